#include "kluft/scene/scene_text.hpp"

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "scene/scene_text.hpp"

namespace kluft {
namespace {

using test::errors_in;
using test::errors_with;
using test::messages_of;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::StartsWith;

/// A directory of scene files that goes away with the test.
class SceneFiles : public testing::Test {
protected:
    void SetUp() override {
        std::string name = (std::filesystem::temp_directory_path() / "kluft-scene-XXXXXX").string();
        ASSERT_NE(mkdtemp(name.data()), nullptr);
        directory = name;
    }
    void TearDown() override { std::filesystem::remove_all(directory); }

    [[nodiscard]] std::string file(const std::string& name) const { return (directory / name).string(); }
    void write(const std::string& name, const std::string& text) const {
        std::filesystem::create_directories((directory / name).parent_path());
        std::ofstream(directory / name, std::ios::binary) << text;
    }
    [[nodiscard]] std::vector<std::string> errors(const std::string& name,
                                                  const std::vector<std::string>& overrides = {}) const {
        return messages_of([&] { return read_scene(file(name), overrides); });
    }

    std::filesystem::path directory;
};

TEST_F(SceneFiles, ASceneIsNamedAfterItsFile) {
    write("case-7.yaml", test::short_scene);
    EXPECT_EQ(read_scene(file("case-7.yaml")).name, "case-7");
}

TEST_F(SceneFiles, MissingFilesAndDirectoriesAreBadInput) {
    EXPECT_THAT(errors("none.yaml"), ElementsAre(file("none.yaml") + ": expected a scene, found no such file"));
    EXPECT_THAT(errors("."), ElementsAre(HasSubstr(": expected a scene, found a directory")));
}

TEST_F(SceneFiles, EmptyBinaryAndLargeFilesAreBadInput) {
    write("empty.yaml", "");
    write("comment.yaml", "# nothing here\n");
    write("binary.yaml", std::string("kluft: 1\n\0\1\2", 12));
    write("latin1.yaml", "title: Kl\xFC"
                         "fte\n");
    write("large.yaml", test::short_scene + std::string(1'000'000, '#'));
    EXPECT_THAT(errors("empty.yaml"), ElementsAre(HasSubstr("expected a mapping that begins with kluft: 1, found an "
                                                            "empty file")));
    EXPECT_THAT(errors("comment.yaml"), ElementsAre(HasSubstr("found an empty file")));
    EXPECT_THAT(errors("binary.yaml"),
                ElementsAre(file("binary.yaml") + ": expected a scene in UTF-8 text, found a binary file"));
    EXPECT_THAT(errors("latin1.yaml"), ElementsAre(HasSubstr("expected a scene in UTF-8 text")));
    EXPECT_THAT(errors("large.yaml"), ElementsAre(HasSubstr("expected a scene of at most 1 MB, found more")));
}

TEST_F(SceneFiles, LinesThatEndInACarriageReturnAloneAreToldAtTheFirst) {
    write("old.yaml", "kluft: 1\r\ntitle: a\rgeometry: {}\r");
    EXPECT_THAT(errors("old.yaml"),
                ElementsAre(file("old.yaml") + ":2: expected lines that end in LF or CR LF, found one that ends in CR "
                                               "alone"));
}

TEST_F(SceneFiles, CrossingOutlineOfAMapIsAllThatIsTold) {
    write("map.geojson", R"({"type": "Polygon", "coordinates": [[[0, 0], [1, 2], [1, 0], [0, 2], [0, 0]]]})");
    write("scene.yaml", std::string(test::short_scene) + "extends: more.yaml\n");
    write("more.yaml", "boundaries: {bottom: {support: smooth}}\n");
    EXPECT_THAT(errors("scene.yaml", {"geometry.domain={rectangle: null, file: map.geojson}"}),
                ElementsAre(AllOf(HasSubstr("geometry.domain.file: "),
                                  HasSubstr("outline: expected a simple polygon, found sides 0 and 2 (counted from 0) "
                                            "that cross"))));
}

TEST_F(SceneFiles, ExtendedSceneThatCannotBeReadIsAllThatIsTold) {
    write("derived.yaml", "kluft: 1\nextends: absent.yaml\nmaterials: {}\ncolour: red\n");
    EXPECT_THAT(errors("derived.yaml"), ElementsAre(HasSubstr("derived.yaml:2:10: extends: expected the file")));
    write("base.yaml", "materials: {rock: [1, 2\n");
    write("of-broken.yaml", "kluft: 1\nextends: base.yaml\n");
    EXPECT_THAT(errors("of-broken.yaml"), ElementsAre(HasSubstr("base.yaml:2:1: expected valid YAML")));
}

TEST_F(SceneFiles, ExtendingMergesMappingsAndReplacesListsAndValues) {
    write("base/base.yaml", test::full_scene);
    write("derived.yaml", "extends: base/base.yaml\n"
                          "materials: {rock: {density: 2500}}\n"
                          "geometry: {fractures: [{trace: [[0, 0], [4, 1]], interface: joint}]}\n"
                          "interfaces: {joint: {normal_stiffness: null, shear_stiffness: ~, stiffness_ratio: 10}}\n");
    const Scene scene = read_scene(file("derived.yaml"));
    EXPECT_EQ(scene.name, "derived");
    EXPECT_EQ(scene.materials[0].density, 2500.0);
    EXPECT_EQ(scene.materials[0].youngs_modulus, 25e9);
    EXPECT_EQ(scene.geometry.fractures.size(), 1U);
    EXPECT_EQ(scene.loads.stages.size(), 4U);
    EXPECT_EQ(scene.interface_types[0].stiffness_ratio, 10.0);
    EXPECT_FALSE(scene.interface_types[0].normal_stiffness);
}

TEST_F(SceneFiles, ErrorsPointToTheFileThatAValueCameFrom) {
    write("base.yaml", "kluft: 1\n"
                       "materials:\n"
                       "  rock: {youngs_modulus: 0, poissons_ratio: 0.25}\n"
                       "geometry: {domain: {rectangle: {width: 1, height: 2}}}\n"
                       "stages: [{strain: {boundary: top, value: 0.01}}]\n");
    write("derived.yaml", "extends: base.yaml\n"
                          "materials:\n"
                          "  rock: {poissons_ratio: 2}\n");
    EXPECT_THAT(errors("derived.yaml", {"solver.tolerance=0"}),
                ElementsAre(file("derived.yaml") + ":3:26: materials.rock.poissons_ratio: expected a number >= 0 and < "
                                                   "0.5, found '2'\n    rock: {poissons_ratio: 2}",
                            file("base.yaml") + ":3:26: materials.rock.youngs_modulus: expected a number > 0 in Pa, "
                                                "found '0'\n    rock: {youngs_modulus: 0, poissons_ratio: 0.25}",
                            "--set solver.tolerance=0: solver.tolerance: expected a number > 0 and < 1, found '0'"));
}

TEST_F(SceneFiles, ExtendingMustEnd) {
    write("self.yaml", "extends: self.yaml\n");
    write("a.yaml", "extends: sub/../b.yaml\n");
    write("b.yaml", "extends: a.yaml\n");
    std::filesystem::create_directories(directory / "sub");
    EXPECT_THAT(errors("self.yaml"),
                testing::Contains(file("self.yaml") + ":1:10: extends: expected the file of another "
                                                      "scene, found 'self.yaml', which leads back "
                                                      "to itself\n  extends: self.yaml"));
    EXPECT_THAT(errors("a.yaml"), testing::Contains(AllOf(StartsWith(file("b.yaml") + ":1:10: extends: "),
                                                          HasSubstr("'a.yaml', which leads back to itself"))));
    for (int i = 0; i < 20; ++i) write(std::to_string(i) + ".yaml", "extends: " + std::to_string(i + 1) + ".yaml\n");
    write("20.yaml", test::short_scene);
    EXPECT_THAT(errors("0.yaml"), testing::Contains(HasSubstr("after a chain of 16 scenes")));
    EXPECT_THAT(errors("10.yaml"), IsEmpty());
}

TEST_F(SceneFiles, ExtendingNeedsAReadableScene) {
    write("a.yaml", "extends: nowhere.yaml\n");
    EXPECT_THAT(errors("a.yaml"), testing::Contains(HasSubstr("extends: expected the file of another scene, found "
                                                              "'nowhere.yaml', which is no file")));
    write("c.yaml", "extends: [b.yaml]\n");
    EXPECT_THAT(errors("c.yaml"), testing::Contains(HasSubstr("extends: expected text, found a list of 1")));
    write("d.yaml", "extends: binary.yaml\n");
    write("binary.yaml", std::string(10, '\0'));
    EXPECT_THAT(errors("d.yaml"), ElementsAre(HasSubstr("found a binary file")));
}

/// A base scene in another folder names its data beside itself.
TEST_F(SceneFiles, GeometryFilesAreRelativeToTheFileThatNamesThem) {
    write("base/area.geojson", R"({"type": "Polygon", "coordinates": [[[0, 0], [1, 0], [1, 2], [0, 2], [0, 0]]]})");
    write("base/base.yaml", "kluft: 1\n"
                            "materials: {rock: {youngs_modulus: 1e9, poissons_ratio: 0.25}}\n"
                            "geometry: {domain: {file: area.geojson}}\n"
                            "stages: [{strain: {boundary: top, value: 0.01}}]\n");
    write("derived.yaml", "extends: base/base.yaml\n");
    EXPECT_EQ(read_scene(file("derived.yaml")).geometry.domain.size(), 4U);
    write("own.yaml", "extends: base/base.yaml\ngeometry: {domain: {file: area.geojson}}\n");
    EXPECT_THAT(errors("own.yaml"), ElementsAre(StartsWith(file("own.yaml") + ":2:27: geometry.domain.file: ")));
}

TEST(Overrides, GoThroughMappingsByKeyAndListsByIndex) {
    const Scene scene = read_scene_text(test::full_scene, {"stages.1.steps=200", "geometry.fractures.1.trace.1.0=25 cm",
                                                           "geometry.tessellation.hexagons.spacing=0.03"});
    EXPECT_EQ(scene.loads.stages[1].steps, 200);
    EXPECT_EQ(scene.geometry.fractures[1].points[1], Vec2(0.25, 1.0));
    EXPECT_EQ(scene.geometry.tessellation->hexagons.spacing, 0.03);
}

TEST(Overrides, CreateKeysOfTheSchemaAndAppendToLists) {
    const Scene scene = read_scene_text(test::short_scene,
                                        {"interfaces.joint.kind=fracture", "interfaces.joint.stiffness_ratio=10",
                                         "geometry.fractures.0.trace=[[0, 0], [1, 1]]", "geometry.reference_spacing=1",
                                         "stages.1.pressure.left=2 MPa", "stages.1.steps=4"});
    EXPECT_EQ(scene.geometry.fractures.size(), 1U);
    ASSERT_EQ(scene.loads.stages.size(), 2U);
    EXPECT_EQ(scene.loads.stages[1].pressure.at(3), 2e6);
}

TEST(Overrides, ApplyInOrderAndTheLastOneWins) {
    EXPECT_EQ(read_scene_text(test::full_scene, {"stages.0.steps=5", "stages.0.steps=6"}).loads.stages[0].steps, 6);
}

TEST(Overrides, MappingsMergeAndNullRemoves) {
    EXPECT_EQ(read_scene_text(test::full_scene, {"solver={max_unbalanced_steps: 5}"}).solver.max_iterations, 30);
    EXPECT_EQ(read_scene_text(test::full_scene, {"solver.max_iterations=null"}).solver.max_iterations, 12);
    EXPECT_FALSE(read_scene_text(test::full_scene, {"geometry.tessellation=~"}).geometry.tessellation);
    EXPECT_EQ(read_scene_text(test::full_scene, {"stages.0=null"}).loads.stages.size(), 3U);
    EXPECT_THAT(errors_in(test::short_scene, {"geometry.tessellation=null"}), IsEmpty()) << "nothing to remove";
}

TEST(Overrides, AMappingWithoutKeysIsRefusedWhereItWouldChangeNothing) {
    EXPECT_THAT(errors_with({"materials={}"}),
                ElementsAre("--set materials={}: materials: expected keys to merge with those that are there, or null, "
                            "which removes 'materials'; found {}, which changes nothing"));
    EXPECT_THAT(errors_with({"stages.1={}"}), ElementsAre(HasSubstr("stages.1: expected keys to merge")));
    EXPECT_THAT(errors_in(test::full_scene, {"geometry.regions=null", "output.histories=null", "output.histories={}"}),
                IsEmpty());
    const Scene merged = read_scene_text(test::full_scene, {"stages.1={steps: 200}"});
    EXPECT_EQ(merged.loads.stages[1].steps, 200);
    EXPECT_TRUE(merged.loads.stages[1].motion) << "the rest of the stage is kept";
}

TEST(Overrides, KeyThatIsMissingBecauseOneTookItAwayIsToldThere) {
    for (const std::string key : {"stages", "geometry", "materials", "kluft", "materials.rock.density"}) {
        for (const char* nothing : {"null", "~"})
            EXPECT_THAT(errors_in(test::full_scene, {key + "=" + nothing}),
                        ::testing::Contains(StartsWith(fmt::format("--set {}={}: {}: expected ", key, nothing, key))));
    }
}

TEST(Overrides, ThatAreWrongSayWhichOne) {
    EXPECT_THAT(errors_with({"stages.1.stpes=3"}),
                ElementsAre("--set stages.1.stpes=3: stages.1.stpes: expected one of name, pressure, gravity, forces, "
                            "displacement, strain, stress, platens, strength_reduction, steps, stop_after_drop, found "
                            "'stpes'; did you mean 'steps'?"));
    EXPECT_THAT(errors_with({"stages"}), ElementsAre("--set stages: expected key.path=value"));
    EXPECT_THAT(errors_with({"=3"}), ElementsAre("--set =3: expected key.path=value"));
    std::string deep = "a"; // recursion over keys filled the stack
    for (int i = 0; i < 100'000; ++i) deep += ".a";
    EXPECT_THAT(errors_with({deep + "=1"}), ElementsAre(::testing::EndsWith(": expected a key of at most 32 levels")));
    EXPECT_THAT(errors_with({"stages.9.steps=3"}),
                ElementsAre("--set stages.9.steps=3: stages: expected an index from 0 to 4 (the last one appends), "
                            "found '9'"));
    EXPECT_THAT(errors_with({"stages.first.steps=3"}), ElementsAre(HasSubstr("expected an index from 0 to 4")));
    EXPECT_THAT(errors_with({"title.short=3"}),
                ElementsAre("--set title.short=3: title: expected a mapping or a list for the key 'short', found 'One "
                            "of everything'"));
    EXPECT_THAT(errors_with({"extends=other.yaml"}), ElementsAre(HasSubstr("expected a key that can be overridden")));
    EXPECT_THAT(errors_with({"solver.tolerance=[1"}),
                testing::Contains(HasSubstr("expected valid YAML, found a mistake")));
    EXPECT_THAT(errors_with({std::string("title=a\0b", 9)}), ElementsAre(HasSubstr("expected a value in UTF-8 text")));
    EXPECT_THAT(errors_with({"..=1"}), testing::SizeIs(1));
}

TEST(SceneYaml, SyntaxErrorsHaveAPlace) {
    EXPECT_THAT(
        errors_in("kluft: 1\ntitle: [a, b\nstages: 3\n"),
        testing::Contains(AllOf(StartsWith("scene.yaml:3:"), HasSubstr("expected valid YAML, found a mistake: "))));
}

TEST(SceneYaml, ATabAsIndentationIsNamed) {
    EXPECT_THAT(errors_in("kluft: 1\n\n   \ntitle: x\nmaterials:\n\trock: {density: 1}\n"),
                testing::Contains(HasSubstr("; line 6 is indented by a tab, where YAML wants spaces")));
    EXPECT_THAT(errors_in("kluft: 1\ntitle: [a,\tb\nstages: 3\n"),
                testing::Not(testing::Contains(HasSubstr("tab")))); // which separates what it may separate
}

TEST(SceneYaml, AnchorsAliasesTagsAndSecondDocumentsAreRefused) {
    const auto with = [](const std::string& line) { return errors_in(test::short_scene + line + "\n"); };
    EXPECT_THAT(with("title: &a text"),
                ElementsAre("scene.yaml:8:8: expected a value, found an anchor (&name), which scenes do not have\n"
                            "  title: &a text"));
    EXPECT_THAT(with("output: &a {fields: true}\nsolver: *a"),
                testing::Contains(HasSubstr("expected a value, found an alias (*name)")));
    EXPECT_THAT(with("title: !!str text"), ElementsAre(HasSubstr("expected a value, found the tag ")));
    EXPECT_THAT(with("---\ntitle: a"), ElementsAre(HasSubstr("expected one document, found a second one")));
    EXPECT_THAT(with("? [a, b]\n: 1"), testing::Contains(HasSubstr("expected a word as the key")));
}

/// Ten levels of ten aliases each would unfold to 10^10 leaves.
TEST(SceneYaml, AliasBombsAreRefusedAtOnce) {
    std::string text = "a: &a [1, 1, 1, 1, 1, 1, 1, 1, 1, 1]\n";
    for (char c = 'b'; c < 'l'; ++c) {
        const std::string alias = std::string("*") + static_cast<char>(c - 1);
        text += std::string(1, c) + ": &" + c + " [" + alias;
        for (int i = 0; i < 9; ++i) text += ", " + alias;
        text += "]\n";
    }
    EXPECT_FALSE(errors_in(text).empty());
}

TEST(SceneYaml, DeepNestingIsRefused) {
    EXPECT_THAT(errors_in("title: " + std::string(100'000, '[')), testing::SizeIs(1));
    EXPECT_THAT(errors_in("title: " + std::string(40, '[') + std::string(40, ']')),
                ElementsAre(HasSubstr("expected at most 32 levels of nesting")));
}

// What follows from a mistake is none of its own.
TEST(SceneYaml, OneMistakeHasOneMessage) {
    EXPECT_THAT(errors_in(test::short_scene + "? [a, b]\n: 3\n"), ElementsAre(HasSubstr("expected a word as the key")));
    EXPECT_THAT(errors_in(test::short_scene + "~: {c: 3}\n"), ElementsAre(HasSubstr("expected a word as the key")));
    try {
        (void)read_scene_text(test::short_scene, {"stages.0.steps=[1"}, "test.yaml");
        FAIL();
    } catch (const InputError& error) {
        EXPECT_THAT(error.messages(), ElementsAre(HasSubstr("--set stages.0.steps=[1: expected valid YAML")));
    }
}

TEST(SceneYaml, MessagesStayReadable) {
    const auto long_line = errors_in(test::short_scene + "title: [" + std::string(5000, 'x') + "]\n");
    ASSERT_EQ(long_line.size(), 1U);
    EXPECT_LT(long_line[0].size(), 500U);
    // An escape sequence must not reach the terminal.
    const auto escape = errors_in(test::short_scene + "\"\\e[31mred\": 1\n");
    ASSERT_EQ(escape.size(), 1U);
    EXPECT_EQ(escape[0].find('\x1b'), std::string::npos);
}

TEST(SceneYaml, ManyErrorsAreCounted) {
    std::string text = test::short_scene;
    for (int i = 0; i < 5000; ++i) text += "key_" + std::to_string(i) + ": 1\n";
    const auto errors = errors_in(text);
    ASSERT_EQ(errors.size(), 1001U);
    EXPECT_EQ(errors.back(), "and 4000 more");
}

TEST(SceneProblems, HaveKeyFileLineAndColumn) {
    std::string text = test::short_scene;
    text.replace(text.find("1 GPa"), 5, "1 m");
    try {
        (void)read_scene_text(text, {"stages.0.steps=x"}, "folder/test.yaml");
        FAIL();
    } catch (const InputError& error) {
        ASSERT_EQ(error.problems().size(), 2U);
        const InputProblem& first = error.problems().front();
        EXPECT_EQ(first.path, "materials.rock.youngs_modulus");
        EXPECT_EQ(first.file, "folder/test.yaml");
        EXPECT_EQ(first.line, 3);
        EXPECT_EQ(first.column, 26);
        EXPECT_EQ(first.message.substr(0, first.message.find('\n')),
                  "folder/test.yaml:3:26: materials.rock.youngs_modulus: " + first.what);
        const InputProblem& last = error.problems().back();
        EXPECT_EQ(last.path, "stages.0.steps");
        EXPECT_EQ(last.file, "");
        EXPECT_EQ(last.line, 0);
    }
}

} // namespace
} // namespace kluft
