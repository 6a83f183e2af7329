#include "kluft/contact/detection.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <map>
#include <numbers>
#include <numeric>
#include <optional>
#include <span>
#include <utility>

#include "kluft/contact/broad_phase.hpp"
#include "kluft/contact/overlap_rule.hpp"
#include "kluft/kinematics/affine.hpp"

namespace kluft {

namespace {

/// Edges face each other if their outward normals are more than 135 degrees apart.
const double facing_cosine = -std::sqrt(0.5);
/// An overlap shorter than this part of the shorter edge is no contact.
constexpr double shortest_overlap = 1e-6;
/// Deeper than this part of the smaller block, the faces of an interface are in contact only if what overlaps is inside one of the
/// blocks.
constexpr double doubtful_penetration = 0.01;
/// Deeper than this part of it, other faces are in contact only if what lies between them is inside both blocks, and a vertex and a face
/// only if the vertex is inside the block; less is round-off.
constexpr double least_penetration = 1e-9;
/// Sides of a block that turn by less (rad) are one, and corners whose angles differ by less are alike; more is not round-off.
constexpr double straight = 1e-4;
/// Faces of two blocks that meet in a vertex go on in one another if they turn by less (rad), as motions of blocks turn them.
constexpr double flush = 0.02;
/// A tip whose plane comes out within this part of the smaller block beside the foot of what rises before it stands at that foot.
constexpr double at_the_foot = 0.02;
/// A toe that has sunk by less than this part of the smaller block below the face that it slides onto meets the side below that face by what
/// joints and blocks have given way; one that has sunk more is held by it.
constexpr double sunk_under_loads = 5e-4;
/// A face that goes on in another one rises or falls there by less than this (rad).
constexpr double flat = std::numbers::pi / 4.0;
/// A corner is round over this part of the shorter edge: where two corners meet, the direction in which they touch is between the faces'.
constexpr double corner_rounding = 1e-3;
/// Two points of a fracture that were nearer than this part of its edge were one point; what is between is round-off.
constexpr double same_point = 1e-12;
/// Deeper than this part of the smaller block, edges that were no neighbours are not in contact ...
constexpr double deepest_penetration = 0.25;
/// ... and deeper than this part of the thickness of the thinner block.
constexpr double deepest_of_thickness = 0.5;
constexpr double largest_fragment = 0.25; ///< of a cell of the net
/// Length that a vertex stands for, as a part of min(edge, h): decides convergence, not strength (measured).
constexpr double vertex_weight = 0.2;

/// An edge that can touch another block, in its current position.
struct CurrentEdge {
    int edge = 0;
    int arriving = 0; ///< the edge before it in its loop
    Vec2 before;      ///< where that one starts
    Vec2 start, end;
    Vec2 beyond; ///< where the edge after it ends
    Vec2 direction;
    double length = 0.0;
};

/// The edges of a block that can touch others: edges[first] .. edges[last - 1] of all of them.
struct Surface {
    int block = 0;
    bool separated =
        false; ///< has an edge that is not bonded inside the body, or one of an outline that may meet others
    std::size_t first = 0;
    std::size_t last = 0;
};

struct Surfaces {
    std::vector<Surface> all;
    std::vector<CurrentEdge> edges;
    std::vector<int> of_block; ///< -1 for a block without any
    std::vector<Vec2> corners; ///< of the block at work

    [[nodiscard]] std::span<const CurrentEdge> edges_of(const Surface& surface) const {
        return std::span(edges).subspan(surface.first, surface.last - surface.first);
    }
};

bool is_bonded(const ContactSurfaces& surfaces, const Edge& edge) {
    return edge.interface >= 0 && surfaces.bonded[edge.interface];
}

CurrentEdge current_edge(int edge, int arriving, const Vec2& before, const Vec2& start, const Vec2& end,
                         const Vec2& beyond) {
    CurrentEdge current{edge, arriving, before, start, end, beyond, Vec2::Zero(), (end - start).norm()};
    current.direction = (end - start) / current.length;
    return current;
}

/// The edges of a block that arrive at a vertex and leave it.
struct Corner {
    Vec2 arriving, leaving;
};
Corner corner_at_start(const CurrentEdge& edge) { return {edge.start - edge.before, edge.direction}; }
Corner corner_at_end(const CurrentEdge& edge) { return {edge.direction, edge.beyond - edge.end}; }

/// Inside the block (rad).
double angle_of(const Corner& at) {
    return std::numbers::pi - std::atan2(cross(at.arriving, at.leaving), at.arriving.dot(at.leaving));
}

/// Whether a direction lies between two that are less than a straight angle apart.
bool is_between(const Vec2& x, const Vec2& first, const Vec2& second) {
    const double sense = cross(first, second);
    return sense * cross(first, x) > 0.0 && sense * cross(x, second) > 0.0;
}

/// Whether the block has a notch there, and not a corner or a vertex on a straight side.
bool is_notch(const Corner& at) {
    const double turn = cross(at.arriving, at.leaving);
    return turn < 0.0 && turn < -straight * at.arriving.norm() * at.leaving.norm();
}

void append_surface(const BlockSystem& system, const ContactSurfaces& contact_surfaces, const Eigen::VectorXd& q, int b,
                    Surfaces& surfaces) {
    const Block& block = system.blocks[b];
    const auto touches = [&](const Edge& edge) { return !is_bonded(contact_surfaces, edge); };
    if (std::ranges::none_of(block.edges, touches)) return;
    Surface surface{b, contact_surfaces.outlines_meet, surfaces.edges.size(), 0};
    std::vector<Vec2>& corners = surfaces.corners;
    corners.clear();
    for (const Edge& edge : block.edges) corners.push_back(current_position(system, q, b, edge.start));
    for (std::size_t loop = 0; loop < block.loop_starts.size(); ++loop) {
        const int first = block.loop_starts[loop];
        const int last =
            loop + 1 < block.loop_starts.size() ? block.loop_starts[loop + 1] : static_cast<int>(block.edges.size());
        for (int e = first; e < last; ++e) {
            if (!touches(block.edges[e])) continue;
            surface.separated = surface.separated || block.edges[e].interface >= 0;
            const int before = e > first ? e - 1 : last - 1;
            const int after = e + 1 < last ? e + 1 : first;
            const int next = after + 1 < last ? after + 1 : first;
            surfaces.edges.push_back(
                current_edge(e, before, corners[before], corners[e], corners[after], corners[next]));
        }
    }
    surface.last = surfaces.edges.size();
    surfaces.of_block[b] = static_cast<int>(surfaces.all.size());
    surfaces.all.push_back(surface);
}

Surfaces current_surfaces(const BlockSystem& system, const ContactSurfaces& contact_surfaces,
                          const Eigen::VectorXd& q) {
    Surfaces surfaces;
    surfaces.of_block.assign(system.blocks.size(), -1);
    for (int b = 0; b < system.n_blocks(); ++b) append_surface(system, contact_surfaces, q, b, surfaces);
    return surfaces;
}

std::vector<BlockBox> bounding_boxes(const Surfaces& surfaces) {
    std::vector<BlockBox> boxes;
    boxes.reserve(surfaces.all.size());
    for (const Surface& surface : surfaces.all) {
        const auto edges = surfaces.edges_of(surface);
        BlockBox box{surface.block, edges.front().start, edges.front().start};
        for (const CurrentEdge& edge : edges) {
            box.lower = box.lower.cwiseMin(edge.start).cwiseMin(edge.end);
            box.upper = box.upper.cwiseMax(edge.start).cwiseMax(edge.end);
        }
        boxes.push_back(box);
    }
    return boxes;
}

/// Points are large: what is sorted are their numbers, block by block, and each point is copied once.
std::vector<ContactPoint> sorted_by_key(const std::vector<ContactPoint>& points, int n_blocks) {
    std::vector<int> first(n_blocks + 1, 0); // of a block's points in the order, and one behind the last block
    for (const ContactPoint& point : points) ++first[point.block_a + 1];
    std::partial_sum(first.begin(), first.end(), first.begin());
    std::vector<int> order(points.size());
    std::vector<int> next(first);
    for (int i = 0; i < static_cast<int>(points.size()); ++i) order[next[points[i].block_a]++] = i;
    for (int b = 0; b < n_blocks; ++b)
        std::ranges::sort(order.begin() + first[b], order.begin() + first[b + 1], {},
                          [&](int i) -> const ContactKey& { return points[i].key; });
    std::vector<ContactPoint> sorted;
    sorted.reserve(points.size());
    for (const int i : order) sorted.push_back(points[i]);
    return sorted;
}

/// The narrow phase of one pair of blocks.
class PairDetection {
public:
    /// `memory`: of what touched last, sorted by key.
    PairDetection(const BlockSystem& system, const ContactSurfaces& surfaces, const Eigen::VectorXd& q, double reach,
                  const std::vector<ContactMemory>& memory)
        : system_(system), surfaces_(surfaces), q_(q), reach_(reach), memory_(memory) {}

    /// Makes room for so many points.
    void expect(std::size_t n_points) { points_.reserve(n_points); }

    /// The boxes are those of all edges.
    void run(const BlockBox& box_a, std::span<const CurrentEdge> edges_a, const BlockBox& box_b,
             std::span<const CurrentEdge> edges_b) {
        const int a = box_a.block;
        const int b = box_b.block;
        bonded_pair_ = bonded(a, b);
        const double smaller = std::min(system_.blocks[a].size, system_.blocks[b].size);
        deepest_ = -deepest_contact(system_, a, b, false);
        deepest_own_ = -deepest_contact(system_, a, b, true);
        doubtful_ = -doubtful_penetration * smaller;
        shallow_ = -least_penetration * smaller;
        overlapping_.clear();
        sunk_beside_.clear();
        const double distance = std::max(reach_, -deepest_) - doubtful_;
        choose_near(a, edges_a, box_b, distance, near_a_);
        choose_near(b, edges_b, box_a, distance, near_b_);
        for (const int i : near_a_) {
            for (const int j : near_b_) append_overlap(a, edges_a[i], edges_a, b, edges_b[j], edges_b);
        }
        if (bonded_pair_) return;
        faces_apart_ = are_faces_apart(a, b);
        append_vertices(a, edges_a, near_a_, b, edges_b, near_b_, false);
        append_vertices(b, edges_b, near_b_, a, edges_a, near_a_, true);
    }

    /// The points of all pairs so far, sorted by key.
    [[nodiscard]] std::vector<ContactPoint> points_by_key() const { return sorted_by_key(points_, system_.n_blocks()); }

    std::vector<UnheldTip> take_unheld_tips() { return std::move(unheld_tips_); }

private:
    [[nodiscard]] const Edge& reference(int block, int edge) const { return system_.blocks[block].edges[edge]; }

    /// The edges that are no farther from another block's box than that, and those of an interface with it.
    void choose_near(int block, std::span<const CurrentEdge> edges, const BlockBox& other, double distance,
                     std::vector<int>& near) const {
        near.clear();
        for (int i = 0; i < static_cast<int>(edges.size()); ++i) {
            const CurrentEdge& edge = edges[i];
            const Vec2 below = other.lower - edge.start.cwiseMax(edge.end);
            const Vec2 above = edge.start.cwiseMin(edge.end) - other.upper;
            if (below.cwiseMax(above).maxCoeff() <= distance ||
                is_shared_with(other.block, reference(block, edge.edge)))
                near.push_back(i);
        }
    }

    /// Whether an edge of another block is one side of an interface with this block.
    [[nodiscard]] bool is_shared_with(int block, const Edge& edge) const {
        if (edge.interface < 0) return false;
        const Interface& interface = system_.interfaces[edge.interface];
        return interface.block_a == block || interface.block_b == block;
    }

    [[nodiscard]] bool bonded(int a, int b) const {
        return std::ranges::any_of(system_.blocks[a].edges, [&](const Edge& edge) {
            return is_bonded(surfaces_, edge) && is_shared_with(b, edge);
        });
    }

    /// Whether two edges have the air before them: what lies between them, if they share a vertex, is a void and no block.
    [[nodiscard]] static bool are_outlines(const Edge& a, const Edge& b) { return a.interface < 0 && b.interface < 0; }

    /// Edges of the same interface may touch. Of others, those that leave a common vertex to the same side have a block between them, and do
    /// not, unless both are outlines; to opposite sides of it, one block slides past the vertex onto the edge of the other.
    [[nodiscard]] bool may_touch(const Edge& a, const Edge& b) const {
        if (a.interface >= 0 && a.interface == b.interface) return true;
        if (bonded_pair_) return false;
        return are_outlines(a, b) || !leave_common_vertex(a, b);
    }

    /// Whether two edges leave a vertex that they have in common to the same side.
    [[nodiscard]] static bool leave_common_vertex(const Edge& a, const Edge& b) {
        return a.start == b.end || a.end == b.start;
    }

    [[nodiscard]] int law_between(const Edge& a, const Edge& b) const {
        if (a.interface < 0 && b.interface < 0) return surfaces_.default_law;
        if (a.interface < 0) return surfaces_.law[b.interface];
        if (b.interface < 0) return surfaces_.law[a.interface];
        const int law_a = surfaces_.law[a.interface];
        const int law_b = surfaces_.law[b.interface];
        return surfaces_.friction[law_a] <= surfaces_.friction[law_b] ? law_a : law_b;
    }

    /// Those of the edge that wants more of them.
    [[nodiscard]] int points_between(const Edge& a, const Edge& b) const {
        const auto on = [&](const Edge& e) {
            return e.interface < 0 ? surfaces_.outline_points : surfaces_.n_points[e.interface];
        };
        return std::max(on(a), on(b));
    }

    /// A point of two edges, but for where it lies on them.
    [[nodiscard]] ContactPoint point_between(int a, const CurrentEdge& edge_a, int b, const CurrentEdge& edge_b) const {
        const Edge& side_a = reference(a, edge_a.edge);
        const Edge& side_b = reference(b, edge_b.edge);
        ContactPoint point;
        point.block_a = a;
        point.block_b = b;
        point.law = law_between(side_a, side_b);
        if (side_a.interface >= 0 && side_a.interface == side_b.interface) point.interface = side_a.interface;
        point.key = {a, edge_a.edge, b, edge_b.edge, -1};
        return point;
    }

    /// An edge of a block as cut.
    struct CutEdge {
        CutEdge(const BlockSystem& system, const Edge& edge)
            : start(edge_start(system, edge)), to_end(edge_end(system, edge) - start) {}
        [[nodiscard]] Vec2 at(double s) const { return start + s * to_end; }
        Vec2 start, to_end;
    };

    /// At a place of each of the two edges as cut; `length` is that of the first one.
    void lay(ContactPoint& point, const Vec2& x_a, const Vec2& x_b, double length) const {
        point.xi_a = block_coordinates(system_.blocks[point.block_a], x_a);
        point.xi_b = block_coordinates(system_.blocks[point.block_b], x_b);
        point.offset = x_b - x_a;
        if (point.offset.norm() <= same_point * length) point.offset.setZero();
    }

    void finish(ContactPoint& point, const Vec2& along) const {
        point.normal = right_normal(along);
        point.tangent = along;
        point.slip_start = along.dot(relative_position(point, q_));
    }

    void append_overlap(int a, const CurrentEdge& edge_a, std::span<const CurrentEdge> edges_a, int b,
                        const CurrentEdge& edge_b, std::span<const CurrentEdge> edges_b) {
        if (edge_a.direction.dot(edge_b.direction) > facing_cosine) return;
        if (!may_touch(reference(a, edge_a.edge), reference(b, edge_b.edge))) return;
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
        const Edge& side_a = reference(a, edge_a.edge);
        const bool own = side_a.interface >= 0 && side_a.interface == reference(b, edge_b.edge).interface;
        if (std::min(gap_low, gap_high) > reach_) return;
        if (!own && leave_common_vertex(side_a, reference(b, edge_b.edge)) && 0.5 * (gap_low + gap_high) > reach_)
            return; // a wide void, at whose tip a corner touches and not a face
        if (std::min(gap_low, gap_high) < (own ? deepest_own_ : deepest_)) return;
        if (!own && -std::min(gap_low, gap_high) > overlap) {
            sunk_beside_.emplace_back(edge_a.edge, edge_b.edge);
            return;
        }
        if (slides_onto_ground(a, edge_a, edges_a, b, edge_b) || slides_onto_ground(b, edge_b, edges_b, a, edge_a))
            return;

        const double at = low + (gap_low < gap_high ? 0.25 : 0.75) * overlap; // nearer to the deeper end
        if (gap_at(at) < (own ? doubtful_ : shallow_)) {
            const Vec2 on_a = edge_a.start + (at / extent_a) * (edge_a.end - edge_a.start);
            const Vec2 on_b = edge_b.end + ((at - start_b) / extent_b) * (edge_b.start - edge_b.end);
            if (own && !is_inside(a, on_b) && !is_inside(b, on_a)) return;
            if (!own && !are_in_both(a, b, on_a, on_b)) {
                sunk_beside_.emplace_back(edge_a.edge, edge_b.edge);
                return;
            }
        }

        overlapping_.emplace_back(edge_a.edge, edge_b.edge);
        const std::size_t first = points_.size();
        const OverlapRule rule = overlap_rule(points_between(side_a, reference(b, edge_b.edge)));
        const auto [along_low, along_high] =
            directions_at_ends(a, edge_a, b, edge_b, start_b, extent_a - (start_b + extent_b));
        const CutEdge cut_a(system_, side_a);
        const CutEdge cut_b(system_, reference(b, edge_b.edge));
        ContactPoint point = point_between(a, edge_a, b, edge_b);
        for (std::size_t k = 0; k < rule.positions.size(); ++k) {
            const double tau = low + rule.positions[k] * overlap;
            lay(point, cut_a.at(tau / extent_a), cut_b.at(1.0 - (tau - start_b) / extent_b), edge_a.length);
            point.weight = rule.weights[k] * overlap;
            point.along = rule.positions[k];
            point.key.point = static_cast<int>(k);
            finish(point, (along_low + rule.positions[k] * (along_high - along_low)).normalized());
            points_.push_back(point);
        }
        set_pieces(rule, std::span(points_).subspan(first));
    }

    /// Along the faces that the corners at the two ends of an overlap touch: at its start the corner of b on the face of a where b begins
    /// `later` along a (m), that of a on the face of b where it is less than zero; at its end the corner of b where a goes on `farther`. The vertex
    /// of a notch touches nothing: there the face itself counts. Of two corners that were one point beside a void share_of_first says which one touches the face of the other.
    [[nodiscard]] std::pair<Vec2, Vec2> directions_at_ends(int a, const CurrentEdge& edge_a, int b,
                                                           const CurrentEdge& edge_b, double later,
                                                           double farther) const {
        const double rounding = corner_rounding * std::min(edge_a.length, edge_b.length);
        const Edge& side_a = reference(a, edge_a.edge);
        const Edge& side_b = reference(b, edge_b.edge);
        const bool beside_void = are_outlines(side_a, side_b);
        const auto along = [&](double on_a, bool is_common, const Corner& of_a, const Corner& of_b,
                               bool begins) -> Vec2 {
            double share_of_a = std::clamp(0.5 + 0.5 * on_a / rounding, 0.0, 1.0);
            if (is_notch(of_a) != is_notch(of_b)) share_of_a = is_notch(of_a) ? 1.0 : 0.0;
            if (is_common && beside_void) {
                const double of_first = share_of_first(a, side_a, of_a, b, side_b, of_b, begins);
                if (std::abs(of_first) > straight) share_of_a = of_first > 0.0 ? 1.0 : 0.0;
            }
            return (share_of_a * edge_a.direction - (1.0 - share_of_a) * edge_b.direction).normalized();
        };
        return {along(later, side_a.start == side_b.end, corner_at_start(edge_a), corner_at_end(edge_b), true),
                along(farther, side_a.end == side_b.start, corner_at_end(edge_a), corner_at_start(edge_b), false)};
    }

    /// The pieces of an overlap are as long as the weights of its points (15).
    static void set_pieces(const OverlapRule& rule, std::span<ContactPoint> points) {
        const ContactPoint& start = points.front();
        const ContactPoint& end = points.back();
        double from = 0.0;
        for (std::size_t k = 0; k < points.size(); ++k) {
            const double to = from + rule.weights[k];
            points[k].piece = {end.xi_a - start.xi_a, end.xi_b - start.xi_b, end.offset - start.offset,
                               from - rule.positions[k], to - rule.positions[k]};
            from = to;
        }
    }

    /// By the number of edges to the right of x.
    [[nodiscard]] bool is_inside(int block, const Vec2& x) const {
        bool inside = false;
        for (const Edge& edge : system_.blocks[block].edges) {
            const Vec2 p = current_position(system_, q_, block, edge.start) - x;
            const Vec2 r = current_position(system_, q_, block, edge.end) - x;
            if ((p.y() > 0.0) != (r.y() > 0.0) && (p.x() * r.y() - r.x() * p.y() > 0.0) == (r.y() > p.y())) {
                inside = !inside;
            }
        }
        return inside;
    }

    /// Whether two blocks have in common what lies between two points. Between the backs of two thin parts that lie on each other
    /// they have no more in common than the closure of what is between these, of which one of two places at most is a part.
    [[nodiscard]] bool are_in_both(int a, int b, const Vec2& x, const Vec2& y) const {
        const auto is_in_both = [&](const Vec2& at) { return is_inside(a, at) && is_inside(b, at); };
        return is_in_both(0.75 * x + 0.25 * y) && is_in_both(0.25 * x + 0.75 * y);
    }

    using EdgePair = std::pair<int, int>; ///< an edge of a and one of b

    /// Whether one of the two edges that meet in a vertex is in `pairs` with an edge of the other block.
    [[nodiscard]] static bool has_side_in(const std::vector<EdgePair>& pairs, const CurrentEdge& leaving, int edge,
                                          bool swapped) {
        return std::ranges::any_of(pairs, [&](const EdgePair& pair) {
            const auto [of_vertex, of_other] = swapped ? std::pair(pair.second, pair.first) : pair;
            return of_other == edge && (of_vertex == leaving.edge || of_vertex == leaving.arriving);
        });
    }

    /// Whether another face of the target than the given one holds the vertex, which lies `gap` before this one. A face next to it around a
    /// convex corner does if an edge of the vertex overlaps that face: against the other one the vertex would catch where blocks side by
    /// side have sunk by different amounts. Of two that the vertex lies behind that one does by which it has come in, the one
    /// behind which it lies less deep, as a vertex of its own or as the end of an edge that overlaps that face: a foot beside a
    /// corner is not pushed off by the side. Both sides of a notch hold what lies in it.
    [[nodiscard]] bool is_held_by_another_face(const CurrentEdge& leaving, const CurrentEdge& edge, double gap,
                                               std::span<const CurrentEdge> edges, bool swapped) const {
        return std::ranges::any_of(edges, [&](const CurrentEdge& face) {
            const bool is_beside = face.arriving == edge.edge || edge.arriving == face.edge;
            if (!is_beside && gap >= 0.0) return false;
            if (is_beside && (are_notch(face, edge) || are_notch(edge, face))) return false;
            const bool overlaps = has_side_in(overlapping_, leaving, face.edge, swapped);
            if (overlaps && is_beside) return true;
            const Vec2 outward = right_normal(face.direction);
            const Vec2 from_face = leaving.start - face.start;
            const double gap_there = outward.dot(from_face);
            const double along = face.direction.dot(from_face);
            if (gap >= 0.0 || gap_there > -shallow_ || gap_there <= gap) return false;
            if ((along < 0.0 || along > face.length) && !is_in_notch(leaving.start, face, along < 0.0, edges))
                return false;
            return overlaps || points_at(leaving, outward);
        });
    }

    /// Whether x, behind the edge and before its start or behind its end, lies behind the face on the other side of a notch there too, and
    /// no other face is nearer to x than the vertex of the notch: what is pressed into a notch may lie beyond the ends of both of its faces.
    [[nodiscard]] bool is_in_notch(const Vec2& x, const CurrentEdge& edge, bool at_start,
                                   std::span<const CurrentEdge> edges) const {
        if (!is_notch(at_start ? corner_at_start(edge) : corner_at_end(edge))) return false;
        const Vec2 from_vertex = x - (at_start ? edge.start : edge.end);
        const double distance = from_vertex.norm();
        const Vec2 other = at_start ? edge.start - edge.before : edge.beyond - edge.end;
        if (distance > -deepest_ || right_normal(other.normalized()).dot(from_vertex) >= shallow_) return false;
        return std::ranges::none_of(edges, [&](const CurrentEdge& face) {
            if (face.edge == edge.edge || are_notch(face, edge) || are_notch(edge, face)) return false;
            const double along = std::clamp(face.direction.dot(x - face.start), 0.0, face.length);
            return (x - face.start - along * face.direction).norm() < distance;
        });
    }

    /// Whether the second edge follows the first one around a notch.
    [[nodiscard]] static bool are_notch(const CurrentEdge& first, const CurrentEdge& second) {
        return second.arriving == first.edge && is_notch(corner_at_start(second));
    }

    /// Whether a vertex is a tip, and no edge of it goes farther into a face with this outward normal. The vertex of a notch touches nothing.
    [[nodiscard]] static bool points_at(const CurrentEdge& leaving, const Vec2& outward) {
        if (cross(leaving.start - leaving.before, leaving.direction) < 0.0) return false;
        return outward.dot(leaving.end - leaving.start) >= 0.0 && outward.dot(leaving.before - leaving.start) >= 0.0;
    }

    /// Of the present pair, once its overlaps are known.
    [[nodiscard]] bool are_faces_apart(int a, int b) const {
        const std::vector<Edge>& edges = system_.blocks[a].edges;
        const auto is_shared = [&](const Edge& edge) { return is_shared_with(b, edge); };
        const auto overlaps = [&](const EdgePair& pair) { return is_shared(edges[pair.first]); };
        return std::ranges::any_of(edges, is_shared) && std::ranges::none_of(overlapping_, overlaps);
    }

    /// Whether the two faces touched last, along an overlap or, where the first one leaves it, by that vertex.
    [[nodiscard]] bool touched(int block_a, int edge_a, int block_b, int edge_b) const {
        const ContactKey first{block_a, edge_a, block_b, edge_b, -1};
        const auto found = std::ranges::lower_bound(memory_, first, {}, &ContactMemory::key);
        if (found == memory_.end()) return false;
        ContactKey key = found->key;
        key.point = -1;
        return key == first;
    }

    /// Whether a side of the vertex, or the vertex, touched the edge last: faces that have turned to less than 135 degrees overlap no
    /// more, and the corner goes on holding what they held.
    [[nodiscard]] bool held_it_last(int owner, const CurrentEdge& leaving, int target, const CurrentEdge& edge,
                                    bool swapped) const {
        if (touched(owner, leaving.edge, target, edge.edge)) return true;
        return swapped ? touched(target, edge.edge, owner, leaving.edge) ||
                             touched(target, edge.edge, owner, leaving.arriving)
                       : touched(owner, leaving.arriving, target, edge.edge);
    }

    /// Whether the vertex is an end of the target's edge in the body as cut.
    [[nodiscard]] bool have_common_vertex(int owner, const CurrentEdge& leaving, int target,
                                          const CurrentEdge& edge) const {
        const int vertex = reference(owner, leaving.edge).start;
        return vertex == reference(target, edge.edge).start || vertex == reference(target, edge.edge).end;
    }

    /// Of two corners that are one point beside a void, where the face of the first one begins and that of the second one ends, or the other way round (`begins`
    /// false): by how much the face of the first one is the one that the other corner touches (rad), negative for the second one's. That is the blunter one's;
    /// but where strengths are reduced and the side of each, with other blocks between them, goes on into the other one, it is the sharper one's, onto which
    /// the blunter one slides up the more easily.
    [[nodiscard]] double share_of_first(int first, const Edge& face, const Corner& corner, int second,
                                        const Edge& other_face, const Corner& other_corner, bool begins) const {
        const double blunter = angle_of(corner) - angle_of(other_corner);
        if (surfaces_.ground_holds_tips) return blunter;
        const EdgeOfBlock side = side_of_corner(first, face, begins);
        const EdgeOfBlock other_side = side_of_corner(second, other_face, !begins);
        if (!have_blocks_between(side.block, *side.edge, other_side.block, *other_side.edge)) return blunter;
        const auto whole = [&](const Corner& at, const Vec2& away, bool face_begins) {
            return face_begins ? Corner{away, at.leaving} : Corner{at.arriving, away};
        };
        const Corner one = whole(corner, as_cut(*side.edge), begins);
        const Corner other = whole(other_corner, as_cut(*other_side.edge), !begins);
        const Corner& begun = begins ? one : other; // its face begins at the vertex
        const Corner& ended = begins ? other : one;
        const bool go_on_inside = is_between(begun.arriving, -ended.arriving, ended.leaving) &&
                                  is_between(-ended.leaving, begun.leaving, -begun.arriving);
        return (go_on_inside ? -1.0 : 1.0) * (angle_of(one) - angle_of(other));
    }

    /// Whether a vertex that is an end of the target's edge too has a void between the one and the other, as the toe of a dam that ends
    /// at a riser. Of two corners at one point the sharper one (see share_of_first) touches the face of the blunter one, and goes on to where it is pressed a
    /// little below its end; where both stand free, tip against tip, or a face of the one goes on straight in one of the other, neither does.
    [[nodiscard]] bool are_beside_a_void(int owner, const CurrentEdge& leaving, int target,
                                         const CurrentEdge& edge) const {
        const Edge& side = reference(target, edge.edge);
        const int vertex = reference(owner, leaving.edge).start;
        const bool at_end = vertex == side.end;
        const Edge& face = reference(owner, at_end ? leaving.edge : leaving.arriving);
        if (!are_outlines(side, face)) return false;
        const Corner of_target = at_end ? corner_at_end(edge) : corner_at_start(edge);
        if (share_of_first(owner, face, corner_at_start(leaving), target, side, of_target, at_end) > straight)
            return false;
        const Vec2 arriving = leaving.start - leaving.before;
        const Vec2 other_side = at_end ? of_target.leaving : of_target.arriving;
        if (go_on_straight(at_end ? arriving : leaving.direction, edge.direction) ||
            go_on_straight(at_end ? leaving.direction : arriving, other_side))
            return false;
        if (is_ground_before(owner, leaving, target, edge)) return false;
        return is_notch(of_target) || std::ranges::any_of(system_.blocks[target].edges, [&](const Edge& other) {
                   return other.interface >= 0 && (at_end ? other.start : other.end) == vertex;
               });
    }

    /// Whether other blocks lie between an edge of the owner and one of the target that go out from one place, each along a fracture and no
    /// net: as above the foot of a valley, between the wedge that slides into it and its other face.
    [[nodiscard]] bool have_blocks_between(int owner, const Edge& edge, int target, const Edge& side) const {
        const auto is_fracture = [&](const Edge& each) {
            return each.interface >= 0 && surfaces_.bonded[each.interface] == 0 &&
                   system_.interfaces[each.interface].origin != EdgeOrigin::tessellation;
        };
        if (!is_fracture(edge) || !is_fracture(side)) return false;
        const Interface& interface = system_.interfaces[edge.interface];
        return (interface.block_a == owner ? interface.block_b : interface.block_a) != target;
    }

    /// Whether the target's edge is ground before a tip of which no count is taken: the tip stood at the foot of the edge as cut, its other face on a
    /// block; the edge rises before that face; and there are other blocks between the two, or a void, and the tip leans away from the edge, by its bisector, as a sharp
    /// wedge does whose plane comes out where the ground before a slope begins. What presses on it from there would bend it off, or have it
    /// ride over; a tip that leans over the edge, as the toe of a dam does over a riser, is pressed into its block.
    [[nodiscard]] bool is_ground_before(int owner, const CurrentEdge& leaving, int target,
                                        const CurrentEdge& edge) const {
        if (surfaces_.ground_holds_tips) return false;
        const Edge& side = reference(target, edge.edge);
        const Edge& arriving = reference(owner, leaving.arriving);
        const Edge& going_on = reference(owner, leaving.edge);
        const Vec2 tip = edge_start(system_, going_on);
        const double from_start = (tip - edge_start(system_, side)).norm();
        const double from_end = (tip - edge_end(system_, side)).norm();
        const double smaller = std::min(system_.blocks[owner].size, system_.blocks[target].size);
        if (std::min(from_start, from_end) > at_the_foot * smaller) return false;
        const bool at_end = from_end < from_start;
        const Edge& sliding = at_end ? arriving : going_on;
        const Edge& other = at_end ? going_on : arriving;
        if (sliding.interface < 0) return false;
        const EdgeOfBlock beyond = side_of_corner(owner, sliding, !at_end);
        const bool is_below_others =
            surfaces_.bonded[sliding.interface] == 0 && have_blocks_between(beyond.block, *beyond.edge, target, side);
        if (!is_below_others && !are_outlines(side, other)) return false;
        const Vec2 before = (edge_start(system_, arriving) - tip).normalized();
        const Vec2 after = (edge_end(system_, going_on) - tip).normalized();
        const Vec2 along_side = (edge_end(system_, side) - edge_start(system_, side)).normalized();
        const Vec2 from_tip = at_end ? -along_side : along_side;
        const bool rises = right_normal(at_end ? -before : after).dot(from_tip) < -flush;
        return rises && (is_below_others || (before + after).normalized().dot(from_tip) < -straight);
    }

    /// Whether one block slides past the side of another one that comes up below its toe, of which no count is taken: as cut, the toe, the lower end of `face`,
    /// an outline, stood at the upper end of `side`, other blocks lay between this and the first one's base, and the base goes on more nearly straight in the
    /// outline of the second one than the side does in `face`. As of a dam whose toe stands on the end of a joint in its ground: it would catch on what the
    /// block below it has sunk. Where it is so: how far the toe lies below that outline (m).
    [[nodiscard]] std::optional<double> toe_beside_side(int owner, const Edge& face, int target,
                                                        const Edge& side) const {
        if (surfaces_.ground_holds_tips || face.interface >= 0 || side.interface < 0) return std::nullopt;
        const bool at_start = face.start == side.start;
        if (!at_start && face.end != side.end) return std::nullopt;
        const EdgeOfBlock base = side_of_corner(owner, face, at_start);
        const EdgeOfBlock top = side_of_corner(target, side, at_start);
        if (top.edge->interface >= 0 || !have_blocks_between(base.block, *base.edge, target, side)) return std::nullopt;
        const double rise = turn_at_end(as_cut(*base.edge), as_cut(*top.edge));
        if (rise > flat || rise > turn_at_end(as_cut(side), as_cut(face)) + flush) return std::nullopt;
        const double sunk = depth_below(top.block, *top.edge, owner, at_start ? face.start : face.end);
        const double smaller = std::min(system_.blocks[owner].size, system_.blocks[target].size);
        if (sunk > sunk_under_loads * smaller) return std::nullopt;
        return sunk;
    }

    [[nodiscard]] Vec2 as_cut(const Edge& edge) const { return edge_end(system_, edge) - edge_start(system_, edge); }

    /// The angle by which one goes on into the other of two edges that both end, or both start, in one point (rad).
    [[nodiscard]] static double turn_at_end(const Vec2& x, const Vec2& y) {
        return std::atan2(std::abs(cross(x, y)), -x.dot(y));
    }

    /// How far a vertex of a block lies behind an edge of another one (m), as they lie.
    [[nodiscard]] double depth_below(int target, const Edge& edge, int block, int vertex) const {
        const Vec2 start = current_position(system_, q_, target, edge.start);
        const Vec2 along = current_position(system_, q_, target, edge.end) - start;
        return -right_normal(along.normalized()).dot(current_position(system_, q_, block, vertex) - start);
    }

    /// How far the toe lies below the outline that it slides onto, where it is the vertex at which `leaving` begins, an end of the target's edge too.
    [[nodiscard]] std::optional<double> toe_beside_side(int owner, const CurrentEdge& leaving, int target,
                                                        const CurrentEdge& edge) const {
        const Edge& side = reference(target, edge.edge);
        const bool at_start = reference(owner, leaving.edge).start == side.start;
        return toe_beside_side(owner, reference(owner, at_start ? leaving.edge : leaving.arriving), target, side);
    }

    /// Whether the end of the target's edge, an outline, is a toe that stands beside the side of the owner that comes up there.
    [[nodiscard]] bool is_below_toe(int owner, const CurrentEdge& leaving, int target, const CurrentEdge& edge) const {
        const Edge& face = reference(target, edge.edge);
        const bool at_start = reference(owner, leaving.edge).start == face.start;
        const Edge& side = reference(owner, at_start ? leaving.edge : leaving.arriving);
        return toe_beside_side(target, face, owner, side).has_value();
    }

    /// The edge before the given one in its loop, or after it.
    [[nodiscard]] const Edge& edge_beside(int block, const Edge& edge, bool before) const {
        const std::vector<Edge>& edges = system_.blocks[block].edges;
        const std::vector<int>& starts = system_.blocks[block].loop_starts;
        const int at = static_cast<int>(&edge - edges.data());
        const auto next_loop = std::ranges::upper_bound(starts, at);
        const int first = *std::prev(next_loop);
        const int last = next_loop == starts.end() ? static_cast<int>(edges.size()) : *next_loop;
        if (before) return edges[at > first ? at - 1 : last - 1];
        return edges[at + 1 < last ? at + 1 : first];
    }

    struct EdgeOfBlock {
        int block = 0;
        const Edge* edge = nullptr;
    };

    /// The other side of the corner that a block has at the start of an edge, or at its end; blocks that are bonded to each other have one corner together.
    [[nodiscard]] EdgeOfBlock side_of_corner(int block, const Edge& from, bool at_start) const {
        EdgeOfBlock side{block, &edge_beside(block, from, at_start)};
        while (is_bonded(surfaces_, *side.edge)) {
            const Interface& bond = system_.interfaces[side.edge->interface];
            const bool is_a = bond.block_a == side.block;
            const int next = is_a ? bond.block_b : bond.block_a;
            const Edge& entered = reference(next, is_a ? bond.edge_b : bond.edge_a);
            if (&entered == &from) break; // all around the vertex
            side = {next, &edge_beside(next, entered, at_start)};
        }
        return side;
    }

    /// Whether a face has such a tip at one of its ends, and the target's edge is the ground before it, or one of the two slides past the other.
    [[nodiscard]] bool slides_onto_ground(int owner, const CurrentEdge& face, std::span<const CurrentEdge> faces,
                                          int target, const CurrentEdge& edge) const {
        if (surfaces_.ground_holds_tips) return false;
        if (reference(owner, face.edge).interface < 0)
            return toe_beside_side(owner, reference(owner, face.edge), target, reference(target, edge.edge))
                .has_value();
        return std::ranges::any_of(faces, [&](const CurrentEdge& leaving) {
            return (leaving.edge == face.edge || leaving.arriving == face.edge) &&
                   is_ground_before(owner, leaving, target, edge);
        });
    }

    /// Whether two faces of two blocks that meet in a vertex are in one line there, and the blocks on its two sides.
    [[nodiscard]] static bool go_on_straight(const Vec2& x, const Vec2& y) {
        return x.dot(y) < 0.0 && std::abs(cross(x, y)) <= flush * x.norm() * y.norm();
    }

    /// Vertices of `owner` (the start of each of its near edges) against the near edges of `target`; `swapped` if the owner is the
    /// higher block.
    void append_vertices(int owner, std::span<const CurrentEdge> leaving_edges, const std::vector<int>& near_leaving,
                         int target, std::span<const CurrentEdge> edges, const std::vector<int>& near, bool swapped) {
        for (const int i : near_leaving) {
            const CurrentEdge& leaving = leaving_edges[i];
            for (const int j : near) {
                const CurrentEdge& edge = edges[j];
                const Vec2 from_edge = leaving.start - edge.start;
                const double gap = right_normal(edge.direction).dot(from_edge);
                if (gap > reach_ || gap < deepest_) continue;
                const double s = edge.direction.dot(from_edge) / edge.length;
                const bool is_beside = beyond_end(s, edge) > -doubtful_ && gap >= shallow_; // most are
                if (!is_beside) append_vertex(owner, leaving, target, edge, gap, s, edges, swapped);
            }
        }
    }

    /// How far a point at s of the edge, 0 to 1 along it, lies beyond the nearer end (m); negative between the ends.
    [[nodiscard]] static double beyond_end(double s, const CurrentEdge& edge) {
        return std::max(-s, s - 1.0) * edge.length;
    }

    /// The vertex lies `gap` before the edge, at s along it.
    void append_vertex(int owner, const CurrentEdge& leaving, int target, const CurrentEdge& edge, double gap, double s,
                       std::span<const CurrentEdge> edges, bool swapped) {
        const Vec2 outward = right_normal(edge.direction);
        const bool is_common = have_common_vertex(owner, leaving, target, edge);
        const bool is_ground = is_ground_before(owner, leaving, target, edge);
        if (is_ground && gap < shallow_) unheld_tips_.push_back({owner, target, edge.edge, -gap, leaving.start});
        if (is_ground && !is_common) return;
        const auto sunk_toe = is_common ? toe_beside_side(owner, leaving, target, edge) : std::nullopt;
        if (sunk_toe && *sunk_toe > -shallow_ && gap < shallow_)
            unheld_tips_.push_back({owner, target, edge.edge, std::min(-gap, *sunk_toe), leaving.start});
        const bool beside_void = is_common && are_beside_a_void(owner, leaving, target, edge);
        const double beyond = beyond_end(s, edge);
        const bool at_end = reference(owner, leaving.edge).start == reference(target, edge.edge).end;
        const bool below_end = beside_void && (at_end ? s > 1.0 : s < 0.0) && beyond <= -doubtful_;
        if (beyond > 0.0 && !below_end && (gap >= shallow_ || !is_in_notch(leaving.start, edge, s < 0.0, edges)))
            return;
        if (!points_at(leaving, outward)) return;
        if (has_side_in(overlapping_, leaving, edge.edge, swapped)) return;
        if (has_side_in(sunk_beside_, leaving, edge.edge, swapped)) return;
        if (is_common && !beside_void && !faces_apart_ &&
            (is_ground || !held_it_last(owner, leaving, target, edge, swapped) || sunk_toe ||
             is_below_toe(owner, leaving, target, edge)))
            return;
        if (!below_end && is_held_by_another_face(leaving, edge, gap, edges, swapped)) return;
        if (gap < shallow_ && !below_end && !is_inside(target, leaving.start)) return; // what takes longest comes last
        ContactPoint point = point_between(owner, leaving, target, edge);
        lay(point, CutEdge(system_, reference(owner, leaving.edge)).at(0.0),
            CutEdge(system_, reference(target, edge.edge)).at(s), leaving.length);
        point.weight = vertex_weight * std::min(edge.length, system_.blocks[owner].size);
        finish(point, -edge.direction);
        points_.push_back(point);
    }

    const BlockSystem& system_;
    const ContactSurfaces& surfaces_;
    const Eigen::VectorXd& q_;
    double reach_;
    const std::vector<ContactMemory>& memory_;
    std::vector<UnheldTip> unheld_tips_;
    std::vector<ContactPoint> points_; ///< in the order in which they were found
    std::vector<int> near_a_, near_b_; ///< edges of the present pair that may touch the other block, by number
    bool bonded_pair_ = false;
    /// Whether two neighbours have an interface and no overlap along any: one has turned about a common vertex, or has gone past the
    /// other. Nothing but this vertex may then keep them apart.
    bool faces_apart_ = false;
    double deepest_ = 0.0;
    double deepest_own_ = 0.0; ///< of the two faces of an interface
    double doubtful_ = 0.0;
    double shallow_ = 0.0;
    std::vector<EdgePair> overlapping_; ///< of the present pair
    /// Of the present pair: deeper in each other than they overlap, or with what is in neither block between them, as where a corner has come
    /// into a face beside the other edge. Their overlap presses with a force that begins at zero, and so the corner does not press there either.
    std::vector<EdgePair> sunk_beside_;
};

/// (block, edge)
using Face = std::pair<int, int>;

/// The mapped fracture that a face is a side of; -1 where it is of none.
int fracture_of(const BlockSystem& system, const Face& face) {
    const int interface = system.blocks[face.first].edges[face.second].interface;
    return interface < 0 ? -1 : system.interfaces[interface].fracture;
}

/// The opening that slip has forced on the faces of mapped fractures so far (m): the largest of each face's points.
std::map<Face, double> dilated_faces(const BlockSystem& system, const std::vector<ContactMemory>& memory) {
    std::map<Face, double> dilated;
    for (const auto& [key, history] : memory) {
        if (history.dilation <= 0.0) continue;
        for (const Face& face : {Face(key.block_a, key.edge_a), Face(key.block_b, key.edge_b)}) {
            if (fracture_of(system, face) < 0) continue;
            double& opening = dilated[face];
            opening = std::max(opening, history.dilation);
        }
    }
    return dilated;
}

/// Where a face of a fracture comes to lie on another one of the same fracture, their asperities hold them apart as far as they
/// held what either lay on before, but no farther than they are now.
double inherited_dilation(const BlockSystem& system, const std::map<Face, double>& dilated, const ContactKey& key,
                          double gap) {
    const Face a(key.block_a, key.edge_a);
    const Face b(key.block_b, key.edge_b);
    const int fracture = fracture_of(system, a);
    if (fracture < 0 || fracture != fracture_of(system, b)) return 0.0;
    double opening = 0.0;
    for (const Face& face : {a, b})
        if (const auto found = dilated.find(face); found != dilated.end()) opening = std::max(opening, found->second);
    return std::clamp(gap, 0.0, opening);
}

/// Whether a point of the overlap of the same two faces is remembered: one that is not has opened without having dilated.
/// `memory` is sorted.
bool is_known_overlap(const std::vector<ContactMemory>& memory, ContactKey key) {
    if (key.point < 0) return false; // a vertex on a face is one point
    key.point = 0;
    const auto first = std::ranges::lower_bound(memory, key, {}, &ContactMemory::key);
    if (first == memory.end()) return false;
    key.point = first->key.point;
    return first->key == key;
}

void transfer_histories(const BlockSystem& system, const Eigen::VectorXd& q, const std::vector<ContactMemory>& memory,
                        std::vector<ContactPoint>& points) {
    const std::map<Face, double> dilated = dilated_faces(system, memory);
    auto next = memory.begin();
    for (ContactPoint& point : points) {
        while (next != memory.end() && next->key < point.key) ++next;
        if (next != memory.end() && next->key == point.key) {
            point.history = next->history;
        } else if (!dilated.empty() && !is_known_overlap(memory, point.key)) {
            point.history.dilation =
                inherited_dilation(system, dilated, point.key, point.normal.dot(relative_position(point, q)));
        }
    }
}

} // namespace

double thickness(const Block& block) {
    const Mat2& m = block.second_moment;
    const double largest = 0.5 * m.trace() + std::hypot(0.5 * (m(0, 0) - m(1, 1)), m(0, 1));
    return block.area / std::sqrt(12.0 * largest / block.area);
}

bool is_fragment(const BlockSystem& system, int block) {
    const bool given = system.outline_type >= 0;
    const double cell = std::sqrt(0.75) * system.spacing * system.spacing;
    return !given && system.blocks[block].area < largest_fragment * cell;
}

double deepest_contact(const BlockSystem& system, int a, int b, bool own) {
    const Block& block_a = system.blocks[a];
    const Block& block_b = system.blocks[b];
    const double smaller = std::min(block_a.size, block_b.size);
    if (own && !is_fragment(system, a) && !is_fragment(system, b)) return smaller;
    const double deepest = deepest_penetration * smaller;
    return own ? deepest : std::min(deepest, deepest_of_thickness * std::min(thickness(block_a), thickness(block_b)));
}

DetectedContacts detect_contacts(const BlockSystem& system, const ContactSurfaces& surfaces, const Eigen::VectorXd& q,
                                 double reach, const std::vector<ContactMemory>& memory) {
    const Surfaces all = current_surfaces(system, surfaces, q);
    DetectedContacts result;
    const std::vector<BlockBox> boxes = bounding_boxes(all);
    const auto pairs = meeting_boxes(boxes, reach);
    result.near_pairs.reserve(pairs.size());
    PairDetection pair_detection(system, surfaces, q, reach, memory);
    pair_detection.expect(std::max(least_overlap_points * all.edges.size() / 2, memory.size() + memory.size() / 4));
    for (const auto& [a, b] : pairs) {
        const Surface& surface_a = all.all[all.of_block[a]];
        const Surface& surface_b = all.all[all.of_block[b]];
        if (!surface_a.separated && !surface_b.separated) continue;
        if (system.blocks[a].fixed && system.blocks[b].fixed) continue;
        result.near_pairs.emplace_back(a, b);
        pair_detection.run(boxes[all.of_block[a]], all.edges_of(surface_a), boxes[all.of_block[b]],
                           all.edges_of(surface_b));
    }
    result.points = pair_detection.points_by_key();
    result.unheld_tips = pair_detection.take_unheld_tips();
    transfer_histories(system, q, memory, result.points);
    return result;
}

} // namespace kluft
