#include "kluft/equilibrium/part_of_body.hpp"

#include <algorithm>
#include <array>
#include <unordered_map>
#include <utility>

namespace kluft {

namespace {

template <class Pair> std::array<int, 2> both_blocks(const Pair& pair) { return {pair.block_a, pair.block_b}; }
template <class Load> std::array<int, 1> its_block(const Load& load) { return {load.block}; }

int other_block(const auto& pair, int block) { return pair.block_a == block ? pair.block_b : pair.block_a; }

/// What forces depend on: the edges of a block are not part of it.
Block without_edges(const Block& block) {
    Block copy;
    copy.centroid = block.centroid;
    copy.area = block.area;
    copy.size = block.size;
    copy.second_moment = block.second_moment;
    copy.material = block.material;
    copy.fixed = block.fixed;
    return copy;
}

} // namespace

// ---- what blocks touch ---------------------------------------------------------------------------------------------

Surroundings::Surroundings(const EquilibriumProblem& problem)
    : problem_(problem), contacts_(problem.body.system->n_blocks(), problem.body.placement->contacts,
                                   [](const ContactPoint& point) { return both_blocks(point); }),
      bonds_(problem.body.system->n_blocks(), problem.body.placement->bonds,
             [](const Bond& bond) { return both_blocks(bond); }),
      pressure_edges_(problem.body.system->n_blocks(), problem.body.loads->pressure_edges,
                      [](const PressureEdge& edge) { return its_block(edge); }),
      point_loads_(problem.body.system->n_blocks(), problem.body.loads->point_loads,
                   [](const PointLoad& load) { return its_block(load); }),
      friction_(problem.body.system->n_blocks(), problem.body.loads->friction,
                [](const PointLoad& load) { return its_block(load); }) {}

std::vector<int> Surroundings::neighbours(int block) const {
    const Placement& placement = *problem_.body.placement;
    std::vector<int> result;
    for (const int i : contacts_.of(block)) result.push_back(other_block(placement.contacts[i], block));
    for (const int i : bonds_.of(block)) result.push_back(other_block(placement.bonds[i], block));
    return result;
}

// ---- a part ----------------------------------------------------------------------------------------------------------

PartOfBody::PartOfBody(const Surroundings& surroundings, const std::vector<int>& free, const Eigen::VectorXd& q)
    : n_free_(static_cast<int>(free.size())), blocks_(free), problem_(surroundings.problem()) {
    take_interfaces(surroundings);
    take_loads(surroundings);
    const EquilibriumProblem& whole = surroundings.problem();
    system_.spacing = whole.body.system->spacing;
    for (const int b : blocks_) system_.blocks.push_back(without_edges(whole.body.system->blocks[b]));
    problem_.body.system = &system_;
    problem_.body.placement = &placement_;
    problem_.body.loads = &loads_;
    problem_.eta.clear();
    start_.resize(n_block_unknowns * static_cast<Eigen::Index>(blocks_.size()));
    problem_.start = Eigen::VectorXd(start_); // moved: the whole body's is given back after that
    for (std::size_t i = 0; i < blocks_.size(); ++i) {
        const auto here = static_cast<Eigen::Index>(n_block_unknowns * i);
        const Eigen::Index there = n_block_unknowns * static_cast<Eigen::Index>(blocks_[i]);
        start_.segment<n_block_unknowns>(here) = q.segment<n_block_unknowns>(there);
        if (whole.eta.empty()) continue;
        problem_.eta.push_back(whole.eta[blocks_[i]]);
        problem_.start.segment<n_block_unknowns>(here) = whole.start.segment<n_block_unknowns>(there);
    }
}

/// The points of the free blocks. Blocks that these touch join the part behind them. A point between two free blocks is
/// taken with the first of them.
void PartOfBody::take_interfaces(const Surroundings& surroundings) {
    const Placement& whole = *surroundings.problem().body.placement;
    std::unordered_map<int, int> index;
    for (int i = 0; i < n_free_; ++i) index.emplace(blocks_[i], i);
    const auto index_of = [&](int block) {
        const auto [place, is_new] = index.try_emplace(block, static_cast<int>(blocks_.size()));
        if (is_new) blocks_.push_back(block);
        return place->second;
    };
    const auto take = [&](const auto& pair, int i, auto& taken) {
        const int other = index_of(other_block(pair, blocks_[i]));
        if (other < i) return;
        auto copy = pair;
        copy.block_a = index_of(pair.block_a);
        copy.block_b = index_of(pair.block_b);
        pairs_.emplace_back(copy.block_a, copy.block_b);
        taken.push_back(copy);
    };
    for (int i = 0; i < n_free_; ++i) {
        for (const int k : surroundings.contacts().of(blocks_[i])) take(whole.contacts[k], i, placement_.contacts);
        for (const int k : surroundings.bonds().of(blocks_[i])) take(whole.bonds[k], i, placement_.bonds);
    }
}

void PartOfBody::take_loads(const Surroundings& surroundings) {
    const Loads& whole = *surroundings.problem().body.loads;
    loads_.pressures = whole.pressures;
    loads_.gravity = whole.gravity;
    std::unordered_map<int, int> index;
    for (int i = 0; i < n_free_; ++i) index.emplace(blocks_[i], i);
    std::vector<PrescribedDisplacement> rows;
    for (const ConstrainedBlock& held : whole.constraints.blocks()) {
        const auto place = index.find(held.block);
        if (place == index.end()) continue;
        for (const int row : held.rows) {
            rows.push_back(whole.constraints.rows()[row]);
            rows.back().block = place->second;
        }
    }
    loads_.constraints = Constraints(std::move(rows));
    const auto take = [&](const auto& loads, std::span<const int> indices, int i, auto& taken) {
        for (const int k : indices) {
            taken.push_back(loads[k]);
            taken.back().block = i;
        }
    };
    for (int i = 0; i < n_free_; ++i) {
        const int b = blocks_[i];
        take(whole.pressure_edges, surroundings.pressure_edges().of(b), i, loads_.pressure_edges);
        take(whole.point_loads, surroundings.point_loads().of(b), i, loads_.point_loads);
        take(whole.friction, surroundings.friction().of(b), i, loads_.friction);
    }
}

void PartOfBody::copy_back(const Eigen::VectorXd& part, Eigen::VectorXd& q) const {
    for (int i = 0; i < n_free_; ++i)
        q.segment<n_block_unknowns>(n_block_unknowns * static_cast<Eigen::Index>(blocks_[i])) =
            part.segment<n_block_unknowns>(n_block_unknowns * static_cast<Eigen::Index>(i));
}

} // namespace kluft
