#include "kluft/simulation/strength_search.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "kluft/blocks/block_search.hpp"
#include "kluft/kinematics/affine.hpp"
#include "kluft/simulation/corner_contact.hpp"
#include "kluft/simulation/fallen_blocks.hpp"
#include "kluft/simulation/over_damped_motion.hpp"
#include "kluft/simulation/strength_reduction.hpp"

namespace kluft {

namespace {

constexpr double reduction_balance = 0.1;   ///< of the tolerance of a factor of safety: largest `balance`
constexpr double reduction_residual = 0.01; ///< of it: largest `tolerance`
constexpr double less_strength = 1.002; ///< growth of the factor with which a body that does not slide stands as well
constexpr double share_of_jump = 0.05;  ///< between factors within the tolerance: what goes farther slides
constexpr double no_deformation =
    20.0;                           ///< times what loads have displaced: more than joints give way before they slide
constexpr double least_snap = 5e-5; ///< that it is asked of, of a block
constexpr double sudden = 5.0;      ///< times the motion before: what goes farther at once may have snapped over

StepGoal goal_with_strengths_of(const StepBench& bench, const State& state, double load_factor) {
    const double tolerance = bench.stage(state).strength_reduction->tolerance;
    StepGoal goal = goal_at(bench, load_factor, bench.model.has_potential_cracks);
    goal.balance.share = std::min(bench.solver.balance, reduction_balance * tolerance);
    goal.must_rest = true;
    return goal;
}

/// A body that has given way under the loads before, and rests in another place, has failed with the strengths it had then, as in
/// (32b). What a platen of given travel has moved has not fallen.
std::optional<Failure> failure_before(const StepBench& bench, const State& state) {
    const std::vector<Stage>& stages = bench.model.loads.stages;
    if (std::any_of(stages.begin(), stages.begin() + state.at.stage, prescribes_strain)) return std::nullopt;
    const Eigen::VectorXd as_cut = Eigen::VectorXd::Zero(state.body.displacement.size());
    const std::string fall = description_of_fall(bench.model, as_cut, state);
    if (fall.empty()) return std::nullopt;
    return Failure{.kind = FailureKind::falling,
                   .load_factor = 0.0,
                   .strength_factor = strength_factor(bench.model.loads, state.at.stage, 0.0),
                   .what =
                       fmt::format("the body has given way under its loads before strengths are reduced, and rests in "
                                   "another place: {}",
                                   fall)};
}

/// The state that the stages before have left must be in equilibrium by the tolerances of this one, too. `equilibria`:
/// what is to be told of it with the first load step.
std::optional<Failure> find_initial_equilibrium(const StepBench& bench, State& state,
                                                std::vector<StepRecord>& equilibria) {
    if (auto failure = failure_before(bench, state)) return failure;
    StepGoal goal = goal_with_strengths_of(bench, state, 0.0);
    goal.checks_cracks = false;
    begin_load_step(bench);
    Step step = take_step(bench, state, goal);
    if (step.failure) return step.failure;
    state = std::move(step.end);
    state.costs = bench.journal.costs();
    bench.journal.warn(step, state.at.step + 1);
    equilibria = std::move(step.equilibria);
    return std::nullopt;
}

/// What a load step to a factor has come to.
struct Trial {
    std::optional<Failure> failure;
    /// Whether the body stands there is undecided: it has moved farther than blocks displace elastically, or failed on its way.
    bool is_undecided = false;
};

/// Those that have moved by more than a share of their motion_scale, the farthest first.
std::vector<MovingBlock> moved_blocks(const BlockSystem& system, const Eigen::VectorXd& moved, double least_share) {
    std::vector<std::pair<double, MovingBlock>> far;
    for (int b = 0; b < system.n_blocks(); ++b) {
        const Vec2 motion = moved.segment<2>(n_block_unknowns * b);
        const double share = motion.norm() / motion_scale(system, system.blocks[b]);
        if (share > least_share) far.push_back({share, {b, motion.normalized(), 0}});
    }
    std::ranges::stable_sort(far, std::greater(), [](const auto& each) { return each.first; });
    std::vector<MovingBlock> blocks;
    for (const auto& each : far) blocks.push_back(each.second);
    return blocks;
}

/// Of a step that ends in another equilibrium than that in which the body stood.
Failure failure_by_motion(const StepBench& bench, const Step& step, const Eigen::VectorXd& before, double farthest) {
    const auto& at = step.end.at;
    const BlockSystem& system = bench.model.system;
    const Eigen::VectorXd& now = step.end.body.displacement;
    Failure failure{.kind = FailureKind::falling,
                    .load_factor = at.load_factor,
                    .strength_factor = strength_factor(bench.model.loads, at.stage, at.load_factor),
                    .moving = moved_blocks(system, now - before, farthest)};
    failure.along = moving_along(system, before, now, failure.moving);
    const double moved = relative_motion(system, now - before);
    if (moved <= jump_motion && !failure.moving.empty())
        failure.what = fmt::format(
            "at once {}, by {:.2g} m, much farther than at all factors before, and may stand there again: what "
            "holds it there is not the strength of the place where it stood",
            description(bench.model, failure.moving),
            (now - before).segment<2>(n_block_unknowns * failure.moving.front().block).norm());
    return failure;
}

/// A corner that holds a block and is none of the earlier ones; nothing if there is none.
std::optional<CornerContact> caught_corner(const Model& model, const std::vector<CornerContact>& earlier,
                                           const State& now) {
    for (const CornerContact& corner : corner_contacts(model, now)) {
        const auto same = [&](const CornerContact& each) {
            return each.block_a == corner.block_a && each.block_b == corner.block_b;
        };
        if (std::ranges::none_of(earlier, same)) return corner;
    }
    return std::nullopt;
}

/// By what a body stands that has moved (motion_scale), where rock would not: a corner that has caught, or whatever a tip has met that has
/// sunk into the ground before it with a block that moved about as far; "" where there is no such thing.
std::string resting_place(const Model& model, const State& before, const State& now, double moved) {
    constexpr double on_the_way = 0.05; // of the motion: ground that rises by 3 degrees; less is deformation
    constexpr double about_as_far = 0.5;
    if (const auto corner = caught_corner(model, corner_contacts(model, before), now))
        return description(model, *corner) + ", which rock would lose";
    const Eigen::VectorXd motion = now.body.displacement - before.body.displacement;
    for (const UnheldTip& tip : unheld_tips(model, now)) {
        const double of_block = motion.segment<2>(n_block_unknowns * tip.block).norm();
        const bool is_moving =
            of_block > about_as_far * moved * motion_scale(model.system, model.system.blocks[tip.block]);
        if (is_moving && tip.depth > on_the_way * of_block) return description(model, tip);
    }
    return {};
}

/// Of a step whose body has given way and has come to rest by what rock would lose, in words.
Failure failure_by_giving_way(const StepBench& bench, const Step& step, const Eigen::VectorXd& before,
                              const std::string& resting) {
    const Eigen::VectorXd moved = step.end.body.displacement - before;
    Failure failure = failure_by_motion(bench, step, before, 0.5 * relative_motion(bench.model.system, moved));
    failure.what = "the body has given way, and " + resting;
    return failure;
}

/// How far the loads have displaced blocks before strengths are reduced, as motions are measured. Of a body that has jumped, and so has
/// moved as well, what counts as near by.
double displaced_by_loads(const Model& model, const State& state, const StepRecord& row) {
    return row.jumps > 0 ? share_of_jump * jump_motion : relative_motion(model.system, state.stage_start.displacement);
}

/// Where a load step goes to, and how far a body that stands moves on the way (motion_scale).
struct TrialGoal {
    double load_factor = 0.0;
    double farthest = jump_motion;
    double displaced_by_loads = 0.0;
    StepKind kind;
};

/// How far a body may move from one factor to the next before it is asked whether it has given way on the way: (32b), or some times as
/// far as it has moved so far, under its loads and since strengths are reduced. Stiff blocks that topple snap over by much less than
/// (32b), and hold each other again by their lower corners.
double farthest_at_once(const Model& model, const State& state, double displaced_by_loads) {
    const double since = relative_motion(model.system, state.body.displacement - state.stage_start.displacement);
    return std::clamp(sudden * (displaced_by_loads + since), least_snap, jump_motion);
}

/// What a body moves by that still stands where it did: (32b), or as far as the loads have displaced it.
double near_by(double displaced_by_loads) { return std::max(jump_motion, displaced_by_loads); }

/// Whether the body stands where it is with strengths that are lower by a five-hundredth, too, without a jump: what it has moved by
/// so far was then its joints' giving way, and not the beginning of a slide.
bool would_stand_with_less(const StepBench& bench, const State& state) {
    const StrengthReduction& reduction = *bench.stage(state).strength_reduction;
    const double less = reduction.load_factor_at(less_strength * reduction.factor_at(state.at.load_factor));
    begin_load_step(bench);
    const Step step = take_step(bench, state, goal_with_strengths_of(bench, state, std::min(1.0, less)));
    return !step.failure && step.jumps.empty();
}

/// Keeps where the body stands at the end of a step without having slid there. False where it slides: where it has moved on by
/// more, as a share of its size, than the factor has grown by meanwhile, and would not stand where it was with less. What is
/// gained on the way is the strength of another place. Source: (32c).
bool keeps_its_place(const StepBench& bench, const State& before, double near, Step& step) {
    StageStart& place = step.end.stage_start;
    const double factor = bench.stage(before).strength_reduction->factor_at(step.end.at.load_factor);
    const double moved = relative_motion(bench.model.system, step.end.body.displacement - place.near_place);
    if (moved <= near) place.near_factor = factor;
    if (moved - near <= std::log(factor / place.near_factor)) return true;
    if (!would_stand_with_less(bench, before)) return false;
    place.near_place = step.end.body.displacement;
    place.near_factor = factor;
    return true;
}

/// Tries a load step and commits it, after the equilibria found before, if the body stands at its end where it stood (32b), and not
/// by a resting_place.
Trial try_factor(const StepBench& bench, const TrialGoal& goal, State& state, std::vector<StepRecord>& before) {
    begin_load_step(bench);
    Step step = take_step(bench, state, goal_with_strengths_of(bench, state, goal.load_factor));
    if (step.failure) {
        const bool fails_before = step.failure->load_factor < goal.load_factor;
        return {step.failure, step.failure->kind == FailureKind::falling || fails_before};
    }
    const Eigen::VectorXd& start = state.body.displacement;
    const double moved = relative_motion(bench.model.system, step.end.body.displacement - start);
    if (moved > goal.farthest) return {failure_by_motion(bench, step, start, goal.farthest), true};
    if (!keeps_its_place(bench, state, near_by(goal.displaced_by_loads), step))
        return {failure_by_motion(bench, step, step.end.stage_start.near_place, jump_motion), false};
    if (moved > goal.displaced_by_loads)
        if (const std::string resting = resting_place(bench.model, state, step.end, moved); !resting.empty())
            return {failure_by_giving_way(bench, step, start, resting), true};
    step.equilibria.insert(step.equilibria.begin(), before.begin(), before.end());
    before.clear();
    commit(std::move(step), goal.kind, state, bench.journal);
    return {};
}

/// Where no equilibrium was found, and no block was seen to move away either.
bool is_without_motion(const Failure& failure) {
    return failure.kind == FailureKind::no_equilibrium && failure.moving.empty();
}

/// The sliver that the failure began with, if it was one.
std::optional<int> sliver_at_fault(const BlockSystem& system, const Failure& failure) {
    const int first = failure.moving.empty() ? failure.worst_block : failure.moving.front().block;
    if (first < 0 || system.blocks[first].area >= sliver_area(system)) return std::nullopt;
    return first;
}

/// Where no equilibrium was found without a block that was seen to move away, or one that is a sliver.
void warn_of_doubtful_failure(const StepBench& bench, double found, const Failure& failure) {
    const BlockSystem& system = bench.model.system;
    const std::optional<int> sliver = sliver_at_fault(system, failure);
    if (!is_without_motion(failure) && !sliver) return;
    std::string warning =
        fmt::format("with the strengths divided by {:.6g} no equilibrium was found", failure.strength_factor);
    if (is_without_motion(failure)) warning += ", and no block was seen to move away either: the search failed there";
    warning += fmt::format(", and the factor of safety may be above {:.6g}", found);
    if (sliver)
        warning += fmt::format(". It failed at block {}, a sliver, which `geometry.reference_spacing` leaves out",
                               block_label(system, *sliver));
    bench.journal.report().warnings.push_back(std::move(warning));
}

/// Whether the block of a tip moves on into the ground before it, and not along it or away.
bool moves_into_ground(const BlockSystem& system, const UnheldTip& tip, const std::vector<MovingBlock>& moving) {
    constexpr double into = 0.05; // of the motion, across the ground
    const auto direction_of = [&](int block) -> Vec2 {
        const auto found = std::ranges::find(moving, block, &MovingBlock::block);
        return found == moving.end() ? Vec2::Zero() : found->direction;
    };
    const Edge& ground = system.blocks[tip.ground].edges[tip.ground_edge];
    const Vec2 outward = right_normal((edge_end(system, ground) - edge_start(system, ground)).normalized());
    const Vec2 relative = direction_of(tip.block) - direction_of(tip.ground);
    return relative.isZero() || outward.dot(relative) < -into * relative.norm();
}

/// What would have held the blocks that fall, if rock were rigid; the deepest three.
void warn_of_unheld_tips(const StepBench& bench, const State& state, const Failure& failure) {
    int left = 3;
    for (const UnheldTip& tip : unheld_tips(bench.model, state)) {
        if (std::ranges::find(failure.moving, tip.block, &MovingBlock::block) == failure.moving.end()) continue;
        if (!moves_into_ground(bench.model.system, tip, failure.moving)) continue;
        bench.journal.report().warnings.push_back(description(bench.model, tip) + "; rigid blocks may stand with more");
        if (--left == 0) return;
    }
}

/// A body that has moved in a jump before strengths are reduced, by less than (32b) takes for a fall.
void warn_of_earlier_jump(const StepBench& bench, const State& state) {
    const std::vector<Stage>& stages = bench.model.loads.stages;
    const auto first = stages.begin();
    if (state.at.load_factor > 0.0 || state.jumps == 0) return;
    if (std::any_of(first, first + state.at.stage, prescribes_strain)) return;
    const std::string jump =
        description_of_small_jump(bench.model, Eigen::VectorXd::Zero(state.body.displacement.size()), state);
    if (jump.empty()) return;
    bench.journal.report().warnings.push_back(
        fmt::format("under its loads, before strengths are reduced, the body has jumped (jumps.csv), and {}: the "
                    "factor of safety is "
                    "that of the place where it has come to rest, and not of the body as cut",
                    jump));
}

std::string four_digits(double factor) { return fmt::format("{:.4g}", factor); }

/// What lies against a factor that is found: it may be that of a body which has moved into another place, as cut it has a lower
/// one.
class Doubts {
public:
    Doubts(const Model& model, const State& start, double displaced_by_loads)
        : model_(model), start_(start.stage_start.displacement), corners_(corner_contacts(model, start)),
          displaced_by_loads_(displaced_by_loads),
          far_(std::max(displaced_by_loads, std::min(jump_motion, no_deformation * displaced_by_loads))) {}

    /// `row`: of the state.
    void look_at(const State& state, const StepRecord& row, double factor) {
        said_ = of_net(row);
        if (said_.empty()) said_ = of_corners(state);
        if (said_.empty()) said_ = of_motion(state);
        if (said_.empty()) without_ = factor;
    }

    /// `factor`: found.
    [[nodiscard]] std::string warning(double factor) const {
        return said_.empty() ? std::string{} : doubt_in_words(said_, factor, without_);
    }

    /// The last factor before what lies against the one that is found; none where that does not change four digits.
    [[nodiscard]] std::optional<double> factor_without(double factor) const {
        return said_.empty() || four_digits(without_) == four_digits(factor) ? std::nullopt : std::optional(without_);
    }

private:
    /// Cells that are loose all around hold each other by their shapes, as rock does not.
    [[nodiscard]] static std::string of_net(const StepRecord& row) {
        if (row.net_broken < locking_share) return {};
        return fmt::format(
            "the net has locked: {:.0f} % of its bonds in the middle half of the body have failed, and its cells hold "
            "each other as masonry does",
            100.0 * row.net_broken);
    }

    /// Blocks that have slid a little catch with their corners, and may stand by these alone.
    [[nodiscard]] std::string of_corners(const State& state) const {
        const auto corner = caught_corner(model_, corners_, state);
        return corner ? description(model_, *corner) : "";
    }

    /// More than (32b) in all, or many times as far as the loads have displaced them.
    [[nodiscard]] std::string of_motion(const State& state) const {
        const BlockSystem& system = model_.system;
        const Eigen::VectorXd moved = state.body.displacement - start_;
        if (relative_motion(system, moved) <= far_) return {};
        const auto blocks = moved_blocks(system, moved, far_);
        if (blocks.empty()) return "blocks have turned since strengths are reduced";
        const int block = blocks.front().block;
        return fmt::format(
            "block {} has moved by {:.3g} m since strengths are reduced, {:.0f} times as far as the loads have "
            "displaced any before",
            block_label(system, block), moved.segment<2>(n_block_unknowns * block).norm(),
            relative_motion(system, moved) / std::max(displaced_by_loads_, 1e-300));
    }

    const Model& model_;
    Eigen::VectorXd start_;
    std::vector<CornerContact> corners_;
    double displaced_by_loads_ = 0.0;
    double far_ = 0.0;
    std::string said_;
    double without_ = 0.0;
};

} // namespace

std::string doubt_in_words(const std::string& said, double factor, double without) {
    const std::string before = four_digits(without);
    if (before == four_digits(factor))
        return fmt::format("{}: without that the factor of safety is the same to four digits", said);
    return fmt::format(
        "{}: the factor of safety may be lower without that; {} is the factor of the last load step before", said,
        before);
}

double reduction_tolerance(const StrengthReduction& reduction, const SolverOptions& solver) {
    return std::min(solver.tolerance, reduction_residual * reduction.tolerance);
}

StageEnd find_strength_limit(const StepBench& bench, State& state) {
    warn_of_earlier_jump(bench, state);
    const StrengthReduction& reduction = *bench.stage(state).strength_reduction;
    const int n_steps = bench.stage(state).steps;
    StageEnd end;
    const double displaced = displaced_by_loads(bench.model, state, bench.journal.last_row());
    Doubts doubts(bench.model, state, displaced);
    doubts.look_at(state, bench.journal.last_row(), reduction.factor_at(state.at.load_factor));
    std::vector<StepRecord> before; // equilibria that are not told yet
    if (state.at.load_factor == 0.0) end.failure = find_initial_equilibrium(bench, state, before);
    if (end.failure) {
        warn_of_unheld_tips(bench, state, *end.failure);
        return {.failure = end.failure, .step = state.at.step + 1};
    }
    if (state.at.load_factor == 0.0) {
        state.stage_start.near_place = state.body.displacement;
        state.stage_start.near_factor = reduction.factor_at(0.0);
    }
    const auto width = [&](double to) { // of the factors from the last equilibrium on, relative
        return reduction.factor_at(to) / reduction.factor_at(state.at.load_factor) - 1.0;
    };
    constexpr double none = std::numeric_limits<double>::infinity();
    double failing = none;    // the least load factor at which the body was found not to stand
    double tried_from = none; // where that left open whether it stands there from nearer by
    double size = none;       // of a load step in which it does not move too far
    while (state.at.step_in_stage < n_steps) {
        const double from = state.at.load_factor;
        const double next = static_cast<double>(state.at.step_in_stage + 1) / n_steps;
        const double middle = 0.5 * (from + failing);
        const bool is_enclosed =
            failing < none && (width(failing) <= reduction.tolerance || middle <= from || middle >= failing);
        if (is_enclosed && (tried_from == none || tried_from == from)) break;
        const double at = is_enclosed ? failing : std::min({next, from + size, middle});
        const bool last = at == next && state.at.step_in_stage + 1 == n_steps;
        const double at_once = farthest_at_once(bench.model, state, displaced);
        const TrialGoal goal{.load_factor = at,
                             .farthest = is_enclosed ? std::min(share_of_jump * jump_motion, at_once) : at_once,
                             .displaced_by_loads = displaced,
                             .kind = {.regular = at == next, .last_of_stage = last}};
        const Trial trial = try_factor(bench, goal, state, before);
        if (!trial.failure) {
            doubts.look_at(state, bench.journal.last_row(), reduction.factor_at(state.at.load_factor));
            size = at == failing ? 2.0 * (at - from) : 2.0 * size;
            if (at == failing) failing = none;
            if (failing == none) end.failure.reset();
            continue;
        }
        end.failure = trial.failure;
        if (end.failure->kind == FailureKind::too_many_solves) break; // whether it stands is not known
        failing = at;
        tried_from = trial.is_undecided ? from : none;
    }
    const double found = reduction.factor_at(state.at.load_factor);
    if (const std::string said = doubts.warning(found); !said.empty()) bench.journal.report().warnings.push_back(said);
    bench.journal.report().results.undoubted_factor = doubts.factor_without(found);
    if (end.failure) warn_of_doubtful_failure(bench, found, *end.failure);
    if (end.failure) warn_of_unheld_tips(bench, state, *end.failure);
    if (!end.failure) {
        bench.journal.report().warnings.push_back(
            fmt::format("the {} is above {:g}, the largest strength factor of stage {}",
                        factor_name(reduced_alone(bench.model, state.at.stage)), reduction.to, state.at.stage));
        return end;
    }
    end.step = state.at.step + 1;
    if (end.failure->kind == FailureKind::too_many_solves) return end;
    end.factor_of_safety = found;
    return end;
}

} // namespace kluft
