// A body that has lost its balance moves over-damped at fixed loads, in pseudo-time steps (docs/theory.md, eq. 29a).
#pragma once

#include <limits>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "kluft/simulation/released_energy.hpp"
#include "kluft/simulation/step_in_progress.hpp"

namespace kluft {

/// Motion of a block at fixed loads, over its motion_scale: more than blocks displace elastically, so that the body has lost
/// its balance.
inline constexpr double jump_motion = 0.01;

/// How finely a motion is followed. Lengths are those of blocks (u or D) over their motion_scale.
struct MotionControl {
    double error = 0.1;           ///< of one pseudo-time step, of the largest motion so far
    double elastic_motion = 5e-3; ///< the least motion that an error is judged by: what stresses of their size displace
    double longest = 0.05;        ///< motion in one pseudo-time step
    int max_steps = 800;          ///< tried, those that are taken again included
};

/// A motion under way. Pseudo-time is 1/eta (m2/Pa).
struct Motion {
    LoadsAt at;
    MotionControl control;
    double first = 0.0;                                        ///< pseudo-time step
    double ordinary = 0.0;                                     ///< pseudo-time step that an ordinary solve takes
    double step = 0.0;                                         ///< the next pseudo-time step
    double step_before = 0.0;                                  ///< 0 where the forces have just changed
    double tried = 0.0;                                        ///< step with which an ordinary solve was tried last
    Eigen::VectorXd end;                                       ///< displacement that it found (m); empty where none
    double largest = 0.0;                                      ///< relative motion so far
    double way_left = std::numeric_limits<double>::infinity(); ///< relative, as the motion slows down
    Eigen::VectorXd start;                                     ///< displacement (m)
    Eigen::VectorXd velocity; ///< of the step before (Pa/m); zero where the forces have just changed
    bool foretells = true;    ///< the velocity tells where the next step goes; no longer once one was not solved
    double step_limit = std::numeric_limits<double>::infinity(); ///< below the step that was not solved last
    Eigen::VectorXd detected;                                    ///< displacement at which contacts were detected (m)
    Eigen::VectorXd early; ///< displacement before the motion had gone halfway to a collapse (m)
    MotionEnergy energy;
    double age = 0.0;         ///< pseudo-time since the forces have changed
    std::vector<char> smooth; ///< blocks whose contacts do not rub (29e); empty: none
    Equilibrium last;         ///< that the body moved to

    /// The largest error of a step.
    [[nodiscard]] double allowed(double motion) const {
        return control.error * std::max({control.elastic_motion, largest, motion});
    }
};

/// A motion from where the step stands, under the loads of a load factor.
[[nodiscard]] Motion begin_motion(const StepInProgress& in_progress, double load_factor, const MotionControl& control);

/// Contacts follow their laws, but those of smooth blocks hold no shear traction (29e).
void set_friction(const std::vector<char>& smooth, PlacedState& placed);

/// The forces have changed at once: the motion begins anew.
void restart(Motion& motion);

/// One implicit Euler step, or the part of it up to where a potential crack fails.
struct PseudoStep {
    Equilibrium moved;
    double load_factor = 1.0; ///< stands for the part of the pseudo-time step
    bool balanced = false;    ///< solved
};

[[nodiscard]] PseudoStep solve_step(StepInProgress& in_progress, const PlacedState& placed, const Motion& motion,
                                    const Eigen::VectorXd& guess);

/// Whether the body is where its supports and platens prescribe it to be: one that stays behind may have no forces at all.
[[nodiscard]] bool follows(const StepInProgress& in_progress, const Equilibrium& moved);

/// Relative to the motion scale of the block that moves most, from where the step stands.
[[nodiscard]] double moved_by(const StepInProgress& in_progress, const Equilibrium& moved);

/// Places the body anew where the motion has come to.
void detect_anew(StepInProgress& in_progress, PlacedState& placed, Motion& motion);

/// The platens hold the body as they do where it stands now.
void touch_anew(const StepInProgress& in_progress, Motion& motion);

/// Whether potential cracks fail on the way.
[[nodiscard]] bool checks_events(const StepGoal& goal);

/// Potential cracks that fail where the body is.
void break_there(StepInProgress& in_progress, PlacedState& placed, Motion& motion);

/// Applies loads that the body has not had yet, slowly, in as many parts as it takes. False, and the step has failed, where
/// there is no way to.
[[nodiscard]] bool apply_loads(StepInProgress& in_progress, PlacedState& placed, Motion& motion);

/// Takes one pseudo-time step at fixed loads, if it is solved and accurate. What is returned is the end of the motion.
[[nodiscard]] std::optional<Equilibrium> take_pseudo_step(StepInProgress& in_progress, PlacedState& placed,
                                                          Motion& motion);

} // namespace kluft
