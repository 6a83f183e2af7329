#include <algorithm>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <regex>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "apps/child_process.hpp"
#include "output/temporary_directory.hpp"

namespace kluft {
namespace {

namespace fs = std::filesystem;
using testing::ChildProcess;
using ::testing::Each;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using testing::Limits;
using ::testing::Not;
using testing::Outcome;
using testing::run_kluft;
using ::testing::StartsWith;
using testing::TemporaryDirectory;
using testing::text_of;

/// A small specimen with a fracture and potential cracks; its two stages take half a second.
const std::string specimen = R"(kluft: 1
title: A small specimen
materials:
  rock: {density: 2300, youngs_modulus: 1500 MPa, poissons_ratio: 0.25, cohesion: 0.15 MPa, friction_angle: 39.6, tensile_strength: 0.05 MPa}
interfaces:
  joint: {kind: fracture, normal_stiffness_times_spacing: 200 MPa, shear_stiffness_times_spacing: 100 MPa, friction_angle: 20, contact_rounding: 0.004 MPa}
  bond: {kind: potential_crack, normal_stiffness_times_spacing: 200 MPa, shear_stiffness_times_spacing: 100 MPa, fails_to: joint}
geometry:
  domain: {rectangle: {width: 20 cm, height: 40 cm}}
  fractures:
    - {name: inclined, trace: [[-0.01, 0.10], [0.15, 0.26]], interface: joint}
  tessellation: {hexagons: {spacing: 5 cm}, interface: bond}
boundaries: {bottom: {support: pinned}}
stages:
  - {name: pressure, pressure: {left: 0.2 MPa, right: 0.2 MPa, top: 0.2 MPa}, steps: 2}
  - {name: platen, strain: {boundary: top, value: 1 %}, platens: smooth, steps: 20}
)";

const std::vector<std::string> columns{"step",
                                       "stage",
                                       "load_factor",
                                       "axial_strain",
                                       "axial_stress",
                                       "lateral_strain",
                                       "lateral_stress",
                                       "differential_stress",
                                       "volumetric_strain",
                                       "cracks_tension",
                                       "cracks_shear",
                                       "open",
                                       "sliding",
                                       "locked",
                                       "open_close_iterations",
                                       "crack_passes",
                                       "unbalanced_ratio",
                                       "balanced",
                                       "elapsed_s"};

class CommandLine : public ::testing::Test {
protected:
    fs::path write(const std::string& name, const std::string& text) const {
        std::ofstream(directory_ / name) << text;
        return directory_ / name;
    }
    Outcome kluft(const std::vector<std::string>& arguments, const Limits& limits = {}) const {
        return run_kluft(directory_.path(), arguments, limits);
    }
    /// Runs the specimen into `name`.
    Outcome run_specimen(const std::string& name, std::vector<std::string> more = {}) const {
        write("specimen.yaml", specimen);
        std::vector<std::string> arguments{"run", "specimen.yaml", "-o", name};
        arguments.insert(arguments.end(), more.begin(), more.end());
        return kluft(arguments);
    }
    [[nodiscard]] std::vector<std::vector<std::string>> table(const fs::path& file) const {
        std::vector<std::vector<std::string>> rows;
        std::istringstream lines(text_of(directory_.path() / file));
        for (std::string line; std::getline(lines, line);) {
            std::istringstream cells(line);
            rows.emplace_back();
            for (std::string cell; std::getline(cells, cell, ',');) rows.back().push_back(cell);
        }
        return rows;
    }
    /// history.csv without the times, its last column.
    [[nodiscard]] std::vector<std::vector<std::string>> history_but_times(const std::string& name) const {
        auto rows = table(fs::path(name) / "history.csv");
        for (auto& row : rows) row.pop_back();
        return rows;
    }
    [[nodiscard]] nlohmann::json summary(const std::string& name) const {
        return nlohmann::json::parse(text_of(directory_ / (name + "/summary.json")));
    }
    [[nodiscard]] bool exists(const std::string& name) const { return fs::exists(directory_ / name); }

    TemporaryDirectory directory_;
};

TEST_F(CommandLine, HelpNamesEveryCommandAndShowsExamples) {
    const Outcome general = kluft({"--help"});
    EXPECT_EQ(general.exit_code, 0);
    for (const char* command : {"run", "check", "draw", "envelope"}) {
        EXPECT_THAT(general.output, HasSubstr(command));
        const Outcome help = kluft({command, "--help"});
        EXPECT_EQ(help.exit_code, 0);
        EXPECT_THAT(help.output, HasSubstr("Example")) << command;
    }
    EXPECT_THAT(general.output, HasSubstr("Examples:"));
    EXPECT_EQ(kluft({"--version"}).exit_code, 0);
}

TEST_F(CommandLine, CompletionKnowsEveryCommandAndOption) {
    const std::string completion = text_of(fs::path(KLUFT_SOURCE_DIR) / "scripts/completions/kluft.bash");
    for (const char* command : {"run", "check", "draw", "envelope"}) {
        EXPECT_THAT(completion, HasSubstr(fmt::format("    {}) options", command)));
        const std::string help = kluft({command, "--help"}).output;
        const std::regex option("--[a-z]+");
        for (std::sregex_iterator it(help.begin(), help.end(), option), end; it != end; ++it) {
            EXPECT_THAT(completion, HasSubstr(it->str())) << command;
        }
    }
}

TEST_F(CommandLine, MistypedCommandIsAnsweredWithTheNearestOne) {
    const Outcome outcome = kluft({"rnu", "scene.yaml"});
    EXPECT_EQ(outcome.exit_code, 2);
    EXPECT_THAT(outcome.errors, HasSubstr("'rnu'"));
    EXPECT_THAT(outcome.errors, HasSubstr("did you mean 'run'?"));
    EXPECT_EQ(kluft({}).exit_code, 2);
    EXPECT_EQ(kluft({"run"}).exit_code, 2);
    EXPECT_EQ(kluft({"run", "x.yaml", "--stes"}).exit_code, 2);
}

TEST_F(CommandLine, MissingSceneFileIsBadInput) {
    const Outcome outcome = kluft({"run", "nowhere.yaml"});
    EXPECT_EQ(outcome.exit_code, 2);
    EXPECT_THAT(outcome.errors, HasSubstr("nowhere.yaml"));
    EXPECT_FALSE(exists("results"));
}

struct BadScene {
    std::string what, found, instead;
    std::vector<std::string> expected; ///< in the message
};

TEST_F(CommandLine, BadSceneNamesFileLineKeyAndWhatWasExpected) {
    const std::vector<BadScene> scenes{
        {"unknown key",
         "poissons_ratio:",
         "poisons_ratio:",
         {"specimen.yaml:4:", "'poisons_ratio'", "did you mean 'poissons_ratio'"}},
        {"wrong type", "steps: 20", "steps: many", {"specimen.yaml:16:", "stages.1.steps", "integer", "many"}},
        {"unit of another dimension", "1500 MPa", "1500 m", {"specimen.yaml:4:", "youngs_modulus", "Pa"}},
        {"out of range", "poissons_ratio: 0.25", "poissons_ratio: 0.7", {"specimen.yaml:4:", "poissons_ratio", "0.7"}},
        {"not a number", "0.25", ".nan", {"specimen.yaml:4:", "poissons_ratio"}},
        {"unknown interface", "interface: bond", "interface: bnd", {"specimen.yaml:12:", "bnd", "did you mean 'bond'"}},
        {"empty geometry", "width: 20 cm", "width: 0", {"specimen.yaml:9:", "width"}},
        {"extends itself", "title: A small specimen", "extends: specimen.yaml", {"specimen.yaml", "extends"}},
    };
    for (const BadScene& scene : scenes) {
        std::string text = specimen;
        text.replace(text.find(scene.found), scene.found.size(), scene.instead);
        write("specimen.yaml", text);
        const Outcome outcome = kluft({"run", "specimen.yaml", "-o", "out"});
        EXPECT_EQ(outcome.exit_code, 2) << scene.what;
        for (const auto& part : scene.expected) EXPECT_THAT(outcome.errors, HasSubstr(part)) << scene.what;
        EXPECT_THAT(outcome.output, IsEmpty()) << scene.what;
        EXPECT_FALSE(exists("out")) << scene.what;
    }
}

TEST_F(CommandLine, BadOverrideNamesItself) {
    const Outcome outcome = run_specimen("out", {"--set", "stages.1.stps=3"});
    EXPECT_EQ(outcome.exit_code, 2);
    EXPECT_THAT(outcome.errors, HasSubstr("--set stages.1.stps=3"));
    EXPECT_THAT(outcome.errors, HasSubstr("did you mean 'steps'?"));
    EXPECT_FALSE(exists("out"));
}

TEST_F(CommandLine, CheckSaysWhatASceneAmountsTo) {
    const fs::path models = fs::path(KLUFT_SOURCE_DIR) / "models";
    const Outcome outcome = kluft({"check", (models / "triaxial/case-3-all.yaml").string()});
    EXPECT_EQ(outcome.exit_code, 0);
    for (const char* part : {"blocks", "interfaces", "potential crack", "fracture", "unknowns", "smallest     area",
                             "edge", "angle", "k_n d/E 0.1333", "E 1.519e+08 Pa, nu 0.1389", "memory"}) {
        EXPECT_THAT(outcome.output, HasSubstr(part));
    }
    EXPECT_THAT(outcome.output + outcome.errors, HasSubstr("plane strain; a cylinder"));
}

TEST_F(CommandLine, EveryModelIsAValidScene) {
    int n_models = 0;
    for (const auto& entry : fs::recursive_directory_iterator(fs::path(KLUFT_SOURCE_DIR) / "models")) {
        const std::string name = entry.path().filename();
        if (entry.path().extension() != ".yaml") continue;
        EXPECT_EQ(kluft({"check", entry.path().string()}).exit_code, 0) << name;
        ++n_models;
    }
    EXPECT_GE(n_models, 12);
}

TEST_F(CommandLine, RunWritesEveryResult) {
    const Outcome outcome = run_specimen("out");
    ASSERT_EQ(outcome.exit_code, 0) << outcome.errors;
    EXPECT_THAT(outcome.output, StartsWith("done: peak "));
    for (const char* name : {"history.csv", "equilibria.csv", "cracks.csv", "summary.json", "curve.png", "curve.svg",
                             "blocks.png", "blocks.svg", "fields.pvd", "state.h5", "run.log"}) {
        EXPECT_TRUE(exists(std::string("out/") + name)) << name;
        EXPECT_GT(fs::file_size(directory_ / (std::string("out/") + name)), 0u) << name;
    }
    const auto rows = table("out/history.csv");
    EXPECT_EQ(rows.at(0), columns);
    EXPECT_EQ(rows.size(), 1u + 1u + 22u); // head, initial state, load steps
    EXPECT_EQ(rows.back().at(0), "22");
    EXPECT_EQ(table("out/equilibria.csv").at(0), columns);
    EXPECT_EQ(table("out/cracks.csv").at(0),
              (std::vector<std::string>{"step", "pass", "interface", "x", "y", "mode", "p1", "p3", "axial_strain"}));
    const auto numbers = summary("out");
    EXPECT_EQ(numbers.at("status"), "done");
    for (const char* key :
         {"peak_stress", "peak_strain", "peak_reached", "residual_stress", "youngs_modulus", "poissons_ratio",
          "cracks_tension", "cracks_shear", "blocks", "interfaces", "unknowns", "steps", "unbalanced_steps",
          "open_close_iterations", "factorizations", "analyses", "elapsed_s", "peak_memory_bytes", "version"}) {
        EXPECT_TRUE(numbers.contains(key)) << key;
    }
    const std::string series = text_of(directory_ / "out/fields.pvd");
    const std::regex reference("file=\"([^\"]+)\"");
    int n_fields = 0;
    for (std::sregex_iterator it(series.begin(), series.end(), reference), end; it != end; ++it, ++n_fields) {
        EXPECT_TRUE(exists("out/" + (*it)[1].str())) << (*it)[1];
    }
    EXPECT_GT(n_fields, 1);
}

TEST_F(CommandLine, NoOutputHoldsANumberThatIsNone) {
    ASSERT_EQ(run_specimen("out").exit_code, 0);
    for (const auto& entry : fs::recursive_directory_iterator(directory_ / "out")) {
        const auto extension = entry.path().extension();
        if (extension != ".csv" && extension != ".json" && extension != ".vtu") continue;
        const std::string text = text_of(entry.path());
        EXPECT_FALSE(std::regex_search(text, std::regex("\\b(nan|inf)\\b", std::regex::icase))) << entry.path();
    }
}

TEST_F(CommandLine, OverrideTakesEffect) {
    ASSERT_EQ(run_specimen("out", {"--set", "stages.1.steps=3", "--set", "output.pictures=false"}).exit_code, 0);
    EXPECT_EQ(summary("out").at("steps"), 5);
    EXPECT_FALSE(exists("out/curve.png"));
}

TEST_F(CommandLine, QuietRunSaysNothing) {
    const Outcome outcome = run_specimen("out", {"--quiet", "--set", "stages.1.steps=2"});
    EXPECT_EQ(outcome.exit_code, 0);
    EXPECT_THAT(outcome.output, IsEmpty());
    EXPECT_THAT(outcome.errors, IsEmpty());
}

TEST_F(CommandLine, SameSceneGivesTheSameHistoryWithOneAndTwoThreads) {
    ASSERT_EQ(run_specimen("first").exit_code, 0);
    ASSERT_EQ(run_specimen("again").exit_code, 0);
    ASSERT_EQ(run_specimen("one", {"--threads", "1"}).exit_code, 0);
    ASSERT_EQ(run_specimen("two", {"--threads", "2"}).exit_code, 0);
    const auto history = history_but_times("first");
    EXPECT_EQ(history_but_times("again"), history);
    EXPECT_EQ(history_but_times("one"), history);
    EXPECT_EQ(history_but_times("two"), history);
}

TEST_F(CommandLine, InterruptedRunLeavesReadableFilesAndResumesToTheSameEnd) {
    const std::vector<std::string> many_steps{"--set", "stages.1.steps=60", "--set", "output.pictures=false"};
    ASSERT_EQ(run_specimen("whole", many_steps).exit_code, 0);

    std::vector<std::string> arguments{"run", "specimen.yaml", "-o", "cut"};
    arguments.insert(arguments.end(), many_steps.begin(), many_steps.end());
    ChildProcess child(directory_.path(), arguments);
    for (int i = 0; i < 10000 && table("cut/history.csv").size() < 10; ++i) {
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    child.interrupt();
    ASSERT_EQ(child.wait(), 130) << child.errors();
    EXPECT_EQ(summary("cut").at("status"), "interrupted");
    const auto part = history_but_times("cut");
    const auto whole = history_but_times("whole");
    ASSERT_LT(part.size(), whole.size());
    EXPECT_TRUE(std::equal(part.begin(), part.end(), whole.begin()));
    EXPECT_EQ(kluft({"draw", "cut"}).exit_code, 0);

    arguments.push_back("--resume");
    ASSERT_EQ(kluft(arguments).exit_code, 0);
    EXPECT_EQ(history_but_times("cut"), whole);
    EXPECT_EQ(table("cut/cracks.csv"), table("whole/cracks.csv"));
}

TEST_F(CommandLine, BodyThatNothingHoldsEndsWithADiagnosisAndItsLastState) {
    // Loose blocks without friction under a lateral pressure on one side only: they can only fly off.
    std::string text = specimen;
    text.replace(text.find("interface: bond"), 15, "interface: joint");
    text.replace(text.find("friction_angle: 20"), 18, "friction_angle: 0");
    text.replace(text.find("bottom: {support: pinned}"), 25, "bottom: {support: smooth}");
    text.replace(text.find("left: 0.2 MPa, right: 0.2 MPa"), 29, "left: 0.2 MPa, right: 0 MPa");
    write("loose.yaml", text);
    const Outcome outcome = kluft({"run", "loose.yaml", "-o", "out", "--set", "solver.max_unbalanced_steps=1"});
    EXPECT_EQ(outcome.exit_code, 3);
    EXPECT_TRUE(std::regex_search(outcome.errors, std::regex("no equilibrium in stage 0 at load step [12]: .* worst is "
                                                             "block [0-9]+ at \\(.*interfaces( [0-9]+)+")))
        << outcome.errors;
    EXPECT_EQ(summary("out").at("status"), "no_equilibrium");
    EXPECT_EQ(kluft({"draw", "out"}).exit_code, 0);
    EXPECT_EQ(table("out/history.csv").at(0), columns);
}

TEST_F(CommandLine, FullDiskEndsTheRunWithTheTablesSoFar) {
    const Outcome outcome = [&] {
        write("specimen.yaml", specimen);
        return kluft({"run", "specimen.yaml", "-o", "out", "--quiet"}, {.largest_file = 3000});
    }();
    EXPECT_EQ(outcome.exit_code, 4);
    EXPECT_THAT(outcome.errors, HasSubstr("File too large"));
    const auto rows = table("out/history.csv");
    ASSERT_GE(rows.size(), 2u);
    for (const auto& row : rows) EXPECT_EQ(row.size(), columns.size());
    for (const auto& entry : fs::recursive_directory_iterator(directory_ / "out")) {
        EXPECT_THAT(entry.path().filename().string(), Not(HasSubstr("tmp"))); // nothing half written
    }
}

TEST_F(CommandLine, LackOfMemoryEndsTheRunWithAMessage) {
#if defined(__SANITIZE_ADDRESS__)
    GTEST_SKIP() << "the address sanitizer reserves more addresses than any limit allows";
#else
    write("specimen.yaml", specimen);
    const Outcome outcome =
        kluft({"run", "specimen.yaml", "-o", "out", "--quiet", "--set", "geometry.tessellation.hexagons.spacing=0.003"},
              {.address_space = 220u << 20});
    EXPECT_EQ(outcome.exit_code, 4) << outcome.errors;
    EXPECT_THAT(outcome.errors, HasSubstr("memory"));
#endif
}

TEST_F(CommandLine, ResumeRefusesAnotherScene) {
    ASSERT_EQ(run_specimen("out", {"--set", "stages.1.steps=2"}).exit_code, 0);
    const Outcome outcome = run_specimen("out", {"--resume", "--set", "geometry.tessellation.hexagons.spacing=0.04"});
    EXPECT_EQ(outcome.exit_code, 2);
    EXPECT_THAT(outcome.errors, HasSubstr("state.h5"));
}

TEST_F(CommandLine, DrawMakesPicturesOfScenesAndRuns) {
    ASSERT_EQ(run_specimen("out", {"--set", "stages.1.steps=4", "--set", "output.pictures=false"}).exit_code, 0);
    EXPECT_EQ(kluft({"draw", "specimen.yaml", "-o", "scene.svg"}).exit_code, 0);
    EXPECT_TRUE(exists("scene.svg"));
    EXPECT_EQ(kluft({"draw", "out"}).exit_code, 0);
    EXPECT_TRUE(exists("out/curve.png"));
    EXPECT_TRUE(exists("out/blocks.svg"));
    const Outcome missing = kluft({"draw", "nowhere"});
    EXPECT_EQ(missing.exit_code, 2);
    EXPECT_THAT(missing.errors, HasSubstr("nowhere"));
    const Outcome format = kluft({"draw", "out", "-o", "picture.gif"});
    EXPECT_EQ(format.exit_code, 2);
    EXPECT_THAT(format.errors, HasSubstr(".png"));
}

// sigma_1 = 2 c sqrt(N) + N sigma_3, N = (1 + sin phi)/(1 - sin phi), through two points.
TEST_F(CommandLine, EnvelopeIsTheLineThroughThePeaks) {
    std::vector<double> peaks;
    for (const char* pressure : {"0.1", "0.4"}) {
        const std::string sides =
            fmt::format("stages.0.pressure={{left: {0} MPa, right: {0} MPa, top: {0} MPa}}", pressure);
        ASSERT_EQ(run_specimen(pressure, {"--set", sides, "--set", "stages.1.strain.value=2.5 %", "--set",
                                          "output.pictures=false"})
                      .exit_code,
                  0);
        peaks.push_back(summary(pressure).at("peak_stress"));
    }
    const Outcome outcome = kluft({"envelope", "0.1", "0.4", "-o", "fit.png"});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.errors;
    EXPECT_TRUE(exists("fit.png"));
    const double slope = (peaks[1] - peaks[0]) / 0.3e6;
    const double cohesion = (peaks[0] - slope * 0.1e6) / (2 * std::sqrt(slope)) / 1e6;
    const double angle = std::asin((slope - 1) / (slope + 1)) * 180 / M_PI;
    std::smatch found;
    ASSERT_TRUE(
        std::regex_search(outcome.output, found, std::regex("cohesion ([0-9.]+) MPa, friction angle ([0-9.]+) deg")))
        << outcome.output;
    EXPECT_NEAR(std::stod(found[1]), cohesion, 1e-3);
    EXPECT_NEAR(std::stod(found[2]), angle, 0.1);
    EXPECT_EQ(kluft({"envelope", "0.1", "nowhere"}).exit_code, 2);
}

} // namespace
} // namespace kluft
