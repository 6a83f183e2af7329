#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "kluft/simulation/over_damped_motion.hpp"

namespace kluft {

namespace {

constexpr double load_step = 0.1;        ///< pseudo-time in which loads move, of that of an ordinary solve, 1/eta
constexpr double least_load_step = 1e-4; ///< of the first step
constexpr double load_step_cut = 0.1;    ///< of a pseudo-time step in which loads move
constexpr double most_load_parts = 64.0; ///< in which loads are applied
constexpr double far_from_platen = 2.0;  ///< times the motion of the platen: not the way of the motion

/// The relative motion that platens ask for.
double platen_motion(const StepInProgress& p, const LoadsAt& at) {
    Eigen::VectorXd prescribed;
    at.loads.constraints.correction(p.displacement(), prescribed);
    return relative_motion(p.bench.model.system, prescribed);
}

bool moves_platens(const LoadsAt& at) {
    return std::ranges::any_of(at.loads.platens, [](const Platen& platen) { return platen.velocity != 0.0; });
}

/// The longest pseudo-time step under the loads of the motion that can be solved and in which the body does not go much farther than
/// its platen; one that is not solved where there is none.
PseudoStep solve_load_step(StepInProgress& p, const PlacedState& placed, Motion& motion) {
    const double expected = motion.control.elastic_motion + far_from_platen * platen_motion(p, motion.at);
    motion.step = std::max(motion.first, load_step * motion.ordinary);
    for (;;) {
        PseudoStep next = solve_step(p, placed, motion, p.displacement());
        const bool shortest = motion.step < least_load_step * motion.first;
        if (shortest || (next.balanced && moved_by(p, next.moved) <= expected)) return next;
        motion.step *= load_step_cut;
    }
}

} // namespace

bool apply_loads(StepInProgress& p, PlacedState& placed, Motion& motion) {
    const double target = motion.at.load_factor;
    double reached = p.load_factor();
    double part = target - reached;
    const double least_part = part / most_load_parts;
    const bool platen_moves = moves_platens(motion.at);
    const double platen_work = platen_moves ? work_of_platens(p, placed) : 0.0; // per unit of load factor
    while (reached < target) {
        const double next_load = reached + part < target ? reached + part : target;
        motion.at = p.loads_at(next_load);
        PseudoStep next = solve_load_step(p, placed, motion);
        if (!next.balanced) {
            part *= 0.5;
            if (part >= least_part) continue;
            fail(p, next.moved, next.moved.summary.residual_ratio, FailureKind::no_equilibrium);
            if (!follows(p, next.moved) && p.step.failure->what.empty())
                p.step.failure->what = fmt::format("the body cannot follow its supports and platens in motions that "
                                                   "are small beside a spacing of {:.3g} m",
                                                   p.bench.model.system.spacing);
            return false;
        }
        const Eigen::VectorXd& end = next.moved.displacement;
        if (platen_moves) {
            add_platen_motion(p, placed, motion.at, end, platen_work * (next_load - reached), motion.energy);
        } else {
            const Eigen::VectorXd velocity = (end - p.displacement()) / motion.step;
            add_motion(p, placed, motion.at, end, driving_forces(p.bench.model.system, velocity), motion.energy);
        }
        if (!move_body(p, placed, next.moved)) return false;
        if (platen_moves) motion.start = p.displacement(); // with which the body has to go
        reached = next_load;
        motion.last = std::move(next.moved);
        detect_anew(p, placed, motion);
    }
    restart(motion);
    break_there(p, placed, motion);
    return true;
}

} // namespace kluft
