// Platens that are moved away from a body which they do not hold.
#pragma once

#include <string>

#include "kluft/simulation/model.hpp"
#include "kluft/simulation/state.hpp"
#include "kluft/simulation/step_record.hpp"

namespace kluft {

/// Follows a run, and remembers the first load step at the end of which nothing touches a platen any more that its stage moves
/// outward and that is not glued. `model` must outlive it.
class PlatenWatch {
public:
    explicit PlatenWatch(const Model& model) : model_(model) {}

    /// A committed load step.
    void step(const StepRecord& record, const State& state);

    /// What is to be said of that platen; "" where there is none.
    [[nodiscard]] std::string warning() const;

private:
    const Model& model_;
    int stage_ = -1; ///< -1: no platen has left
    int step_ = 0;
};

} // namespace kluft
