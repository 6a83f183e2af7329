// When the open-close iteration ends.
#pragma once

#include <limits>
#include <vector>

#include "iterate.hpp"
#include "kluft/equilibrium/open_close_solver.hpp"

namespace kluft {

/// Blocks whose part of the forces is larger than a share of their own.
struct UnbalancedBlocks {
    std::vector<int> blocks;                                        ///< the worst first
    double least_allowed = std::numeric_limits<double>::infinity(); ///< part of the forces on any of them (N/m)
};

/// Judges when the iteration ends, from its norms and step lengths so far.
class StoppingTest {
public:
    StoppingTest(const OpenCloseOptions& options, const IterationGoal& goal, OpenCloseSummary& summary);

    /// True if the iterate q is an equilibrium; the summary says so then.
    [[nodiscard]] bool finds(const Equations& equations, const Eigen::VectorXd& q, const Iterate& at);
    /// True if the iterate q, which is none, is the last one all the same; the summary says why.
    [[nodiscard]] bool ends(const EquilibriumProblem& problem, const Eigen::VectorXd& q, const Iterate& at);
    /// Of the iterate that was judged last, where the body as a whole meets the tolerance.
    [[nodiscard]] const UnbalancedBlocks& unbalanced() const { return unbalanced_; }

    /// Of the forces of all blocks, over F_ref.
    [[nodiscard]] double tolerance() const { return tolerance_; }
    /// What a linear solve may leave where only single blocks are not balanced (N/m).
    [[nodiscard]] double largest_residual() const;
    /// Forces that need not be put right before the next linear solve (N/m).
    [[nodiscard]] double negligible_forces(const EquilibriumProblem& problem, const Eigen::VectorXd& q,
                                           const Iterate& at) const;
    /// True where root finding has had its chance and the norm does not fall.
    [[nodiscard]] bool stalls(const Iterate& at) const;
    /// Notes that blocks have been moved by local iterations.
    void note_elimination() { moved_ = true; }
    /// Notes the step of length s from an iterate.
    void note_step(const Iterate& from, double s);

private:
    bool ends_with(Termination termination);
    [[nodiscard]] bool is_equilibrium(const Iterate& at) const;
    [[nodiscard]] bool is_relaxed(const EquilibriumProblem& problem, const Eigen::VectorXd& q, const Iterate& at) const;

    OpenCloseSummary& summary_;
    double tolerance_;
    double block_tolerance_;
    double relaxed_share_; ///< of the mass-like forces
    int max_iterations_;
    bool relaxes_;
    double previous_norm_ = -1.0; ///< of the free forces one iteration ago (N/m)
    int short_steps_ = 0;         ///< in succession
    bool moved_ = false;          ///< from the guess
    UnbalancedBlocks unbalanced_;
};

inline constexpr double short_step = 0.1; ///< of the increment: this way leads nowhere

} // namespace kluft
