#include "kluft/simulation/step.hpp"

#include <algorithm>
#include <utility>

namespace kluft {

namespace {

int count_of(const State& state, InterfaceStatus status) {
    return static_cast<int>(std::ranges::count(state.body.interfaces, status));
}

} // namespace

void keep_balanced_part(Step& step) {
    if (step.balanced_part) {
        Step::BalancedPart& part = *step.balanced_part;
        step.end.body = std::move(part.body);
        step.end.at.load_factor = part.load_factor;
        step.end.control = std::move(part.control);
        step.end.stresses = part.stresses;
        step.in_place = std::move(part.in_place);
        step.equilibria.resize(part.n_equilibria);
        step.cracks.resize(part.n_cracks);
        step.end.jumps -= static_cast<int>(step.jumps.size() - part.n_jumps);
        step.jumps.resize(part.n_jumps);
        step.balanced_part.reset();
    }
    step.smooth = false;
    step.end.is_settled = false;
    step.end.memory.rate.resize(0);
    if (step.equilibria.empty()) return;
    step.balanced = std::ranges::all_of(step.equilibria, &StepRecord::balanced);
    step.worst_share = std::ranges::max(step.equilibria, {}, &StepRecord::unbalanced_ratio).unbalanced_ratio;
    step.crack_passes = step.cracks.empty() ? 0 : step.cracks.back().pass;
    const int n_solves = step.row.open_close_iterations;
    step.row = step.equilibria.back();
    step.row.open_close_iterations = n_solves;
    step.row.balanced = step.balanced;
    step.row.unbalanced_ratio = step.worst_share;
    step.row.cracks_tension = count_of(step.end, InterfaceStatus::tension_crack);
    step.row.cracks_shear = count_of(step.end, InterfaceStatus::shear_crack);
}

} // namespace kluft
