#include "kluft/assembly/rounded_supernode.hpp"

#include "kluft/assembly/linear_solver.hpp"
#include "support/dense_matrix.hpp"
#include "support/dense_solution.hpp"
#include "support/hexagon_matrix.hpp"

#include <limits>
#include <random>
#include <vector>

#include <gtest/gtest.h>

namespace kluft {
namespace {

struct Shape {
    int n_columns;
    int n_rows;
};

/// Columns of a factor, their rounded copy with what may stand behind it, and the rounded numbers as doubles.
struct Columns {
    std::vector<float> rounded;
    Eigen::MatrixXd exact;

    explicit Columns(const Shape& shape) : exact(shape.n_rows, shape.n_columns) {
        std::mt19937 generator(8);
        std::uniform_real_distribution<double> value(-1.0, 1.0);
        std::vector<double> numbers(static_cast<std::size_t>(shape.n_rows * shape.n_columns));
        for (double& x : numbers) x = value(generator);
        for (int j = 0; j < shape.n_columns; ++j) numbers[j * (shape.n_rows + 1)] += 3.0;
        std::vector<double> memory = numbers;
        memory.resize(std::max<std::size_t>(memory.size(), rounded_padding), 0.0); // a factor has as many at least
        const float* const kept = round_in_place(memory.data(), memory.size());
        rounded.assign(kept, kept + numbers.size() + rounded_padding);
        for (std::size_t i = 0; i < numbers.size(); ++i) exact.data()[i] = rounded[i];
        EXPECT_LT((exact - Eigen::Map<Eigen::MatrixXd>(numbers.data(), shape.n_rows, shape.n_columns)).norm(), 1e-6);
    }
};

class RoundedSupernodeOf : public ::testing::TestWithParam<Shape> {};

// Expected values: Eigen's triangular solutions with the rounded numbers, in double precision.
TEST_P(RoundedSupernodeOf, SolvesLikeAFullMatrixOfTheRoundedNumbers) {
    const auto [n_columns, n_rows] = GetParam();
    const Columns l(GetParam());
    const auto top = l.exact.topRows(n_columns).triangularView<Eigen::Lower>();
    const auto below = l.exact.bottomRows(n_rows - n_columns);
    const Eigen::VectorXd b = Eigen::VectorXd::Random(n_rows);

    std::vector<double> x(b.begin(), b.end());
    x.resize(x.size() + rounded_padding, 7.0);
    eliminate_forward(n_columns, n_rows, l.rounded.data(), x.data());
    Eigen::VectorXd expected = b;
    expected.head(n_columns) = top.solve(b.head(n_columns));
    expected.tail(n_rows - n_columns) -= below * expected.head(n_columns);
    EXPECT_LT((Eigen::Map<Eigen::VectorXd>(x.data(), n_rows) - expected).norm(), 1e-13 * expected.norm());

    x.assign(b.begin(), b.end());
    x.resize(x.size() + rounded_padding, std::numeric_limits<double>::quiet_NaN());
    substitute_back(n_columns, n_rows, l.rounded.data(), x.data());
    expected = b;
    expected.head(n_columns) =
        top.transpose().solve(b.head(n_columns) - below.transpose() * b.tail(n_rows - n_columns));
    EXPECT_LT((Eigen::Map<Eigen::VectorXd>(x.data(), n_rows) - expected).norm(), 1e-13 * expected.norm());
}
INSTANTIATE_TEST_SUITE_P(Shapes, RoundedSupernodeOf,
                         ::testing::Values(Shape{1, 1}, Shape{1, 6}, Shape{2, 3}, Shape{3, 11}, Shape{4, 4},
                                           Shape{5, 9}, Shape{6, 18}, Shape{7, 7}, Shape{12, 37}, Shape{30, 101}));

/// Neighbours held together by `stiffness` in all directions, each block by one.
BlockMatrix chain(const BlockPattern& pattern, const std::vector<std::pair<int, int>>& pairs, double stiffness) {
    BlockMatrix matrix;
    matrix.reset(pattern);
    for (int b = 0; b < pattern.n_blocks(); ++b) matrix.values[pattern.find(b, b)] = Mat6::Identity();
    for (const auto& [a, b] : pairs) {
        for (const int i : {a, b}) {
            const int j = a + b - i;
            matrix.values[pattern.find(i, i)] += stiffness * Mat6::Identity();
            matrix.values[pattern.find(i, j)] -= stiffness * Mat6::Identity();
        }
    }
    return matrix;
}

double error_of_plain_solution(const BlockPattern& pattern, const BlockMatrix& matrix, Factorization kind) {
    LinearSolver solver;
    solver.analyze(pattern);
    EXPECT_TRUE(solver.factorize(matrix, kind));
    const Eigen::VectorXd b = Eigen::VectorXd::Random(6 * pattern.n_blocks());
    Eigen::VectorXd x;
    solver.solve(b, x);
    const Eigen::VectorXd expected = dense_solution(dense(matrix), b);
    return (x - expected).norm() / expected.norm();
}

TEST(RoundedCholesky, SolvesToSinglePrecisionAndKeepsAnIllConditionedFactorInDouble) {
    const auto pairs = hexagon_pairs(6);
    const BlockPattern pattern(36, pairs);
    const double rounding = std::numeric_limits<float>::epsilon();
    const double soft = error_of_plain_solution(pattern, chain(pattern, pairs, 1.0), Factorization::rounded_cholesky);
    EXPECT_LT(soft, 100.0 * rounding);
    EXPECT_GT(soft, 1e-12) << "is it rounded at all?";
    // Condition number about 1e8: rounded, nothing would be left.
    EXPECT_LT(error_of_plain_solution(pattern, chain(pattern, pairs, 1e7), Factorization::rounded_cholesky), 1e-7);
    EXPECT_LT(error_of_plain_solution(pattern, chain(pattern, pairs, 1.0), Factorization::cholesky), 1e-13);
}

TEST(RoundedCholesky, RefinementReachesDoublePrecision) {
    const auto pairs = hexagon_pairs(7);
    const BlockPattern pattern(49, pairs);
    std::mt19937 generator(9);
    const BlockMatrix matrix = hexagon_matrix(pattern, generator);
    LinearSolver solver;
    solver.analyze(pattern);
    ASSERT_TRUE(solver.factorize(matrix, Factorization::rounded_cholesky));
    const Eigen::VectorXd b = Eigen::VectorXd::Random(6 * pattern.n_blocks());
    Eigen::VectorXd x;
    const SolveReport report = solver.solve(matrix, b, {}, 10, x);
    EXPECT_TRUE(report.accepted);
    EXPECT_LE(report.refinements, 3); // each vector gains seven digits
    const Eigen::VectorXd expected = dense_solution(dense(matrix), b);
    EXPECT_LT((x - expected).norm(), 1e-9 * expected.norm());
}

} // namespace
} // namespace kluft
