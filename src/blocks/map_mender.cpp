#include "kluft/blocks/map_mender.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <numeric>
#include <optional>
#include <queue>
#include <tuple>
#include <unordered_set>
#include <utility>

#include "kluft/geometry/polygon.hpp"
#include "kluft/geometry/predicates.hpp"
#include "kluft/geometry/segment_grid.hpp"

namespace kluft {

namespace {

constexpr int outside = PlanarMap::outside;

// What a vertex is worth when an edge collapses: one for each fracture edge at it, and
constexpr int worth_of_outline = 1 << 10;
constexpr int worth_of_corner = 1 << 20;

/// An edge as two vertices and where they are.
struct Segment {
    int a = 0;
    int b = 0;
    Vec2 start;
    Vec2 end;
};

/// Whether edges that share no more than vertices have more than these in common.
bool in_conflict(const Segment& first, const Segment& second) {
    const bool a_shared = first.a == second.a || first.a == second.b;
    const bool b_shared = first.b == second.a || first.b == second.b;
    if (a_shared && b_shared) return true;
    if (!a_shared && !b_shared) return segments_meet(first.start, first.end, second.start, second.end);
    const Vec2& common = a_shared ? first.start : first.end;
    const Vec2& tip = a_shared ? first.end : first.start;
    const bool starts_there = second.a == (a_shared ? first.a : first.b);
    const Vec2& other_tip = starts_there ? second.end : second.start;
    return orientation(common, tip, other_tip) == 0 && (tip - common).dot(other_tip - common) >= 0.0;
}

/// For each segment, indices of all others that may meet it.
class Candidates {
public:
    explicit Candidates(const std::vector<Segment>& segments) {
        constexpr std::size_t few = 64; // below which asking all costs less than a grid
        if (segments.size() <= few) {
            all_.resize(segments.size());
            std::iota(all_.begin(), all_.end(), 0);
            return;
        }
        std::vector<SegmentGrid::Segment> pairs;
        for (const Segment& segment : segments) pairs.emplace_back(segment.start, segment.end);
        grid_.emplace(std::move(pairs));
    }

    [[nodiscard]] std::vector<int> of(const Segment& segment) {
        return grid_ ? grid_->near(bounding_box({segment.start, segment.end}), asked_) : all_;
    }

private:
    std::vector<int> all_;
    std::optional<SegmentGrid> grid_;
    std::vector<char> asked_; // marks of the grid's
};

/// Half-edges of a face that have more than a vertex in common with another one of it, or no length.
std::vector<int> conflicting_half_edges(PlanarMap& map, int face) {
    const std::vector<int>& list = map.half_edges_of(face);
    std::vector<Segment> segments;
    for (const int h : list) {
        segments.push_back({map.start(h), map.end(h), map.positions[map.start(h)], map.positions[map.end(h)]});
    }
    Candidates candidates(segments);
    std::vector<int> found;
    for (int i = 0; i < static_cast<int>(list.size()); ++i) {
        const Segment& segment = segments[i];
        const std::vector<int> others = candidates.of(segment);
        const bool conflict = segment.start == segment.end || std::any_of(others.begin(), others.end(), [&](int j) {
                                  return j != i && in_conflict(segment, segments[j]);
                              });
        if (conflict) found.push_back(list[i]);
    }
    return found;
}

Vec2 face_centroid(PlanarMap& map, int face) {
    const std::vector<int>& list = map.half_edges_of(face);
    const Vec2 from = map.positions[map.start(list.front())];
    Vec2 moment = Vec2::Zero();
    Vec2 mean = Vec2::Zero();
    double twice = 0.0;
    for (const int h : list) {
        const Vec2 a = map.positions[map.start(h)] - from;
        const Vec2 b = map.positions[map.end(h)] - from;
        twice += cross(a, b);
        moment += cross(a, b) * (a + b);
        mean += a;
    }
    mean /= static_cast<double>(list.size());
    const Vec2 centroid = moment / (3.0 * twice);
    const bool degenerate = !centroid.allFinite() || twice <= 0.0;
    return from + (degenerate ? mean : centroid);
}

class Mender {
public:
    Mender(PlanarMap& map, const MendLimits& limits) : map_(map), limits_(limits) {}

    MendReport run() {
        straighten();
        bool changed = true;
        while (changed) {
            changed = merge_slivers();
            straighten();
            changed = collapse_short_edges() || changed;
            straighten();
            if (!changed) changed = merge_broken_faces();
        }
        return std::move(report_);
    }

private:
    [[nodiscard]] bool is_outline(int h) const { return map_.source(h) < limits_.first_fracture; }
    [[nodiscard]] bool is_on_outline(int v) const {
        return std::ranges::any_of(map_.star(v), [this](int h) { return is_outline(h); });
    }
    /// The source of an edge as cut: what has been taken off beside it made it one of the outline.
    [[nodiscard]] int fracture_of(int h) const {
        const auto at = laid_bare_.find(PlanarMap::edge_of(h));
        return at != laid_bare_.end() ? at->second : map_.source(h);
    }
    [[nodiscard]] bool is_tessellation(int h) const { return map_.source(h) >= limits_.tessellation; }

    void straighten() {
        for (int v = 0; v < static_cast<int>(map_.positions.size()); ++v) {
            if (goes_straight_on(v)) map_.dissolve_vertex(v);
        }
    }

    [[nodiscard]] bool goes_straight_on(int v) const {
        if (map_.degree(v, 3) != 2) return false;
        const int leaving = map_.outgoing[v];
        const int arriving = map_.previous(leaving);
        if (map_.source(leaving) != map_.source(arriving)) return false;
        if (map_.cycle_length(leaving, 4) < 4 || map_.cycle_length(map_.twin(leaving), 4) < 4) return false;
        const Vec2& a = map_.positions[map_.start(arriving)];
        const Vec2& b = map_.positions[map_.end(leaving)];
        const Vec2& p = map_.positions[v];
        return (p - a).dot(b - p) > 0.0 && distance_to_segment(p, a, b) <= limits_.rounding;
    }

    /// Whether the fracture of an edge of a face leaves the face at one of its vertices and goes on elsewhere.
    [[nodiscard]] bool goes_on_beyond(int h, const std::vector<int>& half_edges) const {
        const int face = map_.face(h);
        return std::ranges::any_of(half_edges, [&](int of_face) {
            return std::ranges::any_of(map_.star(map_.start(of_face)), [&](int k) {
                return fracture_of(k) == map_.source(h) && map_.face(k) != face && map_.face(map_.twin(k)) != face;
            });
        });
    }

    /// Of a face's half-edges, the one across which it goes into its neighbour; -1 if none of them has one. A fracture that goes through
    /// to the outline stays whole where a sliver between it and the end of another one goes.
    [[nodiscard]] int way_out(const std::vector<int>& half_edges) const {
        int best = -1;
        const auto worth = [&](int h) {
            return std::tuple(is_tessellation(h), !goes_on_beyond(h, half_edges), map_.length(h));
        };
        for (const int h : half_edges) {
            if (map_.face(map_.twin(h)) == outside) continue;
            if (best < 0 || worth(h) > worth(best)) best = h;
        }
        return best;
    }

    /// Angle to the left between an edge and the one after it in their face (radians).
    [[nodiscard]] double turn_between(int arriving, int leaving) const {
        const Vec2 before = map_.positions[map_.end(arriving)] - map_.positions[map_.start(arriving)];
        const Vec2 after = map_.positions[map_.end(leaving)] - map_.positions[map_.start(leaving)];
        return std::atan2(cross(before, after), before.dot(after));
    }

    /// What goes on from a half-edge of a face along one neighbour, in one direction, before the face's outline turns
    /// back: by more than 120 degrees within twice the shortest edge. The end of a strip, which lies between two turns,
    /// belongs to neither of its sides.
    [[nodiscard]] std::vector<int> one_way_along_side(int exit, bool forward) const {
        constexpr double turning_back = 2.1; // radians
        struct Turn {
            double arc = 0.0; // m
            double angle = 0.0;
            std::size_t n_before = 0; // half-edges of the side
        };
        std::vector<int> side{exit};
        std::vector<Turn> recent;
        double arc = 0.0;
        for (int h = exit;;) {
            const int onward = forward ? map_.next(h) : map_.previous(h);
            if (onward == exit || map_.face(map_.twin(onward)) != map_.face(map_.twin(exit))) return side;
            recent.push_back({arc, forward ? turn_between(h, onward) : turn_between(onward, h), side.size()});
            std::erase_if(recent, [&](const Turn& turn) { return turn.arc < arc - 2.0 * limits_.edge; });
            double turned = 0.0;
            for (auto turn = recent.rbegin(); turn != recent.rend(); ++turn) {
                turned += turn->angle;
                if (turned <= turning_back) continue;
                side.resize(turn->n_before);
                return side;
            }
            side.push_back(onward);
            arc += map_.length(onward);
            h = onward;
        }
    }

    /// The edges between the faces on both sides of an edge, but for those on its own side, are free from now on.
    void free_other_sides(int exit) {
        std::unordered_set<int> side;
        for (const bool forward : {true, false})
            for (const int h : one_way_along_side(exit, forward)) side.insert(PlanarMap::edge_of(h));
        const int face = map_.face(exit);
        const int neighbour = map_.face(map_.twin(exit));
        for (const int h : map_.half_edges_of(face)) {
            if (map_.face(map_.twin(h)) != neighbour || side.contains(PlanarMap::edge_of(h))) continue;
            report_.freed.push_back({map_.positions[map_.start(h)], map_.positions[map_.end(h)], map_.source(h)});
        }
    }

    /// Merges the faces on both sides of an edge and returns the face that is left.
    int merge_across(int exit) {
        free_other_sides(exit);
        int face = map_.face(exit);
        int kept = map_.face(map_.twin(exit));
        const double area = std::max(0.0, map_.area(face));
        MendReport::Merged merged{.at = face_centroid(map_, face), .area = area};
        std::map<int, MendReport::Merged> closed; // by fracture
        for (const int h : map_.half_edges_of(face)) {
            if (map_.face(map_.twin(h)) != kept || is_outline(h) || is_tessellation(h)) continue;
            double& largest = report_.cut_off[map_.source(h)];
            largest = std::max(largest, area);
            MendReport::Merged& piece = closed.emplace(map_.source(h), merged).first->second;
            piece.source = map_.source(h);
            piece.length += map_.length(h);
            piece.at_outline = piece.at_outline || is_on_outline(map_.start(h)) || is_on_outline(map_.end(h));
            if (piece.length > merged.length) merged = piece;
        }
        report_.merged.push_back(merged);
        if (map_.faces[kept].size() < map_.faces[face].size()) std::swap(kept, face);
        map_.merge_faces(kept, face);
        return kept;
    }

    double perimeter(int face) {
        double length = 0.0;
        for (const int h : map_.half_edges_of(face)) length += map_.length(h);
        return length;
    }

    /// The piece of the outline that a face ends at, if it is one, along sides that no boundary names, and the face meets the outline nowhere else.
    [[nodiscard]] std::vector<int> free_surface(int face) {
        const std::vector<int>& list = map_.half_edges_of(face);
        const auto at_surface = [&](int h) { return map_.face(map_.twin(h)) == outside; };
        const auto is_free = [&](int h) {
            const int side = map_.source(h);
            return side < static_cast<int>(limits_.is_free.size()) && limits_.is_free[side] != 0;
        };
        std::vector<int> surface;
        int n_ends = 0;
        for (const int h : list) {
            if (at_surface(h)) {
                if (!is_free(h)) return {};
                surface.push_back(h);
            } else {
                n_ends += at_surface(map_.next(h)) ? 1 : 0;
                const bool begins = at_surface(map_.previous(h));
                if (!begins && is_on_outline(map_.start(h))) return {};
            }
        }
        if (n_ends != 1) return {};
        return surface;
    }

    [[nodiscard]] double taken_area() const {
        double area = 0.0;
        for (const MendReport::Merged& piece : report_.taken_off) area += piece.area;
        return area;
    }

    /// What lies at a free surface between fractures that go on beyond it would lock what slides along one of them, whichever neighbour
    /// it went into: a small piece is taken off.
    bool take_off(int face, int exit) {
        if (is_tessellation(exit) || !goes_on_beyond(exit, map_.half_edges_of(face))) return false;
        const double area = std::max(0.0, map_.area(face));
        const double around = perimeter(face);
        if (around > limits_.loose_perimeter || taken_area() + area > limits_.loose_area) return false;
        const std::vector<int> surface = free_surface(face);
        if (surface.empty()) return false;
        MendReport::Merged piece{.at = face_centroid(map_, face), .area = area, .width = 2.0 * area / around};
        for (const int h : surface) piece.length += map_.length(h);
        report_.taken_off.push_back(piece);
        for (const int h : map_.half_edges_of(face))
            if (!is_outline(h)) laid_bare_[PlanarMap::edge_of(h)] = map_.source(h);
        map_.take_away(face, map_.source(surface.front()));
        return true;
    }

    bool is_crumb(int face) {
        return map_.area(face) < limits_.area && std::ranges::all_of(map_.half_edges_of(face), [this](int h) {
                   return !is_outline(h) && map_.length(h) <= limits_.crumb;
               });
    }

    bool merge_slivers() {
        using Entry = std::pair<double, int>;
        std::priority_queue<Entry, std::vector<Entry>, std::greater<>> slivers;
        const auto judge = [&](int face) {
            if (map_.half_edges_of(face).empty()) return;
            const double area = map_.area(face);
            if (area < limits_.area || 2.0 * area < limits_.width * perimeter(face)) slivers.emplace(area, face);
        };
        for (int f = 0; f < map_.n_faces(); ++f) judge(f);
        bool merged = false;
        while (!slivers.empty()) {
            const auto [area, face] = slivers.top();
            slivers.pop();
            if (map_.half_edges_of(face).empty() || map_.area(face) != area) continue;
            const int exit = way_out(map_.half_edges_of(face));
            if (exit < 0) continue;
            merged = true;
            if (is_crumb(face))
                for (const int h : map_.half_edges_of(face)) sides_of_crumbs_.insert(PlanarMap::edge_of(h));
            if (!take_off(face, exit)) judge(merge_across(exit));
        }
        return merged;
    }

    bool merge_broken_faces() {
        bool merged = false;
        for (int f = 0; f < map_.n_faces(); ++f) {
            const int exit = way_out(conflicting_half_edges(map_, f));
            if (exit >= 0) merge_across(exit);
            merged = merged || exit >= 0;
        }
        return merged;
    }

    [[nodiscard]] bool is_straight(int v, int before, int after) const {
        const Vec2& a = map_.positions[before];
        const Vec2& b = map_.positions[after];
        return distance_to_segment(map_.positions[v], a, b) <= limits_.rounding;
    }

    /// Corners of the domain must stay, vertices on its outline must stay on it, and a fracture should stay straight.
    [[nodiscard]] int worth(int v) const {
        int n_fracture = 0;
        int side = -1;
        int along = -1; // the vertex that the outline comes from
        bool corner = false;
        for (const int h : map_.star(v)) {
            if (is_outline(h)) {
                corner = corner || (side >= 0 && (side != map_.source(h) || !is_straight(v, along, map_.end(h))));
                side = map_.source(h);
                along = map_.end(h);
            } else if (!is_tessellation(h)) {
                ++n_fracture;
            }
        }
        return (corner ? worth_of_corner : 0) + (side >= 0 ? worth_of_outline : 0) + n_fracture;
    }

    bool collapse_short_edges() {
        using Entry = std::tuple<double, int>;
        std::priority_queue<Entry, std::vector<Entry>, std::greater<>> short_edges;
        const auto judge = [&](int e) {
            const double length = map_.length(2 * e);
            if (length < limits_.edge || (length <= limits_.crumb && sides_of_crumbs_.contains(e)))
                short_edges.emplace(length, e);
        };
        for (int e = 0; e < map_.n_edges(); ++e) {
            if (map_.alive[e] != 0) judge(e);
        }
        bool collapsed = false;
        while (!short_edges.empty()) {
            const auto [length, e] = short_edges.top();
            short_edges.pop();
            if (map_.alive[e] == 0 || map_.length(2 * e) != length) continue;
            const int kept = collapse(e);
            if (kept < 0) continue;
            collapsed = true;
            ++report_.collapsed_edges;
            for (const int h : map_.star(kept)) judge(PlanarMap::edge_of(h));
        }
        return collapsed;
    }

    /// Returns the vertex that remains, or -1 where the edge has to stay.
    int collapse(int e) {
        const int h = 2 * e;
        const int kept = worth(map_.start(h)) >= worth(map_.end(h)) ? h : h + 1; // runs from the vertex to keep
        if (can_contract(kept)) return map_.contract_edge(kept);
        if (can_contract(map_.twin(kept))) return map_.contract_edge(map_.twin(kept));
        return -1;
    }

    /// Whether the end of h may move to its start. Where that is within rounding, what the faces look like now is as
    /// much a matter of rounding as what they will look like.
    bool can_contract(int h) {
        if (map_.cycle_length(h, 4) < 4 || map_.cycle_length(map_.twin(h), 4) < 4) return false;
        const int kept = map_.start(h);
        const int lost = map_.end(h);
        const int at_stake = worth(lost);
        if (at_stake >= worth_of_corner || (at_stake >= worth_of_outline && !is_outline(h))) return false;
        return !joined_otherwise(h) && !pinches(h) && (map_.length(h) <= limits_.rounding || star_fits(kept, lost));
    }

    /// Whether a third vertex is joined to both ends of h, or a second edge joins these.
    [[nodiscard]] bool joined_otherwise(int h) const {
        std::unordered_set<int> around;
        for (const int k : map_.star(map_.start(h))) {
            if (k != h) around.insert(map_.end(k));
        }
        for (const int k : map_.star(map_.end(h))) {
            if (k == map_.twin(h)) continue;
            if (map_.end(k) == map_.start(h) || around.contains(map_.end(k))) return true;
        }
        return false;
    }

    /// Whether some face would pass the remaining vertex more than once.
    bool pinches(int h) {
        const int u = map_.start(h);
        const int v = map_.end(h);
        std::vector<int> around;
        for (const int w : {u, v}) {
            for (const int k : map_.star(w)) {
                if (map_.face(k) != outside) around.push_back(map_.face(k));
            }
        }
        std::sort(around.begin(), around.end());
        around.erase(std::unique(around.begin(), around.end()), around.end());
        return std::any_of(around.begin(), around.end(), [&](int f) {
            const auto& list = map_.half_edges_of(f);
            const auto corners = std::count_if(list.begin(), list.end(),
                                               [&](int k) { return map_.start(k) == u || map_.start(k) == v; });
            const int sides = (map_.face(h) == f ? 1 : 0) + (map_.face(map_.twin(h)) == f ? 1 : 0);
            return corners - sides != 1;
        });
    }

    /// An edge after `lost` has moved to `kept`.
    [[nodiscard]] Segment moved(int h, int kept, int lost) const {
        const int a = map_.start(h) == lost ? kept : map_.start(h);
        const int b = map_.end(h) == lost ? kept : map_.end(h);
        return {a, b, map_.positions[a], map_.positions[b]};
    }

    bool star_fits(int kept, int lost) {
        for (const int spoke : map_.star(lost)) {
            if (map_.end(spoke) == kept) continue;
            const Segment segment = moved(spoke, kept, lost);
            for (const int f : {map_.face(spoke), map_.face(map_.twin(spoke))}) {
                if (f != outside && !segment_fits(segment, spoke, f, kept, lost)) return false;
            }
            if (map_.face(spoke) != outside && !(moved_area(map_.face(spoke), kept, lost) > 0.0)) return false;
        }
        return true;
    }

    bool segment_fits(const Segment& segment, int spoke, int face, int kept, int lost) {
        for (const int h : map_.half_edges_of(face)) {
            if (PlanarMap::edge_of(h) == PlanarMap::edge_of(spoke)) continue;
            const Segment other = moved(h, kept, lost);
            if (other.a == other.b) continue;
            if (in_conflict(segment, other)) return false;
        }
        return true;
    }

    double moved_area(int face, int kept, int lost) {
        double twice = 0.0;
        const Vec2 from = map_.positions[kept];
        for (const int h : map_.half_edges_of(face)) {
            const Segment segment = moved(h, kept, lost);
            twice += cross(segment.start - from, segment.end - from);
        }
        return 0.5 * twice;
    }

    PlanarMap& map_;
    MendLimits limits_;
    MendReport report_;
    std::unordered_set<int> sides_of_crumbs_; ///< edges
    std::map<int, int>
        laid_bare_; ///< edges of fractures that are of the outline since a piece was taken off: their source before
};

} // namespace

bool face_is_simple(PlanarMap& map, int face) {
    int n_positive = 0;
    for (const auto& loop : map.loops(face)) {
        const double area = map.loop_area(loop);
        if (loop.size() < 3 || area == 0.0) return false;
        n_positive += area > 0.0 ? 1 : 0;
    }
    return n_positive == 1 && conflicting_half_edges(map, face).empty();
}

MendReport mend(PlanarMap& map, const MendLimits& limits) { return Mender(map, limits).run(); }

} // namespace kluft
