#include "kluft/scene/scene_writer.hpp"

#include <filesystem>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "scene/scene_text.hpp"

namespace kluft {
namespace {

/// The values that a change of the text would change.
void expect_same(const Scene& a, const Scene& b) {
    EXPECT_EQ(a.title, b.title);
    EXPECT_EQ(a.gravity_y, b.gravity_y);
    ASSERT_EQ(a.interface_types.size(), b.interface_types.size());
    for (std::size_t i = 0; i < a.interface_types.size(); ++i) {
        EXPECT_EQ(a.interface_types[i].name, b.interface_types[i].name);
        EXPECT_EQ(a.interface_types[i].friction_angle, b.interface_types[i].friction_angle);
        EXPECT_EQ(a.interface_types[i].normal_stiffness_times_spacing,
                  b.interface_types[i].normal_stiffness_times_spacing);
    }
    EXPECT_EQ(a.geometry.domain, b.geometry.domain);
    ASSERT_EQ(a.geometry.fractures.size(), b.geometry.fractures.size());
    for (std::size_t i = 0; i < a.geometry.fractures.size(); ++i) {
        EXPECT_EQ(a.geometry.fractures[i].points, b.geometry.fractures[i].points);
        EXPECT_EQ(a.geometry.fractures[i].name, b.geometry.fractures[i].name);
    }
    ASSERT_EQ(a.loads.stages.size(), b.loads.stages.size());
    for (std::size_t i = 0; i < a.loads.stages.size(); ++i) {
        EXPECT_EQ(a.loads.stages[i].name, b.loads.stages[i].name);
        EXPECT_EQ(a.loads.stages[i].pressure, b.loads.stages[i].pressure);
        EXPECT_EQ(a.loads.stages[i].steps, b.loads.stages[i].steps);
    }
    EXPECT_EQ(a.text, b.text);
}

TEST(SceneWriter, TheTextOfASceneReadsAsTheSameScene) {
    const Scene scene = read_scene_text(test::full_scene, {"stages.0.steps=17", "title=\"a: 'b' \\\"c\\\" # d ü\""});
    EXPECT_EQ(scene.title, "a: 'b' \"c\" # d ü");
    expect_same(scene, read_scene_text(scene.text));
}

TEST(SceneWriter, TrickyTextSurvives) {
    for (const char* name :
         {"null", "~",    "-",    "- a",  "---", "...", "% a", "a%", "[", "{a}", "&a",  "*a", "!a",
          "'",    "a #b", "a: b", "true", "012", "?",   "|",   ">",  "@", "`",   "1e5", "\\", "a,b"}) {
        const std::string quoted = std::string("stages.0.name='") + (name == std::string("'") ? "''" : name) + "'";
        const Scene scene = read_scene_text(test::short_scene, {quoted});
        EXPECT_EQ(scene.loads.stages[0].name, name);
        expect_same(scene, read_scene_text(scene.text));
    }
}

/// With its own extended scenes, overrides and relative files gone, the text may lie anywhere.
TEST(SceneWriter, TheTextOfAModelReadsAsTheSameSceneElsewhere) {
    for (const char* name : {"triaxial/case-4", "triaxial/case-6-all", "outcrop-kb7", "quickstart"}) {
        const Scene scene = read_scene(KLUFT_SOURCE_DIR "/models/" + std::string(name) + ".yaml");
        expect_same(scene, read_scene_text(scene.text, {}, "elsewhere/scene.yaml"));
    }
}

} // namespace
} // namespace kluft
