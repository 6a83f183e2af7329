// Bonds between blocks that are no cells of a net, which carry more than their own strength: mean stresses of large blocks say
// little of the bond between them.
#pragma once

#include <string>
#include <vector>

#include "kluft/constitutive/strength_envelope.hpp"
#include "kluft/simulation/model.hpp"
#include "kluft/simulation/simulation_options.hpp"
#include "kluft/simulation/state.hpp"
#include "kluft/simulation/step_record.hpp"

namespace kluft {

constexpr double clear_overload = 1.1; ///< of a bond's strength: an event is met to less

/// A traction over the largest one in its direction that a bond bears: shear over c - t_n tan(phi), tension over the tensile strength,
/// whichever is more. Pa, the normal one positive in tension. Zero where the strength is.
[[nodiscard]] double load_over_strength(double normal_traction, double shear_traction, const Strength& strength);

/// The interfaces with a bond in the body as cut between given blocks, or on a trace between blocks larger than the cells of a net.
[[nodiscard]] std::vector<int> bonds_of_large_blocks(const Model& model);

/// Follows a run in which bonds fail by the mean stress of their two blocks (CrackCriterion::principal_stress), and remembers
/// that bond of given blocks, or of a trace between blocks larger than the cells of a net, whose own traction was the most of its
/// strength. Costs nothing where there is none. `model` must outlive it.
class BondWatch {
public:
    BondWatch(const Model& model, CrackCriterion criterion);

    /// A committed load step.
    void step(const StepRecord& record, const State& state);

    /// What is to be said where the bond carried more than clear_overload; "" where it did not.
    [[nodiscard]] std::string warning() const;

private:
    struct Overload {
        int interface = -1;
        int step = 0;
        double load = 0.0;   ///< over the strength
        double normal = 0.0; ///< mean traction (Pa, positive in tension)
        double shear = 0.0;
    };

    const Model& model_;
    std::vector<int> interfaces_; ///< of large blocks, with a bond in the body as cut
    Overload worst_;
};

} // namespace kluft
