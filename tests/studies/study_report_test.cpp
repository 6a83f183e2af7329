#include "kluft/studies/study_report.hpp"

#include <cmath>
#include <filesystem>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "kluft/core/diagnostics.hpp"
#include "kluft/output/atomic_file.hpp"
#include "kluft/output/history_table.hpp"
#include "kluft/output/summary.hpp"
#include "output/temporary_directory.hpp"
#include "studies/made_table.hpp"

namespace kluft {
namespace {

namespace fs = std::filesystem;
using testing::done_case;
using ::testing::HasSubstr;
using testing::made_table;
using ::testing::Not;
using testing::TemporaryDirectory;

/// A curve that rises to its peak at 1 % strain and falls to half of it.
void write_case(const fs::path& directory, double peak, int unbalanced_steps) {
    make_directory(directory);
    std::string rows = history_header() + "\n";
    for (int i = 0; i <= 20; ++i) {
        StepRecord row;
        row.step = i;
        row.axial_strain = 0.001 * i;
        const double rise = row.axial_strain / 0.01;
        row.axial_stress = peak * (rise <= 1.0 ? rise * (2.0 - rise) : 1.5 - 0.5 * rise);
        row.differential_stress = row.axial_stress;
        row.balanced = i >= unbalanced_steps;
        rows += table_row(row) + "\n";
    }
    write_file(directory / "history.csv", rows);
    RunSummary summary;
    summary.numbers.unbalanced_steps = unbalanced_steps;
    summary.platen_stage = 0;
    write_file(directory / "summary.json", summary_json(summary));
}

/// First order in the number of steps towards 1.5 MPa, with two ways to update cracks; one case failed, one has
/// unbalanced steps.
StudyTable refined_table(const fs::path& directory) {
    StudyTable table = made_table({"stages.1.steps", "cracks.update"}, 0);
    table.directory = directory;
    for (const char* update : {"all", "event"})
        for (const int steps : {25, 50, 100, 200, 400}) {
            const double error = (update == std::string("all") ? -1.0 : -0.2) / steps;
            StudyCase made =
                done_case({fmt::format("{}", steps), update}, 1.5e6 * (1.0 + error), error, 0.01 * steps + 1);
            made.name = fmt::format("{}-{}", update, steps);
            write_case(directory / "cases" / made.name, *made.quantities[0], steps == 50 ? 1 : 0);
            table.cases.push_back(made);
        }
    table.cases[2].status = CaseStatus::failed;
    table.cases[2].reason = "killed by signal 9";
    return table;
}

std::size_t n_files(const fs::path& directory, const std::string& begin) {
    std::size_t count = 0;
    for (const auto& entry : fs::directory_iterator(directory))
        count += entry.path().filename().string().starts_with(begin) ? 1U : 0U;
    return count;
}

TEST(StudyReport, SaysOrderLimitFailuresAndWhatAccuracyCosts) {
    const TemporaryDirectory directory;
    write_study_report(refined_table(directory.path()), directory.path());
    const std::string text = read_file(directory / "study.md");
    EXPECT_THAT(text, HasSubstr("order 1, limit 1.5 MPa"));
    EXPECT_THAT(text, HasSubstr("killed by signal 9"));
    EXPECT_THAT(text, HasSubstr("\n    --set stages.1.steps=25 --set cracks.update=event\n"));
    EXPECT_THAT(text, HasSubstr("## Recommendation"));
    // 25 steps at events have an error of 0.8 %, and so have all finer ones less
    EXPECT_THAT(text,
                HasSubstr("For 1 % error on peak\\_stress: 25 steps of stage 1, cracks.update event (error 0.8 %) "
                          "costs 1.25 s"));
    EXPECT_THAT(text, Not(HasSubstr("## Replicas")));
    EXPECT_THAT(text, Not(HasSubstr("## Model choices")));
    for (const char* name : {"study-convergence-stages-1-steps", "study-work-peak_stress"})
        for (const char* ending : {".png", ".svg"}) EXPECT_TRUE(fs::exists(directory / (std::string(name) + ending)));
    EXPECT_EQ(n_files(directory.path(), "study-curves"), 4U); // two series, two formats
    const std::string page = read_file(directory / "study.html");
    EXPECT_THAT(page, HasSubstr("data:image/svg+xml;base64,"));
    EXPECT_THAT(page, Not(HasSubstr("src=\"study-")));
}

TEST(StudyReport, SaysThatNothingConfirmsTheReference) {
    const TemporaryDirectory directory;
    StudyTable table = made_table({"stages.1.steps"}, 0);
    table.directory = directory.path();
    for (const int steps : {1, 7, 35}) {
        const double error = steps == 35 ? 0.0 : 0.3 / steps;
        StudyCase made = done_case({fmt::format("{}", steps)}, 1e6 * (1.0 + error), error, steps);
        made.name = fmt::format("{}", steps);
        write_case(directory / "cases" / made.name, *made.quantities[0], 0);
        table.cases.push_back(made);
    }
    table.reference = 2;
    write_study_report(table, directory.path());
    const std::string text = read_file(directory / "study.md");
    EXPECT_THAT(text, HasSubstr("35 steps of stage 1, not confirmed"));
    EXPECT_THAT(text, HasSubstr("They are the reference itself, which no finer case of this study confirms"));
    EXPECT_THAT(text, Not(HasSubstr("it is 0 %")));
}

// Two rocks, each with its own finest case for a reference: what to compute with is advised, not what the rock is.
TEST(StudyReport, RecommendsNoRock) {
    const TemporaryDirectory directory;
    StudyTable table = made_table({"materials.rock.cohesion", "stages.1.steps"}, 1);
    table.directory = directory.path();
    table.own_settings = {"5 MPa", "20"};
    for (const char* cohesion : {"4 MPa", "5 MPa"})
        for (const int steps : {10, 20}) {
            const double error = steps == 10 ? 1e-3 : 0.0;
            StudyCase made = done_case({cohesion, fmt::format("{}", steps)}, 15e6 * (1.0 + error), error, 0.1 * steps);
            made.name = fmt::format("{}-{}", cohesion, steps);
            write_case(directory / "cases" / made.name, *made.quantities[0], 0);
            table.cases.push_back(made);
        }
    write_study_report(table, directory.path());
    const std::string page = read_file(directory / "study.md");
    EXPECT_THAT(page, HasSubstr("10 steps of stage 1"));
    EXPECT_THAT(page, HasSubstr("Found with materials.rock.cohesion 4 MPa"));
    EXPECT_THAT(page, Not(HasSubstr("--set materials")));
}

TEST(StudyReport, SaysWhatRunsWarnedOf) {
    const TemporaryDirectory directory;
    const StudyTable table = refined_table(directory.path());
    for (const char* name : {"all-25", "all-200"}) {
        const fs::path file = directory / "cases" / name / "summary.json";
        RunSummary summary = read_summary(file);
        summary.warnings = {fmt::format("a corner holds block {}", name == std::string("all-25") ? 7 : 12)};
        write_file(file, summary_json(summary));
    }
    write_study_report(table, directory.path());
    const std::string text = read_file(directory / "study.md");
    EXPECT_THAT(text, HasSubstr("2 cases have warnings"));
    EXPECT_THAT(text, HasSubstr("## Warnings"));
    EXPECT_THAT(text, HasSubstr("all-25 and 1 more: a corner holds block 7"));
}

TEST(StudyReport, SaysThatTheReferenceIsOutOfBalance) {
    const TemporaryDirectory directory;
    StudyTable table = refined_table(directory.path());
    table.reference = table.cases.size() - 1;
    EXPECT_THAT((write_study_report(table, directory.path()), read_file(directory / "study.md")),
                Not(HasSubstr("is a reference and has unbalanced load steps")));
    write_case(directory / "cases" / "event-400", 1.5e6, 1);
    write_study_report(table, directory.path());
    const std::string text = read_file(directory / "study.md");
    EXPECT_THAT(text, HasSubstr("event-400 is a reference and has unbalanced load steps"));
    EXPECT_THAT(text, HasSubstr("reference, unbalanced"));
}

TEST(StudyReport, DrawsTheBandOfReplicasAndCountsMembers) {
    const TemporaryDirectory directory;
    StudyTable table = made_table({}, std::nullopt);
    table.reference_name.clear();
    table.directory = directory.path();
    const std::vector<double> peaks{1.00, 1.02, 0.99, 1.01, 0.98}; // mean 1, deviation 0.0158
    for (std::size_t i = 0; i < peaks.size(); ++i) {
        StudyCase made = done_case({}, 1e6 * peaks[i], 0.0, 1.0);
        made.errors = {std::nullopt};
        made.name = fmt::format("copy-{}", i);
        made.replica = static_cast<int>(i);
        write_case(directory / "cases" / made.name, *made.quantities[0], 0);
        table.cases.push_back(made);
    }
    write_study_report(table, directory.path());
    const std::string text = read_file(directory / "study.md");
    EXPECT_THAT(text, HasSubstr("## Replicas"));
    EXPECT_THAT(
        text,
        HasSubstr(
            "| 5 | 1 MPa | 1.58 % | ± 1.96 % | 13 |")); // 2.776 * 1.58/sqrt(5); by hand 2.179 * 1.58/sqrt(13) = 0.955
    EXPECT_THAT(text, HasSubstr("(standard deviation 1.6 %, 95 % confidence of the mean ± 2 %)"));
    EXPECT_THAT(text, HasSubstr("with this band only"));
    EXPECT_EQ(n_files(directory.path(), "study-band"), 2U);
    EXPECT_THAT(text, Not(HasSubstr("## Convergence")));
    EXPECT_THAT(text, Not(HasSubstr("## Error against time")));
    EXPECT_THAT(text, Not(HasSubstr("## Recommendation")));
}

TEST(StudyReport, SeparatesModelChoicesFromErrors) {
    const TemporaryDirectory directory;
    StudyTable table = made_table({"stages.0.steps", "analysis.kinematics"}, 0);
    table.directory = directory.path();
    table.cases = {done_case({"50", "affine"}, 1.01, 0.01, 1.0), done_case({"100", "affine"}, 1.0, 0.0, 2.0),
                   done_case({"50", "rigid"}, 1.111, 0.111, 0.5)};
    table.reference = 1;
    write_study_report(table, directory.path());
    const std::string text = read_file(directory / "study.md");
    EXPECT_THAT(text, HasSubstr("## Model choices"));
    EXPECT_THAT(text, HasSubstr("+10 %"));
    EXPECT_THAT(text, HasSubstr("For 5 % error on peak\\_stress: 50 steps of stage 0 (error 1 %)"));
}

TEST(StudyReport, OfManyParametersHasNamesAndWhatTheyStandFor) {
    const TemporaryDirectory directory;
    StudyTable table = made_table({"stages.1.steps", "cracks.update", "solver.tolerance", "solver.accuracy"}, 0);
    table.directory = directory.path();
    table.own_settings = {"50", "event", "1e-5", ""};
    table.cases = {done_case({"25", "event", "1e-5", ""}, 1.02, 0.02, 1.0),
                   done_case({"50", "event", "1e-5", ""}, 1.01, 0.01, 2.0),
                   done_case({"50", "event", "1e-5", "0.05"}, 1.004, 0.004, 1.5),
                   done_case({"100", "event", "1e-6", ""}, 1.0, 0.0, 4.0)};
    const std::vector<std::string> variants{"steps", "steps", "accuracy", "reference"};
    for (std::size_t i = 0; i < table.cases.size(); ++i) {
        table.cases[i].variant = variants[i];
        table.cases[i].name = fmt::format("{}-{}", variants[i], i);
    }
    table.reference = 3;
    write_study_report(table, directory.path());
    const std::string text = read_file(directory / "study.md");
    EXPECT_THAT(text, HasSubstr("those against case reference-3 (100 steps of stage 1, solver.tolerance 1e-6)"));
    EXPECT_THAT(text, HasSubstr("- stages.1.steps: 25, 50, 100 (the scene: 50)"));
    EXPECT_THAT(text, Not(HasSubstr("- cracks.update:"))); // all as the scene
    EXPECT_THAT(text, HasSubstr("| case | status | peak\\_stress | error | CPU time |"));
    EXPECT_THAT(text, HasSubstr("- reference: 100 steps of stage 1, solver.tolerance 1e-6"));
    EXPECT_THAT(text,
                HasSubstr("The scene's own settings, 50 steps of stage 1 as in the scene, have an error of 1 % on "
                          "peak\\_stress and cost 2 s of CPU time."));
    EXPECT_THAT(text,
                HasSubstr("For 2 % error on peak\\_stress: 25 steps of stage 1 (error 2 %) costs 1 s of CPU time, "
                          "0.5 of the scene's own settings, 0.25 of the reference."));
    EXPECT_THAT(text, HasSubstr("- solver.accuracy 0.05: error 0.4 % on peak\\_stress, 1.5 s of CPU time, 0.75 of the "
                                "scene's own settings."));
}

TEST(StudyReport, ClaimsNoOrderAfterThePeakAndNoneBelowTheNoise) {
    const TemporaryDirectory directory;
    StudyTable table = made_table({"stages.1.steps"}, 0);
    table.directory = directory.path();
    table.quantities = {"peak_stress", "residual_stress"};
    for (const int steps : {25, 50, 100}) {
        StudyCase made = done_case({fmt::format("{}", steps)}, 1e6 * (1.0 + 1e-4 / steps), 0.0, 1.0);
        made.quantities.emplace_back(1e6 * (1.0 + 1.0 / steps));
        made.errors.emplace_back(0.01);
        table.cases.push_back(made);
    }
    write_study_report(table, directory.path());
    EXPECT_THAT(read_file(directory / "study.md"), HasSubstr("| constant to 0.0003 % |"));
    EXPECT_THAT(read_file(directory / "study.md"), HasSubstr("| scatter 2.93 % |")); // 0.03/1.02333
    write_study_report(table, directory.path(), {.quantity = "residual_stress"});
    const std::string text = read_file(directory / "study.md");
    EXPECT_THAT(text, HasSubstr("after the peak: no order; scatter 2.93 %"));
    EXPECT_THAT(text, Not(HasSubstr("order 1")));
}

// The last four values lie within 0.24 % of each other; with 25 steps the stress is 2.4 times theirs, with 12 it is 4 % less.
TEST(StudyReport, NamesCoarserValuesThatTheVerdictIsNotOf) {
    const TemporaryDirectory directory;
    StudyTable table = made_table({"stages.1.steps"}, 0);
    table.directory = directory.path();
    table.quantities = {"peak_stress", "peak_strain"};
    const auto add = [&](int steps, double stress, double strain) {
        StudyCase made = done_case({fmt::format("{}", steps)}, stress, 0.0, 1.0);
        made.quantities.emplace_back(strain);
        made.errors.emplace_back(0.0);
        table.cases.push_back(made);
    };
    add(12, 0.96e6, 2e-3);
    add(25, 2.4e6, 2e-3);
    add(50, 1.001e6, 3e-3);
    add(100, 1.0024e6, 2e-3);
    add(200, 1.0006e6, 2e-3);
    add(400, 1.0014e6, 2e-3);
    add(800, 1.0e6, 2e-3);
    write_study_report(table, directory.path());
    const std::string text = read_file(directory / "study.md");
    EXPECT_THAT(text, HasSubstr("no order: scatter 0.24 %; but -4 % at 12, +140 % at 25 |"));
    EXPECT_THAT(text, HasSubstr("no change; but +50 % at 50 |"));
}

TEST(StudyReport, OfNothingYetHasTheCasesOnlyAndNoPictures) {
    const TemporaryDirectory directory;
    write_file(directory / "study-old.png", "of an earlier report");
    StudyTable table = made_table({"stages.0.steps"}, 0);
    table.cases.resize(3);
    for (StudyCase& each : table.cases) each.settings = {"10"};
    write_study_report(table, directory.path());
    EXPECT_THAT(read_file(directory / "study.md"), HasSubstr("3 cases: 3 waiting"));
    EXPECT_EQ(n_files(directory.path(), "study-"), 0U);
    table.cases.clear();
    EXPECT_NO_THROW(write_study_report(table, directory.path()));
}

TEST(StudyReport, RefusesAQuantityThatTheStudyDoesNotHave) {
    const TemporaryDirectory directory;
    StudyTable table = made_table({"stages.0.steps"}, 0);
    EXPECT_THROW(write_study_report(table, directory.path(), {.quantity = "peak_strss"}), InputError);
}

} // namespace
} // namespace kluft
