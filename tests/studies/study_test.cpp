// What a study file expands to, and what is said of a wrong one.
#include "kluft/studies/study.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <numbers>
#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "kluft/core/diagnostics.hpp"
#include "output/temporary_directory.hpp"
#include "scene/scene_text.hpp"

namespace kluft {
namespace {

using test::full_scene;
using test::messages_of;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::SizeIs;
using ::testing::StartsWith;
using testing::TemporaryDirectory;
using Words = std::vector<std::string>;

class StudyFile : public ::testing::Test {
protected:
    StudyFile() { std::ofstream(directory_ / "scene.yaml") << full_scene; }

    ReadStudy read(const std::string& text, const Words& overrides = {}) const {
        return read_study_text("scene: scene.yaml\n" + text, overrides, directory_ / "study.yaml");
    }
    Words refusals(const std::string& text, const Words& overrides = {}) const {
        return messages_of([&] { return read(text, overrides); });
    }

    TemporaryDirectory directory_;
};

Words values_of(const StudyParameter& parameter) {
    Words values;
    for (const auto& each : parameter.values) values.push_back(each.value);
    return values;
}

Words names_in(const ReadStudy& read) {
    Words names;
    for (const auto& one : read.cases) names.push_back(one.name);
    return names;
}

Words assignments_of(const PlannedCase& one) {
    Words words;
    for (const auto& setting : one.set) words.push_back(setting.assignment());
    return words;
}

TEST_F(StudyFile, WithoutAnythingToVaryHasOneCase) {
    const ReadStudy study = read("");
    EXPECT_THAT(names_in(study), ElementsAre("case"));
    EXPECT_THAT(study.study.quantities, ElementsAre("peak_stress", "peak_strain"));
    EXPECT_EQ(study.cases[0].steps, 3 + 40 + 1 + 5);
}

TEST_F(StudyFile, RangesAreArithmeticByCountAndGeometricByFactor) {
    const ReadStudy study = read("vary:\n"
                                 "  geometry.tessellation.hexagons.rotation: {from: 0, to: 30, count: 4}\n"
                                 "  solver.tolerance: {from: 1e-3, to: 1e-7, factor: 0.1}\n"
                                 "  stages.1.steps: {from: 25, to: 790, factor: 2}\n");
    ASSERT_THAT(study.study.parameters, SizeIs(3));
    EXPECT_THAT(values_of(study.study.parameters[0]), ElementsAre("0", "10", "20", "30"));
    EXPECT_THAT(values_of(study.study.parameters[1]), ElementsAre("0.001", "0.0001", "1e-05", "1e-06", "1e-07"));
    EXPECT_THAT(values_of(study.study.parameters[2]), ElementsAre("25", "50", "100", "200", "400")); // not past the end
    EXPECT_THAT(study.cases, SizeIs(4 * 5 * 5));
}

TEST_F(StudyFile, ProductTakesEveryCombinationTheLastParameterFirst) {
    const ReadStudy study = read("set: {cracks.update: all}\n"
                                 "vary: {stages.1.steps: [5, 10], materials.rock.cohesion: [1 MPa, 2 MPa, 3 MPa]}\n");
    EXPECT_THAT(names_in(study),
                ElementsAre("steps=5,cohesion=1MPa", "steps=5,cohesion=2MPa", "steps=5,cohesion=3MPa",
                            "steps=10,cohesion=1MPa", "steps=10,cohesion=2MPa", "steps=10,cohesion=3MPa"));
    EXPECT_THAT(assignments_of(study.cases[4]),
                ElementsAre("cracks.update=all", "stages.1.steps=10", "materials.rock.cohesion=2 MPa"));
    EXPECT_THAT(study.cases[4].settings, ElementsAre("10", "2 MPa"));
}

TEST_F(StudyFile, TogetherTakesTheParametersElementByElement) {
    const ReadStudy study =
        read("vary: {stages.1.steps: [5, 10], solver.tolerance: [1e-4, 1e-5]}\ncombine: together\n");
    EXPECT_THAT(names_in(study), ElementsAre("steps=5,tolerance=1e-4", "steps=10,tolerance=1e-5"));
    EXPECT_THAT(reference_cases(study.study, study.cases), ElementsAre(1U, 1U));
    EXPECT_THAT(refusals("vary: {stages.1.steps: [5, 10], solver.tolerance: [1e-4]}\ncombine: together\n"),
                ElementsAre(HasSubstr("vary.solver.tolerance: expected 2 values as of stages.1.steps")));
}

TEST_F(StudyFile, VariantsAreCrossedWithWhatVariesAndMayVaryMore) {
    const ReadStudy study =
        read("vary: {stages.1.steps: [5, 10]}\n"
             "variants:\n"
             "  - {name: all, set: {cracks.update: all}}\n"
             "  - {name: event, set: {cracks.update: event}, vary: {cracks.event_tolerance: [0.1, 0.2]}}\n");
    EXPECT_THAT(names_in(study), ElementsAre("all,steps=5", "all,steps=10", "event,steps=5,event_tolerance=0.1",
                                             "event,steps=5,event_tolerance=0.2", "event,steps=10,event_tolerance=0.1",
                                             "event,steps=10,event_tolerance=0.2"));
    EXPECT_THAT(study.cases[0].settings, ElementsAre("5", ""));
    EXPECT_THAT(study.cases[5].settings, ElementsAre("10", "0.2"));
    EXPECT_EQ(study.cases[5].variant, "event");
}

TEST_F(StudyFile, KnowsWhatTheSceneSaysItself) {
    const ReadStudy study =
        read("set: {cracks.every: 3}\n"
             "vary: {stages.1.steps: [5, 10], solver.detection_every: [1, 2]}\n"
             "variants:\n"
             "  - {name: one}\n"
             "  - {name: more, vary: {cracks.every: [5, 6], geometry.tessellation.hexagons: [null],\n"
             "                        geometry.tessellation.voronoi.spacing: [0.2],\n"
             "                        geometry.tessellation.voronoi.seed: [1, 2]}}\n");
    // the scene's, the default, that of `set`, a mapping, nothing, nothing below what is not there
    EXPECT_THAT(study.study.own_settings, ElementsAre("40", "1", "3", "{...}", "", ""));
}

TEST_F(StudyFile, NamesOfCasesStayWhenAValueIsAddedAndDifferWhenTheyAreCut) {
    const auto few = names_in(read("vary: {stages.1.steps: [5, 20], materials.rock.cohesion: [1 MPa]}\n"));
    const auto more = names_in(read("vary: {stages.1.steps: [5, 10, 20], materials.rock.cohesion: [1 MPa, 2 MPa]}\n"));
    for (const auto& name : few) EXPECT_THAT(more, ::testing::Contains(name));
    const auto long_ones =
        names_in(read("vary: {title: ['" + std::string(200, 'a') + "', '" + std::string(201, 'a') + "', 'a/b']}\n"));
    EXPECT_NE(long_ones[0], long_ones[1]);
    for (const auto& name : long_ones) EXPECT_LT(name.size(), 100U);
    EXPECT_THAT(long_ones[2], StartsWith("title=_a_b_-"));
}

TEST_F(StudyFile, ReferenceIsTheFinestCaseOfEachGroupUnlessAnotherOneIsNamed) {
    const std::string varied =
        "vary: {solver.tolerance: [1e-4, 1e-5], stages.1.steps: [5, 10, 20]}\nalong: stages.1.steps\n"
        "variants: [{name: all, set: {cracks.update: all}}, {name: event, set: {cracks.update: event}}]\n";
    const ReadStudy finest = read(varied); // cases 0-5 all, 6-11 event
    EXPECT_THAT(reference_cases(finest.study, finest.cases),
                ElementsAre(2U, 2U, 2U, 5U, 5U, 5U, 8U, 8U, 8U, 11U, 11U, 11U));
    const ReadStudy named = read(varied + "reference: {case: {variant: event}}\n");
    EXPECT_THAT(reference_cases(named.study, named.cases),
                ElementsAre(8U, 8U, 8U, 11U, 11U, 11U, 8U, 8U, 8U, 11U, 11U, 11U));
    const ReadStudy one =
        read(varied + "reference: {case: {variant: all, stages.1.steps: 10.0, solver.tolerance: 1e-5}}\n");
    EXPECT_THAT(reference_cases(one.study, one.cases), ::testing::Each(4U));
    const ReadStudy none = read(varied + "reference: none\n");
    EXPECT_THAT(reference_cases(none.study, none.cases), ::testing::Each(std::nullopt));
}

// Of strengths, stiffnesses and loads none is the finest: the last one was, and recommended.
TEST_F(StudyFile, NoStiffnessOfTheRockLeadsToTheFinestCase) {
    EXPECT_EQ(read("vary: {materials.rock.youngs_modulus: [1e9, 2e9]}\n").study.along, std::nullopt);
    const std::string both = "vary: {materials.rock.youngs_modulus: [1e9, 2e9], stages.1.steps: [5, 10]}\n";
    EXPECT_EQ(read(both).study.along, 1U);
    EXPECT_EQ(read(both + "along: materials.rock.youngs_modulus\n").study.along, 0U); // who asks for it has it
    EXPECT_EQ(read("vary: {geometry.tessellation.hexagons.spacing: [0.5, 0.3]}\n").study.along, 0U);
}

TEST_F(StudyFile, OneReferenceServesVariantsThatVaryOtherKeys) {
    const ReadStudy study =
        read("variants:\n"
             "  - {name: steps, vary: {stages.1.steps: [5, 10]}}\n"
             "  - {name: size, vary: {stages.1.steps: [10], geometry.tessellation.hexagons.spacing: [0.3, 0.5]}}\n"
             "  - {name: best, vary: {stages.1.steps: [50]}}\n"
             "reference: {case: {variant: best, stages.1.steps: 50}}\n");
    EXPECT_THAT(names_in(study),
                ElementsAre("steps,steps=5", "steps,steps=10", "size,spacing=0.3", "size,spacing=0.5", "best"));
    EXPECT_THAT(reference_cases(study.study, study.cases), ::testing::Each(4U));
}

// ---- replicas ------------------------------------------------------------------------------------------------------

double angle_of(const StudySetting& setting) { return std::stod(setting.value); }

TEST_F(StudyFile, ReplicasAreTheSameInEveryGroupAndCompareWithTheirOwnKind) {
    const ReadStudy study = read("vary: {stages.1.steps: [5, 10]}\n"
                                 "replicas: {count: 3, seed: 7, strength_noise: 0, offset: true, rotation: 5}\n");
    EXPECT_THAT(names_in(study),
                ElementsAre("steps=5,r0", "steps=5,r1", "steps=5,r2", "steps=10,r0", "steps=10,r1", "steps=10,r2"));
    EXPECT_THAT(reference_cases(study.study, study.cases), ElementsAre(3U, 4U, 5U, 3U, 4U, 5U));
    std::set<std::string> offsets;
    for (int k = 0; k < 3; ++k) {
        const auto& coarse = study.cases[k].set;
        const auto& fine = study.cases[k + 3].set;
        ASSERT_THAT(coarse, SizeIs(3));
        EXPECT_EQ(coarse[1].assignment(), fine[1].assignment());
        EXPECT_EQ(coarse[2].assignment(), fine[2].assignment());
        EXPECT_EQ(coarse[1].key, "geometry.tessellation.hexagons.rotation");
        EXPECT_NEAR(angle_of(coarse[1]), 15.0, 5.0); // the scene's own net is turned by 15 degrees
        offsets.insert(coarse[2].value);
    }
    EXPECT_THAT(offsets, SizeIs(3));
}

TEST(Replicas, OffsetIsAPartOfThePeriodOfTheNet) {
    const ReplicaPlan plan{.count = 200, .seed = 3, .strength_noise = 0.02, .offset = true};
    HexagonLattice net;
    net.spacing = 0.3;
    double sum_u = 0.0, sum_v = 0.0;
    for (int k = 0; k < plan.count; ++k) {
        const auto settings = replica_settings(plan, k, {net});
        ASSERT_THAT(settings, SizeIs(3));
        EXPECT_EQ(settings[0].assignment(), "cracks.strength_noise=0.02");
        EXPECT_EQ(settings[1].key, "cracks.strength_seed");
        double x = 0.0, y = 0.0;
        ASSERT_EQ(std::sscanf(settings[2].value.c_str(), "[%lf, %lf]", &x, &y), 2);
        // Periods of the net: (d, 0) and (d/2, sqrt(3)/2 d).
        const double v = y / (0.5 * std::numbers::sqrt3 * net.spacing);
        const double u = x / net.spacing - 0.5 * v;
        EXPECT_TRUE(u >= -1e-9 && u < 1.0 && v >= 0.0 && v < 1.0) << u << ' ' << v;
        sum_u += u;
        sum_v += v;
    }
    // Mean of uniform numbers; 4 standard deviations of the mean of 200 are 4/sqrt(12 * 200) = 0.08.
    EXPECT_NEAR(sum_u / plan.count, 0.5, 0.08);
    EXPECT_NEAR(sum_v / plan.count, 0.5, 0.08);
}

TEST(Replicas, OfVoronoiCellsHaveOtherCells) {
    const ReplicaPlan plan{.count = 2, .strength_noise = 0.0, .offset = true, .rotation = 5.0};
    const auto first = replica_settings(plan, 0, {.voronoi = true});
    const auto second = replica_settings(plan, 1, {.voronoi = true});
    ASSERT_THAT(first, SizeIs(1));
    EXPECT_EQ(first[0].key, "geometry.tessellation.voronoi.seed");
    EXPECT_NE(first[0].value, second[0].value);
}

// ---- mistakes ------------------------------------------------------------------------------------------------------

TEST_F(StudyFile, UnknownKeysOfTheStudyAreNamedWithTheNearestOne) {
    EXPECT_THAT(refusals("titel: x\nquantities: [peak_stres]\nalong: steps\n"),
                ElementsAre(AllOf(HasSubstr("study.yaml:2:1: titel: unknown key"), HasSubstr("did you mean 'title'?"),
                                  HasSubstr("\n  titel: x")),
                            AllOf(HasSubstr("study.yaml:3:14: quantities"), HasSubstr("did you mean 'peak_stress'?")),
                            HasSubstr("study.yaml:4:8: along")));
}

TEST_F(StudyFile, WrongKeysAndValuesOfTheSceneAreNamedAtTheirPlaceInTheStudy) {
    EXPECT_THAT(
        refusals("set: {cracks.updaet: all}\nvary:\n  stages.1.steps: [5, 7.5, 10]\n  materials.rock.cohesion: [1 kPa, "
                 "3 m]\n"),
        ElementsAre(AllOf(HasSubstr("study.yaml:2:22: cracks.updaet: "), HasSubstr("did you mean 'update'?")),
                    AllOf(HasSubstr("study.yaml:4:23: stages.1.steps: expected an integer >= 1, found '7.5'"),
                          HasSubstr("\n    stages.1.steps: [5, 7.5, 10]")),
                    HasSubstr("study.yaml:5:36: materials.rock.cohesion: expected a number >= 0 in Pa, found '3 m'")));
    EXPECT_THAT(refusals("", {"cracks.every=x"}),
                ElementsAre(StartsWith("--set cracks.every=x: cracks.every: expected")));
}

TEST_F(StudyFile, RangesThatLeadNowhereAreRefused) {
    EXPECT_THAT(refusals("vary: {solver.tolerance: {from: 1e-3, to: 1e-7, factor: 2}}\n"),
                ElementsAre(HasSubstr("expected a positive factor")));
    EXPECT_THAT(refusals("vary: {solver.tolerance: {from: 1e-3, to: 1e-7}}\n"),
                ElementsAre(HasSubstr("neither count nor factor")));
    EXPECT_THAT(refusals("vary: {solver.tolerance: {from: 1e-3, count: 3}}\n"),
                ElementsAre(HasSubstr("tolerance.to: expected a number, found nothing")));
    EXPECT_THAT(refusals("vary: {solver.tolerance: 5}\n"), ElementsAre(HasSubstr("expected a list of values")));
    EXPECT_THAT(refusals("vary: {stages.1.steps: [5, 5.0]}\n"), ElementsAre(HasSubstr("twice")));
}

TEST_F(StudyFile, ReferencesThatAreNotThereAreRefused) {
    const std::string varied = "vary: {stages.1.steps: [5, 10]}\n";
    EXPECT_THAT(refusals(varied + "reference: coarsest\n"), ElementsAre(HasSubstr("expected finest, none")));
    EXPECT_THAT(refusals(varied + "reference: {case: {stages.1.steps: 7}}\n"),
                ElementsAre(HasSubstr("expected one of 5, 10, found '7'")));
    EXPECT_THAT(refusals(varied + "reference: {case: {step: 7}}\n"),
                ElementsAre(HasSubstr("expected one of stages.1.steps, variant")));
    EXPECT_THAT(refusals(varied + "reference: {directory: absent}\n"), ElementsAre(HasSubstr("no summary.json")));
    EXPECT_THAT(refusals(varied + "reference: {values: {peak: 1}}\n"),
                ElementsAre(HasSubstr("expected one of peak_stress, peak_strain")));
}

TEST_F(StudyFile, KeysThatVaryCannotBeSetToo) {
    EXPECT_THAT(refusals("vary: {stages.1.steps: [5, 10]}\nset: {stages.1.steps: 3}\n"),
                ElementsAre(HasSubstr("study.yaml:3:23: set: expected a key that does not vary")));
    EXPECT_THAT(refusals("vary: {stages.1.steps: [5, 10]}\n", {"stages.1.steps=3"}),
                ElementsAre(StartsWith("--set stages.1.steps=3: ")));
}

// A mapping sets the keys in it, a list or a value takes the place of all below it.
TEST_F(StudyFile, KeysThatSetEachOthersValuesAreRefused) {
    EXPECT_TRUE(sets_key({"stages.1", "{steps: 3}", {}}, "stages.1.steps"));
    EXPECT_FALSE(sets_key({"stages.1", "{name: platen}", {}}, "stages.1.steps"));
    EXPECT_FALSE(sets_key({"stages.1", "{steps: 3}", {}}, "stages.11.steps"));
    EXPECT_FALSE(sets_key({"stages.1.steps", "3", {}}, "stages.1"));
    EXPECT_TRUE(sets_key({"stages", "[{steps: 3}]", {}}, "stages.1.steps"));
    EXPECT_TRUE(sets_key({"geometry.tessellation.triangles", "null", {}}, "geometry.tessellation.triangles.seed"));

    EXPECT_THAT(
        refusals("vary: {stages.1.steps: [5, 8], stages.1: [{steps: 3}, {steps: 4}]}\n"),
        ElementsAre(HasSubstr("vary: expected keys that do not set each other's values, found 'stages.1.steps', "
                              "which 'stages.1' sets too")));
    EXPECT_THAT(refusals("vary: {stages.1: [{steps: 3}, {steps: 4}]}\nset: {stages.1.steps: 3}\n"),
                ElementsAre(HasSubstr("set: expected a key that does not vary")));
    EXPECT_THAT(
        refusals("variants: [{name: a, set: {stages.1.steps: 7}, vary: {stages.1: [{steps: 3}, {steps: 4}]}}]\n"),
        ElementsAre(HasSubstr("variant a: expected keys that do not vary, found 'stages.1.steps', which "
                              "'stages.1' sets too")));
    EXPECT_EQ(read("vary: {stages.1.steps: [5, 8], stages.1: [{name: a}, {name: b}]}\n").cases.size(), 4U);
}

TEST_F(StudyFile, CasesWhoseValuesDoNotGoTogetherAreRefusedOneByOne) {
    const ReadStudy study = read("vary: {interfaces.bond.kind: [potential_crack, fracture]}\n");
    EXPECT_EQ(study.cases[0].refusal, "");
    EXPECT_THAT(study.cases[1].refusal, HasSubstr("interfaces.bond.fails_to: expected nothing for a fracture"));
    EXPECT_THAT(refusals("set: {interfaces.bond.kind: fracture}\n"), ElementsAre(StartsWith("no case can be run")));
}

TEST_F(StudyFile, MoreCasesThanAnyoneWaitsForAreRefused) {
    EXPECT_THAT(
        refusals(
            "vary: {stages.1.steps: {from: 1, to: 200, count: 200}, stages.3.steps: {from: 1, to: 200, count: 200}}\n"),
        ElementsAre(HasSubstr("expected at most 10000 cases, found 40000")));
}

TEST_F(StudyFile, DigestOfACaseChangesWithItsSceneOnly) {
    const std::string text = "vary: {stages.1.steps: [5, 10]}\n";
    const auto before = read(text);
    EXPECT_NE(before.cases[0].digest, before.cases[1].digest);
    EXPECT_EQ(read(text + "title: other\n").cases[0].digest, before.cases[0].digest);
    std::ofstream(directory_ / "scene.yaml") << full_scene << "# a remark\n";
    EXPECT_EQ(read(text).cases[0].digest, before.cases[0].digest);
    EXPECT_NE(read(text + "set: {solver.tolerance: 1e-4}\n").cases[0].digest, before.cases[0].digest);
}

} // namespace
} // namespace kluft
