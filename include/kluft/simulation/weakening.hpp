// Which potential cracks fail together, and what becomes of them.
#pragma once

#include <vector>

#include "kluft/fracture/crack_check.hpp"
#include "kluft/loading/loaded_body.hpp"
#include "kluft/simulation/model.hpp"
#include "kluft/simulation/simulation_options.hpp"
#include "kluft/simulation/state.hpp"
#include "kluft/simulation/step.hpp"
#include "kluft/simulation/step_record.hpp"

namespace kluft {

/// The potential cracks of the state and how near to failure they are in a loaded body at displacements q, with strengths
/// divided by `strength_factor` (strength_reduction.hpp).
[[nodiscard]] std::vector<CrackCandidate> check_cracks(const Model& model, CrackCriterion criterion, const State& state,
                                                       double strength_factor, const LoadedBody& body,
                                                       const Eigen::VectorXd& q);

/// Those of the candidates that fail together, the worst first; none where no f reaches 1.
[[nodiscard]] std::vector<CrackCandidate> chosen_to_fail(const CrackOptions& options,
                                                         const std::vector<CrackCandidate>& candidates);

/// Makes a potential crack of the state a fracture; its shear traction stays. The contact memory of the state is no
/// longer sorted afterwards. The record lacks pass and axial strain.
[[nodiscard]] CrackRecord weaken(const Model& model, const CrackCandidate& candidate, State& state);

/// Makes potential cracks of the step's end fractures in one pass, at an axial strain, and records them.
void weaken_together(const Model& model, const std::vector<CrackCandidate>& broken, double axial_strain, Step& step);

} // namespace kluft
