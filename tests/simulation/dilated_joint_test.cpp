// Joints that slip has forced open: what they have dilated by stays with them over any slip.
#include <cmath>
#include <string>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "kluft/core/units.hpp"
#include "kluft/simulation/state_fields.hpp"
#include "support/scene_run.hpp"

namespace kluft {
namespace {

/// A joint at half the height of a body of 1 m by 0.6 m under 1 MPa, whose upper half is pushed along it.
SceneRun direct_shear(double dilation_angle, double distance, int steps, const std::string& net) {
    return run_scene(fmt::format(R"(kluft: 1
analysis: {{plane: strain}}
materials: {{rock: {{youngs_modulus: 20 GPa, poissons_ratio: 0.2, cohesion: 1 GPa, friction_angle: 40, tensile_strength: 100 MPa}}}}
interfaces:
  joint: {{kind: fracture, friction_angle: 30, dilation_angle: {}, normal_stiffness: 1e11, shear_stiffness: 5e10}}
  bond: {{kind: potential_crack, fails_to: joint}}
geometry:
  domain: {{polygon: [[0, 0], [1, 0], [1, 0.3], [1, 0.6], [0, 0.6], [0, 0.3]]}}
  fractures: [{{name: J, trace: [[-0.1, 0.3], [1.1, 0.3]], interface: joint}}]
  {}
boundaries: {{bottom: {{sides: [0], support: fixed}}, top: {{sides: [3]}}, push: {{sides: [4]}}}}
stages:
  - {{pressure: {{top: 1 MPa}}, steps: 1}}
  - {{displacement: {{boundary: push, value: {}}}, steps: {}}}
output: {{histories: {{J: {{fracture: J}}}}}}
)",
                                 dilation_angle, net, distance, steps));
}

double column(const SceneRun& run, const std::string& name) {
    const std::vector<std::string> names = history_columns(run.model);
    const auto at = std::ranges::find(names, name);
    return at == names.end() ? std::nan("") : run.history.back().histories[at - names.begin()];
}

/// Closed form: the uplift is the slip less what is elastic of it, times tan psi, less what the pressure closes; the force
/// is that of Coulomb's law under 1 MPa on 1 m.
void expect_sawtooth(const SceneRun& run, double dilation_angle, double distance) {
    ASSERT_TRUE(stands(run)) << run.report.diagnosis;
    const double elastic_slip = std::tan(30.0 / degrees) * 1e6 / 5e10;
    const double closure = 1e6 / 1e11;
    const double uplift = (distance - elastic_slip) * std::tan(dilation_angle / degrees) - closure;
    EXPECT_NEAR(column(run, "J.opening"), uplift, 5e-3 * uplift);
    const double force = std::tan(30.0 / degrees) * 1e6;
    EXPECT_NEAR(std::abs(column(run, "J.shear_force")), force, 2e-3 * force);
}

// Far beyond the opening up to which contacts are kept, a tenth of the spacing.
TEST(DilatedJoint, StaysApartWhateverTheSpacing) {
    for (const char* net : {"", "reference_spacing: 0.3", "reference_spacing: 2"}) {
        SCOPED_TRACE(net);
        expect_sawtooth(direct_shear(20.0, 0.35, 100, net), 20.0, 0.35);
    }
}

// Cells of a net slide past the vertices of those on the other side.
TEST(SlowDilatedJoint, StaysApartWhereFacesMeetOthers) {
    expect_sawtooth(direct_shear(3.0, 0.12, 120, "tessellation: {triangles: {spacing: 0.1}, interface: bond}"), 3.0,
                    0.12);
}

TEST(SlowDilatedJoint, StaysApartWhereFacesMeetManyOthers) {
    expect_sawtooth(direct_shear(10.0, 0.06, 60, "tessellation: {triangles: {spacing: 0.05}, interface: bond}"), 10.0,
                    0.06);
}

} // namespace
} // namespace kluft
