#include "kluft/loading/stored_energy.hpp"

#include "kluft/constitutive/block_elasticity.hpp"
#include "kluft/kinematics/affine.hpp"

namespace kluft {

double contact_energy(const LoadedBody& body, const ContactPoint& point, const Eigen::VectorXd& q) {
    const InterfaceLaw& law = (*body.laws)[point.law];
    const auto traction = contact_traction(*body.laws, point, q);
    const double elastic_gap = gap_and_slip(point, q).gap - traction.history.dilation;
    const double shear = law.shear_stiffness > 0.0 ? traction.shear * traction.shear / law.shear_stiffness : 0.0;
    return point.weight * (contact_energy(law, elastic_gap) + 0.5 * shear);
}

double bond_energy(const LoadedBody& body, const Bond& bond, const Eigen::VectorXd& q) {
    const InterfaceLaw& law = (*body.laws)[bond.law];
    double energy = 0.0;
    for (int k = 0; k < n_bond_points; ++k) {
        const auto traction = bond_traction(law, bond, k, q);
        energy += 0.5 * traction.normal * traction.normal / law.normal_stiffness;
        if (law.shear_stiffness > 0.0) energy += 0.5 * traction.shear * traction.shear / law.shear_stiffness;
    }
    return bond.weight * energy;
}

double springs_energy(const LoadedBody& body, const Eigen::VectorXd& q) {
    double energy = 0.0;
    for (const Bond& bond : body.placement->bonds) energy += bond_energy(body, bond, q);
    for (const ContactPoint& point : body.placement->contacts) energy += contact_energy(body, point, q);
    return energy;
}

double stored_energy(const LoadedBody& body, const Eigen::VectorXd& q) {
    double energy = springs_energy(body, q);
    if (body.kinematics == Kinematics::rigid) return energy;
    for (int b = 0; b < body.system->n_blocks(); ++b) {
        const Block& block = body.system->blocks[b];
        energy +=
            block.area * strain_energy_density(deformation_gradient(q, b, block.size), (*body.moduli)[block.material]);
    }
    return energy;
}

} // namespace kluft
