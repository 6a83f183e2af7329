#include "kluft/blocks/given_blocks.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "kluft/blocks/block_search.hpp"
#include "kluft/blocks/open_joint.hpp"
#include "kluft/core/diagnostics.hpp"
#include "kluft/geometry/polygon.hpp"
#include "kluft/geometry/predicates.hpp"
#include "kluft/geometry/segment_grid.hpp"

namespace kluft {

namespace {

constexpr double same_place = 1e-9;     ///< of the diagonal of the body's box
constexpr double shortest_shared = 4.0; ///< of that distance: what two sides share is longer

/// Points that are nearer to each other than the tolerance are one.
class PointIndex {
public:
    explicit PointIndex(double tolerance) : tolerance_(tolerance) {}

    /// Index of a point in `points`, to which it is added if it is new.
    int add(const Vec2& p, std::vector<Vec2>& points) {
        const Cell at{cell(p.x()), cell(p.y())};
        for (std::int64_t i = -1; i <= 1; ++i) {
            for (std::int64_t j = -1; j <= 1; ++j) {
                const auto found = cells_.find({at.first + i, at.second + j});
                if (found == cells_.end()) continue;
                for (const int v : found->second)
                    if ((points[v] - p).norm() <= tolerance_) return v;
            }
        }
        cells_[at].push_back(static_cast<int>(points.size()));
        points.push_back(p);
        return static_cast<int>(points.size()) - 1;
    }

private:
    using Cell = std::pair<std::int64_t, std::int64_t>;
    [[nodiscard]] std::int64_t cell(double x) const { return static_cast<std::int64_t>(std::floor(x / tolerance_)); }

    double tolerance_;
    std::map<Cell, std::vector<int>> cells_;
};

/// A side of a given polygon, with the vertices at which it is split, in order once all are known.
struct Side {
    int block = 0;
    int start = 0;
    int end = 0;
    std::vector<int> splits{};
    std::vector<std::pair<double, double>> inner{}; ///< parts in open joints, along it (m)
};

class Assembly {
public:
    explicit Assembly(const GeometrySpec& spec) : spec_(spec) {}

    CutBody build() {
        check_polygons();
        place_vertices();
        split_sides();
        leave_out_open_joints();
        sort_splits();
        add_blocks();
        refuse_overlaps();
        join_interfaces();
        collect_boundaries();
        form_sets(spec_, system_);
        measure_spacing();
        if (system_.n_blocks() > 1) system_.outline_type = spec_.blocks_interface;
        return {.system = std::move(system_), .report = std::move(report_)};
    }

private:
    [[nodiscard]] const std::string& name(int block) const { return spec_.blocks[block].name; }

    void check_polygons() const {
        for (const GivenBlock& block : spec_.blocks) {
            const bool finite = std::ranges::all_of(block.polygon, [](const Vec2& p) { return p.allFinite(); });
            if (block.polygon.size() < 3 || !finite || !(signed_area(block.polygon) > 0.0) || !is_simple(block.polygon))
                throw InputError(fmt::format("{}: expected a simple polygon, counter-clockwise, found the block '{}'",
                                             spec_.places.blocks, block.name));
        }
    }

    void place_vertices() {
        std::vector<Vec2> all;
        for (const GivenBlock& block : spec_.blocks) all.insert(all.end(), block.polygon.begin(), block.polygon.end());
        const Box box = bounding_box(all);
        system_.origin = box.lower;
        system_.upper = box.upper - box.lower;
        const double farthest = box.lower.cwiseAbs().maxCoeff() + system_.upper.maxCoeff();
        tolerance_ =
            std::max(same_place * system_.upper.norm(), 16.0 * std::numeric_limits<double>::epsilon() * farthest);
        index_.emplace(tolerance_);
        for (std::size_t b = 0; b < spec_.blocks.size(); ++b) {
            const Polygon& polygon = spec_.blocks[b].polygon;
            std::vector<int> corners;
            for (const Vec2& p : polygon) corners.push_back(index_->add(p - system_.origin, system_.vertices));
            for (std::size_t i = 0; i < corners.size(); ++i)
                sides_.push_back({static_cast<int>(b), corners[i], corners[(i + 1) % corners.size()]});
        }
    }

    [[nodiscard]] const Vec2& at(int vertex) const { return system_.vertices[vertex]; }
    [[nodiscard]] Vec2 along(const Side& side) const { return at(side.end) - at(side.start); }

    [[nodiscard]] bool lies_on(int vertex, const Side& side) const {
        return vertex == side.start || vertex == side.end ||
               distance_to_segment(at(vertex), at(side.start), at(side.end)) <= tolerance_;
    }

    /// Sides of different blocks that share a part of an edge are split at its ends.
    void split_sides() {
        std::vector<SegmentGrid::Segment> segments;
        for (const Side& side : sides_) segments.emplace_back(at(side.start), at(side.end));
        const SegmentGrid grid(segments);
        for (int s = 0; s < static_cast<int>(sides_.size()); ++s) {
            Box box = bounding_box({at(sides_[s].start), at(sides_[s].end)});
            box.lower.array() -= tolerance_;
            box.upper.array() += tolerance_;
            for (const int t : grid.near(box))
                if (t > s && sides_[t].block != sides_[s].block) split_pair(sides_[s], sides_[t]);
        }
    }

    void sort_splits() {
        for (Side& side : sides_) {
            const Vec2 direction = along(side);
            std::ranges::sort(side.splits, {},
                              [&](int v) { return std::pair(direction.dot(at(v) - at(side.start)), v); });
            side.splits.erase(std::unique(side.splits.begin(), side.splits.end()), side.splits.end());
        }
    }

    void split_pair(Side& s, Side& t) {
        std::vector<int> shared;
        const auto collect = [&](int vertex, const Side& side) {
            if (lies_on(vertex, side) && std::ranges::find(shared, vertex) == shared.end()) shared.push_back(vertex);
        };
        for (const int v : {t.start, t.end}) collect(v, s);
        for (const int v : {s.start, s.end}) collect(v, t);
        double extent = 0.0;
        for (const int v : shared) extent = std::max(extent, (at(v) - at(shared.front())).norm());
        if (extent <= shortest_shared * tolerance_) return;
        if (along(s).dot(along(t)) > 0.0) refuse(s.block, t.block, at(shared.front()));
        for (Side* side : {&s, &t})
            for (const int v : shared)
                if (v != side->start && v != side->end) side->splits.push_back(v);
    }

    [[noreturn]] void refuse(int a, int b, const Vec2& local) const {
        const Vec2 place = system_.origin + local;
        throw InputError(
            fmt::format("{}: expected blocks that do not overlap, found '{}' and '{}' that do, at ({:.10g}, {:.10g})",
                        spec_.places.blocks, name(a), name(b), place.x(), place.y()));
    }

    /// Boundaries of all blocks have only what lies outside: their sides are split at the ends of open joints.
    void leave_out_open_joints() {
        boundary_ = boundary_of_sides();
        std::vector<SegmentGrid::Segment> segments;
        std::vector<SideOfBlock> sides;
        for (const Side& side : sides_) {
            segments.emplace_back(at(side.start), at(side.end));
            sides.push_back({at(side.start), at(side.end), side.block});
        }
        std::vector<double> sizes;
        for (const GivenBlock& block : spec_.blocks) sizes.push_back(std::sqrt(signed_area(block.polygon)));
        const SegmentGrid grid(segments);
        std::vector<char> asked;
        for (int s = 0; s < static_cast<int>(sides.size()); ++s) {
            const int boundary = boundary_[s];
            if (boundary < 0 || !spec_.boundaries[boundary].block.empty() || !spec_.boundaries[boundary].carries)
                continue;
            Box box = bounding_box({sides[s].start, sides[s].end});
            const double reach = reach_of_open_joints(sizes[sides[s].block]);
            box.lower.array() -= reach;
            box.upper.array() += reach;
            for (const CoveredPart& part : covered_parts(sides, s, grid.near(box, asked), sizes, tolerance_))
                leave_out(s, part);
        }
    }

    /// Where two blocks touch they share an edge, which belongs to no boundary anyway: only strips beside it are left out.
    void leave_out(int s, const CoveredPart& part) {
        const bool is_open = part.gap > tolerance_;
        if (!is_open && part.strips <= shortest_shared * tolerance_) return;
        Side& side = sides_[s];
        const Vec2 start = at(side.start);
        const Vec2 direction = along(side).normalized();
        const double length = along(side).norm();
        for (const double end : {part.from, part.to}) {
            if (end <= tolerance_ || length - end <= tolerance_) continue;
            side.splits.push_back(index_->add(start + end * direction, system_.vertices));
        }
        side.inner.emplace_back(part.from, part.to);
        report_.inner_sides.push_back({.boundary = boundary_[s],
                                       .block = side.block,
                                       .other = part.other,
                                       .gap = is_open ? part.gap : 0.0,
                                       .length = is_open ? part.to - part.from : part.strips,
                                       .at = system_.origin + start + 0.5 * (part.from + part.to) * direction});
    }

    /// Whether a point on the side lies in an open joint.
    [[nodiscard]] bool is_inner(const Side& side, const Vec2& p) const {
        const double distance = (p - at(side.start)).norm();
        return std::ranges::any_of(side.inner,
                                   [&](const auto& part) { return part.first <= distance && distance <= part.second; });
    }

    void add_blocks() {
        for (const GivenBlock& given : spec_.blocks) {
            Block block;
            block.loop_starts = {0};
            block.material = given.material;
            block.fixed = given.fixed;
            system_.blocks.push_back(std::move(block));
            system_.block_names.push_back(given.name);
        }
        for (std::size_t s = 0; s < sides_.size(); ++s) {
            const Side& side = sides_[s];
            Block& block = system_.blocks[side.block];
            int from = side.start;
            const auto add_edge = [&](int to) {
                const int boundary = is_inner(side, 0.5 * (at(from) + at(to))) ? -1 : boundary_[s];
                block.edges.push_back({.start = from, .end = to, .interface = -1, .boundary = boundary});
                from = to;
            };
            for (const int v : side.splits) add_edge(v);
            add_edge(side.end);
        }
        for (int b = 0; b < system_.n_blocks(); ++b) {
            check_loop(b);
            compute_block_moments(system_.vertices, system_.blocks[b]);
        }
    }

    [[nodiscard]] std::vector<int> boundary_of_sides() const {
        std::vector<int> boundary(sides_.size(), -1);
        for (std::size_t k = 0; k < spec_.boundaries.size(); ++k) {
            for (const int side : spec_.boundaries[k].sides) {
                if (side < 0 || side >= static_cast<int>(sides_.size()))
                    throw InputError(fmt::format("boundaries.{}: expected a side of a block, found side {} of {}",
                                                 spec_.boundaries[k].name, side, sides_.size()));
                boundary[side] = static_cast<int>(k);
            }
        }
        return boundary;
    }

    void check_loop(int b) const {
        std::vector<int> starts;
        for (const Edge& edge : system_.blocks[b].edges) starts.push_back(edge.start);
        std::ranges::sort(starts);
        if (std::ranges::adjacent_find(starts) == starts.end()) return;
        throw InputError(
            fmt::format("geometry.blocks: expected a simple polygon with sides longer than {:.2g} m, found "
                        "the block '{}'",
                        tolerance_, name(b)));
    }

    // ---- overlaps --------------------------------------------------------------------------------------------

    void refuse_overlaps() const {
        std::vector<Polygon> outlines;
        std::vector<Box> boxes;
        for (const Block& block : system_.blocks) {
            Polygon outline;
            for (const Edge& edge : block.edges) outline.push_back(at(edge.start));
            boxes.push_back(bounding_box(outline));
            outlines.push_back(std::move(outline));
        }
        for (int a = 0; a < system_.n_blocks(); ++a) {
            for (int b = a + 1; b < system_.n_blocks(); ++b) {
                const bool apart = (boxes[a].lower.array() > boxes[b].upper.array()).any() ||
                                   (boxes[b].lower.array() > boxes[a].upper.array()).any();
                if (apart) continue;
                auto place = crossing(a, b);
                if (!place) place = middle_inside(a, b, outlines[b]);
                if (!place) place = middle_inside(b, a, outlines[a]);
                if (place) refuse(a, b, *place);
            }
        }
    }

    /// Where an edge of one block passes through one of the other.
    [[nodiscard]] std::optional<Vec2> crossing(int a, int b) const {
        for (const Edge& p : system_.blocks[a].edges) {
            for (const Edge& r : system_.blocks[b].edges) {
                const int r_start = orientation(at(p.start), at(p.end), at(r.start));
                const int r_end = orientation(at(p.start), at(p.end), at(r.end));
                if (r_start * r_end >= 0) continue;
                const int p_start = orientation(at(r.start), at(r.end), at(p.start));
                const int p_end = orientation(at(r.start), at(r.end), at(p.end));
                if (p_start * p_end >= 0) continue;
                if (passes(p, r) && passes(r, p)) return at(r.start);
            }
        }
        return std::nullopt;
    }

    /// Both ends of r are farther from p's line than the tolerance.
    [[nodiscard]] bool passes(const Edge& p, const Edge& r) const {
        const Vec2 direction = (at(p.end) - at(p.start)).normalized();
        return std::abs(cross(direction, at(r.start) - at(p.start))) > tolerance_ &&
               std::abs(cross(direction, at(r.end) - at(p.start))) > tolerance_;
    }

    /// The middle of an edge of `block` that lies inside the outline of the other one.
    [[nodiscard]] std::optional<Vec2> middle_inside(int block, int other, const Polygon& outline) const {
        for (const Edge& edge : system_.blocks[block].edges) {
            const Vec2 middle = 0.5 * (at(edge.start) + at(edge.end));
            if (!contains(outline, middle)) continue;
            const bool is_deep = std::ranges::all_of(system_.blocks[other].edges, [&](const Edge& e) {
                return distance_to_segment(middle, at(e.start), at(e.end)) > tolerance_;
            });
            if (is_deep) return middle;
        }
        return std::nullopt;
    }

    // ---- interfaces and boundaries ---------------------------------------------------------------------------

    void join_interfaces() {
        std::map<std::pair<int, int>, std::pair<int, int>> edge_at; // (start, end) -> (block, edge)
        for (int b = 0; b < system_.n_blocks(); ++b) {
            const auto& edges = system_.blocks[b].edges;
            for (int e = 0; e < static_cast<int>(edges.size()); ++e) {
                const auto [found, is_new] = edge_at.try_emplace({edges[e].start, edges[e].end}, b, e);
                if (!is_new) refuse(found->second.first, b, at(edges[e].start));
            }
        }
        for (int a = 0; a < system_.n_blocks(); ++a) {
            auto& edges = system_.blocks[a].edges;
            for (int e = 0; e < static_cast<int>(edges.size()); ++e) {
                const auto twin = edge_at.find({edges[e].end, edges[e].start});
                if (twin == edge_at.end()) continue;
                edges[e].boundary = -1;
                const auto [b, edge_b] = twin->second;
                if (b <= a) continue;
                const int number = system_.n_interfaces();
                edges[e].interface = number;
                system_.blocks[b].edges[edge_b].interface = number;
                system_.interfaces.push_back({.block_a = a,
                                              .edge_a = e,
                                              .block_b = b,
                                              .edge_b = edge_b,
                                              .origin = EdgeOrigin::given,
                                              .fracture = -1,
                                              .interface_type = spec_.blocks_interface});
            }
        }
    }

    void collect_boundaries() {
        for (const BoundarySides& named : spec_.boundaries) system_.boundaries.push_back({named.name, {}});
        for (int b = 0; b < system_.n_blocks(); ++b) {
            const auto& edges = system_.blocks[b].edges;
            for (int e = 0; e < static_cast<int>(edges.size()); ++e)
                if (edges[e].boundary >= 0) system_.boundaries[edges[e].boundary].edges.push_back({b, e});
        }
        for (std::size_t k = 0; k < spec_.boundaries.size(); ++k) {
            if (spec_.boundaries[k].block.empty() || !system_.boundaries[k].edges.empty()) continue;
            throw InputError(fmt::format("boundaries.{}: expected a free side of the block '{}', found none that no "
                                         "other block covers",
                                         spec_.boundaries[k].name, spec_.boundaries[k].block));
        }
    }

    void measure_spacing() {
        system_.spacing = spec_.reference_spacing;
        if (system_.spacing > 0.0) return;
        double area = 0.0;
        int count = 0;
        const bool all_fixed = std::ranges::all_of(system_.blocks, &Block::fixed);
        for (const Block& block : system_.blocks) {
            if (block.fixed && !all_fixed) continue;
            area += block.area;
            ++count;
        }
        system_.spacing = std::sqrt(area / count);
    }

    const GeometrySpec& spec_;
    double tolerance_ = 0.0;
    std::optional<PointIndex> index_; ///< of the vertices
    std::vector<Side> sides_;         ///< of all polygons, one after the other
    std::vector<int> boundary_;       ///< of each side; -1 for none
    BlockSystem system_;
    CutReport report_;
};

} // namespace

CutBody assemble_blocks(const GeometrySpec& spec) { return Assembly(spec).build(); }

} // namespace kluft
