#include "kluft/studies/trade_study.hpp"

#include <map>
#include <set>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <yaml-cpp/yaml.h>

#include "kluft/core/diagnostics.hpp"
#include "kluft/scene/scene_reader.hpp"

namespace kluft {
namespace {

using ::testing::Contains;
using ::testing::Not;

Scene triaxial_scene(const std::string& name, const std::vector<std::string>& overrides = {}) {
    return read_scene(std::string(KLUFT_SOURCE_DIR) + "/models/triaxial/" + name + ".yaml", overrides);
}

YAML::Node study_of(const Scene& scene, const std::vector<std::string>& quantities = {}) {
    return YAML::Load(trade_study("scene.yaml", scene, quantities));
}

YAML::Node variant_of(const YAML::Node& study, const std::string& name) {
    for (const auto& variant : study["variants"])
        if (variant["name"].as<std::string>() == name) return variant["vary"];
    return YAML::Node(YAML::NodeType::Undefined);
}

std::vector<std::string> values_of(const YAML::Node& vary, const std::string& key) {
    return vary[key].as<std::vector<std::string>>();
}

std::set<std::string> keys_of(const YAML::Node& study) {
    std::set<std::string> keys;
    for (const auto& variant : study["variants"])
        for (const auto& entry : variant["vary"]) keys.insert(entry.first.as<std::string>());
    return keys;
}

TEST(TradeStudy, CrossesStepCountsWithCrackUpdatesAndVariesTheRestOneAtATime) {
    const YAML::Node study = study_of(triaxial_scene("case-3-all"));
    const YAML::Node steps = variant_of(study, "steps");
    EXPECT_EQ(values_of(steps, "stages.1.steps"), (std::vector<std::string>{"25", "50", "100", "200", "400", "800"}));
    EXPECT_EQ(values_of(steps, "cracks.update"),
              (std::vector<std::string>{"all", "critical_first", "single", "event"}));
    for (const auto& variant : study["variants"]) {
        if (variant["name"].as<std::string>() == "steps") continue;
        int n_varied = 0;
        for (const auto& entry : variant["vary"]) n_varied += entry.second.size() > 1 ? 1 : 0;
        EXPECT_LE(n_varied, 1) << variant["name"];
    }
    EXPECT_EQ(values_of(variant_of(study, "residual tolerance"), "solver.tolerance"),
              (std::vector<std::string>{"1e-3", "1e-4", "1e-6", "1e-7"})); // 1e-5 is the scene's own
    EXPECT_EQ(values_of(variant_of(study, "triangle size"), "geometry.tessellation.triangles.spacing"),
              (std::vector<std::string>{"0.052", "0.08125"}));
    EXPECT_EQ(values_of(variant_of(study, "other triangles"), "geometry.tessellation.triangles.seed"),
              (std::vector<std::string>{"2", "3"}));
    const YAML::Node hexagons =
        study_of(triaxial_scene("case-3-all", {"geometry.tessellation.triangles=null",
                                               "geometry.tessellation.hexagons={spacing: 0.05, rotation: 20}"}));
    EXPECT_EQ(values_of(variant_of(hexagons, "hexagon size"), "geometry.tessellation.hexagons.spacing"),
              (std::vector<std::string>{"0.04", "0.0625"}));
    EXPECT_EQ(study["reference"]["case"]["variant"].as<std::string>(), "reference");
    EXPECT_EQ(study["along"].as<std::string>(), "stages.1.steps");
}

TEST(TradeStudy, GivesEveryVariantButTheOtherIntegratorAllNumericalSettings) {
    const YAML::Node study = study_of(triaxial_scene("case-3-all", {"stages.1.steps=60", "cracks.update=all"}));
    const YAML::Node own = variant_of(study, "own settings");
    ASSERT_TRUE(own.IsMap()); // 60 steps are none of those crossed
    EXPECT_EQ(values_of(own, "stages.1.steps"), std::vector<std::string>{"60"});
    for (const auto& variant : study["variants"]) {
        if (variant["name"].as<std::string>() == "explicit") continue;
        for (const auto& entry : own) EXPECT_TRUE(variant["vary"][entry.first.as<std::string>()]) << variant["name"];
    }
    const YAML::Node reference = variant_of(study, "reference");
    EXPECT_EQ(values_of(reference, "cracks.update"), std::vector<std::string>{"event"});
    EXPECT_EQ(values_of(reference, "stages.1.steps"), std::vector<std::string>{"800"});
}

TEST(TradeStudy, HasNoTwoCasesWithTheSameSettings) {
    std::set<std::map<std::string, std::string>> cases;
    for (const auto& variant : study_of(triaxial_scene("case-3-all"))["variants"]) {
        std::vector<std::map<std::string, std::string>> all{{}};
        for (const auto& entry : variant["vary"]) {
            std::vector<std::map<std::string, std::string>> longer;
            for (const auto& each : all)
                for (const auto& value : entry.second) {
                    longer.push_back(each);
                    longer.back()[entry.first.as<std::string>()] = value.as<std::string>();
                }
            all = longer;
        }
        for (const auto& each : all) EXPECT_TRUE(cases.insert(each).second) << variant["name"];
    }
    EXPECT_GT(cases.size(), 30U);
}

TEST(TradeStudy, VariesNothingThatTheSceneDoesNotHave) {
    const auto keys = keys_of(study_of(triaxial_scene("case-1"))); // fractures only: no bond, no hexagon
    EXPECT_THAT(keys, Not(Contains(::testing::StartsWith("cracks."))));
    EXPECT_THAT(keys, Not(Contains(::testing::StartsWith("geometry."))));
    EXPECT_THAT(keys, Not(Contains("analysis.kinematics")));
    EXPECT_THAT(keys, Contains("stages.1.steps"));
    EXPECT_THAT(keys, Contains("analysis.integrator"));
}

/// Messages of all variants that the scene's reader refuses, with the first value of each key.
std::vector<std::string> refusals_of(const std::string& name, const std::vector<std::string>& overrides) {
    std::vector<std::string> refusals;
    for (const auto& variant : study_of(triaxial_scene(name, overrides))["variants"]) {
        std::vector<std::string> all = overrides;
        for (const auto& entry : variant["vary"])
            all.push_back(entry.first.as<std::string>() + "=" + entry.second[0].as<std::string>());
        try {
            (void)triaxial_scene(name, all);
        } catch (const InputError& error) {
            refusals.push_back(variant["name"].as<std::string>() + ": " + error.what());
        }
    }
    return refusals;
}

TEST(TradeStudy, HasNoVariantThatTheSceneRefuses) {
    using Words = std::vector<std::string>;
    EXPECT_EQ(refusals_of("case-3-all", {}), Words{});
    EXPECT_EQ(refusals_of("case-3-all", {"solver.detection_every=2", "solver.accuracy=0.03"}), Words{});
    EXPECT_EQ(refusals_of("case-3-all", {"analysis.integrator=explicit", "analysis.damping=0.7",
                                         "analysis.loading_rate=0.1", "analysis.crack_check_interval=5"}),
              Words{});
    EXPECT_EQ(refusals_of("case-3-all", {"analysis.kinematics=rigid"}), Words{});
    EXPECT_EQ(refusals_of("case-1", {}), Words{});
}

TEST(TradeStudy, OfAnAccuracyHoldsItInItsOwnVariantOnly) {
    const YAML::Node study = study_of(triaxial_scene("case-3-all", {"solver.accuracy=0.03"}));
    for (const auto& variant : study["variants"]) {
        const auto values = values_of(variant["vary"], "solver.accuracy");
        if (variant["name"].as<std::string>() == "accuracy")
            EXPECT_EQ(values, (std::vector<std::string>{"0.03", "0.05", "0.02", "0.01"}));
        else
            EXPECT_EQ(values, std::vector<std::string>{"null"}) << variant["name"];
    }
}

TEST(TradeStudy, ComparesTheQuantitiesAskedForAndRefusesASceneWithoutAny) {
    const Scene scene = triaxial_scene("case-3-all");
    EXPECT_EQ(study_of(scene, {"peak_strain"})["quantities"].as<std::vector<std::string>>(),
              std::vector<std::string>{"peak_strain"});
    Scene still = scene;
    for (Stage& stage : still.loads.stages) stage.motion.reset();
    EXPECT_THROW((void)trade_study("scene.yaml", still), InputError);
}

TEST(TradeStudy, IsYamlWhateverTheTitleHolds) {
    Scene scene = triaxial_scene("case-3-all");
    scene.title = "a \"quoted\" \\ title: # with all";
    EXPECT_EQ(study_of(scene)["title"].as<std::string>(), "Trade of accuracy against time: " + scene.title);
}

TEST(TradeStudy, OfASceneWithoutATitleHasItsName) {
    Scene scene = triaxial_scene("case-3-all");
    scene.title.clear();
    EXPECT_EQ(study_of(scene)["title"].as<std::string>(), "Trade of accuracy against time: case-3-all");
}

} // namespace
} // namespace kluft
