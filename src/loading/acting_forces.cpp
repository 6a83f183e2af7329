#include "kluft/loading/acting_forces.hpp"

#include <algorithm>

#include "kluft/loading/loaded_body.hpp"

namespace kluft {

namespace {

/// Where the point xi of a block is at q, local coordinates (m).
Vec2 place_of(const BlockSystem& system, const Eigen::VectorXd& q, int b, const Vec2& xi) {
    const Block& block = system.blocks[b];
    return block.centroid + block.size * xi + displacement_at(q, b, xi);
}

MeetingState meeting_state(ContactState state) {
    switch (state) {
    case ContactState::open:
        return MeetingState::open;
    case ContactState::sliding:
        return MeetingState::sliding;
    case ContactState::locked:
        return MeetingState::locked;
    }
    return MeetingState::open;
}

SupportKind kind_of(const PrescribedDisplacement& row, const std::vector<Platen>& platens) {
    if (row.boundary < 0) return SupportKind::fixed;
    const bool is_platen = std::ranges::find(platens, row.boundary, &Platen::boundary) != platens.end();
    return is_platen ? SupportKind::platen : SupportKind::support;
}

/// The reactions and, on platens, the friction, one force per held point: the rows of a point follow each other.
void add_reactions(const LoadedBody& body, const Eigen::VectorXd& q, std::vector<SupportForce>& result) {
    const Loads& loads = *body.loads;
    BodyForces sum;
    body_forces(body, q, sum);
    const std::vector<double> along = loads.constraints.row_forces(sum.forces);
    const std::vector<PrescribedDisplacement>& rows = loads.constraints.rows();
    for (std::size_t r = 0; r < rows.size(); ++r) {
        const PrescribedDisplacement& row = rows[r];
        const bool is_next =
            r > 0 && rows[r - 1].block == row.block && rows[r - 1].boundary == row.boundary && rows[r - 1].xi == row.xi;
        if (!is_next)
            result.push_back({row.block, row.boundary, kind_of(row, loads.platens), Vec2::Zero(),
                              place_of(*body.system, q, row.block, row.xi)});
        result.back().force += along[r] * row.direction;
        if (is_next || row.platen_point < 0) continue;
        const PlatenPoint& point = loads.platen_points[row.platen_point];
        const auto platen = std::ranges::find(loads.platens, point.boundary, &Platen::boundary);
        result.back().force += point.friction * platen->tangent();
    }
}

} // namespace

std::vector<ContactForce> contact_forces(const LoadedBody& body, const Eigen::VectorXd& q) {
    const BlockSystem& system = *body.system;
    const Placement& placement = *body.placement;
    std::vector<ContactForce> result;
    result.reserve(n_bond_points * placement.bonds.size() + placement.contacts.size());
    for (const Bond& bond : placement.bonds) {
        for (int k = 0; k < n_bond_points; ++k) {
            const PointTraction traction = bond_traction((*body.laws)[bond.law], bond, k, q);
            result.push_back({bond.block_a, bond.block_b, place_of(system, q, bond.block_a, bond.xi_a[k]),
                              place_of(system, q, bond.block_b, bond.xi_b[k]), bond.weight, bond.normal(),
                              traction.normal, traction.shear, MeetingState::bonded, bond.law});
        }
    }
    for (const ContactPoint& point : placement.contacts) {
        const PointTraction traction = contact_traction(*body.laws, point, q);
        result.push_back({point.block_a, point.block_b, place_of(system, q, point.block_a, point.xi_a),
                          place_of(system, q, point.block_b, point.xi_b), point.weight, point.normal, traction.normal,
                          traction.shear, meeting_state(traction.state), point.law});
    }
    return result;
}

std::vector<SupportForce> support_forces(const LoadedBody& body, const Eigen::VectorXd& q) {
    const BlockSystem& system = *body.system;
    std::vector<SupportForce> result;
    const auto add = [&](int block, int boundary, SupportKind kind, const Vec2& force, const Vec2& xi) {
        result.push_back({block, boundary, kind, force, place_of(system, q, block, xi)});
    };
    constexpr int no_boundary_of_load = -1;
    for (int b = 0; b < system.n_blocks(); ++b)
        add(b, no_boundary_of_load, SupportKind::weight, weight_of(body, b), Vec2::Zero());
    for (const PressureEdge& edge : body.loads->pressure_edges)
        add(edge.block, edge.boundary, SupportKind::pressure,
            pressure_force(edge, body.loads->pressures[edge.boundary], q), edge.xi_middle);
    for (const PointLoad& load : body.loads->point_loads)
        add(load.block, no_boundary_of_load, SupportKind::force, load.force, load.xi);
    add_reactions(body, q, result);
    std::erase_if(result, [](const SupportForce& each) { return each.force == Vec2::Zero(); });
    return result;
}

} // namespace kluft
