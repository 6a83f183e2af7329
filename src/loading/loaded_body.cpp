#include "kluft/loading/loaded_body.hpp"

#include <algorithm>
#include <cmath>

#include "kluft/kinematics/affine.hpp"

namespace kluft {

namespace {

constexpr double negligible_stress = 1e-2; ///< of the largest so far

/// Calls visit(block, xi, force) for each load but the weights.
template <class Visit> void for_each_surface_load(const LoadedBody& body, const Eigen::VectorXd& q, Visit visit) {
    for (const PressureEdge& edge : body.loads->pressure_edges) {
        const double pressure = body.loads->pressures[edge.boundary];
        if (pressure != 0.0) visit(edge.block, edge.xi_middle, pressure_force(edge, pressure, q));
    }
    for (const PointLoad& load : body.loads->point_loads) visit(load.block, load.xi, load.force);
    for (const PointLoad& load : body.loads->friction) visit(load.block, load.xi, load.force);
}

/// Sums the forces and, where they are wanted, their magnitudes.
template <bool with_magnitudes> class Summation {
public:
    explicit Summation(BodyForces& result) : result_(result) {}

    void add(int block, const Vec2& xi, const Vec2& force) {
        add_force(result_.forces, block, xi, force);
        if constexpr (with_magnitudes) add_force(result_.magnitudes, block, xi.cwiseAbs(), force.cwiseAbs());
    }

    void add_blocks(const LoadedBody& body, const Eigen::VectorXd& q) {
        const BlockSystem& system = *body.system;
        for (int b = 0; b < system.n_blocks(); ++b) {
            const Block& block = system.blocks[b];
            if (body.kinematics == Kinematics::affine) {
                const ElasticModuli& moduli = (*body.moduli)[block.material];
                const Mat2 force = block.size * stress_of_gradient(displacement_gradient(q, b, block.size), moduli);
                const Eigen::Map<const Eigen::Vector4d> columns(force.data());
                result_.forces.segment<4>(n_block_unknowns * b + 2) += columns;
                if constexpr (with_magnitudes)
                    result_.magnitudes.segment<4>(n_block_unknowns * b + 2) += columns.cwiseAbs();
                raise_stiffest(2.0 * moduli.mu + moduli.lambda);
            }
            if (body.densities != nullptr) {
                const Vec2 weight = weight_of(body, b);
                result_.forces.segment<2>(n_block_unknowns * b) -= weight;
                if constexpr (with_magnitudes) result_.magnitudes.segment<2>(n_block_unknowns * b) += weight.cwiseAbs();
            }
        }
    }

    /// Interface forces are internal: +f on b where f is what b's opening stretches.
    void add_bonds(const LoadedBody& body, const Eigen::VectorXd& q) {
        for (const Bond& bond : body.placement->bonds) {
            const InterfaceLaw& law = (*body.laws)[bond.law];
            for (int k = 0; k < n_bond_points; ++k) {
                const auto traction = bond_traction(law, bond, k, q);
                const Vec2 force = bond.weight * (traction.normal * bond.normal() + traction.shear * bond.tangent);
                add(bond.block_b, bond.xi_b[k], force);
                add(bond.block_a, bond.xi_a[k], -force);
            }
            raise_stiffest(bond.weight * law.normal_stiffness);
        }
    }

    template <class Keep> void add_contacts(const LoadedBody& body, const Eigen::VectorXd& q, Keep keep) {
        for (const ContactPoint& point : body.placement->contacts) {
            const auto traction = contact_traction(*body.laws, point, q);
            const Vec2 force = point.weight * (traction.normal * point.normal + traction.shear * point.tangent);
            add(point.block_b, point.xi_b, force);
            add(point.block_a, point.xi_a, -force);
            raise_stiffest(point.weight * (*body.laws)[point.law].normal_stiffness);
            keep(traction);
        }
    }

    void add_surface_loads(const LoadedBody& body, const Eigen::VectorXd& q) {
        for_each_surface_load(body, q,
                              [this](int block, const Vec2& xi, const Vec2& force) { add(block, xi, -force); });
    }

private:
    void raise_stiffest(double stiffness) { result_.stiffest = std::max(result_.stiffest, stiffness); }

    BodyForces& result_;
};

} // namespace

double negligible_force(double carried_stress, double area) {
    return negligible_stress * carried_stress * std::sqrt(area); // (27c)
}

Vec2 weight_of(const LoadedBody& body, int b) {
    const Block& block = body.system->blocks[b];
    if (body.densities == nullptr || block.fixed) return Vec2::Zero();
    return (*body.densities)[block.material] * block.area * body.loads->gravity;
}

void body_forces(const LoadedBody& body, const Eigen::VectorXd& q, BodyForces& result) {
    result.forces.setZero(q.size());
    result.magnitudes.setZero(q.size());
    result.stiffest = 0.0;
    Summation<true> sum(result);
    sum.add_blocks(body, q);
    sum.add_bonds(body, q);
    sum.add_contacts(body, q, [](const PointTraction&) {});
    sum.add_surface_loads(body, q);
}

void body_forces(const LoadedBody& body, const Eigen::VectorXd& q, BodyForces& result,
                 std::vector<PointTraction>& tractions) {
    result.forces.setZero(q.size());
    result.stiffest = 0.0;
    tractions.clear();
    Summation<false> sum(result);
    sum.add_blocks(body, q);
    sum.add_bonds(body, q);
    sum.add_contacts(body, q, [&](const PointTraction& traction) { tractions.push_back(traction); });
    sum.add_surface_loads(body, q);
}

void external_forces(const LoadedBody& body, const Eigen::VectorXd& q, Eigen::VectorXd& result) {
    result.setZero(q.size());
    for (int b = 0; b < body.system->n_blocks(); ++b) result.segment<2>(n_block_unknowns * b) += weight_of(body, b);
    for_each_surface_load(body, q,
                          [&](int block, const Vec2& xi, const Vec2& force) { add_force(result, block, xi, force); });
}

std::vector<double> load_magnitudes(const LoadedBody& body, const Eigen::VectorXd& q) {
    std::vector<double> result(body.system->blocks.size());
    for (int b = 0; b < body.system->n_blocks(); ++b) result[b] = weight_of(body, b).norm();
    for_each_surface_load(body, q, [&](int block, const Vec2&, const Vec2& force) { result[block] += force.norm(); });
    return result;
}

std::vector<double> driving_loads(const LoadedBody& body, const Eigen::VectorXd& q) {
    std::vector<Vec2> on_surface(body.system->blocks.size(), Vec2::Zero());
    for_each_surface_load(body, q, [&](int block, const Vec2&, const Vec2& force) { on_surface[block] += force; });
    std::vector<double> result;
    for (int b = 0; b < body.system->n_blocks(); ++b)
        result.push_back(weight_of(body, b).norm() + on_surface[b].norm());
    return result;
}

double loads_along(const LoadedBody& body, const Eigen::VectorXd& q, const Vec2& direction) {
    double sum = 0.0;
    for (int b = 0; b < body.system->n_blocks(); ++b) sum += std::abs(weight_of(body, b).dot(direction));
    for_each_surface_load(body, q, [&](int, const Vec2&, const Vec2& force) { sum += std::abs(force.dot(direction)); });
    return sum;
}

ContactPiece piece_at(const InterfaceLaw& law, const ContactPoint& point, const Eigen::VectorXd& q) {
    if (law.cohesion == 0.0) return {};
    return {.from = point.piece.from, .to = point.piece.to, .tilt = tilt(point, q)};
}

double coulomb_limit(const std::vector<InterfaceLaw>& laws, const ContactPoint& point, const Eigen::VectorXd& q) {
    const InterfaceLaw& law = laws[point.law];
    return shear_limit(law, gap_and_slip(point, q).gap - point.history.dilation, piece_at(law, point, q)).value;
}

PointTraction contact_traction(const std::vector<InterfaceLaw>& laws, const ContactPoint& point,
                               const Eigen::VectorXd& q) {
    const auto [gap, slip] = gap_and_slip(point, q);
    const InterfaceLaw& law = laws[point.law];
    return fracture_traction(law, point.history, gap, slip, piece_at(law, point, q), point.held_limit);
}

PointTraction contact_traction(const LoadedBody& body, int i, const Eigen::VectorXd& q) {
    return contact_traction(*body.laws, body.placement->contacts[i], q);
}

PointTraction bond_traction(const LoadedBody& body, int i, int point, const Eigen::VectorXd& q) {
    const Bond& bond = body.placement->bonds[i];
    return bond_traction((*body.laws)[bond.law], bond, point, q);
}

std::vector<Mat2> block_stresses(const BlockSystem& system, const std::vector<ElasticModuli>& moduli,
                                 const Eigen::VectorXd& q) {
    std::vector<Mat2> stresses;
    stresses.reserve(system.blocks.size());
    for (int b = 0; b < system.n_blocks(); ++b) {
        const Block& block = system.blocks[b];
        stresses.push_back(cauchy_stress_of_gradient(displacement_gradient(q, b, block.size), moduli[block.material]));
    }
    return stresses;
}

/// The forces on D of a block add up to -h P of a stress that would balance them, and sigma = P R' for a rigid block.
std::vector<Mat2> block_stresses(const LoadedBody& body, const Eigen::VectorXd& q) {
    if (body.kinematics == Kinematics::affine) return block_stresses(*body.system, *body.moduli, q);
    BodyForces sum;
    body_forces(body, q, sum);
    body.loads->constraints.add_reactions(sum.forces);
    std::vector<Mat2> stresses;
    stresses.reserve(body.system->blocks.size());
    for (int b = 0; b < body.system->n_blocks(); ++b) {
        const double size = body.system->blocks[b].size;
        const Eigen::Map<const Mat2> moments(sum.forces.data() + n_block_unknowns * b + 2);
        const Mat2 stress = -moments * deformation_gradient(q, b, size).transpose() / size;
        stresses.push_back(0.5 * (stress + stress.transpose()));
    }
    return stresses;
}

Eigen::VectorXd travel_of_platen(const Loads& loads, Eigen::Index n_unknowns) {
    return loads.platen_force ? loads.constraints.travel_motion(n_unknowns) : Eigen::VectorXd();
}

void keep_free_part(const Loads& loads, const Eigen::VectorXd& travel, const Eigen::VectorXd& q,
                    Eigen::VectorXd& forces) {
    const double missing = travel.size() > 0 ? loads.platen_force->at(q) - travel.dot(forces) : 0.0;
    loads.constraints.project(forces);
    if (travel.size() > 0) forces -= missing / travel.squaredNorm() * travel;
}

} // namespace kluft
