#include "kluft/reference/explicit_simulation.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "kluft/core/stopwatch.hpp"
#include "kluft/fracture/crack_check.hpp"
#include "kluft/reference/block_inertia.hpp"
#include "kluft/reference/explicit_motion.hpp"
#include "kluft/simulation/measurements.hpp"
#include "kluft/simulation/run_course.hpp"
#include "kluft/simulation/state_check.hpp"
#include "kluft/simulation/state_points.hpp"
#include "kluft/simulation/weakening.hpp"

namespace kluft {

namespace {

constexpr double crossings_per_step = 10.0; ///< of the body by a wave, while the load of a load step moves
constexpr double crossings_per_stage = 100.0;
constexpr double longest_wait = 20.0; ///< of the time in which the load moves
constexpr double slowest_load = 0.02; ///< of its usual rate
constexpr double reference_balance =
    0.1; ///< of `balance`: a load step slows down above it and waits for it, to be a reference
constexpr double detection_motion = 5e-3; ///< of a block between two detections, in lattice spacings
constexpr double wildest_motion = 0.1;    ///< of a block in one time step, in lattice spacings
constexpr double collapse_motion = 0.5;   ///< of a block in one load step that is loaded by stress, in lattice spacings
constexpr int watch_interval = 10;        ///< time steps between two looks at the motion
constexpr int progress_interval = 1000;   ///< time steps

/// From 0 to 1 without a jump of the velocity at the ends.
double smooth(double x) { return x * x * (3.0 - 2.0 * x); }

class ExplicitRun {
public:
    ExplicitRun(const Model& model, const CrackOptions& cracks, const SolverOptions& solver,
                const ExplicitOptions& options, State& state, StepObserver& observer, const std::atomic<bool>& stop)
        : model_(model), cracks_(cracks), solver_(solver), options_(options), course_(model, state, observer, stop),
          motion_(loaded_body(), block_masses(model, options.density_scaling), options.damping, state.displacement),
          crossing_time_(crossing_time(model, block_masses(model, options.density_scaling))),
          detected_at_(state.displacement) {
        extents_.reserve(model.system.blocks.size());
        for (const Block& block : model.system.blocks) extents_.push_back(largest_coordinate(block));
    }

    RunReport run() {
        LoadSteps steps;
        steps.begin_stage = [this] { begin_stage(); };
        steps.initial_record = [this] {
            set_load(0.0);
            return measure();
        };
        steps.load_step = [this](double target, bool) { return load_step(target); };
        steps.look_back = [this](const StepRecord& record) { look_back(record); };
        steps.end_stage = [this] {
            leave_stage(model_, *course_.loads, motion_.body(), motion_.evaluate().forces, work_);
        };
        steps.costs = [this] {
            RunCosts costs = report_.costs;
            costs.elapsed_s = course_.elapsed();
            return costs;
        };
        steps.fields = [this] { return field_record(model_, work_, motion_.body()); };
        RunReport report = run_stages(course_, steps);
        report.motion = MotionReport{time_steps_, motion_.time_step(), worst_energy_error_};
        return report;
    }

private:
    [[nodiscard]] LoadedBody loaded_body() const {
        LoadedBody body;
        body.system = &model_.system;
        body.moduli = &model_.moduli;
        body.laws = &model_.laws;
        if (has_gravity(model_)) body.densities = model_.densities;
        return body;
    }

    [[nodiscard]] double largest_coordinate(const Block& block) const {
        double largest = 0.0;
        for (const Edge& edge : block.edges)
            largest = std::max(largest, block_coordinates(block, edge_start(model_.system, edge)).norm());
        return largest;
    }

    // ---- load steps ------------------------------------------------------------------------------------------

    void begin_stage() {
        motion_.body().constraints = course_.loads->constraints();
        motion_.body().pressure_edges = course_.loads->edges();
        motion_.add_detection_energy(detect());
        if (has_platen_velocity() && platen_time() < motion_.time_step()) {
            report_.warnings.push_back(fmt::format(
                "stage {}: the platen is slower than loading_rate, since a load step takes one time step at "
                "least; expected {:g} steps or fewer",
                work_.stage, std::floor(course_.stage().steps * platen_time() / motion_.time_step())));
        }
    }

    void set_load(double load_factor) {
        apply_load(model_, *course_.loads, work_.stage, load_factor, motion_.body());
        work_.load_factor = load_factor;
    }

    StepRecord load_step(double to) {
        const double from = static_cast<double>(work_.step_in_stage) / course_.stage().steps;
        const bool steady = has_platen_velocity();
        const double duration = steady ? platen_time() : load_time();
        move_load(from, to, duration, steady);
        if (!steady) wait(longest_wait * duration);
        set_load(to);
        keep_state();
        StepRecord record = measure();
        record.load_factor = to;
        notify_equilibrium(course_, record);
        work_.unbalanced_ratio = record.unbalanced_ratio;
        return record;
    }

    /// A platen of constant velocity waits for nothing, so that its load steps may be unbalanced.
    void look_back(const StepRecord& record) const {
        if (has_platen_velocity()) return;
        const bool past_strength = !record.balanced && course_.is_platen_loaded_by_stress();
        if (past_strength || work_.unbalanced_in_succession >= solver_.max_unbalanced_steps)
            throw LostEquilibrium{fmt::format("the unbalanced force is {:.2g} of the forces", record.unbalanced_ratio),
                                  true};
    }

    [[nodiscard]] bool has_platen_velocity() const {
        const auto& motion = course_.stage().motion;
        return options_.loading_rate > 0.0 && motion && motion->control != PlatenControl::stress;
    }

    [[nodiscard]] double load_time() const {
        const int steps = course_.stage().steps;
        return std::max(crossings_per_step, crossings_per_stage / steps) * crossing_time_;
    }

    [[nodiscard]] double platen_time() const {
        const Stage& stage = course_.stage();
        double distance = std::abs(stage.motion->value);
        if (stage.motion->control == PlatenControl::strain) distance *= platen_distance(model_, *stage.motion);
        return distance / (stage.steps * options_.loading_rate);
    }

    static double platen_distance(const Model& model, const PlatenMotion& motion) {
        const Vec2 normal = boundary_frame(model.system, motion.boundary).normal;
        const int fixed = opposite_boundary(model.system, motion.boundary);
        const Vec2 base = fixed >= 0 ? mean_position(model.system, fixed) : model.system.lower;
        return std::abs(normal.dot(mean_position(model.system, motion.boundary) - base));
    }

    // ---- time steps ------------------------------------------------------------------------------------------

    void move_load(double from, double to, double duration, bool steady) {
        double done = 0.0;
        double passed = 0.0;
        while (done < 1.0) {
            const bool patient = !steady && passed < longest_wait * duration;
            const double rate = patient ? load_rate_ : 1.0;
            done = std::min(1.0, done + rate * motion_.time_step() / duration);
            passed += motion_.time_step();
            set_load(from + (to - from) * (steady ? done : smooth(done)));
            advance();
        }
        set_load(to);
    }

    void wait(double longest) {
        const double balance = reference_balance * solver_.balance;
        for (double passed = 0.0; passed < longest; passed += motion_.time_step()) {
            advance();
            if (time_steps_ % watch_interval == 0 && force_ratio() <= balance && is_at_rest(balance)) return;
        }
    }

    void advance() {
        {
            const Stopwatch watch(report_.costs.seconds.assembly);
            motion_.advance();
        }
        ++time_steps_;
        if (time_steps_ % watch_interval == 0) watch_motion();
        if (model_.has_potential_cracks && time_steps_ % options_.crack_check_interval == 0) break_bonds();
        if (time_steps_ % progress_interval == 0) report_progress();
    }

    [[nodiscard]] double force_ratio() const { return motion_.unbalanced_force() / std::max(force_scale_, 1e-300); }

    /// Kinetic energy is that of an oscillation whose forces are this part of the elastic ones, or less.
    [[nodiscard]] bool is_at_rest(double balance) { return kinetic_ratio(motion_.energies()) <= balance * balance; }

    static double kinetic_ratio(const EnergyBalance& energy) {
        return energy.kinetic_energy / std::max(energy.strain_energy(), 1e-300);
    }

    void watch_motion() {
        if (course_.stop) throw Interrupted{};
        if (time_steps_ % (10 * watch_interval) == 0 || force_scale_ == 0.0)
            force_scale_ = motion_.evaluate().magnitudes.norm();
        load_rate_ =
            std::clamp(reference_balance * solver_.balance / std::max(force_ratio(), 1e-300), slowest_load, 1.0);
        const double spacing = model_.system.spacing;
        const double fastest = largest_motion(motion_.velocity()) * motion_.time_step();
        if (!std::isfinite(motion_.unbalanced_force()) || !(fastest < wildest_motion * spacing))
            throw LostEquilibrium{fmt::format("after {} time steps blocks move without limit", time_steps_), true};
        if (course_.is_loaded_by_stress() &&
            largest_motion(motion_.displacement() - course_.accepted.displacement) > collapse_motion * spacing)
            throw LostEquilibrium{"the body falls or flows", true};
        if (largest_motion(motion_.displacement() - detected_at_) > detection_motion * spacing) {
            keep_state();
            motion_.add_detection_energy(detect());
        }
    }

    /// Of any point of a block; NaN and infinity come out as infinity.
    [[nodiscard]] double largest_motion(const Eigen::VectorXd& change) const {
        double largest = 0.0;
        for (int b = 0; b < model_.system.n_blocks(); ++b) {
            const auto moved = change.segment<n_block_unknowns>(n_block_unknowns * b);
            const double size = moved.head<2>().norm() + extents_[b] * moved.tail<4>().norm();
            if (!std::isfinite(size)) return std::numeric_limits<double>::infinity();
            largest = std::max(largest, size);
        }
        return largest;
    }

    /// The place where the work state gets displacements and histories.
    void keep_state() {
        (void)motion_.evaluate();
        if (auto flaw = flaw_of_displacements(motion_.body(), motion_.displacement()); !flaw.empty())
            throw LostEquilibrium{std::move(flaw), false};
        work_.displacement = motion_.displacement();
        keep_histories(motion_.body(), work_.displacement, work_);
    }

    /// Contacts and frames of the work state. Returns the elastic energy that the springs lost by that (J/m).
    double detect() {
        const Stopwatch watch(report_.costs.seconds.detection);
        const double before = motion_.springs_energy();
        bonded_ = bonded_interfaces(work_);
        place_bonds(model_, work_, motion_.body().bonds);
        motion_.body().contacts = state_contacts(model_, work_).points;
        motion_.restart();
        detected_at_ = motion_.displacement();
        ++report_.detections;
        return before - motion_.springs_energy();
    }

    // ---- cracks ----------------------------------------------------------------------------------------------

    void break_bonds() {
        const auto broken = chosen_to_fail(cracks_, check_cracks(course_, cracks_.criterion, bonded_, model_.strengths,
                                                                 motion_.body(), motion_.displacement()));
        if (broken.empty()) return;
        if (!std::isfinite(motion_.unbalanced_force())) return; // watch_motion ends the run
        keep_state();
        const StepRecord before = measure();
        if (before.balanced) notify_equilibrium(course_, before);
        double energy = energy_of_interfaces(broken);
        weaken_together(course_, broken, before.axial_strain);
        const double lost = detect();
        energy -= energy_of_interfaces(broken);
        motion_.add_crack_energy(energy);
        motion_.add_detection_energy(lost - energy);
    }

    /// Elastic energy of the springs of these interfaces, bonded or not.
    [[nodiscard]] double energy_of_interfaces(const std::vector<CrackCandidate>& candidates) const {
        const LoadedBody& body = motion_.body();
        const auto concerns = [&](int interface) {
            return std::ranges::find(candidates, interface, &CrackCandidate::interface) != candidates.end();
        };
        double energy = 0.0;
        for (const Bond& bond : body.bonds)
            if (concerns(bond.interface)) energy += bond_energy(body, bond, motion_.displacement());
        for (const ContactPoint& point : body.contacts)
            if (point.interface >= 0 && concerns(point.interface))
                energy += contact_energy(body, point, motion_.displacement());
        return energy;
    }

    // ---- measurements and messages ---------------------------------------------------------------------------

    StepRecord measure() {
        const BodyForces forces = motion_.evaluate();
        force_scale_ = forces.magnitudes.norm();
        StepRecord record = measure_step(model_, course_.gauges, work_, motion_.body(), *course_.loads,
                                         motion_.displacement(), forces.forces);
        const EnergyBalance energy = motion_.energies();
        MotionRecord motion;
        motion.time_steps = static_cast<double>(time_steps_);
        motion.kinetic_ratio = energy.strain_energy() > 0.0 ? kinetic_ratio(energy) : 0.0;
        motion.platen_imbalance = platen_imbalance(forces.forces);
        motion.external_work = energy.external_work;
        motion.strain_energy = energy.strain_energy();
        motion.kinetic_energy = energy.kinetic_energy;
        motion.friction_energy = energy.friction_energy;
        motion.damping_energy = energy.damping_energy;
        motion.crack_energy = energy.crack_energy;
        motion.detection_energy = energy.detection_energy;
        motion.energy_error = energy.error();
        worst_energy_error_ = std::max(worst_energy_error_, std::abs(motion.energy_error));
        record.motion = motion;
        record.unbalanced_ratio = time_steps_ > 0 ? force_ratio() : 0.0;
        record.balanced = record.unbalanced_ratio <= solver_.balance;
        record.crack_passes = course_.passes;
        record.elapsed_s = course_.elapsed();
        if (!std::isfinite(record.axial_stress) || !std::isfinite(energy.external_work))
            throw LostEquilibrium{fmt::format("after {} time steps the displacements are no numbers", time_steps_)};
        return record;
    }

    /// Difference of the forces on the moved and the opposite boundary over the larger one.
    [[nodiscard]] double platen_imbalance(const Eigen::VectorXd& forces) const {
        const Gauges& gauges = course_.gauges;
        if (gauges.moved < 0 || gauges.opposite < 0) return 0.0;
        const auto force_on = [&](int boundary) {
            const BoundaryFrame frame = boundary_frame(model_.system, boundary);
            return frame.length * boundary_stress(motion_.body(), forces, boundary, course_.loads->is_held(boundary),
                                                  frame.length, frame.normal);
        };
        const double a = force_on(gauges.moved);
        const double b = force_on(gauges.opposite);
        const double larger = std::max(std::abs(a), std::abs(b));
        return larger > 0.0 ? std::abs(a - b) / larger : 0.0;
    }

    void report_progress() { notify_progress(course_, work_.load_factor, static_cast<int>(time_steps_)); }

    const Model& model_;
    const CrackOptions& cracks_;
    const SolverOptions& solver_;
    const ExplicitOptions& options_;
    RunCourse course_;
    State& work_ = course_.work;         ///< where the body was when its state was last kept
    RunReport& report_ = course_.report; ///< so far

    ExplicitMotion motion_;
    double crossing_time_;
    Eigen::VectorXd detected_at_;
    std::vector<double> extents_; ///< largest distance from the centroid in block coordinates, per block
    std::vector<char> bonded_;    ///< per interface of the work state
    long time_steps_ = 0;
    double load_rate_ = 1.0;
    double force_scale_ = 0.0;
    double worst_energy_error_ = 0.0;
};

} // namespace

RunReport run_explicit(const Model& model, const CrackOptions& cracks, const SolverOptions& solver,
                       const ExplicitOptions& options, State& state, StepObserver& observer,
                       const std::atomic<bool>& stop) {
    return ExplicitRun(model, cracks, solver, options, state, observer, stop).run();
}

} // namespace kluft
