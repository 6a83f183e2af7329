// What theory expects of a body of potential cracks without mapped fractures: Mohr-Coulomb's strength of the rock.
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "kluft/calibration/calibration.hpp"
#include "kluft/scene/scene.hpp"

namespace kluft {

/// The target's value by Mohr-Coulomb's law with a tension cut-off (docs/theory.md 23) from the strength of the scene's net:
/// the peak 2 c cos(phi)/(1 - sin(phi)) + sigma_3 (1 + sin(phi))/(1 - sin(phi)) under the scene's lateral pressure, c, phi,
/// and sigma_t, at most c cot(phi). SI, radians. Nothing of other targets, with mapped fractures, without a net of potential
/// cracks or where a platen pulls instead of pressing.
[[nodiscard]] std::optional<double> expected_value(const CalibrationTarget& target, const Scene& scene);

/// ResidualRows by theory and their derivatives by x, one row per target of `targets` (indices into those of the calibration);
/// zero rows of what theory knows nothing of.
struct ExpectedRows {
    Eigen::VectorXd values;   ///< differences from the targets over the tolerances
    Eigen::MatrixXd jacobian; ///< by central differences with a step of 1e-3
    std::vector<char> known;
};
[[nodiscard]] ExpectedRows expected_rows(const Calibration& calibration, const std::vector<std::size_t>& targets,
                                         const Eigen::VectorXd& x);

/// The place where theory meets the targets it knows, from `start`, within the bounds; only parameters with `may_move`
/// move. Nothing where it knows none.
[[nodiscard]] std::optional<Eigen::VectorXd> expected_start(const Calibration& calibration,
                                                            const std::vector<std::size_t>& targets,
                                                            const Eigen::VectorXd& start,
                                                            const std::vector<char>& may_move);

} // namespace kluft
