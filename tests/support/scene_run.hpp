// Runs a scene given as text, for tests of whole runs.
#pragma once

#include <atomic>
#include <string>
#include <utility>
#include <vector>

#include "kluft/reference/explicit_simulation.hpp"
#include "kluft/scene/scene_model.hpp"
#include "kluft/scene/scene_reader.hpp"
#include "kluft/simulation/simulation.hpp"

namespace kluft {

struct SceneRun {
    Scene scene;
    Model model;
    State state;
    RunReport report;
    std::vector<StepRecord> history; ///< load steps, step 0 first
    std::vector<FieldRecord> fields; ///< of the load steps
    std::vector<StepRecord> equilibria;
    std::vector<CrackRecord> cracks;
    std::vector<JumpRecord> jumps;
};

/// Whether the run came to its end, balanced at each load step.
inline bool stands(const SceneRun& run) {
    return run.report.status == RunStatus::done && run.report.unbalanced_steps == 0;
}

class RecordingObserver : public StepObserver {
public:
    explicit RecordingObserver(SceneRun& run) : run_(run) {}
    void equilibrium(const StepRecord& record) override { run_.equilibria.push_back(record); }
    void crack(const CrackRecord& crack) override { run_.cracks.push_back(crack); }
    void jump(const JumpRecord& jump) override { run_.jumps.push_back(jump); }
    void step(const StepRecord& record, const State&, const std::function<FieldRecord()>& fields, bool) override {
        run_.history.push_back(record);
        run_.fields.push_back(fields());
    }

private:
    SceneRun& run_;
};

inline SceneRun run_scene(Scene scene) {
    SceneRun run;
    run.scene = std::move(scene);
    run.model = build_scene_model(run.scene).model;
    run.state = initial_state(run.model);
    RecordingObserver observer(run);
    const std::atomic<bool> stop{false};
    if (run.scene.integrator == Integrator::explicit_motion) {
        run.report = run_explicit(run.model, run.scene.cracks, run.scene.solver, run.scene.explicit_options, run.state,
                                  observer, stop);
        return run;
    }
    run.report = run_simulation(run.model, run.scene.cracks, run.scene.solver, run.state, observer, stop);
    return run;
}

inline SceneRun run_scene(const std::string& text, const std::vector<std::string>& overrides = {}) {
    return run_scene(read_scene_text(text, overrides));
}

} // namespace kluft
