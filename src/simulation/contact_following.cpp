#include "kluft/simulation/contact_following.hpp"

#include <utility>

#include "kluft/simulation/relaxation.hpp"

namespace kluft {

namespace {

constexpr double far = 1e-3; ///< motion of a block after which its contacts are detected anew (motion_scale)
constexpr int max_rounds_of_detection = 100;

bool has_moved_far(const StepInProgress& p, const Eigen::VectorXd& since) {
    const BlockSystem& system = p.bench.model.system;
    const Eigen::VectorXd moved = p.displacement() - since;
    for (int b = 0; b < system.n_blocks(); ++b) {
        if (moved.segment<2>(n_block_unknowns * b).norm() > far * motion_scale(system, system.blocks[b])) return true;
    }
    return false;
}

} // namespace

Equilibrium find_again(StepInProgress& p) {
    PlacedState placed = place(p);
    Equilibrium found = find_at(p, placed, p.load_factor(), p.displacement());
    if (!found.balanced) found = recover(p, placed, found, p.load_factor());
    if (!p.failed()) reach(p, std::move(placed), found);
    return found;
}

void let_contacts_follow(StepInProgress& p, Eigen::VectorXd placed_at) {
    if (!p.goal.must_rest && !is_loaded_by_stress(p.bench.stage(p.from))) return;
    for (int round = 0; !p.failed() && p.step.balanced && has_moved_far(p, placed_at); ++round) {
        placed_at = p.displacement();
        const Equilibrium found = find_again(p);
        if (!p.failed() && round == max_rounds_of_detection) fail(p, found, found.viscous_share, FailureKind::falling);
    }
}

} // namespace kluft
