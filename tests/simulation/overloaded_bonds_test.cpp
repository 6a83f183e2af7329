#include "kluft/simulation/overloaded_bonds.hpp"

#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/scene_run.hpp"

namespace kluft {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

class BondObserver : public StepObserver {
public:
    explicit BondObserver(BondWatch& watch) : watch_(watch) {}
    void step(const StepRecord& record, const State& state, const std::function<FieldRecord()>&, bool) override {
        watch_.step(record, state);
    }

private:
    BondWatch& watch_;
};

std::string warning_of(const std::string& text, const std::vector<std::string>& changes = {}) {
    const Scene scene = read_scene_text(text, changes);
    const Model model = build_scene_model(scene).model;
    State state = initial_state(model);
    BondWatch watch(model, scene.cracks.criterion);
    BondObserver observer(watch);
    const std::atomic<bool> stop{false};
    (void)run_simulation(model, scene.cracks, scene.solver, state, observer, stop);
    return watch.warning();
}

// A block of 1 m x 2 m, 2500 kg/m3, hangs on a bond of 20 kPa. Its weight tears it at g = 20 kPa/(2500 2) = 4 m/s2; its mean stress is
// half of what the bond carries.
const std::string hanging_block_scene = R"(kluft: 1
materials: {rock: {density: 2500, youngs_modulus: 10 GPa, poissons_ratio: 0.2}}
interfaces:
  bond: {kind: potential_crack, normal_stiffness: 50 GPa/m, shear_stiffness: 25 GPa/m, cohesion: 1 MPa, friction_angle: 30, tensile_strength: 20 kPa, fails_to: crack}
  crack: {kind: fracture, normal_stiffness: 50 GPa/m, shear_stiffness: 25 GPa/m, friction_angle: 30}
geometry:
  blocks_interface: bond
  blocks:
    - {name: roof, polygon: [[-1, 0], [2, 0], [2, 1], [-1, 1]], support: fixed}
    - {name: hanging, polygon: [[0, -2], [1, -2], [1, 0], [0, 0]]}
stages: [{gravity: 7.2, steps: 20}]
)";

// By hand: of c = 10 kPa and 40 degrees under 1 MPa 849.1 kPa of shear.
TEST(OverloadedBonds, LoadIsComparedWithWhatFrictionAndCohesionBearTogether) {
    constexpr double degree = 3.14159265358979323846 / 180.0;
    const Strength weak{10e3, 40.0 * degree, 5e3};
    EXPECT_NEAR(load_over_strength(-1e6, 860e3, weak), 1.0128, 1e-4);
    EXPECT_NEAR(load_over_strength(-1e6, -860e3, weak), 1.0128, 1e-4);
    EXPECT_NEAR(load_over_strength(4e3, 0.0, weak), 0.8, 1e-12);
    EXPECT_EQ(load_over_strength(1.0, 1.0, {0.0, 0.0, 0.0}), 0.0);
}

TEST(OverloadedBonds, OfGivenBlocksAreWarnedOf) {
    EXPECT_THAT(warning_of(hanging_block_scene),
                AllOf(HasSubstr("'roof'"), HasSubstr("'hanging'"), HasSubstr("carries 1.8 times"),
                      HasSubstr("0.036 MPa of tension"), HasSubstr("interface_traction")));
    EXPECT_THAT(warning_of(hanging_block_scene, {"stages.0.gravity=3.9"}), IsEmpty());
    EXPECT_THAT(warning_of(hanging_block_scene, {"cracks.criterion=interface_traction"}), IsEmpty());
}

// A bonded joint through a body without a net, sheared beside it: 4 MN/m on 1 m under 0.2 MPa, of c + p tan(30) = 1.1155 MPa.
const std::string sheared_trace_scene = R"(kluft: 1
materials: {rock: {density: 2500, youngs_modulus: 10 GPa, poissons_ratio: 0.2}}
interfaces:
  bond: {kind: potential_crack, normal_stiffness: 50 GPa/m, shear_stiffness: 25 GPa/m, cohesion: 1 MPa, friction_angle: 30, tensile_strength: 0.5 MPa, fails_to: crack}
  crack: {kind: fracture, normal_stiffness: 50 GPa/m, shear_stiffness: 25 GPa/m, friction_angle: 30}
geometry:
  domain: {polygon: [[-1, -1], [2, -1], [2, 0], [1, 0], [1, 1], [0, 1], [0, 0], [-1, 0]]}
  fractures: [{trace: [[0, 0], [1, 0]], interface: bond}]
boundaries: {top: {sides: [4]}, bottom: {sides: [0], support: fixed}}
stages:
  - {pressure: {top: 0.2 MPa}}
  - {forces: {push: {point: [0, 0.05], force: [4 MN/m, 0]}}, steps: 4}
)";

TEST(OverloadedBonds, OfATraceWithoutANetAreWarnedOf) {
    EXPECT_THAT(warning_of(sheared_trace_scene), AllOf(HasSubstr("at (0.5, 0)"), HasSubstr("carries 3.59 times"),
                                                       HasSubstr("4 MPa of shear"), HasSubstr("of pressure")));
    EXPECT_THAT(warning_of(sheared_trace_scene, {"stages.1.forces.push.force=[1 MN/m, 0]"}), IsEmpty());
}

// Cells of a net are chosen for mean stresses: its own bonds, and those of a trace through it, are none of this.
TEST(SlowOverloadedBonds, OfANetAreNone) {
    const std::vector<std::string> in_a_net = {
        "geometry.tessellation={triangles: {spacing: 0.25}, interface: bond}",
        "materials.rock={cohesion: 100 MPa, friction_angle: 30, tensile_strength: 100 MPa}"};
    EXPECT_THAT(warning_of(sheared_trace_scene, in_a_net), IsEmpty());
}

} // namespace
} // namespace kluft
