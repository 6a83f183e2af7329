#include "kluft/simulation/jump.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace kluft {

namespace {

/// Along closed contacts.
double largest_slip(const Placement& placement, const Eigen::VectorXd& q, const Eigen::VectorXd& moved) {
    double largest = 0.0;
    for (const ContactPoint& point : placement.contacts) {
        if (gap_and_slip(point, q).gap > point.history.dilation) continue;
        const Vec2 slip =
            displacement_at(moved, point.block_b, point.xi_b) - displacement_at(moved, point.block_a, point.xi_a);
        largest = std::max(largest, std::abs(point.tangent.dot(slip)));
    }
    return largest;
}

int blocks_that_moved(const BlockSystem& system, const Eigen::VectorXd& moved) {
    int n = 0;
    for (int b = 0; b < system.n_blocks(); ++b) {
        const double size = moved.segment<n_block_unknowns>(n_block_unknowns * b).norm();
        if (size > jump_motion * motion_scale(system, system.blocks[b])) ++n;
    }
    return n;
}

/// Records a motion that was one, from where the loads had been applied.
void note_jump(StepInProgress& p, const PlacedState& placed, Motion& motion, const Equilibrium& end) {
    if (p.failed()) return;
    const Eigen::VectorXd moved = end.displacement - motion.start;
    const int n_blocks = blocks_that_moved(p.bench.model.system, moved);
    if (n_blocks == 0) return;
    if (end.balanced)
        add_motion(p, placed, motion.at, end.displacement, Eigen::VectorXd::Zero(moved.size()), motion.energy);
    p.step.jumps.push_back({.step = p.step.end.at.step + 1,
                            .load_factor = motion.at.load_factor,
                            .released_energy = released_energy(p, placed, motion.at, end.displacement, motion.energy),
                            .largest_slip = largest_slip(placed.placement, end.displacement, moved),
                            .blocks = n_blocks});
    ++p.step.end.jumps;
}

/// What the motion came to where it does not end.
Equilibrium given_up(StepInProgress& p, Equilibrium last) {
    const bool never_moved = last.displacement.size() == 0;
    const bool past_strength = is_platen_loaded_by_stress(p.bench.stage(p.from)); // the platen keeps moving
    if (never_moved || past_strength) fail(p, last, last.viscous_share, FailureKind::no_equilibrium);
    return last;
}

void hold_balanced_part(Step& step) {
    if (step.balanced_part) return;
    step.balanced_part = Step::BalancedPart{.body = step.end.body,
                                            .load_factor = step.end.at.load_factor,
                                            .in_place = step.in_place,
                                            .control = step.end.control,
                                            .stresses = step.end.stresses,
                                            .n_equilibria = step.equilibria.size(),
                                            .n_cracks = step.cracks.size(),
                                            .n_jumps = step.jumps.size()};
}

} // namespace

bool is_jump(const StepInProgress& p, const Equilibrium& found) { return moved_by(p, found) > jump_motion; }

Equilibrium follow_motion(StepInProgress& p, PlacedState& placed, double load_factor, const MotionControl& control) {
    Motion motion = begin_motion(p, load_factor, control);
    motion.energy = energy_at_start(p, placed, motion.at);
    if (load_factor != p.load_factor() && !apply_loads(p, placed, motion)) return motion.last;
    std::optional<Equilibrium> end;
    for (int i = 0; i < control.max_steps && !end; ++i) end = take_pseudo_step(p, placed, motion);
    Equilibrium found = end ? std::move(*end) : given_up(p, std::move(motion.last));
    set_friction({}, placed);
    note_jump(p, placed, motion, found);
    return found;
}

Equilibrium recover(StepInProgress& p, PlacedState& placed, double load_factor, const MotionControl& control) {
    ++p.bench.journal.report().costs.relaxations;
    hold_balanced_part(p.step);
    Equilibrium found = follow_motion(p, placed, load_factor, control);
    if (p.failed() || !p.goal.must_rest) return found;
    if (found.balanced) { // perhaps with the mass-like term of the last step: it must stand without it too
        if (!move_body(p, placed, found)) return found;
        placed = place(p);
        found = find_at(p, placed, load_factor, p.displacement());
    }
    if (!found.balanced) fail(p, found, found.viscous_share, FailureKind::no_equilibrium);
    return found;
}

} // namespace kluft
