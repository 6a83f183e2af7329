// Whether what presses the contacts can come from the loads.
#pragma once

#include <string>

#include "kluft/core/vector.hpp"
#include "kluft/simulation/model.hpp"
#include "kluft/simulation/state.hpp"

namespace kluft {

/// The mean normal traction over what two blocks share (Pa, positive in compression), in the middle of it.
struct PressedContact {
    double value = 0.0; ///< 0: nothing is pressed
    int block_a = -1;
    int block_b = -1;
    Vec2 place = Vec2::Zero(); ///< in the moved body, scene coordinates (m)
};

/// The largest one of a committed state.
[[nodiscard]] PressedContact largest_contact_pressure(const Model& model, const State& state);

/// The largest stress that the loads apply in any stage up to that of the state (Pa): pressures, stresses of platens,
/// point forces over the smaller extent of the body, the weight of a column as high as the body.
[[nodiscard]] double largest_applied_stress(const Model& model, const State& state);

/// What is to be said of a contact that is pressed a hundred times more than the larger of what the loads apply and what
/// the platens were `measured` to apply (Pa), or have applied in an equilibrium within a load step: behind its peak a body may carry
/// nothing. "" where there is none.
[[nodiscard]] std::string contact_pressure_warning(const Model& model, const State& state, double measured);

} // namespace kluft
