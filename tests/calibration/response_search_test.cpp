// The strength stage on responses that cost nothing: noise of a known size, answers in closed form.
#include "kluft/calibration/response_search.hpp"

#include <cmath>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "kluft/calibration/judgement.hpp"

namespace kluft {
namespace {

constexpr int n_copies = 4;

/// Mohr-Coulomb's peaks under two pressures for x = (log c, log phi), each copy with a factor of its own.
Eigen::VectorXd peaks(const Eigen::VectorXd& x) {
    const double c = std::exp(x[0]);
    const double sine = std::sin(std::exp(x[1]));
    const double uniaxial = 2.0 * c * std::sqrt(1.0 - sine * sine) / (1.0 - sine);
    return Eigen::Vector2d(uniaxial, uniaxial + 5.0 * (1.0 + sine) / (1.0 - sine));
}

/// Targets at c = 8, phi = 0.7 with tolerances of 2 %.
struct Synthetic {
    double noise = 0.0;
    int evaluations = 0;
    bool stops = false;

    SearchProblem problem() {
        const Eigen::VectorXd wanted = peaks(Eigen::Vector2d(std::log(8.0), std::log(0.7)));
        SearchProblem problem;
        problem.lower = Eigen::Vector2d(std::log(1.0), std::log(0.2));
        problem.upper = Eigen::Vector2d(std::log(50.0), std::log(1.2));
        problem.starts = {Eigen::Vector2d(std::log(3.0), std::log(0.4))};
        problem.groups = {{0, 1, 1.0, 50.0}, {1, 1, 1.0, 50.0}};
        problem.n_noisy = 2;
        problem.expected = [](const Eigen::VectorXd&) { return Eigen::MatrixXd(Eigen::MatrixXd::Zero(2, 2)); };
        problem.evaluate = [this, wanted](const std::vector<Eigen::VectorXd>& places) {
            std::vector<Evaluation> found;
            for (const Eigen::VectorXd& x : places) {
                ++evaluations;
                Evaluation one;
                one.x = x;
                one.is_usable = true;
                std::mt19937 generator(static_cast<unsigned>(evaluations)); // another noise at each place
                std::normal_distribution<double> normal(1.0, noise);
                for (int i = 0; i < n_copies; ++i) {
                    const Eigen::Vector2d value = normal(generator) * peaks(x);
                    one.copies.push_back(((value - wanted).array() / (0.02 * wanted.array())).matrix());
                }
                found.push_back(one);
            }
            return stops ? std::nullopt : std::optional(found);
        };
        return problem;
    }
};

TEST(ResponseSearch, FindsTheParametersWithoutNoise) {
    Synthetic synthetic;
    const auto found = search_responses(synthetic.problem(), {});
    EXPECT_EQ(found.ending, SearchEnding::met);
    EXPECT_LE(worst_group({{0, 1, 1.0, 50.0}, {1, 1, 1.0, 50.0}}, found.rows), 1.0);
    EXPECT_LT(synthetic.evaluations, 20);
}

// Runs near the answer show no peak: what was tried in vain is not tried again.
TEST(ResponseSearch, TriesNoPlaceTwice) {
    Synthetic synthetic;
    SearchProblem problem = synthetic.problem();
    const auto evaluate = problem.evaluate;
    std::vector<Eigen::VectorXd> tried;
    problem.evaluate = [&](const std::vector<Eigen::VectorXd>& places) {
        auto found = evaluate(places);
        for (Evaluation& one : *found) {
            one.is_usable = one.x[1] < std::log(0.6); // the answer is at 0.7
            tried.push_back(one.x);
        }
        return found;
    };
    (void)search_responses(problem, {});
    for (std::size_t i = 0; i < tried.size(); ++i)
        for (std::size_t j = 0; j < i; ++j) EXPECT_GT((tried[i] - tried[j]).norm(), 1e-9) << i << " " << j;
}

// With 2 % of noise the mean of four copies scatters by 1 %, half the tolerance.
TEST(ResponseSearch, FindsTheParametersThroughNoise) {
    Synthetic synthetic{.noise = 0.02};
    const auto found = search_responses(synthetic.problem(), {});
    EXPECT_EQ(found.ending, SearchEnding::met);
    // Both peaks within 2 % and three standard errors of 1 %: the uniaxial one is nearly linear in c.
    const Eigen::VectorXd wanted = peaks(Eigen::Vector2d(std::log(8.0), std::log(0.7)));
    const Eigen::VectorXd truth = peaks(found.best.x);
    for (int i = 0; i < 2; ++i) EXPECT_NEAR(truth[i] / wanted[i], 1.0, 0.05);
}

// Exact derivatives from theory: no evaluation is spent on directions.
TEST(ResponseSearch, TakesTheoryAtItsWord) {
    Synthetic synthetic;
    SearchProblem problem = synthetic.problem();
    problem.expected = [](const Eigen::VectorXd& x) {
        const Eigen::VectorXd wanted = peaks(Eigen::Vector2d(std::log(8.0), std::log(0.7)));
        Eigen::MatrixXd slopes(2, 2);
        for (int i = 0; i < 2; ++i) {
            const Eigen::VectorXd step = 1e-5 * Eigen::VectorXd::Unit(2, i);
            slopes.col(i) = (peaks(x + step) - peaks(x - step)).cwiseQuotient(2e-5 * 0.02 * wanted);
        }
        return slopes;
    };
    Synthetic learning;
    const auto learnt = search_responses(learning.problem(), {});
    const auto found = search_responses(problem, {});
    EXPECT_EQ(found.ending, SearchEnding::met);
    EXPECT_LT(synthetic.evaluations, learning.evaluations);
    EXPECT_EQ(learnt.ending, SearchEnding::met);
}

TEST(ResponseSearch, EndsWhereTheUserStops) {
    Synthetic synthetic{.stops = true};
    EXPECT_EQ(search_responses(synthetic.problem(), {}).ending, SearchEnding::stopped);
}

TEST(ResponseSearch, EndsWithItsEvaluations) {
    Synthetic synthetic;
    const auto found = search_responses(synthetic.problem(), {.most_evaluations = 3});
    EXPECT_EQ(found.ending, SearchEnding::evaluations);
    EXPECT_EQ(synthetic.evaluations, 3);
}

TEST(LocalModel, HasTheSlopesOfALinearResponse) {
    std::vector<Evaluation> all;
    for (const auto& [a, b] : {std::pair(0.0, 0.0), std::pair(0.2, 0.0), std::pair(0.0, 0.2), std::pair(-0.1, 0.1)}) {
        Evaluation one;
        one.x = Eigen::Vector2d(a, b);
        one.copies = {Eigen::VectorXd::Constant(1, 3.0 + 2.0 * a - 5.0 * b)};
        one.is_usable = true;
        all.push_back(one);
    }
    const auto model =
        fit_local_model(all, Eigen::Vector2d::Zero(), Eigen::MatrixXd::Zero(1, 2), {{0, 1, 1.0, 50.0}}, {0, 1});
    const ResidualRows at = model.at(Eigen::Vector2d(0.1, 0.1));
    EXPECT_NEAR(at.values[0], 2.7, 1e-3);
    EXPECT_NEAR(at.jacobian(0, 0), 2.0, 1e-2);
    EXPECT_NEAR(at.jacobian(0, 1), -5.0, 1e-2);
}

// y = x against targets 0 and 1, each with a tolerance of 0.1: the compromise x = 1/2 misses both, by 5 tolerances.
TEST(Judgement, NamesTargetsThatOpposeEachOther) {
    const Eigen::MatrixXd jacobian = Eigen::MatrixXd::Constant(2, 1, 10.0);
    const Eigen::VectorXd rows = Eigen::Vector2d(5.0, -5.0);
    const std::vector<RowGroup> groups{{0, 1, 1.0, 50.0}, {1, 1, 1.0, 50.0}};
    const auto pairs = opposing_groups(jacobian, rows, groups, {0});
    ASSERT_EQ(pairs.size(), 1U);
    EXPECT_EQ(pairs[0], std::pair(std::size_t{0}, std::size_t{1}));
    EXPECT_TRUE(opposing_groups(jacobian, Eigen::Vector2d(0.5, -0.5), groups, {0}).empty()); // both met
    EXPECT_TRUE(opposing_groups(jacobian, Eigen::Vector2d(5.0, 5.0), groups, {0}).empty());
    EXPECT_TRUE(opposing_groups(jacobian, rows, groups, {1}).empty()); // nothing moves
}

// Two parameters, each told by one row with a slope of 10: copies at +-1 have a standard deviation of sqrt(2) rows, the mean
// one of 1, so that x is known to t(1) * 1/10 with t = 12.7062 (Student's, 95 %, one degree of freedom).
TEST(Judgement, CarriesTheScatterOfCopiesToTheParameters) {
    const Eigen::MatrixXd jacobian = 10.0 * Eigen::MatrixXd::Identity(2, 2);
    const std::vector<Eigen::VectorXd> copies{Eigen::Vector2d(1.0, 0.0), Eigen::Vector2d(-1.0, 0.0)};
    const auto widths = confidence_of(jacobian, copies, {{0, 1, 1.0, 50.0}, {1, 1, 1.0, 50.0}});
    ASSERT_EQ(widths.size(), 2U);
    EXPECT_NEAR(*widths[0], 1.27062, 1e-4);
    EXPECT_NEAR(*widths[1], 0.0, 1e-12);
    EXPECT_TRUE(confidence_of(jacobian, {copies[0]}, {}).empty());
}

TEST(Judgement, KnowsWhatTheRowsDoNotDetermine) {
    Eigen::MatrixXd jacobian(1, 3);
    jacobian << 1.0, 1.0, 0.0; // the sum of the first two
    EXPECT_EQ(determined(jacobian), (std::vector<char>{0, 0, 0}));
    Eigen::MatrixXd of_two(2, 3);
    of_two << 1.0, 0.0, 0.0, 0.0, 1.0, 0.0;
    EXPECT_EQ(determined(of_two), (std::vector<char>{1, 1, 0}));
}

// Rows that change with x0 + 2 x1 and with x2 + x0/4 stay along (-2, 1, 1/2): what x0 and x1 exchange, x2 follows a little.
TEST(Judgement, NamesTheParametersThatAreToldOnlyTogether) {
    Eigen::MatrixXd jacobian(2, 3);
    jacobian << 1.0, 2.0, 0.0, 0.25, 0.0, 1.0;
    EXPECT_EQ(told_together(jacobian), (std::vector<std::size_t>{0, 1, 2}));
    Eigen::MatrixXd without(2, 3);
    without << 1.0, 1.0, 0.0, 0.0, 0.0, 1.0;
    EXPECT_EQ(told_together(without).size(), 2U);
    EXPECT_TRUE(told_together(Eigen::MatrixXd::Identity(3, 3)).empty());
    Eigen::MatrixXd of_one(1, 3);
    of_one << 1.0, 1.0, 0.0; // two directions: whatever is named would be by chance
    EXPECT_TRUE(told_together(of_one).empty());
    Eigen::MatrixXd alone(2, 3);
    alone << 1.0, 0.0, 0.0, 0.0, 1.0, 0.0;
    EXPECT_TRUE(told_together(alone).empty());
}

} // namespace
} // namespace kluft
