#include "kluft/assembly/multifrontal_factor.hpp"

#include "kluft/assembly/blas.hpp"
#include "kluft/assembly/block_columns.hpp"
#include "kluft/assembly/linear_solver.hpp"
#include "kluft/core/diagnostics.hpp"
#include "support/dense_matrix.hpp"
#include "support/hexagon_matrix.hpp"

#include <cmath>
#include <cstdlib>
#include <fstream>
#include <limits>
#include <random>

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

namespace kluft {
namespace {

constexpr double single_rounding = std::numeric_limits<float>::epsilon();

/// L, or the transposed U, as a full matrix, in elimination order.
Eigen::MatrixXd full_triangle(const MultifrontalFactor& factor, const float* values) {
    const BlockSupernodes& s = factor.supernodes();
    const int n = s.nu * s.first_block.back();
    Eigen::MatrixXd l = Eigen::MatrixXd::Zero(n, n);
    for (int k = 0; k < s.size(); ++k) {
        std::vector<int> rows;
        for (int b = s.first_block[k]; b < s.first_block[k + 1]; ++b) rows.push_back(b);
        for (const int b : s.rows_below(k)) rows.push_back(b);
        const int n_rows = s.nu * static_cast<int>(rows.size());
        for (int j = 0; j < s.n_columns(k); ++j) {
            for (int i = j; i < n_rows; ++i) {
                l(s.nu * rows[i / s.nu] + i % s.nu, s.nu * s.first_block[k] + j) =
                    values[s.value_starts[k] + static_cast<std::int64_t>(j) * n_rows + i];
            }
        }
    }
    return l;
}

Eigen::MatrixXd full_factor(const MultifrontalFactor& factor) { return full_triangle(factor, factor.values()); }

Eigen::MatrixXd in_elimination_order(const Eigen::MatrixXd& matrix, const std::vector<int>& position, int nu) {
    Eigen::MatrixXd ordered(matrix.rows(), matrix.cols());
    for (std::size_t a = 0; a < position.size(); ++a) {
        for (std::size_t b = 0; b < position.size(); ++b) {
            ordered.block(nu * position[a], nu * position[b], nu, nu) =
                matrix.block(nu * static_cast<int>(a), nu * static_cast<int>(b), nu, nu);
        }
    }
    return ordered;
}

/// |K - L L'| / |K| or |K - L U| / |K|.
double error_of_factor(const BlockPattern& pattern, const BlockMatrix& matrix,
                       Symmetry symmetry = Symmetry::symmetric) {
    const std::vector<int> position = elimination_order(pattern);
    MultifrontalFactor factor;
    factor.analyze(pattern, position);
    EXPECT_TRUE(factor.factorize(matrix, symmetry));
    const Eigen::MatrixXd l = full_factor(factor);
    const Eigen::MatrixXd transposed_u = full_triangle(factor, factor.upper_values());
    const Eigen::MatrixXd expected = in_elimination_order(dense(matrix), position, pattern.block_unknowns());
    return (l * transposed_u.transpose() - expected).norm() / expected.norm();
}

class MultifrontalFactorOf : public ::testing::TestWithParam<int> {};

TEST_P(MultifrontalFactorOf, HexagonsGivesTheMatrixToSinglePrecision) {
    const BlockPattern pattern(GetParam() * GetParam(), hexagon_pairs(GetParam()));
    std::mt19937 generator(3);
    EXPECT_LT(error_of_factor(pattern, hexagon_matrix(pattern, generator)), 10.0 * single_rounding);
}

// Blocks are joined at random, and some with none: the elimination tree has several roots and wide fronts.
TEST_P(MultifrontalFactorOf, RandomPairsGivesTheMatrixToSinglePrecision) {
    const int n = GetParam() * GetParam();
    std::mt19937 generator(GetParam());
    std::vector<std::pair<int, int>> pairs;
    for (int i = 0; i < n; ++i) {
        const int a = static_cast<int>(generator() % n);
        const int b = static_cast<int>(generator() % n);
        if (a != b) pairs.emplace_back(a, b);
    }
    const BlockPattern pattern(n, pairs);
    EXPECT_LT(error_of_factor(pattern, hexagon_matrix(pattern, generator)), 10.0 * single_rounding);
}

TEST_P(MultifrontalFactorOf, RigidBlocksGivesTheMatrixToSinglePrecision) {
    const auto pairs = hexagon_pairs(GetParam());
    const BlockPattern pattern(GetParam() * GetParam(), pairs, Kinematics::rigid);
    BlockMatrix matrix;
    matrix.reset(pattern);
    std::mt19937 generator(5);
    std::normal_distribution<double> value;
    for (int b = 0; b < pattern.n_blocks(); ++b) matrix.rigid_values[pattern.diagonal(b)] = 40.0 * Mat3::Identity();
    for (const auto& [a, b] : pairs) {
        Mat3 entry;
        for (int i = 0; i < 9; ++i) entry(i / 3, i % 3) = value(generator);
        matrix.rigid_values[pattern.find(a, b)] = entry;
        matrix.rigid_values[pattern.find(b, a)] = entry.transpose();
    }
    EXPECT_LT(error_of_factor(pattern, matrix), 10.0 * single_rounding);
}

TEST_P(MultifrontalFactorOf, UnsymmetricCouplingsGivesTheMatrixToSinglePrecision) {
    const BlockPattern pattern(GetParam() * GetParam(), hexagon_pairs(GetParam()));
    std::mt19937 generator(7);
    const BlockMatrix matrix = unsymmetric_hexagon_matrix(pattern, generator);
    EXPECT_LT(error_of_factor(pattern, matrix, Symmetry::unsymmetric), 30.0 * single_rounding);
    // A symmetric matrix has both factors, which differ by the diagonal alone.
    EXPECT_LT(error_of_factor(pattern, hexagon_matrix(pattern, generator), Symmetry::unsymmetric),
              10.0 * single_rounding);
}

TEST_P(MultifrontalFactorOf, UnsymmetricRigidBlocksGivesTheMatrixToSinglePrecision) {
    const BlockPattern pattern(GetParam() * GetParam(), hexagon_pairs(GetParam()), Kinematics::rigid);
    BlockMatrix matrix;
    matrix.reset(pattern);
    std::mt19937 generator(6);
    std::normal_distribution<double> value;
    for (Mat3& entry : matrix.rigid_values)
        for (int i = 0; i < 9; ++i) entry(i / 3, i % 3) = value(generator);
    for (int b = 0; b < pattern.n_blocks(); ++b) matrix.rigid_values[pattern.diagonal(b)] += 40.0 * Mat3::Identity();
    EXPECT_LT(error_of_factor(pattern, matrix, Symmetry::unsymmetric), 10.0 * single_rounding);
}

INSTANTIATE_TEST_SUITE_P(Sides, MultifrontalFactorOf, ::testing::Values(1, 2, 3, 7));
INSTANTIATE_TEST_SUITE_P(SlowSides, MultifrontalFactorOf, ::testing::Values(12));

TEST(MultifrontalFactor, HasTheOperationsAndNonzerosOfAFullMatrixWhereAllBlocksTouch) {
    constexpr int n = 9;
    std::vector<std::pair<int, int>> pairs;
    for (int a = 0; a < n; ++a) {
        for (int b = 0; b < a; ++b) pairs.emplace_back(a, b);
    }
    const BlockPattern pattern(n, pairs);
    const BlockSupernodes s = block_supernodes(pattern, elimination_order(pattern));
    constexpr double m = 6.0 * n;
    EXPECT_EQ(s.size(), 1);
    EXPECT_EQ(s.nonzeros, m * (m + 1.0) / 2.0);
    EXPECT_EQ(s.flops, m * (m + 1.0) * (2.0 * m + 1.0) / 6.0); // sum of squares
    EXPECT_EQ(s.value_starts.back(), static_cast<std::int64_t>(m * m));
}

// Wherever in the tree it stands.
TEST(MultifrontalFactor, RefusesAMatrixThatIsNotPositiveDefiniteOrHasANumberThatIsNone) {
    const BlockPattern pattern(144, hexagon_pairs(12));
    std::mt19937 generator(4);
    const BlockMatrix whole = hexagon_matrix(pattern, generator);
    MultifrontalFactor factor;
    factor.analyze(pattern, elimination_order(pattern));
    for (int b = 0; b < pattern.n_blocks(); b += 7) {
        for (const double value :
             {-1.0, 0.0, std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
            BlockMatrix matrix = whole;
            matrix.values[pattern.diagonal(b)](3, 3) = value;
            EXPECT_FALSE(factor.factorize(matrix, Symmetry::symmetric)) << b << ": " << value;
            EXPECT_EQ(factor.values(), nullptr);
            if (std::isfinite(value)) continue;
            EXPECT_FALSE(factor.factorize(matrix, Symmetry::unsymmetric)) << b << ": " << value;
        }
    }
    EXPECT_TRUE(factor.factorize(whole, Symmetry::symmetric)); // nothing of it stays
}

/// Rows of blocks, each joined to the next one by a spring per unknown. The first of a row is held in `n_weak` unknowns by a weak
/// spring and in the others by a strong one.
BlockMatrix weakly_held_rows(const BlockPattern& pattern, int n_weak) {
    BlockMatrix matrix;
    matrix.reset(pattern);
    for (int b = 0; b < pattern.n_blocks(); ++b) {
        Mat6& own = matrix.values[pattern.diagonal(b)];
        if (b == 0 || pattern.find(b - 1, b) < 0) {
            for (int i = 0; i < 6; ++i) own(i, i) += i < n_weak ? 1e-9 : 1.0;
        } else {
            own += Mat6::Identity();
            matrix.values[pattern.diagonal(b - 1)] += Mat6::Identity();
            matrix.values[pattern.find(b, b - 1)] = matrix.values[pattern.find(b - 1, b)] = -Mat6::Identity();
        }
    }
    return matrix;
}

// The weak springs are lost in the rounding of the strong ones: refinement brings them back. More directions than two
// bodies have to move in are refused.
TEST(MultifrontalFactor, RaisesFewPivotsThatRoundingLeavesNothingOf) {
    constexpr int n = 40;
    std::vector<std::pair<int, int>> pairs;
    for (int b = 0; b + 1 < n; ++b) pairs.emplace_back(b, b + 1);
    const BlockPattern row(n, pairs);
    MultifrontalFactor factor;
    factor.analyze(row, elimination_order(row));
    for (const int n_weak : {0, 1, 6}) {
        EXPECT_TRUE(factor.factorize(weakly_held_rows(row, n_weak), Symmetry::symmetric));
        EXPECT_GT(full_factor(factor).diagonal().minCoeff(), 1e-3);
    }
    for (int b = 0; b + 1 < n; ++b) pairs.emplace_back(n + b, n + b + 1);
    const BlockPattern two_rows(2 * n, pairs);
    factor.analyze(two_rows, elimination_order(two_rows));
    EXPECT_TRUE(factor.factorize(weakly_held_rows(two_rows, 3), Symmetry::symmetric));
    EXPECT_FALSE(factor.factorize(weakly_held_rows(two_rows, 6), Symmetry::symmetric));
}

// The fronts at the top are wide enough to be divided in all the ways that there are.
TEST(MultifrontalFactor, HasTheSameBitsForAnyNumberOfThreads) {
    constexpr int side = 90;
    const BlockPattern pattern(side * side, hexagon_pairs(side));
    std::mt19937 generator(8);
    const std::vector<int> position = elimination_order(pattern);
    const int before = blas_threads();
    for (const Symmetry symmetry : {Symmetry::symmetric, Symmetry::unsymmetric}) {
        const BlockMatrix matrix = symmetry == Symmetry::symmetric ? hexagon_matrix(pattern, generator)
                                                                   : unsymmetric_hexagon_matrix(pattern, generator);
        std::vector<float> expected;
        for (const int threads : {1, 2, 3, 8}) {
            set_blas_threads(threads);
            MultifrontalFactor factor;
            factor.analyze(pattern, position);
            ASSERT_TRUE(factor.factorize(matrix, symmetry));
            EXPECT_EQ(blas_threads(), threads);
            const auto n = factor.supernodes().value_starts.back();
            std::vector<float> values(factor.values(), factor.values() + n);
            values.insert(values.end(), factor.upper_values(), factor.upper_values() + n);
            if (expected.empty()) expected = values;
            EXPECT_EQ(values, expected) << threads << " threads";
        }
    }
    set_blas_threads(before);
}

// A run keeps the BLAS to the calling thread, and a factorization in it still has the threads that were asked for.
TEST(OwnThreads, LeaveTheNumberOfThreadsAskedFor) {
    const int before = blas_threads();
    set_blas_threads(3);
    {
        const OwnThreads of_run(1);
        EXPECT_EQ(blas_threads(), 3);
        set_blas_threads(2);
        EXPECT_EQ(blas_threads(), 2);
        const OwnThreads of_factorization(blas_threads());
        EXPECT_EQ(of_factorization.number(), 2);
    }
    EXPECT_EQ(blas_threads(), 2);
    set_blas_threads(before);
}

/// Of more than 20 000 unknowns.
class LargeBody : public ::testing::Test {
protected:
    static constexpr int side = 60;
    std::vector<std::pair<int, int>> pairs = hexagon_pairs(side);
    BlockPattern pattern{side * side, pairs};
    std::mt19937 generator{7};
    BlockMatrix matrix = hexagon_matrix(pattern, generator);
    Eigen::VectorXd b = Eigen::VectorXd::Random(6 * pattern.n_blocks());

    [[nodiscard]] Eigen::VectorXd solution_by_cholmod(const BlockMatrix& of) const {
        LinearSolver solver;
        solver.analyze(pattern);
        EXPECT_TRUE(solver.factorize(of, Factorization::cholesky));
        Eigen::VectorXd x;
        solver.solve(b, x);
        return x;
    }
};

TEST_F(LargeBody, IsSolvedAsByCholmodAndRefinedToDoublePrecision) {
    const Eigen::VectorXd expected = solution_by_cholmod(matrix);
    LinearSolver solver;
    solver.analyze(pattern);
    Eigen::VectorXd x;
    for (const bool given_away : {false, true, true}) { // in single precision, in double, and back
        BlockMatrix copy = matrix;
        ASSERT_TRUE(given_away ? solver.factorize(std::move(copy), Factorization::rounded_cholesky)
                               : solver.factorize(copy, Factorization::rounded_cholesky));
        solver.solve(b, x);
        const double error = (x - expected).norm() / expected.norm();
        EXPECT_LT(error, 1e3 * single_rounding);
        EXPECT_GT(error, 1e-12) << "is it rounded at all?";
        const SolveReport report = solver.solve(matrix, b, {}, 10, x);
        EXPECT_TRUE(report.accepted);
        EXPECT_LE(report.refinements, 3);
        EXPECT_LT((x - expected).norm(), 1e-9 * expected.norm());
        ASSERT_TRUE(solver.factorize(matrix, Factorization::cholesky));
        solver.solve(b, x);
        EXPECT_EQ(x, expected);
    }
}

TEST_F(LargeBody, TakesLowRankChangesOnTopOfItsFactor) {
    LinearSolver solver;
    solver.analyze(pattern);
    ASSERT_TRUE(solver.factorize(matrix, Factorization::rounded_cholesky));
    std::vector<StiffnessChange> changes;
    BlockMatrix changed = matrix;
    for (long i = 0; i < 40; ++i) {
        StiffnessChange change;
        change.patch = i;
        std::tie(change.block_a, change.block_b) = pairs[(static_cast<std::size_t>(i) * 211) % pairs.size()];
        change.rows_a = Eigen::Matrix<double, 4, 6>::Random();
        change.rows_b = Eigen::Matrix<double, 4, 6>::Random();
        change.stiffness = 100.0 * Eigen::Matrix4d::Identity();
        changes.push_back(change);
        for (const int row : {change.block_a, change.block_b}) {
            for (const int column : {change.block_a, change.block_b}) {
                const auto& left = row == change.block_a ? change.rows_a : change.rows_b;
                const auto& right = column == change.block_a ? change.rows_a : change.rows_b;
                changed.values[pattern.find(row, column)] += left.transpose() * change.stiffness * right;
            }
        }
    }
    ASSERT_TRUE(solver.update(changes));
    Eigen::VectorXd x;
    solver.solve(b, x);
    const Eigen::VectorXd expected = solution_by_cholmod(changed);
    EXPECT_LT((x - expected).norm(), 1e4 * single_rounding * expected.norm());
}

TEST_F(LargeBody, HasAFactorInDoublePrecisionWhereSingleIsNotEnough) {
    for (int i = 0; i < pattern.n_blocks(); i += 2) { // each two are almost one block
        for (const int k : {i, i + 1}) {
            matrix.values[pattern.diagonal(k)] += 1e8 * Mat6::Identity();
            matrix.values[pattern.find(k, 2 * i + 1 - k)] -= 1e8 * Mat6::Identity();
        }
    }
    LinearSolver solver;
    solver.analyze(pattern);
    ASSERT_TRUE(solver.factorize(BlockMatrix(matrix), Factorization::rounded_cholesky));
    Eigen::VectorXd x;
    solver.solve(b, x);
    const Eigen::VectorXd expected = solution_by_cholmod(matrix);
    EXPECT_LT((x - expected).norm(), 1e-7 * expected.norm());
}

TEST_F(LargeBody, IsRefusedWhereItIsIndefinite) {
    matrix.values[pattern.diagonal(pattern.n_blocks() / 3)] *= -1.0;
    LinearSolver solver;
    solver.analyze(pattern);
    EXPECT_FALSE(solver.factorize(matrix, Factorization::rounded_cholesky));
    EXPECT_TRUE(solver.factorize(matrix, Factorization::lu));
}

using LargeBodyDeathTest = LargeBody;

// The limit leaves room for some of what the factorization takes, a little more each time.
TEST_F(LargeBodyDeathTest, LackOfMemoryThrowsAndLeavesNoFactor) {
#ifdef KLUFT_SANITIZED
    GTEST_SKIP() << "the address sanitizer reserves more address space than any limit";
#endif
    prepare_blas();
    MultifrontalFactor factor;
    factor.analyze(pattern, elimination_order(pattern));
    constexpr int lacking = 4, enough = 5;
    const auto factorize_within = [&](rlim_t more) {
        std::ifstream statistics("/proc/self/statm");
        rlim_t pages = 0;
        statistics >> pages;
        const rlim_t bytes = pages * static_cast<rlim_t>(sysconf(_SC_PAGESIZE)) + more;
        const rlimit limit{bytes, bytes};
        set_blas_threads(1); // a new process starts the others anew, with a stack each
        set_blas_threads(2);
        setrlimit(RLIMIT_AS, &limit);
        try {
            if (!factor.factorize(matrix, Symmetry::symmetric)) std::_Exit(1);
        } catch (const ResourceError&) {
            std::_Exit(factor.values() == nullptr ? lacking : 2);
        }
        std::_Exit(enough);
    };
    constexpr rlim_t step = 2U << 20U;
    EXPECT_EXIT(factorize_within(step), ::testing::ExitedWithCode(lacking), "");
    for (rlim_t more = 2 * step; more < 24 * step; more += step) {
        EXPECT_EXIT(
            factorize_within(more), [](int status) { return WIFEXITED(status) && WEXITSTATUS(status) >= lacking; }, "");
    }
    EXPECT_EXIT(factorize_within(1000 * step), ::testing::ExitedWithCode(enough), "");
}

} // namespace
} // namespace kluft
