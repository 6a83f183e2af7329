// Mends what an exact cut leaves behind: slivers, short edges, needless vertices.
#pragma once

#include <map>
#include <vector>

#include "kluft/blocks/arrangement.hpp"
#include "kluft/blocks/planar_map.hpp"

namespace kluft {

/// What counts as too small, and the meaning of the map's sources: those below `first_fracture` lie on the domain's
/// outline, those from `tessellation` on are hexagon edges.
struct MendLimits {
    double area = 0.0;     ///< smallest face (m2)
    double width = 0.0;    ///< smallest width of a face, twice its area over its perimeter (m)
    double edge = 0.0;     ///< smallest edge (m)
    double crumb = 0.0;    ///< longest edge of a face below `area` that is a point where fractures meet (m)
    double rounding = 0.0; ///< distance below which positions differ by rounding only (m)
    int first_fracture = 0;
    int tessellation = 0;
    std::vector<char> is_free;    ///< of each side of the outline, whether no boundary names it; none is where empty
    double loose_perimeter = 0.0; ///< of the largest piece that may be taken off a free side (m)
    double loose_area = 0.0;      ///< of all pieces together that may be taken off (m2)
};

struct MendReport {
    struct Merged {
        Vec2 at = Vec2::Zero(); ///< centroid (m)
        double area = 0.0;      ///< m2
        int source = -1; ///< of the fracture that lost the longest piece, the one between the two faces; -1 without one
        double length = 0.0;     ///< of that piece (m)
        bool at_outline = false; ///< that piece ends at the outline
        double width = 0.0;      ///< of what was taken off, twice its area over its perimeter (m)
    };
    std::vector<Merged> merged;
    std::vector<Merged> taken_off;    ///< with the outline's piece; no source
    std::map<int, double> cut_off;    ///< of fractures, by their source, the largest merged face that they cut off (m2)
    std::vector<SourceSegment> freed; ///< sides of merged faces that went with the side across which these were merged
    int collapsed_edges = 0;
};

/// Until nothing changes any more:
/// 1. each face below `limits.area` or `limits.width`, smallest first, is merged with the neighbour across its longest tessellation edge,
///    otherwise across its longest interior edge of a fracture that does not go on beyond the face, otherwise of one that does; all edges between the two disappear. A face that is merged away
///    has one side less: the edges that go on from that edge up to a sharp turn, or two turns within 2 `limits.edge`.
///    Where its other sides lie in the same neighbour they separate nothing any more, and are `freed`.
///    A small piece at a free side of the outline all of whose fractures go on beyond it would lock one of them: it is taken off;
///    What is left of the sides of a face below `limits.area` inside the body that has none longer than `limits.crumb` is collapsed in 2: a tooth
///    in the neighbour, however small, would lock what slides past it;
/// 2. each edge below `limits.edge`, shortest first, is collapsed to the end that is worth more (corner of the domain,
///    then its outline, then more fracture edges), otherwise to the other, if every face around stays simple and positively oriented, the
///    outline keeps its shape and corners, and no two vertices get joined twice;
/// 3. vertices where two edges with one source go straight on, within `limits.rounding`, are removed;
/// 4. faces that rounding left not simple are merged as in 1, but across an edge that is in the way of another.
/// Expects no edge with the same face on both sides, and leaves none.
[[nodiscard]] MendReport mend(PlanarMap& map, const MendLimits& limits);

/// Whether the loops of a face are simple, exactly one of them is positive, and they meet at most in common vertices.
[[nodiscard]] bool face_is_simple(PlanarMap& map, int face);

} // namespace kluft
