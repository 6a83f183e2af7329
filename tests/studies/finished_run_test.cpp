#include "kluft/studies/finished_run.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "kluft/core/diagnostics.hpp"
#include "kluft/output/atomic_file.hpp"
#include "kluft/output/history_table.hpp"
#include "output/temporary_directory.hpp"

namespace kluft {
namespace {

namespace fs = std::filesystem;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Not;
using testing::TemporaryDirectory;

std::string refusal(const fs::path& directory) {
    try {
        (void)read_finished_run(directory, "run");
    } catch (const InputError& error) {
        return error.what();
    }
    return "";
}

/// A straight line to 2 MPa at 2 % strain in four steps.
std::string straight_line() {
    std::string text = history_header() + '\n';
    for (int i = 0; i <= 4; ++i) {
        StepRecord record;
        record.step = i;
        record.axial_strain = 0.005 * i;
        record.axial_stress = record.differential_stress = 0.5e6 * i;
        record.elapsed_s = 0.1 * i;
        text += table_row(record) + '\n';
    }
    return text;
}

TEST(FinishedRun, ThatIsMissingIsAnsweredWithTheNearestDirectory) {
    const TemporaryDirectory directory;
    fs::create_directories(directory / "results/case-3-all");
    EXPECT_THAT(refusal(directory / "results/case-3-al"),
                ::testing::AllOf(HasSubstr("expected a directory of results, found nothing"),
                                 HasSubstr("results/case-3-all'?")));
    EXPECT_THAT(refusal(directory / "results/case-3-al/"), HasSubstr("results/case-3-all'?"));
    EXPECT_THAT(refusal(directory / "absent/run"), ::testing::EndsWith("found nothing"));
}

TEST(FinishedRun, WithoutAHistoryIsAnsweredWithTheNearestFile) {
    const TemporaryDirectory directory;
    EXPECT_THAT(refusal(directory.path()), ::testing::EndsWith("found no history.csv in it"));
    write_file(directory / "histry.csv", "");
    EXPECT_THAT(refusal(directory.path()), HasSubstr("did you mean 'histry.csv'?"));
    write_file(directory / "history.csv", history_header() + '\n');
    EXPECT_THAT(refusal(directory.path()), HasSubstr("no load step in it yet"));
    EXPECT_THAT(refusal(directory / "history.csv"), HasSubstr("found a file"));
}

TEST(FinishedRun, OfTablesAloneHasTheNumbersThatTheyGive) {
    const TemporaryDirectory directory;
    write_file(directory / "history.csv", straight_line());
    const FinishedRun run = read_finished_run(directory.path(), "run");
    EXPECT_EQ(run.numbers.peak_stress, 2e6);
    EXPECT_FALSE(run.numbers.peak_reached);
    EXPECT_FALSE(run.numbers.youngs_modulus); // which stage moves a platen is not known
    EXPECT_FALSE(run.cracks);
    EXPECT_FALSE(run.model);
    EXPECT_FALSE(run.summary);
    EXPECT_THAT(run.notes, Contains(HasSubstr("no state.h5")));
    EXPECT_THAT(run.notes, Contains(HasSubstr("no summary.json")));
    EXPECT_THAT(run.notes, Contains(HasSubstr("no cracks.csv")));
}

TEST(FinishedRun, OfTablesAloneSaysWhetherItsNetLocked) {
    const TemporaryDirectory directory;
    write_file(directory / "history.csv",
               "step,stage,axial_strain,axial_stress,differential_stress,net_broken\n"
               "0,0,0,0,0,0\n1,0,0.01,1e6,1e6,0.5\n2,0,0.02,2e6,2e6,1\n3,0,0.03,3e6,3e6,1\n");
    const FinishedRun run = read_finished_run(directory.path(), "run");
    EXPECT_TRUE(run.numbers.net_locked);
    EXPECT_EQ(run.numbers.peak_stress, 2e6);
}

TEST(FinishedRun, MayLackColumnsThatNoCurveNeeds) {
    const TemporaryDirectory directory;
    write_file(directory / "history.csv",
               "differential_stress,stage,step,axial_stress,axial_strain,of_another_program\n"
               "0,0,0,0,0,x\n1e6,0,1,1.2e6,0.01,y\n");
    const FinishedRun run = read_finished_run(directory.path(), "run");
    ASSERT_EQ(run.history.size(), 2U);
    EXPECT_EQ(run.history[1].axial_stress, 1.2e6);
    EXPECT_TRUE(run.history[1].balanced);
    write_file(directory / "history.csv", "stage,step,axial_stress,axial_strain\n0,0,0,0\n");
    EXPECT_THAT(refusal(directory.path()), HasSubstr("history.csv:1: no column 'differential_stress'"));
}

TEST(FinishedRun, SaysThatRowsOfItsTableAreMissing) {
    const TemporaryDirectory directory;
    RunSummary summary;
    summary.numbers.steps = 4;
    write_summary(directory / "summary.json", summary);
    const std::string rows = straight_line();
    write_file(directory / "history.csv", rows);
    EXPECT_THAT(read_finished_run(directory.path(), "run").notes,
                Contains(HasSubstr("run: equilibria.csv ends at load step 0, summary.json says 4")));
    write_file(directory / "equilibria.csv", rows);
    EXPECT_THAT(read_finished_run(directory.path(), "run").notes, Not(Contains(HasSubstr("damaged"))));
    write_file(directory / "history.csv", rows.substr(0, rows.size() - 20)); // cut in the last row
    EXPECT_THAT(read_finished_run(directory.path(), "run").notes,
                Contains(HasSubstr("run: history.csv ends at load step 3, summary.json says 4")));
}

TEST(FinishedRun, SaysWhyItsBlocksAreNotKnown) {
    const TemporaryDirectory directory;
    write_file(directory / "history.csv", straight_line());
    write_file(directory / "state.h5", "damaged");
    const FinishedRun run = read_finished_run(directory.path(), "run");
    EXPECT_FALSE(run.model);
    EXPECT_THAT(run.notes,
                Contains(::testing::AllOf(HasSubstr("the blocks of run are not known"), HasSubstr("state.h5"))));
}

} // namespace
} // namespace kluft
