#include "kluft/loading/boundary_geometry.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "kluft/kinematics/affine.hpp"

namespace kluft {

namespace {

using Edges = std::vector<BoundaryEdge>;

template <typename Visit> void for_each_edge(const BlockSystem& system, const Edges& edges, Visit visit) {
    for (const auto& [b, e] : edges) {
        const Edge& edge = system.blocks[b].edges[e];
        visit(b, edge_start(system, edge), edge_end(system, edge));
    }
}

template <typename Visit> void for_each_edge(const BlockSystem& system, int boundary, Visit visit) {
    for_each_edge(system, system.boundaries[boundary].edges, visit);
}

Vec2 mean_position(const BlockSystem& system, const Edges& edges) {
    Vec2 sum = Vec2::Zero();
    double length = 0.0;
    for_each_edge(system, edges, [&](int, const Vec2& start, const Vec2& end) {
        sum += 0.5 * (end - start).norm() * (start + end);
        length += (end - start).norm();
    });
    return length > 0.0 ? Vec2(sum / length) : sum;
}

constexpr double same_plane = 1e-9;     ///< of the body's larger side
constexpr double same_direction = 1e-6; ///< of the cosine between normals
constexpr double faces_all_ways = 1e-9; ///< of the length: what is left of the sum of normals is round-off

/// Whether a line from a point along a direction meets the body farther on than a distance.
bool meets_body(const BlockSystem& system, const Vec2& from, const Vec2& direction, double distance) {
    const Vec2 across = right_normal(direction);
    for (const Block& block : system.blocks) {
        for (const Edge& edge : block.edges) {
            const Vec2 start = edge_start(system, edge) - from;
            const Vec2 end = edge_end(system, edge) - from;
            const double a = across.dot(start);
            const double b = across.dot(end);
            if ((a < 0.0) == (b < 0.0)) continue;
            if (direction.dot(start + a / (a - b) * (end - start)) > distance) return true;
        }
    }
    return false;
}

Vec2 middle_of(const BlockSystem& system, int block, int e) {
    const Edge& edge = system.blocks[block].edges[e];
    return 0.5 * (edge_start(system, edge) + edge_end(system, edge));
}

/// Those whose normals are nearest to a direction, within 45 degrees of it.
std::vector<int> boundaries_facing(const BlockSystem& system, const Vec2& direction) {
    std::vector<int> facing;
    double most = 0.7; // cosine
    for (int i = 0; i < static_cast<int>(system.boundaries.size()); ++i) {
        const double cosine = direction.dot(boundary_frame(system, i).normal);
        if (cosine < most - same_direction) continue;
        if (cosine > most + same_direction) facing.clear();
        most = std::max(most, cosine);
        facing.push_back(i);
    }
    return facing;
}

/// Lengths that edges cover along an axis (m), a stretch that several of them cover once.
double covered_length(const BlockSystem& system, const Side& side, const Vec2& axis) {
    std::vector<std::pair<double, double>> stretches;
    for (const SidePart& part : side) {
        for_each_edge(system, part.edges, [&](int, const Vec2& start, const Vec2& end) {
            stretches.push_back(std::minmax({axis.dot(start), axis.dot(end)}));
        });
    }
    std::ranges::sort(stretches);
    double length = 0.0;
    double reached = -std::numeric_limits<double>::infinity();
    for (const auto& [from, to] : stretches) {
        length += std::max(0.0, to - std::max(from, reached));
        reached = std::max(reached, to);
    }
    return length;
}

/// All edges of some boundaries, with the lengths (m) that they have across a direction as their shares.
Side side_of(const BlockSystem& system, const std::vector<int>& boundaries, const Vec2& direction) {
    Side side;
    for (const int i : boundaries) {
        SidePart part{.boundary = i, .edges = system.boundaries[i].edges};
        for_each_edge(system, i, [&](int, const Vec2& start, const Vec2& end) {
            part.shares.push_back(direction.dot(right_normal(end - start)));
            part.share += part.shares.back();
        });
        side.push_back(std::move(part));
    }
    return side;
}

double length_of(const Side& side) {
    double length = 0.0;
    for (const SidePart& part : side) length += part.share;
    return length;
}

/// Sum of the places of the edges along a direction, times their shares.
double place_of(const BlockSystem& system, const Side& side, const Vec2& direction) {
    double place = 0.0;
    for (const SidePart& part : side)
        for (std::size_t i = 0; i < part.edges.size(); ++i)
            place += part.shares[i] * direction.dot(middle_of(system, part.edges[i].block, part.edges[i].edge));
    return place;
}

} // namespace

BoundaryFrame boundary_frame(const BlockSystem& system, int boundary) {
    BoundaryFrame frame;
    Vec2 sum = Vec2::Zero();
    for_each_edge(system, boundary, [&](int, const Vec2& start, const Vec2& end) {
        sum += right_normal(end - start);
        frame.length += (end - start).norm();
    });
    if (frame.length == 0.0) return frame;
    if (sum.norm() <= faces_all_ways * frame.length) return frame;
    frame.normal = sum.normalized();
    for (int i = 0; i < 2; ++i) { // a side along an axis has exactly that normal
        if (std::abs(frame.normal[i]) < 1e-12)
            frame.normal = Vec2::Unit(1 - i) * (frame.normal[1 - i] < 0.0 ? -1.0 : 1.0);
    }
    return frame;
}

std::vector<int> opposite_boundaries(const BlockSystem& system, int boundary) {
    constexpr double least_opposite = -0.5; // cosine between the normals
    const Vec2 normal = boundary_frame(system, boundary).normal;
    std::vector<double> cosines;
    for (int i = 0; i < static_cast<int>(system.boundaries.size()); ++i)
        cosines.push_back(normal.dot(boundary_frame(system, i).normal));
    std::vector<int> opposite;
    if (cosines.empty()) return opposite;
    const double most = std::ranges::min(cosines);
    if (most >= least_opposite) return opposite;
    for (int i = 0; i < static_cast<int>(cosines.size()); ++i)
        if (cosines[i] <= most + same_direction) opposite.push_back(i);
    return opposite;
}

int opposite_boundary(const BlockSystem& system, int boundary) {
    const std::vector<int> opposite = opposite_boundaries(system, boundary);
    return opposite.empty() ? -1 : opposite.front();
}

int resting_boundary(const BlockSystem& system, const PlatenMotion& motion) {
    return motion.against ? *motion.against : opposite_boundary(system, motion.boundary);
}

Vec2 mean_position(const BlockSystem& system, int boundary) {
    return mean_position(system, system.boundaries[boundary].edges);
}

Vec2 mean_displacement(const BlockSystem& system, const Eigen::VectorXd& q, int boundary) {
    Vec2 sum = Vec2::Zero();
    double length = 0.0;
    for_each_edge(system, boundary, [&](int b, const Vec2& start, const Vec2& end) {
        const Vec2 xi = block_coordinates(system.blocks[b], 0.5 * (start + end));
        sum += (end - start).norm() * displacement_at(q, b, xi);
        length += (end - start).norm();
    });
    return length > 0.0 ? Vec2(sum / length) : sum;
}

std::array<Side, 2> lateral_sides(const BlockSystem& system, int boundary) {
    const Vec2 normal = boundary_frame(system, boundary).normal;
    const Vec2 lateral(normal.y(), -normal.x());
    std::array<Side, 2> sides;
    for (int k = 0; k < 2; ++k) {
        const Vec2 direction = k == 0 ? lateral : Vec2(-lateral);
        sides[k] = side_of(system, boundaries_facing(system, direction), direction);
        if (length_of(sides[k]) <= 0.0) return {};
    }
    const std::array<double, 2> lengths{length_of(sides[0]), length_of(sides[1])};
    const double height = std::max(covered_length(system, sides[0], normal), covered_length(system, sides[1], normal));
    const double weight = std::max(lengths[0], lengths[1]) / height; // of both: their places have no common origin
    for (int k = 0; k < 2; ++k) {
        for (SidePart& part : sides[k]) {
            part.share /= lengths[k];
            for (double& share : part.shares) share *= weight / lengths[k];
            part.weight = std::accumulate(part.shares.begin(), part.shares.end(), 0.0);
        }
    }
    return sides;
}

Vec2 mean_displacement(const BlockSystem& system, const Eigen::VectorXd& q, const SidePart& part) {
    Vec2 sum = Vec2::Zero();
    for (std::size_t i = 0; i < part.edges.size(); ++i) {
        const auto& [b, e] = part.edges[i];
        sum += part.shares[i] * displacement_at(q, b, block_coordinates(system.blocks[b], middle_of(system, b, e)));
    }
    return sum / part.weight;
}

std::vector<BoundaryEdge> outer_edges(const BlockSystem& system, int boundary) {
    const Vec2 normal = boundary_frame(system, boundary).normal;
    const double outermost = outermost_place(system, system.boundaries[boundary].edges, normal);
    const double near = same_plane * (system.upper - system.lower).maxCoeff();
    std::vector<BoundaryEdge> outer;
    for (const auto& [b, e] : system.boundaries[boundary].edges) {
        const Vec2 middle = middle_of(system, b, e);
        if (normal.dot(middle) >= outermost - near || !meets_body(system, middle, normal, near))
            outer.push_back({b, e});
    }
    return outer;
}

double unevenness(const BlockSystem& system, int boundary) {
    const Vec2 normal = boundary_frame(system, boundary).normal;
    double least = std::numeric_limits<double>::infinity();
    double most = -least;
    for (const auto& [b, e] : outer_edges(system, boundary)) {
        const Edge& edge = system.blocks[b].edges[e];
        for (const Vec2& at : {edge_start(system, edge), edge_end(system, edge)}) {
            least = std::min(least, normal.dot(at));
            most = std::max(most, normal.dot(at));
        }
    }
    return std::max(0.0, most - least);
}

double outer_width(const BlockSystem& system, int boundary, const Vec2& lateral) {
    double width = 0.0;
    for_each_edge(system, outer_edges(system, boundary),
                  [&](int, const Vec2& start, const Vec2& end) { width += std::abs(lateral.dot(end - start)); });
    return width;
}

double outermost_place(const BlockSystem& system, const std::vector<BoundaryEdge>& edges, const Vec2& direction) {
    double outermost = -std::numeric_limits<double>::infinity();
    for_each_edge(system, edges, [&](int, const Vec2& start, const Vec2& end) {
        outermost = std::max({outermost, direction.dot(start), direction.dot(end)});
    });
    return outermost;
}

Vec2 mean_normal(const BlockSystem& system, const Side& side) {
    Vec2 sum = Vec2::Zero();
    for (const SidePart& part : side)
        for_each_edge(system, part.edges,
                      [&](int, const Vec2& start, const Vec2& end) { sum += right_normal(end - start); });
    return sum.normalized();
}

PlatenForce width_across(const BlockSystem& system, int boundary) {
    PlatenForce force;
    force.widening.setZero(n_block_unknowns * system.n_blocks());
    const Vec2 normal = boundary_frame(system, boundary).normal;
    const Vec2 lateral(normal.y(), -normal.x());
    force.width = outer_width(system, boundary, lateral);
    const auto sides = lateral_sides(system, boundary);
    if (sides[0].empty()) return force;
    const double apart = std::abs(place_of(system, sides[0], lateral) - place_of(system, sides[1], lateral));
    force.width = std::max(force.width, apart);
    const double of_all_parts = force.width / apart; // columns side by side widen each
    for (int k = 0; k < 2; ++k) {
        const double sense = k == 0 ? of_all_parts : -of_all_parts;
        for (const SidePart& part : sides[k]) {
            for (std::size_t i = 0; i < part.edges.size(); ++i) {
                const auto& [b, e] = part.edges[i];
                const Vec2 xi = block_coordinates(system.blocks[b], middle_of(system, b, e));
                force.widening.segment<n_block_unknowns>(n_block_unknowns * b) +=
                    sense * part.shares[i] * displacement_row(lateral, xi);
            }
        }
    }
    return force;
}

double pressed_length(const BlockSystem& system, int boundary) {
    const Vec2 normal = boundary_frame(system, boundary).normal;
    double length = 0.0;
    for_each_edge(system, boundary,
                  [&](int, const Vec2& start, const Vec2& end) { length += normal.dot(right_normal(end - start)); });
    return length;
}

double distance_across(const BlockSystem& system, int boundary) {
    const int opposite = opposite_boundary(system, boundary);
    const Vec2 normal = boundary_frame(system, boundary).normal;
    const Vec2 place = mean_position(system, outer_edges(system, boundary));
    if (opposite >= 0) return std::abs(normal.dot(place - mean_position(system, outer_edges(system, opposite))));
    double farthest = 0.0;
    for (const Block& block : system.blocks)
        for (const Edge& edge : block.edges)
            farthest = std::max(farthest, normal.dot(place - edge_start(system, edge)));
    return farthest;
}

} // namespace kluft
