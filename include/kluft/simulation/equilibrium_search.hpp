// The search for one equilibrium: open-close iteration, repeated until the mass-like term no longer changes the answer.
#pragma once

#include <optional>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "kluft/assembly/block_matrix.hpp"
#include "kluft/assembly/linear_solver.hpp"
#include "kluft/equilibrium/equilibrium_problem.hpp"
#include "kluft/equilibrium/open_close_solver.hpp"
#include "kluft/loading/block_balance.hpp"
#include "kluft/simulation/model.hpp"
#include "kluft/simulation/run_costs.hpp"
#include "kluft/simulation/simulation_options.hpp"
#include "kluft/simulation/stage_loads.hpp"

namespace kluft {

/// What a search should know of the body and of its loads.
struct Circumstances {
    bool unloaded = false;    ///< contacts carry no force yet (IterationGoal)
    bool given_loads = false; ///< and not the motion of a platen (IterationGoal)
};

/// What was found at one load level.
struct Equilibrium {
    Eigen::VectorXd displacement; ///< size 6 n_blocks (m)
    OpenCloseSummary summary;     ///< of the last solve
    double load_factor = 0.0;     ///< of the stage
    double strength_factor = 1.0; ///< F that strengths are divided by
    double viscous_share = 0.0;   ///< of the mass-like term in F_ref
    BlockBalance blocks;          ///< what is left over on them; empty where the iteration did not converge
    BlockVerdict verdict;         ///< on that
    int iterations = 0;           ///< linear solves of all solves
    int worst_block = -1;         ///< with the largest residual in the first solve
    bool balanced = false;
    std::optional<PlatenHold> hold; ///< of the platens, where some of their points have opened, closed or slid
    [[nodiscard]] bool converged() const { return summary.converged(); }
};

/// The linear solver, the open-close iteration and the pattern of the matrix, which holds every pair of blocks of the
/// problems to be solved. What is found does not depend on what was found before, to within the tolerance; to the bit if
/// the factor was forgotten.
class EquilibriumSearch {
public:
    EquilibriumSearch(const Model& model, const SolverOptions& options);

    /// Of |R|/F_ref, in the solves to come.
    void set_tolerance(double tolerance) { open_close_.set_tolerance(tolerance); }
    /// The next linear solve makes a new factor.
    void start_anew() { open_close_.start_anew(); }

    /// Makes sure that the pattern holds the pairs of all points. Where it does not, the matrix is ordered anew, for
    /// `near_pairs` besides the pairs at interfaces.
    void require_pairs(const std::vector<ContactPoint>& points, std::vector<std::pair<int, int>> near_pairs);
    /// The pairs that the matrix is ordered for: a resumed run starts from those of the saved state.
    [[nodiscard]] const std::vector<std::pair<int, int>>& near_pairs() const { return near_pairs_; }
    void order_for(std::vector<std::pair<int, int>> near_pairs);

    /// Solves from `guess`, and again from the result, until the mass-like term is small (docs/theory.md, balance) and the
    /// platens press on all that they hold and are penetrated by nothing (docs/theory.md, platens).
    [[nodiscard]] Equilibrium find(const EquilibriumProblem& problem, const Eigen::VectorXd& guess,
                                   const BlockGoal& balance, const Circumstances& circumstances);
    /// Solves again from a balanced state, until what is left over on the blocks is little of what the loads have put on them since
    /// the displacements `before`, where that is little beside what the body carries, and the body moves by little of what it has moved since
    /// (docs/theory.md, (27e) and (27f)). Of a body without platens.
    void follow_loads(EquilibriumProblem problem, const Eigen::VectorXd& before, const BlockGoal& balance,
                      Equilibrium& found);
    /// One step of a motion from the problem's start.
    [[nodiscard]] Equilibrium move_on(const EquilibriumProblem& problem, const Eigen::VectorXd& guess,
                                      const BlockGoal& balance, bool unloaded);

    /// Internal - external forces at q, that of the mass-like term included, without the supports' (N/m).
    [[nodiscard]] Eigen::VectorXd forces(const EquilibriumProblem& problem, const Eigen::VectorXd& q) const;

    /// Adds what the linear solver and the assembly have cost so far.
    void add_costs(RunCosts& costs) const;

private:
    template <class Solve>
    Equilibrium find_touching(const EquilibriumProblem& problem, Aim aim, const BlockGoal& balance, Solve solve);
    Equilibrium find_held(EquilibriumProblem problem, Eigen::VectorXd guess, const BlockGoal& balance,
                          const Circumstances& circumstances);
    Equilibrium find_by_held_friction(EquilibriumProblem problem, Eigen::VectorXd guess, const BlockGoal& balance);
    void iterate(const EquilibriumProblem& problem, const BlockGoal& balance, const Circumstances& circumstances,
                 Equilibrium& found);
    Equilibrium move_held(const EquilibriumProblem& problem, Eigen::VectorXd guess, const BlockGoal& balance,
                          bool unloaded);
    void settle(EquilibriumProblem& problem, const BlockGoal& balance, Equilibrium& found);
    bool catch_up(EquilibriumProblem& problem, const BlockGoal& balance, double tolerance_share, int patience,
                  Equilibrium& found);

    const Model& model_;
    double viscosity_;
    std::vector<std::pair<int, int>> near_pairs_;
    BlockPattern pattern_;
    LinearSolver linear_;
    OpenCloseSolver open_close_;
};

} // namespace kluft
