// Options of a run: how cracks are updated and how a load step is solved or integrated.
#pragma once

#include "kluft/constitutive/strength_noise.hpp"

namespace kluft {

enum class CrackCriterion {
    principal_stress,  ///< mean stress of the two adjacent blocks (default)
    interface_traction ///< the interface's own normal and shear traction
};

enum class CrackUpdate {
    event,          ///< the step is cut where the first potential crack fails (default)
    critical_first, ///< those with f >= 0.95 f_max fail at the end of the step, then check again
    all,            ///< all with f >= 1 fail at the end of the step, then check again
    single          ///< the one with the largest f fails, then check again
};

struct CrackOptions {
    CrackCriterion criterion = CrackCriterion::principal_stress;
    CrackUpdate update = CrackUpdate::event;
    int every = 1;                   ///< load steps between two checks
    double event_tolerance = 2.5e-3; ///< of f at an event
    StrengthNoise strength_noise;    ///< of the potential cracks
};

enum class Tangent {
    unsymmetric, ///< exact
    symmetric    ///< a sliding point drops its shear stiffness
};

struct SolverOptions {
    double tolerance = 1e-5; ///< of |R|/F_ref
    double balance = 1e-3;   ///< largest share of the mass-like term in F_ref of a balanced step
    double accuracy = 0.0;   ///< of the history, relative; the load steps follow from it. 0: as many as the stages say
    int detection_every = 1; ///< load steps between two detections of contacts; always after a crack
    double viscosity = 5e-3; ///< eta H^2/E of the mass-like term
    int max_iterations = 12; ///< open-close iterations per attempt
    int max_unbalanced_steps = 10; ///< successive unbalanced steps that end a run
    int max_step_solves = 20000;   ///< linear solves of one load step; more end the run
    Tangent tangent = Tangent::unsymmetric;
    bool reuse = true;       ///< of the factor; false: a factorization in each linear solve
    bool repeatable = false; ///< a new factor in each load step: runs are bit-identical for any
                             ///< thread count, and across a resume
};

enum class Integrator {
    implicit,       ///< equilibrium by open-close iteration
    explicit_motion ///< motion in small time steps with local damping, as a reference for the implicit one
};

enum class DensityScaling {
    uniform_step, ///< every block gets the inertia that makes its own stable time step that of all others
    none          ///< inertia from the densities
};

struct ExplicitOptions {
    double damping = 0.8; ///< alpha of local damping: the part of the unbalanced force that acts against the velocity
    DensityScaling density_scaling = DensityScaling::uniform_step;
    double loading_rate = 0.0;     ///< velocity of a platen (m/s); 0: from the body's own wave velocity
    int crack_check_interval = 10; ///< time steps between two checks of the potential cracks
};

} // namespace kluft
