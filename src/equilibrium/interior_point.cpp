#include "interior_point.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "kluft/equilibrium/newton_increment.hpp"
#include "kluft/loading/platen.hpp"

namespace kluft {

namespace {

constexpr int most_systems = 40;
constexpr double short_of_zero = 0.99;  ///< of the way to where a force or a way would be zero
constexpr double worthwhile_step = 0.1; ///< of a prediction: of a shorter one the terms of second order mean nothing
constexpr double least_centring = 1e-3; ///< of the mean product
constexpr int most_corrections = 4;     ///< towards the centre, with one factor
constexpr double long_step = 0.95;      ///< that is not corrected any more
constexpr double step_growth = 1.2;     ///< that a correction aims at, and a little more
constexpr double step_addition = 0.1;
constexpr double least_gain = 0.01;   ///< of a correction, in the step
constexpr double centre_width = 10.0; ///< a product is far from the centre where it is so many times more or less

template <class Act> void for_each_pair(MotionConditions& conditions, Act act) {
    for (GapCondition& gap : conditions.gaps) act(gap.pair);
    for (FrictionCondition& friction : conditions.frictions) {
        act(friction.forth);
        act(friction.back);
    }
}

double product_of(const ComplementaryPair& pair, double step) {
    return (pair.force + step * pair.force_change) * (pair.way + step * pair.way_change);
}

double error_of(const GapCondition& gap, const Eigen::VectorXd& motion) {
    return gap.at_start + gap.widening.of(motion) + gap.compliance * gap.pair.force - gap.pair.way;
}

double error_of(const FrictionCondition& friction, const Eigen::VectorXd& motion) {
    return friction.slip.of(motion) - friction.forth.way + friction.back.way;
}

/// How a friction would change if the blocks stayed where they are.
double change_in_place(const FrictionCondition& friction) {
    const auto& [slip, force, forth, back, error, stiffness] = friction;
    return stiffness * (error - (forth.aim / forth.force - forth.way) + (back.aim / back.force - back.way));
}

/// All products are to come to `target`, to first order, or with what the last changes make of the products beyond it.
void aim_at(double target, bool second_order, MotionConditions& conditions) {
    for_each_pair(conditions, [&](ComplementaryPair& pair) {
        pair.aim = target - (second_order ? pair.force_change * pair.way_change : 0.0);
    });
}

/// Products that a step would take far from `target` are to come nearer to it (Gondzio 1996).
void aim_to_centre(double target, double step, MotionConditions& conditions) {
    for_each_pair(conditions, [&](ComplementaryPair& pair) {
        const double product = product_of(pair, step);
        const double nearest = std::clamp(product, target / centre_width, target * centre_width);
        pair.aim += std::max(nearest - product, -target * centre_width);
    });
}

/// The longest step, up to 1, that takes no force and no way beyond this share of its way to zero.
double step_length(double share, MotionConditions& conditions) {
    double step = 1.0;
    for_each_pair(conditions, [&](const ComplementaryPair& pair) {
        if (pair.force_change < 0.0) step = std::min(step, -share * pair.force / pair.force_change);
        if (pair.way_change < 0.0) step = std::min(step, -share * pair.way / pair.way_change);
    });
    return step;
}

void take_step(double step, MotionConditions& conditions) {
    for (FrictionCondition& friction : conditions.frictions) friction.force += step * friction.back.force_change;
    for_each_pair(conditions, [&](ComplementaryPair& pair) {
        pair.force += step * pair.force_change;
        pair.way += step * pair.way_change;
        pair.force_change = pair.way_change = 0.0;
    });
}

/// The equations (29g) at one q.
class LinearisedMotion {
public:
    LinearisedMotion(BareProblem& problem, MotionConditions& conditions) : problem_(problem), conditions_(conditions) {}

    /// Sets up the tangent at q, and what is left of the equations there.
    void linearise(const Eigen::VectorXd& q, BlockMatrix& tangent) {
        problem_.evaluator().reduced_residual(q, of_bare_);
        problem_.evaluator().tangent(q, TangentKind::symmetric, tangent);
        const Eigen::VectorXd motion = q - problem_.start();
        for (GapCondition& gap : conditions_.gaps) {
            gap.error = error_of(gap, motion);
            gap.stiffness = gap.pair.force / (gap.pair.way + gap.compliance * gap.pair.force);
            gap.widening.add_stiffness_to(tangent, gap.stiffness);
        }
        for (FrictionCondition& friction : conditions_.frictions) {
            const auto& [slip, force, forth, back, error, stiffness] = friction;
            friction.error = error_of(friction, motion);
            friction.stiffness = 1.0 / (forth.way / forth.force + back.way / back.force);
            friction.slip.add_stiffness_to(tangent, friction.stiffness);
        }
        problem_.constraints().correction(q, prescribed_);
        tangent.multiply(prescribed_, of_prescribed_);
        make_free(problem_.constraints(), tangent);
    }

    /// Finds the increment, and the changes for which all products come to where they are to.
    void find_changes(LinearSolver& linear_solver, Eigen::VectorXd& increment) {
        Eigen::VectorXd right_side = of_bare_.forces + of_prescribed_;
        for (GapCondition& gap : conditions_.gaps) {
            ComplementaryPair& pair = gap.pair;
            pair.force_change =
                (pair.aim - pair.force * (pair.way + gap.error)) / (pair.way + gap.compliance * pair.force);
            gap.widening.add_force_to(right_side, -(pair.force + pair.force_change));
        }
        for (const FrictionCondition& friction : conditions_.frictions)
            friction.slip.add_force_to(right_side, friction.force + change_in_place(friction));
        right_side *= -1.0;
        problem_.constraints().project(right_side);
        linear_solver.solve(right_side, increment);
        problem_.constraints().project(increment);
        increment += prescribed_;
        for (GapCondition& gap : conditions_.gaps) {
            const double widening = gap.widening.of(increment);
            gap.pair.force_change -= gap.stiffness * widening;
            gap.pair.way_change = widening + gap.compliance * gap.pair.force_change + gap.error;
        }
        for (FrictionCondition& friction : conditions_.frictions) {
            const double change = change_in_place(friction) + friction.stiffness * friction.slip.of(increment);
            friction.forth.force_change = -change;
            friction.back.force_change = change;
            for (ComplementaryPair* pair : {&friction.forth, &friction.back})
                pair->way_change = (pair->aim - pair->way * pair->force_change) / pair->force - pair->way;
        }
    }

private:
    BareProblem& problem_;
    MotionConditions& conditions_;
    Residual of_bare_;
    Eigen::VectorXd prescribed_, of_prescribed_;
};

} // namespace

double RelativeDisplacement::of(const Eigen::VectorXd& motion) const {
    double sum = row_a.dot(motion.segment<n_block_unknowns>(n_block_unknowns * block_a));
    if (block_b >= 0) sum += row_b.dot(motion.segment<n_block_unknowns>(n_block_unknowns * block_b));
    return sum;
}

void RelativeDisplacement::add_force_to(Eigen::VectorXd& forces, double size) const {
    forces.segment<n_block_unknowns>(n_block_unknowns * block_a) += size * row_a;
    if (block_b >= 0) forces.segment<n_block_unknowns>(n_block_unknowns * block_b) += size * row_b;
}

void RelativeDisplacement::add_stiffness_to(BlockMatrix& matrix, double stiffness) const {
    const BlockPattern& pattern = *matrix.pattern;
    matrix.values[pattern.diagonal(block_a)] += stiffness * row_a * row_a.transpose();
    if (block_b < 0) return;
    matrix.values[pattern.find(block_a, block_b)] += stiffness * row_a * row_b.transpose();
    matrix.values[pattern.find(block_b, block_a)] += stiffness * row_b * row_a.transpose();
    matrix.values[pattern.diagonal(block_b)] += stiffness * row_b * row_b.transpose();
}

double MotionConditions::largest_error(const Eigen::VectorXd& motion) const {
    double largest = 0.0;
    for (const GapCondition& gap : gaps) largest = std::max(largest, std::abs(error_of(gap, motion)));
    for (const FrictionCondition& friction : frictions)
        largest = std::max(largest, std::abs(error_of(friction, motion)));
    return largest;
}

double MotionConditions::mean_product(double step) const {
    double sum = 0.0;
    for (const GapCondition& gap : gaps) sum += product_of(gap.pair, step);
    for (const FrictionCondition& friction : frictions)
        sum += product_of(friction.forth, step) + product_of(friction.back, step);
    const std::size_t n = gaps.size() + 2 * frictions.size();
    return n > 0 ? sum / static_cast<double>(n) : 0.0;
}

BareProblem::BareProblem(const EquilibriumProblem& problem, const BlockPattern& pattern, double share_of_eta)
    : loads_(*problem.body.loads), problem_(problem), evaluator_(problem_, pattern) {
    placement_.bonds = problem.body.placement->bonds;
    problem_.body.placement = &placement_;
    problem_.body.loads = &loads_;
    for (double& eta : problem_.eta) eta *= share_of_eta;
    open_platens(problem_.body, problem.start, loads_);
}

double BareProblem::viscous_work(const Eigen::VectorXd& q) const {
    const BlockSystem& system = *problem_.body.system;
    double sum = 0.0;
    for (int b = 0; b < system.n_blocks(); ++b) {
        const Vec6 moved = (q - problem_.start).segment<n_block_unknowns>(n_block_unknowns * b);
        sum += problem_.eta[b] * moved.dot(mass_product(system.blocks[b], problem_.least_mass_area, moved));
    }
    return sum;
}

bool find_motion(LinearSolver& linear_solver, BareProblem& problem, MotionConditions& conditions, Eigen::VectorXd& q,
                 int& n_systems, const std::function<bool(const Eigen::VectorXd& q)>& ends) {
    LinearisedMotion linearised(problem, conditions);
    Eigen::VectorXd increment;
    BlockMatrix tangent;
    for (int i = 0; i < most_systems; ++i) {
        linearised.linearise(q, tangent);
        if (!linear_solver.factorize(std::move(tangent), Factorization::cholesky)) return false;
        tangent = BlockMatrix{};
        ++n_systems;
        aim_at(0.0, false, conditions);
        linearised.find_changes(linear_solver, increment);
        const double predicted = step_length(1.0, conditions);
        const double mean = conditions.mean_product();
        const double share = mean > 0.0 ? conditions.mean_product(predicted) / mean : 0.0;
        const double target = mean * std::clamp(share * share * share, least_centring, 1.0);
        aim_at(target, predicted > worthwhile_step, conditions);
        linearised.find_changes(linear_solver, increment);
        double step = step_length(short_of_zero, conditions);
        for (int k = 0; k < most_corrections && step < long_step; ++k) {
            MotionConditions corrected = conditions;
            aim_to_centre(target, std::min(1.0, step_growth * step + step_addition), corrected);
            std::swap(conditions, corrected);
            Eigen::VectorXd next;
            linearised.find_changes(linear_solver, next);
            const double length = step_length(short_of_zero, conditions);
            if (length < step + least_gain) {
                std::swap(conditions, corrected);
                break;
            }
            step = length;
            increment = std::move(next);
        }
        if (!increment.allFinite()) return false;
        take_step(step, conditions);
        q += step * increment;
        if (ends(q)) return true;
    }
    return false;
}

} // namespace kluft
