#include "kluft/assembly/linear_solver.hpp"
#include "support/dense_matrix.hpp"
#include "support/dense_solution.hpp"

#include <limits>
#include <random>

#include <gtest/gtest.h>

namespace kluft {
namespace {

/// A random matrix on the pattern of a grid of blocks, diagonally dominant; symmetric on request.
BlockMatrix random_matrix(const BlockPattern& pattern, bool symmetric, std::mt19937& generator) {
    std::uniform_real_distribution<double> value(-1.0, 1.0);
    BlockMatrix matrix;
    matrix.reset(pattern);
    for (int row = 0; row < pattern.n_blocks(); ++row) {
        for (int entry = pattern.row_start(row); entry < pattern.row_start(row + 1); ++entry) {
            Mat6 block;
            for (int i = 0; i < 36; ++i) block(i / 6, i % 6) = value(generator);
            if (pattern.column(entry) == row) {
                block = (symmetric ? Mat6(block + block.transpose()) : block) + 60.0 * Mat6::Identity();
            }
            matrix.values[entry] = block;
        }
    }
    if (!symmetric) return matrix;
    for (int row = 0; row < pattern.n_blocks(); ++row) {
        for (int entry = pattern.row_start(row); entry < pattern.row_start(row + 1); ++entry) {
            const int column = pattern.column(entry);
            if (column > row) matrix.values[pattern.find(column, row)] = matrix.values[entry].transpose();
        }
    }
    return matrix;
}

BlockPattern grid_pattern(int side) {
    std::vector<std::pair<int, int>> pairs;
    for (int i = 0; i < side; ++i) {
        for (int j = 0; j < side; ++j) {
            if (i + 1 < side) pairs.emplace_back(i * side + j, (i + 1) * side + j);
            if (j + 1 < side) pairs.emplace_back(i * side + j, i * side + j + 1);
        }
    }
    return {side * side, pairs};
}

// Wherever it stands in the matrix, on its diagonal or beside it.
TEST(LinearSolver, RefusesAMatrixWithANumberThatIsNone) {
    std::mt19937 generator(11);
    const BlockPattern pattern = grid_pattern(4);
    const BlockMatrix whole = random_matrix(pattern, true, generator);
    LinearSolver solver;
    solver.analyze(pattern);
    for (const auto kind : {Factorization::cholesky, Factorization::rounded_cholesky, Factorization::lu}) {
        for (const auto& [a, b] : {std::pair{0, 0}, {15, 15}, {6, 6}, {0, 1}, {14, 15}, {5, 9}}) {
            BlockMatrix matrix = whole;
            matrix.values[pattern.find(a, b)](3, 2) = std::numeric_limits<double>::quiet_NaN();
            matrix.values[pattern.find(b, a)](2, 3) = std::numeric_limits<double>::quiet_NaN();
            EXPECT_FALSE(solver.factorize(matrix, kind)) << static_cast<int>(kind) << ": " << a << ", " << b;
        }
    }
    EXPECT_TRUE(solver.factorize(whole, Factorization::cholesky)); // nothing of it stays
}

// Dense Eigen is the independent twin. A factor that was there serves on.
TEST(LinearSolver, SolvesByItsDiagonalBlocksWhereTheseAreMuchOfTheMatrix) {
    std::mt19937 generator(7);
    const BlockPattern pattern = grid_pattern(4);
    const BlockMatrix matrix = random_matrix(pattern, false, generator);
    const BlockMatrix other = random_matrix(pattern, true, generator);
    const Eigen::VectorXd b = Eigen::VectorXd::Random(6 * pattern.n_blocks());
    LinearSolver solver;
    solver.analyze(pattern);
    ASSERT_TRUE(solver.factorize(other, Factorization::cholesky));
    Eigen::VectorXd x;
    const SolveReport report = solver.solve_by_blocks(matrix, b, {.residual = 1e-10 * b.norm()}, 60, x);
    EXPECT_TRUE(report.accepted);
    EXPECT_GT(report.refinements, 3);
    const Eigen::VectorXd expected = dense_solution(dense(matrix), b);
    EXPECT_LT((x - expected).norm(), 1e-9 * expected.norm());
    EXPECT_FALSE(solver.solve_by_blocks(matrix, b, {.residual = 1e-10 * b.norm()}, 2, x).accepted);
    solver.solve(b, x);
    EXPECT_LT((dense(other) * x - b).norm(), 1e-9 * b.norm());
}

// Dense Eigen is the independent twin of both sparse paths.
TEST(LinearSolver, SparseFactorsAgreeWithTheDenseTwin) {
    std::mt19937 generator(4);
    for (const int side : {1, 2, 4}) {
        const BlockPattern pattern = grid_pattern(side);
        LinearSolver solver;
        solver.analyze(pattern);
        for (const bool symmetric : {true, false}) {
            const BlockMatrix matrix = random_matrix(pattern, symmetric, generator);
            const Eigen::VectorXd b = Eigen::VectorXd::Random(6 * pattern.n_blocks());
            Eigen::VectorXd x;
            ASSERT_TRUE(solver.factorize(matrix, symmetric ? Factorization::cholesky : Factorization::lu));
            solver.solve(b, x);
            const Eigen::VectorXd expected = dense_solution(dense(matrix), b);
            EXPECT_LT((x - expected).norm(), 1e-12 * expected.norm());
        }
    }
}

TEST(LinearSolver, MatrixTimesVectorAgreesWithTheDenseTwin) {
    std::mt19937 generator(5);
    const BlockPattern pattern = grid_pattern(3);
    const BlockMatrix matrix = random_matrix(pattern, false, generator);
    const Eigen::VectorXd x = Eigen::VectorXd::Random(6 * pattern.n_blocks());
    Eigen::VectorXd y;
    matrix.multiply(x, y);
    EXPECT_LT((y - dense(matrix) * x).norm(), 1e-13 * y.norm());
}

TEST(LinearSolver, IndefiniteMatrixIsRefusedByCholesky) {
    std::mt19937 generator(6);
    const BlockPattern pattern = grid_pattern(2);
    BlockMatrix matrix = random_matrix(pattern, true, generator);
    matrix.values[pattern.find(3, 3)] *= -1.0;
    LinearSolver solver;
    solver.analyze(pattern);
    EXPECT_FALSE(solver.factorize(matrix, Factorization::cholesky));
    EXPECT_TRUE(solver.factorize(matrix, Factorization::lu));
}

TEST(LinearSolver, AnalysisIsDoneOncePerPattern) {
    std::mt19937 generator(7);
    const BlockPattern pattern = grid_pattern(3);
    LinearSolver solver;
    solver.analyze(pattern);
    for (int i = 0; i < 3; ++i) {
        EXPECT_TRUE(solver.factorize(random_matrix(pattern, true, generator), Factorization::cholesky));
    }
    EXPECT_EQ(solver.statistics().analyses, 1);
    EXPECT_EQ(solver.statistics().factorizations, 3);
}

} // namespace
} // namespace kluft
