// A load step as a value: the state that it leads to and all that is to be told of it. Not using it undoes it.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "kluft/loading/loaded_body.hpp"
#include "kluft/simulation/failure.hpp"
#include "kluft/simulation/stage_loads.hpp"
#include "kluft/simulation/state.hpp"
#include "kluft/simulation/step_record.hpp"

namespace kluft {

/// What the fields of a committed state are computed from.
struct LoadedPlacement {
    Placement placement;
    LoadsAt at;
};

struct Step {
    State end;                ///< at the last equilibrium, of a failed step the last balanced one; or the start
    StepRecord row;           ///< of that equilibrium, with the totals of the step
    bool smooth = true;       ///< nothing broke, was cut or relaxed
    bool balanced = true;     ///< all equilibria
    double worst_share = 0.0; ///< of the mass-like term, of all equilibria
    int crack_passes = 0;     ///< checks that made potential cracks fail
    double checked_index =
        0.0;              ///< the largest failure index, up to 10, when the step first checked them; 0 after a jump
    int worst_block = -1; ///< of the last solve
    std::vector<StepRecord> equilibria; ///< in order
    std::vector<CrackRecord> cracks;
    std::vector<JumpRecord> jumps;
    std::vector<MovingBlock> moving; ///< at the last equilibrium, where that is not balanced
    std::optional<Failure> failure;  ///< the step did not come to its goal
    std::string lost_contact;        ///< a warning, "" without reason
    LoadedPlacement in_place;        ///< at the last equilibrium

    /// What is left of a step that fails after an unbalanced equilibrium, or on the way to one: all up to its last
    /// balanced one.
    struct BalancedPart {
        BodyState body{};
        double load_factor = 0.0;
        LoadedPlacement in_place{};
        StepControl control{};
        StressHistory stresses{};
        std::size_t n_equilibria = 0;
        std::size_t n_cracks = 0;
        std::size_t n_jumps = 0;
    };
    std::optional<BalancedPart> balanced_part; ///< of a step under way
};

/// Takes back what was computed after the last balanced equilibrium of a step that failed; the potential cracks that were
/// chosen to fail at it stay. A step without such an equilibrium has no `equilibria` left.
void keep_balanced_part(Step& step);

} // namespace kluft
