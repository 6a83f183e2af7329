#include "kluft/scene/scene_reader.hpp"

#include <filesystem>
#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "kluft/core/diagnostics.hpp"
#include "kluft/scene/outline.hpp"
#include "scene/scene_text.hpp"
#include "support/units.hpp"

namespace kluft {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::ThrowsMessage;

TEST(SceneReader, ReadsMaterialsInSi) {
    const Scene scene = read_scene_text(test::full_scene);
    ASSERT_EQ(scene.materials.size(), 2U);
    const Material& rock = scene.materials[0];
    EXPECT_EQ(rock.name, "rock");
    EXPECT_EQ(rock.density, 2650.0);
    EXPECT_EQ(rock.youngs_modulus, 25e9);
    EXPECT_EQ(rock.poissons_ratio, 0.25);
    ASSERT_TRUE(rock.strength);
    EXPECT_EQ(rock.strength->cohesion, 5e6);
    EXPECT_DOUBLE_EQ(rock.strength->friction_angle, 40.0 * degree);
    EXPECT_EQ(rock.strength->tensile_strength, 2e6);
    EXPECT_EQ(scene.materials[1].name, "clay");
}

TEST(SceneReader, ReadsAFractureWithEachOfItsKeys) {
    const InterfaceType joint = read_scene_text(test::full_scene).interface_types.at(0);
    EXPECT_EQ(joint.name, "joint");
    EXPECT_EQ(joint.kind, InterfaceKind::fracture);
    EXPECT_EQ(joint.normal_stiffness, 10e9);
    EXPECT_EQ(joint.shear_stiffness, 5e9);
    EXPECT_FALSE(joint.normal_stiffness_times_spacing || joint.stiffness_ratio || joint.shear_ratio);
    EXPECT_DOUBLE_EQ(joint.friction_angle, 25.0 * degree);
    EXPECT_EQ(joint.cohesion, 10e3);
    EXPECT_DOUBLE_EQ(joint.dilation_angle, 5.0 * degree);
    EXPECT_EQ(joint.cohesion_onset, 1e3);
    EXPECT_EQ(joint.contact_rounding, 2e3);
    EXPECT_EQ(joint.friction_rounding, 0.1);
    EXPECT_FALSE(joint.strength);
    EXPECT_EQ(joint.fails_to, -1);
}

TEST(SceneReader, ReadsPotentialCracksWithAndWithoutTheirOwnStrength) {
    const Scene scene = read_scene_text(test::full_scene);
    const InterfaceType& bond = scene.interface_types.at(1);
    EXPECT_EQ(bond.kind, InterfaceKind::potential_crack);
    EXPECT_EQ(bond.stiffness_ratio, 12.0);
    EXPECT_EQ(bond.shear_ratio, 0.4);
    EXPECT_FALSE(bond.strength);
    EXPECT_EQ(bond.fails_to, 0);
    const InterfaceType& seam = scene.interface_types.at(2);
    EXPECT_EQ(seam.normal_stiffness_times_spacing, 1e9);
    EXPECT_EQ(seam.shear_stiffness_times_spacing, 0.5e9);
    ASSERT_TRUE(seam.strength);
    EXPECT_EQ(seam.strength->cohesion, 1e6);
    EXPECT_DOUBLE_EQ(seam.strength->friction_angle, 35.0 * degree);
    EXPECT_EQ(seam.strength->tensile_strength, 0.5e6);
    EXPECT_EQ(seam.cohesion, 0.0) << "a potential crack's cohesion is strength, not that of a fracture law";
}

TEST(SceneReader, ReadsGeometry) {
    const GeometrySpec spec = read_scene_text(test::full_scene).geometry;
    EXPECT_EQ(spec.domain, (Polygon{{1.0, -1.0}, {3.0, -1.0}, {3.0, 3.0}, {1.0, 3.0}}));
    ASSERT_EQ(spec.fractures.size(), 2U);
    EXPECT_EQ(spec.fractures[0].name, "main");
    EXPECT_EQ(spec.fractures[0].interface_type, 0);
    EXPECT_EQ(spec.fractures[1].name, "fracture 2");
    EXPECT_EQ(spec.fractures[1].interface_type, 2);
    EXPECT_EQ(spec.fractures[1].points, (std::vector<Vec2>{{0.0, 1.0}, {1.5, 1.0}, {4.0, 2.0}}));
    ASSERT_TRUE(spec.tessellation);
    EXPECT_EQ(spec.tessellation->interface_type, 1);
    EXPECT_EQ(spec.tessellation->hexagons.spacing, 0.2);
    EXPECT_DOUBLE_EQ(spec.tessellation->hexagons.rotation, 15.0 * degree);
    EXPECT_EQ(spec.tessellation->hexagons.offset, Vec2(0.01, 0.02));
    EXPECT_EQ(spec.tessellation->hexagons.jitter, 0.1);
    EXPECT_EQ(spec.tessellation->hexagons.seed, 7U);
    ASSERT_TRUE(spec.tessellation->region);
    EXPECT_EQ(spec.tessellation->region->size(), 4U);
    EXPECT_EQ(spec.reference_spacing, 0.3);
    EXPECT_EQ(spec.minimum_area, 0.04);
    EXPECT_EQ(spec.material, 0);
    ASSERT_EQ(spec.regions.size(), 1U);
    EXPECT_EQ(spec.regions[0].material, 1);
}

TEST(SceneReader, ReadsVoronoiCellsInPlaceOfHexagons) {
    const Scene scene = read_scene_text(
        test::full_scene, {"geometry.tessellation.hexagons=null",
                           "geometry.tessellation.voronoi={spacing: 20 cm, seed: 7, offset: [1, 2], relaxation: 5}"});
    const auto& cells = scene.geometry.tessellation->voronoi;
    ASSERT_TRUE(cells);
    EXPECT_EQ(cells->spacing, 0.2);
    EXPECT_EQ(cells->seed, 7U);
    EXPECT_EQ(cells->offset, Vec2(1.0, 2.0));
    EXPECT_EQ(cells->relaxation, 5);
    EXPECT_EQ(lattice_spacing(scene.geometry), 0.2);
    const auto again = read_scene_text(scene.text).geometry.tessellation->voronoi;
    ASSERT_TRUE(again);
    EXPECT_EQ(again->seed, 7U);
    EXPECT_EQ(again->relaxation, 5);
}

TEST(SceneReader, VoronoiCellsAreRelaxedTwiceWhereNothingIsSaid) {
    const Scene scene =
        read_scene_text(test::full_scene, {"geometry.tessellation={hexagons: null, voronoi: {spacing: 0.3}}"});
    const auto& cells = scene.geometry.tessellation->voronoi;
    ASSERT_TRUE(cells);
    EXPECT_EQ(cells->seed, 1U);
    EXPECT_EQ(cells->offset, Vec2(0.0, 0.0));
    EXPECT_EQ(cells->relaxation, 2);
}

TEST(SceneReader, ReadsTheNoiseOfStrengths) {
    const StrengthNoise none = read_scene_text(test::full_scene).cracks.strength_noise;
    EXPECT_EQ(none.deviation, 0.0);
    EXPECT_EQ(none.seed, 1U);
    const StrengthNoise noise =
        read_scene_text(test::full_scene, {"cracks.strength_noise=1 %", "cracks.strength_seed=9"})
            .cracks.strength_noise;
    EXPECT_EQ(noise.deviation, 0.01);
    EXPECT_EQ(noise.seed, 9U);
}

TEST(SceneReader, SidesOfARectangleAreBottomRightTopLeft) {
    const auto boundaries = read_scene_text(test::short_scene).geometry.boundaries;
    ASSERT_EQ(boundaries.size(), 4U);
    const char* names[] = {"bottom", "right", "top", "left"};
    for (int i = 0; i < 4; ++i) {
        EXPECT_EQ(boundaries[i].name, names[i]);
        EXPECT_EQ(boundaries[i].sides, std::vector<int>{i});
    }
}

TEST(SceneReader, ReadsSupportsAndStages) {
    const LoadProgram loads = read_scene_text(test::full_scene).loads;
    EXPECT_THAT(loads.supports, ElementsAre(Support::fixed, Support::none, Support::none, Support::smooth));
    ASSERT_EQ(loads.stages.size(), 4U);
    EXPECT_EQ(loads.stages[0].name, "weight");
    EXPECT_EQ(loads.stages[0].pressure, (std::map<int, double>{{1, 1e6}, {2, 2e6}}));
    EXPECT_FALSE(loads.stages[0].motion);
    EXPECT_EQ(loads.stages[0].steps, 3);
    ASSERT_TRUE(loads.stages[1].motion);
    EXPECT_EQ(loads.stages[1].motion->control, PlatenControl::strain);
    EXPECT_EQ(loads.stages[1].motion->boundary, 2);
    EXPECT_EQ(loads.stages[1].motion->value, 0.015);
    EXPECT_TRUE(std::isinf(loads.stages[1].platen_friction));
    EXPECT_EQ(loads.stages[2].motion->control, PlatenControl::displacement);
    EXPECT_EQ(loads.stages[2].motion->value, 0.003);
    EXPECT_EQ(loads.stages[2].steps, 1);
    EXPECT_EQ(loads.stages[3].motion->control, PlatenControl::stress);
    EXPECT_EQ(loads.stages[3].motion->value, 3e6);
}

TEST(SceneReader, ReadsOptions) {
    const Scene scene = read_scene_text(test::full_scene);
    EXPECT_EQ(scene.title, "One of everything");
    EXPECT_EQ(scene.gravity_x, 0.0);
    EXPECT_EQ(scene.gravity_y, -9.81);
    EXPECT_EQ(scene.cracks.criterion, CrackCriterion::interface_traction);
    EXPECT_EQ(scene.cracks.update, CrackUpdate::all);
    EXPECT_EQ(scene.cracks.every, 2);
    EXPECT_EQ(scene.cracks.event_tolerance, 1e-3);
    EXPECT_EQ(scene.solver.tolerance, 1e-6);
    EXPECT_EQ(scene.solver.balance, 1e-4);
    EXPECT_EQ(scene.solver.viscosity, 0.1);
    EXPECT_EQ(scene.solver.max_iterations, 30);
    EXPECT_EQ(scene.solver.max_unbalanced_steps, 4);
    EXPECT_EQ(scene.solver.tangent, Tangent::symmetric);
    EXPECT_TRUE(scene.solver.repeatable);
    EXPECT_FALSE(scene.output.fields);
    EXPECT_EQ(scene.output.fields_every, 10);
    EXPECT_FALSE(scene.output.pictures);
    EXPECT_EQ(scene.output.checkpoint_every, 5);
    EXPECT_EQ(scene.output.checkpoint_seconds, 90.0);
}

/// The defaults of the table of keys are those of the option structs.
TEST(SceneReader, LeavesDefaultsWhereTheSceneSaysNothing) {
    const Scene scene = read_scene_text(test::short_scene);
    EXPECT_EQ(scene.name, "scene");
    EXPECT_EQ(scene.plane, Plane::strain);
    EXPECT_EQ(scene.gravity_y, 0.0);
    const CrackOptions cracks;
    EXPECT_EQ(scene.cracks.criterion, cracks.criterion);
    EXPECT_EQ(scene.cracks.update, cracks.update);
    EXPECT_EQ(scene.cracks.every, cracks.every);
    EXPECT_EQ(scene.cracks.event_tolerance, cracks.event_tolerance);
    const SolverOptions solver;
    EXPECT_EQ(scene.solver.tolerance, solver.tolerance);
    EXPECT_EQ(scene.solver.balance, solver.balance);
    EXPECT_EQ(scene.solver.viscosity, solver.viscosity);
    EXPECT_EQ(scene.solver.max_iterations, solver.max_iterations);
    EXPECT_EQ(scene.solver.max_unbalanced_steps, solver.max_unbalanced_steps);
    EXPECT_EQ(scene.solver.tangent, solver.tangent);
    EXPECT_EQ(scene.solver.repeatable, solver.repeatable);
    const OutputOptions output;
    EXPECT_EQ(scene.output.fields, output.fields);
    EXPECT_EQ(scene.output.fields_every, output.fields_every);
    EXPECT_EQ(scene.output.pictures, output.pictures);
    EXPECT_EQ(scene.output.checkpoint_every, output.checkpoint_every);
    EXPECT_EQ(scene.output.checkpoint_seconds, output.checkpoint_seconds);
    const GeometrySpec spec;
    EXPECT_EQ(scene.geometry.minimum_area, spec.minimum_area);
    EXPECT_EQ(scene.geometry.reference_spacing, spec.reference_spacing);
    const InterfaceType type = read_scene_text(test::short_scene, {"interfaces.a.kind=fracture"}).interface_types.at(0);
    EXPECT_EQ(type.friction_rounding, InterfaceType{}.friction_rounding);
    EXPECT_FALSE(type.cohesion_onset || type.contact_rounding || type.stiffness_ratio || type.shear_ratio);
    const HexagonLattice lattice = read_scene_text(test::short_scene, {"interfaces.a={kind: fracture}",
                                                                       "geometry.tessellation.hexagons.spacing=0.1"})
                                       .geometry.tessellation->hexagons;
    EXPECT_EQ(lattice.seed, HexagonLattice{}.seed);
    EXPECT_EQ(lattice.jitter, HexagonLattice{}.jitter);
    EXPECT_EQ(scene.loads.stages[0].name, "stage 0");
    EXPECT_EQ(scene.loads.stages[0].steps, Stage{}.steps);
    EXPECT_EQ(scene.loads.stages[0].platen_friction, Stage{}.platen_friction);
}

TEST(SceneReader, GravityIsANumberDownwardsOrAVector) {
    const auto with = [](const std::string& gravity) {
        return read_scene_text(test::full_scene, {"analysis.gravity=" + gravity});
    };
    EXPECT_EQ(with("981 cm/s2").gravity_y, -9.81);
    EXPECT_EQ(with("0").gravity_y, 0.0);
    EXPECT_FALSE(std::signbit(with("0").gravity_y));
    EXPECT_EQ(with("[1.5, -9]").gravity_x, 1.5);
    EXPECT_EQ(with("[1.5, -9]").gravity_y, -9.0);
}

TEST(SceneReader, AClockwisePolygonTurnsRoundAndItsSidesKeepTheirMeaning) {
    const std::vector<std::string> clockwise{
        "geometry.domain.rectangle=null", "geometry.domain.polygon=[[0, 0], [0, 2], [1, 2], [1, 0]]",
        "boundaries={ceiling: {sides: [1]}, walls: {sides: [0, 2]}}",
        "stages=[{pressure: {walls: 1}, strain: {boundary: ceiling, value: 0.01}}]"};
    const GeometrySpec spec = read_scene_text(test::short_scene, clockwise).geometry;
    EXPECT_EQ(spec.domain, (Polygon{{0.0, 0.0}, {1.0, 0.0}, {1.0, 2.0}, {0.0, 2.0}}));
    ASSERT_EQ(spec.boundaries.size(), 2U);
    EXPECT_EQ(spec.boundaries[0].name, "ceiling");
    EXPECT_THAT(spec.boundaries[0].sides, ElementsAre(2)); // from (1, 2) to (0, 2)
    EXPECT_THAT(spec.boundaries[1].sides, ElementsAre(3, 1));
}

TEST(SceneReader, APolygonWithoutBoundariesFacesFourWays) {
    const std::vector<std::string> overrides{
        "geometry.domain={polygon: [[0, 0], [2, 0.5], [2.2, 2], [1, 3], [0, 0]], rectangle: null}",
        "boundaries={bottom: {support: fixed}}"};
    const Scene scene = read_scene_text(test::short_scene, overrides);
    EXPECT_EQ(scene.geometry.domain.size(), 4U) << "the repeated first point is dropped";
    ASSERT_EQ(scene.geometry.boundaries.size(), 4U);
    EXPECT_EQ(scene.geometry.boundaries[0].name, "bottom");
    EXPECT_THAT(scene.geometry.boundaries[0].sides, ElementsAre(0));
    EXPECT_THAT(scene.geometry.boundaries[1].sides, ElementsAre(1));
    EXPECT_THAT(scene.geometry.boundaries[2].sides, ElementsAre(2));
    EXPECT_THAT(scene.geometry.boundaries[3].sides, ElementsAre(3));
    EXPECT_EQ(scene.loads.supports[0], Support::fixed);
}

TEST(SceneReader, ABoundaryMayTakeAllSidesThatFaceADirection) {
    const std::vector<std::string> overrides{"geometry.domain={polygon: [[0, 0], [2, 0], [2, 2], [1, 2.5], [0, 2]], "
                                             "rectangle: null}",
                                             "boundaries={roof: {facing: top}, floor: {sides: [0]}}",
                                             "stages.0.strain.boundary=roof"};
    const GeometrySpec spec = read_scene_text(test::short_scene, overrides).geometry;
    EXPECT_THAT(spec.boundaries[0].sides, ElementsAre(2, 3));
}

/// Mohr-Coulomb's envelope ends at c cot(phi) = 0.1/tan(45 deg) = 0.1 MPa.
TEST(SceneReader, TensileStrengthIsCappedAtTheApexWithAWarning) {
    const Scene scene = read_scene_text(test::full_scene,
                                        {"materials.clay.friction_angle=45", "materials.clay.tensile_strength=1 MPa"});
    EXPECT_NEAR(scene.materials[1].strength->tensile_strength, 0.1e6, 1e-6);
    EXPECT_THAT(scene.warnings,
                ElementsAre("--set materials.clay.tensile_strength=1 MPa: materials.clay.tensile_strength: "
                            "1e+06 Pa is above cohesion cot(friction_angle), taken as 100000 Pa"));
}

TEST(SceneReader, WarnsOfLinesAndGradingOfANetThatHaveNoPartInTheBody) {
    const auto warnings = [](const std::string& grading, const std::vector<std::string>& more = {}) {
        std::vector<std::string> settings{"interfaces.bond.stiffness_ratio=2", "geometry.tessellation.hexagons=null",
                                          "geometry.tessellation.triangles={spacing: 0.3, grading: {" + grading + "}}"};
        settings.insert(settings.end(), more.begin(), more.end());
        auto all = read_scene_text(test::full_scene, settings).warnings;
        std::erase_if(all, [](const std::string& warning) {
            return warning.find("grading") == std::string::npos && warning.find("construction") == std::string::npos;
        });
        return all;
    };
    EXPECT_THAT(warnings("fractures: 0.1"), IsEmpty());
    EXPECT_THAT(warnings("fractures: 0.1", {"geometry.fractures=null"}),
                ElementsAre(HasSubstr("grading.fractures: has no effect: there is no mapped fracture in the domain")));
    EXPECT_THAT(warnings("openings: 0.1"),
                ElementsAre(HasSubstr("grading.openings: has no effect: the domain has no holes")));
    EXPECT_THAT(warnings("region: [[8, 8], [9, 8], [9, 9]], region_spacing: 0.1"),
                ElementsAre(HasSubstr("grading.region: has no effect: it has no part in the body")));
    EXPECT_THAT(warnings("region: [[1, 0], [2, 0], [2, 1]], region_spacing: 0.1"), IsEmpty());
    EXPECT_THAT(warnings("", {"geometry.construction_lines=[{trace: [[1, 0], [3, 0]]}, {trace: [[7, 0], [8, 0]]}]"}),
                ElementsAre(HasSubstr("geometry.construction_lines.1.trace: the line lies outside the domain")));
}

TEST(SceneReader, WarnsOfWhatHasNoEffect) {
    EXPECT_THAT(read_scene_text(test::full_scene).warnings, IsEmpty());
    EXPECT_THAT(read_scene_text(test::full_scene, {"interfaces.bond.contact_rounding=1 kPa"}).warnings,
                ElementsAre(HasSubstr("no effect on a potential crack")));
    EXPECT_THAT(read_scene_text(test::full_scene, {"stages.0.pressure.left=1 kPa"}).warnings,
                ElementsAre(HasSubstr("no effect where the boundary is supported")));
    EXPECT_THAT(read_scene_text(test::full_scene, {"geometry.fractures.0.trace=[[30, 0], [40, 1]]"}).warnings,
                ElementsAre(HasSubstr("main lies outside the domain")));
    EXPECT_THAT(read_scene_text(test::full_scene, {"geometry.blocks_interface=joint"}).warnings,
                ElementsAre(AllOf(HasSubstr("geometry.blocks_interface"), HasSubstr("has no effect"))));
    EXPECT_THAT(read_scene_text(test::full_scene, {"cracks.strength_noise=0", "cracks.strength_seed=3"}).warnings,
                ElementsAre(AllOf(HasSubstr("cracks.strength_seed"), HasSubstr("has no effect"))));
}

TEST(SceneReader, OnlyMaterialsOfTheBodyNeedStrengthsForPotentialCracks) {
    const std::string scene = R"(kluft: 1
materials:
  rock: {youngs_modulus: 10 GPa, poissons_ratio: 0.25, cohesion: 1 MPa, friction_angle: 40, tensile_strength: 0.9 MPa}
  steel: {youngs_modulus: 200 GPa, poissons_ratio: 0.3}
interfaces:
  bond: {kind: potential_crack}
  joint: {kind: fracture, friction_angle: 30}
geometry:
  domain: {rectangle: {width: 1, height: 2}}
  material: rock
  tessellation: {triangles: {spacing: 0.2}, interface: bond}
stages: [{strain: {boundary: top, value: 1 %}}]
)";
    EXPECT_THAT(read_scene_text(scene).warnings, IsEmpty());
    EXPECT_THAT([&] { (void)read_scene_text(scene, {"geometry.material=steel"}); },
                ThrowsMessage<InputError>(HasSubstr("in the material steel, found neither")));
}

TEST(SceneReader, JsonIsASceneToo) {
    const Scene scene = read_scene_text(R"({"kluft": 1,
      "materials": {"rock": {"youngs_modulus": 1e9, "poissons_ratio": 0.25}},
      "geometry": {"domain": {"rectangle": {"width": "100 cm", "height": 2}}},
      "stages": [{"strain": {"boundary": "top", "value": 0.01}}]})");
    EXPECT_EQ(scene.geometry.domain[2], Vec2(1.0, 2.0));
}

class Models : public testing::TestWithParam<const char*> {
protected:
    [[nodiscard]] Scene read() const {
        return read_scene(KLUFT_SOURCE_DIR "/models/" + std::string(GetParam()) + ".yaml");
    }
};

TEST_P(Models, AreValidWithoutAWarning) { EXPECT_THAT(read().warnings, IsEmpty()); }

INSTANTIATE_TEST_SUITE_P(All, Models,
                         testing::Values("quickstart", "outcrop-kb7", "calibration/intact", "triaxial/base",
                                         "triaxial/model-b", "triaxial/model-c", "triaxial/model-c-all",
                                         "triaxial/case-1", "triaxial/case-2", "triaxial/case-3", "triaxial/case-3-all",
                                         "triaxial/case-4", "triaxial/case-4-all", "triaxial/case-5",
                                         "triaxial/case-5-all", "triaxial/case-6", "triaxial/case-6-all"),
                         [](const auto& model) {
                             std::string name = model.param;
                             for (char& c : name)
                                 if (std::isalnum(static_cast<unsigned char>(c)) == 0) c = '_';
                             return name;
                         });

Scene triaxial(const std::string& name) { return read_scene(KLUFT_SOURCE_DIR "/models/triaxial/" + name + ".yaml"); }

TEST(TriaxialModels, EveryCaseHasAPressureStageAndAPlatenStage) {
    const std::pair<const char*, std::pair<double, double>> cases[] = {
        {"case-1", {0.2e6, 0.035}},     {"case-2", {0.2e6, 0.035}},     {"case-3", {0.2e6, 0.035}},
        {"case-4", {0.55e6, 0.05}},     {"case-5", {0.0, 0.025}},       {"case-6", {1.0e6, 0.075}},
        {"case-3-all", {0.2e6, 0.035}}, {"case-4-all", {0.55e6, 0.05}}, {"case-5-all", {0.0, 0.025}},
        {"case-6-all", {1.0e6, 0.075}}};
    for (const auto& [name, expected] : cases) {
        const auto& [pressure, strain] = expected;
        const Scene scene = triaxial(name);
        EXPECT_EQ(scene.name, name);
        ASSERT_EQ(scene.loads.stages.size(), 2U) << name;
        EXPECT_EQ(scene.loads.stages[0].name, "pressure");
        EXPECT_EQ(scene.loads.stages[0].pressure, (std::map<int, double>{{1, pressure}, {2, pressure}, {3, pressure}}))
            << name;
        EXPECT_EQ(scene.loads.stages[1].name, "platen");
        EXPECT_EQ(scene.loads.stages[1].motion->boundary, 2);
        EXPECT_DOUBLE_EQ(scene.loads.stages[1].motion->value, strain) << name;
        EXPECT_THAT(scene.loads.supports, ElementsAre(Support::pinned, Support::none, Support::none, Support::none));
    }
}

TEST(TriaxialModels, DifferInWhatIsAPotentialCrack) {
    const auto is_bond = [](const Scene& scene, int type) {
        return scene.interface_types.at(type).kind == InterfaceKind::potential_crack;
    };
    const auto n_bonded_traces = [&](const Scene& scene) {
        return std::count_if(scene.geometry.fractures.begin(), scene.geometry.fractures.end(),
                             [&](const FractureTrace& trace) { return is_bond(scene, trace.interface_type); });
    };
    EXPECT_FALSE(triaxial("case-1").geometry.tessellation);
    EXPECT_EQ(triaxial("case-1").geometry.reference_spacing, 0.05);
    for (const char* name : {"case-2", "case-3", "case-4", "case-5", "case-6"}) {
        const Scene scene = triaxial(name);
        EXPECT_FALSE(is_bond(scene, scene.geometry.tessellation->interface_type)) << name;
        EXPECT_EQ(n_bonded_traces(scene), std::string(name) == "case-2" ? 0 : 3) << name;
    }
    for (const char* name : {"case-3-all", "case-4-all", "case-5-all", "case-6-all"}) {
        const Scene scene = triaxial(name);
        EXPECT_TRUE(is_bond(scene, scene.geometry.tessellation->interface_type)) << name;
        EXPECT_EQ(n_bonded_traces(scene), 0) << name;
    }
}

double dip(const Vec2& a, const Vec2& b) { return std::abs(std::atan2(b.y() - a.y(), b.x() - a.x())) / degree; }

/// Dips and meeting points of the reference problem, from its description rather than from the coordinates.
TEST(TriaxialModels, FracturesHaveTheDipsAndMeetTheMainOneAtTheHeightsOfTheReference) {
    const auto fractures = triaxial("case-1").geometry.fractures;
    ASSERT_EQ(fractures.size(), 3U);
    const auto& main = fractures[0].points;
    EXPECT_NEAR(dip(main[0], main[1]), 75.0, 1e-9);
    const Vec2 along = (main[1] - main[0]).normalized();
    const auto distance_from_main = [&](const Vec2& point) { return cross(along, point - main[0]); };
    EXPECT_NEAR(distance_from_main(Vec2(0.19, 0.5)), 0.0, 1e-12);
    const auto& left = fractures[1].points;
    EXPECT_NEAR(left.front().y(), 0.35, 1e-6);
    EXPECT_NEAR(180.0 - dip(left[0], left[1]), 25.0, 1e-9);
    const auto& right = fractures[2].points;
    EXPECT_NEAR(right.front().y(), 0.68, 1e-6);
    EXPECT_NEAR(dip(right[0], right[1]), 20.0, 1e-9);
    // The inner ends lie across the main fracture by a hair, the outer ones outside the specimen.
    EXPECT_LT(distance_from_main(left.front()), 0.0);
    EXPECT_GT(distance_from_main(left.front()), -2e-6);
    EXPECT_LT(left.back().x(), 0.0);
    EXPECT_GT(distance_from_main(right.front()), 0.0);
    EXPECT_LT(distance_from_main(right.front()), 2e-6);
    EXPECT_GT(right.back().x(), 0.38);
}

/// The parts of a split trace join at equal points and keep the line of the whole one.
TEST(TriaxialModels, PartsOfAFractureFormItsTrace) {
    const auto whole = triaxial("case-2").geometry.fractures;
    const auto parts = triaxial("case-3").geometry.fractures;
    ASSERT_EQ(parts.size(), 9U);
    for (int i = 0; i < 3; ++i) {
        EXPECT_EQ(parts[3 * i].points.front(), whole[i].points.front());
        EXPECT_EQ(parts[3 * i].points.back(), parts[3 * i + 1].points.front());
        EXPECT_EQ(parts[3 * i + 1].points.back(), parts[3 * i + 2].points.front());
        EXPECT_EQ(parts[3 * i + 2].points.back(), whole[i].points.back());
        const Vec2 along = (whole[i].points[1] - whole[i].points[0]).normalized();
        for (const auto& point : parts[3 * i + 1].points)
            EXPECT_NEAR(cross(along, point - whole[i].points[0]), 0.0, 1e-12);
    }
    EXPECT_NEAR((parts[1].points[1] - parts[1].points[0]).norm(), 0.2, 1e-9);
}

} // namespace
} // namespace kluft
