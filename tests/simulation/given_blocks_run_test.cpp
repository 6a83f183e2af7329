// Bodies put together from polygons, with fixed blocks, point forces, gravity that changes and histories; by equilibrium
// and by motion.
#include <cmath>
#include <map>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "kluft/core/diagnostics.hpp"
#include "kluft/simulation/fingerprint.hpp"
#include "support/scene_run.hpp"
#include "support/units.hpp"

namespace kluft {
namespace {

constexpr double gravity = 9.81;

/// The value of a column of histories.csv at a load step.
double followed(const SceneRun& run, const std::string& column, std::size_t step) {
    const auto columns = history_columns(run.model);
    const auto found = std::find(columns.begin(), columns.end(), column);
    EXPECT_NE(found, columns.end()) << column;
    return run.history.at(step).histories.at(static_cast<std::size_t>(found - columns.begin()));
}
double followed_last(const SceneRun& run, const std::string& column) {
    return followed(run, column, run.history.size() - 1);
}

void expect_fixed_blocks_at_rest(const SceneRun& run) {
    for (int b = 0; b < run.model.system.n_blocks(); ++b) {
        if (!run.model.system.blocks[b].fixed) continue;
        EXPECT_EQ(run.state.body.displacement.segment<n_block_unknowns>(n_block_unknowns * b).norm(), 0.0) << b;
    }
}

/// By both integrators, and how near each comes to a closed form.
struct Way {
    std::string name;
    std::vector<std::string> overrides;
    double tolerance = 0.0; ///< relative
};

class GivenBlocksRun : public testing::TestWithParam<Way> {
protected:
    static SceneRun run(const std::string& scene, std::vector<std::string> overrides = {}) {
        overrides.insert(overrides.end(), GetParam().overrides.begin(), GetParam().overrides.end());
        SceneRun result = run_scene(scene, overrides);
        EXPECT_EQ(result.report.status, RunStatus::done) << result.report.diagnosis;
        EXPECT_EQ(result.report.unbalanced_steps, 0);
        expect_fixed_blocks_at_rest(result);
        for (const StepRecord& record : result.history) {
            EXPECT_LT(std::abs(record.motion.value_or(MotionRecord{}).energy_error), 0.01) << record.step;
        }
        return result;
    }
    static double tolerance() { return GetParam().tolerance; }
};

INSTANTIATE_TEST_SUITE_P(
    BothIntegrators, GivenBlocksRun,
    testing::Values(Way{"Implicit", {"solver={tolerance: 1e-10, balance: 1e-9}"}, 1e-6},
                    Way{"Explicit", {"analysis.integrator=explicit", "solver={balance: 1e-4}"}, 1e-3}),
    [](const auto& way) { return way.param.name; });

const char* const stack = R"(
kluft: 1
analysis: {gravity: 9.81}
materials: {rock: {density: 2500, youngs_modulus: 10 GPa, poissons_ratio: 0.25}}
interfaces: {joint: {kind: fracture, normal_stiffness: 100 GPa/m, shear_stiffness: 50 GPa/m, friction_angle: 30,
                     contact_rounding: 0, friction_rounding: 0}}
geometry:
  blocks:
    - {name: base, polygon: [[-1, -1], [3, -1], [3, 0], [-1, 0]], support: fixed}
    - {name: lower, polygon: [[0, 0], [2, 0], [2, 1], [0, 1]]}
    - {name: middle, polygon: [[0.5, 1], [0.5, 1.5], [1.5, 1.5], [1.5, 1]]}
    - {name: upper, polygon: [[0, 1.5], [2, 1.5], [2, 2], [0, 2]]}
stages: [{name: weight}]
output:
  histories:
    foot: {interface: [base, lower]}
    waist: {interface: [lower, middle]}
    neck: {interface: [upper, middle]}
    head: {block: upper}
)";

TEST_P(GivenBlocksRun, ContactsOfAStackCarryTheWeightAbove) {
    const auto stacked = run(stack);
    const double weight = 2500 * gravity;
    EXPECT_NEAR(followed_last(stacked, "foot.normal_force"), 3.5 * weight, 3.5 * weight * tolerance());
    EXPECT_NEAR(followed_last(stacked, "waist.normal_force"), 1.5 * weight, 1.5 * weight * tolerance());
    EXPECT_NEAR(followed_last(stacked, "neck.normal_force"), weight, weight * tolerance());
    EXPECT_NEAR(followed_last(stacked, "waist.mean_normal_traction"), 1.5 * weight, 1.5 * weight * tolerance());
    EXPECT_NEAR(followed_last(stacked, "foot.shear_force"), 0.0, weight * tolerance());
    EXPECT_LT(followed_last(stacked, "neck.opening"), 0.0) << "a closed contact overlaps";
    EXPECT_LT(followed_last(stacked, "head.displacement_y"), 0.0);
    EXPECT_EQ(followed(stacked, "foot.normal_force", 0), 0.0);
}

/// A block on a slope of `angle` with a fixed base.
std::string incline(double angle, const std::string& rest) {
    const Vec2 along(std::cos(angle), std::sin(angle));
    const Vec2 up(-along.y(), along.x());
    const auto point = [](const Vec2& p) { return fmt::format("[{:.17g}, {:.17g}]", p.x(), p.y()); };
    return fmt::format(R"(
kluft: 1
materials: {{rock: {{density: 2500, youngs_modulus: 10 GPa, poissons_ratio: 0.25}}}}
interfaces: {{joint: {{kind: fracture, normal_stiffness: 1e12, shear_stiffness: 1e12, friction_angle: 30,
                     contact_rounding: 0, friction_rounding: 0}}}}
geometry:
  blocks:
    - {{name: slope, polygon: [[0, 0], {}, {}], support: fixed}}
    - {{name: block, polygon: [{}, {}, {}, {}]}}
output: {{histories: {{contact: {{interface: [slope, block]}}, reverse: {{interface: [block, slope]}}}}}}
)",
                       point({4 * along.x(), 0}), point(4 * along), point(along), point(2 * along),
                       point(2 * along + 0.4 * up), point(along + 0.4 * up)) +
           rest;
}

// N = W cos, T = W sin below the friction angle; the block leans to the left of the normal that points out of the slope.
TEST_P(GivenBlocksRun, BlockOnAnInclineIsHeldByItsNormalAndShearForce) {
    const double angle = 20 * degree;
    const auto held = run(incline(angle, "stages: [{name: weight, gravity: 9.81}]\n"));
    const double weight = 2500 * 0.4 * gravity;
    EXPECT_NEAR(followed_last(held, "contact.normal_force"), weight * std::cos(angle), weight * tolerance());
    EXPECT_NEAR(followed_last(held, "contact.shear_force"), weight * std::sin(angle), weight * tolerance());
    EXPECT_GT(followed_last(held, "contact.slip"), 0.0);
    for (const char* column : {"normal_force", "shear_force", "opening", "slip"})
        EXPECT_EQ(followed_last(held, fmt::format("contact.{}", column)),
                  followed_last(held, fmt::format("reverse.{}", column)));
}

// On the flat, with gravity that turns: the same forces as on the incline.
TEST_P(GivenBlocksRun, TiltingGravityIsAnIncline) {
    const double angle = 20 * degree;
    const auto tilted = run(
        incline(0.0, fmt::format("stages: [{{name: weight, gravity: 9.81}}, {{name: tilt, gravity: [{:.17g}, {:.17g}], "
                                 "steps: 2}}, {{name: stay}}]\n",
                                 gravity * std::sin(angle), -gravity * std::cos(angle))),
        {"geometry.blocks.0.polygon=[[0, 0], [0, -1], [4, -1], [4, 0]]"});
    const double weight = 2500 * 0.4 * gravity;
    ASSERT_EQ(tilted.history.size(), 5U);
    EXPECT_NEAR(followed(tilted, "contact.normal_force", 1), weight, weight * tolerance());
    EXPECT_NEAR(followed(tilted, "contact.shear_force", 2), -0.5 * weight * std::sin(angle), weight * tolerance());
    for (const std::size_t step : {3, 4}) {
        EXPECT_NEAR(followed(tilted, "contact.normal_force", step), weight * std::cos(angle), weight * tolerance());
        EXPECT_NEAR(followed(tilted, "contact.shear_force", step), -weight * std::sin(angle), weight * tolerance());
    }
}

const char* const column_scene = R"(
kluft: 1
materials: {rock: {youngs_modulus: 10 GPa, poissons_ratio: 0.25}}
interfaces: {joint: {kind: fracture, normal_stiffness: 1e12, shear_stiffness: 1e12, contact_rounding: 0}}
geometry:
  blocks:
    - {name: base, polygon: [[0, 0], [0, -1], [1.5, -1], [1.5, 0]], support: fixed}
    - {name: column, polygon: [[0.25, 0], [0.75, 0], [0.75, 3], [0.25, 3]]}
  sets: {all: {blocks: [column]}}
stages:
  - {name: press, forces: {weight: {block: all, point: [0.5, 3], force: [0, -1 kN/m]}}, steps: 2}
  - {name: more, forces: {weight: {force: [0, -4 kN/m]}, pull: {point: [0.5, 2], force: [0, 1 kN/m]}}}
  - {name: stay, forces: {pull: {force: [0, 0]}}}
output:
  histories:
    stress: {block: column}
    top: {point: [0.5, 3]}
    foot: {interface: [base, column]}
)";

// The mean stress of the column is P/A under a force on its top, and P y/(A H) under one at the height y
// (Love-Weber: the sum of f y over the area). Strains are below 1e-6. The top sinks by the strain and the foot's closure.
TEST_P(GivenBlocksRun, PointForcesMakeTheStressOfAColumn) {
    const auto pressed = run(column_scene);
    const double width = 0.5;
    ASSERT_EQ(pressed.history.size(), 5U);
    const double expected[] = {0.0, 500.0, 1000.0, 4000.0 - 1000.0 * 2.0 / 3.0, 4000.0};
    const double at_foot[] = {0.0, 500.0, 1000.0, 3000.0, 4000.0};
    for (std::size_t step = 0; step < 5; ++step) {
        EXPECT_NEAR(followed(pressed, "stress.stress_yy", step), expected[step] / width, 1e4 * tolerance()) << step;
        EXPECT_NEAR(followed(pressed, "stress.stress_xx", step), 0.0, 1e4 * tolerance()) << step;
        EXPECT_NEAR(followed(pressed, "foot.normal_force", step), at_foot[step], 1e4 * tolerance()) << step;
    }
    const double modulus = 10e9 / (1.0 - 0.25 * 0.25); // plane strain
    const double sunk = 4000.0 / width * (3.0 / modulus + 1e-12);
    EXPECT_NEAR(followed_last(pressed, "top.displacement_y"), -sunk, 10.0 * tolerance() * sunk);
    EXPECT_NEAR(followed_last(pressed, "top.rotation"), 0.0, 1e-3 * tolerance());
}

// Half of its own weight and all of that above: (12.5 + 25) kPa, whether the two cubes share an edge or are 10 nm apart.
TEST_P(GivenBlocksRun, TheUpperOfTwoCubesStandsOnTheLowerOneAcrossAGap) {
    for (const char* gap : {"0", "1e-8"}) {
        const auto stacked = run(fmt::format(R"(
kluft: 1
analysis: {{gravity: 10}}
materials: {{rock: {{density: 2500, youngs_modulus: 10 GPa, poissons_ratio: 0.2}}}}
interfaces: {{joint: {{kind: fracture, normal_stiffness: 100 GPa/m, shear_stiffness: 50 GPa/m, friction_angle: 30,
                     contact_rounding: 0, friction_rounding: 0}}}}
geometry:
  blocks:
    - {{name: lower, polygon: [[0, 0], [1, 0], [1, 1], [0, 1]]}}
    - {{name: upper, polygon: [[0, {0:.9g}], [1, {0:.9g}], [1, 2], [0, 2]]}}
boundaries: {{bottom: {{support: smooth}}}}
stages: [{{name: weight}}]
output: {{histories: {{lower: {{block: lower}}, upper: {{block: upper}}}}}}
)",
                                             1.0 + std::stod(gap)));
        EXPECT_NEAR(followed_last(stacked, "lower.stress_yy"), 37.5e3, 37.5e3 * (tolerance() + 1e-7)) << gap;
        EXPECT_NEAR(followed_last(stacked, "upper.stress_yy"), 12.5e3, 37.5e3 * (tolerance() + 1e-7)) << gap;
    }
}

TEST_P(GivenBlocksRun, GravityInSeveralStagesEndsLikeGravityAtOnce) {
    const auto at_once = run(stack);
    const auto in_stages = run(stack, {"analysis.gravity=0", "stages=[{gravity: [0, -5], steps: 2}, {gravity: 9.81}]"});
    for (const char* name : {"foot.normal_force", "waist.normal_force", "neck.normal_force", "head.displacement_y"}) {
        const double value = followed_last(at_once, name);
        EXPECT_NEAR(followed_last(in_stages, name), value, 10.0 * tolerance() * std::abs(value)) << name;
    }
    const double weight = 3.5 * 2500;
    EXPECT_NEAR(followed(in_stages, "foot.normal_force", 1), 2.5 * weight, 10.0 * weight * tolerance());
    EXPECT_NEAR(followed(in_stages, "foot.normal_force", 2), 5.0 * weight, 10.0 * weight * tolerance());
}

// A roof stands on its corner: contact of a vertex against an edge that it does not split.
TEST_P(GivenBlocksRun, CornerOnASideCarriesTheWeight) {
    const auto standing = run(R"(
kluft: 1
analysis: {gravity: 9.81}
materials: {rock: {density: 2000, youngs_modulus: 10 GPa, poissons_ratio: 0.25}}
interfaces: {joint: {kind: fracture, normal_stiffness: 1e12, shear_stiffness: 1e12, contact_rounding: 0}}
geometry:
  blocks:
    - {name: base, polygon: [[-2, -1], [2, -1], [2, 0], [-2, 0]], support: fixed}
    - {name: left, polygon: [[-1.5, 0], [-0.5, 0], [-0.5, 2], [-1.5, 2]], support: fixed}
    - {name: right, polygon: [[0.5, 0], [1.5, 0], [1.5, 2], [0.5, 2]], support: fixed}
    - {name: roof, polygon: [[0, 0], [0.5, 1], [0.5, 1.5], [-0.5, 1.5], [-0.5, 1]]}
stages: [{name: weight}]
output: {histories: {corner: {interface: [base, roof]}}}
)");
    const double weight = 2000 * gravity;
    EXPECT_NEAR(followed_last(standing, "corner.normal_force"), weight, weight * std::max(1e-4, tolerance()));
}

// On a plane of 30 degrees with friction of 20 degrees: tan 20/tan 30 = 0.63. The coordinates are rounded to millimetres.
TEST(GivenBlocks, ABlockWhoseCornersMissThePlaneByLittleSlides) {
    const SceneRun slope = run_scene(R"(
kluft: 1
analysis: {gravity: 9.81}
materials: {rock: {density: 2500, youngs_modulus: 10 GPa, poissons_ratio: 0.2}}
interfaces: {joint: {kind: fracture, friction_angle: 20, normal_stiffness: 100 GPa/m, shear_stiffness: 50 GPa/m}}
geometry:
  reference_spacing: 1
  blocks:
    - {name: base, polygon: [[0, -1], [10, -1], [10, 5.774], [0, 0]]}
    - {name: a, polygon: [[4, 2.310], [5.732, 3.310], [5.232, 4.175], [3.5, 3.175]]}
boundaries: {bottom: {support: fixed}}
stages: [{name: weight}, {name: reduce, strength_reduction: {to: 3}, steps: 10}]
)");
    EXPECT_NE(slope.report.status, RunStatus::done);
    EXPECT_FALSE(slope.report.results.factor_of_safety.has_value());
}

TEST(Histories, FollowFracturesBondedOrNot) {
    const std::string scene = R"(
kluft: 1
materials: {rock: {youngs_modulus: 10 GPa, poissons_ratio: 0}}
interfaces:
  joint: {kind: fracture, normal_stiffness: 1e11, shear_stiffness: 1e11, contact_rounding: 0}
  bond: {kind: potential_crack, normal_stiffness: 1e11, shear_stiffness: 1e11, fails_to: joint, cohesion: 1e12,
         friction_angle: 30, tensile_strength: 1e12}
geometry:
  domain: {rectangle: {width: 1, height: 2}}
  reference_spacing: 1
  fractures: [{name: seam, trace: [[-1, 1], [2, 1]], interface: joint}]
boundaries: {bottom: {support: pinned}}
stages: [{name: press, pressure: {top: 1 MPa}}]
solver: {tolerance: 1e-10, balance: 1e-9}
output: {histories: {seam: {fracture: seam}, upper: {point: [0.5, 1.5]}}}
)";
    for (const char* kind : {"joint", "bond"}) {
        const auto run = run_scene(scene, {fmt::format("geometry.fractures.0.interface={}", kind)});
        ASSERT_EQ(run.report.status, RunStatus::done) << run.report.diagnosis;
        EXPECT_NEAR(followed_last(run, "seam.normal_force"), 1e6, 1e2) << kind;
        EXPECT_NEAR(followed_last(run, "seam.mean_normal_traction"), 1e6, 1e2) << kind;
        EXPECT_NEAR(followed_last(run, "seam.opening"), -1e6 / 1e11, 1e-8) << kind;
        EXPECT_NEAR(followed_last(run, "seam.slip"), 0.0, 1e-10) << kind;
        EXPECT_NEAR(followed_last(run, "upper.stress_yy"), 1e6, 1e3) << kind;
    }
}

TEST(PointForces, MustActOnABlock) {
    EXPECT_THROW((void)run_scene(column_scene, {"stages.0.forces.weight.point=[0.5, 3.1]"}), InputError);
    EXPECT_THROW((void)run_scene(column_scene, {"stages.1.forces.pull.point=[5, 5]"}), InputError);
    EXPECT_THROW((void)run_scene(column_scene, {"geometry.sets.all.blocks=[column, base]"}), InputError);
}

TEST(FixedBlocks, AreNotMovedByAPlaten) {
    EXPECT_THROW((void)run_scene(column_scene, {"stages=[{strain: {boundary: bottom, value: 1 %}}]"}), InputError);
}

TEST(Model, FixedBlocksForcesAndGravityBelongToTheFingerprint) {
    const auto print = [](const std::vector<std::string>& overrides) {
        return fingerprint(build_scene_model(read_scene_text(column_scene, overrides)).model);
    };
    const std::string plain = print({});
    EXPECT_EQ(plain, print({"output.histories=null"}));
    for (const char* change :
         {"geometry.blocks.1.support=fixed", "stages.0.forces.weight.point=[0.4, 3]",
          "stages.2.forces.pull.force=[0, 1]", "geometry.sets.base2={blocks: [column], support: fixed}"})
        EXPECT_NE(plain, print({change})) << change;
    const std::string heavy = "materials.rock.density=2000";
    EXPECT_NE(print({heavy}), print({heavy, "stages.1.gravity=1"}));
}

// 2 MN/m along a joint of 1 m under 1 MPa, of tan(40) = 0.839 MN/m: the upper block slides. The force's point lies on the joint; on
// the fixed block below it would push nothing.
TEST(GivenBlocks, ForceOnAJointActsOnTheBlockThatIsNotFixed) {
    const std::string scene = R"(kluft: 1
materials: {rock: {density: 2500, youngs_modulus: 10 GPa, poissons_ratio: 0.2}}
interfaces: {joint: {kind: fracture, normal_stiffness: 100 GPa/m, shear_stiffness: 50 GPa/m, friction_angle: 40}}
geometry:
  blocks_interface: joint
  blocks:
    - {name: lower, polygon: [[-1, -1], [2, -1], [2, 0], [-1, 0]], support: fixed}
    - {name: upper, polygon: [[0, 0], [1, 0], [1, 0.5], [0, 0.5]]}
boundaries: {top: {block: upper, facing: top}}
stages:
  - {pressure: {top: 1 MPa}}
  - {forces: {push: {point: [0, 0], force: [2 MN/m, 0]}}, steps: 10}
)";
    const SceneRun run = run_scene(scene);
    EXPECT_EQ(run.report.status, RunStatus::no_equilibrium);
    EXPECT_LT(run.history.back().load_factor, 0.43);
    EXPECT_THAT(run.model.warnings, testing::IsEmpty());
    const auto warnings_with = [&](const std::string& change) {
        return build_scene_model(
                   read_scene_text(scene, {"geometry.blocks.0.support=none",
                                           "boundaries.floor={block: lower, facing: bottom, support: fixed}", change}))
            .model.warnings;
    };
    EXPECT_THAT(warnings_with("stages.1.steps=1"),
                testing::ElementsAre(testing::AllOf(testing::HasSubstr("stages.1.forces.push"),
                                                    testing::HasSubstr("on a joint of blocks 'lower' and 'upper'"))));
    EXPECT_THAT(warnings_with("stages.1.forces.push.block=upper"), testing::IsEmpty());
}

} // namespace
} // namespace kluft
