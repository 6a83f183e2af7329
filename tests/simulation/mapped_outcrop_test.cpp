// A real map: curved traces whose blocks have tips as thin as a hundredth of their length.
#include <algorithm>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "support/scene_run.hpp"

namespace kluft {
namespace {

/// The blocks that the traces close, without a net; the sides that face south are held, the others pressed.
SceneRun outcrop_with(const std::vector<std::string>& changes) {
    return run_scene(fmt::format(R"(
kluft: 1
materials: {{granite: {{density: 2650, youngs_modulus: 50 GPa, poissons_ratio: 0.25}}}}
interfaces: {{joint: {{kind: fracture, normal_stiffness: 20 GPa/m, shear_stiffness: 10 GPa/m, friction_angle: 35}}}}
geometry:
  domain: {{file: {0}/area.geojson}}
  reference_spacing: 1 m
  fractures: [{{name: trace, file: {0}/traces.geojson, interface: joint}}]
boundaries: {{bottom: {{support: fixed}}}}
stages: [{{pressure: {{left: 5 MPa, right: 5 MPa, top: 3 MPa}}, steps: 10}}]
)",
                                 std::string(KLUFT_MODELS_DIR) + "/data/outcrop-kb7"),
                     changes);
}

/// Over the largest entry of the stresses of all blocks.
double largest_difference(const std::vector<Mat2>& a, const std::vector<Mat2>& b) {
    double largest = 0.0;
    double difference = 0.0;
    for (std::size_t i = 0; i < a.size(); ++i) {
        largest = std::max(largest, a[i].cwiseAbs().maxCoeff());
        difference = std::max(difference, (a[i] - b[i]).cwiseAbs().maxCoeff());
    }
    return difference / largest;
}

// Nothing slides far and no bond breaks, so that only the paths of friction differ: 0.02 %.
TEST(SlowMappedOutcrop, HasStressesThatDoNotDependOnTheNumberOfLoadSteps) {
    const SceneRun few = outcrop_with({"stages.0.steps=10"});
    const SceneRun many = outcrop_with({"stages.0.steps=40"});
    ASSERT_TRUE(stands(few) && stands(many));
    EXPECT_LT(largest_difference(few.fields.back().stress, many.fields.back().stress), 1e-3);
}

TEST(SlowMappedOutcrop, StandsWithSoftJointsInEveryLoadStep) {
    EXPECT_TRUE(stands(
        outcrop_with({"interfaces.joint.normal_stiffness=1 GPa/m", "interfaces.joint.shear_stiffness=0.5 GPa/m"})));
}

} // namespace
} // namespace kluft
