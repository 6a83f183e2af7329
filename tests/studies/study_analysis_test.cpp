#include "kluft/studies/study_analysis.hpp"

#include <cmath>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "studies/made_table.hpp"

namespace kluft {
namespace {

using testing::done_case;
using ::testing::ElementsAre;
using ::testing::IsEmpty;
using testing::made_table;

std::vector<double> power_law(const std::vector<double>& sizes, double limit, double factor, double order) {
    std::vector<double> values;
    for (const double size : sizes) values.push_back(limit + factor * std::pow(size, order));
    return values;
}

TEST(Richardson, FindsOrderAndLimitOfExactSequences) {
    const std::vector<double> sizes{0.08, 0.04, 0.02, 0.01};
    for (const double order : {0.5, 1.0, 2.0, 4.0}) {
        const Convergence found = convergence(sizes, power_law(sizes, 1.39, -3.0, order));
        ASSERT_EQ(found.kind, ConvergenceKind::monotone) << order;
        EXPECT_NEAR(*found.order, order, 1e-6);
        EXPECT_NEAR(*found.limit, 1.39, 1e-9);
        // 1.25 times the error of the finest value
        EXPECT_NEAR(*found.uncertainty, 1.25 * 3.0 * std::pow(0.01, order) / 1.39, 1e-9);
    }
}

TEST(Richardson, FitsSizesOfUnequalRatios) {
    const std::vector<double> sizes{1.0 / 25, 1.0 / 60, 1.0 / 100, 1.0 / 270};
    for (const double order : {1.0, 2.0}) {
        const Convergence found = convergence(sizes, power_law(sizes, 5.0, 2.0, order));
        ASSERT_EQ(found.kind, ConvergenceKind::monotone);
        EXPECT_NEAR(*found.order, order, 1e-4);
        EXPECT_NEAR(*found.limit, 5.0, 1e-6);
    }
}

// The friction of model (b) at 0.9 % strain with 9, 18, ..., 288 steps: first order, as measured.
TEST(Richardson, SeesTheFirstOrderOfFriction) {
    const std::vector<double> sizes{1.0 / 36, 1.0 / 72, 1.0 / 144, 1.0 / 288};
    const Convergence found = convergence(sizes, {1.2528, 1.2540, 1.2546, 1.2549});
    ASSERT_EQ(found.kind, ConvergenceKind::monotone);
    EXPECT_NEAR(*found.order, 1.0, 1e-9);
    EXPECT_NEAR(*found.limit, 1.2552, 1e-9);
}

TEST(Richardson, GivesNoOrderOfValuesThatGoUpAndDown) {
    // Peaks of event runs with 14, 28, ..., 224 steps (MPa): spread 0.35 % of the mean of the last four.
    const std::vector<double> sizes{1.0 / 14, 1.0 / 28, 1.0 / 56, 1.0 / 112, 1.0 / 224};
    const Convergence found = convergence(sizes, {1.3972, 1.3996, 1.3992, 1.3952, 1.4003});
    EXPECT_EQ(found.kind, ConvergenceKind::scattered);
    EXPECT_FALSE(found.order);
    EXPECT_FALSE(found.limit);
    EXPECT_NEAR(found.scatter, (1.4003 - 1.3952) / 1.398575, 1e-6);
}

TEST(Richardson, GivesNoOrderWhereTwoEstimatesDisagreeOrStepsGrow) {
    const std::vector<double> sizes{0.08, 0.04, 0.02, 0.01};
    const Convergence unsettled = convergence(sizes, {1.0, 1.1, 1.19, 1.20}); // orders 0.15 and 3.2
    EXPECT_EQ(unsettled.kind, ConvergenceKind::unsettled);
    EXPECT_FALSE(unsettled.limit);
    EXPECT_NEAR(*unsettled.uncertainty, 0.2 / 1.2, 1e-12); // three times the mean change of 0.2/3
    EXPECT_EQ(convergence(sizes, {1.0, 1.1, 1.3, 1.7}).kind, ConvergenceKind::scattered);
}

TEST(Richardson, SaysWhenThereAreTooFewValuesOrNoChange) {
    EXPECT_EQ(convergence({0.1, 0.05}, {1.0, 2.0}).kind, ConvergenceKind::too_few);
    EXPECT_EQ(convergence({}, {}).kind, ConvergenceKind::too_few);
    const Convergence constant = convergence({0.4, 0.2, 0.1}, {3.0, 3.0, 3.0});
    EXPECT_EQ(constant.kind, ConvergenceKind::constant);
    EXPECT_DOUBLE_EQ(*constant.limit, 3.0);
}

TEST(StudySettings, AreNumbersInSiAndSizesThatShrink) {
    EXPECT_DOUBLE_EQ(*refinement_size("stages.1.steps", "200"), 0.005);
    EXPECT_DOUBLE_EQ(*refinement_size("geometry.tessellation.hexagons.spacing", "5 cm"), 0.05);
    EXPECT_DOUBLE_EQ(*refinement_size("solver.tolerance", "1e-5"), 1e-5);
    EXPECT_FALSE(refinement_size("cracks.update", "event"));
    EXPECT_FALSE(refinement_size("solver.tolerance", ""));
}

TEST(StudySettings, TellRefinementsFromMethodsAndModels) {
    EXPECT_EQ(parameter_kind("stages.0.steps"), ParameterKind::refinement);
    EXPECT_EQ(parameter_kind("solver.tolerance"), ParameterKind::refinement);
    EXPECT_EQ(parameter_kind("cracks.update"), ParameterKind::method);
    EXPECT_EQ(parameter_kind("analysis.integrator"), ParameterKind::method);
    EXPECT_EQ(parameter_kind("analysis.kinematics"), ParameterKind::model);
    EXPECT_EQ(parameter_kind("geometry.tessellation.hexagons.rotation"), ParameterKind::model);
    EXPECT_EQ(parameter_kind("interfaces.joint.friction_angle"), ParameterKind::model);
}

TEST(StudySeries, JoinsCasesThatDifferInOneParameterFromCoarseToFine) {
    StudyTable table = made_table({"stages.0.steps", "cracks.update"}, 0);
    table.cases = {done_case({"100", "all"}, 1.0, 0.0, 1.0), done_case({"25", "all"}, 1.0, 0.0, 1.0),
                   done_case({"50", "event"}, 1.0, 0.0, 1.0), done_case({"50", "all"}, 1.0, 0.0, 1.0)};
    const auto groups = study_groups(table);
    const auto series = study_series(table, groups);
    ASSERT_EQ(series.size(), 1U); // one case of event alone is no series
    ASSERT_EQ(series[0].levels.size(), 3U);
    EXPECT_EQ(groups[series[0].levels[0].group].settings[0], "25");
    EXPECT_EQ(groups[series[0].levels[2].group].settings[0], "100");
}

TEST(StudySeries, RunsAlongOtherRefinementsWhereTheyAddCases) {
    StudyTable table = made_table({"stages.0.steps", "solver.tolerance"}, 0);
    table.cases = {done_case({"25", "1e-5"}, 1.0, 0.0, 1.0), done_case({"50", "1e-5"}, 1.0, 0.0, 1.0),
                   done_case({"50", "1e-3"}, 1.0, 0.0, 1.0)};
    const auto series = study_series(table, study_groups(table));
    ASSERT_EQ(series.size(), 2U);
    EXPECT_EQ(series[1].parameter, 1U);
}

TEST(StudyGroups, KeepVariantsApartOnlyWhereTheyHoldHiddenSettings) {
    StudyTable table = made_table({"stages.0.steps"}, 0);
    table.cases = {done_case({"25"}, 1.0, 0.0, 1.0), done_case({"50"}, 1.0, 0.0, 1.0)};
    table.cases[0].variant = "a";
    table.cases[1].variant = "b";
    EXPECT_EQ(study_series(table, study_groups(table)).size(), 1U);
    table.cases.push_back(done_case({"50"}, 1.1, 0.0, 1.0));
    table.cases.back().variant = "a";
    EXPECT_EQ(study_groups(table).size(), 3U);
    ASSERT_EQ(study_series(table, study_groups(table)).size(), 1U); // 25 and 50 of variant a
}

TEST(SeriesValues, AreMeansOverTheReplicasThatAllLevelsHave) {
    StudyTable table = made_table({"stages.0.steps"}, 0);
    table.cases = {done_case({"25"}, 1.0, 0.0, 1.0), done_case({"25"}, 3.0, 0.0, 1.0), done_case({"50"}, 5.0, 0.0, 1.0),
                   done_case({"50"}, 9.0, 0.0, 1.0)};
    table.cases[1].replica = table.cases[3].replica = 1;
    const auto values = [&] {
        const auto groups = study_groups(table);
        return series_values(table, groups, study_series(table, groups).front(), study_measures(table).front()).values;
    };
    EXPECT_THAT(values(), ElementsAre(2.0, 7.0));
    table.cases[3].status = CaseStatus::failed;
    EXPECT_THAT(values(), ElementsAre(1.0, 5.0));
}

/// Whether no other balanced point is at least as good in both and better in one: O(n^2), from the definition.
bool is_on_front(const std::vector<WorkPoint>& points, std::size_t i) {
    if (!points[i].balanced) return false;
    for (const WorkPoint& other : points) {
        const bool as_good = other.cpu_s <= points[i].cpu_s && other.error <= points[i].error;
        const bool better = other.cpu_s < points[i].cpu_s || other.error < points[i].error;
        if (other.balanced && as_good && better) return false;
    }
    return true;
}

TEST(WorkPrecision, MarksThePointsThatNoOtherBeats) {
    std::mt19937 random(5);
    std::uniform_real_distribution<double> uniform(0.0, 1.0);
    for (int repeat = 0; repeat < 50; ++repeat) {
        StudyTable table = made_table({"stages.0.steps"}, 0);
        std::vector<bool> unbalanced;
        for (int i = 0; i < 40; ++i) {
            table.cases.push_back(done_case({"1"}, 1.0, uniform(random) - 0.5, uniform(random)));
            unbalanced.push_back(uniform(random) < 0.2);
        }
        const auto points =
            work_precision(table, study_measures(table).front(), std::vector<bool>(40, true), unbalanced);
        ASSERT_EQ(points.size(), 40U);
        for (std::size_t i = 0; i < points.size(); ++i) EXPECT_EQ(points[i].on_front, is_on_front(points, i));
    }
}

TEST(WorkPrecision, LeavesOutFailedCasesTheReferenceAndWhatIsNotChosen) {
    StudyTable table = made_table({"stages.0.steps"}, 0);
    for (int i = 0; i < 4; ++i) table.cases.push_back(done_case({"1"}, 1.0, 0.1, 1.0 + i));
    table.cases[0].status = CaseStatus::no_equilibrium;
    table.reference = 1;
    const auto points =
        work_precision(table, study_measures(table).front(), {true, true, true, false}, std::vector<bool>(4, false));
    ASSERT_EQ(points.size(), 1U);
    EXPECT_EQ(points[0].study_case, 2U);
}

/// Step counts with their errors; each costs as many seconds as it has steps.
StudyTable step_table(const std::vector<std::pair<std::string, double>>& errors) {
    StudyTable table = made_table({"stages.0.steps"}, 0);
    for (const auto& [steps, error] : errors)
        table.cases.push_back(done_case({steps}, 1.0 + error, error, std::stod(steps)));
    return table;
}

std::optional<std::string> cheapest(const StudyTable& table, double bound, const std::vector<bool>& unbalanced = {}) {
    const auto groups = study_groups(table);
    const auto advice = cheapest_settings(table, groups, study_measures(table).front(), unbalanced, {bound});
    if (!advice.front().group) return std::nullopt;
    return groups[*advice.front().group].settings[0];
}

TEST(CheapestSettings, TakeNoLuckyHits) {
    StudyTable table = step_table({{"25", 0.001}, {"50", -0.03}, {"100", 0.015}, {"200", -0.004}, {"400", 0.0}});
    table.reference = 4;
    EXPECT_EQ(cheapest(table, 0.05), "25");
    EXPECT_EQ(cheapest(table, 0.02), "100"); // 25 would do, but 50 does not
    EXPECT_EQ(cheapest(table, 0.01), "200");
    EXPECT_EQ(cheapest(table, 0.001), "400"); // the reference itself
    const auto groups = study_groups(table);
    const auto advice = cheapest_settings(table, groups, study_measures(table).front(), {}, {0.02, 0.01});
    EXPECT_THAT(advice[0].not_confirmed, ElementsAre(0U));
    EXPECT_DOUBLE_EQ(*advice[0].reference_share, 0.25);
}

TEST(CheapestSettings, SayWhereNothingIsFinerThanTheReference) {
    StudyTable table = step_table({{"100", 0.03}, {"200", 0.0}, {"400", 0.001}});
    const auto is_unconfirmed = [&](std::size_t reference) {
        table.reference = reference;
        const auto advice =
            cheapest_settings(table, study_groups(table), study_measures(table).front(), {}, {0.01}).front();
        return advice.group && advice.is_unconfirmed;
    };
    EXPECT_FALSE(is_unconfirmed(1)); // 400 steps confirm it
    table.cases.pop_back();
    EXPECT_TRUE(is_unconfirmed(1));
}

// Times of short runs differ by some per cent from one run to the next: 52 seconds are no dearer than 50.
TEST(CheapestSettings, AreTheMostExactOfThoseThatCostTheSame) {
    StudyTable table = step_table({{"50", 0.008}, {"52", 0.0004}, {"400", 0.0}});
    table.reference = 2;
    EXPECT_EQ(cheapest(table, 0.01), "52");
    EXPECT_EQ(cheapest(step_table({{"50", 0.008}, {"60", 0.0004}, {"400", 0.0}}), 0.01), "50");
}

TEST(CheapestSettings, NeedAFinerCaseThatCameToAnEnd) {
    StudyTable table = step_table({{"25", 0.001}, {"50", 0.001}, {"100", 0.001}});
    EXPECT_EQ(cheapest(table, 0.01), "25");
    table.cases[1].status = CaseStatus::failed;
    EXPECT_EQ(cheapest(table, 0.01), std::nullopt); // 100 has nothing finer, 25 is not confirmed by 50
}

TEST(CheapestSettings, AreBalanced) {
    StudyTable table = step_table({{"25", 0.001}, {"50", 0.001}, {"100", 0.0}});
    table.reference = 2;
    EXPECT_EQ(cheapest(table, 0.01, {true, false, false}), "50");
}

TEST(CheapestSettings, OfOneToleranceAreConfirmedByFinerStepsToo) {
    StudyTable table = made_table({"stages.0.steps", "solver.tolerance"}, 0);
    table.cases = {done_case({"50", "1e-3"}, 1.0, 0.001, 1.0), done_case({"50", "1e-5"}, 1.0, 0.001, 2.0),
                   done_case({"100", "1e-5"}, 1.0, 0.03, 3.0), done_case({"200", "1e-5"}, 1.0, 0.0, 4.0)};
    table.reference = 3;
    EXPECT_EQ(cheapest(table, 0.01), "200"); // 50 steps are right by chance, whatever the tolerance
}

TEST(CheapestSettings, CountTheMeanErrorOfReplicasWithItsConfidence) {
    StudyTable table = made_table({"stages.0.steps"}, 0);
    for (const double error : {0.010, 0.012, 0.014}) table.cases.push_back(done_case({"50"}, 1.0, error, 1.0));
    for (int i = 0; i < 3; ++i) table.cases[static_cast<std::size_t>(i)].replica = i;
    const auto groups = study_groups(table);
    ASSERT_EQ(groups.size(), 1U);
    // 0.012 + 4.303 * 0.002/sqrt(3)
    EXPECT_NEAR(*group_error(table, groups[0], study_measures(table).front()), 0.016968, 1e-5);
    table.cases.pop_back();
    EXPECT_NEAR(*group_error(table, study_groups(table)[0], study_measures(table).front()), 0.012, 1e-12);
}

TEST(ModelChoices, AreComparedWithTheSameNumericalSettings) {
    StudyTable table = made_table({"stages.0.steps", "analysis.kinematics"}, 0);
    table.cases = {done_case({"100", ""}, 1.02, 0.02, 2.0), done_case({"800", ""}, 1.0, 0.0, 8.0),
                   done_case({"100", "rigid"}, 1.122, 0.122, 1.0), done_case({"50", "rigid"}, 1.2, 0.2, 1.0)};
    table.reference = 1;
    const auto groups = study_groups(table);
    EXPECT_THAT(other_model_marks(table, groups), ElementsAre(false, false, true, true));
    const auto choices = model_choices(table, groups, study_measures(table).front());
    ASSERT_EQ(choices.size(), 1U); // 50 steps have no counterpart
    EXPECT_NEAR(*choices[0].deviation, 0.1, 1e-12);
    EXPECT_NEAR(*choices[0].cost_ratio, 0.5, 1e-12);
    EXPECT_THAT(cheapest_settings(table, groups, study_measures(table).front(), {}, {0.5})[0].not_confirmed, IsEmpty());
}

TEST(ModelChoices, AreNoneWithoutAReferenceAmongTheCases) {
    StudyTable table = made_table({"analysis.kinematics"}, std::nullopt);
    table.cases = {done_case({"affine"}, 1.0, 0.1, 2.0), done_case({"rigid"}, 1.1, 0.2, 1.0)};
    EXPECT_THAT(other_model_marks(table, study_groups(table)), ElementsAre(false, false));
}

TEST(ReferenceMarks, AreTheCasesWithoutErrorsWhereEachGroupHasItsOwn) {
    StudyTable table = step_table({{"25", 0.1}, {"50", 0.0}});
    EXPECT_THAT(reference_marks(table), ElementsAre(false, true));
    table.reference = 0;
    EXPECT_THAT(reference_marks(table), ElementsAre(true, false));
}

TEST(GroupLabel, NamesWhatIsUnusual) {
    StudyTable table = made_table({"stages.0.steps", "cracks.update"}, 0);
    table.cases = {done_case({"25", "event"}, 1.0, 0.0, 1.0), done_case({"50", "event"}, 1.0, 0.0, 1.0),
                   done_case({"50", "event"}, 1.0, 0.0, 1.0), done_case({"100", "all"}, 1.0, 0.0, 1.0)};
    table.cases[2].replica = 1;
    const auto groups = study_groups(table);
    ASSERT_EQ(groups.size(), 3U);
    EXPECT_EQ(group_label(table, groups, 0), "steps 25");
    EXPECT_EQ(group_label(table, groups, 2), "steps 100, update all");
    EXPECT_EQ(group_label(table, groups, 0, 0), "usual settings");
    EXPECT_EQ(advised_settings(table, groups, 0), "25 steps of stage 0, cracks.update event");
}

TEST(SettingWords, CountStepsAsOneSays) {
    EXPECT_EQ(setting_words("stages.1.steps", "1"), "1 step of stage 1");
    EXPECT_EQ(setting_words("stages.10.steps", "25"), "25 steps of stage 10");
    EXPECT_EQ(setting_words("cracks.update", "all"), "cracks.update all");
    EXPECT_EQ(setting_words("solver.accuracy", "null"), "without solver.accuracy");
}

TEST(GroupLabel, NamesParametersByAsMuchOfTheirPathAsTellsThemApart) {
    StudyTable table = made_table({"a.hexagons.spacing", "a.voronoi.spacing"}, std::nullopt);
    table.cases = {done_case({"0.1", ""}, 1.0, 0.0, 1.0), done_case({"null", "0.1"}, 1.0, 0.0, 1.0)};
    const auto groups = study_groups(table);
    EXPECT_EQ(group_label(table, groups, 1), "without hexagons.spacing, voronoi.spacing 0.1");
}

TEST(SeriesLabel, NamesWhatTellsSeriesApart) {
    StudyTable table = made_table({"stages.0.steps", "cracks.update"}, 0);
    for (const char* update : {"all", "event"})
        for (const char* steps : {"25", "50"}) table.cases.push_back(done_case({steps, update}, 1.0, 0.0, 1.0));
    table.cases.push_back(done_case({"100", "event"}, 1.0, 0.0, 1.0)); // now most have the update of events
    const auto groups = study_groups(table);
    const auto series = study_series(table, groups);
    ASSERT_EQ(series.size(), 2U);
    EXPECT_EQ(series_label(table, groups, series, series[0]), "update all");
    EXPECT_EQ(series_label(table, groups, series, series[1]), "update event");
}

TEST(OwnSettings, AreNotNamedInAdviceButForTheStepsAndAreFoundOrTheNearest) {
    StudyTable table = made_table({"stages.1.steps", "cracks.update", "solver.tolerance", "solver.accuracy"}, 0);
    table.own_settings = {"90", "event", "1e-5", ""};
    table.cases = {done_case({"25", "event", "1e-5", ""}, 1.0, 0.0, 1.0),
                   done_case({"100", "event", "0.00001", "null"}, 1.0, 0.0, 1.0),
                   done_case({"90", "all", "1e-5", ""}, 1.0, 0.0, 1.0),
                   done_case({"100", "event", "1e-5", "0.01"}, 1.0, 0.0, 1.0)};
    auto groups = study_groups(table);
    EXPECT_EQ(advised_settings(table, groups, 1), "100 steps of stage 1");
    EXPECT_EQ(advised_settings(table, groups, 2), "90 steps of stage 1, cracks.update all");
    EXPECT_EQ(advised_settings(table, groups, 3), "100 steps of stage 1, solver.accuracy 0.01");
    EXPECT_EQ(own_group(table, groups), 1U);
    table.own_settings[0] = "100";
    EXPECT_EQ(advised_settings(table, groups, 3), "solver.accuracy 0.01"); // takes its own steps
    table.own_settings[0] = "90";
    table.cases.push_back(done_case({"90", "event", "1e-5", ""}, 1.0, 0.0, 1.0));
    groups = study_groups(table);
    EXPECT_EQ(own_group(table, groups), 4U);
    EXPECT_EQ(advised_settings(table, groups, 4), "90 steps of stage 1 as in the scene");
    table.own_settings.clear();
    EXPECT_EQ(own_group(table, groups), std::nullopt);
}

TEST(Richardson, CallsChangesBelowTheNoiseNone) {
    const std::vector<double> sizes{4.0, 2.0, 1.0};
    const std::vector<double> values{1.0 + 4e-6, 1.0 + 2e-6, 1.0 + 1e-6};
    EXPECT_EQ(convergence(sizes, values).kind, ConvergenceKind::monotone);
    const Convergence found = convergence(sizes, values, 1e-4);
    EXPECT_EQ(found.kind, ConvergenceKind::constant);
    EXPECT_NEAR(*found.uncertainty, 3e-6, 1e-11);
}

} // namespace
} // namespace kluft
