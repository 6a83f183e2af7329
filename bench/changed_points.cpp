#include "changed_points.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "kluft/contact/bonds.hpp"
#include "kluft/kinematics/affine.hpp"

namespace kluft::bench {

namespace {

constexpr double line_dip = 1.0; ///< rad
constexpr int open_every = 4;    ///< interfaces

struct Candidate {
    int interface;
    Vec2 middle;
};

/// The interfaces between blocks that move freely: supports and platens would change their rows.
std::vector<Candidate> free_interfaces(const Body& body) {
    const BlockSystem& system = body.model().system;
    std::vector<char> held(system.blocks.size(), 0);
    for (const auto& row : body.problem().body.loads->constraints.rows()) held[row.block] = 1;
    std::vector<Candidate> candidates;
    for (int i = 0; i < system.n_interfaces(); ++i) {
        const Interface& interface = system.interfaces[i];
        if (held[interface.block_a] != 0 || held[interface.block_b] != 0) continue;
        const Edge& edge = system.blocks[interface.block_a].edges[interface.edge_a];
        candidates.push_back({i, 0.5 * (edge_start(system, edge) + edge_end(system, edge))});
    }
    return candidates;
}

/// The n that are next to the points of the additive recurrence with the plastic number, which fill a square evenly for
/// every n (M. Roberts, 2018).
std::vector<int> spread_interfaces(const BlockSystem& system, std::vector<Candidate> candidates, int n) {
    constexpr double plastic = 1.32471795724474602596;
    const Vec2 step(1.0 / plastic, 1.0 / (plastic * plastic));
    std::vector<int> chosen;
    for (int k = 1; k <= n; ++k) {
        const Vec2 fraction = (k * step).unaryExpr([](double x) { return x - std::floor(x); });
        const Vec2 wanted = system.lower + fraction.cwiseProduct(system.upper - system.lower);
        const auto nearest = std::ranges::min_element(
            candidates, {}, [&](const Candidate& each) { return (each.middle - wanted).squaredNorm(); });
        chosen.push_back(nearest->interface);
        *nearest = candidates.back();
        candidates.pop_back();
    }
    return chosen;
}

/// The n of a band one hexagon wide that are nearest to the middle of the body.
std::vector<int> line_interfaces(const BlockSystem& system, std::vector<Candidate> candidates, int n) {
    const Vec2 along(std::cos(line_dip), std::sin(line_dip));
    const Vec2 centre = 0.5 * (system.lower + system.upper);
    const double size = (system.upper - system.lower).norm();
    std::ranges::sort(candidates, {}, [&](const Candidate& each) {
        const Vec2 arm = each.middle - centre;
        const bool outside = std::abs(cross(along, arm)) > 0.5 * system.spacing;
        return std::abs(along.dot(arm)) + (outside ? size : 0.0);
    });
    std::vector<int> chosen;
    for (int k = 0; k < n; ++k) chosen.push_back(candidates[k].interface);
    return chosen;
}

/// Change of d(normal, shear)/d(gap, slip) of a bonded point (Pa/m).
Mat2 change_of_tangent(const Model& model, const Bond& bond, bool opens, Sliding sliding) {
    const InterfaceLaw& law = model.laws[bond.law];
    Mat2 change = Mat2::Zero();
    change(1, 1) = -law.shear_stiffness;
    if (opens) {
        change(0, 0) = -law.normal_stiffness;
    } else if (sliding == Sliding::frictional) {
        change(1, 0) = law.normal_stiffness * model.laws[model.fracture_law[bond.law]].tan_friction;
    }
    return change;
}

StiffnessChange change_of(const Body& body, int interface, bool opens, Sliding sliding) {
    const std::array<double, n_bond_points> no_shear{};
    const Bond bond = bond_at(body.model().system, interface, body.displacement(), no_shear.data());
    const std::array<Vec2, 2> directions{bond.normal(), bond.tangent};
    const Mat2 tangent = bond.weight * change_of_tangent(body.model(), bond, opens, sliding);
    StiffnessChange change;
    change.patch = interface;
    change.block_a = bond.block_a;
    change.block_b = bond.block_b;
    change.n_rows = 2 * n_bond_points;
    for (int k = 0; k < n_bond_points; ++k) {
        for (int d = 0; d < 2; ++d) {
            change.rows_a.row(2 * k + d) = -displacement_row(directions[d], bond.xi_a[k]).transpose();
            change.rows_b.row(2 * k + d) = displacement_row(directions[d], bond.xi_b[k]).transpose();
        }
        change.stiffness.block<2, 2>(2 * k, 2 * k) = tangent;
    }
    return change;
}

} // namespace

std::vector<StiffnessChange> changed_interfaces(const Body& body, Placement placement, int n, Sliding sliding) {
    const BlockSystem& system = body.model().system;
    auto candidates = free_interfaces(body);
    n = std::min(n, static_cast<int>(candidates.size()));
    const auto chosen = placement == Placement::spread ? spread_interfaces(system, std::move(candidates), n)
                                                       : line_interfaces(system, std::move(candidates), n);
    std::vector<StiffnessChange> changes;
    for (int k = 0; k < n; ++k)
        changes.push_back(change_of(body, chosen[k], k % open_every == open_every - 1, sliding));
    return changes;
}

void add_changes(std::span<const StiffnessChange> changes, BlockMatrix& matrix) {
    const BlockPattern& pattern = *matrix.pattern;
    for (const StiffnessChange& change : changes) {
        const int a = change.block_a;
        const int b = change.block_b;
        matrix.values[pattern.find(a, a)] += change.rows_a.transpose() * change.stiffness * change.rows_a;
        matrix.values[pattern.find(a, b)] += change.rows_a.transpose() * change.stiffness * change.rows_b;
        matrix.values[pattern.find(b, a)] += change.rows_b.transpose() * change.stiffness * change.rows_a;
        matrix.values[pattern.find(b, b)] += change.rows_b.transpose() * change.stiffness * change.rows_b;
    }
}

} // namespace kluft::bench
