#include "kluft/calibration/judgement.hpp"

#include <algorithm>
#include <cmath>
#include <functional>

#include "kluft/core/dense_decompositions.hpp"
#include "kluft/studies/ensemble.hpp"

namespace kluft {

namespace {

constexpr double confidence_level = 0.95;
constexpr double indifferent = 1e-3; // singular value over the largest, below which a direction is not determined
constexpr double much = 0.1;         // of a parameter in a unit direction
constexpr double opposition = -0.5;  // cosine
constexpr double no_gradient = 1e-9;

Eigen::VectorXd root_weights(const std::vector<RowGroup>& groups, Eigen::Index n_rows) {
    Eigen::VectorXd weights = Eigen::VectorXd::Ones(n_rows);
    for (const RowGroup& group : groups) weights.segment(group.first, group.n).setConstant(std::sqrt(group.weight));
    return weights;
}

/// Unit vectors of parameters along which hardly any row changes.
std::vector<Eigen::VectorXd> indifferent_directions(const Eigen::MatrixXd& jacobian) {
    const Eigen::Index n = jacobian.cols();
    std::vector<Eigen::VectorXd> directions;
    if (n == 0) return directions;
    Eigen::MatrixXd square = Eigen::MatrixXd::Zero(std::max(n, jacobian.rows()), n);
    square.topRows(jacobian.rows()) = jacobian;
    const SingularValues singular = singular_values(square);
    for (Eigen::Index i = 0; i < n; ++i)
        if (singular.values[i] <= indifferent * singular.values[0]) directions.emplace_back(singular.v.col(i));
    return directions;
}

} // namespace

std::vector<char> determined(const Eigen::MatrixXd& jacobian) {
    const Eigen::Index n = jacobian.cols();
    std::vector<char> result(static_cast<std::size_t>(n), 1);
    for (const Eigen::VectorXd& direction : indifferent_directions(jacobian))
        for (Eigen::Index p = 0; p < n; ++p)
            if (std::abs(direction[p]) > much) result[static_cast<std::size_t>(p)] = 0;
    return result;
}

std::vector<std::size_t> told_together(const Eigen::MatrixXd& jacobian) {
    const auto directions = indifferent_directions(jacobian);
    if (directions.size() != 1) return {};
    const Eigen::VectorXd parts = directions.front().cwiseAbs();
    std::vector<std::size_t> parameters;
    for (Eigen::Index p = 0; p < parts.size(); ++p)
        if (parts[p] > much) parameters.push_back(static_cast<std::size_t>(p));
    if (parameters.size() < 2) return {};
    std::ranges::stable_sort(parameters, std::ranges::greater(),
                             [&](std::size_t p) { return parts[static_cast<Eigen::Index>(p)]; });
    return parameters;
}

std::vector<std::optional<double>> confidence_of(const Eigen::MatrixXd& jacobian,
                                                 const std::vector<Eigen::VectorXd>& copies,
                                                 const std::vector<RowGroup>& groups) {
    if (copies.size() < 2) return {};
    const Eigen::VectorXd weights = root_weights(groups, jacobian.rows());
    const SingularValues singular = singular_values(weights.asDiagonal() * jacobian);
    const Eigen::MatrixXd inverse = pseudo_inverse(singular, singular.rank(indifferent));
    const auto n_copies = static_cast<int>(copies.size());
    Eigen::VectorXd mean = Eigen::VectorXd::Zero(jacobian.rows());
    for (const Eigen::VectorXd& each : copies) mean += each / n_copies;
    Eigen::VectorXd squares = Eigen::VectorXd::Zero(jacobian.cols());
    for (const Eigen::VectorXd& each : copies) {
        const Eigen::VectorXd step = inverse * weights.cwiseProduct(each - mean);
        squares += step.cwiseProduct(step);
    }
    const auto known = determined(jacobian);
    std::vector<std::optional<double>> half_widths;
    for (Eigen::Index p = 0; p < squares.size(); ++p) {
        const double deviation = std::sqrt(squares[p] / (n_copies - 1));
        half_widths.push_back(
            known[static_cast<std::size_t>(p)]
                ? std::optional(student_quantile(n_copies - 1, confidence_level) * deviation / std::sqrt(n_copies))
                : std::nullopt);
    }
    return half_widths;
}

std::vector<std::pair<std::size_t, std::size_t>> opposing_groups(const Eigen::MatrixXd& jacobian,
                                                                 const Eigen::VectorXd& rows,
                                                                 const std::vector<RowGroup>& groups,
                                                                 const std::vector<char>& at_bound) {
    std::vector<Eigen::VectorXd> gradients;
    std::vector<char> missed;
    for (const RowGroup& group : groups) {
        const Eigen::VectorXd own = rows.segment(group.first, group.n);
        Eigen::VectorXd gradient = group.weight * jacobian.middleRows(group.first, group.n).transpose() * own;
        for (Eigen::Index p = 0; p < gradient.size(); ++p)
            if (at_bound[static_cast<std::size_t>(p)]) gradient[p] = 0.0;
        gradients.push_back(std::move(gradient));
        missed.push_back(own.norm() > 1.0 ? 1 : 0);
    }
    std::vector<std::pair<std::size_t, std::size_t>> pairs;
    for (std::size_t i = 0; i < groups.size(); ++i) {
        for (std::size_t j = i + 1; j < groups.size(); ++j) {
            const double size = gradients[i].norm() * gradients[j].norm();
            if (!(missed[i] || missed[j]) || size < no_gradient) continue;
            if (gradients[i].dot(gradients[j]) < opposition * size) pairs.emplace_back(i, j);
        }
    }
    return pairs;
}

} // namespace kluft
