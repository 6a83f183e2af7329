// What a run tells the world: the one place where output hooks in.
#pragma once

#include <functional>
#include <optional>

#include "kluft/simulation/state.hpp"
#include "kluft/simulation/step_record.hpp"

namespace kluft {

/// Where a run stands inside a load step, for a progress line.
struct Progress {
    int stage = 0;
    int n_stages = 0;
    int step = 0;    ///< load steps accepted in all
    int n_steps = 0; ///< load steps of all stages; 0 where they follow from an accuracy
    double load_factor = 0.0;
    double axial_strain = 0.0;
    double axial_stress = 0.0;             ///< Pa
    std::optional<double> strength_factor; ///< F in runs that reduce strengths, where no platen moves
    int cracks = 0;
    int open_close_iterations = 0;       ///< so far in the run
    std::optional<double> share_of_step; ///< that is done of the load step in progress, where that grows with its time
};

class StepObserver {
public:
    virtual ~StepObserver() = default;

    /// Every equilibrium, also those just before an event and between crack passes.
    virtual void equilibrium(const StepRecord& /*record*/) {}
    virtual void crack(const CrackRecord& /*crack*/) {}
    virtual void jump(const JumpRecord& /*jump*/) {}
    /// A load step was committed (step 0: the initial state). `fields` computes the fields on demand, in the contacts and under
    /// the loads of its equilibrium; until the next load step is committed, model and state living on, later too.
    virtual void step(const StepRecord& /*record*/, const State& /*state*/,
                      const std::function<FieldRecord()>& /*fields*/, bool /*last_of_stage*/) {}
    /// Several times a step.
    virtual void progress(const Progress& /*progress*/) {}
};

} // namespace kluft
