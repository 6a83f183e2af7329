#include "kluft/simulation/contact_following.hpp"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "kluft/equilibrium/left_over.hpp"
#include "kluft/simulation/breaking.hpp"
#include "kluft/simulation/jump.hpp"
#include "kluft/simulation/placement.hpp"
#include "kluft/simulation/state_fields.hpp"

namespace kluft {

namespace {

constexpr double far = 1e-3; ///< motion of a block after which its contacts are detected anew (motion_scale)
constexpr int max_rounds_of_detection = 100;
constexpr double large_imbalance = 0.1; ///< of what acts on a block
constexpr double same_place = 0.01;     ///< of the motion between two detections
constexpr double in_place = 1e-6;       ///< of a block: all rounds of detection would not take it far

/// Whether the body comes to rest in an equilibrium that was found beside it, without another potential crack that fails.
bool rests_at(const StepInProgress& p, const PlacedState& placed, const Equilibrium& found) {
    if (!found.balanced || is_jump(p, found)) return false;
    const bool by_events = p.goal.checks_cracks && p.goal.cracks.update == CrackUpdate::event;
    return !by_events || largest_failure_index(p, placed.placement, p.loads_at(found), found.displacement) < 1.0;
}

bool has_moved_far(const StepInProgress& p, const Eigen::VectorXd& since) {
    return relative_motion(p.bench.model.system, p.displacement() - since) > far;
}

/// Of contacts detected where the body stands: whether it is held but for a tenth of what acts on each block and group.
BlockVerdict verdict_anew(const LoadedBody& body, const Eigen::VectorXd& q, double share = large_imbalance) {
    return judge_blocks(block_balance(body, q), nullptr, {.share = share});
}

/// Whether the next load step would begin where this one ends.
bool is_held_anew(const StepInProgress& p, double share = large_imbalance) {
    const Model& model = p.bench.model;
    const BodyState& body = p.step.end.body;
    if (body.contacts.empty()) return true;
    DetectedContacts detected = detect(p);
    Placement placement{placed_bonds(model, body), std::move(detected.points)};
    const LoadsAt at = p.loads_at(p.load_factor());
    const bool is_held = verdict_anew(loaded_body(model, placement, at), body.displacement, share).balanced();
    detected.points = std::move(placement.contacts);
    keep_detected(p, std::move(detected));
    return is_held;
}

/// Whether a tip has sunk into the ground before it that holds it no more, by contacts detected anew, under a platen: what a large load step carries it past
/// would be strength of the body.
bool has_passed_ground(const StepInProgress& p) {
    const Model& model = p.bench.model;
    if (!has_gravity(model)) return false;
    return !detected_contacts(model, p.step.end.body, false).unheld_tips.empty() &&
           !is_held_anew(p, p.goal.balance.share);
}

/// Whether the body stands though contacts detected anew do not hold it: two sets of them take turns, each detected where the other one has
/// brought it, or it comes back to where it was.
bool stays_in_place(const StepInProgress& p, const Eigen::VectorXd& before, const Eigen::VectorXd& two_before) {
    const BlockSystem& system = p.bench.model.system;
    const double back = relative_motion(system, p.displacement() - two_before);
    const double moved = relative_motion(system, p.displacement() - before);
    return moved <= far && back <= std::max(in_place, same_place * moved);
}

/// The block that moves farthest, beside its size.
MovingBlock farthest_block(const BlockSystem& system, const Eigen::VectorXd& motion) {
    MovingBlock farthest;
    double largest = -1.0;
    for (int b = 0; b < system.n_blocks(); ++b) {
        const Vec2 moved = motion.segment<2>(n_block_unknowns * b);
        const double share = moved.norm() / motion_scale(system, system.blocks[b]);
        if (share <= largest) continue;
        largest = share;
        farthest = {.block = b, .direction = moved.normalized()};
    }
    return farthest;
}

/// The body is balanced each time: what is named is the block that goes farthest.
void fail_by_moving_on(StepInProgress& p, const Equilibrium& found, const Eigen::VectorXd& motion) {
    fail(p, found, found.viscous_share, FailureKind::falling);
    const BlockSystem& system = p.bench.model.system;
    Failure& failure = *p.step.failure;
    failure.moving = {farthest_block(system, motion)};
    failure.along = moving_along(system, p.displacement() - motion, p.displacement(), failure.moving);
    failure.what = fmt::format("each time its contacts are detected anew the body moves on, {} times at this load: {}",
                               max_rounds_of_detection, description(p.bench.model, all_moving(failure)));
}

} // namespace

Equilibrium find_again(StepInProgress& p) {
    PlacedState placed = place(p);
    Equilibrium found = find_at(p, placed, p.load_factor(), p.displacement());
    if (!rests_at(p, placed, found)) found = recover(p, placed, p.load_factor());
    if (!p.failed()) reach(p, std::move(placed), found);
    return found;
}

void let_contacts_follow(StepInProgress& p, Eigen::VectorXd placed_at) {
    const bool given = p.goal.must_rest || is_loaded_by_stress(p.bench.stage(p.from));
    bool stands = !p.goal.must_rest; // else contacts detected anew tell, however little has moved
    const auto goes_on = [&] {
        if (p.failed() || !p.step.balanced) return false;
        if (!given) return has_passed_ground(p);
        return !stands || has_moved_far(p, placed_at) || (!p.goal.must_rest && !is_held_anew(p));
    };
    const Eigen::VectorXd began = p.displacement();
    for (int round = 0; goes_on(); ++round) {
        stands = true;
        const Eigen::VectorXd before = std::exchange(placed_at, p.displacement());
        if (!given) p.step.equilibria.pop_back(); // what held it there holds it no more
        const Equilibrium found = find_again(p);
        if (!p.goal.must_rest && stays_in_place(p, placed_at, before)) return;
        if (p.failed() || round < max_rounds_of_detection) continue;
        if (!given) return;
        if (!has_moved_far(p, placed_at) && !has_moved_far(p, began)) return;
        fail_by_moving_on(p, found, p.displacement() - placed_at);
    }
}

std::string contacts_anew_warning(const Model& model, const State& state) {
    const Stage& stage = model.loads.stages[state.at.stage];
    if (stage.strength_reduction || !is_loaded_by_stress(stage)) return {};
    std::string warning;
    with_body_of_state(model, state, [&](const LoadedBody& body) {
        if (body.placement->contacts.empty()) return;
        const BlockVerdict verdict = verdict_anew(body, state.body.displacement);
        if (verdict.balanced()) return;
        warning =
            fmt::format("where the body stands two sets of contacts take turns, each detected where the other one "
                        "has brought it: they leave {:.3g} % of what acts on a block out of balance: {}",
                        100.0 * verdict.error, description(model, verdict.moving));
    });
    return warning;
}

} // namespace kluft
