// kluft calibrate as a user sees it: exit codes, what it leaves, going on after a stop.
#include <csignal>
#include <cstdlib>
#include <iterator>
#include <map>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <sys/wait.h>
#include <unistd.h>

#include "calibration/calibration_scenes.hpp"
#include "kluft/output/summary.hpp"
#include "kluft/scene/scene_reader.hpp"
#include "output/temporary_directory.hpp"
#include "support/scene_run.hpp"

namespace kluft {
namespace {

using namespace kluft::testing;
using ::testing::AllOf;
using ::testing::HasSubstr;
namespace fs = std::filesystem;

std::string text_of(const fs::path& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
}

/// Some seventy blocks: runs in about a second.
std::string small_specimen() {
    std::string scene = specimen("hexagons: {spacing: 0.01}");
    const std::string size = "width: 0.2, height: 0.4";
    return scene.replace(scene.find(size), size.size(), "width: 0.05, height: 0.1");
}

const std::string moduli =
    "kluft_calibration: 1\nscene: scene.yaml\nparameters:\n"
    "  kn: {keys: [interfaces.bond.normal_stiffness], start: 400 GPa/m, from: 1 GPa/m, to: 90 TPa/m}\n"
    "  ks: {keys: [interfaces.bond.shear_stiffness], start: 100 GPa/m, from: 1 GPa/m, to: 90 TPa/m}\n";
const std::string cohesion = "  c: {keys: [materials.rock.cohesion], start: 5 MPa, from: 1 MPa, to: 50 MPa}\n";
const std::string elasticity = "targets:\n  youngs_modulus: {value: 10 GPa, tolerance: 0.1 %}\n"
                               "  poissons_ratio: {value: 0.25, tolerance: 0.1 %}\n";
const std::string peak = "  peak_stress: {value: 40 MPa, tolerance: 5 %, set: {stages.0.pressure.left: 1 MPa, "
                         "stages.0.pressure.right: 1 MPa}}\n";

class CalibrateProgram : public ::testing::Test {
protected:
    CalibrateProgram() { write_text(path("scene.yaml"), small_specimen()); }

    [[nodiscard]] fs::path path(const std::string& name) const { return directory_ / name; }

    /// The exit code; what is told is in `told`. `before`: shell commands.
    int run(const std::string& target, const std::string& before = {}) {
        write_text(path("target.yaml"), target);
        const std::string command = before + "\"" + KLUFT_PROGRAM + "\" calibrate \"" + path("target.yaml").string() +
                                    "\" -o \"" + path("out").string() + "\" >\"" + path("told").string() + "\" 2>&1";
        const int status = std::system(command.c_str());
        told_ = text_of(path("told"));
        return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
    }

    /// When the runs in the directory ended, by file.
    [[nodiscard]] std::map<std::string, fs::file_time_type> ends() const {
        std::map<std::string, fs::file_time_type> times;
        if (!fs::exists(path("out") / "runs")) return times;
        for (const auto& entry : fs::recursive_directory_iterator(path("out") / "runs"))
            if (entry.path().filename() == "outcome.json") times[entry.path().string()] = entry.last_write_time();
        return times;
    }

    TemporaryDirectory directory_;
    std::string told_;
};

TEST_F(CalibrateProgram, MeetsElasticTargetsWithASceneThatRuns) {
    ASSERT_EQ(run(moduli + elasticity), 0) << told_;
    const std::string scene = text_of(path("out") / "calibrated.yaml");
    EXPECT_THAT(scene, AllOf(HasSubstr("extends:"), HasSubstr("# youngs_modulus: wanted 10 GPa, found 10 GPa")));
    EXPECT_THAT(text_of(path("out") / "report.html"), HasSubstr("All targets are met."));
    const auto json = nlohmann::json::parse(text_of(path("out") / "calibration.json"));
    EXPECT_TRUE(json.at("met"));
    EXPECT_TRUE(json.at("warnings").empty()); // no fracture that could slip
    EXPECT_LT(json.at("elastic_evaluations"), 20);
    // The scene itself, at so little strain that its square does not count.
    const SceneRun found =
        run_scene(read_scene(path("out") / "calibrated.yaml", {"stages.1.strain.value=1e-6", "stages.1.steps=3"}));
    const auto numbers = curve_numbers(found.equilibria, found.history, 1, Plane::strain);
    EXPECT_NEAR(*numbers.youngs_modulus / 10e9, 1.0, 1e-3);
    EXPECT_NEAR(*numbers.poissons_ratio / 0.25, 1.0, 1e-3);
}

// A real scene: stiffnesses by the elastic stage, the cohesion by runs; then the same command again, which runs nothing.
TEST_F(CalibrateProgram, MeetsAPeakByRunsAndRunsNothingTwice) {
    const std::string target = moduli + cohesion + elasticity + peak + "replicas: 2\n";
    ASSERT_EQ(run(target), 0) << told_;
    const auto json = nlohmann::json::parse(text_of(path("out") / "calibration.json"));
    const auto& found = json.at("targets").back();
    EXPECT_EQ(found.at("name"), "peak_stress");
    EXPECT_NEAR(found.at("found").get<double>() / 40e6, 1.0, 0.05);
    EXPECT_EQ(found.at("copies").size(), 2U);
    EXPECT_TRUE(json.at("parameters").back().at("low").is_number());
    const auto first = ends();
    EXPECT_FALSE(first.empty());
    ASSERT_EQ(run(target), 0) << told_;
    EXPECT_EQ(ends(), first);
    auto again = nlohmann::json::parse(text_of(path("out") / "calibration.json"));
    EXPECT_EQ(again.at("parameters"), json.at("parameters"));
}

// What a body bears until its sides are unloaded is less than its strength under their pressure.
TEST_F(CalibrateProgram, TakesNoPeakThatEndedByUnloading) {
    std::string scene = small_specimen();
    const std::string platen = "value: 0.8 %}, steps: 20}\n";
    scene.replace(
        scene.find(platen), platen.size(),
        "value: 0.35 %}, steps: 10}\n  - {name: unloading, pressure: {left: 0, right: 0}, strain: {boundary: top, "
        "value: 0.005 %}, steps: 5}\n");
    write_text(path("scene.yaml"), scene);
    const std::string under_pressure = "targets:\n  peak_stress: {value: 40 MPa, tolerance: 5 %, set: "
                                       "{stages.0.pressure.left: 5 MPa, stages.0.pressure.right: 5 MPa}}\n";
    EXPECT_EQ(run("kluft_calibration: 1\nscene: scene.yaml\nparameters:\n" + cohesion + under_pressure), 1);
    EXPECT_THAT(told_, AllOf(HasSubstr("found nothing"), HasSubstr("the stress fell after the sides were unloaded")));
}

TEST_F(CalibrateProgram, SaysWhichTargetsOpposeEachOther) {
    const std::string one =
        "kluft_calibration: 1\nscene: scene.yaml\nparameters:\n"
        "  k: {keys: [interfaces.bond.normal_stiffness, {key: interfaces.bond.shear_stiffness, times: "
        "0.5}], start: 1 TPa/m, from: 1 GPa/m, to: 90 TPa/m}\n";
    EXPECT_EQ(run(one + "targets:\n  youngs_modulus: {value: 10 GPa, tolerance: 0.1 %}\n"
                        "  poissons_ratio: {value: 0.15, tolerance: 0.1 %}\n"),
              1);
    EXPECT_THAT(told_, AllOf(HasSubstr("youngs_modulus and poissons_ratio oppose each other"), HasSubstr("missed")));
    EXPECT_TRUE(fs::exists(path("out") / "calibrated.yaml"));
    // E of the blocks is 15 GPa, which no interface makes stiffer.
    EXPECT_EQ(run(one + "targets:\n  youngs_modulus: {value: 20 GPa, tolerance: 0.1 %}\n"), 1);
    EXPECT_THAT(told_, HasSubstr("k is at its upper bound"));
}

TEST_F(CalibrateProgram, BadInputEndsWithTwo) {
    EXPECT_EQ(run("kluft_calibration: 1\nscen: scene.yaml\n"), 2);
    EXPECT_THAT(told_, HasSubstr("did you mean 'scene'?"));
    EXPECT_FALSE(fs::exists(path("out") / "calibration.json"));
}

// What a run, a calibration of another scene, or the user has left there is nobody's to replace.
TEST_F(CalibrateProgram, ReplacesItsLikeOnly) {
    fs::create_directory(path("out"));
    const auto refused = [&](const std::string& file, const std::string& content, const std::string& found) {
        write_text(path("out") / file, content);
        EXPECT_EQ(run(moduli + elasticity), 2);
        EXPECT_THAT(told_, HasSubstr(found));
        EXPECT_EQ(text_of(path("out") / file), content);
        fs::remove(path("out") / file);
    };
    refused("history.csv", "step\n", "expected another directory than that of a run");
    refused("calibrated.yaml", "kluft: 1\n", "expected a calibrated.yaml that a calibration wrote or none");
    for (const char* mine : {"report.html", "calibration.json", "progress.png", "progress.svg"})
        refused(mine, "mine", std::string("expected a ") + mine + " that a calibration wrote or none");
    refused("calibration.json", R"({"scene": "/other.yaml"})", "found those of one of the scene \"/other.yaml\"");
    EXPECT_EQ(run(moduli + elasticity), 0) << told_;
    EXPECT_EQ(run(moduli + elasticity), 0) << told_;
}

// Values found by runs of two scenes are those of none.
TEST_F(CalibrateProgram, ASceneThatChangesMeanwhileEndsIt) {
    const std::string target = moduli + cohesion + elasticity + peak;
    const std::string changes =
        "(until [ -e out/runs/0/cases ]; do sleep 0.01; done; echo 'cracks: {strength_noise: 0.001}' >>scene.yaml) & ";
    EXPECT_EQ(run(target, "cd '" + directory_.path().string() + "'; " + changes), 2);
    EXPECT_THAT(told_, HasSubstr("expected the scenes that the calibration began with"));
    EXPECT_FALSE(fs::exists(path("out") / "calibrated.yaml"));
}

// No file may grow beyond some tens of kilobytes, which a saved state does.
TEST_F(CalibrateProgram, StopsWhereARunHasNoRoomAndGoesOnFromThere) {
    const std::string target = moduli + cohesion + elasticity + peak;
    EXPECT_EQ(run(target, "ulimit -f 60; "), 4);
    EXPECT_THAT(told_, AllOf(HasSubstr("the run failed (out of disk or memory"), HasSubstr("File too large")));
    EXPECT_FALSE(fs::exists(path("out") / "calibrated.yaml"));
    EXPECT_EQ(run(target), 0) << told_;
}

TEST_F(CalibrateProgram, GoesOnAfterAStop) {
    write_text(path("target.yaml"), moduli + cohesion + elasticity + peak + "replicas: 3\n");
    const pid_t child = fork();
    if (child == 0) {
        const std::string target = path("target.yaml");
        const std::string out = path("out");
        execl(KLUFT_PROGRAM, KLUFT_PROGRAM, "calibrate", target.c_str(), "-o", out.c_str(), "--jobs", "1", "--quiet",
              nullptr);
        _exit(126);
    }
    while (ends().empty() && waitpid(child, nullptr, WNOHANG) == 0) usleep(10'000); // until a run has ended
    kill(child, SIGINT);
    int status = 0;
    waitpid(child, &status, 0);
    ASSERT_TRUE(WIFEXITED(status));
    EXPECT_EQ(WEXITSTATUS(status), 130);
    const auto first = ends();
    ASSERT_EQ(run(text_of(path("target.yaml"))), 0) << told_;
    const auto all = ends();
    EXPECT_GT(all.size(), first.size());
    EXPECT_EQ(all.at(first.begin()->first), first.begin()->second);
}

} // namespace
} // namespace kluft
