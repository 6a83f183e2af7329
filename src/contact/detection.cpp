#include "kluft/contact/detection.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "kluft/contact/broad_phase.hpp"
#include "kluft/kinematics/affine.hpp"

namespace kluft {

namespace {

/// Edges face each other if their outward normals are more than 135 degrees apart.
const double facing_cosine = -std::sqrt(0.5);
/// An overlap shorter than this part of the shorter edge is no contact.
constexpr double shortest_overlap = 1e-6;
/// Deeper than this part of the smaller block, two edges are not in contact but on opposite sides of a block.
constexpr double deepest_penetration = 0.25;
/// Two points of a fracture that were nearer than this part of its edge were one point; what is between is round-off.
constexpr double same_point = 1e-12;
/// Length that a vertex stands for, as a part of min(edge, h): decides convergence, not strength (measured).
constexpr double vertex_weight = 0.2;

/// Gauss-Lobatto: exact for a linear gap on a closed overlap, with points at both corners.
constexpr std::array<double, 3> lobatto_positions{0.0, 0.5, 1.0};
constexpr std::array<double, 3> lobatto_weights{1.0 / 6.0, 4.0 / 6.0, 1.0 / 6.0};

/// The edges of a block that can touch another one, in their current position.
struct Surface {
    int block = 0;
    bool separated = false; ///< has an edge that is not bonded inside the body
    struct CurrentEdge {
        int edge = 0;
        Vec2 start, end;
        Vec2 direction;
        double length = 0.0;
    };
    std::vector<CurrentEdge> edges;
};

bool is_bonded(const ContactSurfaces& surfaces, const Edge& edge) {
    return edge.interface >= 0 && surfaces.bonded[edge.interface];
}

Surface current_surface(const BlockSystem& system, const ContactSurfaces& surfaces, const Eigen::VectorXd& q, int b) {
    Surface surface;
    surface.block = b;
    const Block& block = system.blocks[b];
    for (int e = 0; e < static_cast<int>(block.edges.size()); ++e) {
        const Edge& edge = block.edges[e];
        if (is_bonded(surfaces, edge)) continue;
        surface.separated = surface.separated || edge.interface >= 0;
        Surface::CurrentEdge current;
        current.edge = e;
        current.start = current_position(system, q, b, edge.start);
        current.end = current_position(system, q, b, edge.end);
        current.length = (current.end - current.start).norm();
        current.direction = (current.end - current.start) / current.length;
        surface.edges.push_back(current);
    }
    return surface;
}

BlockBox bounding_box(const Surface& surface) {
    BlockBox box{surface.block, surface.edges.front().start, surface.edges.front().start};
    for (const auto& edge : surface.edges) {
        box.lower = box.lower.cwiseMin(edge.start).cwiseMin(edge.end);
        box.upper = box.upper.cwiseMax(edge.start).cwiseMax(edge.end);
    }
    return box;
}

/// The narrow phase of one pair of blocks.
class PairDetection {
public:
    PairDetection(const BlockSystem& system, const ContactSurfaces& surfaces, const Eigen::VectorXd& q, double reach,
                  std::vector<ContactPoint>& points)
        : system_(system), surfaces_(surfaces), q_(q), reach_(reach), points_(points) {}

    void run(const Surface& a, const Surface& b) {
        bonded_pair_ = bonded(a.block, b.block);
        deepest_ = -deepest_penetration * std::min(system_.blocks[a.block].size, system_.blocks[b.block].size);
        overlapping_.clear();
        for (const auto& edge_a : a.edges) {
            for (const auto& edge_b : b.edges) append_overlap(a, edge_a, b, edge_b);
        }
        if (bonded_pair_) return;
        append_vertices(a, b, false);
        append_vertices(b, a, true);
    }

private:
    [[nodiscard]] const Edge& reference(int block, int edge) const { return system_.blocks[block].edges[edge]; }

    [[nodiscard]] bool bonded(int a, int b) const {
        return std::ranges::any_of(system_.blocks[a].edges, [&](const Edge& edge) {
            if (!is_bonded(surfaces_, edge)) return false;
            const Interface& interface = system_.interfaces[edge.interface];
            return interface.block_a == b || interface.block_b == b;
        });
    }

    /// Edges of the same interface may touch. Of others, those that leave a common vertex to the same side have a block
    /// between them; to opposite sides of it, one block slides past the vertex onto the edge of the other.
    [[nodiscard]] bool may_touch(const Edge& a, const Edge& b) const {
        if (a.interface >= 0 && a.interface == b.interface) return true;
        if (bonded_pair_) return false;
        return a.start != b.end && a.end != b.start;
    }

    [[nodiscard]] int law_between(const Edge& a, const Edge& b) const {
        if (a.interface < 0 && b.interface < 0) return surfaces_.default_law;
        if (a.interface < 0) return surfaces_.law[b.interface];
        if (b.interface < 0) return surfaces_.law[a.interface];
        const int law_a = surfaces_.law[a.interface];
        const int law_b = surfaces_.law[b.interface];
        return surfaces_.friction[law_a] <= surfaces_.friction[law_b] ? law_a : law_b;
    }

    ContactPoint point_between(const Surface& a, const Surface::CurrentEdge& edge_a, double s_a, const Surface& b,
                               const Surface::CurrentEdge& edge_b, double s_b) const {
        const Edge& side_a = reference(a.block, edge_a.edge);
        const Edge& side_b = reference(b.block, edge_b.edge);
        const Vec2 x_a = edge_start(system_, side_a) + s_a * (edge_end(system_, side_a) - edge_start(system_, side_a));
        const Vec2 x_b = edge_start(system_, side_b) + s_b * (edge_end(system_, side_b) - edge_start(system_, side_b));
        ContactPoint point;
        point.block_a = a.block;
        point.block_b = b.block;
        point.xi_a = block_coordinates(system_.blocks[a.block], x_a);
        point.xi_b = block_coordinates(system_.blocks[b.block], x_b);
        point.offset = x_b - x_a;
        if (point.offset.norm() <= same_point * edge_a.length) point.offset.setZero();
        point.law = law_between(side_a, side_b);
        if (side_a.interface >= 0 && side_a.interface == side_b.interface) point.interface = side_a.interface;
        point.key = {a.block, edge_a.edge, b.block, edge_b.edge, -1};
        return point;
    }

    void finish(ContactPoint& point, const Vec2& along) {
        point.normal = right_normal(along);
        point.tangent = along;
        point.slip_start = along.dot(relative_position(point, q_));
        points_.push_back(point);
    }

    void append_overlap(const Surface& a, const Surface::CurrentEdge& edge_a, const Surface& b,
                        const Surface::CurrentEdge& edge_b) {
        if (edge_a.direction.dot(edge_b.direction) > facing_cosine) return;
        if (!may_touch(reference(a.block, edge_a.edge), reference(b.block, edge_b.edge))) return;
        const Vec2 along = (edge_a.direction - edge_b.direction).normalized();
        const Vec2 normal = right_normal(along);
        const Vec2 d = edge_b.end - edge_a.start; // differences first: positions far from the origin lose digits
        const double extent_a = along.dot(edge_a.end - edge_a.start);
        const double extent_b = along.dot(edge_b.start - edge_b.end);
        const double start_b = along.dot(d);
        const double low = std::max(0.0, start_b);
        const double high = std::min(extent_a, start_b + extent_b);
        const double overlap = high - low;
        if (overlap <= shortest_overlap * std::min(edge_a.length, edge_b.length)) return;

        const auto gap_at = [&](double tau) {
            const Vec2 on_a = (tau / extent_a) * (edge_a.end - edge_a.start);
            const Vec2 on_b = d + ((tau - start_b) / extent_b) * (edge_b.start - edge_b.end);
            return normal.dot(on_b - on_a);
        };
        const double gap_low = gap_at(low);
        const double gap_high = gap_at(high);
        if (std::min(gap_low, gap_high) > reach_ || std::min(gap_low, gap_high) < deepest_) return;

        overlapping_.emplace_back(edge_a.edge, edge_b.edge);
        for (int k = 0; k < 3; ++k) {
            const double tau = low + lobatto_positions[k] * overlap;
            ContactPoint point = point_between(a, edge_a, tau / extent_a, b, edge_b, 1.0 - (tau - start_b) / extent_b);
            point.weight = lobatto_weights[k] * overlap;
            point.key.point = k;
            finish(point, along);
        }
    }

    [[nodiscard]] bool overlap_covers(int edge_of_vertex, int edge, bool swapped) const {
        const auto pair = swapped ? std::pair(edge, edge_of_vertex) : std::pair(edge_of_vertex, edge);
        return std::ranges::find(overlapping_, pair) != overlapping_.end();
    }

    /// Vertices of `owner` (the start of each of its edges) against the edges of `target`.
    void append_vertices(const Surface& owner, const Surface& target, bool swapped) {
        const Block& block = system_.blocks[owner.block];
        for (const auto& leaving : owner.edges) {
            const int arriving = previous_edge(block, leaving.edge);
            const Vec2 before = current_position(system_, q_, owner.block, block.edges[arriving].start);
            for (const auto& edge : target.edges) {
                append_vertex(owner, leaving, arriving, before, target, edge, swapped);
            }
        }
    }

    void append_vertex(const Surface& owner, const Surface::CurrentEdge& leaving, int arriving, const Vec2& before,
                       const Surface& target, const Surface::CurrentEdge& edge, bool swapped) {
        const Vec2 outward = right_normal(edge.direction);
        const Vec2 from_edge = leaving.start - edge.start;
        const double gap = outward.dot(from_edge);
        if (gap > reach_ || gap < deepest_) return;
        const double s = edge.direction.dot(from_edge) / edge.length;
        if (s < 0.0 || s > 1.0) return;
        if (outward.dot(leaving.end - leaving.start) < 0.0 || outward.dot(before - leaving.start) < 0.0) return;
        const Edge& target_edge = reference(target.block, edge.edge);
        const int vertex = reference(owner.block, leaving.edge).start;
        if (vertex == target_edge.start || vertex == target_edge.end) return;
        if (overlap_covers(leaving.edge, edge.edge, swapped) || overlap_covers(arriving, edge.edge, swapped)) return;
        ContactPoint point = point_between(owner, leaving, 0.0, target, edge, s);
        point.weight = vertex_weight * std::min(edge.length, system_.blocks[owner.block].size);
        finish(point, -edge.direction);
    }

    static int previous_edge(const Block& block, int e) {
        for (std::size_t loop = 0; loop < block.loop_starts.size(); ++loop) {
            const int first = block.loop_starts[loop];
            const int last = loop + 1 < block.loop_starts.size() ? block.loop_starts[loop + 1]
                                                                 : static_cast<int>(block.edges.size());
            if (e == first) return last - 1;
            if (e > first && e < last) return e - 1;
        }
        return e;
    }

    const BlockSystem& system_;
    const ContactSurfaces& surfaces_;
    const Eigen::VectorXd& q_;
    double reach_;
    std::vector<ContactPoint>& points_;
    bool bonded_pair_ = false;
    double deepest_ = 0.0;
    std::vector<std::pair<int, int>> overlapping_; ///< (edge of a, edge of b) of the present pair
};

void transfer_histories(const std::vector<ContactMemory>& memory, std::vector<ContactPoint>& points) {
    auto next = memory.begin();
    for (ContactPoint& point : points) {
        while (next != memory.end() && next->key < point.key) ++next;
        if (next != memory.end() && next->key == point.key) point.history = next->history;
    }
}

} // namespace

DetectedContacts detect_contacts(const BlockSystem& system, const ContactSurfaces& surfaces, const Eigen::VectorXd& q,
                                 double reach, const std::vector<ContactMemory>& memory) {
    std::vector<Surface> touching;
    std::vector<int> index(system.blocks.size(), -1);
    std::vector<BlockBox> boxes;
    for (int b = 0; b < system.n_blocks(); ++b) {
        Surface surface = current_surface(system, surfaces, q, b);
        if (surface.edges.empty()) continue;
        boxes.push_back(bounding_box(surface));
        index[b] = static_cast<int>(touching.size());
        touching.push_back(std::move(surface));
    }

    DetectedContacts result;
    PairDetection pair_detection(system, surfaces, q, reach, result.points);
    for (const auto& [a, b] : meeting_boxes(boxes, reach)) {
        const Surface& surface_a = touching[index[a]];
        const Surface& surface_b = touching[index[b]];
        if (!surface_a.separated && !surface_b.separated) continue;
        result.near_pairs.emplace_back(a, b);
        pair_detection.run(surface_a, surface_b);
    }
    std::ranges::sort(result.points, {}, &ContactPoint::key);
    transfer_histories(memory, result.points);
    return result;
}

} // namespace kluft
