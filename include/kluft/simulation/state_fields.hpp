// Fields of a state, for pictures and ParaView.
#pragma once

#include <functional>

#include "kluft/loading/loaded_body.hpp"
#include "kluft/simulation/model.hpp"
#include "kluft/simulation/state.hpp"
#include "kluft/simulation/step_record.hpp"

namespace kluft {

/// In the placement and under the loads of the body.
[[nodiscard]] FieldRecord field_record(const Model& model, const State& state, const LoadedBody& body);

/// Calls use(body) with the body of a committed state, in its placement and under its loads.
void with_body_of_state(const Model& model, const State& state, const std::function<void(const LoadedBody&)>& use);

/// Of a committed state alone.
[[nodiscard]] FieldRecord fields_of_state(const Model& model, const State& state);

} // namespace kluft
