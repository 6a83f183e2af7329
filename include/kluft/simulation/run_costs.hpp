// What a run has cost.
#pragma once

namespace kluft {

/// Where the time of a run went (s).
struct RunSeconds {
    double detection = 0.0;
    double set_up = 0.0;   ///< bonds, pattern look-ups, constant tangent
    double assembly = 0.0; ///< residuals and tangents
    double local = 0.0;    ///< iterations on the few blocks that carry most of the forces
    double analysis = 0.0;
    double factorization = 0.0;
    double update = 0.0; ///< low-rank changes on top of a factor
    double solution = 0.0;
    double crack_check = 0.0;
    double observers = 0.0;
};

/// Of the whole run: what was spent before a resumed state was saved is counted, what was lost with a load step that
/// was not committed is not.
struct RunCosts {
    int open_close_iterations = 0; ///< all linear solves of the whole body
    int factorizations = 0;
    int analyses = 0;
    int updates = 0;      ///< linear solves with a factor that was kept
    int largest_rank = 0; ///< of the changes on top of a factor
    int refinements = 0;  ///< Krylov vectors in all linear solves
    int relaxations = 0;
    int events = 0;             ///< equilibria at which potential cracks failed
    int rejected_steps = 0;     ///< load steps taken again with a smaller size, for the accuracy's sake
    double elapsed_s = 0.0;     ///< wall-clock time of the load steps
    double loading_cpu_s = 0.0; ///< processor time of the same, without start-up and pictures
    RunSeconds seconds;
};

/// Calls visit(name, member) for each counter, by the name that it has in state.h5, in summary.json and in the tables of a
/// study. `costs`: RunCosts, const or not.
template <class Costs, class Visit> void visit_counts(Costs& costs, Visit&& visit) {
    visit("open_close_iterations", costs.open_close_iterations);
    visit("factorizations", costs.factorizations);
    visit("analyses", costs.analyses);
    visit("updates", costs.updates);
    visit("rank", costs.largest_rank);
    visit("refinements", costs.refinements);
    visit("relaxations", costs.relaxations);
    visit("events", costs.events);
    visit("rejected_steps", costs.rejected_steps);
}

/// The same for the times (s). `seconds`: RunSeconds, const or not.
template <class Seconds, class Visit> void visit_seconds(Seconds& seconds, Visit&& visit) {
    visit("detection", seconds.detection);
    visit("set_up", seconds.set_up);
    visit("assembly", seconds.assembly);
    visit("local", seconds.local);
    visit("analysis", seconds.analysis);
    visit("factorization", seconds.factorization);
    visit("update", seconds.update);
    visit("solution", seconds.solution);
    visit("crack_check", seconds.crack_check);
    visit("output", seconds.observers);
}

/// What an explicit run did.
struct MotionReport {
    long time_steps = 0;
    double time_step = 0.0;    ///< the last one (s, of the time in which the inertia of the blocks counts)
    double energy_error = 0.0; ///< the largest of its load steps
};

} // namespace kluft
