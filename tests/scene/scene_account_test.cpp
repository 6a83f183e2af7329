// What `kluft check` says of how a body was cut.
#include "kluft/scene/scene_account.hpp"

#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "kluft/scene/scene_model.hpp"
#include "kluft/scene/scene_reader.hpp"

namespace kluft {
namespace {

using ::testing::HasSubstr;

// Two joints cross 0.1 m behind a free side: between them and the side lie 0.01 m2, below 2 % of a hexagon of 1 m.
TEST(SceneAccount, NamesWhatIsTakenOffAFreeSurface) {
    const Scene scene = read_scene_text(R"(kluft: 1
analysis: {gravity: 9.81}
materials: {rock: {density: 2500, youngs_modulus: 10 GPa, poissons_ratio: 0.2}}
interfaces: {joint: {kind: fracture, friction_angle: 30, normal_stiffness: 10 GPa/m, shear_stiffness: 5 GPa/m}}
geometry:
  domain: {polygon: [[0, 0], [2, 0], [2, 2], [0, 2]]}
  reference_spacing: 1
  minimum_area: 0.02
  fractures:
    - {trace: [[0.9, 0], [2.7, 1.8]], interface: joint}
    - {trace: [[0.9, 2], [2.7, 0.2]], interface: joint}
boundaries: {base: {sides: [0], support: fixed}}
stages: [{name: weight}]
)",
                                        {});
    const SceneModel built = build_scene_model(scene);
    const SceneAccount account = account_of(scene, built);
    EXPECT_THAT(text_of(account), HasSubstr("taken off the surface 0.01 m2 at (1.96667, 1)"));
    const auto json = nlohmann::json::parse(json_of(account, scene, built));
    ASSERT_EQ(json["taken_off"].size(), 1U);
    EXPECT_NEAR(json["taken_off"][0]["area"].get<double>(), 0.01, 1e-9);
    EXPECT_TRUE(json["merged"].empty());
}

} // namespace
} // namespace kluft
