#include "kluft/loading/block_balance.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <span>
#include <utility>

#include <Eigen/LU>

#include "kluft/core/dense_decompositions.hpp"
#include "kluft/core/disjoint_sets.hpp"

namespace kluft {

namespace {

constexpr double least_progress = 0.7; ///< of what is left over, from one solve to the next: else the block is moving
constexpr double least_turn = 0.1; ///< moment over sqrt(area) and force: a block turns too, as one that topples does
constexpr double much_more = 3.0;
constexpr double most_roundoff =
    0.01; ///< of the loads on a part and of its contact forces: with fewer digits nothing tells whether it stands
constexpr double balanced_loads =
    1e-3; ///< resultant of the loads on a block over the sum of their magnitudes: less is none
constexpr double touch_of_a_load = 0.1; ///< of (27c): less does not join a piece to what carries
constexpr double harmless_share =
    0.1; ///< of the largest share: what a block without loads may leave of forces around it

/// A point where two blocks meet.
struct Meeting {
    int block_a = 0;
    int block_b = 0;
    Vec2 on_a = Vec2::Zero(); ///< force on a, and its opposite on b (N/m)
    double force = 0.0;       ///< its magnitude
    double stiffness = 0.0;   ///< Pa
    bool holds = false;       ///< bonded or locked
    bool bonded = false;      ///< of these, holds against tension
};

/// All points where blocks meet at q; `traction_of_contact(i)`: of contact i there.
template <class TractionOfContact>
std::vector<Meeting> meetings_of(const LoadedBody& body, const Eigen::VectorXd& q,
                                 TractionOfContact traction_of_contact) {
    const Placement& placement = *body.placement;
    std::vector<Meeting> meetings;
    meetings.reserve(n_bond_points * placement.bonds.size() + placement.contacts.size());
    const auto add = [&](const auto& pair, const Vec2& normal, const PointTraction& traction, bool holds, bool bonded) {
        const Vec2 on_a = pair.weight * (traction.normal * normal + traction.shear * pair.tangent);
        meetings.push_back({pair.block_a, pair.block_b, on_a, on_a.norm(),
                            pair.weight * (*body.laws)[pair.law].normal_stiffness, holds, bonded});
    };
    for (int i = 0; i < static_cast<int>(placement.bonds.size()); ++i) {
        const Bond& bond = placement.bonds[i];
        for (int k = 0; k < n_bond_points; ++k) add(bond, bond.normal(), bond_traction(body, i, k, q), true, true);
    }
    for (int i = 0; i < static_cast<int>(placement.contacts.size()); ++i) {
        const ContactPoint& point = placement.contacts[i];
        const PointTraction& traction = traction_of_contact(i);
        add(point, point.normal, traction, traction.state == ContactState::locked, false);
    }
    return meetings;
}

std::vector<Meeting> meetings_of(const LoadedBody& body, const Eigen::VectorXd& q) {
    return meetings_of(body, q, [&](int i) { return contact_traction(body, i, q); });
}

/// The blocks that are held together, two or more each.
std::vector<std::vector<int>> groups_of(int n_blocks, const std::vector<Meeting>& meetings) {
    DisjointSets sets(n_blocks);
    for (const Meeting& at : meetings)
        if (at.holds) sets.join(at.block_a, at.block_b);
    std::vector<std::vector<int>> members(n_blocks);
    for (int b = 0; b < n_blocks; ++b) members[sets.root(b)].push_back(b);
    std::erase_if(members, [](const auto& group) { return group.size() < 2; });
    return members;
}

/// What drives the whole body along translations that nothing resists, per area, where that is no more than a share of the loads
/// along them (27d): it accelerates all blocks alike, and strains none (Pa/m).
Vec2 drift_of(const BlockBalance& balance, const BlockGoal& goal) {
    Vec2 drift = Vec2::Zero();
    for (const auto& [direction, loads] : balance.free) {
        double driving = 0.0;
        for (const Vec3& left : balance.left) driving += left.head<2>().dot(direction);
        if (std::abs(driving) > goal.share * loads) continue;
        drift += driving / std::reduce(balance.area.begin(), balance.area.end()) * direction;
    }
    return drift;
}

/// A block, or a group of them, as one body.
struct Part {
    Vec3 left = Vec3::Zero();
    double own = 0.0;
    double around = 0.0;
    double roundoff = 0.0;
    bool loaded = false;
    [[nodiscard]] double size() const { return std::max(0.0, size_of(left) - roundoff); }
};

/// The part of a body that these blocks are, without what makes all of it drift; the moment is about the centroid of all.
Part part_of(const BlockBalance& balance, const Vec2& drift, std::span<const int> blocks) {
    Part part;
    double area = 0.0;
    Vec2 centre = Vec2::Zero();
    for (const int b : blocks) {
        area += balance.area[b];
        centre += balance.area[b] * balance.position[b];
    }
    centre /= area;
    double of_loads = 0.0;
    double of_contacts = 0.0;
    double contacts = 0.0; // of all of its blocks
    for (const int b : blocks) {
        const Vec2 force = balance.left[b].head<2>() - balance.area[b] * drift;
        part.left.head<2>() += force;
        part.left[2] += std::sqrt(balance.area[b] / area) * balance.left[b][2] +
                        cross(balance.position[b] - centre, force) / std::sqrt(area);
        part.loaded = part.loaded || balance.forces.loaded[b];
        (balance.forces.loaded[b] ? of_loads : of_contacts) += balance.forces.own[b];
        contacts += balance.forces.of_contacts[b];
        part.around = std::max(part.around, balance.forces.around[b]);
        part.roundoff += balance.forces.roundoff[b];
    }
    part.own = part.loaded ? of_loads : of_contacts;
    if (part.loaded) {
        part.around = part.own;
        part.roundoff = std::min(part.roundoff, most_roundoff * std::max(part.own, contacts));
    }
    return part;
}

/// The share of what is left over, and whether that has fallen.
struct Share {
    double value = 0.0;
    bool falls = false;
};

MovingBlock moved_by(const Vec3& left, int block) {
    const Vec2 force = left.head<2>();
    const double length = force.norm();
    const bool turns = std::abs(left[2]) > least_turn * length;
    return {block, length > 0.0 ? Vec2(force / length) : Vec2(Vec2::Zero()), turns ? (left[2] > 0.0 ? 1 : -1) : 0};
}

Share share_of(const Part& now, const Part* before, const BlockGoal& goal) {
    const auto share = [&](double force) { return now.size() > 0.0 ? now.size() / std::max(force, 1e-300) : 0.0; };
    Share result;
    if (now.own == 0.0) return result; // it touches nothing, and nothing acts on it
    result.falls = before != nullptr && now.size() <= least_progress * before->size();
    const bool disturbs_nobody = share(now.around) <= harmless_share * goal.share;
    result.value = !now.loaded && (result.falls || disturbs_nobody) ? share(now.around) : share(now.own);
    return result;
}

/// Two blocks that meet, and the sum of the magnitudes of what acts between them (N/m).
struct Neighbours {
    int block_a = 0;
    int block_b = 0;
    double force = 0.0;
};

/// Each pair once, in ascending order.
std::vector<Neighbours> neighbours_of(const std::vector<Meeting>& meetings) {
    std::vector<Neighbours> all;
    const auto same_blocks = [](const Neighbours& p, const Neighbours& q) {
        return p.block_a == q.block_a && p.block_b == q.block_b;
    };
    const auto append = [&](const Neighbours& next) {
        if (all.empty() || !same_blocks(all.back(), next)) all.push_back({next.block_a, next.block_b, 0.0});
        all.back().force += next.force;
    };
    for (const Meeting& at : meetings)
        append({std::min(at.block_a, at.block_b), std::max(at.block_a, at.block_b), at.force});
    const auto blocks_of = [](const Neighbours& p) { return std::pair(p.block_a, p.block_b); };
    if (!std::ranges::is_sorted(all, {}, blocks_of)) std::ranges::stable_sort(all, {}, blocks_of);
    const std::vector<Neighbours> sorted = std::exchange(all, {});
    for (const Neighbours& next : sorted) append(next);
    return all;
}

/// What is left over on a loaded block disturbs the blocks that it presses on: where its load is much more than what acts
/// between them, and than what acts on the other one, that is what counts. The weight of a large block, which its support
/// carries, hides nothing so (27a).
void keep_below_neighbours(const std::vector<Neighbours>& neighbours, OwnForces& forces) {
    const std::vector<double> own = forces.own;
    const auto lower = [&](int block, int other, double force) {
        if (forces.loaded[block] && force > 0.0)
            forces.own[block] = std::min(forces.own[block], much_more * std::max(own[other], force));
    };
    for (const auto& [a, b, force] : neighbours) {
        lower(a, b, force);
        lower(b, a, force);
    }
}

/// Whether a support or a platen holds a point of the block.
std::vector<char> supported_blocks(const LoadedBody& body) {
    std::vector<char> supported(body.system->blocks.size(), 0);
    for (std::size_t b = 0; b < supported.size(); ++b) supported[b] = body.system->blocks[b].fixed ? 1 : 0;
    for (const ConstrainedBlock& each : body.loads->constraints.blocks()) supported[each.block] = 1;
    return supported;
}

/// The sum of the forces that the body presses on its supports and platens with, by what the blocks there get from others.
double carried_by_supports(const std::vector<char>& supported, const std::vector<Meeting>& meetings) {
    std::vector<Vec2> forces(supported.size(), Vec2::Zero());
    for (const Meeting& at : meetings) {
        forces[at.block_a] += at.on_a;
        forces[at.block_b] -= at.on_a;
    }
    double sum = 0.0;
    for (std::size_t b = 0; b < supported.size(); ++b)
        if (supported[b] != 0) sum += forces[b].norm();
    return sum;
}

/// Those that no chain of bonds and of forces that count leads from to a support. Source: (27c).
std::vector<char> blocks_aside(const LoadedBody& body, const std::vector<char>& supported,
                               const std::vector<Meeting>& meetings) {
    const std::vector<Block>& blocks = body.system->blocks;
    DisjointSets pieces(body.system->n_blocks());
    for (const Meeting& at : meetings) {
        const double area = std::min(blocks[at.block_a].area, blocks[at.block_b].area);
        const double least = touch_of_a_load * negligible_force(body.carried_stress, area);
        if (at.bonded || at.force > least) pieces.join(at.block_a, at.block_b);
    }
    std::vector<char> carries(blocks.size(), 0); // at the root of a piece
    for (std::size_t b = 0; b < blocks.size(); ++b)
        if (supported[b] != 0) carries[pieces.root(static_cast<int>(b))] = 1;
    std::vector<char> aside(blocks.size());
    for (std::size_t b = 0; b < blocks.size(); ++b) aside[b] = carries[pieces.root(static_cast<int>(b))] == 0 ? 1 : 0;
    return aside;
}

/// Sets what carries nothing (27c).
void find_idle(const LoadedBody& body, const std::vector<Meeting>& meetings, OwnForces& forces) {
    if (!(body.carried_stress > 0.0)) return;
    const std::vector<char> supported = supported_blocks(body);
    const double negligible = negligible_force(body.carried_stress, area_of(*body.system)); // (27c)
    forces.has_shed_its_load = carried_by_supports(supported, meetings) <= negligible;
    forces.idle =
        forces.has_shed_its_load ? std::vector<char>(supported.size(), 1) : blocks_aside(body, supported, meetings);
}

/// Of blocks that no other load acts on, whether the friction of a platen does.
std::vector<char> rubbed_by_platens(const LoadedBody& body, const std::vector<double>& load_magnitudes) {
    std::vector<double> friction(load_magnitudes.size(), 0.0);
    for (const PointLoad& each : body.loads->friction) friction[each.block] += each.force.norm();
    std::vector<char> rubbed(load_magnitudes.size());
    for (std::size_t b = 0; b < rubbed.size(); ++b)
        rubbed[b] = friction[b] > 0.0 && load_magnitudes[b] <= friction[b] ? 1 : 0;
    return rubbed;
}

/// The own forces of what carries nothing (27c), beside which the friction of a platen that hardly touches is no load.
void raise_to_negligible(const LoadedBody& body, const std::vector<char>& rubbed, OwnForces& forces) {
    for (std::size_t b = 0; b < forces.idle.size(); ++b) {
        if (forces.idle[b] == 0) continue;
        const double negligible = negligible_force(body.carried_stress, body.system->blocks[b].area);
        if (rubbed[b] != 0 && forces.own[b] < negligible) {
            forces.loaded[b] = 0;
            forces.own[b] = std::max(forces.own[b], forces.of_contacts[b]);
        }
        if (!forces.loaded[b] && forces.own[b] > 0.0) forces.own[b] = std::max(forces.own[b], negligible);
    }
}

OwnForces own_forces(const LoadedBody& body, const Eigen::VectorXd& q, const std::vector<Meeting>& meetings) {
    const auto n = static_cast<std::size_t>(body.system->n_blocks());
    OwnForces result{driving_loads(body, q),     {}, std::vector<double>(n, 0.0), std::vector<char>(n, 0), false, {},
                     std::vector<double>(n, 0.0)};
    const std::vector<double> magnitudes = load_magnitudes(body, q);
    const auto roundoff_of = [](double stiffness, double moved) {
        return 64.0 * std::numeric_limits<double>::epsilon() * stiffness * moved;
    };
    const auto motion = [&](int b) {
        return q.segment<n_block_unknowns>(n_block_unknowns * b).lpNorm<Eigen::Infinity>();
    };
    for (const Meeting& at : meetings) {
        const double roundoff = roundoff_of(at.stiffness, std::max(motion(at.block_a), motion(at.block_b)));
        for (const int b : {at.block_a, at.block_b}) {
            result.of_contacts[b] += at.force;
            result.roundoff[b] = std::max(result.roundoff[b], roundoff);
        }
    }
    for (std::size_t b = 0; b < n; ++b) {
        const ElasticModuli& moduli = (*body.moduli)[body.system->blocks[b].material];
        result.roundoff[b] =
            std::max(result.roundoff[b], roundoff_of(2.0 * moduli.mu + moduli.lambda, motion(static_cast<int>(b))));
        result.loaded[b] = result.own[b] > balanced_loads * magnitudes[b];
        if (result.loaded[b]) continue;
        result.own[b] = result.of_contacts[b];
        if (result.of_contacts[b] == 0.0) result.own[b] = magnitudes[b];
    }
    const std::vector<Neighbours> neighbours = neighbours_of(meetings);
    keep_below_neighbours(neighbours, result);
    find_idle(body, meetings, result);
    raise_to_negligible(body, rubbed_by_platens(body, magnitudes), result);
    result.around = result.own;
    const auto take = [&](int block,
                          int other) { // a fixed one carries whatever stands on it, and is disturbed by nothing
        if (!result.loaded[block] && !body.system->blocks[other].fixed)
            result.around[block] = std::max(result.around[block], result.own[other]);
    };
    for (const auto& [a, b, force] : neighbours) {
        take(a, b);
        take(b, a);
    }
    return result;
}

} // namespace

OwnForces own_forces(const LoadedBody& body, const Eigen::VectorXd& q) {
    return own_forces(body, q, meetings_of(body, q));
}

/// The moment is h times the force on w, h dtheta = dw.
Vec3 affine_rigid_part(const BlockSystem& system, const Eigen::VectorXd& q, const Eigen::VectorXd& forces, int b) {
    const Block& block = system.blocks[b];
    Vec3 part = rigid_motion(q, b, block.size).transpose() * forces.segment<n_block_unknowns>(n_block_unknowns * b);
    part[2] *= block.size / std::sqrt(block.area);
    return part;
}

namespace {

constexpr double not_held =
    1e-9; ///< of the cube of the mean eigenvalue, or of the largest one: of rows that leave a motion free

/// Of each block, whether its prescribed displacements leave no rigid motion free.
std::vector<char> held_blocks(const LoadedBody& body) {
    std::vector<char> held(body.system->blocks.size(), 0);
    const std::vector<PrescribedDisplacement>& rows = body.loads->constraints.rows();
    for (const ConstrainedBlock& each : body.loads->constraints.blocks()) {
        Mat3 resistance = Mat3::Zero();
        for (const int r : each.rows) {
            const Vec2& n = rows[r].direction;
            const Vec3 row(n.x(), n.y(), cross(rows[r].xi, n));
            resistance += row * row.transpose();
        }
        const double mean = resistance.trace() / 3.0;
        held[each.block] = resistance.determinant() > not_held * mean * mean * mean ? 1 : 0;
    }
    return held;
}

std::vector<FreeTranslation> free_translations(const LoadedBody& body, const Eigen::VectorXd& q) {
    Mat2 resistance = Mat2::Zero();
    for (const PrescribedDisplacement& row : body.loads->constraints.rows())
        resistance += row.direction * row.direction.transpose();
    const SymmetricEigen eigen = symmetric_eigen(resistance);
    std::vector<FreeTranslation> free;
    for (int i = 0; i < 2; ++i) {
        if (eigen.values[i] > not_held * eigen.values[1]) continue;
        const Vec2 direction = eigen.vectors.col(i);
        free.push_back({direction, loads_along(body, q, direction)});
    }
    return free;
}

BlockBalance balance_of(const LoadedBody& body, const Eigen::VectorXd& q, std::vector<Vec3> left,
                        const std::vector<Meeting>& meetings) {
    const BlockSystem& system = *body.system;
    BlockBalance result;
    result.forces = own_forces(body, q, meetings);
    result.groups = groups_of(system.n_blocks(), meetings);
    result.left = std::move(left);
    result.held = held_blocks(body);
    result.free = free_translations(body, q);
    for (int b = 0; b < system.n_blocks(); ++b) {
        result.position.push_back(system.blocks[b].centroid + q.segment<2>(n_block_unknowns * b));
        result.area.push_back(system.blocks[b].area);
    }
    return result;
}

} // namespace

BlockBalance block_balance(const LoadedBody& body, const Eigen::VectorXd& q, std::vector<Vec3> left) {
    return balance_of(body, q, std::move(left), meetings_of(body, q));
}

BlockBalance affine_block_balance(const LoadedBody& body, const Eigen::VectorXd& q) {
    BodyForces sum;
    std::vector<PointTraction> tractions;
    tractions.reserve(body.placement->contacts.size());
    body_forces(body, q, sum, tractions);
    keep_free_part(*body.loads, travel_of_platen(*body.loads, q.size()), q, sum.forces);
    std::vector<Vec3> left;
    for (int b = 0; b < body.system->n_blocks(); ++b)
        left.push_back(-affine_rigid_part(*body.system, q, sum.forces, b));
    const auto traction_of = [&](int i) -> const PointTraction& { return tractions[i]; };
    return balance_of(body, q, std::move(left), meetings_of(body, q, traction_of));
}

BlockVerdict judge_blocks(const BlockBalance& now, const BlockBalance* before, const BlockGoal& goal) {
    BlockVerdict verdict;
    double worst = 0.0;
    const Vec2 drift = drift_of(now, goal);
    const Vec2 drift_before = before != nullptr ? drift_of(*before, goal) : Vec2::Zero();
    const auto judge = [&](std::span<const int> blocks) {
        const Part part = part_of(now, drift, blocks);
        const Part part_before = before != nullptr ? part_of(*before, drift_before, blocks) : Part{};
        const Share share = share_of(part, before != nullptr ? &part_before : nullptr, goal);
        verdict.error = std::max(verdict.error, share.value);
        if (share.value <= goal.share) return;
        verdict.falls = verdict.falls && share.falls;
        for (const int b : blocks) verdict.moving.push_back(moved_by(part.left, b));
        if (share.value <= worst) return;
        worst = share.value;
        std::swap(verdict.moving.front(), verdict.moving[verdict.moving.size() - blocks.size()]);
    };
    for (int b = 0; b < static_cast<int>(now.left.size()); ++b) judge(std::span(&b, 1));
    for (const std::vector<int>& group : now.groups) judge(group);
    const auto is_held = [&](const MovingBlock& each) { return now.held[each.block] != 0; };
    if (!std::ranges::all_of(verdict.moving, is_held)) std::erase_if(verdict.moving, is_held); // what others do to it
    return verdict;
}

} // namespace kluft
