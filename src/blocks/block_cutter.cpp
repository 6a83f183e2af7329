#include "kluft/blocks/block_cutter.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <numeric>
#include <optional>
#include <string>
#include <tuple>

#include <fmt/format.h>

#include "kluft/blocks/arrangement.hpp"
#include "kluft/blocks/block_search.hpp"
#include "kluft/blocks/fracture_trace.hpp"
#include "kluft/blocks/free_pieces.hpp"
#include "kluft/blocks/given_blocks.hpp"
#include "kluft/blocks/hexagon_lattice.hpp"
#include "kluft/blocks/map_mender.hpp"
#include "kluft/blocks/triangle_net.hpp"
#include "kluft/blocks/voronoi_cells.hpp"
#include "kluft/blocks/whole_cells.hpp"
#include "kluft/core/diagnostics.hpp"
#include "kluft/core/memory.hpp"
#include "kluft/core/place_text.hpp"
#include "kluft/geometry/polygon.hpp"
#include "kluft/geometry/predicates.hpp"
#include "kluft/geometry/segment_grid.hpp"

namespace kluft {

namespace {

/// Numbers of what cuts the body, in order of priority: the sides of the outline, those of the holes, the fractures,
/// the tessellation.
struct SourceNumbers {
    int first_fracture = 0; ///< = number of all sides, of the outline and of the holes
    int tessellation = 0;   ///< = first_fracture + number of fractures
};

SourceNumbers number_sources(const GeometrySpec& spec) {
    SourceNumbers numbers;
    numbers.first_fracture = static_cast<int>(spec.domain.size());
    for (const Polygon& hole : spec.holes) numbers.first_fracture += static_cast<int>(hole.size());
    numbers.tessellation = numbers.first_fracture + static_cast<int>(spec.fractures.size());
    return numbers;
}

void check_finite(const std::vector<Vec2>& points, const std::string& what) {
    for (std::size_t i = 0; i < points.size(); ++i) {
        if (!points[i].allFinite()) throw InputError(fmt::format("{}: point {} is not a finite number", what, i));
    }
}

void check_polygon(const Polygon& polygon, const std::string& what) {
    if (polygon.size() < 3) {
        throw InputError(fmt::format("{}: expected a polygon of at least 3 points, found {}", what, polygon.size()));
    }
    check_finite(polygon, what);
}

/// The boundary of each side of the outline and of the holes, -1 for sides in none.
std::vector<int> boundary_of_sides(const GeometrySpec& spec) {
    const int n_sides = number_sources(spec).first_fracture;
    std::vector<int> boundary(n_sides, -1);
    for (int k = 0; k < static_cast<int>(spec.boundaries.size()); ++k) {
        const BoundarySides& named = spec.boundaries[k];
        for (const int side : named.sides) {
            if (side < 0 || side >= n_sides) {
                throw InputError(fmt::format("boundaries.{}: the domain and its holes have sides 0 to {}, found {}",
                                             named.name, n_sides - 1, side));
            }
            if (boundary[side] >= 0 && boundary[side] != k) {
                throw InputError(fmt::format("boundaries.{}: side {} already belongs to boundary {}", named.name, side,
                                             spec.boundaries[boundary[side]].name));
            }
            boundary[side] = k;
        }
    }
    return boundary;
}

void check_spec(const GeometrySpec& spec) {
    check_polygon(spec.domain, spec.places.domain);
    for (std::size_t i = 0; i < spec.holes.size(); ++i) {
        check_polygon(spec.holes[i], fmt::format("{}: hole {}", spec.places.domain, i));
    }
    for (std::size_t i = 0; i < spec.fractures.size(); ++i) {
        const FractureTrace& trace = spec.fractures[i];
        const std::string what =
            fmt::format("{}{}", trace.place.empty() ? fmt::format("geometry.fractures.{}", i) : trace.place,
                        trace.name.empty() ? "" : fmt::format(" ({})", trace.name));
        if (trace.points.size() < 2) {
            throw InputError(
                fmt::format("{}: expected a trace of at least 2 points, found {}", what, trace.points.size()));
        }
        check_finite(trace.points, what);
    }
    for (std::size_t i = 0; i < spec.regions.size(); ++i) {
        check_polygon(spec.regions[i].polygon, fmt::format("geometry.regions.{}", i));
    }
    if (spec.tessellation && spec.tessellation->region) {
        check_polygon(*spec.tessellation->region, "geometry.tessellation.region");
    }
    if (!(minimum_area_share(spec) >= 0.0 && minimum_area_share(spec) < 1.0)) {
        throw InputError(
            fmt::format("geometry.minimum_area: expected a fraction 0 <= f < 1, found {}", minimum_area_share(spec)));
    }
    if (!(spec.reference_spacing >= 0.0) || !std::isfinite(spec.reference_spacing)) {
        throw InputError(
            fmt::format("geometry.reference_spacing: expected a length, found {}", spec.reference_spacing));
    }
}

/// The body relative to the lower left corner of the domain's box.
struct LocalFrame {
    Vec2 origin = Vec2::Zero();
    Box box; ///< of the domain, local

    [[nodiscard]] Polygon to_local(const Polygon& points) const {
        Polygon local = points;
        for (Vec2& p : local) p -= origin;
        return local;
    }
};

LocalFrame local_frame(const Polygon& domain) {
    LocalFrame frame;
    frame.origin = bounding_box(domain).lower;
    frame.box = bounding_box(frame.to_local(domain));
    return frame;
}

void add_polygon(std::vector<SourceSegment>& segments, const Polygon& polygon, int first_source) {
    for (std::size_t i = 0; i < polygon.size(); ++i) {
        segments.push_back({polygon[i], polygon[(i + 1) % polygon.size()], first_source + static_cast<int>(i)});
    }
}

std::vector<SourceSegment> outline_segments(const GeometrySpec& spec, const LocalFrame& frame) {
    std::vector<SourceSegment> segments;
    add_polygon(segments, frame.to_local(spec.domain), 0);
    int first = static_cast<int>(spec.domain.size());
    for (const Polygon& hole : spec.holes) {
        add_polygon(segments, frame.to_local(hole), first);
        first += static_cast<int>(hole.size());
    }
    return segments;
}

/// The polygons of the outline, each with the body to its left.
std::vector<Polygon> outlines(const GeometrySpec& spec, const LocalFrame& frame) {
    std::vector<Polygon> polygons{frame.to_local(spec.domain)};
    for (const Polygon& hole : spec.holes) polygons.push_back(frame.to_local(hole));
    for (Polygon& polygon : polygons) {
        const bool is_hole = &polygon != &polygons.front();
        if ((signed_area(polygon) > 0.0) == is_hole) std::ranges::reverse(polygon);
    }
    return polygons;
}

/// Which polygon a side of the domain belongs to, and the place that it has there.
struct SideOfPolygon {
    int polygon = -1; ///< -1: the outline; the index of a hole
    int index = 0;
    int n_sides = 0;

    [[nodiscard]] std::string name() const { return polygon < 0 ? "the outline" : fmt::format("hole {}", polygon); }
    [[nodiscard]] bool is_before(const SideOfPolygon& other) const {
        return polygon == other.polygon && (index + 1) % n_sides == other.index;
    }
};

std::vector<SideOfPolygon> sides_of_domain(const GeometrySpec& spec) {
    std::vector<SideOfPolygon> sides;
    const auto add = [&sides](int polygon, const Polygon& points) {
        const int n_sides = static_cast<int>(points.size());
        for (int i = 0; i < n_sides; ++i) sides.push_back({polygon, i, n_sides});
    };
    add(-1, spec.domain);
    for (std::size_t i = 0; i < spec.holes.size(); ++i) add(static_cast<int>(i), spec.holes[i]);
    return sides;
}

/// A place that two segments which meet have in common.
Vec2 common_place(const SourceSegment& first, const SourceSegment& second) {
    for (const Vec2& p : {second.a, second.b})
        if (on_segment(p, first.a, first.b)) return p;
    for (const Vec2& p : {first.a, first.b})
        if (on_segment(p, second.a, second.b)) return p;
    const Vec2 along = first.b - first.a;
    const Vec2 across = second.b - second.a;
    return first.a + cross(second.a - first.a, across) / cross(along, across) * along;
}

/// Where two sides have more in common than the corner between successive ones, if anywhere.
std::optional<Vec2> conflict_of(const SourceSegment& first, const SideOfPolygon& of_first, const SourceSegment& second,
                                const SideOfPolygon& of_second) {
    if (of_second.is_before(of_first)) return conflict_of(second, of_second, first, of_first);
    if (!of_first.is_before(of_second)) {
        if (!segments_meet(first.a, first.b, second.a, second.b)) return std::nullopt;
        return common_place(first, second);
    }
    const bool turns_back =
        orientation(first.a, first.b, second.b) == 0 && (first.a - first.b).dot(second.b - first.b) > 0.0;
    return turns_back ? std::optional(first.b) : std::nullopt;
}

std::vector<SegmentGrid::Segment> pairs_of(const std::vector<SourceSegment>& segments) {
    std::vector<SegmentGrid::Segment> pairs;
    pairs.reserve(segments.size());
    for (const SourceSegment& segment : segments) pairs.emplace_back(segment.a, segment.b);
    return pairs;
}

/// "the outline crosses or touches itself at (1, 2)" for the first place where that is so.
std::string flaw_of_outline(const GeometrySpec& spec, const std::vector<SourceSegment>& segments, const Vec2& origin) {
    const std::vector<SideOfPolygon> sides = sides_of_domain(spec);
    const SegmentGrid grid(pairs_of(segments));
    for (std::size_t i = 0; i < segments.size(); ++i) {
        for (const int j : grid.near(bounding_box({segments[i].a, segments[i].b}))) {
            if (j <= static_cast<int>(i)) continue;
            const auto local = conflict_of(segments[i], sides[i], segments[j], sides[j]);
            if (!local) continue;
            const Vec2 at = origin + *local;
            const bool same = sides[i].polygon == sides[j].polygon;
            return fmt::format("{} crosses or touches {} at {}", sides[i].name(), same ? "itself" : sides[j].name(),
                               place_text(at));
        }
    }
    return "the outline or a hole crosses or touches itself or another";
}

/// An outline is sound if it subdivides into exactly its own sides and vertices, and each hole lies in the body.
void check_outline(const GeometrySpec& spec, const std::vector<SourceSegment>& segments, const Vec2& origin) {
    const std::vector<SideOfPolygon> sides = sides_of_domain(spec);
    for (std::size_t i = 0; i < segments.size(); ++i) {
        if (segments[i].a != segments[i].b) continue;
        const Vec2 at = origin + segments[i].a;
        throw InputError(fmt::format("{}: two successive points of {} are the same, {}", spec.places.domain,
                                     sides[i].name(), place_text(at)));
    }
    const PlanarMap map = arrange(segments);
    const int n_vertices = static_cast<int>(map.positions.size());
    bool simple = map.n_edges() == static_cast<int>(segments.size()) && n_vertices == map.n_edges() &&
                  map.n_faces() == 2 + static_cast<int>(spec.holes.size());
    for (int v = 0; v < n_vertices && simple; ++v) simple = map.degree(v, 3) == 2;
    if (!simple) throw InputError(fmt::format("{}: {}", spec.places.domain, flaw_of_outline(spec, segments, origin)));
    // Inside the body every hole has the body's face on its outer side: the face that is left of or right of side 0.
    const auto faces_of = [&map](int source) {
        const auto e = std::find(map.sources.begin(), map.sources.end(), source) - map.sources.begin();
        return std::pair(map.face(static_cast<int>(2 * e)), map.face(static_cast<int>(2 * e + 1)));
    };
    const auto [left, right] = faces_of(0);
    const int body = left == 0 ? right : left;
    int first = static_cast<int>(spec.domain.size());
    for (std::size_t i = 0; i < spec.holes.size(); ++i) {
        const auto [a, b] = faces_of(first);
        const Vec2& at = spec.holes[i].front();
        if (a != body && b != body)
            throw InputError(fmt::format("{}: hole {}, from {} on, lies outside the outline or inside another",
                                         spec.places.domain, i, place_text(at)));
        first += static_cast<int>(spec.holes[i].size());
    }
}

bool has_triangles(const GeometrySpec& spec) { return spec.tessellation && spec.tessellation->triangles; }

/// The smallest length that the cut resolves (m); see block_cutter.hpp.
double resolution(const GeometrySpec& spec, const LocalFrame& frame) {
    constexpr double of_spacing = 0.02;
    constexpr double of_side = 0.05; // of triangles, whose quality near a short line costs many small ones
    constexpr double of_diagonal = 1e-9;
    constexpr double of_position = 16.0 * std::numeric_limits<double>::epsilon();
    const double farthest = frame.origin.cwiseAbs().maxCoeff() + frame.box.upper.maxCoeff();
    const double spacing = std::min(lattice_spacing(spec), frame.box.upper.minCoeff());
    return std::max(
        {has_triangles(spec) ? of_side * smallest_side(*spec.tessellation->triangles) : of_spacing * spacing,
         of_diagonal * frame.box.upper.norm(), of_position * farthest});
}

std::vector<SourceTrace> local_traces(const GeometrySpec& spec, const LocalFrame& frame, const SourceNumbers& numbers) {
    std::vector<SourceTrace> traces;
    for (const FractureTrace& fracture : spec.fractures) {
        const std::vector<Vec2> points = frame.to_local(fracture.points);
        const int source = numbers.first_fracture + static_cast<int>(&fracture - spec.fractures.data());
        for (auto& part :
             parts_near(frame.box, has_triangles(spec) ? simplified(points, resolution(spec, frame)) : points))
            traces.push_back({std::move(part), source});
    }
    return traces;
}

void add_traces(std::vector<SourceSegment>& segments, const std::vector<SourceTrace>& traces) {
    for (const SourceTrace& trace : traces) {
        for (std::size_t i = 0; i + 1 < trace.points.size(); ++i) {
            if (trace.points[i] == trace.points[i + 1]) continue;
            segments.push_back({trace.points[i], trace.points[i + 1], trace.source});
        }
    }
}

/// Which hexagons are made exactly: those that something else may touch, and their neighbours, or all.
enum class ExactCells { where_needed, all };

/// The cells with their centre in the region, and of these only those that can reach into the domain. `others` is all else
/// that cuts the body.
HexagonNet net_of(const GeometrySpec& spec, const LocalFrame& frame, const SegmentGrid& outline,
                  const std::vector<SourceSegment>& others, ExactCells exact) {
    const Tessellation& net = *spec.tessellation;
    const Polygon domain = frame.to_local(spec.domain);
    const Polygon region = net.region ? frame.to_local(*net.region) : Polygon{};
    const double reach = net.voronoi ? voronoi_reach(*net.voronoi) : hexagon_reach(net.hexagons);
    const auto keeps = [&](const Vec2& centre) {
        if (!region.empty() && !contains(region, centre)) return false;
        return contains(domain, centre) || std::isfinite(outline.distance(centre, reach));
    };
    if (net.voronoi) return {.whole = {}, .edges = voronoi_edges(*net.voronoi, frame.box, keeps)};
    if (exact == ExactCells::all) return {.whole = {}, .edges = hexagon_edges(net.hexagons, frame.box, keeps)};
    const SegmentGrid cutting(pairs_of(others));
    const double farthest = reach + net.hexagons.spacing; // of what can touch a neighbour
    const auto is_clear = [&](const Vec2& centre) {
        return !std::isfinite(cutting.distance(centre, farthest)) && contains(domain, centre);
    };
    return hexagon_net(net.hexagons, frame.box, keeps, is_clear);
}

/// What a net of triangles follows beside the outline and the fractures: construction lines and its region's sides.
std::vector<SourceSegment> lines_of_net(const GeometrySpec& spec, const LocalFrame& frame,
                                        const SourceNumbers& numbers) {
    std::vector<SourceTrace> lines;
    const auto add = [&](const std::vector<Vec2>& line) {
        for (auto& part : parts_near(frame.box, line)) lines.push_back({std::move(part), numbers.tessellation});
    };
    for (const auto& line : spec.construction_lines) add(frame.to_local(line));
    if (spec.tessellation->region) {
        Polygon closed = frame.to_local(*spec.tessellation->region);
        closed.push_back(closed.front());
        add(closed);
    }
    std::vector<SourceSegment> segments;
    add_traces(segments, lines);
    return segments;
}

struct Cuts {
    std::vector<SourceSegment> segments;
    WholeCells whole; ///< that no segment touches
    int joined_ends = 0;
};

Cuts cuts_of(const GeometrySpec& spec, const LocalFrame& frame, const SourceNumbers& numbers, ExactCells exact) {
    Cuts cuts;
    cuts.segments = outline_segments(spec, frame);
    check_outline(spec, cuts.segments, frame.origin);
    const SegmentGrid outline(pairs_of(cuts.segments));

    const std::vector<SourceTrace> traces = local_traces(spec, frame, numbers);
    add_traces(cuts.segments, traces);
    const std::vector<SourceSegment> bridges = bridge_ends(traces, cuts.segments, resolution(spec, frame));
    if (!spec.tessellation) { // the cells of a net part by themselves
        std::vector<SourceSegment> of_traces;
        add_traces(of_traces, traces);
        const auto to_notches = bridge_notches(outlines(spec, frame), of_traces, resolution(spec, frame));
        cuts.segments.insert(cuts.segments.end(), to_notches.begin(), to_notches.end());
    }
    cuts.segments.insert(cuts.segments.end(), bridges.begin(), bridges.end());
    cuts.joined_ends = static_cast<int>(bridges.size());
    if (has_triangles(spec)) {
        const std::vector<SourceSegment> lines = lines_of_net(spec, frame, numbers);
        cuts.segments.insert(cuts.segments.end(), lines.begin(), lines.end());
    } else if (spec.tessellation) {
        HexagonNet net = net_of(spec, frame, outline, cuts.segments, exact);
        for (const auto& [a, b] : net.edges) cuts.segments.push_back({a, b, numbers.tessellation});
        cuts.whole = std::move(net.whole);
    }
    return cuts;
}

/// Every crossing of the outline changes sides: what an odd number of crossings separates from face 0 is the body.
std::vector<char> faces_in_body(const PlanarMap& map, int first_fracture) {
    std::vector<char> in_body(map.n_faces(), 0);
    std::vector<char> reached(map.n_faces(), 0);
    std::vector<int> stack{0};
    reached[0] = 1;
    while (!stack.empty()) {
        const int face = stack.back();
        stack.pop_back();
        for (const int h : map.faces[face]) {
            const int across = map.face(PlanarMap::twin(h));
            if (reached[across] != 0) continue;
            reached[across] = 1;
            in_body[across] = static_cast<char>(in_body[face] ^ (map.source(h) < first_fracture ? 1 : 0));
            stack.push_back(across);
        }
    }
    return in_body;
}

void take_outside_away(PlanarMap& map, const SourceNumbers& numbers) {
    const std::vector<char> in_body = faces_in_body(map, numbers.first_fracture);
    for (int f = 0; f < map.n_faces(); ++f) {
        if (in_body[f] != 0) continue;
        for (const int h : map.faces[f]) map.half_edges[h].face = PlanarMap::outside;
        map.faces[f] = {};
    }
}

/// Connected pieces of fractures in the body with the same face on both sides, each fracture on its own, that are
/// longer than `shortest` in all; the longest one first.
std::vector<LoosePiece> pruned_pieces(const PlanarMap& map, const SourceNumbers& numbers, double shortest) {
    std::vector<int> root;                       // of each free edge, in the order found
    std::vector<double> length;                  // of the piece, at its root
    std::vector<int> source;                     // of each free edge
    std::map<std::pair<int, int>, int> first_at; // (source, vertex) -> free edge
    const auto find = [&root](int i) {
        while (root[i] != i) i = root[i] = root[root[i]];
        return i;
    };
    for (int h = 0; h < 2 * map.n_edges(); h += 2) {
        const bool free = map.face(h) == map.face(h + 1) && map.face(h) != PlanarMap::outside;
        if (!free || map.source(h) >= numbers.tessellation) continue;
        const int edge = static_cast<int>(root.size());
        root.push_back(edge);
        length.push_back(map.length(h));
        source.push_back(map.source(h));
        for (const int v : {map.start(h), map.end(h)}) {
            const int a = find(edge);
            const int b = find(first_at.emplace(std::pair(map.source(h), v), edge).first->second);
            if (a == b) continue;
            root[a] = b;
            length[b] += length[a];
        }
    }
    std::vector<LoosePiece> pieces;
    for (int i = 0; i < static_cast<int>(root.size()); ++i)
        if (root[i] == i && length[i] > shortest) pieces.push_back({source[i] - numbers.first_fracture, length[i]});
    std::ranges::stable_sort(pieces, std::ranges::greater(), &LoosePiece::length);
    return pieces;
}

/// A piece below it is no block of its own (m2).
double least_area(const GeometrySpec& spec) {
    constexpr double rounding_area = 1e-12; // of the domain
    constexpr double crumb = 1e-8;          // of the domain: what lies between traces that meet in one point on a map
    const double domain_area = std::abs(signed_area(spec.domain));
    if (lattice_spacing(spec) == 0.0) return crumb * domain_area;
    return std::max(rounding_area * domain_area,
                    minimum_area_share(spec) * std::min(mean_cell_area(spec), domain_area));
}

/// A face that is narrower is no block of its own (m).
double least_width(const GeometrySpec& spec, const LocalFrame& frame) {
    constexpr double hair = 1e-6; // of the diagonal: what lies between two traces of one joint
    if (has_triangles(spec))
        return resolution(spec, frame); // a strip would be filled with triangles as narrow as it is
    return hair * frame.box.upper.norm();
}

constexpr double loose_share = 0.01; ///< of the domain: what may be taken off its free sides

MendLimits mend_limits(const GeometrySpec& spec, const LocalFrame& frame, const SourceNumbers& numbers) {
    MendLimits limits;
    limits.area = least_area(spec);
    limits.edge = resolution(spec, frame);
    constexpr double crumb_length = 4.0; // over the root of its area: its sides cross at 7 degrees
    if (lattice_spacing(spec) == 0.0) limits.crumb = crumb_length * std::sqrt(limits.area);
    limits.width = least_width(spec, frame);
    limits.rounding = 4.0 * std::numeric_limits<double>::epsilon() * frame.box.upper.norm();
    limits.first_fracture = numbers.first_fracture;
    limits.tessellation = numbers.tessellation;
    for (const int boundary : boundary_of_sides(spec)) limits.is_free.push_back(static_cast<char>(boundary < 0));
    limits.loose_perimeter = 2.0 * lattice_spacing(spec);
    limits.loose_area = loose_share * std::abs(signed_area(spec.domain));
    return limits;
}

void check_faces(PlanarMap& map, const LocalFrame& frame) {
    for (int f = 0; f < map.n_faces(); ++f) {
        if (map.half_edges_of(f).empty() || face_is_simple(map, f)) continue;
        const Vec2 at = frame.origin + map.positions[map.start(map.faces[f].front())];
        throw InputError(fmt::format("geometry: the block at ({:.17g}, {:.17g}) folds over itself in double precision; "
                                     "move the fractures or the net there a little, or give a reference spacing",
                                     at.x(), at.y()));
    }
}

int material_at(const GeometrySpec& spec, const Vec2& scene_point) {
    int material = spec.material;
    for (const MaterialRegion& region : spec.regions) {
        if (contains(region.polygon, scene_point)) material = region.material;
    }
    return material;
}

/// A block before it has its number: its loops as half-edges, the outline first.
struct Draft {
    std::vector<std::vector<int>> loops;
    Block block;
};

/// The order of the blocks: by rows of centroids upwards, in a row to the right.
void sort_by_place(std::vector<Draft>& drafts, double tolerance) {
    const auto place = [tolerance](const Draft& draft) {
        return std::tuple(std::round(draft.block.centroid.y() / tolerance), draft.block.centroid.x(),
                          draft.block.centroid.y());
    };
    std::stable_sort(drafts.begin(), drafts.end(),
                     [&place](const Draft& a, const Draft& b) { return place(a) < place(b); });
}

class SystemBuilder {
public:
    SystemBuilder(const GeometrySpec& spec, const LocalFrame& frame, const SourceNumbers& numbers, PlanarMap& map)
        : spec_(spec), frame_(frame), numbers_(numbers), map_(map), boundary_of_side_(boundary_of_sides(spec)) {}

    BlockSystem build() {
        std::vector<Draft> drafts = draft_blocks();
        sort_by_place(drafts, 1e-9 * frame_.box.upper.norm());
        number_vertices(drafts);
        system_.origin = frame_.origin;
        system_.lower = frame_.box.lower;
        system_.upper = frame_.box.upper;
        for (const BoundarySides& named : spec_.boundaries) system_.boundaries.push_back({named.name, {}});
        system_.blocks.reserve(drafts.size());
        for (Draft& draft : drafts) add_block(draft);
        join_interfaces();
        system_.vertices.shrink_to_fit();
        system_.interfaces.shrink_to_fit();
        system_.spacing = lattice_spacing(spec_);
        if (system_.spacing == 0.0) system_.spacing = std::sqrt(area_of(system_) / system_.n_blocks());
        return std::move(system_);
    }

private:
    std::vector<Draft> draft_blocks() {
        std::vector<Draft> drafts;
        for (int f = 0; f < map_.n_faces(); ++f) {
            if (map_.half_edges_of(f).empty()) continue;
            Draft draft;
            draft.loops = map_.loops(f);
            std::stable_partition(draft.loops.begin(), draft.loops.end(),
                                  [this](const auto& loop) { return map_.loop_area(loop) > 0.0; });
            for (auto& loop : draft.loops) start_at_lower_left(loop);
            for (const auto& loop : draft.loops) {
                for (const int h : loop) draft.block.edges.push_back({.start = map_.start(h), .end = map_.end(h)});
            }
            compute_block_moments(map_.positions, draft.block);
            drafts.push_back(std::move(draft));
        }
        return drafts;
    }

    void start_at_lower_left(std::vector<int>& loop) const {
        const auto place = [this](int h) {
            const Vec2& p = map_.positions[map_.start(h)];
            return std::pair(p.y(), p.x());
        };
        std::rotate(loop.begin(),
                    std::min_element(loop.begin(), loop.end(), [&](int a, int b) { return place(a) < place(b); }),
                    loop.end());
    }

    void number_vertices(const std::vector<Draft>& drafts) {
        number_of_vertex_.assign(map_.positions.size(), -1);
        for (const Draft& draft : drafts) {
            for (const Edge& edge : draft.block.edges) {
                if (number_of_vertex_[edge.start] >= 0) continue;
                number_of_vertex_[edge.start] = static_cast<int>(system_.vertices.size());
                system_.vertices.push_back(map_.positions[edge.start]);
            }
        }
    }

    void add_block(Draft& draft) {
        const int number = system_.n_blocks();
        Block& block = draft.block;
        block.material = material_at(spec_, frame_.origin + block.centroid);
        int at = 0;
        for (const auto& loop : draft.loops) {
            block.loop_starts.push_back(at);
            for (const int h : loop) {
                Edge& edge = block.edges[at];
                edge.start = number_of_vertex_[edge.start];
                edge.end = number_of_vertex_[edge.end];
                const int side = map_.source(h);
                if (side < numbers_.first_fracture) edge.boundary = boundary_of_side_[side];
                if (edge.boundary >= 0) system_.boundaries[edge.boundary].edges.push_back({number, at});
                side_of_half_edge_.resize(map_.half_edges.size(), {-1, -1});
                side_of_half_edge_[h] = {number, at};
                order_.push_back(h);
                ++at;
            }
        }
        system_.blocks.push_back(std::move(block));
    }

    void join_interfaces() {
        for (const int h : order_) {
            const auto [a, edge_a] = side_of_half_edge_[h];
            const auto [b, edge_b] = side_of_half_edge_[PlanarMap::twin(h)];
            if (b < 0 || b < a) continue;
            const int source = map_.source(h);
            Interface joint{.block_a = a, .edge_a = edge_a, .block_b = b, .edge_b = edge_b};
            if (source < numbers_.tessellation) {
                joint.origin = EdgeOrigin::fracture;
                joint.fracture = source - numbers_.first_fracture;
                joint.interface_type = spec_.fractures[joint.fracture].interface_type;
            } else {
                joint.origin = EdgeOrigin::tessellation;
                joint.interface_type = spec_.tessellation->interface_type;
            }
            const int number = system_.n_interfaces();
            system_.blocks[a].edges[edge_a].interface = number;
            system_.blocks[b].edges[edge_b].interface = number;
            system_.interfaces.push_back(joint);
        }
    }

    const GeometrySpec& spec_;
    const LocalFrame& frame_;
    const SourceNumbers& numbers_;
    PlanarMap& map_;
    std::vector<int> boundary_of_side_;
    std::vector<int> number_of_vertex_;
    std::vector<std::pair<int, int>> side_of_half_edge_; ///< (block, edge); (-1, -1) outside
    std::vector<int> order_;                             ///< half-edges in the order of blocks and edges
    BlockSystem system_;
};

double interior_angle(const Vec2& arriving, const Vec2& leaving) {
    return std::numbers::pi - std::atan2(cross(arriving, leaving), arriving.dot(leaving));
}

void measure(const BlockSystem& system, CutReport& report) {
    report.smallest_area = std::numeric_limits<double>::infinity();
    report.smallest_edge = std::numeric_limits<double>::infinity();
    report.smallest_angle = 2.0 * std::numbers::pi;
    const auto along = [&system](const Edge& edge) -> Vec2 {
        return edge_end(system, edge) - edge_start(system, edge);
    };
    for (const Block& block : system.blocks) {
        report.smallest_area = std::min(report.smallest_area, block.area);
        for (std::size_t l = 0; l < block.loop_starts.size(); ++l) {
            const int first = block.loop_starts[l];
            const int last =
                l + 1 < block.loop_starts.size() ? block.loop_starts[l + 1] : static_cast<int>(block.edges.size());
            for (int i = first; i < last; ++i) {
                const int following = i + 1 < last ? i + 1 : first;
                const Vec2 arriving = along(block.edges[i]);
                report.smallest_edge = std::min(report.smallest_edge, arriving.norm());
                report.smallest_angle =
                    std::min(report.smallest_angle, interior_angle(arriving, along(block.edges[following])));
            }
        }
    }
}

} // namespace

double lattice_spacing(const GeometrySpec& spec) {
    if (!spec.tessellation) return spec.reference_spacing;
    const Tessellation& net = *spec.tessellation;
    if (net.triangles) return net.triangles->spacing;
    return net.voronoi ? net.voronoi->spacing : net.hexagons.spacing;
}

double minimum_area_share(const GeometrySpec& spec) {
    constexpr double of_cells = 0.05;
    constexpr double of_traces = 0.002; // smaller than what matters to a slope of blocks
    return spec.minimum_area.value_or(spec.tessellation ? of_cells : of_traces);
}

double mean_cell_area(const GeometrySpec& spec) {
    if (has_triangles(spec)) return triangle_area(smallest_side(*spec.tessellation->triangles));
    return hexagon_area(lattice_spacing(spec));
}

namespace {

TriangleSize side_of_triangles(const GeometrySpec& spec, const LocalFrame& frame, const SourceNumbers& numbers) {
    std::vector<SegmentGrid::Segment> fractures;
    for (const SourceTrace& trace : local_traces(spec, frame, numbers)) {
        for (std::size_t i = 0; i + 1 < trace.points.size(); ++i)
            fractures.emplace_back(trace.points[i], trace.points[i + 1]);
    }
    std::vector<SegmentGrid::Segment> openings;
    for (const Polygon& hole : spec.holes) {
        const Polygon local = frame.to_local(hole);
        for (std::size_t i = 0; i < local.size(); ++i) openings.emplace_back(local[i], local[(i + 1) % local.size()]);
    }
    const TriangleNet& net = *spec.tessellation->triangles;
    return {net, std::move(fractures), std::move(openings), frame.to_local(net.grading.region)};
}

/// Gives the edges of a graded net the spacing that it has there.
void grade(BlockSystem& system, const TriangleSize& size) {
    if (!size.is_graded()) return;
    for (Interface& interface : system.interfaces) {
        if (interface.origin != EdgeOrigin::tessellation) continue;
        const Edge& edge = system.blocks[interface.block_a].edges[interface.edge_a];
        interface.spacing = size.level_at(0.5 * (edge_start(system, edge) + edge_end(system, edge)));
    }
}

PlanarMap filled_with_triangles(const GeometrySpec& spec, const LocalFrame& frame, const SourceNumbers& numbers,
                                PlanarMap map, const std::vector<SourceSegment>& free) {
    TriangleFrame lines;
    lines.free_pieces = joined_pieces(map, free, resolution(spec, frame));
    lines.map = &map;
    if (spec.tessellation->region) lines.region = frame.to_local(*spec.tessellation->region);
    lines.tessellation = numbers.tessellation;
    lines.origin = frame.origin;
    lines.places = spec.places;
    PlanarMap filled =
        arrange(triangle_edges(*spec.tessellation->triangles, side_of_triangles(spec, frame, numbers), lines));
    take_outside_away(filled, numbers);
    return filled;
}

/// What is asked of the traces that have no interface.
class LossSearch {
public:
    LossSearch(const GeometrySpec& spec, const LocalFrame& frame, const SourceNumbers& numbers,
               const std::map<int, double>& cut_off)
        : spec_(spec), cut_off_(cut_off), domain_(frame.to_local(spec.domain)), resolution_(resolution(spec, frame)),
          rounding_(1e-12 * frame.box.upper.norm()), segments_(outline_segments(spec, frame)), numbers_(numbers) {
        for (const Polygon& hole : spec.holes) holes_.push_back(frame.to_local(hole));
        if (spec.tessellation && spec.tessellation->region) region_ = frame.to_local(*spec.tessellation->region);
        for (const FractureTrace& fracture : spec.fractures)
            for (auto& part : parts_near(frame.box, frame.to_local(fracture.points)))
                traces_.push_back({std::move(part), numbers.first_fracture + index_of(fracture)});
        add_traces(segments_, traces_);
    }

    [[nodiscard]] std::vector<LostFracture> lost(const BlockSystem& system) const {
        std::vector<char> found(spec_.fractures.size(), 0);
        for (const Interface& interface : system.interfaces)
            if (interface.origin == EdgeOrigin::fracture) found[interface.fracture] = 1;
        const SegmentGrid fractures = what_is_left(system);
        std::vector<LostFracture> lost;
        for (int f = 0; f < static_cast<int>(found.size()); ++f) {
            if (const auto loss = found[f] != 0 ? loss_in_part(f, fractures) : loss_of(f)) lost.push_back(*loss);
        }
        return lost;
    }

private:
    [[nodiscard]] int index_of(const FractureTrace& fracture) const {
        return static_cast<int>(&fracture - spec_.fractures.data());
    }

    [[nodiscard]] bool is_along(const Polygon& polygon, const Vec2& p) const {
        for (std::size_t i = 0; i < polygon.size(); ++i)
            if (distance_to_segment(p, polygon[i], polygon[(i + 1) % polygon.size()]) <= rounding_) return true;
        return false;
    }

    /// Or on its outline, or on the wall of a hole.
    [[nodiscard]] bool in_body(const Vec2& p) const {
        if (!contains(domain_, p)) return is_along(domain_, p);
        return std::none_of(holes_.begin(), holes_.end(),
                            [&](const Polygon& hole) { return contains(hole, p) && !is_along(hole, p); });
    }

    /// Places on the parts of a fracture that are in the body, an odd number to each of its segments.
    [[nodiscard]] std::vector<Vec2> places_in_body(int fracture) const {
        constexpr int per_segment = 63;
        std::vector<Vec2> places;
        for (const SourceTrace& trace : traces_) {
            if (trace.source != numbers_.first_fracture + fracture) continue;
            for (std::size_t i = 0; i + 1 < trace.points.size(); ++i) {
                for (int k = 0; k < per_segment; ++k) {
                    const Vec2 p = trace.points[i] + (k + 0.5) / per_segment * (trace.points[i + 1] - trace.points[i]);
                    if (in_body(p)) places.push_back(p);
                }
            }
        }
        return places;
    }

    /// The first source before the fracture that runs through all the places; -1 if none does.
    [[nodiscard]] int source_along(const std::vector<Vec2>& places, int fracture) const {
        const int last = numbers_.first_fracture + fracture;
        int first = -1;
        for (const Vec2& p : places) {
            int here = -1;
            for (const SourceSegment& segment : segments_) {
                if (segment.source >= last || distance_to_segment(p, segment.a, segment.b) > rounding_) continue;
                if (here < 0 || segment.source < here) here = segment.source;
            }
            if (here < 0) return -1;
            if (first < 0) first = here;
        }
        return first;
    }

    /// All fractures and the outline.
    [[nodiscard]] SegmentGrid what_is_left(const BlockSystem& system) const {
        std::vector<SegmentGrid::Segment> segments;
        for (const SourceSegment& segment : segments_)
            if (segment.source < numbers_.first_fracture) segments.emplace_back(segment.a, segment.b);
        for (const Interface& interface : system.interfaces) {
            if (interface.origin != EdgeOrigin::fracture) continue;
            const Edge& edge = system.blocks[interface.block_a].edges[interface.edge_a];
            segments.emplace_back(edge_start(system, edge), edge_end(system, edge));
        }
        return SegmentGrid(std::move(segments));
    }

    /// Other nets cut off what ends inside a block.
    [[nodiscard]] std::optional<LostFracture> loss_in_part(int fracture, const SegmentGrid& left) const {
        if (!has_triangles(spec_) || !region_.empty()) return std::nullopt;
        const double reach = 2.0 * resolution_;
        double missing = 0.0;
        for (const SourceTrace& trace : traces_) {
            if (trace.source != numbers_.first_fracture + fracture) continue;
            for (std::size_t i = 0; i + 1 < trace.points.size(); ++i) {
                const Vec2 along = trace.points[i + 1] - trace.points[i];
                const double n_pieces = std::clamp(std::ceil(along.norm() / resolution_), 1.0, 1e4);
                for (double k = 0.5; k < n_pieces; k += 1.0) {
                    const Vec2 p = trace.points[i] + k / n_pieces * along;
                    if (in_body(p) && !std::isfinite(left.distance(p, reach))) missing += along.norm() / n_pieces;
                }
            }
        }
        if (missing <= reach) return std::nullopt;
        return LostFracture{.fracture = fracture, .cause = LostFracture::Cause::in_part, .length = missing};
    }

    [[nodiscard]] std::optional<LostFracture> loss_of(int fracture) const {
        const std::vector<Vec2> places = places_in_body(fracture);
        if (places.empty()) return std::nullopt;
        LostFracture loss{.fracture = fracture};
        const Box extent = bounding_box(spec_.fractures[fracture].points);
        const int along = source_along(places, fracture);
        if (along >= 0) {
            loss.cause = LostFracture::Cause::coincides;
            if (along >= numbers_.first_fracture) loss.other = along - numbers_.first_fracture;
        } else if ((extent.upper - extent.lower).norm() < resolution_) {
            loss.cause = LostFracture::Cause::too_short;
        } else if (const auto piece = cut_off_.find(numbers_.first_fracture + fracture);
                   piece != cut_off_.end() && (piece->second < least_area(spec_) || !has_triangles(spec_))) {
            const bool is_little = lattice_spacing(spec_) > 0.0 && piece->second < least_area(spec_);
            loss.cause = is_little ? LostFracture::Cause::cuts_off_little : LostFracture::Cause::cuts_off_a_hair;
            loss.area = piece->second;
        } else if (has_triangles(spec_) && (region_.empty() || contains(region_, places[places.size() / 2]))) {
            loss.cause = LostFracture::Cause::too_near;
        }
        return loss;
    }

    const GeometrySpec& spec_;
    const std::map<int, double>& cut_off_;
    Polygon domain_;
    std::vector<Polygon> holes_;
    Polygon region_;
    double resolution_ = 0.0;
    double rounding_ = 0.0;
    std::vector<SourceSegment> segments_; ///< of the outline and of all traces
    std::vector<SourceTrace> traces_;
    const SourceNumbers& numbers_;
};

/// Sides of the outline and holes that are smaller than the triangles can follow without becoming as small.
std::vector<FineDetail> fine_details(const GeometrySpec& spec, double resolution) {
    std::vector<FineDetail> details;
    for (std::size_t i = 0; i < spec.domain.size(); ++i) {
        const Vec2& a = spec.domain[i];
        const Vec2& b = spec.domain[(i + 1) % spec.domain.size()];
        if ((b - a).norm() < resolution) details.push_back({-1, false, 0.5 * (a + b), (b - a).norm()});
    }
    for (std::size_t k = 0; k < spec.holes.size(); ++k) {
        const Polygon& hole = spec.holes[k];
        const Box box = bounding_box(hole);
        const double extent = (box.upper - box.lower).maxCoeff();
        const int number = static_cast<int>(k);
        if (extent < resolution) {
            details.push_back({number, true, 0.5 * (box.lower + box.upper), extent});
            continue;
        }
        for (std::size_t i = 0; i < hole.size(); ++i) {
            const Vec2& a = hole[i];
            const Vec2& b = hole[(i + 1) % hole.size()];
            if ((b - a).norm() < resolution) details.push_back({number, false, 0.5 * (a + b), (b - a).norm()});
        }
    }
    return details;
}

CutBody cut(const GeometrySpec& spec, ExactCells exact) {
    check_spec(spec);
    const SourceNumbers numbers = number_sources(spec);
    const LocalFrame frame = local_frame(spec.domain);

    CutBody body;
    const Cuts cuts = cuts_of(spec, frame, numbers, exact);
    body.report.joined_ends = cuts.joined_ends;
    PlanarMap map = arrange(cuts.segments);
    insert_whole_cells(map, cuts.whole, numbers.tessellation);
    take_outside_away(map, numbers);
    std::vector<SourceSegment> free = has_triangles(spec) ? free_pieces(map) : std::vector<SourceSegment>{};
    body.report.pruned = pruned_pieces(map, numbers, 2.0 * resolution(spec, frame));
    map.remove_edges_inside_faces();

    MendReport mended = mend(map, mend_limits(spec, frame, numbers));
    check_faces(map, frame);
    if (has_triangles(spec)) {
        free.insert(free.end(), mended.freed.begin(), mended.freed.end());
        map = filled_with_triangles(spec, frame, numbers, std::move(map), free);
        body.report.pruned = pruned_pieces(map, numbers, 2.0 * resolution(spec, frame));
        map.remove_edges_inside_faces();
    }
    body.report.collapsed_edges = mended.collapsed_edges;
    for (const auto& piece : mended.merged)
        body.report.merged.push_back({frame.origin + piece.at, piece.area,
                                      std::max(-1, piece.source - numbers.first_fracture), piece.length,
                                      piece.at_outline});
    for (const auto& piece : mended.taken_off)
        body.report.taken_off.push_back({frame.origin + piece.at, piece.area, -1, piece.length, true, piece.width});

    body.system = SystemBuilder(spec, frame, numbers, map).build();
    if (has_triangles(spec)) grade(body.system, side_of_triangles(spec, frame, numbers));
    body.report.lost = LossSearch(spec, frame, numbers, mended.cut_off).lost(body.system);
    body.report.resolution = resolution(spec, frame);
    body.report.minimum_area = least_area(spec);
    body.report.minimum_width = least_width(spec, frame);
    if (has_triangles(spec)) body.report.fine_details = fine_details(spec, body.report.resolution);
    form_sets(spec, body.system);
    return body;
}

CutBody body_of(const GeometrySpec& spec, ExactCells exact) {
    CutBody body = spec.blocks.empty() ? cut(spec, exact) : assemble_blocks(spec);
    measure(body.system, body.report);
    return_freed_memory(); // a multiple of what the body needs, which the run would otherwise not get
    return body;
}

} // namespace

CutBody cut_blocks(const GeometrySpec& spec) { return body_of(spec, ExactCells::where_needed); }

CutBody cut_blocks_exactly(const GeometrySpec& spec) { return body_of(spec, ExactCells::all); }

} // namespace kluft
