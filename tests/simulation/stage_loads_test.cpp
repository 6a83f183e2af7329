#include "kluft/loading/boundary_geometry.hpp"
#include "kluft/simulation/stage_loads.hpp"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <numbers>
#include <string>
#include <vector>

#include <Eigen/Geometry>
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "kluft/core/units.hpp"
#include "kluft/kinematics/affine.hpp"
#include "kluft/simulation/fingerprint.hpp"
#include "support/scene_run.hpp"

namespace kluft {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

constexpr int bottom = 0, right = 1, top = 2, left = 3; // of a rectangle

/// A body of 1 m x 2 m, cut by two joints across the bottom and the top, with the boundaries and stages given.
std::string scene_with(const std::string& boundaries, const std::string& stages) {
    return fmt::format(R"(
kluft: 1
analysis: {{plane: stress}}
materials: {{rock: {{youngs_modulus: 1 GPa, poissons_ratio: 0.2, cohesion: 1e12, friction_angle: 30, tensile_strength: 1e11}}}}
interfaces:
  joint: {{kind: fracture, normal_stiffness: 1e10, shear_stiffness: 1e10, friction_angle: 30}}
  bond: {{kind: potential_crack, normal_stiffness: 1e10, shear_stiffness: 1e10, fails_to: joint}}
geometry:
  domain: {{rectangle: {{width: 1.0, height: 2.0}}}}
  fractures: [{{trace: [[0.4, -1], [0.4, 3]], interface: bond}}, {{trace: [[-1, 1], [2, 1]], interface: bond}}]
  reference_spacing: 1.0
boundaries: {}
stages: {}
solver: {{tolerance: 1e-11, balance: 1e-9}}
)",
                       boundaries, stages);
}

Model model_of(const std::string& boundaries, const std::string& stages) {
    return build_scene_model(read_scene_text(scene_with(boundaries, stages))).model;
}

StageLoads loads_of(const Model& model, const State& state, int stage = 0) {
    return {model, {state.body.displacement, state.stage_start.boundary_pressure}, model.loads.stages[stage]};
}

/// A block of 0.4 m by 0.1 m on one that reaches out from below it by 0.05 m on the left and 0.25 m on the right, turned by an angle;
/// its left side is pushed and has no other side across from it.
Model pushed_block(double degrees_turned) {
    const double c = std::cos(degrees_turned / degrees);
    const double s = std::sin(degrees_turned / degrees);
    const auto corner = [&](double x, double y) {
        return fmt::format("[{:.17g}, {:.17g}]", c * x - s * y, s * x + c * y);
    };
    const auto box = [&](double left, double right, double low, double high) {
        return fmt::format("[{}, {}, {}, {}]", corner(left, low), corner(right, low), corner(right, high),
                           corner(left, high));
    };
    return build_scene_model(read_scene_text(fmt::format(R"(
kluft: 1
materials: {{rock: {{youngs_modulus: 1 GPa, poissons_ratio: 0.2, density: 2600}}}}
interfaces: {{joint: {{kind: fracture, normal_stiffness: 1e10, shear_stiffness: 1e10, friction_angle: 30}}}}
geometry:
  blocks:
    - {{name: floor, polygon: {}, support: fixed}}
    - {{name: slab, polygon: {}}}
  blocks_interface: joint
boundaries: {{push: {{block: slab, sides: [3]}}}}
stages: [{{strain: {{boundary: push, value: 1 %}}}}]
)",
                                                         box(0.0, 0.7, 0.0, 0.1), box(0.05, 0.45, 0.1, 0.2))))
        .model;
}

/// Rows on a boundary along x (0) or y (1), with the reference positions of their vertices.
struct Row {
    Vec2 at;
    double target;
    double rate;
    bool operator<(const Row& other) const {
        return at.x() != other.at.x() ? at.x() < other.at.x() : at.y() < other.at.y();
    }
};

std::vector<Row> rows_on(const Model& model, const Constraints& constraints, int boundary, int axis) {
    std::vector<Row> rows;
    for (const PrescribedDisplacement& row : constraints.rows()) {
        if (row.boundary != boundary || std::abs(row.direction[axis]) < 0.5) continue;
        EXPECT_EQ(row.direction.cwiseAbs(), Vec2::Unit(axis));
        const Block& block = model.system.blocks[row.block];
        const double sign = row.direction[axis];
        rows.push_back({block.centroid + block.size * row.xi, sign * row.target, sign * row.rate});
    }
    std::sort(rows.begin(), rows.end());
    return rows;
}

std::size_t n_rows(const Constraints& constraints, int boundary) {
    return static_cast<std::size_t>(
        std::ranges::count(constraints.rows(), boundary, &PrescribedDisplacement::boundary));
}

constexpr const char* pressed = "[{pressure: {right: 1 MPa}}]";

// The bottom has two blocks with vertices at x = 0, 0.4 and 0.4, 1: four rows across it.
TEST(StageLoads, SmoothSupportHoldsEveryVertexAcrossTheBoundaryOnly) {
    const Model model = model_of("{bottom: {support: smooth}}", pressed);
    const StageLoads loads = loads_of(model, initial_state(model));
    const auto across = rows_on(model, loads.constraints(), bottom, 1);
    ASSERT_EQ(across.size(), 4U);
    const double places[] = {0.0, 0.4, 0.4, 1.0};
    for (int i = 0; i < 4; ++i) {
        EXPECT_NEAR(across[i].at.x(), places[i], 1e-12);
        EXPECT_NEAR(across[i].at.y(), 0.0, 1e-12);
        EXPECT_EQ(across[i].target, 0.0);
    }
    EXPECT_EQ(loads.constraints().rows().size(), 4U);
    EXPECT_TRUE(loads.is_held(bottom));
    for (const int free : {right, top, left}) EXPECT_FALSE(loads.is_held(free));
}

// One vertex, the nearest to the middle at x = 0.5, is held along the boundary too.
TEST(StageLoads, PinnedSupportHoldsOneVertexNearTheMiddleAlongTheBoundaryToo) {
    const Model model = model_of("{bottom: {support: pinned}}", pressed);
    const StageLoads loads = loads_of(model, initial_state(model));
    EXPECT_EQ(rows_on(model, loads.constraints(), bottom, 1).size(), 4U);
    const auto along = rows_on(model, loads.constraints(), bottom, 0);
    ASSERT_EQ(along.size(), 1U);
    EXPECT_NEAR(along.front().at.x(), 0.4, 1e-12);
    EXPECT_EQ(loads.constraints().rows().size(), 5U);
}

TEST(StageLoads, FixedSupportHoldsEveryVertexInBothDirections) {
    const Model model = model_of("{left: {support: fixed}}", pressed);
    const StageLoads loads = loads_of(model, initial_state(model));
    EXPECT_EQ(rows_on(model, loads.constraints(), left, 0).size(), 4U);
    EXPECT_EQ(rows_on(model, loads.constraints(), left, 1).size(), 4U);
    EXPECT_EQ(loads.constraints().rows().size(), 8U);
}

TEST(StageLoads, BodyWithoutSupportsHasNoRows) {
    const Model model = model_of("{}", pressed);
    EXPECT_TRUE(loads_of(model, initial_state(model)).constraints().rows().empty());
}

// ---- platens -------------------------------------------------------------------------------------------------------

// A smooth platen leaves the tangential motion free; without more, the body could drift between two of them.
TEST(StageLoads, SmoothPlatenRestsOnAPinnedOneOppositeToIt) {
    const Model model = model_of("{}", "[{strain: {boundary: top, value: 1 %}}]");
    const StageLoads loads = loads_of(model, initial_state(model));
    EXPECT_EQ(rows_on(model, loads.constraints(), top, 1).size(), 4U);
    EXPECT_EQ(rows_on(model, loads.constraints(), top, 0).size(), 0U);
    EXPECT_EQ(rows_on(model, loads.constraints(), bottom, 1).size(), 4U);
    EXPECT_EQ(rows_on(model, loads.constraints(), bottom, 0).size(), 1U);
    EXPECT_EQ(loads.constraints().rows().size(), 9U);
    EXPECT_FALSE(loads.is_held(left));
    EXPECT_FALSE(loads.is_held(right));
}

TEST(StageLoads, SupportOppositeToASmoothPlatenStaysAsTheSceneSays) {
    for (const auto& [support, expected] : {std::pair("smooth", 0U), std::pair("pinned", 1U), std::pair("fixed", 4U)}) {
        const Model model =
            model_of(fmt::format("{{bottom: {{support: {}}}}}", support), "[{strain: {boundary: top, value: 1 %}}]");
        const StageLoads loads = loads_of(model, initial_state(model));
        EXPECT_EQ(rows_on(model, loads.constraints(), bottom, 0).size(), expected) << support;
    }
}

TEST(StageLoads, RoughPlatensHoldBothBoundariesInBothDirections) {
    const Model model =
        model_of("{bottom: {support: smooth}}", "[{displacement: {boundary: right, value: 1 mm}, platens: rough}]");
    const StageLoads loads = loads_of(model, initial_state(model));
    for (const int boundary : {left, right}) {
        EXPECT_EQ(rows_on(model, loads.constraints(), boundary, 0).size(), 4U);
        EXPECT_EQ(rows_on(model, loads.constraints(), boundary, 1).size(), 4U);
    }
    EXPECT_EQ(n_rows(loads.constraints(), bottom), 4U);
}

// Inward, from where the vertices are at the start of the stage: strain times the height of 2 m, or the displacement.
TEST(StageLoads, PlatenMovesInwardInProportionToTheLoadFactor) {
    for (const auto& [motion, boundary, axis, travel] :
         {std::tuple("strain: {boundary: top, value: 1 %}", top, 1, -0.02),
          std::tuple("strain: {boundary: left, value: -1 %}", left, 0, -0.01),
          std::tuple("displacement: {boundary: right, value: 3 mm}", right, 0, -0.003)}) {
        const Model model = model_of("{}", fmt::format("[{{{}}}]", motion));
        State state = initial_state(model);
        for (int b = 0; b < model.system.n_blocks(); ++b) state.body.displacement[6 * b + axis] = 0.005;
        const StageLoads loads = loads_of(model, state);
        Constraints constraints = loads.constraints();
        for (const double factor : {0.0, 0.25, 1.0}) {
            constraints.move_to(factor);
            for (const Row& row : rows_on(model, constraints, boundary, axis)) {
                EXPECT_NEAR(row.target, 0.005 + factor * travel, 1e-15) << motion;
                EXPECT_EQ(row.rate, 0.0);
            }
        }
        for (const Row& row : rows_on(model, constraints, opposite_boundary(model.system, boundary), axis)) {
            EXPECT_NEAR(row.target, 0.005, 1e-15) << motion;
        }
    }
}

// Under a given stress the platen is rigid and its travel unknown: inward by one per unit of travel.
TEST(StageLoads, PlatenUnderAStressTravelsAsARigidBody) {
    const Model model = model_of("{}", "[{stress: {boundary: top, value: 3 MPa}}]");
    const StageLoads loads = loads_of(model, initial_state(model));
    for (const Row& row : rows_on(model, loads.constraints(), top, 1)) EXPECT_EQ(row.rate, -1.0);
    for (const Row& row : rows_on(model, loads.constraints(), bottom, 1)) EXPECT_EQ(row.rate, 0.0);
    for (const double factor : {0.0, 0.5, 1.0}) {
        ASSERT_TRUE(loads.platen_force(factor).has_value());
        EXPECT_DOUBLE_EQ(loads.platen_force(factor)->stress, factor * 3e6);
        EXPECT_DOUBLE_EQ(loads.platen_force(factor)->at(initial_state(model).body.displacement), factor * 3e6 * 1.0);
    }
    EXPECT_FALSE(
        loads_of(model_of("{}", "[{strain: {boundary: top, value: 1 %}}]"), initial_state(model)).platen_force(1));
}

// 1 m wide; both sides move outward by 1 cm and 2 cm: 1.03 m.
TEST(StageLoads, PlatenForceActsOnTheCurrentWidth) {
    const Model model = model_of("{}", pressed);
    const PlatenForce force = width_across(model.system, top);
    EXPECT_NEAR(force.width, 1.0, 1e-12);
    Eigen::VectorXd q = initial_state(model).body.displacement;
    for (int b = 0; b < model.system.n_blocks(); ++b) {
        q[6 * b] = model.system.blocks[b].centroid.x() > 0.4 ? 0.02 : -0.01;
        q[6 * b + 1] = 0.5;
    }
    EXPECT_NEAR(force.widening.dot(q), 0.03, 1e-15);
}

// The area over the height: a rectangle of 0.2 m x 0.4 m less a notch of 0.05 m x 0.1 m in its top, whose steep flanks face the left and the right, and
// one whose left side bulges by 0.1 m over a height of 0.1 m.
TEST(StageLoads, ABodyWithANotchOrABulgeIsAsWideAsItsAreaOverItsHeight) {
    const auto width_of = [](const char* polygon, const char* boundaries) {
        const Model model = build_scene_model(read_scene_text(fmt::format(R"(
kluft: 1
materials: {{rock: {{youngs_modulus: 1 GPa, poissons_ratio: 0.2, density: 2600}}}}
geometry: {{domain: {{polygon: [{}]}}}}
boundaries: {}
stages: [{{strain: {{boundary: top, value: 1 %}}}}]
)",
                                                                          polygon, boundaries)))
                                .model;
        return width_across(model.system, model.loads.stages[0].motion->boundary).width;
    };
    EXPECT_NEAR(width_of("[0, 0], [0.2, 0], [0.2, 0.4], [0.125, 0.4], [0.1, 0.3], [0.075, 0.4], [0, 0.4]",
                         "{top: {}, left: {}, right: {}}"),
                0.2 - 0.0025 / 0.4, 1e-12);
    EXPECT_NEAR(width_of("[0, 0], [0.2, 0], [0.2, 0.4], [0, 0.4], [0, 0.25], [-0.1, 0.2], [0, 0.15]",
                         "{bottom: {sides: [0]}, right: {sides: [1]}, top: {sides: [2]}, left: {sides: [3, 4, 5, 6]}}"),
                0.2125, 1e-12);
}

/// Two columns of 0.1 m x 0.2 m, 0.05 m apart, with corners off by little, and without the upper half of one side.
Model two_columns(double off, const char* boundaries = "{}") {
    return build_scene_model(read_scene_text(fmt::format(R"(
kluft: 1
analysis: {{plane: stress}}
materials: {{rock: {{youngs_modulus: 10 GPa, poissons_ratio: 0.25, density: 2600}}}}
interfaces: {{joint: {{kind: fracture, normal_stiffness: 1e11, shear_stiffness: 1e11, friction_angle: 30}}}}
geometry:
  blocks:
    - {{name: a, polygon: [[0, 0], [0.1, 0], [0.1, 0.2], [0, 0.2]]}}
    - {{name: b, polygon: [[0.15, 0], [0.25, {0}], [0.25, 0.1], [0.25, 0.2], [0.15, 0.2]]}}
  blocks_interface: joint
boundaries: {1}
stages: [{{strain: {{boundary: top, value: 0.1 %}}, steps: 2}}]
)",
                                                         off, boundaries)))
        .model;
}

// Each column counts as one, whether or not their sides are of the same length to the last digit: half of Poisson's ratio was found.
TEST(StageLoads, ColumnsBesideEachOtherWidenEach) {
    const auto expect_two = [](const Model& model, double tolerance) {
        const int moved = model.loads.stages[0].motion->boundary;
        for (const Side& side : lateral_sides(model.system, moved)) {
            double weight = 0.0;
            for (const SidePart& part : side) weight += part.weight;
            EXPECT_NEAR(weight, 2.0, tolerance);
        }
        EXPECT_NEAR(width_across(model.system, moved).width, 0.2, tolerance);
    };
    for (const double off : {0.0, 1e-9, 1e-6, 1e-5}) expect_two(two_columns(off), 10.0 * off + 1e-12);
    expect_two(two_columns(0.0, "{top: {facing: top}, bottom: {facing: bottom}, left: {facing: left}, plate: {block: "
                                "b, sides: [2]}, right: {facing: right}}"),
               1e-12);
}

// The area over the height, to what the corner is off by: E was 11.4 for 9.9 GPa.
TEST(StageLoads, TheWidthOfANotchedBodyChangesByNoMoreThanItsCorners) {
    for (const double off : {0.0, 1e-9, 1e-6, 1e-5}) {
        const Model model = build_scene_model(read_scene_text(fmt::format(R"(
kluft: 1
materials: {{rock: {{youngs_modulus: 1 GPa, poissons_ratio: 0.2, density: 2600}}}}
geometry: {{domain: {{polygon: [[0, 0], [0.1, {}], [0.1, 0.2], [0.06, 0.2], [0.05, 0.17], [0.04, 0.2], [0, 0.2]]}}}}
stages: [{{strain: {{boundary: top, value: 1 %}}}}]
)",
                                                                          off)))
                                .model;
        const double width = width_across(model.system, model.loads.stages[0].motion->boundary).width;
        EXPECT_NEAR(width, (0.02 - 0.0003) / 0.2, off + 1e-12);
    }
}

// The floor reaches 0.65 m behind the side that is pushed, whichever way it faces.
TEST(StageLoads, ABodyWithoutABoundaryAcrossIsAsLongAsItReachesBehindThePlaten) {
    for (const double turned : {0.0, 30.0, 90.0, 180.0, 270.0}) {
        const Model model = pushed_block(turned);
        EXPECT_NEAR(distance_across(model.system, model.loads.stages[0].motion->boundary), 0.65, 1e-12) << turned;
    }
}

TEST(StageLoads, APlatenOnAPartOfTheBodyHasAnAxialStressOfTheWholeWidth) {
    const auto warnings = [](const char* width) {
        return build_scene_model(read_scene_text(fmt::format(R"(
kluft: 1
materials: {{rock: {{youngs_modulus: 1 GPa, poissons_ratio: 0.2, density: 2600}}}}
interfaces: {{joint: {{kind: fracture, normal_stiffness: 1e10, shear_stiffness: 1e10, friction_angle: 30}}}}
geometry:
  blocks:
    - {{name: ground, polygon: [[0, 0], [16, 0], [16, 8], [0, 8]]}}
    - {{name: footing, polygon: [[0, 8], [{0}, 8], [{0}, 9], [0, 9]]}}
  blocks_interface: joint
boundaries:
  bottom: {{block: ground, sides: [0], support: fixed}}
  right: {{block: ground, sides: [1], support: smooth}}
  left: {{block: ground, sides: [3], support: smooth}}
  footing: {{block: footing, sides: [2]}}
stages: [{{stress: {{boundary: footing, value: 1 MPa}}}}]
)",
                                                             width)))
            .model.warnings;
    };
    EXPECT_THAT(warnings("2"), testing::ElementsAre(
                                   testing::HasSubstr("16 m, and not over its own 2 m, on which it presses 8 times")));
    EXPECT_THAT(warnings("16"), testing::IsEmpty());
}

/// A specimen with a platen on its top, whose other sides have these boundaries and supports.
void build_pressed(const std::string& boundaries, const std::string& more = "") {
    (void)build_scene_model(read_scene_text(fmt::format(R"(
kluft: 1
materials: {{rock: {{density: 2500, youngs_modulus: 5 GPa, poissons_ratio: 0.25}}}}
geometry: {{domain: {{polygon: [[0, 0], [1, 0], [1, 2], [0, 2]]}}}}
boundaries: {{t: {{facing: top}}{}}}
stages: [{{strain: {{boundary: t, value: 0.1 %}}}}]
{}
)",
                                                        boundaries, more)));
}

/// A box of two blocks, the upper left half of which is pushed: both halves of its right side face the platen. `sides`: boundaries in
/// the order of the scene, `motion`: more of the platen's; turned by so many degrees about the origin.
Model shear_box(const std::string& sides, const std::string& motion, double turned) {
    const Eigen::Rotation2Dd turn(turned * std::numbers::pi / 180.0);
    const auto text = [&](std::initializer_list<Vec2> points) {
        std::string joined;
        for (const Vec2& point : points) {
            const Vec2 at = turn * point;
            joined += fmt::format("{}[{:.12g}, {:.12g}]", joined.empty() ? "" : ", ", at.x(), at.y());
        }
        return "[" + joined + "]";
    };
    return build_scene_model(read_scene_text(fmt::format(R"(
kluft: 1
materials: {{rock: {{youngs_modulus: 20 GPa, poissons_ratio: 0.25}}}}
interfaces: {{joint: {{kind: fracture, normal_stiffness: 2e10, shear_stiffness: 1e10, friction_angle: 30}}}}
geometry:
  domain: {{polygon: {}}}
  reference_spacing: 1
  fractures: [{{name: plane, trace: {}, interface: joint}}]
boundaries: {{bottom: {{sides: [0], support: fixed}}, {}, top: {{sides: [3]}}, pushed: {{sides: [4]}}}}
stages: [{{displacement: {{boundary: pushed, value: 2 mm{}}}}}]
)",
                                                         text({{0, 0}, {4, 0}, {4, 1}, {4, 2}, {0, 2}, {0, 1}}),
                                                         text({{-1, 1}, {5, 1}}), sides, motion)))
        .model;
}

// By the rounding of the turned coordinates the platen lay on the one or the other of them.
TEST(StageLoads, AFixedPlatenLiesOnTheFirstOfSeveralThatFaceTheMovedOne) {
    const std::string low = "low: {sides: [1]}";
    const std::string high = "high: {sides: [2]}";
    for (const double turned : {0.0, 10.0, 20.0, 30.0, 53.0, 60.0, 135.0, 180.0, 200.0}) {
        for (const bool low_first : {true, false}) {
            const std::string sides = low_first ? fmt::format("{}, {}", low, high) : fmt::format("{}, {}", high, low);
            const Model model = shear_box(sides, "", turned);
            const PlatenMotion& motion = *model.loads.stages[0].motion;
            EXPECT_EQ(model.system.boundaries[resting_boundary(model.system, motion)].name, low_first ? "low" : "high")
                << turned;
            EXPECT_THAT(model.warnings,
                        Contains(AllOf(HasSubstr("the platen on 'pushed' presses the body against a fixed platen on"),
                                       HasSubstr("the first of those that face it most"))));
        }
    }
}

TEST(StageLoads, TheSceneSaysWhatRestsOnAFixedPlaten) {
    const std::string sides = "high: {sides: [2]}, low: {sides: [1]}";
    const auto resting = [&](const std::string& motion) {
        const Model model = shear_box(sides, motion, 0.0);
        EXPECT_THAT(model.warnings, Not(Contains(HasSubstr("presses the body against"))));
        return resting_boundary(model.system, *model.loads.stages[0].motion);
    };
    EXPECT_EQ(resting(", against: none"), -1);
    EXPECT_EQ(resting(", against: low"), 2);
    for (const char* wrong : {"pushed", "lwo"})
        EXPECT_THROW((void)shear_box(sides, fmt::format(", against: {}", wrong), 0.0), InputError) << wrong;
    const auto print_of = [&](const std::string& motion) { return fingerprint(shear_box(sides, motion, 0.0)); };
    EXPECT_NE(print_of(", against: low"), print_of(", against: none")); // a run goes on with its own only
}

// What a platen braces that was only named carried 276 MN/m of a dam's thrust in place of 0.907.
TEST(StageLoads, AFixedPlatenBesideSupportsThatHoldTheBodyIsToldOf) {
    const auto warnings = [](const std::string& more) {
        return build_scene_model(read_scene_text(fmt::format(R"(
kluft: 1
analysis: {{gravity: 9.81}}
materials: {{rock: {{density: 2400, youngs_modulus: 20 GPa, poissons_ratio: 0.25}}}}
interfaces: {{base: {{kind: fracture, normal_stiffness: 2e10, shear_stiffness: 1e10, friction_angle: 35}}}}
geometry:
  domain: {{polygon: [[0, 0], [30, 0], [30, 5], [18, 5], [13, 15], [10, 15], [10, 5], [0, 5]]}}
  reference_spacing: 5
  fractures: [{{name: plane, trace: [[9, 5], [19, 5]], interface: base}}]
boundaries: {{ground: {{sides: [0], support: fixed}}, upstream: {{sides: [5]}}{}}}
stages: [{{name: push, displacement: {{boundary: upstream, value: 5 mm}}}}]
)",
                                                             more)))
            .model.warnings;
    };
    EXPECT_THAT(warnings(", downstream: {sides: [3]}"),
                Contains(AllOf(HasSubstr("a fixed platen on 'downstream', turned against it by 26.6 degrees"),
                               HasSubstr("beside supports that hold the body there already"))));
    EXPECT_THAT(warnings(""), Not(Contains(HasSubstr("a fixed platen on"))));
}

// Without anything against it the platen carries the body along, and a strain is told of a body without a stress.
TEST(StageLoads, PlatenHasSomethingToPressAgainst) {
    for (const char* with : {"", ", l: {facing: left, support: smooth}, r: {facing: right, support: smooth}"}) {
        try {
            build_pressed(with);
            ADD_FAILURE() << with;
        } catch (const InputError& error) {
            EXPECT_THAT(error.what(), testing::HasSubstr("expected a boundary opposite to 't', a support or a fixed"));
        }
    }
    for (const char* with : {", b: {facing: bottom}", ", b: {facing: bottom, support: fixed}"})
        EXPECT_NO_THROW(build_pressed(with)) << with;
    EXPECT_NO_THROW(build_pressed("", "analysis: {gravity: 9.81}")); // a body on a jack
}

// ---- pressures -----------------------------------------------------------------------------------------------------

TEST(StageLoads, PressureGrowsLinearlyFromTheStartOfTheStageAndOthersKeepTheirs) {
    const Model model = model_of("{bottom: {support: smooth}}", "[{pressure: {left: 3 MPa, top: 0}}]");
    State state = initial_state(model);
    state.stage_start.boundary_pressure = {7e6, 2e6, 4e6, 1e6}; // at the bottom what its support carried
    const StageLoads loads = loads_of(model, state);
    EXPECT_EQ(loads.pressures(0.0), (std::vector<double>{0.0, 2e6, 4e6, 1e6}));
    EXPECT_EQ(loads.pressures(0.25), (std::vector<double>{0.0, 2e6, 3e6, 1.5e6}));
    EXPECT_EQ(loads.pressures(1.0), (std::vector<double>{0.0, 2e6, 0.0, 3e6}));
    double length[4] = {};
    for (const PressureEdge& edge : loads.edges()) length[edge.boundary] += edge.extent.norm();
    EXPECT_NEAR(length[bottom], 0.0, 1e-12);
    EXPECT_NEAR(length[right], 2.0, 1e-12);
    EXPECT_NEAR(length[top], 1.0, 1e-12);
    EXPECT_NEAR(length[left], 2.0, 1e-12);
}

TEST(StageLoads, PlatenTakesThePressureOfItsBoundaryOver) {
    const Model model = model_of("{bottom: {support: smooth}}", "[{strain: {boundary: top, value: 1 %}}]");
    State state = initial_state(model);
    state.stage_start.boundary_pressure = {0.0, 2e6, 4e6, 2e6};
    const StageLoads loads = loads_of(model, state);
    for (const double factor : {0.0, 1.0}) {
        EXPECT_EQ(loads.pressures(factor), (std::vector<double>{0.0, 2e6, 0.0, 2e6}));
    }
}

TEST(StageLoads, APlatenThatIsGoneInTheNextStageIsToldOf) {
    const std::string first = "{strain: {boundary: top, value: 0.1 %}}";
    const auto warnings = [&](const std::string& next) {
        return model_of("{}", "[" + first + ", " + next + "]").warnings;
    };
    EXPECT_THAT(warnings("{pressure: {left: 1 MPa}}"),
                ElementsAre(HasSubstr("stage 1 has no platen on 'top' any more")));
    EXPECT_THAT(warnings("{pressure: {top: 1 MPa}}"), IsEmpty());
    EXPECT_THAT(warnings("{strain: {boundary: top, value: 0.2 %}}"), IsEmpty());
}

// Both sides of a V are turned by 45 degrees from its mean normal; one with a drop of 0.1 m on 1 m by 5.7 degrees.
TEST(StageLoads, ASmoothSupportOnSidesThatFaceApartIsToldOf) {
    const auto warnings = [](const char* tip) {
        return build_scene_model(read_scene_text(fmt::format(R"(
kluft: 1
materials: {{rock: {{youngs_modulus: 1 GPa, poissons_ratio: 0.2, density: 2600}}}}
interfaces: {{joint: {{kind: fracture, normal_stiffness: 1e10, shear_stiffness: 1e10, friction_angle: 30}}}}
geometry: {{domain: {{polygon: [[0, 0], [1, {}], [2, 0], [2, 3], [0, 3]]}}}}
boundaries: {{floor: {{sides: [0, 1], support: smooth}}, right: {{sides: [2], support: smooth}}}}
stages: [{{pressure: {{right: 0}}}}]
)",
                                                             tip)))
            .model.warnings;
    };
    EXPECT_THAT(warnings("-1"), Contains(AllOf(HasSubstr("'floor' holds its sides along"), HasSubstr("45 degrees"))));
    EXPECT_THAT(warnings("-0.1"), Not(Contains(HasSubstr("holds its sides along"))));
}

TEST(BoundaryFrame, OfAnUprightRectangleHasNormalsAlongTheAxes) {
    const Model model = model_of("{}", pressed);
    const Vec2 normals[] = {{0, -1}, {1, 0}, {0, 1}, {-1, 0}};
    const double lengths[] = {1.0, 2.0, 1.0, 2.0};
    const Vec2 middles[] = {{0.5, 0}, {1, 1}, {0.5, 2}, {0, 1}};
    for (int i = 0; i < 4; ++i) {
        const BoundaryFrame frame = boundary_frame(model.system, i);
        EXPECT_EQ(frame.normal, normals[i]);
        EXPECT_NEAR(frame.length, lengths[i], 1e-12);
        EXPECT_LT((mean_position(model.system, i) - middles[i]).norm(), 1e-12);
        EXPECT_EQ(opposite_boundary(model.system, i), (i + 2) % 4);
    }
    const auto sides = lateral_sides(model.system, top);
    ASSERT_EQ(sides[0].size(), 1U);
    ASSERT_EQ(sides[1].size(), 1U);
    EXPECT_EQ(sides[0][0].boundary, right);
    EXPECT_EQ(sides[1][0].boundary, left);
}

// A side in two boundaries is one side, in whatever order they stand.
TEST(BoundaryFrame, LateralSidesAreAllBoundariesThatFaceAcross) {
    const auto lateral_stress = [](const std::string& boundaries) {
        const SceneRun run = run_scene(R"(
kluft: 1
analysis: {plane: stress}
materials: {rock: {youngs_modulus: 1 GPa, poissons_ratio: 0.2}}
geometry: {domain: {polygon: [[0, 0], [1, 0], [1, 1], [1, 2], [0, 2], [0, 1]]}}
boundaries: )" + boundaries + R"(
stages:
  - {name: pressure, pressure: {low_right: 1 MPa, high_right: 3 MPa, low_left: 1 MPa, high_left: 3 MPa}}
  - {name: platen, strain: {boundary: top, value: 0.1 %}, steps: 2}
)");
        return run.history.back().lateral_stress;
    };
    const double expected = 2e6; // the mean of 1 and 3 MPa on halves of a side
    EXPECT_NEAR(lateral_stress(
                    "{bottom: {sides: [0], support: smooth}, low_right: {sides: [1]}, high_right: {sides: [2]}, top: "
                    "{sides: [3]}, high_left: {sides: [4]}, low_left: {sides: [5]}}"),
                expected, 2e-3 * expected);
    EXPECT_NEAR(
        lateral_stress("{high_left: {sides: [4]}, high_right: {sides: [2]}, low_left: {sides: [5]}, top: {sides: [3]}, "
                       "low_right: {sides: [1]}, bottom: {sides: [0], support: smooth}}"),
        expected, 2e-3 * expected);
}

/// A specimen between smooth platens whose sides are pressed alike, on a support of that kind.
std::vector<std::string> warnings_on(const std::string& support) {
    return build_scene_model(read_scene_text(R"(
kluft: 1
materials: {rock: {density: 2600, youngs_modulus: 1 GPa, poissons_ratio: 0.2}}
geometry: {domain: {rectangle: {width: 1, height: 2}}}
boundaries: {bottom: {support: )" + support + R"(}}
stages:
  - {name: cell, pressure: {left: 1 MPa, right: 1 MPa, top: 1 MPa}}
  - {name: axial, strain: {boundary: top, value: 0.1 %}}
)"))
        .model.warnings;
}

// By statics: smooth supports and platens have no force along their faces.
TEST(FreeBody, ASpecimenThatOnlyFrictionHoldsSidewaysIsWarnedOf) {
    EXPECT_THAT(warnings_on("smooth"), testing::Contains(testing::HasSubstr(
                                           "nothing but friction holds the body along (1, 0) in stage cell")));
    const auto none = testing::Not(testing::Contains(testing::HasSubstr("nothing but friction")));
    EXPECT_THAT(warnings_on("pinned"), none);
    EXPECT_THAT(warnings_on("fixed"), none);
}

// A block that is pushed along a joint under its lid has no lateral stress, and needs none.
TEST(BoundaryFrame, ThePressureOnTheLidOfAShearBoxIsNotWarnedOf) {
    const auto warnings = build_scene_model(read_scene_text(R"(
kluft: 1
materials: {rock: {youngs_modulus: 30 GPa, poissons_ratio: 0.25}}
interfaces: {joint: {kind: fracture, normal_stiffness: 20 GPa/m, shear_stiffness: 10 GPa/m, friction_angle: 32 deg}}
geometry:
  reference_spacing: 0.1 m
  blocks:
    - {name: lower, polygon: [[0, 0], [0.3, 0], [0.3, 0.1], [0, 0.1]], support: fixed}
    - {name: upper, polygon: [[0, 0.1], [0.3, 0.1], [0.3, 0.2], [0, 0.2]]}
boundaries: {lid: {block: upper, facing: top}, push: {block: upper, facing: left}}
stages:
  - {name: normal load, pressure: {lid: 1 MPa}}
  - {name: shear, displacement: {boundary: push, value: 5 mm, against: none}, steps: 50}
)"))
                              .model.warnings;
    EXPECT_THAT(warnings, testing::Not(testing::Contains(testing::HasSubstr("lateral stress"))));
}

TEST(BoundaryFrame, APressureOnNoSideOfItsOwnIsWarnedOf) {
    const SceneRun run = run_scene(R"(
kluft: 1
analysis: {plane: stress}
materials: {rock: {youngs_modulus: 1 GPa, poissons_ratio: 0.2}}
geometry: {domain: {polygon: [[0, 0], [1, 0], [1, 2], [0, 2]]}}
boundaries: {bottom: {sides: [0], support: pinned}, mantle: {sides: [1, 3]}, top: {sides: [2]}}
stages:
  - {name: pressure, pressure: {mantle: 1 MPa}}
  - {name: platen, strain: {boundary: top, value: 0.1 %}, steps: 2}
)");
    EXPECT_THAT(run.model.warnings,
                testing::Contains(testing::HasSubstr("the pressure on 'mantle' is in no lateral stress")));
}

// ---- what a run reaches --------------------------------------------------------------------------------------------

/// Pressure all around, then a platen; every step balanced.
SceneRun run_with(const std::string& motion, int steps) {
    return run_scene(
        scene_with("{bottom: {support: smooth}}",
                   fmt::format("[{{pressure: {{left: 1 MPa, right: 1 MPa, top: 1 MPa}}, steps: 2}}, {{{}, steps: {}}}]",
                               motion, steps)));
}

TEST(StageLoads, StrainReachesItsTargetAtTheLastStepCountedFromTheStartOfTheStage) {
    const auto run = run_with("strain: {boundary: top, value: 0.4 %}", 4);
    ASSERT_EQ(run.report.status, RunStatus::done) << run.report.diagnosis;
    ASSERT_EQ(run.history.size(), 7U);
    for (int i = 0; i < 4; ++i) EXPECT_NEAR(run.history[3 + i].axial_strain, 1e-3 * (i + 1), 1e-14);
    // The platen starts from the stress of the pressure: 1 MPa, and it rises.
    EXPECT_NEAR(run.history[2].axial_stress, 1e6, 1e-3);
    for (int i = 3; i < 7; ++i) EXPECT_GT(run.history[i].axial_stress, run.history[i - 1].axial_stress + 0.5e6);
}

TEST(StageLoads, DisplacementReachesItsTargetAtTheLastStep) {
    const auto run = run_with("displacement: {boundary: top, value: 5 mm}", 5);
    ASSERT_EQ(run.report.status, RunStatus::done) << run.report.diagnosis;
    for (int i = 0; i < 5; ++i) EXPECT_NEAR(run.history[3 + i].axial_strain, 1e-3 * (i + 1) / 2.0, 1e-14);
}

TEST(StageLoads, StressRisesLinearlyFromThePressureToItsTargetAtTheLastStep) {
    const auto run = run_with("stress: {boundary: top, value: 5 MPa}", 4);
    ASSERT_EQ(run.report.status, RunStatus::done) << run.report.diagnosis;
    ASSERT_EQ(run.report.unbalanced_steps, 0);
    for (int i = 0; i < 4; ++i) {
        EXPECT_NEAR(run.history[3 + i].axial_stress, 2e6 + 1e6 * i, 1.0);
        EXPECT_NEAR(run.history[3 + i].lateral_stress, 1e6, 1e-6);
    }
}

// The platen under a stress and the one at the strain that it reaches are the same problem.
TEST(StageLoads, StressAndStrainOfAPlatenLeadToTheSameState) {
    const auto by_stress = run_with("stress: {boundary: top, value: 5 MPa}", 4);
    const double strain = by_stress.history.back().axial_strain;
    const auto by_strain = run_with(fmt::format("strain: {{boundary: top, value: {:.17g}}}", strain), 4);
    ASSERT_EQ(by_strain.report.status, RunStatus::done) << by_strain.report.diagnosis;
    EXPECT_NEAR(by_strain.history.back().axial_stress, 5e6, 10.0);
    EXPECT_NEAR(by_strain.history.back().lateral_strain, by_stress.history.back().lateral_strain, 1e-6 * strain);
}

} // namespace
} // namespace kluft
