#include "kluft/blocks/free_pieces.hpp"

#include <algorithm>
#include <functional>
#include <map>
#include <utility>

#include "kluft/geometry/polygon.hpp"
#include "kluft/geometry/predicates.hpp"
#include "kluft/geometry/segment_grid.hpp"

namespace kluft {

namespace {

using Place = std::pair<double, double>;

Place key_of(const Vec2& p) { return {p.x(), p.y()}; }

/// Where places are moved to.
class Moves {
public:
    void add(const Vec2& from, const Vec2& to) {
        if (from != to) to_.emplace(key_of(from), to);
    }

    [[nodiscard]] Vec2 of(const Vec2& place) const {
        const auto found = to_.find(key_of(place));
        return found == to_.end() ? place : of(found->second);
    }

private:
    std::map<Place, Vec2> to_;
};

/// Each living edge of a map by its half-edge, as a segment that can be found by place.
struct EdgeSearch {
    std::vector<int> half_edges;
    std::vector<SegmentGrid::Segment> segments;
};

EdgeSearch living_edges(const PlanarMap& map) {
    EdgeSearch search;
    for (int h = 0; h < 2 * map.n_edges(); h += 2) {
        if (map.alive[PlanarMap::edge_of(h)] == 0) continue;
        search.half_edges.push_back(h);
        search.segments.emplace_back(map.positions[map.start(h)], map.positions[map.end(h)]);
    }
    return search;
}

/// The half-edge from the same start that leads to `place`: an edge that was cut keeps its number up to the first cut.
int part_at(const PlanarMap& map, int h, const Vec2& place) {
    const auto beyond = [&](int part) {
        const Vec2& a = map.positions[map.start(part)];
        const Vec2& b = map.positions[map.end(part)];
        return (place - b).dot(b - a) > 0.0;
    };
    while (beyond(h) && map.source(map.next(h)) == map.source(h) && map.degree(map.end(h), 3) == 2) h = map.next(h);
    return h;
}

/// Whether two lines are farther apart than `reach`, but for an end that they share, where they enclose an angle.
bool are_clear(const SegmentGrid::Segment& first, const SegmentGrid::Segment& second, double reach) {
    constexpr double cosine_of_sharp = 0.97; // 14 degrees
    const auto [a, b] = first;
    const auto [c, d] = second;
    const bool from_a = a == c || a == d;
    if (!from_a && b != c && b != d) {
        return !segments_meet(a, b, c, d) &&
               std::min({distance_to_segment(a, c, d), distance_to_segment(b, c, d), distance_to_segment(c, a, b),
                         distance_to_segment(d, a, b)}) >= reach;
    }
    const Vec2& shared = from_a ? a : b;
    const Vec2 one = (from_a ? b : a) - shared;
    const Vec2 other = (shared == c ? d : c) - shared;
    return one.dot(other) < cosine_of_sharp * one.norm() * other.norm();
}

/// The pieces, longest first, that are clear of the map and of those before.
std::vector<SourceSegment> clear_pieces(const PlanarMap& map, std::vector<SourceSegment> pieces, double reach) {
    std::ranges::stable_sort(pieces, std::greater(),
                             [](const SourceSegment& piece) { return (piece.b - piece.a).squaredNorm(); });
    std::vector<SegmentGrid::Segment> lines = living_edges(map).segments;
    const std::size_t n_edges = lines.size();
    for (const SourceSegment& piece : pieces) lines.emplace_back(piece.a, piece.b);
    const SegmentGrid grid(lines);
    std::vector<char> kept(lines.size(), 0);
    std::fill_n(kept.begin(), n_edges, 1);
    std::vector<SourceSegment> clear;
    for (std::size_t i = n_edges; i < lines.size(); ++i) {
        Box around = bounding_box({lines[i].first, lines[i].second});
        around.lower -= Vec2::Constant(reach);
        around.upper += Vec2::Constant(reach);
        const std::vector<int> near = grid.near(around);
        const bool is_clear = std::ranges::all_of(
            near, [&](int other) { return kept[other] == 0 || are_clear(lines[i], lines[other], reach); });
        if (!is_clear) continue;
        kept[i] = 1;
        clear.push_back(pieces[i - n_edges]);
    }
    return clear;
}

} // namespace

std::vector<SourceSegment> free_pieces(const PlanarMap& map) {
    std::vector<SourceSegment> pieces;
    for (int h = 0; h < 2 * map.n_edges(); h += 2) {
        const bool free = map.alive[PlanarMap::edge_of(h)] != 0 && map.face(h) == map.face(h + 1) &&
                          map.face(h) != PlanarMap::outside;
        if (free) pieces.push_back({map.positions[map.start(h)], map.positions[map.end(h)], map.source(h)});
    }
    return pieces;
}

std::vector<SourceSegment> joined_pieces(PlanarMap& map, const std::vector<SourceSegment>& pieces, double reach) {
    const EdgeSearch search = living_edges(map);
    const SegmentGrid grid(search.segments);
    Moves moves;
    std::vector<Vec2> added;    // vertices
    std::map<Place, int> worth; // of ends: how many pieces they join; those on the map stay there
    constexpr int worth_of_vertex = 1 << 20;
    const auto join = [&](const Vec2& end) {
        const Vec2 around = Vec2::Constant(reach);
        double nearest_vertex = reach;
        double nearest_edge = reach;
        Vec2 to = end;
        int edge = -1;
        for (const int i : grid.near({end - around, end + around})) {
            const auto& [a, b] = search.segments[i];
            for (const Vec2& vertex : {a, b}) {
                const double away = (vertex - end).norm();
                if (away < nearest_vertex) std::tie(nearest_vertex, to) = std::pair(away, vertex);
            }
            const double away = distance_to_segment(end, a, b);
            if (away < nearest_edge) std::tie(nearest_edge, edge) = std::pair(away, search.half_edges[i]);
        }
        for (const Vec2& vertex : added) {
            const double away = (vertex - end).norm();
            if (away < nearest_vertex) std::tie(nearest_vertex, to) = std::pair(away, vertex);
        }
        if (nearest_vertex < reach) {
            moves.add(end, to);
            worth[key_of(to)] += worth_of_vertex;
        } else if (edge >= 0) {
            const int part = part_at(map, edge, end);
            const Vec2 on_edge = nearest_point(end, map.positions[map.start(part)], map.positions[map.end(part)]);
            map.split_edge(part, on_edge);
            moves.add(end, on_edge);
            added.push_back(on_edge);
            worth[key_of(on_edge)] += worth_of_vertex;
        }
    };
    std::map<Place, bool> seen;
    for (const SourceSegment& piece : pieces) {
        for (const Vec2& end : {piece.a, piece.b})
            if (seen.emplace(key_of(end), true).second) join(end);
    }
    for (const SourceSegment& piece : pieces)
        for (const Vec2& end : {piece.a, piece.b}) ++worth[key_of(moves.of(end))];
    const auto shrink = [&](const Vec2& a, const Vec2& b) {
        const bool keeps_a = worth[key_of(a)] >= worth[key_of(b)];
        const Vec2& kept = keeps_a ? a : b;
        const Vec2& lost = keeps_a ? b : a;
        moves.add(lost, kept);
        worth[key_of(kept)] += worth[key_of(lost)];
    };
    std::vector<SourceSegment> joined;
    for (const SourceSegment& piece : pieces) {
        const Vec2 a = moves.of(piece.a);
        const Vec2 b = moves.of(piece.b);
        if (a == b) continue;
        if ((b - a).norm() < reach) {
            shrink(a, b);
        } else {
            joined.push_back({a, b, piece.source});
        }
    }
    for (SourceSegment& piece : joined) {
        piece.a = moves.of(piece.a);
        piece.b = moves.of(piece.b);
    }
    return clear_pieces(map, std::move(joined), reach);
}

} // namespace kluft
