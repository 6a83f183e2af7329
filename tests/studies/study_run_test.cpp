// Running a study: what is run and what is not, what a case leaves, and what others than Kluft run.
#include "kluft/studies/study_run.hpp"

#include <algorithm>
#include <atomic>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <optional>
#include <regex>
#include <sstream>
#include <thread>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>

#include "kluft/core/diagnostics.hpp"
#include "kluft/output/atomic_file.hpp"
#include "kluft/output/directory_lock.hpp"
#include "kluft/studies/ready_made_studies.hpp"
#include "kluft/studies/study_emit.hpp"
#include "kluft/studies/study_results.hpp"
#include "output/temporary_directory.hpp"
#include "scene/scene_text.hpp"

namespace kluft {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using ::testing::SizeIs;
using testing::TemporaryDirectory;
using ::testing::ThrowsMessage;

// Six blocks, two stages, cracks: runs in a tenth of a second.
const char* const tiny_scene = R"(kluft: 1
title: Tiny
materials:
  rock: {density: 2300, youngs_modulus: 1500 MPa, poissons_ratio: 0.25, cohesion: 0.05 MPa, friction_angle: 40, tensile_strength: 0.05 MPa}
interfaces:
  joint: {kind: fracture, normal_stiffness_times_spacing: 200 MPa, shear_stiffness_times_spacing: 100 MPa, friction_angle: 20, cohesion: 0.02 MPa}
  bond: {kind: potential_crack, normal_stiffness_times_spacing: 200 MPa, shear_stiffness_times_spacing: 100 MPa, fails_to: joint}
geometry:
  domain: {rectangle: {width: 0.2, height: 0.4}}
  tessellation: {hexagons: {spacing: 0.1}, interface: bond}
boundaries: {bottom: {support: smooth}}
stages:
  - {name: pressure, pressure: {left: 0.1 MPa, right: 0.1 MPa, top: 0.1 MPa}, steps: 2}
  - {name: platen, strain: {boundary: top, value: 1 %}, steps: 8}
output: {pictures: false, fields: false}
)";

// Stands in for the program: says in `starts` that it was started and in summary.json a peak that is the number of load
// steps. 55 steps change the scene, 66 kill it, 77 end as bad input, 88 take longer than anyone waits, 99 save a state when they are stopped.
const char* const stand_in = R"(#!/bin/bash
for ((i = 1; i <= $#; ++i)); do
    case ${!i} in
    -o) j=$((i + 1)); directory=${!j} ;;
    stages.1.steps=*) steps=${!i#stages.1.steps=} ;;
    esac
done
echo "$steps ${*: -1}" >>"$(dirname "$0")/starts"
case $steps in
55) echo 'cracks: {update: all}' >>"$(dirname "$0")/scene.yaml" ;;
66) kill -9 $$ ;;
77) echo 'the scene is wrong' >&2; exit 2 ;;
88) sleep 100 & trap 'kill $!; exit 130' INT; wait ;;
99) if [[ ${*: -1} != --resume ]]; then touch "$directory/state.h5"; exit 130; fi ;;
esac
echo "{\"status\": \"done\", \"peak_stress\": $steps, \"peak_strain\": null, \"loading_cpu_s\": 1.5}" >"$directory/summary.json"
)";

std::string content_of(const fs::path& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
}

std::vector<std::string> lines_of(const std::string& text) {
    std::vector<std::string> lines;
    std::istringstream stream(text);
    for (std::string line; std::getline(stream, line);) lines.push_back(line);
    return lines;
}

int exit_code_of(const std::string& command) { return WEXITSTATUS(std::system(command.c_str())); }

class StudyRuns : public ::testing::Test {
protected:
    StudyRuns() {
        std::ofstream(directory_ / "scene.yaml") << tiny_scene;
        std::ofstream(directory_ / "program") << stand_in;
        fs::permissions(directory_ / "program", fs::perms::owner_all);
    }

    ReadStudy read(const std::string& text) const {
        return read_study_text("scene: scene.yaml\n" + text, {}, directory_ / "study.yaml");
    }
    StudyTable run(const ReadStudy& study, const fs::path& program, int jobs = 2) const {
        prepare_study(study, program, results_);
        return run_study(study, results_, {program, jobs, {}}, stop_);
    }
    StudyTable run(const std::string& text) const { return run(read(text), directory_ / "program"); }

    /// Steps and last words of the starts since the last call, sorted.
    std::vector<std::string> starts() const {
        auto lines = lines_of(content_of(directory_ / "starts"));
        fs::remove(directory_ / "starts");
        std::ranges::sort(lines);
        return lines;
    }

    TemporaryDirectory directory_;
    fs::path results_ = directory_ / "results";
    std::atomic<bool> stop_{false};
};

std::vector<CaseStatus> statuses_of(const StudyTable& table) {
    std::vector<CaseStatus> statuses;
    for (const auto& one : table.cases) statuses.push_back(one.status);
    return statuses;
}

std::string steps(const std::string& list) { return "vary: {stages.1.steps: [" + list + "]}\n"; }

TEST_F(StudyRuns, EveryCaseIsRunOnceAndNeverAgain) {
    const StudyTable table = run(steps("10, 20, 40"));
    EXPECT_THAT(statuses_of(table), ::testing::Each(CaseStatus::done));
    EXPECT_THAT(starts(), ElementsAre("10 --force", "20 --force", "40 --force"));
    EXPECT_EQ(table.cases[0].quantities[0], 10.0);
    EXPECT_EQ(table.cases[0].errors[0], (10.0 - 40.0) / 40.0);
    EXPECT_EQ(table.cases[0].quantities[1], std::nullopt);
    ASSERT_TRUE(table.reference);
    EXPECT_EQ(*table.reference, 2U);
    EXPECT_EQ(table.reference_name, "case steps=40 (stages.1.steps: 40)");

    (void)run(steps("10, 20, 40"));
    EXPECT_THAT(starts(), IsEmpty());
    EXPECT_THAT(statuses_of(run(steps("5, 10, 20, 40"))), SizeIs(4));
    EXPECT_THAT(starts(), ElementsAre("5 --force"));
}

TEST_F(StudyRuns, ChangedScenesAndSettingsAreRunAgain) {
    (void)run(steps("10, 20"));
    (void)starts();
    (void)run(steps("10, 20") + "set: {solver.tolerance: 1e-4}\n");
    EXPECT_THAT(starts(), SizeIs(2));
    std::ofstream(directory_ / "scene.yaml", std::ios::app) << "cracks: {update: all}\n";
    EXPECT_EQ(collect_study(read(steps("10, 20")), results_).cases[0].status, CaseStatus::waiting);
    (void)run(steps("10, 20"));
    EXPECT_THAT(starts(), SizeIs(2));
}

// A table with cases of two scenes would be nobody's study. The 55 steps of the stand-in change the scene.
TEST_F(StudyRuns, CasesOfASceneThatChangesMeanwhileFail) {
    const StudyTable table = run(read(steps("10, 55, 20")), directory_ / "program", 1);
    EXPECT_THAT(statuses_of(table), ElementsAre(CaseStatus::done, CaseStatus::failed, CaseStatus::failed));
    EXPECT_THAT(table.cases[1].reason, HasSubstr("the scene has changed since the study began"));
    (void)starts();
    fs::remove(directory_ / "program");
    std::ofstream(directory_ / "program") << std::regex_replace(stand_in, std::regex("\n55\\)[^\n]*"), "");
    fs::permissions(directory_ / "program", fs::perms::owner_all);
    EXPECT_THAT(statuses_of(run(steps("10, 55, 20"))), ::testing::Each(CaseStatus::done));
    EXPECT_THAT(starts(), SizeIs(3));
}

TEST_F(StudyRuns, KilledAndRefusedCasesAreToldAndTheOthersGoOn) {
    const StudyTable table = run(steps("10, 66, 77, 20"));
    EXPECT_THAT(statuses_of(table),
                ElementsAre(CaseStatus::done, CaseStatus::failed, CaseStatus::refused, CaseStatus::done));
    EXPECT_EQ(table.cases[1].reason, "killed by signal 9 (Killed)");
    EXPECT_EQ(table.cases[2].reason, "the scene is wrong");
    EXPECT_EQ(table.cases[1].quantities[0], std::nullopt);
    (void)starts();
    (void)run(steps("10, 66, 77, 20"));
    EXPECT_THAT(starts(), ElementsAre("66 --force")); // what failed is tried again
}

TEST_F(StudyRuns, CaseThatTakesTooLongIsStopped) {
    const StudyTable table = run(steps("10, 88") + "time_limit: 0.3\n");
    EXPECT_EQ(table.cases[1].status, CaseStatus::failed);
    EXPECT_THAT(table.cases[1].reason, HasSubstr("after the time limit of 0.3 s"));
    EXPECT_LT(*table.cases[1].elapsed_s, 10.0);
}

// Asked before it has become the program of the case: by then it has the handlers of the study's own program.
TEST_F(StudyRuns, CaseIsStoppedHoweverShortItsTimeIs) {
    void (*const before)(int) = std::signal(SIGINT, [](int) {});
    const StudyTable table = run(steps("88") + "time_limit: 1e-9\n");
    std::signal(SIGINT, before);
    EXPECT_EQ(table.cases[0].status, CaseStatus::failed);
    EXPECT_THAT(table.cases[0].reason, HasSubstr("after the time limit of 1e-09 s"));
    EXPECT_LT(*table.cases[0].elapsed_s, 5.0);
}

TEST_F(StudyRuns, InterruptedCaseGoesOnFromItsSavedState) {
    EXPECT_EQ(run(steps("10, 99")).cases[1].status, CaseStatus::waiting);
    EXPECT_THAT(starts(), ElementsAre("10 --force", "99 --force"));
    EXPECT_EQ(run(steps("10, 99")).cases[1].status, CaseStatus::done);
    EXPECT_THAT(starts(), ElementsAre("99 --resume"));
}

TEST_F(StudyRuns, InterruptedStudyStopsItsCasesAndLeavesATable) {
    const ReadStudy study = read(steps("88, 10"));
    prepare_study(study, directory_ / "program", results_);
    std::thread user([&] {
        while (!fs::exists(directory_ / "starts")) std::this_thread::yield();
        stop_ = true;
    });
    const StudyTable table = run_study(study, results_, {directory_ / "program", 1, {}}, stop_);
    user.join();
    EXPECT_THAT(statuses_of(table), ElementsAre(CaseStatus::waiting, CaseStatus::waiting));
    EXPECT_THAT(lines_of(content_of(results_ / "study.csv")), SizeIs(3));
}

// As a run does that a killed study has left and that still saves its state.
TEST_F(StudyRuns, CaseThatAnotherProcessRunsIsWaitedFor) {
    const ReadStudy study = read(steps("10, 20"));
    prepare_study(study, directory_ / "program", results_);
    std::optional<DirectoryLock> earlier(std::in_place, case_directory(results_, study.cases[0]), "kluft run");
    std::jthread saving([&] {
        while (!fs::exists(results_ / "cases/steps=20/outcome.json")) std::this_thread::yield();
        EXPECT_THAT(starts(), ElementsAre("20 --force"));
        earlier.reset();
    });
    const StudyTable table = run_study(study, results_, {directory_ / "program", 2, {}}, stop_);
    EXPECT_THAT(statuses_of(table), ElementsAre(CaseStatus::done, CaseStatus::done));
    EXPECT_THAT(starts(), ElementsAre("10 --force"));
}

TEST_F(StudyRuns, SummaryThatIsGoneIsNamed) {
    const ReadStudy study = read(steps("10, 20"));
    (void)run(steps("10, 20"));
    for (const bool is_there : {true, false}) {
        const fs::path summary = results_ / "cases/steps=20/summary.json";
        if (is_there) write_file(summary, "damaged");
        if (!is_there) fs::remove(summary);
        const StudyTable table = collect_study(study, results_);
        EXPECT_THAT(statuses_of(table), ElementsAre(CaseStatus::done, CaseStatus::failed));
        EXPECT_THAT(table.cases[1].reason,
                    AllOf(HasSubstr("steps=20/summary.json, found none"), HasSubstr("makes it anew")));
    }
}

TEST_F(StudyRuns, ClosedFormAndOtherRunsAreReferencesToo) {
    const StudyTable closed = run(steps("10, 20") + "reference: {values: {peak_stress: 16}}\n");
    EXPECT_EQ(closed.cases[0].errors[0], -0.375);
    EXPECT_EQ(closed.reference_name, "closed form");
    const StudyTable other = run(steps("10, 20") + "reference: {directory: results/cases/steps=20}\n");
    EXPECT_EQ(other.cases[0].errors[0], -0.5);
    EXPECT_THAT(other.reference_name, HasSubstr("cases/steps=20"));
}

TEST_F(StudyRuns, TableHasTheColumnsOfTheContractAndQuotesWhatNeedsIt) {
    (void)run(steps("10, 77") + "variants: [{name: 'a, b'}]\n");
    const auto table = collect_study(read(steps("10, 77") + "variants: [{name: 'a, b'}]\n"), results_);
    const auto lines = lines_of(study_csv(table));
    EXPECT_EQ(lines[0], "case,variant,stages.1.steps,replica,status,peak_stress,peak_strain,error_peak_stress,"
                        "error_peak_strain,curve_error,cpu_s,elapsed_s,reason");
    EXPECT_THAT(lines[1], HasSubstr(",\"a, b\",10,0,done,10,,,,,"));
    EXPECT_THAT(lines[2], AllOf(HasSubstr(",77,0,refused,,,,,,"), HasSubstr(",the scene is wrong")));
}

// The program itself. The L2 distance of a curve to itself is zero.
TEST_F(StudyRuns, RealCasesHaveCurvesAndCosts) {
    const ReadStudy study = read(steps("5, 20") + "quantities: [peak_stress, cracks_shear, peak_reached]\n");
    const StudyTable table = run(study, KLUFT_PROGRAM);
    ASSERT_THAT(statuses_of(table), ::testing::Each(CaseStatus::done));
    EXPECT_EQ(table.cases[1].curve_error, 0.0);
    EXPECT_GT(*table.cases[0].curve_error, 1e-6);
    EXPECT_LT(*table.cases[0].curve_error, 0.2);
    for (const auto& one : table.cases) {
        EXPECT_GT(*one.cpu_s, 0.0);
        EXPECT_LT(*one.cpu_s, 60.0);
        EXPECT_GT(*one.quantities[0], 1e5);
    }
    EXPECT_EQ(study_csv(collect_study(study, results_)), content_of(results_ / "study.csv"));
    EXPECT_THAT(content_of(results_ / "cases" / "steps=5" / "summary.json"), HasSubstr("\"cpu_s\""));
}

// Strains of a body that is pressed by given loads only are no curve, so that there is no error of one.
TEST_F(StudyRuns, CasesThatMoveNoPlatenHaveNoCurve) {
    std::ofstream(directory_ / "scene.yaml") << std::regex_replace(
        tiny_scene, std::regex("strain: \\{boundary: top, value: 1 %\\}"), "pressure: {top: 0.15 MPa}");
    const StudyTable table = run(read(steps("2, 4") + "quantities: [cracks_shear]\n"), KLUFT_PROGRAM);
    ASSERT_THAT(statuses_of(table), ::testing::Each(CaseStatus::done));
    for (const StudyCase& each : table.cases) EXPECT_EQ(each.curve_error, std::nullopt);
}

// A body that has lost a fifth of its strength is not pressed on, and its peak is that of the whole run.
TEST_F(StudyRuns, CasesMayEndAfterADropOfTheStress) {
    const ReadStudy study = read("vary: {stages.1.stop_after_drop: [0.2, null]}\n"
                                 "set: {stages.1.steps: 20, interfaces.joint.friction_angle: 10}\n"
                                 "quantities: [peak_stress, peak_reached, steps]\n");
    const StudyTable table = run(study, KLUFT_PROGRAM);
    ASSERT_THAT(statuses_of(table), ::testing::Each(CaseStatus::done));
    EXPECT_EQ(table.cases[0].quantities[0], table.cases[1].quantities[0]);
    EXPECT_EQ(table.cases[0].quantities[1], 1.0);
    EXPECT_LT(*table.cases[0].quantities[2], 22.0);
    EXPECT_EQ(table.cases[1].quantities[2], 22.0);
}

// ---- others that run the cases -------------------------------------------------------------------------------------

TEST_F(StudyRuns, MakefileRunsWhatHasNotEndedAndGathersTheSameTable) {
    const ReadStudy study = read(steps("10, 66, 77, 99"));
    prepare_study(study, directory_ / "program", results_);
    const std::string next = emit_study("make", study, results_, 2, {"/bin/sh", "-c", "echo $HOME >collected"});
    EXPECT_EQ(next, "make -j2 -C " + results_.string() + "\n");
    EXPECT_EQ(exit_code_of("make -s -j2 -C '" + results_.string() + "' >/dev/null 2>&1"), 0);
    EXPECT_EQ(content_of(results_ / "collected"), std::string(std::getenv("HOME")) + "\n");
    EXPECT_THAT(starts(), ElementsAre("10 --force", "66 --force", "77 --force", "99 --force"));
    auto statuses = statuses_of(collect_study(study, results_));
    EXPECT_THAT(statuses, ElementsAre(CaseStatus::done, CaseStatus::failed, CaseStatus::refused, CaseStatus::waiting));
    EXPECT_EQ(collect_study(study, results_).cases[1].reason, "killed by signal 9 (Killed)");

    EXPECT_EQ(exit_code_of("make -s -C '" + results_.string() + "' >/dev/null 2>&1"), 0);
    EXPECT_THAT(starts(), ElementsAre("66 --force", "99 --resume"));
    statuses = statuses_of(collect_study(study, results_));
    EXPECT_EQ(statuses[3], CaseStatus::done);
}

TEST_F(StudyRuns, CasesHaveTheirPicturesOnlyWhereTheStudyAsksForThem) {
    const auto words = [&](const std::string& study) {
        const ReadStudy read_study = read(steps("10") + study);
        return case_command(read_study, read_study.cases[0], "/opt/kluft", results_);
    };
    EXPECT_THAT(words(""), ::testing::Contains("output.pictures=false"));
    EXPECT_THAT(words("pictures: true\n"), ::testing::Contains("output.pictures=true"));
}

// What start-up, the cut of the net and pictures take is none of what the load steps cost.
TEST_F(StudyRuns, CostOfACaseIsThatOfItsLoadSteps) {
    const StudyTable table = run(steps("10"));
    EXPECT_EQ(table.cases[0].cpu_s, 1.5);
}

TEST_F(StudyRuns, JobArrayHasOneJobForEachLineOfCommands) {
    const ReadStudy study = read("vary: {stages.1.steps: [10, 20], interfaces.bond.kind: [potential_crack, fracture], "
                                 "title: [\"it's\", \"$HOME\"]}\n");
    prepare_study(study, "/opt/kluft", results_);
    const auto lines = lines_of(content_of(results_ / "cases.txt"));
    ASSERT_THAT(lines, SizeIs(4)); // without those that the scene's reader refuses
    EXPECT_EQ(lines[0],
              fmt::format("/opt/kluft run {} -o {}/cases/{} --set output.pictures=false --set output.report=false "
                          "--set stages.1.steps=10 --set "
                          "interfaces.bond.kind=potential_crack --set 'title=\"it'\\''s\"' --threads 1 --quiet",
                          (directory_ / "scene.yaml").string(), results_.string(), study.cases[0].name));
    const std::string next = emit_study("slurm", study, results_, 3, {"collect"});
    EXPECT_THAT(next, AllOf(HasSubstr("sbatch"), HasSubstr("\ncollect\n")));
    const std::string script = content_of(results_ / "study.slurm");
    EXPECT_THAT(script, AllOf(HasSubstr("#SBATCH --array=0-3%3\n"), HasSubstr("#SBATCH --requeue\n"),
                              HasSubstr("#SBATCH --signal=B:USR1@120\n"), Not(HasSubstr("--time"))));
    EXPECT_EQ(exit_code_of("bash -n '" + (results_ / "run-case").string() + "'"), 0);
    EXPECT_THROW((void)emit_study("pbs", study, results_, 3, {}), InputError);
}

// Slurm takes a line "#SBATCH" apart at its spaces, as a shell does, and replaces what begins with a per cent sign.
TEST_F(StudyRuns, JobArrayQuotesItsPlace) {
    const ReadStudy study = read(steps("10, 20"));
    const fs::path odd = directory_ / "it's 50 %";
    prepare_study(study, "/opt/kluft", odd);
    (void)emit_study("slurm", study, odd, 3, {"collect"});
    const std::string script = content_of(odd / "study.slurm");
    EXPECT_THAT(script,
                HasSubstr("\n#SBATCH '--output=" + directory_.path().string() + "/it'\\''s 50 %%/slurm-%a.log'\n"));
    EXPECT_THAT(script, HasSubstr("\n#SBATCH --job-name=kluft-study\n"));
}

TEST_F(StudyRuns, LineBreaksInNamesAreRefused) {
    const auto is_refused = ThrowsMessage<InputError>(HasSubstr("found a line break"));
    const ReadStudy study = read(steps("10, 20"));
    EXPECT_THAT([&] { prepare_study(study, "/opt/kluft", directory_ / "two\nlines"); }, is_refused);
    EXPECT_FALSE(fs::exists(directory_ / "two\nlines"));
    ReadStudy named = study;
    named.study.name = "study\ntouch file";
    EXPECT_THAT([&] { prepare_study(named, "/opt/kluft", results_); }, is_refused);
    prepare_study(study, "/opt/kluft", results_);
    EXPECT_THAT([&] { (void)emit_study("make", study, results_, 1, {"collect", "two\nlines.yaml"}); }, is_refused);
}

// ---- ready-made studies and the command ----------------------------------------------------------------------------

TEST_F(StudyRuns, StepSizeStudyTakesTheLastStageThatMovesAPlaten) {
    std::ofstream(directory_ / "made.yaml") << step_size_study(directory_ / "scene.yaml");
    const ReadStudy study = read_study(directory_ / "made.yaml");
    ASSERT_THAT(study.cases, SizeIs(7));
    EXPECT_EQ(study.study.parameters[0].key, "stages.1.steps");
    EXPECT_EQ(study.cases[0].settings[0], "8"); // the scene's own
    EXPECT_EQ(study.cases[6].settings[0], "800");
    std::ofstream(directory_ / "same.yaml") << step_size_study(directory_ / "scene.yaml", {"stages.1.steps=100"});
    EXPECT_THAT(read_study(directory_ / "same.yaml").cases, SizeIs(6));
    EXPECT_THROW((void)ready_made_study("step", directory_ / "scene.yaml"), InputError);
}

TEST_F(StudyRuns, ReadyMadeStudyReplacesItsLikeOnly) {
    const std::string mine = "scene: scene.yaml\n" + steps("4, 8");
    std::ofstream(directory_ / "study.yaml") << mine;
    const std::string in = "cd '" + (directory_ / ".").string() + "' && " + KLUFT_PROGRAM + " study ";
    EXPECT_EQ(exit_code_of(in + "step-size scene.yaml -o . --emit make >said 2>&1"), 2);
    EXPECT_THAT(content_of(directory_ / "said"), HasSubstr("found another study, which would be lost"));
    EXPECT_EQ(content_of(directory_ / "study.yaml"), mine);
    EXPECT_EQ(exit_code_of(in + "step-size scene.yaml -o made --emit make >said 2>&1"), 0);
    EXPECT_EQ(exit_code_of(in + "step-size scene.yaml -o made --emit make >said 2>&1"), 0);
    const std::string made = content_of(directory_ / "made" / "study.yaml");
    const DirectoryLock lock(directory_ / "made", "kluft study step-size");
    EXPECT_EQ(exit_code_of(in + "step-size scene.yaml -o made --set title=Other --emit make >said 2>&1"), 2);
    EXPECT_EQ(content_of(directory_ / "made" / "study.yaml"), made);
}

TEST_F(StudyRuns, TradeStudyRefusesNoCaseOfTheOtherIntegrator) {
    std::ofstream(directory_ / "made.yaml") << ready_made_study("trade", directory_ / "scene.yaml");
    const ReadStudy study = read_study(directory_ / "made.yaml");
    EXPECT_TRUE(std::ranges::any_of(study.cases, [](const auto& one) { return one.variant == "explicit"; }));
    for (const auto& one : study.cases) EXPECT_EQ(one.refusal, "") << one.name;
}

// A study's report among a run's files would take the place of the run's own.
TEST_F(StudyRuns, CommandStandsNotAmongTheFilesOfARun) {
    std::ofstream(directory_ / "study.yaml") << "scene: scene.yaml\n" << steps("2, 4");
    const std::string into =
        "cd '" + directory_.path().string() + "' && '" KLUFT_PROGRAM "' study study.yaml --quiet -o ";
    fs::create_directory(directory_ / "run");
    std::ofstream(directory_ / "run" / "history.csv") << "step\n";
    EXPECT_EQ(exit_code_of(into + "run 2>told"), 2);
    EXPECT_THAT(content_of(directory_ / "told"), HasSubstr("expected another directory than that of a run"));
    EXPECT_EQ(exit_code_of(into + "study.yaml 2>told"), 2);
    EXPECT_THAT(content_of(directory_ / "told"), HasSubstr("expected a directory for the results, found a file"));
}

TEST_F(StudyRuns, CommandWritesTheTableAndAnswersMistakesWithTheirPlace) {
    std::ofstream(directory_ / "study.yaml") << "scene: scene.yaml\n" << steps("4, 8");
    const std::string in = "cd '" + (directory_ / ".").string() + "' && " + KLUFT_PROGRAM + " study ";
    EXPECT_EQ(exit_code_of(in + "study.yaml -o out >said 2>&1"), 0);
    EXPECT_THAT(content_of(directory_ / "said"), HasSubstr("2 cases: 2 done; table in "));
    const std::string table = content_of(directory_ / "out" / "study.csv");
    EXPECT_THAT(lines_of(table), SizeIs(3));
    EXPECT_EQ(exit_code_of(in + "study.yaml -o out --collect >said 2>&1"), 0);
    EXPECT_EQ(content_of(directory_ / "out" / "study.csv"), table);
    EXPECT_EQ(exit_code_of(in + "study.yaml -o other --collect >said 2>&1"), 2) << "no directory of a study";
    EXPECT_THAT(content_of(directory_ / "said"), HasSubstr("expected the directory of a study, found no "));
    EXPECT_EQ(exit_code_of(in + "step-siz scene.yaml >said 2>&1"), 2);
    EXPECT_THAT(content_of(directory_ / "said"), HasSubstr("did you mean 'step-size'?"));
    EXPECT_EQ(exit_code_of(in + "absent.yaml >said 2>&1"), 2);
    EXPECT_THAT(content_of(directory_ / "said"), HasSubstr("absent.yaml: expected a study file, found no such file"));
}

} // namespace
} // namespace kluft
