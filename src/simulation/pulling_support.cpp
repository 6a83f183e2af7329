#include "kluft/simulation/pulling_support.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <tuple>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "kluft/blocks/block_search.hpp"
#include "kluft/core/disjoint_sets.hpp"
#include "kluft/core/place_text.hpp"
#include "kluft/loading/acting_forces.hpp"
#include "kluft/loading/loaded_body.hpp"
#include "kluft/simulation/state_fields.hpp"

namespace kluft {

namespace {

constexpr double large_pull = 0.05;    ///< of what acts on the piece
constexpr double large_turning = 0.01; ///< of the loads on the part
constexpr double straight_enough =
    1e-3; ///< how far the points of a straight support are beside its line, of its length

/// Blocks that bonds hold together, and what acts on them (N/m).
struct HeldPiece {
    double loads = 0.0;           ///< magnitudes of weights, pressures and point forces
    double contact_forces = 0.0;  ///< magnitudes of those of other pieces
    double unused_friction = 0.0; ///< what the shear forces of contacts in it lack of Coulomb's limit
    int n_blocks = 0;
    bool has_joint = false;
    bool has_fixed_block = false;
    std::set<int> fixed_boundaries; ///< whose support holds it against any motion
};

/// Normal to the sides of a block on a boundary, outward (unit).
Vec2 outward_normal(const BlockSystem& system, int boundary, int block) {
    Vec2 sum = Vec2::Zero();
    for (const BoundaryEdge& each : system.boundaries[boundary].edges) {
        if (each.block != block) continue;
        const Edge& edge = system.blocks[block].edges[each.edge];
        sum += right_normal(edge_end(system, edge) - edge_start(system, edge));
    }
    return sum.stableNormalized();
}

class HeldPieces {
public:
    HeldPieces(const LoadedBody& body, const Eigen::VectorXd& q)
        : sets_(body.system->n_blocks()), pieces_(body.system->blocks.size()) {
        for (const Bond& bond : body.placement->bonds) sets_.join(bond.block_a, bond.block_b);
        const std::vector<double> loads = load_magnitudes(body, q);
        for (int b = 0; b < body.system->n_blocks(); ++b) {
            HeldPiece& piece = of_block(b);
            ++piece.n_blocks;
            piece.loads += loads[b];
            piece.has_fixed_block = piece.has_fixed_block || body.system->blocks[b].fixed;
        }
        for (const ContactPoint& point : body.placement->contacts) add_contact(body, point, q);
    }

    [[nodiscard]] int number_of(int block) { return sets_.root(block); }
    [[nodiscard]] HeldPiece& of_block(int block) { return pieces_[sets_.root(block)]; }

private:
    void add_contact(const LoadedBody& body, const ContactPoint& point, const Eigen::VectorXd& q) {
        if (number_of(point.block_a) == number_of(point.block_b)) return;
        const PointTraction traction = contact_traction(*body.laws, point, q);
        const double unused = std::max(0.0, coulomb_limit(*body.laws, point, q) - std::abs(traction.shear));
        for (const int block : {point.block_a, point.block_b}) {
            HeldPiece& piece = of_block(block);
            piece.has_joint = true;
            piece.contact_forces += point.weight * Vec2(traction.normal, traction.shear).norm();
            piece.unused_friction += point.weight * unused;
        }
    }

    DisjointSets sets_;
    std::vector<HeldPiece> pieces_; ///< each where its set has its root
};

/// Whether nothing but the support of this boundary and joints hold the piece.
bool is_held_alone(const HeldPiece& piece, int boundary) {
    return piece.has_joint && !piece.has_fixed_block &&
           std::ranges::all_of(piece.fixed_boundaries, [&](int fixed) { return fixed == boundary; });
}

/// Whether joints could not take over what a support pulls with.
bool is_needed(const HeldPiece& piece, double pull) {
    return pull - piece.unused_friction > large_pull * std::max(piece.loads, piece.contact_forces);
}

/// What a support pulls a piece with, and its most pulled block.
struct Pull {
    double force = 0.0;
    double of_block = 0.0;
    int block = -1;
};

bool has_platen(const Model& model) {
    return std::ranges::any_of(model.loads.stages, [](const Stage& stage) { return stage.motion.has_value(); });
}

/// Blocks that bonds and closed contacts hold together, and what holds them from outside.
struct JoinedPart {
    double loads = 0.0; ///< magnitudes of weights, pressures and point forces (N/m)
    int n_blocks = 0;
    bool has_joint = false; ///< a closed contact
    bool has_fixed_block = false;
    std::vector<SupportForce> supports; ///< forces of the boundaries' supports
};

std::map<int, JoinedPart> joined_parts(const LoadedBody& body, const Eigen::VectorXd& q) {
    const int n_blocks = body.system->n_blocks();
    DisjointSets sets(n_blocks);
    std::vector<char> has_joint(body.system->blocks.size(), 0);
    for (const Bond& bond : body.placement->bonds) sets.join(bond.block_a, bond.block_b);
    for (const ContactPoint& point : body.placement->contacts) {
        if (contact_traction(*body.laws, point, q).state == ContactState::open) continue;
        sets.join(point.block_a, point.block_b);
        has_joint[point.block_a] = 1;
    }
    std::map<int, JoinedPart> parts;
    const std::vector<double> loads = load_magnitudes(body, q);
    for (int b = 0; b < n_blocks; ++b) {
        JoinedPart& part = parts[sets.root(b)];
        ++part.n_blocks;
        part.loads += loads[b];
        part.has_joint = part.has_joint || has_joint[b] != 0;
        part.has_fixed_block = part.has_fixed_block || body.system->blocks[b].fixed;
    }
    for (const SupportForce& each : support_forces(body, q))
        if (each.kind == SupportKind::support) parts[sets.root(each.block)].supports.push_back(each);
    return parts;
}

/// What a support does on a part that it alone holds. Its points lie in one line, so that only the normal forces have a moment
/// about a point of it.
TurningPart turning(const BlockSystem& system, const JoinedPart& part) {
    TurningPart none;
    if (!part.has_joint || part.has_fixed_block || part.supports.empty()) return none;
    const int boundary = part.supports.front().boundary;
    Vec2 outward = Vec2::Zero();
    for (const SupportForce& each : part.supports) {
        if (each.boundary != boundary) return none;
        outward += outward_normal(system, boundary, each.block);
    }
    outward = outward.stableNormalized();
    const Vec2 along(-outward.y(), outward.x());
    std::vector<double> places_along;
    std::vector<double> places_out;
    std::vector<double> pulls;
    for (const SupportForce& each : part.supports) {
        places_along.push_back(along.dot(each.place));
        places_out.push_back(outward.dot(each.place));
        pulls.push_back(outward.dot(each.force));
    }
    const auto [first, last] = std::ranges::minmax(places_along);
    const auto [lowest, highest] = std::ranges::minmax(places_out);
    const double length = last - first;
    if (!(length > 0.0) || highest - lowest > straight_enough * length) return none;
    double press = 0.0;
    double moment = 0.0; // about the first point
    for (std::size_t i = 0; i < pulls.size(); ++i) {
        press -= pulls[i];
        moment -= pulls[i] * (places_along[i] - first);
    }
    if (press <= 0.0) return none;
    TurningPart found{.boundary = boundary, .n_blocks = part.n_blocks};
    found.block = part.supports[static_cast<std::size_t>(std::ranges::max_element(pulls) - pulls.begin())].block;
    found.beyond = std::max(-moment / press, moment / press - length);
    found.force = press * found.beyond / length;
    return found.force > large_turning * part.loads ? found : none;
}

std::string turning_warning(const Model& model, const TurningPart& found) {
    const BlockSystem& system = model.system;
    return fmt::format(
        "the support of '{}' keeps block {} at {} and what is joined to it, {} blocks, from turning over: "
        "it holds in tension, too, {:.3g} kN/m here, and its resultant lies {:.3g} m beyond the end of "
        "what it holds. Rock that may part from what is below it stands on a fixed block, beside a joint",
        system.boundaries[found.boundary].name, block_label(system, found.block),
        place_text(system.origin + system.blocks[found.block].centroid), found.n_blocks, 1e-3 * found.force,
        found.beyond);
}

} // namespace

PullingSupport strongest_pulling_support(const Model& model, const State& state) {
    PullingSupport strongest;
    if (has_platen(model)) return strongest;
    with_body_of_state(model, state, [&](const LoadedBody& body) {
        const Eigen::VectorXd& q = state.body.displacement;
        std::map<std::pair<int, int>, double> of_blocks; // by (boundary, block)
        HeldPieces pieces(body, q);
        for (const SupportForce& each : support_forces(body, q)) {
            if (each.kind != SupportKind::support) continue;
            of_blocks[{each.boundary, each.block}] +=
                each.force.dot(outward_normal(model.system, each.boundary, each.block));
            if (model.loads.supports[each.boundary] == Support::fixed)
                pieces.of_block(each.block).fixed_boundaries.insert(each.boundary);
        }
        std::map<std::pair<int, int>, Pull> of_pieces; // by (boundary, piece)
        for (const auto& [of, force] : of_blocks) {
            Pull& pull = of_pieces[{of.first, pieces.number_of(of.second)}];
            pull.force += force;
            if (force > pull.of_block) std::tie(pull.of_block, pull.block) = std::tie(force, of.second);
        }
        for (const auto& [of, pull] : of_pieces) {
            const HeldPiece& piece = pieces.of_block(of.second);
            if (pull.force > strongest.force && is_held_alone(piece, of.first) && is_needed(piece, pull.force))
                strongest = {
                    .boundary = of.first, .block = pull.block, .n_blocks = piece.n_blocks, .force = pull.force};
        }
    });
    return strongest;
}

TurningPart strongest_turning_part(const Model& model, const State& state) {
    TurningPart strongest;
    if (has_platen(model)) return strongest;
    with_body_of_state(model, state, [&](const LoadedBody& body) {
        for (const auto& [root, part] : joined_parts(body, state.body.displacement)) {
            const TurningPart found = turning(model.system, part);
            if (found.boundary >= 0 && found.force > strongest.force) strongest = found;
        }
    });
    return strongest;
}

std::string pulling_support_warning(const Model& model, const State& state) {
    const PullingSupport found = strongest_pulling_support(model, state);
    if (found.boundary < 0) {
        const TurningPart part = strongest_turning_part(model, state);
        return part.boundary < 0 ? std::string() : turning_warning(model, part);
    }
    const BlockSystem& system = model.system;
    return fmt::format("the support of '{}' pulls block {} at {}{} with {:.3g} kN/m: it holds in tension, too. Rock "
                       "that may part from what is behind it, as behind an open joint, stands beside a fixed block or "
                       "has no support there",
                       system.boundaries[found.boundary].name, block_label(system, found.block),
                       place_text(system.origin + system.blocks[found.block].centroid),
                       found.n_blocks > 1 ? " and what is bonded to it" : "", 1e-3 * found.force);
}

} // namespace kluft
