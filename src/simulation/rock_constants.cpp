#include "kluft/simulation/rock_constants.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "kluft/loading/boundary_geometry.hpp"

namespace kluft {

namespace {

constexpr double square_to = 1e-3; ///< cosine: less is a right angle

std::string quoted_name(const Model& model, int boundary) { return "'" + model.system.boundaries[boundary].name + "'"; }

/// Of the sides besides those of the platens, the supports that change what the body strains by: any that takes forces along itself, one
/// that is neither along nor across the platen, and smooth ones on both sides, not one alone, as on a plane of symmetry.
std::vector<std::string> supports_that_hold(const Model& model, const PlatenMotion& motion) {
    const BlockSystem& system = model.system;
    const int moved = motion.boundary;
    const Vec2 normal = boundary_frame(system, moved).normal;
    const Vec2 across(-normal.y(), normal.x());
    const int opposite = resting_boundary(system, motion);
    std::vector<std::string> holding;
    std::array<std::vector<std::string>, 2> smooth_sides;
    for (int i = 0; i < static_cast<int>(system.boundaries.size()); ++i) {
        const Support support = model.loads.supports[i];
        if (i == moved || i == opposite || support == Support::none) continue;
        const Vec2 own = boundary_frame(system, i).normal;
        const bool is_square = std::abs(own.dot(normal)) < square_to;
        const bool leaves_along = support == Support::smooth || support == Support::pinned;
        if (support == Support::smooth && is_square)
            smooth_sides[own.dot(across) > 0.0 ? 0 : 1].push_back(quoted_name(model, i));
        else if (!leaves_along || std::abs(own.dot(across)) >= square_to)
            holding.push_back(quoted_name(model, i));
    }
    if (!smooth_sides[0].empty() && !smooth_sides[1].empty())
        for (const auto& side : smooth_sides) holding.insert(holding.end(), side.begin(), side.end());
    return holding;
}

std::vector<std::string> what_holds(const Model& model, const Stage& stage) {
    const int moved = stage.motion->boundary;
    const int opposite = resting_boundary(model.system, *stage.motion);
    std::vector<std::string> reasons;
    if (stage.platen_friction > 0.0) reasons.push_back(fmt::format("the platen on {} rubs", quoted_name(model, moved)));
    if (opposite >= 0 && model.loads.supports[opposite] == Support::fixed)
        reasons.push_back(fmt::format("the platen on {}, whose support is fixed, lets nothing slide along it",
                                      quoted_name(model, opposite)));
    if (const auto holding = supports_that_hold(model, *stage.motion); !holding.empty())
        reasons.push_back(fmt::format("the support of {} holds the body as well", fmt::join(holding, ", ")));
    if (std::ranges::any_of(model.system.blocks, &Block::fixed))
        reasons.emplace_back("fixed blocks hold the body as well");
    return reasons;
}

} // namespace

bool is_pressed_in_part(const BlockSystem& system, int boundary) {
    constexpr double much_narrower = 0.8;
    return boundary_frame(system, boundary).length < much_narrower * width_across(system, boundary).width;
}

std::string elastic_constants_warning(const Model& model) {
    const auto stage =
        std::ranges::find_if(model.loads.stages, [](const Stage& each) { return each.motion.has_value(); });
    if (stage == model.loads.stages.end() || is_pressed_in_part(model.system, stage->motion->boundary)) return {};
    const std::vector<std::string> reasons = what_holds(model, *stage);
    if (reasons.empty()) return {};
    return fmt::format(
        "youngs_modulus and poissons_ratio are those of this body in this test and not the rock's, and by how "
        "much they differ cannot be known from it: {}. Smooth platens on the whole width and sides that "
        "are free or pressed give the rock's",
        fmt::join(reasons, "; "));
}

} // namespace kluft
