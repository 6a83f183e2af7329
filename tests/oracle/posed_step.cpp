#include "oracle/posed_step.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "kluft/equilibrium/open_close_solver.hpp"
#include "kluft/scene/scene_model.hpp"
#include "kluft/simulation/placement.hpp"
#include "kluft/simulation/simulation.hpp"
#include "kluft/simulation/stage_loads.hpp"

namespace kluft::oracle {

namespace {

constexpr int max_rounds = 60;

/// Keeps the states before and after one load step and stops the run there.
class StateKeeper : public StepObserver {
public:
    StateKeeper(int step, State& before, State& after, std::atomic<bool>& stop)
        : step_(step), before_(before), after_(after), stop_(stop) {}

    void step(const StepRecord& record, const State& state, const std::function<FieldRecord()>&, bool) override {
        balanced = balanced && record.balanced;
        if (record.step == step_ - 1) before_ = state;
        if (record.step != step_) return;
        after_ = state;
        reached = true;
        stop_ = true;
    }

    bool balanced = true;
    bool reached = false;

private:
    int step_;
    State& before_;
    State& after_;
    std::atomic<bool>& stop_;
};

} // namespace

PosedStep::PosedStep(const Scene& scene, int step) : model_(build_scene_model(scene).model) {
    std::atomic<bool> stop{false};
    StateKeeper keeper(step, before_, after_, stop);
    State state = initial_state(model_);
    const RunReport report = run_simulation(model_, scene.cracks, scene.solver, state, keeper, stop);
    if (!keeper.reached) throw std::runtime_error("the run did not reach the load step: " + report.diagnosis);
    if (before_.at.stage != after_.at.stage) throw std::invalid_argument("the load step is the first one of a stage");
    run_is_balanced_ = keeper.balanced;
    pose(scene);
}

void PosedStep::pose(const Scene& scene) {
    const StageLoads loads = enter_stage(model_, before_);
    placement_.bonds = placed_bonds(model_, before_.body);
    auto contacts = detected_contacts(model_, before_.body, true);
    placement_.contacts = std::move(contacts.points);
    at_ = loads_at(model_, loads, hold_of(model_, loads, after_.body), before_.at.stage, after_.at.load_factor);
    problem_.body = loaded_body(model_, placement_, at_);

    const double height = (model_.system.upper - model_.system.lower).maxCoeff();
    problem_.eta.assign(model_.system.blocks.size(),
                        scene.solver.viscosity * model_.effective_modulus / (height * height));
    problem_.least_mass_area = std::sqrt(0.75) * model_.system.spacing * model_.system.spacing;
    for (const Interface& interface : model_.system.interfaces)
        contacts.near_pairs.emplace_back(interface.block_a, interface.block_b);
    pattern_ = BlockPattern(model_.system.n_blocks(), contacts.near_pairs);
}

PosedStep::Solution PosedStep::solve_by_open_close(double tolerance, double balance, const Eigen::VectorXd& guess) {
    LinearSolver linear;
    linear.analyze(pattern_);
    OpenCloseOptions options;
    options.tolerance = tolerance;
    options.max_iterations = 100;
    OpenCloseSolver solver(linear, options);
    Solution solution;
    solution.q = guess;
    const bool unloaded = before_.body.contacts.empty();
    do {
        problem_.start = solution.q;
        const auto summary =
            solver.solve(problem_, pattern_, solution.q, {.unloaded = unloaded && solution.rounds == 0});
        ++solution.rounds;
        solution.iterations += summary.iterations;
        solution.residual_ratio = summary.residual_ratio;
        solution.viscous_share = viscous_force(problem_, solution.q).sum / std::max(summary.force_scale, 1e-300);
        solution.converged = summary.converged() && solution.viscous_share <= balance;
        if (!summary.converged()) break;
    } while (!solution.converged && solution.rounds < max_rounds);
    return solution;
}

} // namespace kluft::oracle
