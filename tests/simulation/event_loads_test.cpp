// The first crack of a body in tension comes where f reaches 1, whatever brings the load, the blocks' kinematics and the
// load steps.
#include <algorithm>
#include <cmath>
#include <string>
#include <tuple>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/scene_run.hpp"

namespace kluft {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr double strength = 1e6;         // tensile, Pa
constexpr double event_tolerance = 2e-2; // default of cracks.event_tolerance

/// A specimen of hexagons that hangs from its top or stands on its bottom, without its stages.
std::string specimen(const std::string& held) {
    return R"(
kluft: 1
materials: {rock: {density: 2500, youngs_modulus: 10 GPa, poissons_ratio: 0.15, cohesion: 5 MPa, friction_angle: 40, tensile_strength: 1 MPa}}
interfaces:
  crack: {kind: potential_crack, stiffness_ratio: 10, shear_ratio: 0.5, fails_to: joint}
  joint: {kind: fracture, stiffness_ratio: 10, shear_ratio: 0.5, friction_angle: 30}
geometry: {domain: {rectangle: {width: 0.4, height: 0.8}}, tessellation: {hexagons: {spacing: 0.1}, interface: crack}}
boundaries: {)" +
           held + ": {support: fixed}}\n";
}

struct Loading {
    std::string name;
    std::string held;
    std::string stages; ///< of a load that is several times what the body carries; the last one has {} steps
};

/// Lateral pressure stays while the body is pulled; gravity is that of a centrifuge.
const std::vector<Loading> loadings{
    {"pressure", "bottom", "stages: [{{pressure: {{top: -4 MPa}}, steps: {}}}]"},
    {"pressure_under_lateral_pressure", "bottom",
     "stages: [{{pressure: {{left: 0.5 MPa, right: 0.5 MPa}}}}, {{pressure: {{top: -4 MPa}}, steps: {}}}]"},
    {"gravity", "top", "stages: [{{gravity: 2000, steps: {}}}]"},
    {"forces", "bottom",
     "stages: [{{forces: {{a: {{point: [0.11, 0.74], force: [0, 6e5]}}, b: {{point: [0.29, 0.74], force: [0, 6e5]}}}}, "
     "steps: {}}}]"},
    {"strain_of_a_platen", "bottom", "stages: [{{strain: {{boundary: top, value: -4e-4, glued: true}}, steps: {}}}]"},
    {"stress_of_a_platen", "bottom", "stages: [{{stress: {{boundary: top, value: -4 MPa, glued: true}}, steps: {}}}]"},
};

/// Of a specimen that stands without friction and is pulled by 4 MPa, in all of its bonds alike: f grows by 4 per load factor.
std::vector<std::string> warnings_of_pull(int steps, const std::string& cracks) {
    return run_scene(specimen("bottom") + fmt::format("stages: [{{pressure: {{top: -4 MPa}}, steps: {}}}]\n", steps),
                     {"boundaries.bottom.support=pinned", "cracks=" + cracks})
        .report.warnings;
}

// In 20 steps f grows by 0.2 in each: the seventh one is checked at 1.4. In three steps the first one is checked at 4/3.
TEST(LateChecks, AreWarnedOfWithWhatStressesReachedBefore) {
    EXPECT_THAT(warnings_of_pull(20, "{every: 7}"),
                Contains(AllOf(HasSubstr("load step 7: stresses reach 1.4 times"), HasSubstr("cracks.every: 1"))));
    EXPECT_THAT(warnings_of_pull(3, "{update: all}"),
                Contains(AllOf(HasSubstr("load step 1: stresses reach 1.3 times"), HasSubstr("cracks.update: event"))));
}

TEST(LateChecks, AreNoneWhereEachEventIsFound) {
    const auto late = Contains(HasSubstr("stresses reach"));
    EXPECT_THAT(warnings_of_pull(20, "{every: 1}"), Not(late));
    EXPECT_THAT(warnings_of_pull(3, "{update: event}"), Not(late));
    EXPECT_THAT(warnings_of_pull(200, "{update: all}"), Not(late)) << "2 % beyond at most";
}

class FirstCrack : public ::testing::TestWithParam<std::tuple<Loading, std::string>> {
protected:
    [[nodiscard]] static SceneRun run(int steps) {
        const auto& [loading, kinematics] = GetParam();
        return run_scene(specimen(loading.held) + fmt::format(fmt::runtime(loading.stages), steps),
                         {"analysis.kinematics=" + kinematics});
    }
};

// f_t = -p3/sigma_t with the mean stress of the two blocks (docs/theory.md, failure index).
TEST_P(FirstCrack, ComesAtTheStrengthWhateverTheLoadStep) {
    for (const int steps : {1, 2, 4, 8, 40}) {
        const SceneRun pulled = run(steps);
        ASSERT_FALSE(pulled.cracks.empty()) << steps << " steps";
        const CrackRecord& first = pulled.cracks.front();
        EXPECT_EQ(first.mode, CrackMode::tension) << steps << " steps";
        EXPECT_GE(-first.p3, strength) << steps << " steps";
        EXPECT_LE(-first.p3, (1.0 + event_tolerance) * strength) << steps << " steps";
    }
}

std::string name_of(const ::testing::TestParamInfo<FirstCrack::ParamType>& info) {
    return std::get<0>(info.param).name + "_" + std::get<1>(info.param);
}

INSTANTIATE_TEST_SUITE_P(LoadsAndKinematics, FirstCrack,
                         ::testing::Combine(::testing::ValuesIn(loadings), ::testing::Values("affine", "rigid")),
                         name_of);

// The strength of a body that crack after crack takes apart; the expected value is that of 100 steps. A goal beyond the strength
// has no equilibrium, and the peak lies before it: motion to the goal at once, which passes over it, gave 12 % more in 2 steps.
TEST(SlowPeakStrength, IsThatOfSmallLoadStepsWhateverTheLoadStep) {
    const auto peak = [](int steps) {
        const SceneRun run = run_scene(fmt::format(R"(
kluft: 1
materials: {{r: {{density: 2500, youngs_modulus: 1 GPa, poissons_ratio: 0.2, cohesion: 0.1 MPa, friction_angle: 30,
                tensile_strength: 0.05 MPa}}}}
interfaces:
  j: {{kind: fracture, friction_angle: 30, normal_stiffness: 10 GPa/m, shear_stiffness: 5 GPa/m}}
  p: {{kind: potential_crack, fails_to: j, normal_stiffness: 10 GPa/m, shear_stiffness: 5 GPa/m}}
geometry: {{domain: {{rectangle: {{width: 1, height: 2}}}}, tessellation: {{hexagons: {{spacing: 0.4}}, interface: p}}}}
stages: [{{strain: {{boundary: top, value: 0.1 %}}, steps: {}}}]
)",
                                                   steps),
                                       {});
        double largest = 0.0;
        for (const StepRecord& row : run.equilibria) {
            if (row.axial_stress < 0.8 * largest) break; // the loose hexagons lock later, and carry more
            if (row.balanced) largest = std::max(largest, row.axial_stress);
        }
        return largest;
    };
    const double expected = peak(100);
    for (const int steps : {2, 3, 4, 5, 10, 40})
        EXPECT_NEAR(peak(steps), expected, 2e-3 * expected) << steps << " steps";
}

} // namespace
} // namespace kluft
