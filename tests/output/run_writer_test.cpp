#include "kluft/output/run_writer.hpp"

#include <algorithm>
#include <csignal>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <malloc.h>
#include <nlohmann/json.hpp>
#include <sys/resource.h>

#include "kluft/core/diagnostics.hpp"
#include "kluft/output/atomic_file.hpp"
#include "kluft/output/history_table.hpp"
#include "kluft/output/state_file.hpp"
#include "output/hexagon_grid.hpp"
#include "output/temporary_directory.hpp"

namespace kluft {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using testing::TemporaryDirectory;
using ::testing::ThrowsMessage;

/// A run of 4 pressure steps and 10 platen steps of a small body, told step by step.
class SmallRun {
public:
    SmallRun(const fs::path& directory, RunWriterOptions options)
        : writer_(directory, system_, [&] {
              options.title = "small";
              options.fingerprint = "scene";
              options.platen_stage = 1;
              options.material_names = {"rock"};
              return options;
          }()) {
        if (options.resumed_step) state_.at.step = *options.resumed_step;
    }

    /// Steps up to and with `last`.
    void go_to(int last, bool from_zero = true) {
        for (int step = from_zero ? 0 : state_.at.step + 1; step <= last; ++step) {
            state_.at.step = step;
            const StepRecord record = record_of(step);
            writer_.equilibrium(record);
            if (step == 9) writer_.crack({step, 1, 2, 0.1, 0.2, CrackMode::tension, 1e6, -1e4, 0.005});
            if (step == 9) writer_.jump({step, 0.5, 12.0, 0.001, 7});
            writer_.step(record, state_, fields(), step == 4 || step == 14);
        }
    }

    /// An equilibrium of a step that is never committed.
    void try_step(int step) { writer_.equilibrium(record_of(step)); }

    RunSummary finish(RunStatus status = RunStatus::done, const std::string& remark = "") {
        RunOutcome outcome;
        outcome.report.remark = remark;
        outcome.report.status = status;
        outcome.report.costs.factorizations = 17;
        outcome.version = "0.1.0";
        outcome.blas_core = "Haswell";
        outcome.unknowns = 6 * system_.n_blocks();
        return writer_.finish(outcome, state_, fields());
    }

    static StepRecord record_of(int step) {
        StepRecord record;
        record.step = step;
        record.stage = step <= 4 ? 0 : 1;
        record.axial_strain = step <= 4 ? 0.0 : 0.001 * (step - 4);
        record.differential_stress = 1e6 * std::min(record.axial_strain / 0.005, 2.0 - record.axial_strain / 0.005);
        record.lateral_strain = -0.2 * record.axial_strain;
        record.lateral_stress = 0.2e6;
        record.axial_stress = record.differential_stress + record.lateral_stress;
        record.histories = {0.5 * step, -1e3};
        return record;
    }

private:
    std::function<FieldRecord()> fields() const {
        return [this] { return testing::affine_fields(system_, Mat2::Zero(), -1e6 * Mat2::Identity()); };
    }

    BlockSystem system_ = testing::hexagon_grid(3, 4, 0.1);
    State state_;
    RunWriter writer_;
};

std::vector<int> steps_in(const fs::path& table) {
    std::vector<int> steps;
    for (const StepRecord& record : read_history(table)) steps.push_back(record.step);
    return steps;
}

/// Files cannot grow beyond a number of bytes for its life.
class FileLimit {
public:
    explicit FileLimit(rlim_t bytes) : signal_(std::signal(SIGXFSZ, SIG_IGN)) {
        getrlimit(RLIMIT_FSIZE, &before_);
        const rlimit limit{bytes, before_.rlim_max};
        setrlimit(RLIMIT_FSIZE, &limit);
    }
    FileLimit(const FileLimit&) = delete;
    FileLimit& operator=(const FileLimit&) = delete;
    ~FileLimit() {
        setrlimit(RLIMIT_FSIZE, &before_);
        std::signal(SIGXFSZ, signal_);
    }

private:
    void (*signal_)(int);
    rlimit before_{};
};

TEST(RunWriter, LeavesEverythingOfTheContract) {
    const TemporaryDirectory directory;
    SmallRun run(directory.path(), {});
    run.go_to(14);
    const RunSummary summary = run.finish();
    for (const char* name : {"history.csv", "equilibria.csv", "cracks.csv", "summary.json", "fields.pvd", "curve.png",
                             "curve.svg", "blocks.png", "blocks.svg", "state.h5"})
        EXPECT_TRUE(fs::is_regular_file(directory / name)) << name;
    EXPECT_EQ(steps_in(directory / "history.csv").size(), 15U);
    EXPECT_EQ(read_cracks(directory / "cracks.csv").size(), 1U);
    EXPECT_EQ(read_file(directory / "jumps.csv"), jumps_header() + "\n9,0.5,12,0.001,7\n");
    EXPECT_EQ(read_state(directory / "state.h5", "scene").at.step, 14);
    EXPECT_THAT(read_file(directory / "fields.pvd"), HasSubstr("fields/blocks_000014.vtu"));
    EXPECT_NEAR(*summary.numbers.peak_stress, 1.2e6, 1e-6);
    const auto json = nlohmann::json::parse(read_file(directory / "summary.json"));
    EXPECT_EQ(json["blocks"], 12);
    EXPECT_EQ(json["unknowns"], 72);
    EXPECT_EQ(json["factorizations"], 17);
    EXPECT_EQ(json["peak_reached"], true);
    for (const auto& entry : fs::recursive_directory_iterator(directory.path()))
        EXPECT_NE(entry.path().extension(), ".part") << entry.path();
}

// The last tenth of the strain, 0.9 and 1.0 %, with 0.4 and 0.2 MPa.
TEST(RunWriter, TellsNoResidualStressOfARunThatADropEnded) {
    const TemporaryDirectory directory;
    SmallRun whole(directory.path(), {});
    whole.go_to(14);
    EXPECT_NEAR(*whole.finish().numbers.residual_stress, 0.3e6, 1e-6);
    EXPECT_EQ(whole.finish(RunStatus::done, "stopped after a drop of the axial stress").numbers.residual_stress,
              std::nullopt);
}

TEST(RunWriter, HasTheHistoryOnTheDiskWithEveryStep) {
    const TemporaryDirectory directory;
    SmallRun run(directory.path(), {});
    run.go_to(2);
    EXPECT_THAT(steps_in(directory / "history.csv"), ElementsAre(0, 1, 2));
    EXPECT_THAT(steps_in(directory / "equilibria.csv"), ElementsAre(0, 1, 2));
}

TEST(RunWriter, WritesFieldsAndStatesAsOftenAsAsked) {
    const TemporaryDirectory directory;
    RunWriterOptions options;
    options.fields_every = 3;
    options.checkpoint_every = 2;
    options.pictures = false;
    SmallRun run(directory.path(), options);
    run.go_to(7);
    EXPECT_EQ(read_state(directory / "state.h5", "scene").at.step, 6);
    const std::string pvd = read_file(directory / "fields.pvd");
    for (const int step : {0, 3, 4, 6})
        EXPECT_THAT(pvd, HasSubstr("fields/blocks_00000" + std::to_string(step) + ".vtu"));
    EXPECT_THAT(pvd, ::testing::Not(HasSubstr("blocks_000007.vtu")));
    run.finish(RunStatus::interrupted);
    EXPECT_THAT(read_file(directory / "fields.pvd"), HasSubstr("blocks_000007.vtu"));
    EXPECT_EQ(read_state(directory / "state.h5", "scene").at.step, 7);
}

// The elastic constants of `record_of` are there from the platen's second row on; a run that ended before has none to warn of.
TEST(RunWriter, WarnsOfElasticConstantsWhereItHasSome) {
    RunWriterOptions options;
    options.pictures = false;
    options.platen_stage = 1;
    options.elastic_constants_warning = "not the rock's";
    for (const int last : {2, 9}) {
        const TemporaryDirectory directory;
        SmallRun run(directory.path(), options);
        run.go_to(last);
        const RunSummary summary = run.finish();
        EXPECT_EQ(summary.numbers.youngs_modulus.has_value(), last == 9);
        EXPECT_EQ(std::ranges::count(summary.warnings, "not the rock's"), last == 9 ? 1 : 0);
    }
}

// The body's own modulus and ratio stay.
TEST(RunWriter, HasNoElasticConstantsOfABodyThatIsNoSpecimen) {
    RunWriterOptions options;
    options.pictures = false;
    options.platen_stage = 1;
    options.has_elastic_constants = false;
    options.elastic_constants_warning = "its shape";
    const TemporaryDirectory directory;
    SmallRun run(directory.path(), options);
    run.go_to(9);
    const RunSummary summary = run.finish();
    EXPECT_FALSE(summary.numbers.youngs_modulus || summary.numbers.poissons_ratio);
    EXPECT_TRUE(summary.numbers.axial_modulus && summary.numbers.lateral_ratio);
    EXPECT_THAT(summary.warnings, ::testing::Contains("its shape"));
}

TEST(RunWriter, WritesNeitherFieldsNorPicturesWhenNotAsked) {
    const TemporaryDirectory directory;
    RunWriterOptions options;
    options.fields = false;
    options.pictures = false;
    SmallRun run(directory.path(), options);
    run.go_to(14);
    run.finish();
    std::vector<std::string> names;
    for (const auto& entry : fs::directory_iterator(directory.path())) names.push_back(entry.path().filename());
    std::sort(names.begin(), names.end());
    EXPECT_THAT(names,
                ElementsAre("cracks.csv", "equilibria.csv", "history.csv", "jumps.csv", "state.h5", "summary.json"));
}

// The tables of an uninterrupted run, and of one that was killed at step 11 and resumed from the state of step 8.
TEST(RunWriter, LeavesTheSameTablesAfterAResumedRun) {
    const TemporaryDirectory whole;
    const TemporaryDirectory broken;
    RunWriterOptions options;
    options.checkpoint_every = 4;
    options.pictures = false;
    options.fields_every = 5;
    SmallRun uninterrupted(whole.path(), options);
    uninterrupted.go_to(14);
    uninterrupted.finish();
    {
        SmallRun killed(broken.path(), options);
        killed.go_to(11);
        killed.try_step(12);
    }
    options.resumed_step = read_state(broken / "state.h5", "scene").at.step;
    EXPECT_EQ(options.resumed_step, 8);
    SmallRun resumed(broken.path(), options);
    EXPECT_EQ(steps_in(broken / "history.csv").back(), 8);
    EXPECT_TRUE(read_cracks(broken / "cracks.csv").empty());
    resumed.go_to(14, false);
    resumed.finish();
    for (const char* name : {"history.csv", "equilibria.csv", "cracks.csv", "jumps.csv", "fields.pvd"})
        EXPECT_TRUE(read_file(broken / name) == read_file(whole / name)) << name;
}

TEST(RunWriter, WritesHistoriesWhereTheSceneFollowsSomething) {
    const TemporaryDirectory whole;
    const TemporaryDirectory broken;
    RunWriterOptions options;
    options.checkpoint_every = 4;
    options.pictures = false;
    options.fields = false;
    options.history_columns = {"top.displacement_y", "foot.normal_force"};
    SmallRun(whole.path(), options).go_to(14);
    EXPECT_THAT(read_file(whole / "histories.csv"),
                ::testing::StartsWith("step,stage,load_factor,top.displacement_y,foot.normal_force\n0,0,0,0,-1000\n"
                                      "1,0,0,0.5,-1000\n"));
    { SmallRun(broken.path(), options).go_to(11); }
    options.resumed_step = read_state(broken / "state.h5", "scene").at.step;
    { SmallRun(broken.path(), options).go_to(14, false); }
    EXPECT_EQ(read_file(broken / "histories.csv"), read_file(whole / "histories.csv"));
    options.history_columns = {"top.displacement_x"};
    EXPECT_THROW(SmallRun(broken.path(), options), InputError);
    remove_results(whole.path());
    EXPECT_FALSE(fs::exists(whole / "histories.csv"));
}

TEST(RunWriter, WritesTheSceneWholeAndRemovesNoneOfTheUsersOwn) {
    const TemporaryDirectory directory;
    EXPECT_EQ(first_result_in(directory.path()), "");
    write_file(directory / "scene.yaml", "mine");
    RunWriterOptions options;
    { SmallRun(directory.path(), options).go_to(5); }
    EXPECT_EQ(read_file(directory / "scene.yaml"), "mine");
    EXPECT_EQ(first_result_in(directory.path()), "history.csv");
    options.scene_file = "kluft: 1\n";
    { SmallRun(directory.path(), options).go_to(5); }
    EXPECT_EQ(read_file(directory / "scene.yaml"), "kluft: 1\n");
    options.resumed_step = 4;
    options.scene_file = "kluft: 1\ntitle: again\n";
    { SmallRun(directory.path(), options).go_to(7, false); }
    EXPECT_EQ(read_file(directory / "scene.yaml"), options.scene_file);
    remove_results(directory.path());
    EXPECT_EQ(first_result_in(directory.path()), "");
    EXPECT_TRUE(fs::exists(directory / "scene.yaml"));
}

TEST(RunWriter, KnowsEveryFileThatARunWouldTakeThePlaceOf) {
    for (const char* name : {"run.log", "contacts/000000.csv", "supports/000012.csv", "fields/blocks_000000.vtu",
                             "fields/interfaces_000000.vtu", "report.html"}) {
        const TemporaryDirectory directory;
        make_directory((directory / name).parent_path());
        write_file(directory / name, "mine");
        EXPECT_EQ(first_result_in(directory.path()), name);
    }
    const TemporaryDirectory directory;
    make_directory(directory / "fields");
    write_file(directory / "fields/blocks_mine.vtu", "mine");
    EXPECT_EQ(first_result_in(directory.path()), "");
}

TEST(RunWriter, RefusedResumptionLeavesTheScene) {
    const TemporaryDirectory directory;
    RunWriterOptions options;
    options.scene_file = "kluft: 1\n";
    { SmallRun(directory.path(), options).go_to(5); }
    fs::remove(directory / "cracks.csv");
    options.resumed_step = 4;
    options.scene_file = "kluft: 1\ntitle: again\n";
    EXPECT_THROW(SmallRun(directory.path(), options), InputError);
    EXPECT_EQ(read_file(directory / "scene.yaml"), "kluft: 1\n");
}

TEST(RunWriter, IgnoresStepsThatAResumedRunTellsAgain) {
    const TemporaryDirectory directory;
    RunWriterOptions options;
    options.checkpoint_every = 1;
    { SmallRun(directory.path(), options).go_to(3); }
    options.resumed_step = 3;
    SmallRun resumed(directory.path(), options);
    resumed.go_to(5);
    EXPECT_THAT(steps_in(directory / "history.csv"), ElementsAre(0, 1, 2, 3, 4, 5));
}

TEST(RunWriter, RefusesToResumeWithoutTheRowsOfTheSavedState) {
    const TemporaryDirectory directory;
    RunWriterOptions options;
    options.checkpoint_every = 3;
    options.history_columns = {"top.displacement_y", "foot.normal_force"};
    { SmallRun(directory.path(), options).go_to(13); }
    options.resumed_step = 12;
    for (const char* name : {"history.csv", "equilibria.csv", "cracks.csv", "jumps.csv", "histories.csv"}) {
        const std::string before = read_file(directory / name);
        write_file(directory / name, before.substr(0, before.find('\n', before.find("\n9,") + 1) - 1) + '\n');
        EXPECT_THAT([&] { SmallRun(directory.path(), options); }, ThrowsMessage<InputError>(HasSubstr(name)));
        fs::remove(directory / name);
        EXPECT_THAT([&] { SmallRun(directory.path(), options); }, ThrowsMessage<InputError>(HasSubstr(name)));
        write_file(directory / name, before);
    }
    EXPECT_NO_THROW(SmallRun(directory.path(), options));
    fs::remove(directory / "state.h5");
    EXPECT_THROW(SmallRun(directory.path(), options), InputError);
}

TEST(RunWriter, DoesNotMixANewRunWithOldResults) {
    const TemporaryDirectory directory;
    {
        SmallRun old(directory.path(), {});
        old.go_to(14);
        old.finish();
    }
    write_file(directory / "notes.txt", "mine");
    write_file(directory / "run.log", "log");
    RunWriterOptions options;
    options.fields = false;
    SmallRun run(directory.path(), options);
    std::vector<std::string> names;
    for (const auto& entry : fs::directory_iterator(directory.path())) names.push_back(entry.path().filename());
    std::sort(names.begin(), names.end());
    EXPECT_THAT(names, ElementsAre("cracks.csv", "equilibria.csv", "history.csv", "jumps.csv", "notes.txt", "run.log"));
    EXPECT_TRUE(steps_in(directory / "history.csv").empty());
}

TEST(RunWriter, SaysWhenTheDirectoryCannotBeMade) {
    const TemporaryDirectory directory;
    write_file(directory / "f", "");
    EXPECT_THROW(SmallRun(directory / "f/results", {}), ResourceError);
}

// Files cannot grow beyond 20 kB, so that pictures and fields fail; state, tables and summary must still be there.
TEST(RunWriter, SavesWhatItCanWhenTheDiskIsFull) {
    const TemporaryDirectory directory;
    SmallRun run(directory.path(), {});
    run.go_to(14);
    {
        const FileLimit limit(20000);
        EXPECT_THROW(run.finish(RunStatus::out_of_resources), ResourceError);
    }
    EXPECT_FALSE(fs::exists(directory / "blocks.png"));
    EXPECT_FALSE(fs::exists(directory / "blocks.png.part"));
    EXPECT_EQ(nlohmann::json::parse(read_file(directory / "summary.json"))["status"], "out_of_resources");
    EXPECT_EQ(read_state(directory / "state.h5", "scene").at.step, 14);
}

// The history is the first of the tables, so that without room for its row none of the other tables has one either; all
// are written as soon as there is room, before the state.
TEST(RunWriter, WritesTheRowsThatWaitedForRoomOnTheDisk) {
    const TemporaryDirectory directory;
    RunWriterOptions options;
    options.history_columns = {"top.displacement_y", "foot.normal_force"};
    SmallRun run(directory.path(), options);
    run.go_to(8);
    {
        const FileLimit limit(fs::file_size(directory / "history.csv") + 20);
        EXPECT_THROW(run.go_to(9, false), ResourceError);
    }
    EXPECT_EQ(steps_in(directory / "history.csv").back(), 8);
    run.finish(RunStatus::out_of_resources);
    EXPECT_EQ(read_state(directory / "state.h5", "scene").at.step, 9);
    for (const char* name : {"history.csv", "equilibria.csv", "cracks.csv", "jumps.csv", "histories.csv"})
        EXPECT_THAT(read_file(directory / name), HasSubstr("\n9,")) << name;
}

// What was told of a load step that was never committed is in no table, and in no number of the summary.
TEST(RunWriter, ForgetsTheRowsOfAStepThatIsNotCommitted) {
    const TemporaryDirectory directory;
    SmallRun run(directory.path(), {});
    run.go_to(5);
    run.try_step(9); // the peak
    const RunSummary summary = run.finish(RunStatus::out_of_resources);
    EXPECT_EQ(steps_in(directory / "equilibria.csv").back(), 5);
    EXPECT_EQ(*summary.numbers.peak_stress, SmallRun::record_of(5).axial_stress);
}

TEST(RunWriter, SavesAStateWhenTheLastOneIsOld) {
    const TemporaryDirectory directory;
    RunWriterOptions options;
    options.checkpoint_seconds = 1000.0;
    { SmallRun(directory.path(), options).go_to(3); }
    EXPECT_FALSE(fs::exists(directory / "state.h5"));
    options.checkpoint_seconds = 1e-9;
    { SmallRun(directory.path(), options).go_to(3); }
    EXPECT_EQ(read_state(directory / "state.h5", "scene").at.step, 3);
    options.checkpoint_seconds = 0.0;
    { SmallRun(directory.path(), options).go_to(3); }
    EXPECT_FALSE(fs::exists(directory / "state.h5"));
}

// Pictures do not fit: the run ends without room, whatever it was before, and its summary says so.
TEST(RunWriter, SaysInTheSummaryThatTheDiskWasFullAtTheEnd) {
    const TemporaryDirectory directory;
    RunWriterOptions options;
    options.fields = false;
    SmallRun run(directory.path(), options);
    run.go_to(14);
    {
        const FileLimit limit(20000);
        EXPECT_THROW(run.finish(RunStatus::done), ResourceError);
    }
    const auto json = nlohmann::json::parse(read_file(directory / "summary.json"));
    EXPECT_EQ(json["status"], "out_of_resources");
    EXPECT_THAT(json["message"].get<std::string>(), HasSubstr("cannot write: File too large"));
}

// A row is some 250 bytes of memory and stands in two tables.
TEST(RunWriter, HoldsNoMoreMemoryAfterManyLoadSteps) {
#if defined(KLUFT_SANITIZED) || !defined(__GLIBC__)
    GTEST_SKIP() << "counts the bytes of the GNU allocator";
#else
    const TemporaryDirectory directory;
    RunWriterOptions options;
    options.fields = false;
    SmallRun run(directory.path(), options);
    run.go_to(100);
    const std::size_t before = mallinfo2().uordblks;
    run.go_to(1000, false);
    EXPECT_LT(mallinfo2().uordblks, before + 20000);
#endif
}

} // namespace
} // namespace kluft
