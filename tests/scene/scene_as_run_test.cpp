#include "kluft/scene/scene_as_run.hpp"

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <regex>
#include <string>
#include <system_error>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "scene/scene_text.hpp"

namespace kluft {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

/// With a directory for files.
class SceneAsRun : public ::testing::Test {
protected:
    SceneAsRun() {
        std::string name = (fs::temp_directory_path() / "kluft-scene-XXXXXX").string();
        if (mkdtemp(name.data()) == nullptr) throw fs::filesystem_error("mkdtemp", std::error_code());
        directory_ = name;
    }
    ~SceneAsRun() override {
        std::error_code ignored;
        fs::remove_all(directory_, ignored);
    }
    [[nodiscard]] fs::path path(const std::string& name) const { return directory_ / name; }
    void write(const std::string& name, const std::string& text) const { std::ofstream(path(name)) << text; }

private:
    fs::path directory_;
};

/// What differs of a scene from the scene as run of another one.
std::string what_differs(const Scene& earlier, const Scene& scene) {
    return scene_difference(write_scene_as_run(earlier), scene);
}

std::string with_pattern_replaced(const std::string& text, const std::string& pattern, const std::string& by) {
    return std::regex_replace(text, std::regex(pattern), by);
}

TEST_F(SceneAsRun, ReadsAsTheSameSceneAndIsThenWrittenTheSame) {
    for (const char* name : {"triaxial/case-4", "triaxial/case-6-all", "outcrop-kb7", "quickstart"}) {
        const Scene scene =
            read_scene(KLUFT_SOURCE_DIR "/models/" + std::string(name) + ".yaml", {"stages.0.steps=17"});
        const std::string text = write_scene_as_run(scene);
        EXPECT_TRUE(is_scene_as_run(text));
        EXPECT_FALSE(is_scene_as_run(scene.text));
        const Scene again = read_scene_text(text, {}, path("scene.yaml"));
        EXPECT_EQ(again.loads.stages[0].steps, 17);
        EXPECT_EQ(again.text, scene.text);
        EXPECT_EQ(write_scene_as_run(again), text);
        EXPECT_EQ(what_differs(scene, again), "");
        EXPECT_EQ(what_differs(again, scene), "");
        EXPECT_EQ(scene_difference(scene.text, again), "");
    }
}

TEST_F(SceneAsRun, KeepsUnitsAsTheyWereWrittenAndGivesEachStageALine) {
    const std::string text = write_scene_as_run(read_scene_text(test::full_scene));
    EXPECT_THAT(text, AllOf(HasSubstr("\n    youngs_modulus: 25 GPa\n"), HasSubstr("\nstages:\n  - {"),
                            Not(HasSubstr("solver.accuracy"))));
}

TEST_F(SceneAsRun, CountsValuesAndNeitherCommentsNorTheOrderOfKeys) {
    const std::string text = "kluft: 1\n" + with_pattern_replaced(test::full_scene, "kluft: 1\n", "# the same\n\n");
    const std::string reordered =
        with_pattern_replaced(text, "(    friction_angle: 25)\n    cohesion: 10 kPa", "    cohesion: '10 kPa'\n$1");
    const Scene scene = read_scene_text(test::full_scene);
    EXPECT_EQ(what_differs(scene, read_scene_text(reordered)), "");
    EXPECT_EQ(what_differs(scene, read_scene_text(test::full_scene, {"materials.rock.density=2651 kg/m3"})),
              "materials.rock.density is '2650 kg/m3' there and '2651 kg/m3' here");
    const Scene plain = read_scene_text(test::short_scene);
    const Scene stress = read_scene_text(test::short_scene, {"analysis.plane=stress"});
    EXPECT_EQ(what_differs(plain, stress), "analysis.plane is absent there and 'stress' here");
    EXPECT_EQ(what_differs(stress, plain), "analysis.plane is 'stress' there and absent here");
}

TEST_F(SceneAsRun, OfARunThatGoesOnOnlyBodyLawsAndLoadsCount) {
    const Scene scene = read_scene_text(test::short_scene);
    for (const char* free : {"solver.tolerance=1e-6", "output.fields=false", "cracks.every=2"})
        EXPECT_EQ(body_difference(scene.text, read_scene_text(test::short_scene, {free})), "") << free;
    EXPECT_EQ(body_difference(scene.text,
                              read_scene_text(test::short_scene, {"solver.tolerance=1e-6", "analysis.plane=stress"})),
              "analysis.plane is absent there and 'stress' here");
    for (const char* of_body : {"cracks.strength_noise", "cracks.strength_seed"}) // the strengths of its bonds
        EXPECT_EQ(body_difference(scene.text, read_scene_text(test::short_scene, {std::string(of_body) + "=0"})),
                  std::string(of_body) + " is absent there and '0' here");
}

TEST_F(SceneAsRun, TakesItsTitleFromTheNameOfTheFileWhereThereIsNone) {
    const Scene untitled = read_scene_text(test::short_scene, {}, "slope.yaml");
    const std::string text = write_scene_as_run(untitled);
    EXPECT_EQ(read_scene_text(text).title, "slope");
    EXPECT_EQ(scene_difference(text, read_scene_text(test::short_scene, {}, "other.yaml")), "");
    EXPECT_EQ(scene_difference(text, read_scene_text(test::short_scene, {"title=Another"}, "slope.yaml")),
              "title is 'slope' there and 'Another' here");
}

TEST_F(SceneAsRun, CountsFilesByTheirContentWhereverTheyAre) {
    const std::string text = with_pattern_replaced(test::short_scene, "domain: .*", "domain: {file: area.geojson}");
    const auto area = [](double width) {
        return R"({"type": "Polygon", "coordinates": [[[0, 0], [)" + std::to_string(width) +
               R"(, 0], [2, 2], [0, 2], [0, 0]]]})";
    };
    for (const char* place : {"a", "b"}) {
        fs::create_directory(path(place));
        write(std::string(place) + "/area.geojson", area(2.0));
        write(std::string(place) + "/scene.yaml", text);
    }
    const Scene scene = read_scene(path("a/scene.yaml"));
    const std::string as_run = write_scene_as_run(scene);
    EXPECT_THAT(as_run, HasSubstr(path("a/area.geojson").string()));
    EXPECT_EQ(scene_difference(as_run, read_scene(path("b/scene.yaml"))), "");
    write("b/area.geojson", area(2.5));
    EXPECT_EQ(scene_difference(as_run, read_scene(path("b/scene.yaml"))), "a file of the geometry has another content");
    fs::remove_all(path("a"));
    EXPECT_EQ(scene_difference(as_run, scene),
              "a file of the geometry has another content"); // it cannot be known any more
}

TEST_F(SceneAsRun, TellsThatItWasChangedByHand) {
    const Scene scene = read_scene_text(test::full_scene);
    const std::string changed = with_pattern_replaced(write_scene_as_run(scene), "25 GPa", "26 GPa");
    EXPECT_EQ(scene_difference(changed, read_scene_text(changed)), "scene.yaml has been changed since");
    EXPECT_EQ(scene_difference(with_pattern_replaced(changed, "# digest .*", "# digest"), scene),
              "materials.rock.youngs_modulus is '26 GPa' there and '25 GPa' here");
    EXPECT_NE(scene_difference("# no scene at all", scene), "");
    EXPECT_NE(scene_difference("{[", scene), "");
}

} // namespace
} // namespace kluft
