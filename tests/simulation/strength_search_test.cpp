#include "kluft/simulation/strength_search.hpp"

#include <cmath>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "kluft/kinematics/affine.hpp"
#include "support/posed_run.hpp"
#include "support/scene_run.hpp"

namespace kluft {
namespace {

using posed::degree;
using posed::Workplace;

/// A block of friction angle 30 degrees on a plane of 20 degrees at the start of its reduction.
Workplace at_the_reduction(const StrengthReduction& reduction, int steps) {
    return Workplace(posed::block_on_a_plane(20.0 * degree, 30.0 * degree, reduction, steps));
}

void bring_up_the_weight(Workplace& work) {
    Step weight = work.take(1.0);
    ASSERT_FALSE(weight.failure.has_value());
    const Step kept = weight;
    commit(std::move(weight), {.last_of_stage = true}, work.state, work.journal);
    work.leave(kept);
}

// F = tan(phi)/tan(dip). From 1.2 to 2 in four steps the fifth-largest tried is known: the steps to 1.4 stand, that to 1.6
// fails; each halving of (1.4, 1.6) is one trial until the interval is F times the tolerance.
TEST(StrengthSearch, BlockOnAPlaneHasItsFactorOfSafetyAfterAKnownNumberOfTrials) {
    const StrengthReduction reduction{.from = 1.2, .to = 2.0, .tolerance = 1e-3, .interface_types = {}};
    Workplace work = at_the_reduction(reduction, 4);
    bring_up_the_weight(work);
    EXPECT_EQ(work.told.last.strength_factor, 1.2);
    const std::size_t rows_before = work.told.rows.size();
    const StageEnd end = find_strength_limit(work.bench(), work.state);
    const double factor = std::tan(30.0 * degree) / std::tan(20.0 * degree);
    ASSERT_TRUE(end.factor_of_safety.has_value());
    EXPECT_LE(*end.factor_of_safety, factor * (1.0 + 1e-6));
    EXPECT_GE(*end.factor_of_safety, factor * (1.0 - 1e-3));
    EXPECT_TRUE(end.failure.has_value());

    double low = 1.4, high = 1.6;
    std::size_t kept = 1; // of the regular steps
    while (high - low > 1e-3 * low) {
        const double middle = 0.5 * (low + high);
        if (middle <= factor) {
            low = middle;
            ++kept;
        } else {
            high = middle;
        }
    }
    EXPECT_EQ(work.told.rows.size() - rows_before, kept); // trials that failed left no row
    EXPECT_EQ(work.state.at.step_in_stage, 1);
    EXPECT_NEAR(*end.factor_of_safety, low, 1e-12);
    EXPECT_NEAR(work.told.last.strength_factor.value(), factor, 2e-3 * factor); // the last trial
}

TEST(StrengthSearch, SaysOfADoubtHowMuchItMatters) {
    EXPECT_EQ(doubt_in_words("a corner holds block 7", 2.2, 2.1),
              "a corner holds block 7: the factor of safety is lower without that; 2.1 is the factor of the last load "
              "step before");
    EXPECT_EQ(doubt_in_words("a corner holds block 7", 2.13684, 2.13656),
              "a corner holds block 7: without that the factor of safety is the same to four digits");
}

TEST(StrengthSearch, SaysThatTheFactorIsAboveTheLargestTried) {
    const StrengthReduction reduction{.from = 1.0, .to = 1.4, .tolerance = 1e-3, .interface_types = {}};
    Workplace work = at_the_reduction(reduction, 2);
    bring_up_the_weight(work);
    const StageEnd end = find_strength_limit(work.bench(), work.state);
    EXPECT_FALSE(end.failure.has_value());
    EXPECT_FALSE(end.factor_of_safety.has_value());
    ASSERT_EQ(work.journal.report().warnings.size(), 1U);
    EXPECT_NE(work.journal.report().warnings.front().find("above 1.4"), std::string::npos);
    EXPECT_EQ(work.state.at.load_factor, 1.0);
}

// F = 1.586 is what the plane carries. At 1.6 the block slides with 0.9 % of its shear: with a balance of a tenth the stage
// of the weight lets that pass, and the reduction looks closer.
TEST(StrengthSearch, FailsWhereTheStateBeforeItDoesNotStand) {
    const StrengthReduction reduction{.from = 1.6, .to = 2.0, .tolerance = 1e-3, .interface_types = {}};
    SolverOptions loose;
    loose.balance = 0.1;
    Workplace work(posed::block_on_a_plane(20.0 * degree, 30.0 * degree, reduction, 2), loose);
    bring_up_the_weight(work);
    const StageEnd end = find_strength_limit(work.bench(), work.state);
    EXPECT_TRUE(end.failure.has_value());
    EXPECT_FALSE(end.factor_of_safety.has_value());
    EXPECT_EQ(work.state.at.step_in_stage, 0);
}

/// A block on a plane of 35 degrees with a friction angle of 40, 0.3 m above a ledge that it can come to rest on.
SceneRun block_above_a_ledge(int steps) {
    return run_scene(read_scene_text(R"(kluft: 1
analysis: {gravity: [-5.735764364, -8.191520443]}
materials: {rock: {density: 2600, youngs_modulus: 20 GPa, poissons_ratio: 0.25}}
interfaces: {joint: {kind: fracture, normal_stiffness: 10 GPa/m, shear_stiffness: 5 GPa/m, friction_angle: 40}}
geometry:
  blocks:
    - {name: base, polygon: [[-10, -5], [30, -5], [30, 0], [0, 0], [-0.3, 0], [-0.3, 2], [-10, 2]], support: fixed}
    - {name: slab, polygon: [[0, 0], [10, 0], [10, 4], [0, 4]]}
stages: [{}, {strength_reduction: {from: 0.5, to: 3}}]
)",
                                     {fmt::format("stages.1.steps={}", steps)}, "ledge.yaml"));
}

// F = tan(phi)/tan(dip): what a block comes to rest on after a slide is not what held it.
TEST(StrengthSearch, BodyThatComesToRestElsewhereHasFailed) {
    for (const int steps : {1, 3, 10}) {
        const SceneRun run = block_above_a_ledge(steps);
        ASSERT_TRUE(run.report.results.factor_of_safety.has_value()) << steps;
        EXPECT_NEAR(*run.report.results.factor_of_safety, std::tan(40.0 * degree) / std::tan(35.0 * degree), 2e-4)
            << steps;
        EXPECT_NE(run.report.diagnosis.find("'slab'"), std::string::npos) << run.report.diagnosis;
    }
}

// What friction loses a wall of 0.3 MPa/m takes over: some 3 % of the block's size, in the end, without a jump.
TEST(StrengthSearch, SoftJointsThatGiveWayByMuchStand) {
    const SceneRun run = run_scene(read_scene_text(R"(kluft: 1
analysis: {gravity: [-5, -8.660254038]}
materials: {rock: {density: 2600, youngs_modulus: 20 GPa, poissons_ratio: 0.25}}
interfaces: {joint: {kind: fracture, normal_stiffness: 0.3 MPa/m, shear_stiffness: 1 MPa/m, friction_angle: 50}}
geometry:
  reference_spacing: 1
  blocks:
    - {name: corner, polygon: [[-1, -1], [1, -1], [1, 0], [0, 0], [0, 1], [-1, 1]], support: fixed}
    - {name: block, polygon: [[0, 0], [1, 0], [1, 1], [0, 1]]}
stages: [{}, {strength_reduction: {from: 1, to: 30}, steps: 1}]
)",
                                                   {}, "soft.yaml"));
    EXPECT_TRUE(stands(run)) << run.report.diagnosis;
    EXPECT_EQ(run.state.at.load_factor, 1.0);
    EXPECT_GT(relative_motion(run.model.system, run.state.body.displacement), 0.03);
}

TEST(StrengthSearch, AsksForAResidualWellBelowTheToleranceOfTheFactor) {
    StrengthReduction reduction;
    reduction.tolerance = 1e-4;
    SolverOptions solver;
    EXPECT_DOUBLE_EQ(reduction_tolerance(reduction, solver), 1e-6);
    solver.tolerance = 1e-8;
    EXPECT_DOUBLE_EQ(reduction_tolerance(reduction, solver), 1e-8);
}

} // namespace
} // namespace kluft
