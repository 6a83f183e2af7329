// A repeatable run that is stopped after any of its load steps, saved, read again and gone on with has the same bits as one
// that was not stopped.
#include <unistd.h>

#include <filesystem>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "kluft/output/state_file.hpp"
#include "support/scene_run.hpp"

namespace kluft {
namespace {

class StateCollector : public RecordingObserver {
public:
    StateCollector(SceneRun& run, std::vector<State>& states) : RecordingObserver(run), states_(states) {}
    void step(const StepRecord& record, const State& state, const std::function<FieldRecord()>& fields,
              bool last) override {
        RecordingObserver::step(record, state, fields, last);
        states_.push_back(state);
    }

private:
    std::vector<State>& states_;
};

SceneRun run_from(const Scene& scene, const Model& model, State from, std::vector<State>& states) {
    SceneRun run;
    run.state = std::move(from);
    StateCollector observer(run, states);
    const std::atomic<bool> stop{false};
    run.report = run_simulation(model, scene.cracks, scene.solver, run.state, observer, stop);
    return run;
}

State saved_and_read(const State& state) {
    const auto path = std::filesystem::temp_directory_path() / ("kluft-bits-" + std::to_string(getpid()) + ".h5");
    write_state(path, state, "bits");
    State read = read_state(path, "bits");
    std::filesystem::remove(path);
    return read;
}

struct RepeatableScene {
    const char* name;
    const char* geometry;
    const char* loads;
    const char* more;
};
void PrintTo(const RepeatableScene& scene, std::ostream* out) { *out << scene.name; }

class ResumedBits : public ::testing::TestWithParam<RepeatableScene> {};

TEST_P(ResumedBits, AreThoseOfTheRunThatWasNotStopped) {
    const auto& [name, geometry, loads, more] = GetParam();
    const Scene scene = read_scene_text(std::string(R"(
kluft: 1
materials: {rock: {density: 2300, youngs_modulus: 1500 MPa, poissons_ratio: 0.25, cohesion: 0.05 MPa, friction_angle: 40,
                   tensile_strength: 0.05 MPa}}
interfaces:
  joint: {kind: fracture, normal_stiffness: 2 GPa/m, shear_stiffness: 1 GPa/m, friction_angle: 20, cohesion: 0.02 MPa}
  bond: {kind: potential_crack, normal_stiffness: 2 GPa/m, shear_stiffness: 1 GPa/m, fails_to: joint}
)") + geometry + "\n" + loads + "\n" + more +
                                        "\n");
    const Model model = build_scene_model(scene).model;
    std::vector<State> states;
    const SceneRun whole = run_from(scene, model, initial_state(model), states);
    ASSERT_GT(states.size(), 5U);
    for (const State& stopped : states) {
        if (stopped.at.step == 0) continue;
        std::vector<State> rest;
        const SceneRun resumed = run_from(scene, model, saved_and_read(stopped), rest);
        for (const State& state : rest) {
            const State& expected = states.at(state.at.step);
            ASSERT_EQ(state.body.displacement, expected.body.displacement)
                << "stopped after load step " << stopped.at.step << ", at " << state.at.step;
            ASSERT_EQ(state.body.bond_shear, expected.body.bond_shear);
        }
        EXPECT_EQ(resumed.state.body.displacement, whole.state.body.displacement);
        EXPECT_EQ(resumed.report.status, whole.report.status);
        EXPECT_EQ(resumed.report.warnings, whole.report.warnings) << "stopped after load step " << stopped.at.step;
    }
}

constexpr const char* fine_hexagons = "geometry: {domain: {rectangle: {width: 0.2, height: 0.4}}, tessellation: "
                                      "{hexagons: {spacing: 0.1}, interface: bond}}";
constexpr const char* triangles =
    "geometry: {domain: {rectangle: {width: 0.2, height: 0.4}}, tessellation: {triangles: "
    "{spacing: 0.08}, interface: bond}}";
constexpr const char* with_fracture = "geometry: {domain: {rectangle: {width: 0.2, height: 0.4}}, tessellation: "
                                      "{hexagons: {spacing: 0.1}, interface: bond}, "
                                      "fractures: [{trace: [[-1, 0.1], [1, 0.3]], interface: joint}]}";
constexpr const char* pressed = "boundaries: {bottom: {support: smooth}}\n"
                                "stages: [{pressure: {left: 0.1 MPa, right: 0.1 MPa, top: 0.1 MPa}, steps: 2}, "
                                "{strain: {boundary: top, value: 1 %}, "
                                "steps: 8}]";

constexpr const char* reduced = "boundaries: {bottom: {support: pinned}}\n"
                                "stages: [{pressure: {left: 0.1 MPa, right: 0.1 MPa, top: 0.15 MPa}, steps: 3}, "
                                "{strength_reduction: {from: 1, to: 1.2}, steps: 4}]";

/// Stages that begin with the force of the platen of the one before.
constexpr const char* unloaded_sides =
    "boundaries: {bottom: {support: smooth}}\n"
    "stages: [{pressure: {left: 0.1 MPa, right: 0.1 MPa, top: 0.1 MPa}, steps: 2}, "
    "{strain: {boundary: top, value: 0.3 %}, steps: 3}, {pressure: {left: 0.05 MPa, right: 0.05 MPa}, steps: 3}]";
constexpr const char* other_platens =
    "boundaries: {bottom: {support: smooth}, left: {support: smooth}}\n"
    "stages: [{pressure: {right: 0.1 MPa, top: 0.1 MPa}, steps: 2}, {stress: {boundary: top, value: 0.2 MPa}, steps: "
    "2}, "
    "{strain: {boundary: right, value: 0.1 %}, steps: 2}, {stress: {boundary: top, value: 0.25 MPa}, steps: 2}]";

INSTANTIATE_TEST_SUITE_P(
    All, ResumedBits,
    ::testing::Values(
        RepeatableScene{"Hexagons", fine_hexagons, pressed, "solver: {repeatable: true}"},
        RepeatableScene{"Triangles", triangles, pressed, "solver: {repeatable: true}"},
        RepeatableScene{"Fracture", with_fracture, pressed, "solver: {repeatable: true}"},
        RepeatableScene{"ContactsKept", with_fracture, pressed, "solver: {repeatable: true, detection_every: 4}"},
        RepeatableScene{"StrengthReduction", with_fracture, reduced, "solver: {repeatable: true}"},
        RepeatableScene{"PressureAfterAPlaten", with_fracture, unloaded_sides, "solver: {repeatable: true}"},
        RepeatableScene{"PlatenAfterAPlaten", triangles, other_platens, "solver: {repeatable: true}"},
        RepeatableScene{"AllThatFail", triangles, pressed, "cracks: {update: all}\nsolver: {repeatable: true}"},
        RepeatableScene{"LateChecks", triangles, pressed, "cracks: {every: 3}\nsolver: {repeatable: true}"}),
    [](const auto& scene) { return std::string(scene.param.name); });

} // namespace
} // namespace kluft
