#include "kluft/assembly/blas.hpp"
#include "kluft/assembly/linear_solver.hpp"
#include "support/dense_matrix.hpp"
#include "support/dense_solution.hpp"
#include "support/hexagon_matrix.hpp"

#include <cstdlib>
#include <fstream>
#include <memory>
#include <new>
#include <random>

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

namespace kluft {
namespace {

/// A change with random rows between two neighbours; its stiffness is random, unsymmetric on request.
StiffnessChange random_change(long patch, std::pair<int, int> pair, bool symmetric, std::mt19937& generator) {
    std::normal_distribution<double> value;
    StiffnessChange change;
    change.patch = patch;
    std::tie(change.block_a, change.block_b) = pair;
    for (int i = 0; i < 24; ++i) {
        change.rows_a(i / 6, i % 6) = value(generator);
        change.rows_b(i / 6, i % 6) = value(generator);
    }
    for (int i = 0; i < 16; ++i) change.stiffness(i / 4, i % 4) = value(generator);
    if (symmetric) change.stiffness = (change.stiffness * change.stiffness.transpose()).eval();
    return change;
}

/// The changed matrix, entry by entry.
void add(const StiffnessChange& change, BlockMatrix& matrix) {
    const BlockPattern& pattern = *matrix.pattern;
    const auto& c = change.stiffness;
    matrix.values[pattern.find(change.block_a, change.block_a)] += change.rows_a.transpose() * c * change.rows_a;
    matrix.values[pattern.find(change.block_a, change.block_b)] += change.rows_a.transpose() * c * change.rows_b;
    matrix.values[pattern.find(change.block_b, change.block_a)] += change.rows_b.transpose() * c * change.rows_a;
    matrix.values[pattern.find(change.block_b, change.block_b)] += change.rows_b.transpose() * c * change.rows_b;
}

/// Address space that the process holds.
rlim_t held_bytes() {
    std::ifstream statistics("/proc/self/statm");
    rlim_t pages = 0;
    statistics >> pages;
    return pages * static_cast<rlim_t>(sysconf(_SC_PAGESIZE));
}

class LowRankUpdateOf : public ::testing::TestWithParam<int> {};

// The expected solution is that of the changed matrix by dense elimination.
TEST_P(LowRankUpdateOf, ChangesOnTopOfAFactorSolveTheChangedMatrix) {
    const auto pairs = hexagon_pairs(GetParam());
    const BlockPattern pattern(GetParam() * GetParam(), pairs);
    std::mt19937 generator(3);
    const BlockMatrix reference = hexagon_matrix(pattern, generator);
    LinearSolver solver;
    solver.analyze(pattern);
    ASSERT_TRUE(solver.factorize(reference, Factorization::cholesky));

    std::vector<StiffnessChange> changes;
    const std::size_t n_changes = 7;
    for (std::size_t i = 0; i < n_changes; ++i) {
        const auto pair = pairs[(i * 17) % pairs.size()];
        changes.push_back(random_change(static_cast<long>(100 + i), pair, i % 2 == 0, generator));
        BlockMatrix changed = reference;
        for (const auto& change : changes) add(change, changed);
        if (4 * static_cast<int>(i + 1) > solver.max_rank()) {
            EXPECT_FALSE(solver.update(changes));
            break;
        }
        ASSERT_TRUE(solver.update(changes)); // what was added before stays: the small matrix is bordered
        const Eigen::VectorXd b = Eigen::VectorXd::Random(6 * pattern.n_blocks());
        Eigen::VectorXd x;
        solver.solve(b, x);
        const Eigen::VectorXd expected = dense_solution(dense(changed), b);
        EXPECT_LT((x - expected).norm(), 1e-9 * expected.norm()) << i + 1 << " changes";
    }
    EXPECT_EQ(solver.statistics().factorizations, 1);
}
INSTANTIATE_TEST_SUITE_P(Sides, LowRankUpdateOf, ::testing::Values(2, 3, 8));

// The factor is in single precision, so are its solutions.
TEST(LowRankUpdate, ChangesOnTopOfAnUnsymmetricFactorSolveTheChangedMatrix) {
    const auto pairs = hexagon_pairs(9);
    const BlockPattern pattern(81, pairs);
    std::mt19937 generator(6);
    const BlockMatrix reference = unsymmetric_hexagon_matrix(pattern, generator);
    LinearSolver solver;
    solver.analyze(pattern);
    ASSERT_TRUE(solver.factorize(reference, Factorization::rounded_lu));
    std::vector<StiffnessChange> changes;
    for (std::size_t i = 0; i < 12; ++i) {
        const auto pair = pairs[(i * 17) % pairs.size()];
        changes.push_back(random_change(static_cast<long>(100 + i), pair, i % 2 == 0, generator));
        std::vector<StiffnessChange> some = changes;
        if (i > 6) some.erase(some.begin() + 1, some.begin() + 5); // what is taken back leaves its rows idle
        BlockMatrix changed = reference;
        for (const auto& change : some) add(change, changed);
        ASSERT_TRUE(solver.update(some));
        const Eigen::VectorXd b = Eigen::VectorXd::Random(6 * pattern.n_blocks());
        Eigen::VectorXd x;
        solver.solve(b, x);
        const Eigen::VectorXd expected = dense_solution(dense(changed), b);
        EXPECT_LT((x - expected).norm(), 1e-3 * expected.norm()) << i + 1 << " changes";
        const SolveReport report = solver.solve(changed, b, {.residual = 1e-10 * b.norm()}, 8, x);
        EXPECT_TRUE(report.accepted);
        EXPECT_LE(report.refinements, 4);
    }
    EXPECT_EQ(solver.statistics().factorizations, 1);
}

TEST(LowRankUpdate, AChangeTakenBackLeavesTheReference) {
    const auto pairs = hexagon_pairs(5);
    const BlockPattern pattern(25, pairs);
    std::mt19937 generator(4);
    const BlockMatrix reference = hexagon_matrix(pattern, generator);
    LinearSolver solver;
    solver.analyze(pattern);
    ASSERT_TRUE(solver.factorize(reference, Factorization::cholesky));
    ASSERT_TRUE(solver.update({random_change(1, pairs[3], false, generator)}));
    EXPECT_EQ(solver.rank(), 4);
    ASSERT_TRUE(solver.update({}));
    const Eigen::VectorXd b = Eigen::VectorXd::Random(150);
    Eigen::VectorXd x;
    solver.solve(b, x);
    const Eigen::VectorXd expected = dense_solution(dense(reference), b);
    EXPECT_LT((x - expected).norm(), 1e-11 * expected.norm());
}

TEST(LowRankUpdate, RowsWithoutStiffnessTakeNoRank) {
    const auto pairs = hexagon_pairs(4);
    const BlockPattern pattern(16, pairs);
    std::mt19937 generator(5);
    LinearSolver solver;
    solver.analyze(pattern);
    ASSERT_TRUE(solver.factorize(hexagon_matrix(pattern, generator), Factorization::cholesky));
    StiffnessChange change = random_change(1, pairs[0], true, generator);
    change.stiffness.setZero();
    change.stiffness(2, 2) = 1.0;
    ASSERT_TRUE(solver.update({change}));
    EXPECT_EQ(solver.rank(), 1);
}

// The limit leaves room for some of what the update takes, a little more each time. A room given back twice would end the
// process by a signal.
TEST(LowRankUpdateDeathTest, LackOfMemoryThrowsAndGivesNothingBackTwice) {
#ifdef KLUFT_SANITIZED
    GTEST_SKIP() << "the address sanitizer reserves more address space than any limit";
#endif
    constexpr int side = 40;
    const auto pairs = hexagon_pairs(side);
    const BlockPattern pattern(side * side, pairs);
    std::mt19937 generator(7);
    auto solver = std::make_unique<LinearSolver>();
    solver->analyze(pattern);
    ASSERT_TRUE(solver->factorize(hexagon_matrix(pattern, generator), Factorization::cholesky));
    std::vector<StiffnessChange> changes;
    for (int i = 0; i < 64; ++i) changes.push_back(random_change(i, pairs[(i * 67) % pairs.size()], true, generator));
    const Eigen::VectorXd b = Eigen::VectorXd::Random(6 * pattern.n_blocks());
    Eigen::VectorXd x;
    ASSERT_TRUE(solver->update({changes.begin(), changes.begin() + 16}));
    solver->solve(b, x);
    constexpr int lacking = 4, enough = 5;
    const auto update_within = [&](rlim_t more) {
        const rlimit limit{held_bytes() + more, held_bytes() + more};
        set_blas_threads(1); // a new process starts the others anew, with a stack each
        setrlimit(RLIMIT_AS, &limit);
        try {
            if (!solver->update(changes)) std::_Exit(1);
            solver->solve(b, x);
        } catch (const std::bad_alloc&) {
            solver.reset();
            std::_Exit(lacking);
        }
        std::_Exit(enough);
    };
    constexpr rlim_t step = 320U << 10U; // the first leaves enough for the stack
    EXPECT_EXIT(update_within(step), ::testing::ExitedWithCode(lacking), "");
    for (rlim_t more = 2 * step; more < 24 * step; more += step)
        EXPECT_EXIT(
            update_within(more), [](int status) { return WIFEXITED(status) && WEXITSTATUS(status) >= lacking; }, "");
    EXPECT_EXIT(update_within(1000 * step), ::testing::ExitedWithCode(enough), "");
}

// A body that the change lets go: the rows are those of the only spring to the ground, so to speak.
TEST(LowRankUpdate, AChangeThatMakesTheMatrixSingularIsRefused) {
    const auto pairs = hexagon_pairs(2);
    const BlockPattern pattern(4, pairs);
    std::mt19937 generator(6);
    BlockMatrix matrix;
    matrix.reset(pattern);
    for (int b = 0; b < 4; ++b) matrix.values[pattern.find(b, b)] = Mat6::Identity();
    StiffnessChange change;
    change.patch = 1;
    std::tie(change.block_a, change.block_b) = pairs[0];
    change.rows_a(0, 0) = 1.0;
    change.stiffness(0, 0) = -1.0;
    LinearSolver solver;
    solver.analyze(pattern);
    ASSERT_TRUE(solver.factorize(matrix, Factorization::cholesky));
    EXPECT_FALSE(solver.update({change}));
}

TEST(LinearSolver, RefinementMeetsTheMatrixOfTheMomentFromAnOldFactor) {
    const auto pairs = hexagon_pairs(8);
    const BlockPattern pattern(64, pairs);
    std::mt19937 generator(7);
    const BlockMatrix reference = hexagon_matrix(pattern, generator);
    BlockMatrix now = reference;
    std::normal_distribution<double> value(0.0, 1e-3);
    for (Mat6& block : now.values) {
        for (int i = 0; i < 36; ++i) block(i / 6, i % 6) += value(generator); // not symmetric any more
    }
    for (int i = 0; i < 5; ++i) add(random_change(i, pairs[11 * i], false, generator), now);
    LinearSolver solver;
    solver.analyze(pattern);
    ASSERT_TRUE(solver.factorize(reference, Factorization::cholesky));
    const Eigen::VectorXd b = Eigen::VectorXd::Random(384);
    Eigen::VectorXd x;
    const SolveReport report = solver.solve(now, b, {}, 60, x);
    EXPECT_TRUE(report.accepted);
    EXPECT_GT(report.refinements, 0);
    const Eigen::VectorXd expected = dense_solution(dense(now), b);
    EXPECT_LT((x - expected).norm(), 1e-8 * expected.norm());
    EXPECT_FALSE(solver.solve(now, b, {}, 2, x).accepted);
}

} // namespace
} // namespace kluft
