// How a run ended.
#pragma once

namespace kluft {

enum class RunStatus {
    done,
    no_equilibrium,   ///< a step found none; the state is the last committed one
    collapsed,        ///< a stress-controlled stage went past what the body carries, or strengths were reduced to it
    out_of_resources, ///< of disk or memory
    interrupted       ///< asked to stop; the state is the last committed one
};

} // namespace kluft
