// Scenes of given blocks, sets, forces, stage gravity and histories: what is read and what is refused.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "kluft/scene/scene_reader.hpp"
#include "scene/scene_text.hpp"

namespace kluft {
namespace {

using test::errors_in;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Pair;

const std::string masonry = R"(kluft: 1
materials: {rock: {density: 2500, youngs_modulus: 1 GPa, poissons_ratio: 0.25}}
interfaces: {joint: {kind: fracture, normal_stiffness: 1e10, shear_stiffness: 1e10}}
geometry:
  blocks:
    - {name: base, polygon: [[0, 0], [0, 1], [4, 1], [4, 0]], support: fixed}
    - {polygon: [[1, 1], [2, 1], [2, 300 cm], [1, 3]]}
  sets:
    all: {polygon: [[-1, -1], [5, -1], [5, 5], [-1, 5]]}
    column: {blocks: [block 2]}
stages:
  - {gravity: 9.81, forces: {push: {block: column, point: [1, 2], force: [5 kN/m, 0]}}}
  - {gravity: [1, -9], forces: {push: {force: [0, 0]}, other: {point: [1.5, 3], force: [0, -1]}}}
output:
  histories:
    a: {block: base, point: [1, 0.5]}
    b: {interface: [base, column]}
)";

TEST(SceneReader, ReadsGivenBlocksAndSets) {
    const GeometrySpec spec = read_scene_text(masonry).geometry;
    ASSERT_EQ(spec.blocks.size(), 2U);
    EXPECT_EQ(spec.blocks[0].name, "base");
    EXPECT_EQ(spec.blocks[0].polygon, (Polygon{{0, 0}, {4, 0}, {4, 1}, {0, 1}})) << "counter-clockwise";
    EXPECT_TRUE(spec.blocks[0].fixed);
    EXPECT_EQ(spec.blocks[1].name, "block 2");
    EXPECT_EQ(spec.blocks[1].polygon[2], Vec2(2, 3));
    EXPECT_FALSE(spec.blocks[1].fixed);
    EXPECT_TRUE(spec.domain.empty());
    ASSERT_EQ(spec.sets.size(), 2U);
    EXPECT_EQ(spec.sets[0].name, "all");
    EXPECT_EQ(spec.sets[0].polygon.size(), 4U);
    EXPECT_THAT(spec.sets[1].blocks, ElementsAre(1));
}

TEST(SceneReader, SidesOfGivenBlocksBelongToTheDirectionTheyFace) {
    const auto boundaries = read_scene_text(masonry).geometry.boundaries;
    ASSERT_EQ(boundaries.size(), 4U);
    EXPECT_EQ(boundaries[0].name, "bottom");
    EXPECT_THAT(boundaries[0].sides, ElementsAre(0, 4));
    EXPECT_EQ(boundaries[1].name, "right");
    EXPECT_THAT(boundaries[1].sides, ElementsAre(1, 5));
}

TEST(SceneReader, ABoundaryOfOneBlockTakesItsSidesFromTheOthers) {
    const auto boundaries =
        read_scene_text(masonry + "boundaries:\n  roof: {facing: top}\n  push: {block: block 2, facing: top}\n  "
                                  "side: {block: base, sides: [0]}\n")
            .geometry.boundaries;
    ASSERT_EQ(boundaries.size(), 3U);
    EXPECT_THAT(boundaries[0].sides, ElementsAre(2));
    EXPECT_THAT(boundaries[1].sides, ElementsAre(6));
    EXPECT_EQ(boundaries[1].block, "block 2");
    EXPECT_THAT(boundaries[2].sides, ElementsAre(3)) << "side 0 of the clockwise polygon is the left one";
}

TEST(SceneReader, ReadsForcesGravityAndHistories) {
    const Scene scene = read_scene_text(masonry);
    const auto& forces = scene.loads.forces;
    ASSERT_EQ(forces.size(), 2U);
    EXPECT_EQ(forces[0].name, "push");
    EXPECT_EQ(forces[0].block, "column");
    EXPECT_EQ(forces[0].point, Vec2(1, 2));
    EXPECT_EQ(forces[1].block, "");
    const auto& stages = scene.loads.stages;
    EXPECT_THAT(stages[0].forces, ElementsAre(Pair(0, Vec2(5000, 0))));
    EXPECT_THAT(stages[1].forces, ElementsAre(Pair(0, Vec2(0, 0)), Pair(1, Vec2(0, -1))));
    EXPECT_EQ(stages[0].gravity, Vec2(0, -9.81));
    EXPECT_EQ(stages[1].gravity, Vec2(1, -9));
    const auto& histories = scene.output.histories;
    ASSERT_EQ(histories.size(), 2U);
    EXPECT_EQ(histories[0].block, "base");
    EXPECT_EQ(histories[0].point, Vec2(1, 0.5));
    EXPECT_EQ(histories[1].pair, (std::pair<std::string, std::string>("base", "column")));
}

TEST(SceneReader, ReadsAHistoryOfAFractureByItsName) {
    const Scene scene = read_scene_text(test::full_scene, {"output.histories={f: {fracture: main}}"});
    EXPECT_THAT(scene.output.histories.at(0).fractures, ElementsAre(0));
}

TEST(SceneReader, MergedSceneOfGivenBlocksReadsTheSame) {
    const Scene scene = read_scene_text(masonry);
    const Scene again = read_scene_text(scene.text);
    EXPECT_EQ(again.text, scene.text);
    EXPECT_EQ(again.geometry.blocks[1].polygon, scene.geometry.blocks[1].polygon);
}

std::vector<std::string> errors_of(const std::string& change) { return errors_in(masonry, {change}); }

TEST(SceneErrors, ABodyIsCutOrGiven) {
    EXPECT_THAT(errors_of("geometry.blocks=null"),
                testing::Contains(HasSubstr("geometry: expected one of domain, blocks, found none of them")));
    EXPECT_THAT(errors_of("geometry.domain={rectangle: {width: 1, height: 1}}"),
                testing::Contains(HasSubstr("geometry: expected one of domain, blocks, found domain and blocks")));
    EXPECT_THAT(errors_of("geometry.fractures=[{trace: [[0, 0], [1, 1]]}]"),
                ElementsAre(HasSubstr("geometry.fractures: expected nothing beside blocks, found a list of 1")));
}

TEST(SceneErrors, GivenBlocksHaveNamesAndSimplePolygons) {
    EXPECT_THAT(
        errors_of("geometry.blocks.1.name=base"),
        testing::Contains(HasSubstr("geometry.blocks.1.name: expected each name of a block or a set once, found "
                                    "'base' again")));
    EXPECT_THAT(errors_of("geometry.sets.base={blocks: [base]}"),
                ElementsAre(HasSubstr("geometry.sets.base: expected each name of a block or a set once")));
    EXPECT_THAT(errors_of("geometry.blocks.1.polygon=[[0, 1], [1, 2], [1, 1], [0, 2]]"),
                ElementsAre(HasSubstr("geometry.blocks.1.polygon: expected a simple polygon")));
    EXPECT_THAT(errors_of("geometry.blocks.1.support=pinned"),
                ElementsAre(HasSubstr("geometry.blocks.1.support: expected one of none, fixed, found 'pinned'")));
    EXPECT_THAT(errors_of("geometry.blocks_interface=joints"),
                ElementsAre(HasSubstr("geometry.blocks_interface: expected the name of an interface (joint), found "
                                      "'joints'; did you mean 'joint'?")));
    EXPECT_THAT(errors_of("geometry.sets.column.blocks=[block 3]"),
                ElementsAre(HasSubstr("geometry.sets.column.blocks: expected the name of a given block")));
    EXPECT_THAT(errors_of("geometry.sets.column.blocks=[]"),
                ElementsAre(HasSubstr("geometry.sets.column.blocks: expected a list of at least 1 name, found an empty "
                                      "list")));
    EXPECT_THAT(
        errors_of("geometry.sets.column.polygon=[[0, 0], [1, 0], [1, 1]]"),
        ElementsAre(HasSubstr("geometry.sets.column: expected one of polygon, blocks, found polygon and blocks")));
}

TEST(SceneErrors, BoundariesOfGivenBlocksNameSidesThatExist) {
    EXPECT_THAT(errors_of("boundaries={a: {block: bas, facing: top}}"),
                ElementsAre(HasSubstr("boundaries.a.block: expected the name of a given block (base, block 2), found "
                                      "'bas'; did you mean 'base'?")));
    EXPECT_THAT(errors_of("boundaries={a: {sides: [1]}}"),
                ElementsAre(HasSubstr("boundaries.a.sides: expected block: NAME beside it")));
    EXPECT_THAT(errors_of("boundaries={a: {block: base, sides: [4]}}"),
                ElementsAre(HasSubstr("boundaries.a.sides: expected sides of the block from 0 to 3, found 4")));
    EXPECT_THAT(errors_of("boundaries={a: {block: base, facing: top}, b: {block: base, sides: [1]}}"),
                ElementsAre(HasSubstr("boundaries.b: expected each side of the block 'base' once")));
    EXPECT_THAT(errors_in(test::full_scene, {"boundaries.left.block=base"}),
                ElementsAre(HasSubstr("boundaries.left.block: expected nothing for a domain that is cut")));
}

TEST(SceneErrors, ForcesHaveAPointOnce) {
    EXPECT_THAT(errors_of("stages.0.forces.new={force: [1, 0]}"),
                ElementsAre(HasSubstr("stages.0.forces.new: expected a point [x, y] in m because the force is new")));
    EXPECT_THAT(errors_of("stages.1.forces.push.point=[1, 2.5]"),
                ElementsAre(HasSubstr("stages.1.forces.push: expected the block and the point where the force acts")));
    EXPECT_THAT(errors_of("stages.0.forces.push.block=colum"), testing::Contains(HasSubstr("did you mean 'column'?")));
    EXPECT_THAT(
        errors_of("stages.0.forces.push.force=[1 MPa, 0]"),
        ElementsAre(HasSubstr("stages.0.forces.push.force.0: expected a number in N/m, found '1 MPa', which is in "
                              "Pa")));
    EXPECT_THAT(errors_of("stages.0.forces.push.force=null"),
                ElementsAre(HasSubstr("stages.0.forces.push.force: expected a point [x, y] in N/m, found nothing")));
}

TEST(SceneErrors, GravityOfAStageNeedsDensities) {
    EXPECT_THAT(
        errors_of("materials.rock.density=null"),
        ElementsAre(HasSubstr("materials.rock.density: expected a number > 0 in kg/m3 because there is gravity")));
    EXPECT_THAT(errors_of("stages.0.gravity=-1"),
                ElementsAre(HasSubstr("stages.0.gravity: expected a number >= 0 (downwards) or [gx, gy] in m/s2")));
}

TEST(SceneErrors, HistoriesAreOfOneThingThatExists) {
    EXPECT_THAT(errors_of("output.histories.a.block=bse"), ElementsAre(HasSubstr("did you mean 'base'?")));
    EXPECT_THAT(errors_of("output.histories.b.interface=[base]"),
                ElementsAre(HasSubstr("output.histories.b.interface: expected a list of at least 2 names"),
                            HasSubstr("output.histories.b.interface: expected the names of two blocks")));
    EXPECT_THAT(errors_of("output.histories.b.interface=[base, base]"),
                ElementsAre(HasSubstr("expected two different blocks, found 'base' twice")));
    EXPECT_THAT(errors_of("output.histories.b.block=base"),
                ElementsAre(HasSubstr("output.histories.b: expected either block and point")));
    EXPECT_THAT(errors_of("output.histories.c={}"),
                ElementsAre(HasSubstr("output.histories.c: expected either block and point")));
    EXPECT_THAT(
        errors_in(test::full_scene, {"output.histories={f: {fracture: man}}"}),
        ElementsAre(HasSubstr("output.histories.f.fracture: expected the name of a mapped fracture (main, fracture "
                              "2), found 'man'; did you mean 'main'?")));
}

} // namespace
} // namespace kluft
