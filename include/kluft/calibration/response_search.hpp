// Least squares of responses that are noisy and cost a run each: a trust region on local models in the logarithms of the
// parameters (docs/calibration.md).
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "kluft/calibration/least_squares.hpp"

namespace kluft {

/// The residuals at one place: differences from the targets over their tolerances.
struct Evaluation {
    Eigen::VectorXd x;
    std::vector<Eigen::VectorXd> copies; ///< noisy rows, one vector per copy of the body that gave all of them
    bool is_usable = false;              ///< enough copies did
    std::string note;                    ///< why copies are missing; empty otherwise

    /// Of the copies.
    [[nodiscard]] Eigen::VectorXd mean() const;
    /// Squared standard error of the mean, per row; zero of a single copy.
    [[nodiscard]] Eigen::VectorXd variance_of_mean() const;
};

/// The rows of one target: met where the norm of its rows is at most 1.
struct RowGroup {
    Eigen::Index first = 0;
    Eigen::Index n = 1;
    double weight = 1.0; ///< of the squares of its rows
    double unit = 1.0;   ///< change of a row that is as large as the target's value: 1/tolerance
};

/// Rows are the noisy ones first, then the exact ones. x: logarithms of the parameters.
struct SearchProblem {
    Eigen::VectorXd lower, upper; ///< equal where a parameter does not move
    std::vector<Eigen::VectorXd> starts;
    std::vector<RowGroup> groups;
    Eigen::Index n_noisy = 0;
    /// Runs all places at once; nothing when the user has stopped.
    std::function<std::optional<std::vector<Evaluation>>(const std::vector<Eigen::VectorXd>&)> evaluate;
    ResidualFunction exact; ///< the exact rows; may be empty
    /// Derivatives of the noisy rows that theory expects, before any are known; a row of zeros where it knows none.
    std::function<Eigen::MatrixXd(const Eigen::VectorXd&)> expected;
};

struct SearchOptions {
    int most_evaluations = 40;
    double radius = 0.5;        ///< of the first trust region, in logarithms
    double least_radius = 0.02; ///< ends below it
    double largest_radius = 1.2;
    std::function<void(const Evaluation&, double worst)>
        show; ///< after each evaluation, with the largest norm of a group
};

enum class SearchEnding {
    met,         ///< every group within its tolerance
    minimum,     ///< no step promises an improvement
    evaluations, ///< none left
    stopped,     ///< by the user
    failed       ///< nothing could be evaluated at the starts
};

struct SearchResult {
    SearchEnding ending = SearchEnding::failed;
    Evaluation best;
    Eigen::VectorXd rows;     ///< means and exact rows at the best place
    Eigen::MatrixXd jacobian; ///< of all rows there, as far as the local model knows it
    std::vector<Evaluation> all;
};

/// The largest norm of a group.
[[nodiscard]] double worst_group(const std::vector<RowGroup>& groups, const Eigen::VectorXd& rows);

[[nodiscard]] SearchResult search_responses(const SearchProblem& problem, const SearchOptions& options);

/// A local model of the noisy rows about a centre: a + G d + C (d o d) with d = x - centre.
struct LocalModel {
    Eigen::VectorXd centre;
    Eigen::VectorXd value;     ///< a
    Eigen::MatrixXd slope;     ///< G
    Eigen::MatrixXd curvature; ///< C

    [[nodiscard]] ResidualRows at(const Eigen::VectorXd& x) const;
};

/// The most likely model (Bayes with normal errors): slopes scatter about the `expected` ones by 1 unit per unit of x, by 2
/// where theory knows none; curvatures about zero by 1/2 unit; an evaluation at the distance |d| about the model by the
/// standard error of its mean, a tenth of a tolerance and |d|^2/4 units, which is what the model leaves out; by more where they show a
/// larger scatter.
[[nodiscard]] LocalModel fit_local_model(const std::vector<Evaluation>& all, const Eigen::VectorXd& centre,
                                         const Eigen::MatrixXd& expected, const std::vector<RowGroup>& groups,
                                         const std::vector<Eigen::Index>& moving);

} // namespace kluft
