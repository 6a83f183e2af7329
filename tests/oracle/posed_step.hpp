// One load step of a scene as a run poses it, and its solution by open-close iteration.
#pragma once

#include <string>

#include <Eigen/Core>

#include "kluft/equilibrium/equilibrium_problem.hpp"
#include "kluft/scene/scene.hpp"
#include "kluft/simulation/model.hpp"
#include "kluft/simulation/stage_loads.hpp"
#include "kluft/simulation/state.hpp"

namespace kluft::oracle {

/// Runs a scene to the end of load step `step` and poses that step again from the state before it. The step must not be
/// the first one of a later stage.
class PosedStep {
public:
    PosedStep(const Scene& scene, int step);
    PosedStep(const PosedStep&) = delete; // the problem points into the model, the placement and the loads
    PosedStep& operator=(const PosedStep&) = delete;
    PosedStep(PosedStep&&) = delete;
    PosedStep& operator=(PosedStep&&) = delete;
    ~PosedStep() = default;

    [[nodiscard]] const LoadedBody& body() const { return problem_.body; }
    /// The state that the step starts from (m).
    [[nodiscard]] const Eigen::VectorXd& start() const { return before_.body.displacement; }
    /// Where the run itself got to in this step (m).
    [[nodiscard]] const Eigen::VectorXd& end_of_run() const { return after_.body.displacement; }
    /// Every load step of the run was balanced.
    [[nodiscard]] bool run_is_balanced() const { return run_is_balanced_; }

    struct Solution {
        Eigen::VectorXd q; ///< m
        bool converged = false;
        double residual_ratio = 0.0; ///< |R|/F_ref
        double viscous_share = 0.0;  ///< of the mass-like term in F_ref
        int iterations = 0;
        int rounds = 0; ///< of the mass-like term
    };
    /// The equilibrium of the posed step, by open-close iteration from `guess` until the mass-like term is below `balance`.
    [[nodiscard]] Solution solve_by_open_close(double tolerance, double balance, const Eigen::VectorXd& guess);

private:
    void pose(const Scene& scene);

    Model model_;
    State before_;
    State after_;
    bool run_is_balanced_ = false;
    Placement placement_;
    LoadsAt at_;
    EquilibriumProblem problem_;
    BlockPattern pattern_;
};

} // namespace kluft::oracle
