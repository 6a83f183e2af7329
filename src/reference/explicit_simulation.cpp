#include "kluft/reference/explicit_simulation.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "kluft/core/memory.hpp"
#include "kluft/core/stopwatch.hpp"
#include "kluft/fracture/crack_check.hpp"
#include "kluft/loading/block_balance.hpp"
#include "kluft/loading/boundary_geometry.hpp"
#include "kluft/loading/stored_energy.hpp"
#include "kluft/reference/block_inertia.hpp"
#include "kluft/reference/explicit_motion.hpp"
#include "kluft/simulation/causes.hpp"
#include "kluft/simulation/event_search.hpp"
#include "kluft/simulation/journal.hpp"
#include "kluft/simulation/measurements.hpp"
#include "kluft/simulation/placement.hpp"
#include "kluft/simulation/stage_loads.hpp"
#include "kluft/simulation/state_check.hpp"
#include "kluft/simulation/step.hpp"
#include "kluft/simulation/stress_drop.hpp"
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
constexpr double much_left_over =
    100.0; ///< of `balance`: at the end of a stage that waits for nothing, a block that keeps more is warned of
constexpr int watch_interval = 10;      ///< time steps between two looks at the motion
constexpr int progress_interval = 1000; ///< time steps

/// From 0 to 1 without a jump of the velocity at the ends.
double smooth(double x) { return x * x * (3.0 - 2.0 * x); }

bool has_platen_velocity(const Stage& stage, const ExplicitOptions& options) {
    return options.loading_rate > 0.0 && stage.motion && stage.motion->control != PlatenControl::stress;
}

/// In which the load of a load step moves (s).
double load_time(const Stage& stage, double crossing) {
    return std::max(crossings_per_step, crossings_per_stage / stage.steps) * crossing;
}

/// In which a platen of constant velocity moves by what a load step asks for (s).
double platen_time(const Model& model, const Stage& stage, const ExplicitOptions& options) {
    double distance = std::abs(stage.motion->value);
    if (stage.motion->control == PlatenControl::strain)
        distance *= distance_across(model.system, stage.motion->boundary);
    return distance / (stage.steps * options.loading_rate);
}

class ExplicitRun {
public:
    ExplicitRun(const Model& model, const CrackOptions& cracks, const SolverOptions& solver,
                const ExplicitOptions& options, State& state, StepObserver& observer, const std::atomic<bool>& stop)
        : model_(model), cracks_(cracks), solver_(solver), options_(options), state_(state), stop_(stop),
          journal_(model, state, observer, number_of_steps(model)),
          motion_(body_of(model), {}, {}, block_masses(model, options.density_scaling), options.damping,
                  state.body.displacement),
          crossing_time_(crossing_time(model, block_masses(model, options.density_scaling))),
          detected_at_(state.body.displacement) {
        extents_.reserve(model.system.blocks.size());
        for (const Block& block : model.system.blocks) extents_.push_back(largest_coordinate(block));
    }

    RunReport run() {
        RunReport report = report_of(journal_, [this] {
            for (;;) {
                const StageLoads loads = enter_stage(model_, state_);
                loads_ = &loads;
                begin_stage();
                StageEnd end = run_stage();
                const bool last = state_.at.stage + 1 == static_cast<int>(model_.loads.stages.size());
                const bool unbalanced = !has_platen_velocity() && state_.unbalanced_in_succession > 0;
                end.causes = causes_of(end);
                if (end.ends_run() || last || unbalanced) return journal_.ended(state_, end);
                state_.body.holding_forces = holding_forces(model_, loads, motion_.loads(), motion_.evaluate().forces);
                leave_stage(model_, loads, motion_.loads(), state_);
                state_.costs = journal_.costs();
            }
        });
        warn_of_late_checks(report);
        report.motion = MotionReport{time_steps_, motion_.time_step(), worst_energy_error_};
        if (report.status == RunStatus::interrupted)
            report.diagnosis =
                "an explicit run does not go on from its saved state, which has no velocities: it is run anew";
        return report;
    }

private:
    [[nodiscard]] static LoadedBody body_of(const Model& model) {
        LoadedBody body;
        body.system = &model.system;
        body.moduli = &model.moduli;
        body.laws = &model.laws;
        body.densities = has_gravity(model) ? &model.densities : nullptr;
        return body;
    }

    [[nodiscard]] double largest_coordinate(const Block& block) const {
        double largest = 0.0;
        for (const Edge& edge : block.edges)
            largest = std::max(largest, block_coordinates(block, edge_start(model_.system, edge)).norm());
        return largest;
    }

    // ---- load steps ------------------------------------------------------------------------------------------

    [[nodiscard]] const Stage& stage() const { return model_.loads.stages[state_.at.stage]; }
    [[nodiscard]] State& work() { return step_.end; }
    [[nodiscard]] bool failed() const { return step_.failure.has_value(); }
    void fail(FailureKind kind, std::string what) { step_.failure = Failure{.kind = kind, .what = std::move(what)}; }

    [[nodiscard]] Failure failure_of(FailureKind kind, std::vector<MovingBlock> moving) const {
        return {.kind = kind,
                .residual_ratio = force_ratio(),
                .load_factor = step_.end.at.load_factor,
                .nothing_holds = loads_->constraints().rows().empty(),
                .moving = std::move(moving)};
    }

    /// What the loads say of why a stage has ended out of balance.
    [[nodiscard]] std::vector<std::string> causes_of(const StageEnd& end) {
        if (!end.failure && state_.unbalanced_in_succession == 0) return {};
        return likely_causes(model_, {motion_.loads(), model_.laws, state_.at.load_factor, 1.0},
                             end.failure ? end.failure->moving : state_.imbalance.moving);
    }

    void begin_stage() {
        begin_step();
        PlatenHold hold = hold_of(model_, *loads_, work().body);
        motion_.loads().constraints = std::move(hold.constraints);
        motion_.loads().platens = loads_->platens();
        motion_.loads().platen_points = std::move(hold.points);
        motion_.loads().friction = std::move(hold.friction);
        motion_.loads().pressure_edges = loads_->edges();
        motion_.add_detection_energy(detect());
        if (has_platen_velocity() && platen_time() < motion_.time_step()) {
            journal_.report().warnings.push_back(fmt::format(
                "stage {}: the platen is slower than loading_rate, since a load step takes one time step at "
                "least; expected {:g} steps or fewer",
                state_.at.stage, std::floor(stage().steps * platen_time() / motion_.time_step())));
        }
        if (state_.at.step > 0 || state_.at.stage > 0) return;
        set_load(0.0);
        const StepRecord row = measure({});
        journal_.begin(row, state_, in_place());
    }

    StageEnd run_stage() {
        StageEnd end;
        while (!end.ends_run() && state_.at.step_in_stage < stage().steps) {
            const bool last = state_.at.step_in_stage + 1 == stage().steps;
            take_step(static_cast<double>(state_.at.step_in_stage + 1) / stage().steps);
            if (failed()) {
                keep_balanced_part(step_);
                return commit_balanced_part(std::move(step_), state_, journal_);
            }
            const StepRecord row = step_.row;
            end.has_dropped = row.balanced && has_dropped(stage(), step_.end.stresses);
            const bool ends = last || end.has_dropped;
            if (ends && has_platen_velocity()) warn_of_motion();
            commit(std::move(step_), {.last_of_stage = ends}, state_, journal_);
            end.failure = failure_after(row);
            end.step = state_.at.step;
        }
        return end;
    }

    void set_load(double load_factor) {
        move_loads(model_, *loads_, state_.at.stage, load_factor, motion_.loads());
        work().at.load_factor = load_factor;
    }

    void begin_step() {
        step_ = Step{};
        step_.end = state_;
        step_.row = journal_.last_row();
        step_.balanced_part =
            Step::BalancedPart{.body = state_.body, .load_factor = state_.at.load_factor, .stresses = state_.stresses};
    }

    void take_step(double to) {
        begin_step();
        if (has_moved_since_detection()) motion_.add_detection_energy(detect());
        const double from = static_cast<double>(state_.at.step_in_stage) / stage().steps;
        const bool steady = has_platen_velocity();
        const double duration = steady ? platen_time() : load_time();
        look_ = {};
        move_load(from, to, duration, steady);
        const bool rests = !steady && wait(longest_wait * duration);
        if (failed()) return;
        set_load(to);
        keep_state();
        if (failed()) return;
        if (model_.has_potential_cracks) (void)candidates(); // however long the interval of the checks is
        const BlockVerdict verdict = rests ? look_.verdict : verdict_without_rest();
        step_.row = measure(verdict);
        if (!step_.row.balanced) step_.moving = moving_blocks(verdict);
        step_.row.load_factor = to;
        keep_equilibrium(step_.row);
        step_.balanced = step_.row.balanced;
        step_.worst_share = step_.row.unbalanced_ratio;
        step_.in_place = in_place();
    }

    void keep_equilibrium(const StepRecord& row) {
        note_axial_stress(stage(), row, work().stresses);
        step_.equilibria.push_back(row);
    }

    /// A copy of what the fields of the state follow from.
    [[nodiscard]] LoadedPlacement in_place() {
        return {motion_.placement(), {motion_.loads(), model_.laws, work().at.load_factor, 1.0}};
    }

    /// A platen of constant velocity waits for nothing, so that its load steps may be unbalanced.
    [[nodiscard]] std::optional<Failure> failure_after(const StepRecord& row) const {
        if (has_platen_velocity()) return std::nullopt;
        const bool past_strength = !row.balanced && is_platen_loaded_by_stress(stage());
        if (!past_strength && state_.unbalanced_in_succession < solver_.max_unbalanced_steps) return std::nullopt;
        return failure_of(FailureKind::no_equilibrium, state_.imbalance.moving);
    }

    [[nodiscard]] bool has_platen_velocity() const { return kluft::has_platen_velocity(stage(), options_); }
    [[nodiscard]] double load_time() const { return kluft::load_time(stage(), crossing_time_); }
    [[nodiscard]] double platen_time() const { return kluft::platen_time(model_, stage(), options_); }

    // ---- time steps ------------------------------------------------------------------------------------------

    void move_load(double from, double to, double duration, bool steady) {
        double done = 0.0;
        while (done < 1.0 && !failed()) {
            const double rate = steady ? 1.0 : load_rate_;
            done = std::min(1.0, done + rate * motion_.time_step() / duration);
            load_share_ = done;
            set_load(from + (to - from) * (steady ? done : smooth(done)));
            advance();
        }
        if (!failed()) set_load(to);
    }

    /// For the body and each of its blocks to come to rest; false where they do not.
    bool wait(double longest) {
        const double balance = reference_balance * solver_.balance;
        for (double passed = 0.0; passed < longest && !failed(); passed += motion_.time_step()) {
            advance();
            if (failed() || time_steps_ % watch_interval != 0) continue;
            if (force_ratio() <= balance && is_at_rest(balance) && look_at_blocks()) return true;
        }
        return false;
    }

    [[nodiscard]] BlockBalance blocks_now() const {
        return affine_block_balance(motion_.body(), motion_.displacement());
    }
    [[nodiscard]] BlockGoal block_goal() const { return {.share = solver_.balance}; }

    /// Whether they are at rest: balanced now and in the look before, since a block that swings is balanced for a moment
    /// where it passes its equilibrium.
    bool look_at_blocks() {
        const bool balanced_before = look_.is_taken() && look_.verdict.balanced();
        BlockBalance blocks = blocks_now();
        look_.verdict = judge_blocks(blocks, look_.is_taken() ? &look_.blocks : nullptr, block_goal());
        look_.blocks = std::move(blocks);
        return balanced_before && look_.verdict.balanced();
    }

    /// Of the blocks now, or of those that the last look has found in motion.
    [[nodiscard]] BlockVerdict verdict_without_rest() {
        BlockVerdict before = look_.verdict;
        look_at_blocks();
        return look_.verdict.balanced() && !before.balanced() ? before : look_.verdict;
    }

    /// Those of the verdict; where it names none, since a body drifts or swings as a whole, the fastest one.
    [[nodiscard]] std::vector<MovingBlock> moving_blocks(const BlockVerdict& verdict) const {
        std::vector<MovingBlock> moving = verdict.moving;
        if (moving.empty()) moving = fastest_block();
        return moving_on(model_.system, state_.body.displacement, motion_.displacement(), std::move(moving));
    }

    /// Empty where nothing moves.
    [[nodiscard]] std::vector<MovingBlock> fastest_block() const {
        MovingBlock fastest;
        double speed = 0.0;
        for (int b = 0; b < model_.system.n_blocks(); ++b) {
            const Vec2 velocity = motion_.velocity().segment<2>(n_block_unknowns * b);
            if (!(velocity.norm() > speed)) continue;
            speed = velocity.norm();
            fastest = {b, velocity / speed, 0};
        }
        return speed > 0.0 ? std::vector{fastest} : std::vector<MovingBlock>{};
    }

    void advance() {
        {
            const Stopwatch watch(journal_.report().costs.seconds.assembly);
            motion_.advance();
        }
        ++time_steps_;
        if (time_steps_ % watch_interval == 0) {
            motion_.update_platens();
            watch_motion();
        }
        if (failed()) return;
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
        if (stop_) throw Interrupted{};
        require_memory();
        if (time_steps_ % (10 * watch_interval) == 0 || force_scale_ == 0.0)
            force_scale_ = motion_.evaluate().magnitudes.norm();
        load_rate_ =
            std::clamp(reference_balance * solver_.balance / std::max(force_ratio(), 1e-300), slowest_load, 1.0);
        const double spacing = model_.system.spacing;
        const double fastest = largest_motion(motion_.velocity()) * motion_.time_step();
        if (!std::isfinite(motion_.unbalanced_force()) || !(fastest < wildest_motion * spacing))
            return fail(FailureKind::falling,
                        fmt::format("after {} time steps blocks move without limit", time_steps_));
        if (is_loaded_by_stress(stage()) &&
            largest_motion(motion_.displacement() - state_.body.displacement) > collapse_motion * spacing)
            return fail_by_falling();
        if (largest_motion(motion_.displacement() - detected_at_) > detection_motion * spacing) {
            keep_state();
            if (!failed()) motion_.add_detection_energy(detect());
        }
    }

    void fail_by_falling() {
        (void)motion_.evaluate();
        step_.failure =
            failure_of(FailureKind::falling, moving_blocks(judge_blocks(blocks_now(), nullptr, block_goal())));
    }

    /// Nothing has waited for the blocks to come to rest, so that one may fall at the end of the stage.
    void warn_of_motion() {
        const BlockVerdict verdict = judge_blocks(blocks_now(), nullptr, {.share = much_left_over * solver_.balance});
        if (verdict.balanced()) return;
        journal_.report().warnings.push_back(fmt::format("stage {} ends in motion, since a platen with loading_rate "
                                                         "waits for nothing; out of balance by {:.2g} of its "
                                                         "own force, {}",
                                                         state_.at.stage, verdict.error,
                                                         description(model_, moving_blocks(verdict))));
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
            return fail(FailureKind::broken_body, std::move(flaw));
        work().body.displacement = motion_.displacement();
        keep_slips(model_.system, motion_.displacement(), motion_.loads().platens, motion_.loads().platen_points);
        work().body.platen_points = motion_.loads().platen_points;
        keep_histories(motion_.body(), work().body.displacement, work().body);
    }

    /// Even by less than detection_motion, which is centimetres of large blocks: a corner that has gone from a face presses on
    /// it until contacts are detected.
    [[nodiscard]] bool has_moved_since_detection() const { return motion_.displacement() != detected_at_; }

    /// Contacts and frames of the work state. Returns the elastic energy that the springs lost by that (J/m).
    double detect() {
        const Stopwatch watch(journal_.report().costs.seconds.detection);
        const double before = motion_.springs_energy();
        motion_.placement().bonds = placed_bonds(model_, work().body);
        motion_.placement().contacts = detected_contacts(model_, work().body, true).points;
        add_near_points(model_.system, motion_.displacement(), contact_reach * model_.system.spacing, motion_.loads());
        motion_.restart();
        detected_at_ = motion_.displacement();
        ++journal_.report().detections;
        return before - motion_.springs_energy();
    }

    // ---- cracks ----------------------------------------------------------------------------------------------

    /// The step keeps the largest index of all its checks.
    [[nodiscard]] std::vector<CrackCandidate> candidates() {
        const Stopwatch watch(journal_.report().costs.seconds.crack_check);
        ++journal_.report().crack_checks;
        auto all = check_cracks(model_, cracks_.criterion, work(), 1.0, motion_.body(), motion_.displacement());
        step_.checked_index = std::max(step_.checked_index, std::min(largest_useful_index, largest_index(all)));
        return all;
    }

    void warn_of_late_checks(RunReport& report) const {
        const int interval = options_.crack_check_interval;
        if (interval <= 1) return;
        std::string warning = warning_of_late_checks(
            journal_.largest_checked(),
            fmt::format("only one time step in {} checks them (analysis.crack_check_interval)", interval),
            "analysis.crack_check_interval, made smaller,");
        if (!warning.empty()) report.warnings.push_back(std::move(warning));
    }

    void break_bonds() {
        const auto broken = chosen_to_fail(cracks_, candidates());
        if (broken.empty()) return;
        if (!std::isfinite(motion_.unbalanced_force())) return; // watch_motion ends the run
        keep_state();
        if (failed()) return;
        const StepRecord before = measure(judge_blocks(blocks_now(), nullptr, block_goal()));
        if (failed()) return;
        if (before.balanced) keep_equilibrium(before);
        double energy = energy_of_interfaces(broken);
        weaken_together(model_, broken, before.axial_strain, step_);
        if (before.balanced)
            step_.balanced_part = Step::BalancedPart{.body = work().body,
                                                     .load_factor = work().at.load_factor,
                                                     .in_place = in_place(),
                                                     .stresses = work().stresses,
                                                     .n_equilibria = step_.equilibria.size(),
                                                     .n_cracks = step_.cracks.size()};
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
        for (const Bond& bond : body.placement->bonds)
            if (concerns(bond.interface)) energy += bond_energy(body, bond, motion_.displacement());
        for (const ContactPoint& point : body.placement->contacts)
            if (point.interface >= 0 && concerns(point.interface))
                energy += contact_energy(body, point, motion_.displacement());
        return energy;
    }

    // ---- measurements and messages ---------------------------------------------------------------------------

    /// Where the platen waits for nothing, only the body as a whole is asked to be in balance.
    StepRecord measure(const BlockVerdict& verdict) {
        const BodyForces forces = motion_.evaluate();
        force_scale_ = forces.magnitudes.norm();
        StepRecord record = measure_step(model_, journal_.gauges(), work(), motion_.body(), *loads_,
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
        record.balance_error = verdict.error;
        record.balanced = record.unbalanced_ratio <= solver_.balance && (has_platen_velocity() || verdict.balanced());
        record.crack_passes = step_.crack_passes;
        record.elapsed_s = journal_.elapsed();
        if (!std::isfinite(record.axial_stress) || !std::isfinite(energy.external_work))
            fail(FailureKind::broken_body,
                 fmt::format("after {} time steps the displacements are no numbers", time_steps_));
        return record;
    }

    /// Difference of the forces on the moved and the opposite boundary over the larger one.
    [[nodiscard]] double platen_imbalance(const Eigen::VectorXd& forces) const {
        const Gauges& gauges = journal_.gauges();
        if (gauges.moved < 0 || gauges.opposite < 0) return 0.0;
        const auto force_on = [&](int boundary) {
            const Loads& loads = *motion_.body().loads;
            return loads_->is_held(boundary)
                       ? holding_force(model_.system, loads, forces, boundary)
                       : boundary_frame(model_.system, boundary).length * loads.pressures[boundary];
        };
        const double a = force_on(gauges.moved);
        const double b = force_on(gauges.opposite);
        const double larger = std::max(std::abs(a), std::abs(b));
        return larger > 0.0 ? std::abs(a - b) / larger : 0.0;
    }

    void report_progress() {
        const auto n_steps = static_cast<int>(std::min<long>(time_steps_, std::numeric_limits<int>::max()));
        journal_.progress(work(), step_.row, work().at.load_factor, n_steps, load_share_);
    }

    /// At the blocks of a body that waits.
    struct Look {
        BlockBalance blocks;
        BlockVerdict verdict;
        [[nodiscard]] bool is_taken() const { return !blocks.left.empty(); }
    };

    const Model& model_;
    const CrackOptions& cracks_;
    const SolverOptions& solver_;
    const ExplicitOptions& options_;
    State& state_; ///< at the last committed load step
    const std::atomic<bool>& stop_;
    Journal journal_;
    const StageLoads* loads_ = nullptr; ///< of the stage in progress
    Step step_;                         ///< in progress; its end is where the body was when its state was last kept

    ExplicitMotion motion_;
    double crossing_time_;
    Eigen::VectorXd detected_at_;
    Look look_;                   ///< the last one of the load step in progress
    std::vector<double> extents_; ///< largest distance from the centroid in block coordinates, per block
    long time_steps_ = 0;
    double load_rate_ = 1.0;
    double load_share_ = 0.0; ///< of the way of the load in the load step in progress
    double force_scale_ = 0.0;
    double worst_energy_error_ = 0.0;
};

} // namespace

std::string warning_of_long_steps(const Model& model, const ExplicitOptions& options) {
    constexpr double very_many = 1e8; // time steps; of a small body some hours
    const std::vector<Mat6> masses = block_masses(model, options.density_scaling);
    const double crossing = crossing_time(model, masses);
    const double time_step =
        stable_time_step(largest_frequency(initial_stiffness_bounds(model), masses), options.damping);
    for (std::size_t s = 0; s < model.loads.stages.size(); ++s) {
        const Stage& stage = model.loads.stages[s];
        const bool steady = has_platen_velocity(stage, options);
        const double time = steady ? platen_time(model, stage, options) : load_time(stage, crossing);
        const double n_time_steps = time / time_step;
        if (!(n_time_steps > very_many)) continue;
        return fmt::format(
            "stages.{}: a load step takes {:.1e} time steps of {:.2g} s, since {}", s, n_time_steps, time_step,
            steady ? fmt::format("the platen takes {:.2g} s for it: a larger analysis.loading_rate takes fewer", time)
                   : "the stiffest interface is far stiffer than the body: smaller stiffnesses of the interfaces, or "
                     "blocks that differ less in size, take fewer");
    }
    return {};
}

RunReport run_explicit(const Model& model, const CrackOptions& cracks, const SolverOptions& solver,
                       const ExplicitOptions& options, State& state, StepObserver& observer,
                       const std::atomic<bool>& stop) {
    return ExplicitRun(model, cracks, solver, options, state, observer, stop).run();
}

} // namespace kluft
