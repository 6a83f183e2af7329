// Bending that a bond between two large blocks carries, and that no criterion of failure sees.
#pragma once

#include <string>
#include <vector>

#include "kluft/simulation/model.hpp"
#include "kluft/simulation/state.hpp"
#include "kluft/simulation/step_record.hpp"

namespace kluft {

/// Follows a run and remembers the bond of given blocks, or of a trace between blocks larger than the cells of a net, one of
/// whose ends was pulled by most of its tensile strength, more than twice that; of bonds without one the most pulled. Criteria
/// judge mean stresses or tractions (docs/theory.md, section 6), in a net those of the several bonds that a crack would have to
/// cut. Costs nothing where there is none. `model` must outlive it.
class BendingWatch {
public:
    explicit BendingWatch(const Model& model);

    /// A committed load step.
    void step(const StepRecord& record, const State& state);

    /// What is to be said of it; "" where there is none.
    [[nodiscard]] std::string warning() const;

private:
    struct Bending {
        int interface = -1;
        int step = 0;
        double tension = 0.0; ///< at the end (Pa)
        double load = 0.0;    ///< over the tensile strength; infinite without one
    };

    const Model& model_;
    std::vector<int> interfaces_; ///< of large blocks, with a bond in the body as cut
    Bending worst_;
};

} // namespace kluft
