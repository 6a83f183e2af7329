#include "kluft/studies/comparison.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "kluft/output/atomic_file.hpp"
#include "output/hexagon_grid.hpp"
#include "output/temporary_directory.hpp"

namespace kluft {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using ::testing::StartsWith;
using testing::TemporaryDirectory;
using Rows = std::vector<StepRecord>;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

CrackRecord crack_at(double x, double y, CrackMode mode = CrackMode::tension, int interface = -1) {
    CrackRecord crack;
    crack.x = x;
    crack.y = y;
    crack.mode = mode;
    crack.interface = interface;
    return crack;
}

std::vector<std::pair<std::size_t, std::size_t>> pairs(const std::vector<CrackMatch>& matches) {
    std::vector<std::pair<std::size_t, std::size_t>> result;
    for (const CrackMatch& match : matches) result.emplace_back(match.a, match.b);
    return result;
}

StepRecord row(double strain, double stress) {
    StepRecord record;
    record.stage = 1;
    record.axial_strain = strain;
    record.differential_stress = record.axial_stress = stress;
    record.lateral_strain = -0.25 * strain;
    return record;
}

// ---- matching ------------------------------------------------------------------------------------------------------

// Distances 0.6 (a0 b0), 0.4 (a1 b0), 0.5 (a1 b1): the nearest pair leaves a0 and b1, 1.5 apart, alone.
TEST(CrackMatching, TakesTheNearestPairFirstAndEachCrackOnce) {
    const std::vector<CrackRecord> a{crack_at(0.0, 0.0), crack_at(1.0, 0.0)};
    const std::vector<CrackRecord> b{crack_at(0.6, 0.0), crack_at(1.5, 0.0)};
    const auto matches = match_cracks(a, b, 0.7);
    EXPECT_THAT(pairs(matches), ElementsAre(std::pair(1U, 0U)));
    EXPECT_NEAR(matches.front().distance, 0.4, 1e-15);
    EXPECT_THAT(pairs(match_cracks(a, b, 1.6)), ElementsAre(std::pair(0U, 1U), std::pair(1U, 0U)));
}

TEST(CrackMatching, KeepsTensionAndShearApart) {
    const std::vector<CrackRecord> a{crack_at(0.0, 0.0, CrackMode::tension), crack_at(0.0, 1.0, CrackMode::shear)};
    const std::vector<CrackRecord> b{crack_at(0.0, 0.0, CrackMode::shear), crack_at(0.0, 1.0, CrackMode::shear)};
    EXPECT_THAT(pairs(match_cracks(a, b, 0.5)), ElementsAre(std::pair(1U, 1U)));
}

// (3, 4) is 5 from the origin.
TEST(CrackMatching, ReachesAsFarAsOneSpacingAndNoFarther) {
    const std::vector<CrackRecord> a{crack_at(6.7e6, 0.0)};
    const std::vector<CrackRecord> b{crack_at(6.7e6 + 3.0, 4.0)};
    EXPECT_EQ(match_cracks(a, b, 5.0).size(), 1U);
    EXPECT_THAT(match_cracks(a, b, 4.99), IsEmpty());
}

TEST(CrackMatching, IsTheSameTheOtherWayRound) {
    std::vector<CrackRecord> a, b;
    for (int i = 0; i < 40; ++i) {
        const auto mode = i % 3 == 0 ? CrackMode::shear : CrackMode::tension;
        a.push_back(crack_at(std::sin(1.7 * i), std::cos(2.3 * i), mode));
        b.push_back(crack_at(std::sin(1.9 * i), std::cos(2.1 * i), mode));
    }
    const auto forward = match_cracks(a, b, 0.3);
    std::vector<std::pair<std::size_t, std::size_t>> backward;
    for (const auto& [i, j] : pairs(match_cracks(b, a, 0.3))) backward.emplace_back(j, i);
    EXPECT_THAT(pairs(forward), ::testing::UnorderedElementsAreArray(backward));
    EXPECT_GT(forward.size(), 5U);
}

TEST(CrackMatching, LeavesCracksWithoutAPlaceAlone) {
    EXPECT_THAT(match_cracks({crack_at(nan, 0.0)}, {crack_at(nan, 0.0), crack_at(0.0, 0.0)}, 1.0), IsEmpty());
    EXPECT_THAT(match_cracks({}, {crack_at(0.0, 0.0)}, 1.0), IsEmpty());
}

// ---- curves --------------------------------------------------------------------------------------------------------

// A straight line to 1 MPa at 1 %, and one through 0.6 MPa at half of it: apart by 0.1 MPa in the middle, falling to 0
// on both sides. Sum over 201 points: 0.1 (1 - |i - 100|/100) = 10, over 201. Up to half the strain 0.1 i/200 = 10.05.
TEST(CurveDifference, OfATriangleIsThatByHand) {
    const Rows line{row(0.0, 0.0), row(0.01, 1e6)};
    const Rows bent{row(0.0, 0.0), row(0.005, 0.6e6), row(0.01, 1e6), row(0.02, 0.0)};
    const auto whole = curve_difference(line, bent, 0.015, 1e6);
    ASSERT_TRUE(whole);
    EXPECT_NEAR(whole->largest, 0.1, 1e-12);
    EXPECT_NEAR(whole->mean, 10.0 / 201.0, 1e-12);
    EXPECT_EQ(whole->end, 0.01); // the line ends there
    const auto half = curve_difference(bent, line, 0.005, 2e6);
    EXPECT_NEAR(half->largest, 0.05, 1e-12);
    EXPECT_NEAR(half->mean, 0.025, 1e-12);
}

TEST(CurveDifference, LooksAtBalancedRowsOfGrowingStrainOnly) {
    const Rows line{row(0.0, 0.0), row(0.01, 1e6)};
    Rows disturbed{row(0.0, 0.0),   row(0.004, 5e6), row(0.006, 0.6e6), row(0.005, 9e6),
                   row(0.006, 7e6), row(nan, 0.0),   row(0.01, 1e6)};
    disturbed[1].balanced = false;
    EXPECT_NEAR(curve_difference(line, disturbed, 0.01, 1e6)->largest, 0.0, 1e-12);
}

// Where bonds break the stress falls at one strain: from 1 MPa at 0.5 % to 0.2 MPa, at which it stays.
TEST(CurveDifference, KeepsADropAtItsStrain) {
    const Rows coarse{row(0.0, 0.0),     row(0.005, 1e6),   row(0.005, 0.8e6),
                      row(0.005, 0.4e6), row(0.005, 0.2e6), row(0.01, 0.2e6)};
    const Rows fine{row(0.0, 0.0), row(0.005, 1e6), row(0.005, 0.2e6), row(0.0051, 0.2e6), row(0.01, 0.2e6)};
    EXPECT_NEAR(curve_difference(coarse, fine, 0.01, 1e6)->largest, 0.0, 1e-9);
    EXPECT_NEAR(*curve_distance(growing_curve(fine), growing_curve(coarse)), 0.0, 1e-9);
}

TEST(CurveDifference, IsNotKnownWithoutACommonRangeOrAStress) {
    const Rows line{row(0.0, 0.0), row(0.01, 1e6)};
    EXPECT_FALSE(curve_difference(line, line, 0.0, 1e6));
    EXPECT_FALSE(curve_difference(line, line, 0.01, 0.0));
    EXPECT_FALSE(curve_difference(line, line, 0.01, nan));
    EXPECT_FALSE(curve_difference(line, line, nan, 1e6));
    EXPECT_FALSE(curve_difference(line, {row(0.02, 0.0), row(0.03, 1e6)}, 0.03, 1e6));
    EXPECT_FALSE(curve_difference({}, line, 0.01, 1e6));
}

// ---- the table -----------------------------------------------------------------------------------------------------

/// Differential stress rises in a straight line to `peak` at 1 % strain and falls to half of it at 2 %.
FinishedRun triangle(const std::string& name, double peak) {
    FinishedRun run;
    run.name = name;
    run.directory = name;
    run.history.push_back(row(0.0, 0.0));
    run.history.front().stage = 0;
    for (int i = 1; i <= 40; ++i) {
        const double strain = 5e-4 * i;
        run.history.push_back(row(strain, peak * (i <= 20 ? strain / 0.01 : 1.5 - 0.5 * strain / 0.01)));
        run.history.back().step = i;
    }
    run.platen_stage = 1;
    run.cracks.emplace();
    run.numbers = curve_numbers({}, run.history, run.platen_stage, Plane::stress);
    return run;
}

const ComparedQuantity& quantity(const Comparison& comparison, const std::string& key) {
    const auto& all = comparison.table.quantities;
    const auto found = std::find_if(all.begin(), all.end(), [&](const auto& each) { return each.key == key; });
    EXPECT_NE(found, all.end()) << key;
    return *found;
}

// The second curve is 1.04 times the first: peak and modulus 4 % more, and the mean over the rise 2 % of the peak.
TEST(Comparison, MeasuresPeakModulusAndCurvesRelativeToTheFirstRun) {
    const auto comparison = compare_runs(triangle("a", 1e6), triangle("b", 1.04e6), 0.05);
    EXPECT_NEAR(*quantity(comparison, "peak_stress").difference, 0.04, 1e-12);
    EXPECT_NEAR(*quantity(comparison, "peak_strain").difference, 0.0, 1e-12);
    EXPECT_NEAR(*quantity(comparison, "youngs_modulus").difference, 0.04, 1e-9);
    EXPECT_NEAR(*quantity(comparison, "youngs_modulus").a, 100e6, 1e-2);
    EXPECT_NEAR(*quantity(comparison, "poissons_ratio").b, 0.25, 1e-9);
    EXPECT_NEAR(*quantity(comparison, "curve_largest").difference, 0.04, 1e-12);
    EXPECT_NEAR(*quantity(comparison, "curve_mean").difference, 0.02, 1e-12);
    EXPECT_TRUE(comparison.table.agree);
}

TEST(Comparison, MarksWhatMissesTheTolerance) {
    const auto comparison = compare_runs(triangle("a", 1e6), triangle("b", 1.04e6), 0.03);
    EXPECT_FALSE(comparison.table.agree);
    EXPECT_EQ(quantity(comparison, "peak_stress").verdict, Verdict::missed);
    EXPECT_EQ(quantity(comparison, "peak_strain").verdict, Verdict::within);
    EXPECT_EQ(quantity(comparison, "curve_mean").verdict, Verdict::within);
    EXPECT_EQ(quantity(comparison, "residual_stress").verdict, Verdict::not_judged);
    EXPECT_THAT(comparison_text(comparison.table),
                HasSubstr("do not agree within 3 %: peak axial stress, Young's modulus.\n"));
}

TEST(Comparison, OfARunWithItselfAgreesWithinNothing) {
    const FinishedRun run = triangle("a", 1e6);
    EXPECT_TRUE(compare_runs(run, run, 0.0).table.agree);
}

TEST(Comparison, WithoutPlatenStageHasNoModuliAndNoCurves) {
    FinishedRun run = triangle("a", 1e6);
    run.platen_stage.reset();
    run.numbers = curve_numbers({}, run.history, {}, Plane::stress);
    for (StepRecord& each : run.history) each.load_factor = 1.0;
    const auto comparison = compare_runs(run, run, 0.05);
    EXPECT_FALSE(quantity(comparison, "peak_stress").a);
    EXPECT_FALSE(quantity(comparison, "youngs_modulus").a);
    EXPECT_EQ(quantity(comparison, "youngs_modulus").verdict, Verdict::not_judged);
    EXPECT_FALSE(quantity(comparison, "curve_mean").difference);
    EXPECT_TRUE(comparison.table.agree); // in what is known, the load factor
    FinishedRun other = run;
    other.history.back().load_factor = 0.9;
    EXPECT_NEAR(*quantity(compare_runs(run, other, 0.05), "load_factor").difference, -0.1, 1e-12);
    EXPECT_FALSE(compare_runs(run, other, 0.05).table.agree);
    for (StepRecord& each : other.history) each = run.history.back();
    for (StepRecord& each : other.history) each.stage = 7;
    EXPECT_EQ(quantity(compare_runs(run, other, 0.05), "load_factor").verdict, Verdict::missed);
}

// The same slope at the same factor of safety, under loads whose strains differ by half.
TEST(Comparison, OfFactorsOfSafetyHasNoCurve) {
    const auto reduced = [](double stress) {
        FinishedRun run = triangle("a", stress);
        run.platen_stage.reset();
        run.numbers = curve_numbers({}, run.history, {}, Plane::stress);
        run.summary.emplace().results.factor_of_safety = 2.4;
        return run;
    };
    const auto comparison = compare_runs(reduced(1e6), reduced(2e6), 0.05);
    EXPECT_TRUE(comparison.table.agree);
    EXPECT_EQ(quantity(comparison, "curve_mean").verdict, Verdict::not_judged);
    EXPECT_EQ(quantity(comparison, "factor_of_safety").verdict, Verdict::within);
}

TEST(Comparison, OfARunWithoutAnyBalancedStepNeverAgrees) {
    FinishedRun none = triangle("none", 1e6);
    for (StepRecord& each : none.history) each.balanced = false;
    none.numbers = curve_numbers({}, none.history, 1, Plane::stress);
    EXPECT_FALSE(compare_runs(none, none, 0.05).table.agree);
    const auto comparison = compare_runs(triangle("a", 1e6), none, 0.05);
    EXPECT_EQ(quantity(comparison, "peak_stress").verdict, Verdict::missed);
    EXPECT_THAT(comparison.table.notes, ::testing::Contains(HasSubstr("none has no balanced equilibrium")));
    EXPECT_THAT(comparison_text(comparison.table), Not(HasSubstr("nan")));
}

// A run that was killed at 97 % of the other one's peak has none: its stress might have risen on.
TEST(Comparison, OfARunThatWasStoppedBeforeItsPeakNeverAgreesWithOneThatEnded) {
    const FinishedRun ended = [] {
        FinishedRun run = triangle("ended", 1e6);
        run.summary.emplace();
        run.summary->status = RunStatus::done;
        return run;
    }();
    FinishedRun stopped = triangle("stopped", 1e6);
    stopped.history.resize(20); // up to 0.95 %
    stopped.numbers = curve_numbers({}, stopped.history, stopped.platen_stage, Plane::stress);
    for (const bool was_killed : {true, false}) {
        if (!was_killed) {
            stopped.summary.emplace();
            stopped.summary->status = RunStatus::interrupted;
        }
        const auto comparison = compare_runs(ended, stopped, 0.06);
        EXPECT_FALSE(comparison.table.agree);
        EXPECT_EQ(quantity(comparison, "peak_stress").verdict, Verdict::missed);
        EXPECT_THAT(comparison.table.notes,
                    ::testing::Contains(HasSubstr("stopped was stopped before its stress fell")));
        EXPECT_TRUE(compare_runs(stopped, stopped, 0.0).table.agree); // as far as they went
    }
}

TEST(Comparison, OfARunWithoutDifferentialStressHasNoNumbersThatAreNone) {
    FinishedRun flat = triangle("flat", 0.0);
    const auto comparison = compare_runs(flat, triangle("b", 1e6), 0.05);
    EXPECT_FALSE(quantity(comparison, "peak_stress").difference);
    EXPECT_EQ(quantity(comparison, "peak_stress").verdict, Verdict::missed);
    for (const std::string& text : {comparison_text(comparison.table), comparison_markdown(comparison.table)})
        EXPECT_THAT(text, ::testing::AllOf(Not(HasSubstr("nan")), Not(HasSubstr("inf"))));
}

/// A body of hexagons 0.1 m wide, in a model without mechanics.
Model grid_model() {
    Model model;
    model.system = testing::hexagon_grid(4, 4, 0.1, {6.0, 7.0});
    return model;
}

/// The middle of an interface of the grid.
CrackRecord grid_crack(const Model& model, int interface, CrackMode mode) {
    const BlockSystem& system = model.system;
    const Interface& each = system.interfaces[interface];
    const Edge& edge = system.blocks[each.block_a].edges[each.edge_a];
    const Vec2 middle = system.origin + 0.5 * (edge_start(system, edge) + edge_end(system, edge));
    return crack_at(middle.x(), middle.y(), mode, interface);
}

struct CrackedRuns {
    FinishedRun a = triangle("a", 1e6);
    FinishedRun b = triangle("b", 1e6);

    CrackedRuns() {
        a.model = grid_model();
        b.model = grid_model();
        // The first broke in both; the second in a alone (b's is of the other mode); a third one far away in b alone.
        a.cracks = {grid_crack(*a.model, 0, CrackMode::tension), grid_crack(*a.model, 1, CrackMode::shear)};
        b.cracks = {grid_crack(*b.model, 0, CrackMode::tension), grid_crack(*b.model, 1, CrackMode::tension),
                    grid_crack(*b.model, 30, CrackMode::shear)};
    }
};

TEST(Comparison, CountsCracksByModeAndMatchesThemWithinOneSpacing) {
    const CrackedRuns runs;
    const auto comparison = compare_runs(runs.a, runs.b, 0.05);
    EXPECT_EQ(comparison.table.matching_distance, 0.1);
    EXPECT_EQ(quantity(comparison, "cracks_tension").a, 1.0);
    EXPECT_EQ(quantity(comparison, "cracks_tension").b, 2.0);
    EXPECT_NEAR(*quantity(comparison, "cracks_tension").difference, 1.0, 1e-15);
    EXPECT_EQ(quantity(comparison, "matched_cracks").a, 1.0);
    EXPECT_NEAR(*quantity(comparison, "matched_share").a, 1.0 / 2.0, 1e-15);
    EXPECT_NEAR(*quantity(comparison, "matched_share").b, 1.0 / 3.0, 1e-15);
}

TEST(Comparison, WithoutAnyCracksHasNoShareOfThem) {
    FinishedRun run = triangle("a", 1e6);
    run.model = grid_model();
    const auto comparison = compare_runs(run, run, 0.05);
    EXPECT_EQ(quantity(comparison, "matched_cracks").a, 0.0);
    EXPECT_FALSE(quantity(comparison, "matched_share").a);
    EXPECT_TRUE(comparison.table.agree);
}

TEST(Comparison, TakesTheLargerSpacingOfTwoBodiesAndSaysThatTheyDiffer) {
    CrackedRuns runs;
    runs.b.model->system = testing::hexagon_grid(2, 2, 0.25);
    const auto comparison = compare_runs(runs.a, runs.b, 0.05);
    EXPECT_EQ(comparison.table.matching_distance, 0.25);
    EXPECT_THAT(comparison.table.notes, ::testing::Contains(HasSubstr("the bodies differ: 16 blocks")));
}

TEST(CracksPlot, DividesCracksIntoThoseOfOneRunAndOfBoth) {
    const CrackedRuns runs;
    const auto plot = cracks_plot(runs.a, runs.b, compare_runs(runs.a, runs.b, 0.05).matches);
    ASSERT_EQ(plot.groups.size(), 3U);
    EXPECT_EQ(plot.groups[0].label, "in both: 1");
    EXPECT_EQ(plot.groups[0].cracks.size(), 2U); // that of each run
    EXPECT_EQ(plot.groups[1].label, "only a: 1");
    EXPECT_EQ(plot.groups[1].note, "0 in tension, 1 in shear");
    EXPECT_EQ(plot.groups[2].label, "only b: 2");
    // A hexagon's side is spacing/sqrt(3) long.
    for (const CrackGroup& group : plot.groups)
        for (const DrawnCrack& crack : group.cracks)
            EXPECT_NEAR((crack.end - crack.start).norm(), 0.1 / std::sqrt(3.0), 1e-9);
}

TEST(CracksPlot, MakesADotOfACrackThatIsNotAtItsInterface) {
    CrackedRuns runs;
    (*runs.a.cracks)[1].y += 0.05;
    runs.b.model.reset();
    const auto plot = cracks_plot(runs.a, runs.b, {});
    const DrawnCrack& moved = plot.groups[1].cracks[1];
    EXPECT_EQ(moved.start, moved.end);
    for (const DrawnCrack& crack : plot.groups[2].cracks) EXPECT_EQ(crack.start, crack.end);
    EXPECT_THAT(draw_cracks(runs.a.model->system, plot, PictureFormat::png), StartsWith("\x89PNG"));
}

TEST(Comparison, IsWrittenWithPicturesAndWithoutBlocksLeavesThePictureOfCracksOut) {
    const TemporaryDirectory directory;
    CrackedRuns runs;
    auto comparison = compare_runs(runs.a, runs.b, 0.05);
    write_comparison(directory / "c", runs.a, runs.b, comparison);
    for (const char* name : {"curves.png", "cracks.png"})
        EXPECT_THAT(read_file(directory / "c" / name), StartsWith("\x89PNG"));
    for (const char* name : {"curves.svg", "cracks.svg"})
        EXPECT_THAT(read_file(directory / "c" / name), HasSubstr("</svg>"));
    EXPECT_THAT(read_file(directory / "c/compare.md"), HasSubstr("](cracks.png)"));
    runs.a.model.reset();
    runs.b.model.reset();
    comparison = compare_runs(runs.a, runs.b, 0.05);
    write_comparison(directory / "c", runs.a, runs.b, comparison);
    EXPECT_FALSE(std::filesystem::exists(directory / "c/cracks.png"));
    const auto json = nlohmann::json::parse(read_file(directory / "c/compare.json"));
    EXPECT_TRUE(json["agree"]);
    EXPECT_TRUE(json["quantities"]["matched_cracks"]["a"].is_null());
    EXPECT_TRUE(json["matching_distance"].is_null());
    EXPECT_EQ(json["quantities"]["peak_stress"]["within"], true);
    EXPECT_EQ(json["pictures"], nlohmann::json::array({"curves.png"}));
}

} // namespace
} // namespace kluft
