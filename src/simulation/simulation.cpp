#include "kluft/simulation/simulation.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include <Eigen/Eigenvalues>
#include <fmt/format.h>

#include "kluft/assembly/blas.hpp"
#include "kluft/blocks/block_search.hpp"
#include "kluft/contact/bonds.hpp"
#include "kluft/core/diagnostics.hpp"
#include "kluft/core/stopwatch.hpp"
#include "kluft/equilibrium/open_close_solver.hpp"
#include "kluft/fracture/crack_check.hpp"
#include "kluft/kinematics/affine.hpp"
#include "kluft/kinematics/rigid.hpp"
#include "kluft/simulation/measurements.hpp"
#include "kluft/simulation/run_course.hpp"
#include "kluft/simulation/state_check.hpp"
#include "kluft/simulation/state_points.hpp"
#include "kluft/simulation/step_control.hpp"
#include "kluft/simulation/strength_reduction.hpp"
#include "kluft/simulation/weakening.hpp"

namespace kluft {

namespace {

constexpr double balance_rounds_per_digit = 4.0; ///< of `balance`
constexpr double least_balance_progress = 0.7;   ///< of the viscous share per round, else the body is moving
constexpr double relaxation_growth = 16.0;       ///< of eta on the blocks that stop the iteration
constexpr double relaxation_decay = 4.0;         ///< after a solve in a few iterations, also of later load steps
constexpr int easy_iterations = 6;
constexpr double largest_relaxation = 4.0e6;
constexpr int easy_relaxation = 4;
constexpr double relaxed_tolerance = 0.1; ///< of `balance`: a residual on the way that does not matter
constexpr double relaxed_residual = 2.0;  ///< of the mass-like forces: the same
constexpr int max_relaxation_attempts = 250;
constexpr double collapse_motion = 0.5; ///< of a block in one load step, in lattice spacings
constexpr int quick_event_trials = 12;  ///< then the interval is halved: f may have a kink that Illinois creeps up to
constexpr int max_event_trials = 60;
constexpr double reduction_balance = 0.1;         ///< of the tolerance of a factor of safety: largest `balance`
constexpr double reduction_residual = 0.01;       ///< of it: largest `tolerance`, and the share of a body that rests
constexpr int max_moving_attempts = 25;           ///< of a relaxation with reduced strengths, whose share does not fall
constexpr double least_relaxation_progress = 0.9; ///< of the share in as many attempts
constexpr double largest_useful_index = 10.0;  ///< of f in the search for an event: a strength of zero gives infinity
constexpr double accurate_balance = 0.03;      ///< of the accuracy asked for: largest `balance`
constexpr double lag_weight = 4.0;             ///< of the mass-like term's share in the stresses (measured: 1 to 4)
constexpr double softening_share = 0.2;        ///< of the stress lost since the peak: the accuracy there
constexpr double least_step_size = 1e-4;       ///< load factor of a step from an accuracy that is accepted as it is
constexpr double least_predicted_share = 0.01; ///< of a load step: the first trial of an event
constexpr double least_event_width = 1e-4;     ///< of the accuracy: load factors between which an event is not searched

/// True if the constraints stop every rigid motion of every group of bonded blocks.
bool is_held(const BlockSystem& system, const std::vector<char>& bonded, const Constraints& constraints) {
    std::vector<int> group(system.blocks.size());
    std::iota(group.begin(), group.end(), 0);
    const auto root = [&](int b) {
        while (group[b] != b) b = group[b] = group[group[b]];
        return b;
    };
    for (int i = 0; i < system.n_interfaces(); ++i) {
        if (bonded[i]) group[root(system.interfaces[i].block_a)] = root(system.interfaces[i].block_b);
    }
    std::vector<Eigen::Matrix3d> grams(system.blocks.size(), Eigen::Matrix3d::Zero());
    const Vec2 centre = 0.5 * (system.lower + system.upper);
    const double size = (system.upper - system.lower).maxCoeff();
    for (const auto& row : constraints.rows()) {
        if (row.rate != 0.0) continue; // the platen travels
        const Block& block = system.blocks[row.block];
        const Vec2 arm = (block.centroid + block.size * row.xi - centre) / size;
        const Eigen::Vector3d motion(row.direction.x(), row.direction.y(), cross(arm, row.direction));
        grams[root(row.block)] += motion * motion.transpose();
    }
    for (int b = 0; b < system.n_blocks(); ++b) {
        if (root(b) != b) continue;
        const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(grams[b]);
        if (eigen.eigenvalues()[0] <= 1e-9 * std::max(1e-300, eigen.eigenvalues()[2])) return false;
    }
    return true;
}

/// Of a load step that is taken again with a smaller size, whatever the accuracy.
constexpr StepError without_equilibrium{std::numeric_limits<double>::infinity(),
                                        std::numeric_limits<double>::infinity()};

class Run {
public:
    Run(const Model& model, const CrackOptions& cracks, const SolverOptions& solver, State& state,
        StepObserver& observer, const std::atomic<bool>& stop)
        : model_(model), cracks_(cracks), options_(solver), course_(model, state, observer, stop),
          open_close_(linear_, open_close_options(solver)) {
        problem_.kinematics = model.kinematics;
        problem_.system = &model.system;
        problem_.moduli = &model.moduli;
        problem_.laws = &strengths_.laws;
        if (has_gravity(model)) problem_.densities = model.densities;
        problem_.least_mass_area = std::sqrt(0.75) * model.system.spacing * model.system.spacing;
    }

    RunReport run() {
        steps_.begin_stage = [this] { begin_stage(); };
        steps_.initial_record = [this] {
            prepare();
            set_load(0.0);
            return measure(work_.displacement, 0.0);
        };
        steps_.load_step = [this](double target, bool last_of_stage) { return load_step(target, last_of_stage); };
        steps_.chooses_steps = [this] { return is_adaptive(); };
        steps_.reduce_strengths = [this] { reduce_strengths(); };
        steps_.look_back = [this](const StepRecord& record) {
            if (work_.unbalanced_in_succession >= options_.max_unbalanced_steps)
                throw no_equilibrium(last_worst_block_, record.unbalanced_ratio);
        };
        steps_.end_stage = [this] {
            if (last_residual_.forces.size() == 0) { // resumed at the end of a stage
                prepare();
                set_load(1.0);
                (void)measure(work_.displacement, 0.0);
            }
            leave_stage(model_, *course_.loads, problem_, last_residual_.forces, work_);
        };
        steps_.costs = [this] { return costs(); };
        steps_.fields = [this] { return field_record(model_, work_, problem_); };
        RunReport report = run_stages(course_, steps_);
        if (options_.accuracy > 0.0) report.estimated_error = course_.accepted.control.estimated_error;
        return report;
    }

private:
    struct Trial {
        Eigen::VectorXd q;
        OpenCloseSummary summary;
        double viscous_share = 0.0;
        bool balanced = false;
        [[nodiscard]] bool converged() const { return summary.converged(); }
    };

    /// Whether the viscous share of a relaxation falls, with patience.
    struct RelaxationProgress {
        double least = std::numeric_limits<double>::infinity();
        int attempts = 0; ///< since then
        bool falls(double share) {
            if (share < least_relaxation_progress * least) {
                least = share;
                attempts = 0;
            }
            return ++attempts <= max_moving_attempts;
        }
    };

    static OpenCloseOptions open_close_options(const SolverOptions& solver) {
        OpenCloseOptions options;
        options.tolerance = solver.tolerance;
        options.max_iterations = solver.max_iterations;
        options.reuse = solver.reuse;
        options.tangent = solver.tangent == Tangent::unsymmetric ? TangentKind::exact : TangentKind::symmetric;
        return options;
    }

    /// Everything spent so far, also before the state that the run started from.
    [[nodiscard]] RunCosts costs() const {
        RunCosts costs = report_.costs;
        const LinearSolverStatistics& linear = linear_.statistics();
        costs.factorizations += linear.factorizations;
        costs.analyses += linear.analyses;
        costs.updates += linear.updates;
        costs.largest_rank = std::max(costs.largest_rank, linear.rank);
        costs.refinements += linear.refinements;
        costs.elapsed_s = course_.elapsed();
        costs.seconds.analysis += linear.analyze_seconds;
        costs.seconds.factorization += linear.factorize_seconds;
        costs.seconds.update += linear.update_seconds;
        costs.seconds.solution += linear.solve_seconds;
        costs.seconds.assembly += open_close_.assembly_seconds();
        return costs;
    }

    void begin_stage() {
        if (work_.step_in_stage == 0) {
            work_.displacement_rate.resize(0);
            work_.control.size = 1.0 / course_.stage().steps;
            work_.control.lag = 0.0;
        }
        steps_with_contacts_ = 0;
        strengths_ = reduced_strengths(model_, work_.stage, work_.load_factor);
        course_.holds_back = reduces_strengths();
        course_.chooses_steps = options_.accuracy > 0.0;
        const double tolerance = reduces_strengths() ? course_.stage().strength_reduction->tolerance : 0.0;
        rest_share_ = reduction_residual * tolerance;
        balance_ = reduces_strengths() ? std::min(options_.balance, reduction_balance * tolerance) : options_.balance;
        open_close_.set_tolerance(reduces_strengths() ? std::min(options_.tolerance, rest_share_) : options_.tolerance);
    }

    [[nodiscard]] bool is_adaptive() const { return options_.accuracy > 0.0 && !reduces_strengths(); }
    [[nodiscard]] bool reduces_strengths() const { return course_.stage().strength_reduction.has_value(); }

    // ---- factor of safety ------------------------------------------------------------------------------------

    /// Divides the strengths by larger and larger factors. Where no equilibrium is found, the interval between the last
    /// one with equilibrium and the first one without is halved, always from the last equilibrium, and the run ends.
    void reduce_strengths() {
        const StrengthReduction& reduction = *course_.stage().strength_reduction;
        const int n_steps = course_.stage().steps;
        if (work_.load_factor == 0.0) begin_reduction();
        std::optional<double> failing;
        while (!failing && work_.step_in_stage < n_steps) {
            const double target = static_cast<double>(work_.step_in_stage + 1) / n_steps;
            if (!stands_at(target, true)) failing = target;
        }
        if (!failing) {
            report_.warnings.push_back(
                fmt::format("the factor of safety is above {:g}, the largest strength factor of stage {}", reduction.to,
                            work_.stage));
            return;
        }
        const auto factor = [&](double load_factor) { return reduction.factor_at(load_factor); };
        while (factor(*failing) - factor(work_.load_factor) > reduction.tolerance * factor(work_.load_factor)) {
            const double middle = 0.5 * (work_.load_factor + *failing);
            if (middle == work_.load_factor || middle == *failing) break; // to the last digit
            if (!stands_at(middle, false)) failing = middle;
        }
        report_.factor_of_safety = factor(work_.load_factor);
        throw last_failure_;
    }

    /// The state that the stages before have left must stand by the closer look of this one.
    void begin_reduction() {
        step_balanced_ = true;
        worst_share_ = 0.0;
        advance(0.0, false);
        accept(course_, steps_);
        tell_waiting(course_);
    }

    /// Tries a load step; the state stays where it was if there is no equilibrium at its end. `regular`: one of the steps
    /// of the stage, and not one between two of them.
    bool stands_at(double target, bool regular) {
        const StepRecord before = course_.last_record;
        const int events = report_.costs.events;
        const bool last_of_stage = regular && work_.step_in_stage + 1 == course_.stage().steps;
        course_.passes = 0;
        try {
            commit_load_step(course_, steps_, load_step(target, last_of_stage), target, last_of_stage, regular);
            return true;
        } catch (const LostEquilibrium& failure) {
            last_failure_ = failure;
            report_.costs.events = events;
            work_ = course_.accepted;
            course_.last_record = before;
            course_.waiting_equilibria.clear();
            course_.waiting_cracks.clear();
            return false;
        }
    }

    // ---- load steps ------------------------------------------------------------------------------------------

    StepRecord load_step(double target, bool last_of_stage) {
        iterations_at_start_ = report_.costs.open_close_iterations;
        if (options_.repeatable) open_close_.forget_factor();
        step_balanced_ = true;
        worst_share_ = 0.0;
        if (is_adaptive()) {
            advance_by_accuracy();
        } else {
            const bool smooth = advance(target, is_checked(last_of_stage));
            if (smooth && !reduces_strengths()) {
                keep_rate(target);
            } else {
                work_.displacement_rate.resize(0);
            }
        }
        StepRecord record = course_.last_record;
        record.open_close_iterations = report_.costs.open_close_iterations - iterations_at_start_;
        record.balanced = step_balanced_;
        record.unbalanced_ratio = worst_share_;
        return record;
    }

    /// Whether potential cracks are checked in the step in progress.
    [[nodiscard]] bool is_checked(bool last_of_stage) const {
        return model_.has_potential_cracks &&
               ((work_.step + 1) % std::max(1, cracks_.every) == 0 || last_of_stage || reduces_strengths());
    }

    /// That of the step in progress, from the accepted state to the work state at a load factor.
    void keep_rate(double load_factor) {
        const State& before = course_.accepted;
        work_.displacement_rate = (work_.displacement - before.displacement) / (load_factor - before.load_factor);
    }

    /// Brings the work state to the target load factor. True if nothing broke, was cut or relaxed on the way.
    bool advance(double target, bool check) {
        bool smooth = true;
        const bool by_events = check && cracks_.update == CrackUpdate::event;
        do {
            const double from = work_.load_factor;
            begin_step();
            Trial trial = solve(target, predicted(target));
            if (!trial.balanced) {
                smooth = false;
                trial = recover(trial, target, from);
                if (!trial.balanced && nothing_holds())
                    throw no_equilibrium(last_worst_block_, trial.viscous_share, true);
            }
            double reached = target;
            if (by_events && trial.balanced) reached = locate_event(from, target, trial);
            smooth = smooth && reached == target;
            commit(trial, reached);
            record_equilibrium(trial);
            if (check && (by_events || reached >= target) && break_bonds(reached)) smooth = false;
        } while (work_.load_factor < target);
        return smooth;
    }

    // ---- load steps from an accuracy -------------------------------------------------------------------------

    /// One load step: of the size that the accuracy asks for, or up to the next event.
    void advance_by_accuracy() {
        const State& before = course_.accepted;
        const StepRecord record_before = course_.last_record;
        const int events_before = report_.costs.events;
        set_accuracy();
        StepError rejected;
        for (double last_size = 0.0;;) {
            const double remaining = 1.0 - before.load_factor;
            const double size = fitted_step_size(work_.control.size, remaining);
            const double target = size < remaining ? before.load_factor + size : 1.0;
            const auto error = try_or_stand_back(size, target);
            if (!error) {
                charge_unjudged();
                break;
            }
            const bool stands = std::isfinite(error->path);
            const bool branches = stands && last_size > 0.0 && !learn_lag(size, *error, last_size, rejected);
            const StepError own{stands && is_past_peak() ? 0.0 : std::max(0.0, error->path - work_.control.lag * size),
                                error->chord};
            if (branches || (stands && size <= least_step_size) || is_accurate(size, own, accuracy_)) {
                keep_judged(size, own, branches);
                break;
            }
            ++report_.costs.rejected_steps;
            const double lag = work_.control.lag;
            take_back(record_before, events_before);
            work_.control.lag = lag;
            work_.control.size = next_step_size(size, own, accuracy_);
            rejected = *error;
            last_size = stands ? size : 0.0;
        }
        StepControl& control = work_.control;
        if (control.largest_stress > before.control.largest_stress || !prescribes_strain())
            control.estimated_error = control.path_error + control.event_error;
    }

    /// A load step that ends without equilibrium is too large, unless it is small.
    std::optional<StepError> try_or_stand_back(double size, double target) {
        try {
            return try_step(target, is_checked(target == 1.0));
        } catch (const LostEquilibrium&) {
            if (size > small_step()) return without_equilibrium;
            tell_waiting(course_);
            throw;
        }
    }

    /// Up to this size a load step may be relaxed, and a run may end in it: the history misses no more than the accuracy.
    [[nodiscard]] double small_step() const { return std::max(accuracy_, least_step_size); }

    /// From a step that was rejected and taken again with a smaller size: the part of the error in proportion to the size
    /// is a lag (of the mass-like term, of the tolerance) that does not add up. False where the error does not fall with
    /// the size: a jump or a branch of the path.
    bool learn_lag(double size, const StepError& error, double rejected_size, const StepError& rejected) {
        if (error.chord > rejected.chord && error.chord > accuracy_) return false;
        const double rate = error.path / size;
        const double rejected_rate = rejected.path / rejected_size;
        if (rate >= rejected_rate) return error.path <= accuracy_ * size;
        const double lag = rate - size * (rejected_rate - rate) / (rejected_size - size);
        work_.control.lag = std::clamp(lag, 0.0, accuracy_);
        return true;
    }

    /// What has been lost since a peak in this stage, where the platen goes on the same way, makes accuracy pointless: the
    /// path after the peak depends on every detail, and only the straight lines between the rows are judged there.
    void set_accuracy() {
        const StepControl& control = work_.control;
        const bool may_soften = prescribes_strain() && control.stage_of_largest == work_.stage;
        stress_lost_ = may_soften ? 1.0 - std::abs(control.axial_stress) / control.largest_stress : 0.0;
        accuracy_ = std::max(options_.accuracy, softening_share * stress_lost_);
        cracks_.event_tolerance = accuracy_;
        balance_ = std::min(options_.balance, accurate_balance * accuracy_);
    }

    /// By more than the accuracy that is asked for.
    [[nodiscard]] bool is_past_peak() const { return stress_lost_ > options_.accuracy; }

    /// The error of a step that ended at an event or was relaxed: as that of the last one that was judged.
    void charge_unjudged() {
        const double taken = work_.load_factor - course_.accepted.load_factor;
        work_.control.path_error += work_.control.curvature * taken * taken;
    }

    void keep_judged(double size, const StepError& error, bool branches) {
        StepControl& control = work_.control;
        control.size = branches ? size : std::max(least_step_size, next_step_size(size, error, accuracy_));
        control.curvature = error.path / (size * size);
        control.path_error += error.path;
    }

    /// Undoes the load step in progress. The pairs that the matrix is ordered for stay.
    void take_back(const StepRecord& record_before, int events_before) {
        auto near_pairs = std::move(work_.near_pairs);
        work_ = course_.accepted;
        work_.near_pairs = std::move(near_pairs);
        course_.last_record = record_before;
        course_.passes = 0;
        course_.waiting_equilibria.clear();
        course_.waiting_cracks.clear();
        report_.costs.events = events_before;
        steps_with_contacts_ = 0;
    }

    /// Moves the work state towards the target load factor, up to the first event. A step without one is judged. Where no
    /// equilibrium is found at once, the step is relaxed only if it is small.
    std::optional<StepError> try_step(double target, bool check) {
        const double from = work_.load_factor;
        course_.holds_back = true;
        begin_step();
        seeks_failure_ = check && cracks_.update == CrackUpdate::event;
        note_slips(work_.displacement);
        const double first = predicted_event(from, target);
        Trial trial = solve(first, predicted(first));
        if (!trial.balanced) {
            if (first - from > small_step()) return without_equilibrium;
            trial = recover(trial, first, from);
            work_.control.size = std::max(work_.control.size, std::min(small_step(), 2.0 * (first - from)));
            finish_unjudged(trial, first, check);
            work_.displacement_rate.resize(0);
            return std::nullopt;
        }
        const double reached = locate_event(from, first, trial);
        const bool event = reached < first || is_event(trial.q);
        work_.control.missed_events = event || first == target ? 0 : work_.control.missed_events + 1;
        if (reached == target && !event) return judge_by_halves(target, trial, check);
        finish_unjudged(trial, reached, check);
        return std::nullopt;
    }

    /// Takes the step from the work state once more in two halves, which are what counts.
    std::optional<StepError> judge_by_halves(double target, const Trial& whole, bool check) {
        const CourseValue start = course_value(work_.control.axial_stress, work_.displacement);
        const CourseValue at_once = course_value(measure(whole.q, whole.viscous_share).axial_stress, whole.q);
        const double middle = std::midpoint(work_.load_factor, target);
        const Trial half = solve(middle, 0.5 * (work_.displacement + whole.q));
        if (!half.balanced) {
            set_load(target);
            finish_unjudged(whole, target, check);
            return std::nullopt;
        }
        commit(half, middle);
        record_equilibrium(half);
        const CourseValue halfway = course_value(work_.control.axial_stress, half.q);
        prepare();
        Trial end = solve(target, whole.q);
        if (!end.balanced) {
            finish_unjudged(recover(end, target, middle), target, check);
            return std::nullopt;
        }
        const double reached = locate_event(middle, target, end);
        if (reached < target || is_event(end.q)) {
            finish_unjudged(end, reached, check);
            return std::nullopt;
        }
        finish_step(end, target, check);
        const double open =
            options_.tolerance + lag_weight * std::max({whole.viscous_share, half.viscous_share, end.viscous_share});
        return error_of(start, halfway, course_value(work_.control.axial_stress, end.q), at_once, open);
    }

    /// Nothing takes the step back any more.
    void finish_unjudged(const Trial& trial, double reached, bool check) {
        finish_step(trial, reached, check);
        course_.holds_back = false;
        tell_waiting(course_);
    }

    void finish_step(const Trial& trial, double reached, bool check) {
        if (trial.balanced) note_event(trial.q);
        commit(trial, reached);
        record_equilibrium(trial);
        keep_rate(reached);
        if (check) (void)break_bonds(reached);
    }

    /// The axial stress where a platen prescribes the strain, else the stresses of all blocks, whose norm is the root of
    /// their mean square.
    using CourseValue = Eigen::VectorXd;
    [[nodiscard]] CourseValue course_value(double axial_stress, const Eigen::VectorXd& q) const {
        if (prescribes_strain()) return CourseValue::Constant(1, axial_stress);
        return weighted_stresses(problem_, q);
    }

    [[nodiscard]] bool prescribes_strain() const {
        return course_.stage().motion.has_value() && !course_.is_platen_loaded_by_stress();
    }

    /// `open`: what the solves themselves leave open, relative; it does not add up and is none of the step's size. The
    /// scale is the largest value so far, or what the stage comes to at the pace so far.
    [[nodiscard]] StepError error_of(const CourseValue& start, const CourseValue& middle, const CourseValue& end,
                                     const CourseValue& at_once, double open) const {
        const StepControl& control = work_.control;
        const double largest = prescribes_strain() ? control.largest_stress : control.largest_mean_stress;
        const double size = work_.load_factor - course_.accepted.load_factor;
        const double scale = std::max(largest, (end + (1.0 - work_.load_factor) / size * (end - start)).norm());
        if (!(scale > 0.0)) return {};
        const double path = (end - at_once).norm() / scale;
        const double chord = (middle - 0.5 * (start + end)).norm() / scale;
        return {std::max(0.0, path - open), std::max(0.0, chord - open)};
    }

    // ---- events of steps from an accuracy --------------------------------------------------------------------

    [[nodiscard]] bool is_event(const Eigen::VectorXd& q) { return event_index(q) >= 1.0 - accuracy_; }

    /// Of the mapped fractures that have not slipped yet, and of the potential cracks if they are checked.
    double event_index(const Eigen::VectorXd& q) {
        if (!is_adaptive()) return largest_index_at(q);
        double largest = seeks_failure_ ? largest_index_at(q) : 0.0;
        if (cracks_.update != CrackUpdate::event) return largest;
        const auto slips = slip_indices(model_, problem_, q);
        for (int i = 0; i < static_cast<int>(slips.size()); ++i)
            if (!has_slipped(i)) largest = std::max(largest, std::min(largest_useful_index, slips[i]));
        return largest;
    }

    [[nodiscard]] bool has_slipped(int fracture) const {
        return std::ranges::find(work_.control.slipped, fracture) != work_.control.slipped.end();
    }

    /// A mapped fracture slips for the first time only once.
    void note_slips(const Eigen::VectorXd& q) {
        if (cracks_.update != CrackUpdate::event) return;
        const auto slips = slip_indices(model_, problem_, q);
        for (int i = 0; i < static_cast<int>(slips.size()); ++i)
            if (slips[i] >= 1.0 - accuracy_ && !has_slipped(i)) work_.control.slipped.push_back(i);
    }

    void note_event(const Eigen::VectorXd& q) {
        const double index = event_index(q);
        if (index < 1.0 - accuracy_) return;
        work_.control.event_error = std::max(work_.control.event_error, std::min(std::abs(index - 1.0), event_width_));
        note_slips(q);
    }

    /// Where the motion of the last step, going on, has the next event before the target; else the target.
    double predicted_event(double from, double target) {
        if (work_.displacement_rate.size() == 0) return target;
        const double width = target - from;
        double low = 0.0;
        double high = 1.0;
        const auto index_at = [&](double load_factor) {
            set_load(load_factor);
            return event_index(predicted(load_factor)) - 1.0;
        };
        double g_low = index_at(from);
        double g_high = index_at(target);
        if (g_high <= accuracy_ || g_low >= 0.0) return target;
        double at = high;
        for (int i = 0; i < quick_event_trials && std::abs(g_high) > 0.1 * accuracy_; ++i) {
            at = high - g_high * (high - low) / (g_high - g_low);
            const double g = index_at(from + at * width);
            if (g >= 0.0) {
                high = at;
                g_high = g;
                g_low *= 0.5;
            } else {
                low = at;
                g_low = g;
                g_high *= 0.5;
            }
        }
        at = std::max(at, least_predicted_share) * std::ldexp(1.0, std::min(work_.control.missed_events, 10));
        return at < 1.0 ? from + at * width : target;
    }

    // ---- recovery --------------------------------------------------------------------------------------------

    /// Where a solve has failed: relaxes from the work state, which stands at the load factor `at`. With reduced
    /// strengths the result must stand without relaxation too.
    Trial recover(const Trial& failed, double load_factor, double at) {
        if (failed.converged()) commit(failed, at);
        Trial trial = relax(load_factor, failed.summary.restless);
        if (!reduces_strengths()) return trial;
        if (trial.balanced) {
            commit(trial, at);
            prepare();
            trial = solve(load_factor, work_.displacement);
        }
        if (!trial.balanced) throw no_equilibrium(last_worst_block_, trial.viscous_share, nothing_holds());
        return trial;
    }

    [[nodiscard]] bool nothing_holds() const { return problem_.constraints.rows().empty(); }

    /// Under a given stress or weight a body that lost its balance may fall for ever.
    [[nodiscard]] bool is_falling() const {
        if (!course_.is_loaded_by_stress()) return false;
        const Eigen::VectorXd moved = work_.displacement - course_.accepted.displacement;
        for (int b = 0; b < model_.system.n_blocks(); ++b) {
            if (moved.segment<2>(n_block_unknowns * b).norm() > collapse_motion * model_.system.spacing) return true;
        }
        return false;
    }

    // ---- one equilibrium -------------------------------------------------------------------------------------

    /// At the start of a load step, where the contacts may be those of the step before.
    void begin_step() {
        const bool keeps = steps_with_contacts_ > 0 && steps_with_contacts_ < options_.detection_every;
        prepare(keeps);
        ++steps_with_contacts_;
    }

    /// Contacts and frames of the work state; what all trials from it share.
    void prepare(bool keeps_contacts = false) {
        bonded_ = bonded_interfaces(work_);
        const bool separated = std::ranges::find(bonded_, 0) != bonded_.end();
        {
            const Stopwatch watch(report_.costs.seconds.set_up);
            place_bonds(model_, work_, problem_.bonds);
        }
        std::vector<std::pair<int, int>> near_pairs;
        if (keeps_contacts) {
            renew_contacts(work_, problem_.contacts);
        } else {
            steps_with_contacts_ = 0;
            problem_.contacts.clear();
        }
        if ((separated || may_outlines_meet(model_)) && !keeps_contacts) {
            const Stopwatch watch(report_.costs.seconds.detection);
            auto detected = state_contacts(model_, work_);
            problem_.contacts = std::move(detected.points);
            near_pairs = std::move(detected.near_pairs);
            ++report_.detections;
        }
        require_pattern(near_pairs);
        problem_.constraints = course_.loads->constraints();
        problem_.pressure_edges = course_.loads->edges();
        problem_.start = work_.displacement;
        problem_.eta.clear();
        const bool needs_mass = separated || !is_held(model_.system, bonded_, problem_.constraints);
        if (needs_mass && options_.viscosity > 0.0) {
            problem_.eta.assign(model_.system.blocks.size(), eta_of(options_.viscosity));
            for (std::size_t b = 0; b < work_.viscosity_factor.size(); ++b)
                problem_.eta[b] *= work_.viscosity_factor[b];
        }
    }

    [[nodiscard]] double eta_of(double viscosity) const {
        const double height = (model_.system.upper - model_.system.lower).maxCoeff();
        return viscosity * model_.effective_modulus / (height * height);
    }

    /// A relaxation needs the mass-like term also where ordinary solves do without it.
    [[nodiscard]] double relaxation_eta() const {
        return eta_of(options_.viscosity > 0.0 ? options_.viscosity : SolverOptions{}.viscosity);
    }

    /// The pattern must hold every pair that touches; a new one costs an analysis.
    void require_pattern(const std::vector<std::pair<int, int>>& near_pairs) {
        const bool first = pattern_.n_blocks() != model_.system.n_blocks();
        if (first && !work_.near_pairs.empty()) analyze_pattern();
        const bool complete = pattern_.n_blocks() == model_.system.n_blocks() &&
                              std::ranges::all_of(problem_.contacts, [&](const ContactPoint& point) {
                                  return pattern_.find(point.block_a, point.block_b) >= 0;
                              });
        if (complete) return;
        work_.near_pairs = near_pairs;
        analyze_pattern();
    }

    /// Orders the matrix for the pairs of the work state: a resumed run has the ordering of the saved one.
    void analyze_pattern() {
        std::vector<std::pair<int, int>> pairs = work_.near_pairs;
        for (const Interface& interface : model_.system.interfaces) {
            pairs.emplace_back(interface.block_a, interface.block_b);
        }
        pattern_ = BlockPattern(model_.system.n_blocks(), pairs, model_.kinematics);
        linear_.analyze(pattern_);
    }

    void set_load(double load_factor) {
        tried_load_factor_ = load_factor;
        apply_load(model_, *course_.loads, work_.stage, load_factor, problem_);
        if (reduces_strengths()) strengths_ = reduced_strengths(model_, work_.stage, load_factor);
    }

    [[nodiscard]] Eigen::VectorXd predicted(double load_factor) const {
        if (work_.displacement_rate.size() == 0) return work_.displacement;
        return work_.displacement + (load_factor - work_.load_factor) * work_.displacement_rate;
    }

    Trial solve(double load_factor, Eigen::VectorXd guess) {
        if (course_.stop) throw Interrupted{};
        set_load(load_factor);
        problem_.start = work_.displacement;
        Trial trial;
        trial.q = std::move(guess);
        if (model_.kinematics == Kinematics::rigid) make_rigid(model_.system, trial.q);
        trial.summary = open_close_.solve(problem_, pattern_, trial.q, work_.contacts.empty());
        report_.costs.open_close_iterations += trial.summary.iterations;
        last_worst_block_ = trial.summary.worst_block;
        if (trial.converged()) balance(trial);
        if (trial.balanced && trial.summary.iterations <= easy_iterations) decay(work_.viscosity_factor);
        notify_progress(course_, load_factor, report_.costs.open_close_iterations);
        return trial;
    }

    [[nodiscard]] double viscous_share(const Trial& trial) const {
        const double force = viscous_force(problem_, trial.q);
        return force > 0.0 ? force / std::max(trial.summary.force_scale, 1e-300) : 0.0;
    }

    /// The mass-like term must not change the answer: solve again from the result until its share is small. With reduced
    /// strengths it must fall as well, for a body that slides has a share that stays, however small it is.
    void balance(Trial& trial) {
        trial.viscous_share = viscous_share(trial);
        const int max_rounds = static_cast<int>(std::ceil(-balance_rounds_per_digit * std::log10(balance_)));
        bool settles = !reduces_strengths() || trial.viscous_share <= rest_share_;
        for (int round = 0; round < max_rounds && (trial.viscous_share > balance_ || !settles); ++round) {
            problem_.start = trial.q;
            Trial next = trial;
            next.summary = open_close_.solve(problem_, pattern_, next.q);
            report_.costs.open_close_iterations += next.summary.iterations;
            if (!next.converged()) break;
            next.viscous_share = viscous_share(next);
            const bool stalls = next.viscous_share > least_balance_progress * trial.viscous_share;
            trial = std::move(next);
            settles = !reduces_strengths() || !stalls || trial.viscous_share <= rest_share_;
            if (stalls) break;
        }
        trial.balanced = settles && trial.viscous_share <= balance_;
    }

    /// Pseudo-transient continuation at a load factor from the work state, which moves along: eta grows on the blocks
    /// that stop the iteration and falls again as they come to rest. A step on the way need not be an equilibrium: the
    /// next one starts where it ends. The last one must be.
    Trial relax(double load_factor, const std::vector<int>& restless) {
        ++report_.costs.relaxations;
        std::vector<double> factor = work_.viscosity_factor;
        factor.resize(model_.system.blocks.size(), 1.0);
        (void)grow_eta(restless, factor);
        Trial last; // that the state moved to
        RelaxationProgress progress;
        for (int attempt = 0; attempt < max_relaxation_attempts; ++attempt) {
            if (course_.stop) throw Interrupted{};
            prepare();
            set_load(load_factor);
            factor.resize(model_.system.blocks.size(), 1.0);
            problem_.eta = factor;
            for (double& eta : problem_.eta) eta *= relaxation_eta();
            Trial trial;
            trial.q = work_.displacement;
            trial.summary = open_close_.solve(problem_, pattern_, trial.q, work_.contacts.empty(), Aim::relaxation);
            report_.costs.open_close_iterations += trial.summary.iterations;
            last_worst_block_ = trial.summary.worst_block;
            notify_progress(course_, load_factor, report_.costs.open_close_iterations);
            trial.viscous_share = viscous_share(trial);
            const double harmless = std::max(relaxed_tolerance * balance_, relaxed_residual * trial.viscous_share);
            if (!trial.converged() && trial.summary.residual_ratio > harmless) {
                if (!grow_eta(trial.summary.restless, factor)) {
                    throw no_equilibrium(trial.summary.worst_block, trial.summary.residual_ratio);
                }
                continue;
            }
            if (!trial.converged()) trial.viscous_share += trial.summary.residual_ratio;
            trial.balanced = trial.viscous_share <= balance_;
            if (trial.balanced) {
                work_.viscosity_factor = factor;
                return trial;
            }
            commit(trial, work_.load_factor);
            const bool moves_on = reduces_strengths() && !progress.falls(trial.viscous_share);
            if (moves_on || is_falling())
                throw no_equilibrium(trial.summary.worst_block, trial.viscous_share, nothing_holds());
            if (trial.summary.iterations <= easy_relaxation) decay(factor);
            last = std::move(trial);
        }
        if (last.q.size() == 0) throw no_equilibrium(last_worst_block_, last.summary.residual_ratio);
        if (course_.is_platen_loaded_by_stress()) { // the platen keeps moving: past the strength
            throw no_equilibrium(last.summary.worst_block, last.viscous_share);
        }
        return last;
    }

    /// False if nothing is left to grow.
    static bool grow_eta(const std::vector<int>& restless, std::vector<double>& factor) {
        bool grown = false;
        const auto grow = [&](double& f) {
            grown = grown || f < largest_relaxation;
            f = std::min(largest_relaxation, relaxation_growth * f);
        };
        for (const int b : restless) grow(factor[b]);
        if (restless.empty()) std::ranges::for_each(factor, grow);
        return grown;
    }

    /// Empty when nothing is left.
    static void decay(std::vector<double>& factor) {
        bool any = false;
        for (double& f : factor) {
            f = std::max(1.0, f / relaxation_decay);
            any = any || f > 1.0;
        }
        if (!any) factor.clear();
    }

    /// The place where the work state changes.
    void commit(const Trial& trial, double load_factor) {
        if (auto flaw = flaw_of_displacements(problem_, trial.q); !flaw.empty())
            throw LostEquilibrium{std::move(flaw), false};
        warn_of_lost_contact(trial.q);
        keep_histories(problem_, trial.q, work_);
        work_.displacement = trial.q;
        work_.load_factor = load_factor;
        work_.unbalanced_ratio = trial.viscous_share;
    }

    /// Once.
    void warn_of_lost_contact(const Eigen::VectorXd& q) {
        if (warned_of_lost_contact_) return;
        const std::string lost = lost_contact(problem_, q);
        if (lost.empty()) return;
        warned_of_lost_contact_ = true;
        report_.warnings.push_back(fmt::format("load step {}: a contact was lost, because {}", work_.step + 1, lost));
    }

    // ---- cracks ----------------------------------------------------------------------------------------------

    std::vector<CrackCandidate> candidates(const Eigen::VectorXd& q) {
        return check_cracks(course_, cracks_.criterion, bonded_, strengths_.strengths, problem_, q);
    }

    double largest_index_at(const Eigen::VectorXd& q) {
        return std::min(largest_useful_index, largest_index(candidates(q)));
    }

    /// Cuts the step at the load factor where the largest f is in [1, 1 + tolerance] (Illinois on the load factor);
    /// replaces `trial` and returns that load factor, or `to` if nothing fails before.
    double locate_event(double from, double to, Trial& trial) {
        const double tolerance = cracks_.event_tolerance;
        const double goal = is_adaptive() ? 1.0 : 1.0 + 0.5 * tolerance;
        const double reach = is_adaptive() ? tolerance : 0.5 * tolerance; // of f around the goal
        const double least_width = is_adaptive() ? least_event_width * accuracy_ : 0.0;
        event_width_ = std::numeric_limits<double>::infinity();
        double f_high = event_index(trial.q);
        if (f_high <= 1.0 + tolerance) return to;
        double low = from;
        double high = to;
        set_load(from); // the stresses of rigid blocks and reduced strengths follow the load
        double g_low = event_index(work_.displacement) - goal;
        set_load(to);
        double g_high = f_high - goal;
        if (g_low >= 0.0) return to;
        for (int i = 0; i < max_event_trials && high - low > least_width; ++i) {
            const double width = high - low;
            const double quick =
                std::clamp(high - g_high * width / (g_high - g_low), low + 0.01 * width, high - 0.01 * width);
            const double at = i < quick_event_trials ? quick : low + 0.5 * width;
            const double share = (at - from) / (high - from);
            Trial next = solve(at, work_.displacement + share * (trial.q - work_.displacement));
            if (!next.converged() || !next.balanced) {
                problem_.start = work_.displacement;
                break;
            }
            const double g = event_index(next.q) - goal;
            if (g >= -reach) {
                trial = std::move(next);
                high = at;
                if (g <= reach) break;
                g_high = g;
                g_low *= 0.5;
            } else {
                low = at;
                g_low = g;
                g_high *= 0.5;
            }
        }
        set_load(high);
        if (high - low <= least_width) event_width_ = high - low;
        return high;
    }

    /// Fails potential cracks and finds equilibrium again at the same load, until nothing fails. True if any failed.
    bool break_bonds(double load_factor) {
        bool any = false;
        for (;;) {
            const auto broken = breaking(candidates(work_.displacement), !any);
            if (broken.empty()) return any;
            any = true;
            weaken_together(course_, broken, course_.last_record.axial_strain);
            prepare();
            Trial trial = solve(load_factor, work_.displacement);
            if (!trial.balanced) trial = recover(trial, load_factor, load_factor);
            commit(trial, load_factor);
            record_equilibrium(trial);
        }
    }

    /// Those that fail together. At an event that was located around f = 1, the first time, all within its tolerance.
    [[nodiscard]] std::vector<CrackCandidate> breaking(const std::vector<CrackCandidate>& all, bool first) const {
        const bool around_one = first && is_adaptive() && cracks_.update == CrackUpdate::event;
        const double largest = largest_index(all);
        if (!around_one || largest > 1.0 + accuracy_) return chosen_to_fail(cracks_, all);
        return failing(all, 1.0 - accuracy_);
    }

    // ---- measurements and messages ---------------------------------------------------------------------------

    StepRecord measure(const Eigen::VectorXd& q, double share) {
        EquilibriumEvaluator(problem_, pattern_).residual(q, last_residual_);
        StepRecord record =
            measure_step(model_, course_.gauges, work_, problem_, *course_.loads, q, last_residual_.forces);
        record.open_close_iterations = report_.costs.open_close_iterations - iterations_at_start_;
        record.crack_passes = course_.passes;
        record.unbalanced_ratio = share;
        record.elapsed_s = course_.elapsed();
        if (reduction_of(model_.loads, 0) != nullptr)
            record.strength_factor = strength_factor(model_.loads, work_.stage, work_.load_factor);
        return record;
    }

    void record_equilibrium(const Trial& trial) {
        StepRecord& record = course_.last_record;
        record = measure(trial.q, trial.viscous_share);
        record.balanced = trial.balanced;
        step_balanced_ = step_balanced_ && trial.balanced;
        worst_share_ = std::max(worst_share_, trial.viscous_share);
        StepControl& control = work_.control;
        control.axial_stress = record.axial_stress;
        if (trial.balanced && std::abs(record.axial_stress) > control.largest_stress) {
            control.largest_stress = std::abs(record.axial_stress);
            control.stage_of_largest = work_.stage;
        }
        if (is_adaptive() && !prescribes_strain())
            control.largest_mean_stress =
                std::max(control.largest_mean_stress, weighted_stresses(problem_, trial.q).norm());
        notify_equilibrium(course_, record);
    }

    /// `nothing_holds`: the body, which has neither a support nor a platen.
    [[nodiscard]] LostEquilibrium no_equilibrium(int worst_block, double residual_ratio,
                                                 bool nothing_holds = false) const {
        std::string text = fmt::format("residual {:.2g} of the forces", residual_ratio);
        const double factor = strength_factor(model_.loads, work_.stage, tried_load_factor_);
        if (factor != 1.0) text += fmt::format("; with the strengths divided by {:.6g}", factor);
        if (nothing_holds) text += "; nothing holds the body, which has neither a support nor a platen";
        if (worst_block >= 0) text += "; worst is " + block_description(worst_block);
        return {text, !nothing_holds};
    }

    [[nodiscard]] std::string block_description(int index) const {
        const Block& block = model_.system.blocks[index];
        const Vec2 at = model_.system.origin + block.centroid;
        std::string text = fmt::format("block {} at ({:.6g}, {:.6g}), area {:.3g} m2, interfaces",
                                       block_label(model_.system, index), at.x(), at.y(), block.area);
        for (const Edge& edge : block.edges) {
            if (edge.interface >= 0) text += fmt::format(" {}", edge.interface);
        }
        return text;
    }

    const Model& model_;
    CrackOptions cracks_;
    const SolverOptions& options_;
    RunCourse course_;
    State& work_ = course_.work;         ///< at the last equilibrium
    RunReport& report_ = course_.report; ///< so far

    LinearSolver linear_;
    OpenCloseSolver open_close_;
    std::vector<char> bonded_; ///< per interface of the work state
    BlockPattern pattern_;
    ReducedStrengths strengths_; ///< of the load in place
    EquilibriumProblem problem_;
    Residual last_residual_;
    int iterations_at_start_ = 0;
    double tried_load_factor_ = 0.0;
    bool warned_of_lost_contact_ = false;
    double stress_lost_ = 0.0; ///< since the peak of the stage in progress, relative
    bool step_balanced_ = true;
    double worst_share_ = 0.0;
    int last_worst_block_ = -1;
    double balance_ = 0.0;        ///< of the stage
    double accuracy_ = 0.0;       ///< of the load step in progress
    double event_width_ = 0.0;    ///< load factors that enclose the last event where f jumps there; infinite elsewhere
    double rest_share_ = 0.0;     ///< of the mass-like term: with reduced strengths a body with less rests
    int steps_with_contacts_ = 0; ///< load steps with the contacts in place since they were detected
    bool seeks_failure_ = false;  ///< of potential cracks, in the load step in progress
    LostEquilibrium last_failure_;
    LoadSteps steps_;
};

} // namespace

State initial_state(const Model& model) {
    State state;
    const auto n = static_cast<Eigen::Index>(n_block_unknowns) * model.system.n_blocks();
    state.displacement = Eigen::VectorXd::Zero(n);
    state.stage_start_displacement = state.displacement;
    state.reference_displacement = state.displacement;
    for (const Interface& interface : model.system.interfaces) {
        state.interfaces.push_back(model.bonds[interface.interface_type] ? InterfaceStatus::potential_crack
                                                                         : InterfaceStatus::fracture);
    }
    state.bond_shear.assign(static_cast<std::size_t>(n_bond_points) * model.system.interfaces.size(), 0.0);
    state.boundary_pressure.assign(model.system.boundaries.size(), 0.0);
    return state;
}

RunReport run_simulation(const Model& model, const CrackOptions& cracks, const SolverOptions& solver, State& state,
                         StepObserver& observer, const std::atomic<bool>& stop) {
    if (solver.repeatable) set_blas_threads(1);
    return Run(model, cracks, solver, state, observer, stop).run();
}

} // namespace kluft
