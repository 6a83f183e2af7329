// The size of load steps from the accuracy that is asked for (docs/theory.md, "Load steps from an accuracy").
#pragma once

#include <vector>

#include <Eigen/Core>

#include "kluft/loading/loaded_body.hpp"
#include "kluft/simulation/model.hpp"

namespace kluft {

/// What a load step says of its own error, relative to the scale of the history.
struct StepError {
    double path = 0.0;  ///< of its end: one step against two halves
    double chord = 0.0; ///< of the straight line from its start to its end, at the middle
};

/// Whether a step of `size` (load factor) with that error is good enough: the path's error at most `accuracy` times the
/// size, so that the sum over a stage stays below `accuracy`; the chord's, which does not add up, at most `accuracy`.
[[nodiscard]] bool is_accurate(double size, const StepError& error, double accuracy);

/// The size of the step after it, or of the same one taken again. Both errors grow with the square of the size.
[[nodiscard]] double next_step_size(double size, const StepError& error, double accuracy);

/// What a step of `size` takes of the load factor that is left: no splinter stays for the last one.
[[nodiscard]] double fitted_step_size(double size, double remaining);

/// Stresses (xx, yy, sqrt(2) xy) of the blocks times the roots of their shares in the body's area, size 3 n_blocks: the
/// norm is the root of the mean square (Pa).
[[nodiscard]] Eigen::VectorXd weighted_stresses(const LoadedBody& body, const Eigen::VectorXd& q);

/// How far the mapped fractures are from their first slip: the largest |shear traction| / limit, as if nothing slid,
/// over the closed contact points of each fracture at q; 0 for one that has none. Indexed by fracture, up to the last one with a point.
[[nodiscard]] std::vector<double> slip_indices(const Model& model, const LoadedBody& body, const Eigen::VectorXd& q);

} // namespace kluft
