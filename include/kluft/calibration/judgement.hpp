// What a local model and the scatter of copies say of a calibration: how sure its parameters are, and which targets oppose
// each other.
#pragma once

#include <optional>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "kluft/calibration/response_search.hpp"

namespace kluft {

/// Half widths of the 95 % confidence intervals of x, from the scatter of copies of all rows: the step that the local model
/// takes for each copy's difference from the mean, t s/sqrt(n) of those steps. Nothing for what does not move, or of which the
/// rows say nothing; empty with fewer than two copies.
[[nodiscard]] std::vector<std::optional<double>> confidence_of(const Eigen::MatrixXd& jacobian,
                                                               const std::vector<Eigen::VectorXd>& copies,
                                                               const std::vector<RowGroup>& groups);

/// Per parameter, whether the rows determine it: no direction of x that hardly changes any row has much of it.
[[nodiscard]] std::vector<char> determined(const Eigen::MatrixXd& jacobian);

/// Parameters that the rows tell only together, those that have most of it first, where there is a single direction that hardly
/// changes any row and two or more have much of it; else none.
[[nodiscard]] std::vector<std::size_t> told_together(const Eigen::MatrixXd& jacobian);

/// Pairs of groups that oppose each other: of the two at least one is not met, and the parameters that bring the one nearer
/// take the other one away, the cosine of the angle between their gradients of weighted squares below -1/2. `at_bound`:
/// parameters that cannot move.
[[nodiscard]] std::vector<std::pair<std::size_t, std::size_t>> opposing_groups(const Eigen::MatrixXd& jacobian,
                                                                               const Eigen::VectorXd& rows,
                                                                               const std::vector<RowGroup>& groups,
                                                                               const std::vector<char>& at_bound);

} // namespace kluft
