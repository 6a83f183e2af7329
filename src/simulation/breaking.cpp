#include "kluft/simulation/breaking.hpp"

#include <algorithm>
#include <utility>

#include "kluft/core/stopwatch.hpp"
#include "kluft/fracture/crack_check.hpp"
#include "kluft/simulation/contact_following.hpp"
#include "kluft/simulation/placement.hpp"
#include "kluft/simulation/weakening.hpp"

namespace kluft {

namespace {

std::vector<CrackCandidate> candidates(const StepInProgress& p, const Placement& placement, const LoadsAt& at,
                                       const Eigen::VectorXd& q) {
    const Model& model = p.bench.model;
    RunReport& report = p.bench.journal.report();
    const Stopwatch watch(report.costs.seconds.crack_check);
    ++report.crack_checks;
    return check_cracks(model, p.goal.cracks.criterion, p.step.end, at.strength_factor,
                        loaded_body(model, placement, at), q);
}

/// Those that fail together: at an event of a step from an accuracy, which it meets to within that, the first time the foremost of
/// those around 1.
std::vector<CrackCandidate> breaking(const StepGoal& goal, const std::vector<CrackCandidate>& all, bool first) {
    const bool around_one = first && goal.accuracy > 0.0 && goal.cracks.update == CrackUpdate::event;
    const double largest = largest_index(all);
    if (!around_one || largest > 1.0 + goal.accuracy) return chosen_to_fail(goal.cracks, all);
    return failing(all, std::max(1.0 - goal.accuracy, largest - goal.cracks.event_tolerance));
}

} // namespace

void break_bonds(StepInProgress& p) {
    for (bool first = true; !p.failed(); first = false) {
        const auto& [placement, at] = p.step.in_place;
        const auto all = candidates(p, placement, at, p.displacement());
        if (p.step.cracks.empty() && p.step.jumps.empty())
            p.step.checked_index = std::min(largest_useful_index, largest_index(all));
        const auto broken = breaking(p.goal, all, first);
        if (broken.empty()) return;
        p.step.smooth = false;
        weaken_together(p.bench.model, broken, p.step.row.axial_strain, p.step);
        Eigen::VectorXd placed_at = p.displacement();
        find_again(p);
        let_contacts_follow(p, std::move(placed_at));
    }
}

bool break_at(StepInProgress& p, const PlacedState& placed, const LoadsAt& at) {
    const auto broken = breaking(p.goal, candidates(p, placed.placement, at, p.displacement()), false);
    if (broken.empty()) return false;
    weaken_together(p.bench.model, broken, p.step.row.axial_strain, p.step);
    return true;
}

void settle(StepInProgress& p) {
    p.step.smooth = false;
    find_again(p);
    if (!p.failed() && p.bench.model.has_potential_cracks) break_bonds(p);
}

double largest_failure_index(const StepInProgress& p, const Placement& placement, const LoadsAt& at,
                             const Eigen::VectorXd& q) {
    return std::min(largest_useful_index, largest_index(candidates(p, placement, at, q)));
}

} // namespace kluft
