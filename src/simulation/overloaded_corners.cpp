#include "kluft/simulation/overloaded_corners.hpp"

#include <algorithm>
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
constexpr double large_share = 0.05; ///< of what goes across mapped fractures

/// Sums over the contact points of two blocks along mapped fractures.
struct Touching {
    double force = 0.0;  ///< N/m, in compression
    double length = 0.0; ///< of what is pressed (m)
    Vec2 moment = Vec2::Zero();
};

bool is_on_mapped_fracture(const BlockSystem& system, int block, int edge) {
    const int interface = system.blocks[block].edges[edge].interface;
    return interface >= 0 && system.interfaces[interface].fracture >= 0;
}

/// docs/theory.md, (36).
double compressive_strength(const Strength& strength, double confining_stress) {
    const double sine = std::sin(strength.friction_angle);
    return uniaxial_compressive_strength(strength) + (1.0 + sine) / (1.0 - sine) * confining_stress;
}

/// Of the potential cracks around a block, also of those that have failed: the largest; 0 without any (Pa).
double rock_strength(const Model& model, int block, double confining_stress) {
    double strength = 0.0;
    for (const Edge& edge : model.system.blocks[block].edges) {
        if (edge.interface < 0 || !model.bonds[law_of(model.system.interfaces[edge.interface])]) continue;
        strength = std::max(strength, compressive_strength(model.strengths[edge.interface], confining_stress));
    }
    return strength;
}

using TouchingPairs = std::map<std::pair<int, int>, Touching>;

TouchingPairs pressed_along_fractures(const Model& model, const BodyState& state) {
    const Eigen::VectorXd& q = state.displacement;
    TouchingPairs pairs;
    for (const ContactPoint& point : detected_contacts(model, state).points) {
        if (!is_on_mapped_fracture(model.system, point.key.block_a, point.key.edge_a)) continue;
        const double pressure = -contact_traction(model.laws, point, q).normal;
        if (pressure <= 0.0) continue;
        const Block& block = model.system.blocks[point.block_a];
        Touching& touching = pairs[std::minmax(point.block_a, point.block_b)];
        touching.force += point.weight * pressure;
        touching.length += point.weight;
        touching.moment +=
            point.weight * (block.centroid + block.size * point.xi_a + displacement_at(q, point.block_a, point.xi_a));
    }
    return pairs;
}

} // namespace

OverloadedCorners overloaded_corners(const Model& model, const State& state, double confining_stress) {
    OverloadedCorners corners;
    if (!model.has_potential_cracks) return corners;
    const TouchingPairs pairs = pressed_along_fractures(model, state.body);
    double all = 0.0;
    double overloaded = 0.0;
    double largest = 0.0;
    for (const auto& [blocks, touching] : pairs) {
        all += touching.force;
        const double strength = std::min(rock_strength(model, blocks.first, confining_stress),
                                         rock_strength(model, blocks.second, confining_stress));
        const double traction = touching.force / touching.length;
        if (strength <= 0.0 || traction <= overload * strength) continue;
        ++corners.n;
        overloaded += touching.force;
        if (touching.force <= largest) continue;
        largest = touching.force;
        corners.block_a = blocks.first;
        corners.block_b = blocks.second;
        corners.traction = traction;
        corners.strength = strength;
        corners.place = model.system.origin + touching.moment / touching.length;
    }
    if (all > 0.0) corners.share = overloaded / all;
    return corners;
}

CornerWatch::CornerWatch(const Model& model)
    : model_(model),
      is_needed_(model.has_potential_cracks && std::ranges::any_of(model.system.interfaces, [](const Interface& each) {
                     return each.fracture >= 0;
                 })) {}

void CornerWatch::step(const StepRecord& record, const State& state) {
    if (!is_needed_ || model_.loads.stages[record.stage].strength_reduction) return;
    const double stress = std::abs(record.axial_stress);
    if (!record.balanced || stress < largest_stress_) return;
    largest_stress_ = stress;
    corners_ = overloaded_corners(model_, state, std::max(0.0, std::min(record.axial_stress, record.lateral_stress)));
    if (corners_.share <= large_share) stress_before_ = stress;
}

std::string CornerWatch::warning() const {
    if (corners_.share <= large_share) return {};
    std::string text = fmt::format(
        "corners between mapped fractures bear more than rock does: {} under more than {} times its compressive "
        "strength carry {:.2g} % of what goes across the fractures (blocks {} and {} at about {} press each other with "
        "{:.3g} MPa, rock of {:.3g} MPa), since corners smaller than a cell of the net cannot break off. ",
        corners_.n, overload, 100.0 * corners_.share, block_label(model_.system, corners_.block_a),
        block_label(model_.system, corners_.block_b), place_text(corners_.place), 1e-6 * corners_.traction,
        1e-6 * corners_.strength);
    if (stress_before_ > 0.0)
        text += fmt::format("A strength is too high by what they carry: until then the axial stress was {:.4g} MPa at "
                            "most",
                            1e-6 * stress_before_);
    else
        text += "A strength is too high by what they carry";
    return text;
}

} // namespace kluft
