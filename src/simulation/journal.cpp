#include "kluft/simulation/journal.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include <fmt/format.h>

#include "kluft/blocks/block_search.hpp"
#include "kluft/core/stopwatch.hpp"
#include "kluft/simulation/equilibrium_search.hpp"
#include "kluft/simulation/event_search.hpp"
#include "kluft/simulation/placement.hpp"
#include "kluft/simulation/state_fields.hpp"
#include "kluft/simulation/strength_reduction.hpp"

namespace kluft {

namespace {

std::vector<FallingBlock> falling_blocks(const Model& model, const State& state,
                                         const std::vector<MovingBlock>& moving) {
    std::vector<FallingBlock> falling;
    const double area = area_of(model.system);
    std::vector<char> named(model.system.blocks.size(), 0);
    for (const MovingBlock& each : moving) {
        if (std::exchange(named[each.block], 1)) continue;
        const auto& names = model.system.block_names;
        falling.push_back({names.empty() ? std::to_string(each.block) : names[each.block], state.at.stage,
                           state.at.load_factor, each.direction, each.turn,
                           model.system.blocks[each.block].area / area});
    }
    return falling;
}

std::string remark_on_drop(const Stage& stage, const State& state) {
    return fmt::format("stopped in stage {} at load step {}, after a drop of the axial stress by {:.4g} % "
                       "(stop_after_drop: {:.4g} %)",
                       state.at.stage, state.at.step,
                       100.0 * (1.0 - std::abs(state.stresses.axial) / state.stresses.largest_in_stage),
                       100.0 * *stage.stop_after_drop);
}

/// Whether a block that moves as a whole leaves all blocks that it met as cut, and what is at rest: nothing rubs on it then.
bool leaves_all_others(const Model& model, const MovingBlock& moving) {
    constexpr double along = 1e-3; // cosine: less is a motion along a face
    const BlockSystem& system = model.system;
    if (moving.turn != 0 || moving.direction == Vec2::Zero()) return false;
    return std::ranges::all_of(system.blocks[moving.block].edges, [&](const Edge& edge) {
        const bool is_held = edge.boundary >= 0 && model.loads.supports[edge.boundary] != Support::none;
        if (edge.interface < 0 && !is_held) return true;
        const Vec2 outward = right_normal(edge_end(system, edge) - edge_start(system, edge)).normalized();
        return outward.dot(moving.direction) < -along;
    });
}

/// Of a body that does not stand with the strengths that a reduction begins with. Not where a platen of given travel may have moved it, and
/// not where its loads are at fault.
std::string remark_on_first_factor(const Model& model, int stage, const StageEnd& end) {
    const std::vector<Stage>& stages = model.loads.stages;
    const auto until = stages.begin() + stage;
    const auto reduced =
        std::find_if(until, stages.end(), [](const Stage& s) { return s.strength_reduction.has_value(); });
    if (reduced == stages.end() || end.factor_of_safety || !end.failure->may_be_collapse() || !end.causes.empty() ||
        std::any_of(stages.begin(), until + 1, prescribes_strain))
        return {};
    const auto sliver = std::ranges::find_if(end.failure->moving, [&](const MovingBlock& each) {
        return model.system.blocks[each.block].area < sliver_area(model.system);
    });
    const bool is_of_sliver = sliver != end.failure->moving.end();
    const auto unheld = std::ranges::find_if(end.failure->moving,
                                             [&](const MovingBlock& each) { return leaves_all_others(model, each); });
    if (unheld != end.failure->moving.end())
        return fmt::format("; block {} moves off all that it touches, which no strength holds: a smaller "
                           "stages.{}.strength_reduction.from finds no factor of safety",
                           block_label(model.system, unheld->block), reduced - stages.begin());
    return fmt::format(
        "; {}its factor of safety is below stages.{}.strength_reduction.from, {:g}, with which the body was "
        "loaded: a smaller `from` finds it, if the body stands with any",
        is_of_sliver ? fmt::format("block {} is a sliver, which may fail where the body stands: "
                                   "`geometry.reference_spacing` leaves it out; or else ",
                                   block_label(model.system, sliver->block))
                     : std::string(),
        reduced - stages.begin(), reduced->strength_reduction->from);
}

/// A stage that a resumed run begins again finds what its state has noted already.
std::vector<std::string> each_once(const std::vector<std::string>& texts) {
    std::vector<std::string> once;
    for (const std::string& text : texts)
        if (std::ranges::find(once, text) == once.end()) once.push_back(text);
    return once;
}

constexpr std::string_view contact_was_lost = ": a contact was lost, because ";

bool tells_of_lost_contact(const std::string& warning) { return warning.find(contact_was_lost) != std::string::npos; }

std::string listed(const std::vector<std::string>& causes) {
    std::string text;
    for (const std::string& cause : causes) text += "; " + cause;
    return text;
}

} // namespace

Journal::Journal(const Model& model, const State& state, StepObserver& observer, int n_steps,
                 const EquilibriumSearch* search)
    : model_(model), observer_(observer), search_(search), gauges_(make_gauges(model)), n_steps_(n_steps) {
    report_.costs = state.costs;
    report_.warnings = state.remarks.warnings;
    largest_checked_ = state.remarks.largest_checked;
    warned_of_lost_contact_ = std::ranges::any_of(report_.warnings, tells_of_lost_contact);
}

double Journal::elapsed() const {
    const auto since = std::chrono::steady_clock::now() - started_;
    return report_.costs.elapsed_s + std::chrono::duration<double>(since).count();
}

RunCosts Journal::costs() const {
    RunCosts costs = report_.costs;
    if (search_ != nullptr) search_->add_costs(costs);
    costs.elapsed_s = elapsed();
    costs.loading_cpu_s += processor_seconds() - cpu_at_start_;
    return costs;
}

void Journal::begin(StepRecord row, const State& state, LoadedPlacement in_place) {
    row.step = 0;
    tell_state(row, state, std::move(in_place), false);
}

void Journal::tell(const Step& step) {
    const Stopwatch watch(report_.costs.seconds.observers);
    for (const StepRecord& record : step.equilibria) observer_.equilibrium(record);
    for (const CrackRecord& crack : step.cracks) observer_.crack(crack);
    for (const JumpRecord& jump : step.jumps) observer_.jump(jump);
}

void Journal::warn(const Step& step, int number) {
    if (step.checked_index > largest_checked_.index) largest_checked_ = {step.checked_index, number};
    if (step.lost_contact.empty() || std::exchange(warned_of_lost_contact_, true)) return;
    report_.warnings.push_back(fmt::format("load step {}{}{}", number, contact_was_lost, step.lost_contact));
}

void Journal::tell_state(const StepRecord& row, const State& state, LoadedPlacement in_place, bool last_of_stage) {
    last_row_ = row;
    const Stopwatch watch(report_.costs.seconds.observers);
    const auto kept = std::make_shared<const LoadedPlacement>(std::move(in_place));
    const auto fields = [&model = model_, &state, kept] {
        return field_record(model, state, loaded_body(model, kept->placement, kept->at));
    };
    observer_.step(row, state, fields, last_of_stage);
}

void Journal::progress(const State& state, const StepRecord& row, double load_factor, int n_solves,
                       std::optional<double> share_of_step) {
    Progress progress;
    progress.stage = state.at.stage;
    progress.n_stages = static_cast<int>(model_.loads.stages.size());
    progress.step = state.at.step;
    progress.n_steps = n_steps_;
    progress.load_factor = load_factor;
    progress.axial_strain = row.axial_strain;
    progress.axial_stress = row.axial_stress;
    if (!model_.loads.stages[state.at.stage].motion && reduction_of(model_.loads, 0) != nullptr)
        progress.strength_factor = strength_factor(model_.loads, state.at.stage, load_factor);
    progress.cracks = row.cracks_tension + row.cracks_shear;
    progress.open_close_iterations = n_solves;
    progress.share_of_step = share_of_step;
    observer_.progress(progress);
}

RunReport Journal::ended(const State& state, const StageEnd& end) const {
    const Stage& stage = model_.loads.stages[state.at.stage];
    if (!end.failure && state.unbalanced_in_succession == 0) {
        RunReport report = cut_short(RunStatus::done, "");
        if (end.has_dropped) report.remark = remark_on_drop(stage, state);
        return report;
    }
    if (!end.failure) {
        const Imbalance& imbalance = state.imbalance;
        const Failure left{
            .worst_block = imbalance.worst_block, .residual_ratio = imbalance.share, .moving = imbalance.moving};
        std::string why = fmt::format("stage {} ends out of balance: {}", state.at.stage, description(model_, left)) +
                          listed(end.causes);
        RunReport report = cut_short(RunStatus::unbalanced, std::move(why));
        report.falling = falling_blocks(model_, state, state.imbalance.moving);
        return report;
    }
    const bool has_stood = state.at.stage > 0 || state.at.step_in_stage > 0; // through a whole load step
    const bool past_limit = end.failure->may_be_collapse() && is_platen_loaded_by_stress(stage) && has_stood;
    std::string why = fmt::format("no equilibrium in stage {} at load step {}: {}", state.at.stage, end.step,
                                  description(model_, *end.failure) + listed(end.causes)) +
                      remark_on_first_factor(model_, state.at.stage, end);
    const auto reduced = end.factor_of_safety ? reduced_alone(model_, state.at.stage) : std::vector<std::string>{};
    if (end.factor_of_safety)
        why = fmt::format("{} {:.6g}; beyond it {}", factor_name(reduced), *end.factor_of_safety, why);
    RunReport report = cut_short(end.factor_of_safety || past_limit ? RunStatus::collapsed : RunStatus::no_equilibrium,
                                 std::move(why));
    report.results.factor_of_safety = end.factor_of_safety;
    report.reduced_alone = reduced;
    report.falling = falling_blocks(model_, state, all_moving(*end.failure));
    return report;
}

RunReport Journal::cut_short(RunStatus status, std::string why) const {
    RunReport report = report_;
    report.status = status;
    report.diagnosis = std::move(why);
    report.costs = costs();
    report.warnings = each_once(report.warnings);
    return report;
}

void commit(Step step, StepKind kind, State& state, Journal& journal) {
    State& next = step.end;
    if (kind.regular) ++next.at.step_in_stage;
    ++next.at.step;
    next.unbalanced_in_succession = step.balanced ? 0 : next.unbalanced_in_succession + 1;
    next.imbalance = {};
    if (!step.balanced) next.imbalance = {step.worst_block, step.worst_share, std::move(step.moving)};
    if (!step.balanced) ++journal.report().unbalanced_steps;
    journal.report().costs.events += step.crack_passes;
    next.costs = journal.costs();
    step.row.step = next.at.step;
    step.row.load_factor = next.at.load_factor;
    step.row.crack_passes = step.crack_passes;
    journal.warn(step, next.at.step);
    next.remarks = journal.remarks();
    state = std::move(next);
    journal.tell(step);
    journal.tell_state(step.row, state, std::move(step.in_place), kind.last_of_stage);
}

StageEnd commit_balanced_part(Step step, State& state, Journal& journal) {
    const bool is_further = state.is_settled || step.end.at.load_factor > state.at.load_factor || !step.cracks.empty();
    const bool has_part = is_further && !step.equilibria.empty();
    // An unsettled state is the part of a load step that has failed before: its row has the number of that step.
    StageEnd end{.failure = step.failure, .step = has_part || state.is_settled ? state.at.step + 1 : state.at.step};
    journal.warn(step, end.step);
    if (has_part) commit(std::move(step), {.regular = false}, state, journal);
    return end;
}

std::string warning_of_late_checks(const CheckedIndex& largest, std::string_view why, std::string_view remedy) {
    constexpr double far_beyond = 1.1;
    const auto [index, step] = largest;
    if (index <= far_beyond) return {};
    return fmt::format(
        "load step {}: stresses reach {:.2g} times the strength of a potential crack{} before it is checked, since {}: "
        "strengths of the body come out too large by up to that. {} finds where each crack fails",
        step, index, index >= largest_useful_index ? " or more" : "", why, remedy);
}

int number_of_steps(const Model& model) {
    int n = 0;
    for (const Stage& stage : model.loads.stages) n += stage.steps;
    return n;
}

} // namespace kluft
