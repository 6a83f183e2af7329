#include "kluft/simulation/overloaded_corners.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "kluft/blocks/block_search.hpp"
#include "kluft/constitutive/strength_envelope.hpp"
#include "kluft/core/place_text.hpp"
#include "kluft/kinematics/affine.hpp"
#include "kluft/loading/loaded_body.hpp"
#include "kluft/simulation/placement.hpp"

namespace kluft {

namespace {

/// Of the compressive strength: what a wedge of 60 degrees bears on its blunted tip, 2.1 with phi = 25 degrees and no confining
/// stress (docs/theory.md, (32c)).
constexpr double overload = 2.0;
constexpr double large_axial_share = 0.05; ///< of the axial force
constexpr double short_corner = 0.5;       ///< of the spacing of a hexagon as large as the smaller block
constexpr int n_sections = 10;             ///< along the body, in each of which the axial forces of corners are summed

/// Sums over the contact points of two blocks along mapped fractures.
struct MappedTouching {
    double pressing = 0.0;      ///< N/m, in compression
    double length = 0.0;        ///< of what is pressed (m)
    Vec2 force = Vec2::Zero();  ///< on the second block (N/m)
    Vec2 moment = Vec2::Zero(); ///< of the length (m2)
};

bool is_on_mapped_fracture(const BlockSystem& system, int block, int edge) {
    const int interface = system.blocks[block].edges[edge].interface;
    return interface >= 0 && system.interfaces[interface].fracture >= 0;
}

/// Of each block: the largest of the potential cracks around it, also of those that have failed; of a block without any the largest in
/// the body (Pa).
std::vector<double> rock_strengths(const Model& model, double confining_stress) {
    std::vector<double> strengths(model.system.blocks.size(), 0.0);
    for (int i = 0; i < model.system.n_interfaces(); ++i) {
        const Interface& interface = model.system.interfaces[i];
        if (!model.bonds[law_of(interface)]) continue;
        const double strength = compressive_strength(model.strengths[i], confining_stress);
        for (const int block : {interface.block_a, interface.block_b})
            strengths[block] = std::max(strengths[block], strength);
    }
    const double largest = *std::ranges::max_element(strengths);
    std::ranges::replace(strengths, 0.0, largest);
    return strengths;
}

using TouchingPairs = std::map<std::pair<int, int>, MappedTouching>;

TouchingPairs pressed_along_fractures(const Model& model, const BodyState& state) {
    const Eigen::VectorXd& q = state.displacement;
    TouchingPairs pairs;
    for (const ContactPoint& point : detected_contacts(model, state, true).points) {
        if (!is_on_mapped_fracture(model.system, point.key.block_a, point.key.edge_a)) continue;
        const PointTraction traction = contact_traction(model.laws, point, q);
        if (traction.normal >= 0.0) continue;
        const double sign = point.block_a < point.block_b ? 1.0 : -1.0;
        MappedTouching& touching = pairs[std::minmax(point.block_a, point.block_b)];
        touching.pressing -= point.weight * traction.normal;
        touching.length += point.weight;
        touching.force += sign * point.weight * (traction.normal * point.normal + traction.shear * point.tangent);
        touching.moment += point.weight * current_position(model.system, q, point.block_a, point.xi_a);
    }
    return pairs;
}

} // namespace

OverloadedCorners overloaded_corners(const Model& model, const Gauges& gauges, const StepRecord& record,
                                     const State& state) {
    OverloadedCorners corners;
    if (!model.has_potential_cracks) return corners;
    const BlockSystem& system = model.system;
    const auto strengths = rock_strengths(model, std::max(0.0, std::min(record.axial_stress, record.lateral_stress)));
    const double middle = gauges.axial_normal.dot(0.5 * (system.lower + system.upper));
    std::array<double, n_sections> carried{};
    double largest = 0.0;
    for (const auto& [blocks, touching] : pressed_along_fractures(model, state.body)) {
        const auto [a, b] = blocks;
        const double strength = std::min(strengths[a], strengths[b]);
        const double traction = touching.pressing / touching.length;
        const double size = std::min(spacing_of(system.blocks[a]), spacing_of(system.blocks[b]));
        if (traction <= overload * strength || touching.length > short_corner * size) continue;
        ++corners.n;
        const Vec2 place = touching.moment / touching.length;
        const double force = std::abs(gauges.axial_normal.dot(touching.force));
        const double along = (gauges.axial_normal.dot(place) - middle) / gauges.length + 0.5;
        carried[static_cast<std::size_t>(std::clamp(along * n_sections, 0.0, n_sections - 1.0))] += force;
        if (force <= largest) continue;
        largest = force;
        corners.block_a = a;
        corners.block_b = b;
        corners.traction = traction;
        corners.strength = strength;
        corners.place = system.origin + place;
    }
    const double axial_force = std::abs(record.axial_stress) * gauges.width;
    if (axial_force > 0.0) corners.share = *std::ranges::max_element(carried) / axial_force;
    return corners;
}

CornerWatch::CornerWatch(const Model& model)
    : model_(model), gauges_(make_gauges(model)),
      is_needed_(
          gauges_.first_platen_stage >= 0 && model.has_potential_cracks &&
          std::ranges::any_of(model.system.interfaces, [](const Interface& each) { return each.fracture >= 0; })) {}

void CornerWatch::step(const StepRecord& record, const State& state) {
    if (!is_needed_ || record.stage < gauges_.first_platen_stage) return;
    const double stress = std::abs(record.axial_stress);
    if (!record.balanced || stress < largest_stress_ || model_.loads.stages[record.stage].strength_reduction) return;
    largest_stress_ = stress;
    corners_ = overloaded_corners(model_, gauges_, record, state);
    if (corners_.share <= large_axial_share) stress_before_ = stress;
}

std::string CornerWatch::warning() const {
    if (corners_.share <= large_axial_share) return {};
    std::string text = fmt::format(
        "corners between mapped fractures bear more than rock does, since what is smaller than a cell of the net "
        "cannot break off: at {} under more than {} times the rock's compressive strength they carry {:.0f} % of the "
        "axial force (blocks {} and {} at about {} press each other with {:.4g} MPa, rock of {:.3g} MPa). The largest "
        "axial stress is too high by that",
        corners_.n == 1 ? "one contact" : fmt::format("{} contacts", corners_.n), overload, 100.0 * corners_.share,
        block_label(model_.system, corners_.block_a), block_label(model_.system, corners_.block_b),
        place_text(corners_.place), 1e-6 * corners_.traction, 1e-6 * corners_.strength);
    if (stress_before_ > 0.0)
        text += fmt::format("; when they came to carry a twentieth, it was {:.4g} MPa", 1e-6 * stress_before_);
    return text;
}

} // namespace kluft
