#include "kluft/equilibrium/reused_factor.hpp"

#include <random>
#include <utility>

#include <gtest/gtest.h>

#include "kluft/equilibrium/boundary_terms.hpp"
#include "support/pressed_body.hpp"

namespace kluft {
namespace {

/// A bonded body between its platens with the factor of its symmetric tangent.
struct Factored {
    Factored() { linear.analyze(pattern); }
    [[nodiscard]] bool renew() {
        BlockMatrix tangent = symmetric_tangent_at_rest();
        return factor.renew(body.problem, q, std::move(tangent));
    }
    [[nodiscard]] BlockMatrix symmetric_tangent_at_rest() {
        BlockMatrix tangent;
        EquilibriumEvaluator(body.problem, pattern).tangent(q, TangentKind::symmetric, tangent);
        project(body.problem.loads.constraints, tangent, 1e10);
        return tangent;
    }

    PressedBody body{false, {1, 1}};
    Eigen::VectorXd q = at_rest(body.system);
    BlockPattern pattern = pattern_of(body.problem);
    LinearSolver linear;
    ReusedFactor factor{linear};
};

TEST(ReusedFactor, IsThereFromItsMakingUntilItIsForgotten) {
    Factored factored;
    EXPECT_FALSE(factored.factor.update(factored.body.problem, factored.q));
    ASSERT_TRUE(factored.renew());
    EXPECT_TRUE(factored.factor.update(factored.body.problem, factored.q));
    factored.factor.forget();
    EXPECT_FALSE(factored.factor.update(factored.body.problem, factored.q));
}

TEST(ReusedFactor, DoesNotOutliveTheAnalysisOfItsPattern) {
    Factored factored;
    ASSERT_TRUE(factored.renew());
    std::vector<std::pair<int, int>> all;
    for (int b = 1; b < factored.body.system.n_blocks(); ++b) all.emplace_back(0, b);
    const BlockPattern another(factored.body.system.n_blocks(), all);
    factored.linear.analyze(another);
    EXPECT_FALSE(factored.factor.update(factored.body.problem, factored.q));
}

// docs/theory.md: given up where the solutions since have taken 15 vectors more than as many of the first one's kind.
TEST(ReusedFactor, IsGivenUpWhereRefinementCostsMoreThanAFactorization) {
    Factored factored;
    ASSERT_TRUE(factored.renew());
    factored.factor.count(3);
    factored.factor.count(2);
    factored.factor.count(18);
    EXPECT_TRUE(factored.factor.update(factored.body.problem, factored.q));
    factored.factor.count(4);
    EXPECT_FALSE(factored.factor.update(factored.body.problem, factored.q));
    ASSERT_TRUE(factored.renew());
    EXPECT_TRUE(factored.factor.update(factored.body.problem, factored.q));
}

// docs/theory.md: more than three vectors of a first solution with the symmetric part.
TEST(ReusedFactor, FindsFrictionCostlyByTheFirstSolutionWithASymmetricFactor) {
    Factored factored;
    ASSERT_TRUE(factored.renew());
    factored.factor.count(3);
    factored.factor.count(9); // of later changes
    EXPECT_FALSE(factored.factor.friction_is_costly());
    ASSERT_TRUE(factored.renew());
    factored.factor.count(4);
    EXPECT_TRUE(factored.factor.friction_is_costly());
    factored.factor.forget();
    EXPECT_TRUE(factored.factor.friction_is_costly());
    factored.factor.forget_all();
    EXPECT_FALSE(factored.factor.friction_is_costly());
}

// Twice as many after each failure in succession, so that what fails always costs little and what has failed once is tried again.
TEST(ReusedFactor, IsLeftOutAfterFailures) {
    Factored factored;
    const auto left_out = [&] {
        int n = 0;
        while (factored.factor.is_left_out()) ++n;
        return n;
    };
    EXPECT_EQ(left_out(), 0);
    for (const int expected : {1, 2, 4, 8, 16, 16}) {
        factored.factor.note_failure();
        EXPECT_EQ(left_out(), expected);
    }
    factored.factor.count(3);
    factored.factor.note_failure();
    EXPECT_EQ(left_out(), 1);
    factored.factor.note_failure();
    factored.factor.forget_all();
    EXPECT_EQ(left_out(), 0);
}

TEST(ReusedFactor, SolutionWithTheExactFactorLeavesNoMoreThanIsAskedFor) {
    Factored factored;
    BlockMatrix tangent = factored.symmetric_tangent_at_rest();
    std::mt19937 generator(9);
    std::normal_distribution<double> value(0.0, 1e-3 * tangent.trace() / static_cast<double>(factored.q.size()));
    for (Mat6& entry : tangent.values)
        for (int i = 0; i < 36; ++i) entry(i / 6, i % 6) += value(generator);
    ASSERT_TRUE(factored.factor.renew_exact(factored.body.problem, factored.q, tangent));
    const Eigen::VectorXd b = Eigen::VectorXd::Ones(factored.q.size());
    Eigen::VectorXd x, product;
    const SolveReport report = factored.factor.solve(tangent, b, 1e-9 * b.norm(), x);
    EXPECT_TRUE(report.accepted);
    EXPECT_LE(report.refinements, 4); // single precision
    tangent.multiply(x, product);
    EXPECT_LT((product - b).norm(), 1e-9 * b.norm());
}

TEST(ReusedFactor, SolutionLeavesNoMoreThanIsAskedFor) {
    Factored factored;
    ASSERT_TRUE(factored.renew());
    const BlockMatrix tangent = factored.symmetric_tangent_at_rest();
    Eigen::VectorXd b = Eigen::VectorXd::Ones(factored.q.size()), x, product;
    const SolveReport report = factored.factor.solve(tangent, b, 1e-9 * b.norm(), x);
    EXPECT_TRUE(report.accepted);
    tangent.multiply(x, product);
    EXPECT_LT((product - b).norm(), 1e-9 * b.norm());
}

// Cholesky: only a positive definite stiffness holds the body.
TEST(ReusedFactor, IsNotMadeOfAnIndefiniteStiffness) {
    Factored factored;
    BlockMatrix tangent = factored.symmetric_tangent_at_rest();
    for (Mat6& value : tangent.values) value *= -1.0;
    EXPECT_FALSE(factored.factor.renew(factored.body.problem, factored.q, std::move(tangent)));
    EXPECT_FALSE(factored.factor.update(factored.body.problem, factored.q));
}

} // namespace
} // namespace kluft
