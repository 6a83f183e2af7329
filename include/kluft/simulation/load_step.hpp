// One load step: contacts detected, an equilibrium searched and judged, potential cracks failed at their events until
// nothing fails any more (docs/theory.md, "One load step").
#pragma once

#include "kluft/simulation/step_in_progress.hpp"

namespace kluft {

/// Finds equilibrium at the goal's load factor, by way of every event before it. `from` stays as it is. Throws
/// Interrupted, and ResourceError out of memory.
[[nodiscard]] Step take_step(const StepBench& bench, const State& from, const StepGoal& goal);

/// The goal of a load step of the run's own settings.
[[nodiscard]] StepGoal goal_at(const StepBench& bench, double load_factor, bool checks_cracks);

/// To be called before each load step: a repeatable run solves it with a factor of its own.
void begin_load_step(const StepBench& bench);

/// Commits a load step of the stage, which may be its end (end_after).
[[nodiscard]] StageEnd commit_regular_step(const StepBench& bench, Step step, bool last_of_stage, State& state);

/// How a stage ends after its last committed load step: with a failure where too many in succession were unbalanced, and
/// where the axial stress has dropped by as much as the stage waits for.
[[nodiscard]] StageEnd end_after(const StepBench& bench, const State& state);

/// Whether potential cracks are checked in the load step after `state`.
[[nodiscard]] bool is_checked(const StepBench& bench, const State& state, bool last_of_stage);

} // namespace kluft
