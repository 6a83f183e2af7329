// Which potential cracks fail together, and what becomes of them.
#pragma once

#include <vector>

#include "kluft/fracture/crack_check.hpp"
#include "kluft/simulation/model.hpp"
#include "kluft/simulation/simulation_options.hpp"
#include "kluft/simulation/state.hpp"
#include "kluft/simulation/step_record.hpp"

namespace kluft {

/// Those of the candidates that fail together, the worst first; none where no f reaches 1.
[[nodiscard]] std::vector<CrackCandidate> chosen_to_fail(const CrackOptions& options,
                                                         const std::vector<CrackCandidate>& candidates);

/// Makes a potential crack of the state a fracture; its shear traction stays. The contact memory of the state is no
/// longer sorted afterwards. The record lacks pass and axial strain.
[[nodiscard]] CrackRecord weaken(const Model& model, const CrackCandidate& candidate, State& state);

} // namespace kluft
