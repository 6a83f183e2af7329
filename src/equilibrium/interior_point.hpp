// An interior-point method for blocks whose gaps stay open and whose contacts rub up to given limits (docs/theory.md, (29g)).
#pragma once

#include <functional>
#include <vector>

#include <Eigen/Core>

#include "kluft/assembly/linear_solver.hpp"
#include "kluft/equilibrium/equilibrium_problem.hpp"

namespace kluft {

/// The relative displacement of two blocks, or of a block and a platen, at a point and in a direction.
struct RelativeDisplacement {
    int block_a = 0;
    int block_b = -1; ///< none: a platen
    Vec6 row_a = Vec6::Zero();
    Vec6 row_b = Vec6::Zero();

    [[nodiscard]] double of(const Eigen::VectorXd& motion) const;
    void add_force_to(Eigen::VectorXd& forces, double size) const;
    void add_stiffness_to(BlockMatrix& matrix, double stiffness) const;
};

/// A force and a way that stay positive while their product goes to zero, and how they change in an iteration.
struct ComplementaryPair {
    double force = 0.0; ///< N/m
    double way = 0.0;   ///< m
    double force_change = 0.0;
    double way_change = 0.0;
    double aim = 0.0; ///< what the product is to come to, less its terms of second order (N)
};

/// A condition gap >= 0 on a motion.
struct GapCondition {
    RelativeDisplacement widening;
    double at_start = 0.0;   ///< gap before the motion (m)
    double compliance = 0.0; ///< m2/N
    int spot = 0;            ///< index of the caller's
    ComplementaryPair pair;  ///< force: pressing; way: the gap and what the force has closed of it
    double error = 0.0;      ///< of the way, beside the gap at q (m)
    double stiffness = 0.0;  ///< of the linearised condition (N/m2)
};

/// Friction that resists a slip with no more than a limit.
struct FrictionCondition {
    RelativeDisplacement slip;
    double force = 0.0;            ///< N/m
    ComplementaryPair forth, back; ///< of the limit, what the force leaves of it, and the slip in that direction
    double error = 0.0;            ///< of the two slips, beside that at q (m)
    double stiffness = 0.0;
};

/// What is asked of a motion from a problem's start.
struct MotionConditions {
    std::vector<GapCondition> gaps;
    std::vector<FrictionCondition> frictions;

    /// The largest difference between a way and the motion from the start.
    [[nodiscard]] double largest_error(const Eigen::VectorXd& motion) const;
    /// After a step of this length along the changes (N).
    [[nodiscard]] double mean_product(double step = 0.0) const;
};

/// A problem without its contacts, with open platens, and with a share of its mass-like term.
class BareProblem {
public:
    BareProblem(const EquilibriumProblem& problem, const BlockPattern& pattern, double share_of_eta);
    ~BareProblem() = default;
    BareProblem(const BareProblem&) = delete; // its parts refer to each other
    BareProblem& operator=(const BareProblem&) = delete;

    [[nodiscard]] const Eigen::VectorXd& start() const { return problem_.start; }
    [[nodiscard]] const Constraints& constraints() const { return loads_.constraints; }
    [[nodiscard]] EquilibriumEvaluator& evaluator() { return evaluator_; }
    /// Of the mass-like forces at q along the way there (N).
    [[nodiscard]] double viscous_work(const Eigen::VectorXd& q) const;

private:
    Loads loads_;
    Placement placement_;
    EquilibriumProblem problem_;
    EquilibriumEvaluator evaluator_;
};

/// Moves q from the start of the problem until the motion `ends`, by prediction and correction. The pairs of the conditions, which must
/// be positive, begin with what they are given. False where it takes too many linear systems, which are counted.
[[nodiscard]] bool find_motion(LinearSolver& linear_solver, BareProblem& problem, MotionConditions& conditions,
                               Eigen::VectorXd& q, int& n_systems,
                               const std::function<bool(const Eigen::VectorXd& q)>& ends);

} // namespace kluft
