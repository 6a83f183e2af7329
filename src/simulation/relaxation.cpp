#include "kluft/simulation/relaxation.hpp"

#include <algorithm>
#include <limits>
#include <utility>
#include <vector>

#include "kluft/simulation/mass_term.hpp"

namespace kluft {

namespace {

constexpr double relaxed_tolerance = 0.1; ///< of `balance`: a residual on the way that does not matter
constexpr double relaxed_residual = 2.0;  ///< of the mass-like forces: the same
constexpr int easy_relaxation = 4;        ///< iterations of a step after which the mass-like term falls
constexpr int max_relaxation_attempts = 250;
constexpr int max_moving_attempts = 25;           ///< of a relaxation that must come to rest, whose share does not fall
constexpr double least_relaxation_progress = 0.9; ///< of the share in as many attempts
constexpr double collapse_motion = 0.5;           ///< of a block in one load step (motion_scale)

/// Whether the largest share left over on a block falls, with patience.
class RelaxationProgress {
public:
    bool falls(double share) {
        if (share < least_relaxation_progress * least_) {
            least_ = share;
            attempts_ = 0;
        }
        return ++attempts_ <= max_moving_attempts;
    }

private:
    double least_ = std::numeric_limits<double>::infinity();
    int attempts_ = 0; ///< since then
};

/// A relaxation needs the mass-like term also where ordinary solves do without it.
double relaxation_viscosity(const SolverOptions& solver) {
    return solver.viscosity > 0.0 ? solver.viscosity : SolverOptions{}.viscosity;
}

/// Under a given stress or weight a body that lost its balance may fall for ever.
bool is_falling(const StepInProgress& p) {
    const BlockSystem& system = p.bench.model.system;
    if (!is_loaded_by_stress(p.bench.stage(p.from))) return false;
    const Eigen::VectorXd moved = p.displacement() - p.from.body.displacement;
    for (int b = 0; b < system.n_blocks(); ++b) {
        const double far = collapse_motion * motion_scale(system, system.blocks[b]);
        if (moved.segment<2>(n_block_unknowns * b).norm() > far) return true;
    }
    return false;
}

/// One step of pseudo-transient continuation from where the body stands, with the mass-like term times `factors`.
Equilibrium move_on(StepInProgress& p, PlacedState& placed, const LoadsAt& at, std::vector<double>& factors) {
    const auto& [model, cracks, solver, loads, search, journal, stop] = p.bench;
    if (stop) throw Interrupted{};
    placed = place(p);
    factors.resize(model.system.blocks.size(), 1.0);
    placed.eta = factors;
    for (double& eta : placed.eta) eta *= mass_coefficient(model, relaxation_viscosity(solver));
    Equilibrium moved =
        search.move_on(pose(model, placed, at, p.displacement()), p.goal.balance, p.step.end.body.contacts.empty());
    moved.load_factor = at.load_factor;
    moved.strength_factor = at.strength_factor;
    journal.report().costs.open_close_iterations += moved.iterations;
    p.step.worst_block = moved.worst_block;
    journal.progress(p.step.end, p.step.row, at.load_factor, journal.report().costs.open_close_iterations);
    return moved;
}

/// Whether a step of the relaxation counts though the iteration did not converge: its residual is small beside the
/// mass-like forces, or beside what is asked for. The residual then counts as left over.
bool is_harmless(Equilibrium& moved, const BlockGoal& balance) {
    if (moved.converged()) return true;
    const double residual = moved.summary.residual_ratio;
    if (residual > std::max(relaxed_tolerance * balance.share, relaxed_residual * moved.viscous_share)) return false;
    moved.viscous_share += residual;
    return true;
}

/// What becomes of one step of a relaxation.
enum class Outcome { stuck, moved, balanced, failed };

/// Judges a step that was taken, and moves the body along if it counts.
Outcome judge(StepInProgress& p, const PlacedState& placed, RelaxationProgress& progress, const Equilibrium& last,
              Equilibrium& moved) {
    if (!is_harmless(moved, p.goal.balance)) return Outcome::stuck;
    moved.verdict = judge_blocks(moved.blocks, last.blocks.left.empty() ? nullptr : &last.blocks, p.goal.balance);
    moved.balanced = moved.verdict.balanced() && moved.viscous_share <= p.goal.balance.share;
    if (moved.balanced) return Outcome::balanced;
    if (!move_body(p, placed, moved)) return Outcome::failed;
    const bool must_rest = p.goal.must_rest || is_loaded_by_stress(p.bench.stage(p.from));
    const bool moves_on = must_rest && !progress.falls(moved.verdict.error);
    if (!moves_on && !is_falling(p)) return Outcome::moved;
    fail(p, moved, moved.viscous_share, FailureKind::falling);
    return Outcome::failed;
}

/// What the relaxation came to in all its attempts, where none was balanced.
Equilibrium given_up(StepInProgress& p, Equilibrium last) {
    const bool never_moved = last.displacement.size() == 0;
    if (never_moved) last.worst_block = p.step.worst_block;
    const bool past_strength = is_platen_loaded_by_stress(p.bench.stage(p.from)); // the platen keeps moving
    if (never_moved || past_strength)
        fail(p, last, never_moved ? last.summary.residual_ratio : last.viscous_share, FailureKind::no_equilibrium);
    return last;
}

/// Blocks on their way that do not hinder the iteration go on faster: they come to rest or fall in fewer steps.
void hurry(const Equilibrium& moved, std::vector<double>& factors) {
    if (factors.empty()) return; // an easy step has just set all of them back to one
    for (const MovingBlock& moving : moved.verdict.moving) {
        const int b = moving.block;
        if (!std::ranges::binary_search(moved.summary.restless, b)) quicken(factors[b]);
    }
}

/// The body moves along with the steps, each of which starts where the one before has ended; eta grows on the blocks that
/// stop the iteration and falls again as they come to rest. A step on the way need not be an equilibrium, the last must.
Equilibrium relax(StepInProgress& p, PlacedState& placed, const LoadsAt& at, const std::vector<int>& restless) {
    ++p.bench.journal.report().costs.relaxations;
    std::vector<double> factors = p.step.end.memory.viscosity_factor;
    factors.resize(p.bench.model.system.blocks.size(), 1.0);
    (void)grow_mass(restless, factors);
    Equilibrium last; // that the body moved to
    last.load_factor = at.load_factor;
    last.strength_factor = at.strength_factor;
    RelaxationProgress progress;
    for (int attempt = 0; attempt < max_relaxation_attempts; ++attempt) {
        Equilibrium moved = move_on(p, placed, at, factors);
        const Outcome outcome = judge(p, placed, progress, last, moved);
        if (outcome == Outcome::balanced) p.step.end.memory.viscosity_factor = factors;
        if (outcome == Outcome::stuck && !grow_mass(moved.summary.restless, factors))
            fail(p, moved, moved.summary.residual_ratio, FailureKind::no_equilibrium);
        if (outcome == Outcome::balanced || p.failed()) return moved;
        if (outcome == Outcome::stuck) continue;
        if (moved.summary.iterations <= easy_relaxation) decay_mass(factors);
        hurry(moved, factors);
        last = std::move(moved);
    }
    return given_up(p, std::move(last));
}

void hold_balanced_part(Step& step) {
    if (step.balanced_part) return;
    step.balanced_part = Step::BalancedPart{.body = step.end.body,
                                            .load_factor = step.end.at.load_factor,
                                            .in_place = step.in_place,
                                            .viscosity_factor = step.end.memory.viscosity_factor,
                                            .control = step.end.control,
                                            .stresses = step.end.stresses,
                                            .n_equilibria = step.equilibria.size(),
                                            .n_cracks = step.cracks.size()};
}

} // namespace

Equilibrium recover(StepInProgress& p, PlacedState& placed, const Equilibrium& failed, double load_factor) {
    hold_balanced_part(p.step);
    const LoadsAt at = p.loads_at(load_factor);
    if (failed.converged() && !move_body(p, placed, failed)) return failed;
    Equilibrium found = relax(p, placed, at, failed.summary.restless);
    if (p.failed() || !p.goal.must_rest) return found;
    if (found.balanced) { // with the mass-like term of a relaxation: it must stand without it too
        if (!move_body(p, placed, found)) return found;
        placed = place(p);
        found = find_at(p, placed, load_factor, p.displacement());
    }
    if (!found.balanced) fail(p, found, found.viscous_share, FailureKind::no_equilibrium);
    return found;
}

} // namespace kluft
