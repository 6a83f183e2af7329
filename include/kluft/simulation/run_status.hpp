// How a run ended.
#pragma once

namespace kluft {

enum class RunStatus {
    done,
    no_equilibrium, ///< a step found none; the state is the last committed one
    unbalanced,     ///< the last load step of a stage is not balanced: the run stops there
    collapsed,      ///< a stage that looks for a limit, by the stress on a platen or by reduced strengths, went past it
    out_of_resources, ///< of disk or memory
    interrupted       ///< asked to stop; the state is the last committed one
};

} // namespace kluft
