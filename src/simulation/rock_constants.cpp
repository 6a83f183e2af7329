#include "kluft/simulation/rock_constants.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "kluft/loading/boundary_geometry.hpp"

namespace kluft {

namespace {

constexpr double square_to = 1e-3;    ///< cosine: less is a right angle
constexpr double much_narrower = 0.9; ///< of the body's width
constexpr double much_beyond = 0.02;  ///< of the body's length: spikes and corners that raise its width by as much
constexpr double much_uneven = 0.05;  ///< of the body's length
constexpr double much_leaning =
    0.0872; ///< sine of 5 degrees: E of a body twice as high as wide is 3 % less, nu 9 % more

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

/// The platens of a stage, and the body between them.
struct PressedBody {
    Vec2 normal = Vec2::Zero(); ///< outward, of the moved one
    double length = 0.0;        ///< m
    double width = 0.0;         ///< m
    std::array<Side, 2> sides;
};

PressedBody pressed_body(const BlockSystem& system, int moved) {
    return {.normal = boundary_frame(system, moved).normal,
            .length = distance_across(system, moved),
            .width = width_across(system, moved).width,
            .sides = lateral_sides(system, moved)};
}

/// How far the sides reach beyond what a platen lies on, along its direction (m).
double reach_beyond(const BlockSystem& system, const PressedBody& body, int boundary, const Vec2& outward) {
    const double plane = outermost_place(system, outer_edges(system, boundary), outward);
    double reach = 0.0;
    for (const Side& side : body.sides)
        for (const SidePart& part : side) reach = std::max(reach, outermost_place(system, part.edges, outward) - plane);
    return reach;
}

/// What makes the stress at a platen uneven, or its width another one than that of the body below.
std::vector<std::string> unlike_a_specimen(const Model& model, const PressedBody& body, int boundary,
                                           const Vec2& outward) {
    const BlockSystem& system = model.system;
    const std::string name = quoted_name(model, boundary);
    std::vector<std::string> reasons;
    const double width = outer_width(system, boundary, right_normal(outward));
    if (width < much_narrower * body.width)
        reasons.push_back(
            fmt::format("the platen on {} presses {:.4g} m of the body's width, {:.4g} m", name, width, body.width));
    if (const double beyond = reach_beyond(system, body, boundary, outward); beyond > much_beyond * body.length)
        reasons.push_back(
            fmt::format("the body stands out by {:.3g} m beyond what the platen on {} is laid on", beyond, name));
    if (const double apart = unevenness(system, boundary); apart > much_uneven * body.length)
        reasons.push_back(fmt::format("the platen on {} is laid on sides that lie up to {:.3g} m apart", name, apart));
    return reasons;
}

/// Why a body is no specimen with straight sides between two parallel platens, in the stage's motion.
std::vector<std::string> unlike_a_specimen(const Model& model, const PlatenMotion& motion) {
    const BlockSystem& system = model.system;
    const PressedBody body = pressed_body(system, motion.boundary);
    std::vector<std::string> reasons = unlike_a_specimen(model, body, motion.boundary, body.normal);
    if (const int rest = resting_boundary(system, motion); rest >= 0) {
        const auto more = unlike_a_specimen(model, body, rest, -body.normal);
        reasons.insert(reasons.end(), more.begin(), more.end());
    }
    double leaning = 0.0;
    for (const Side& side : body.sides)
        if (!side.empty()) leaning = std::max(leaning, std::abs(mean_normal(system, side).dot(body.normal)));
    if (leaning > much_leaning)
        reasons.push_back(fmt::format("the sides lean by {:.3g} degrees against the way of the platen",
                                      std::asin(leaning) * 180.0 / std::numbers::pi));
    return reasons;
}

const Stage* first_platen_stage(const Model& model) {
    const auto stage =
        std::ranges::find_if(model.loads.stages, [](const Stage& each) { return each.motion.has_value(); });
    return stage == model.loads.stages.end() ? nullptr : &*stage;
}

} // namespace

bool is_pressed_in_part(const BlockSystem& system, int boundary) {
    const Vec2 normal = boundary_frame(system, boundary).normal;
    return outer_width(system, boundary, right_normal(normal)) < much_narrower * width_across(system, boundary).width;
}

bool has_elastic_constants(const Model& model) {
    const Stage* const stage = first_platen_stage(model);
    return stage == nullptr || unlike_a_specimen(model, *stage->motion).empty();
}

std::string elastic_constants_warning(const Model& model) {
    const Stage* const stage = first_platen_stage(model);
    if (stage == nullptr || is_pressed_in_part(model.system, stage->motion->boundary)) return {};
    if (const auto shape = unlike_a_specimen(model, *stage->motion); !shape.empty())
        return fmt::format(
            "youngs_modulus and poissons_ratio are null, since they would be those of the body's shape and "
            "not the rock's: {}. Even faces across the way of the platen, as wide as the body, and sides "
            "along it give the rock's",
            fmt::join(shape, "; "));
    const std::vector<std::string> reasons = what_holds(model, *stage);
    if (reasons.empty()) return {};
    return fmt::format(
        "youngs_modulus and poissons_ratio are those of this body in this test and not the rock's, and by how "
        "much they differ cannot be known from it: {}. Smooth platens on the whole width and sides that "
        "are free or pressed give the rock's",
        fmt::join(reasons, "; "));
}

} // namespace kluft
