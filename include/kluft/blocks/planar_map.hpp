// A subdivision of the plane into faces, as half-edges, with the edits that mend it.
#pragma once

#include <vector>

#include "kluft/core/vector.hpp"

namespace kluft {

/// Half-edges 2e and 2e + 1 are the two directions of edge e; the face of a half-edge lies to its left. Faces are
/// numbered from 0; `outside` is everything beyond the domain. Each cycle of `next` is a loop of its face: one runs
/// counter-clockwise round it, the others clockwise round its holes.
/// Invariants: next and previous are inverse; a half-edge and its next have the same face; faces[f] lists every
/// half-edge of f that is alive (and may list dead ones).
class PlanarMap {
public:
    static constexpr int outside = -1;

    struct HalfEdge {
        int start = 0;
        int next = 0;
        int previous = 0;
        int face = outside;
    };

    std::vector<Vec2> positions;         ///< of the vertices, size n_vertices (m)
    std::vector<int> outgoing;           ///< a half-edge that starts at the vertex; -1 without any
    std::vector<HalfEdge> half_edges;    ///< size 2 n_edges
    std::vector<int> sources;            ///< what each edge lies on, size n_edges; the cutter gives the meaning
    std::vector<char> alive;             ///< size n_edges
    std::vector<std::vector<int>> faces; ///< half-edges of each face, size n_faces; empty for a face merged away

    static int twin(int h) { return h ^ 1; }
    static int edge_of(int h) { return h >> 1; }
    [[nodiscard]] int n_edges() const { return static_cast<int>(alive.size()); }
    [[nodiscard]] int n_faces() const { return static_cast<int>(faces.size()); }
    [[nodiscard]] int start(int h) const { return half_edges[h].start; }
    [[nodiscard]] int end(int h) const { return half_edges[twin(h)].start; }
    [[nodiscard]] int next(int h) const { return half_edges[h].next; }
    [[nodiscard]] int previous(int h) const { return half_edges[h].previous; }
    [[nodiscard]] int face(int h) const { return half_edges[h].face; }
    [[nodiscard]] int source(int h) const { return sources[edge_of(h)]; }
    [[nodiscard]] double length(int h) const { return (positions[end(h)] - positions[start(h)]).norm(); }

    /// The half-edges that start at v, clockwise. Of the corners of one vertex the edges form one cycle.
    [[nodiscard]] std::vector<int> star(int v) const;

    /// The living half-edges of a face; drops the dead ones from its list.
    const std::vector<int>& half_edges_of(int f);

    /// Loops of a face, each without a repeated vertex: a cycle that passes a vertex twice is split there. Half-edges
    /// in order. The loop that encloses the face has a positive area, those of its holes a negative one.
    [[nodiscard]] std::vector<std::vector<int>> loops(int f);

    [[nodiscard]] double area(int f);
    [[nodiscard]] double loop_area(const std::vector<int>& loop) const;

    /// Removes edges that have the same face on both sides, which leaves the faces as point sets unchanged (but for
    /// the edges themselves).
    void remove_edges_inside_faces();

    /// Gives what is `lost` to `kept` and removes every edge between them.
    void merge_faces(int kept, int lost);

    /// Gives a face to `outside`: its edges towards that disappear, its others get `source`.
    void take_away(int f, int source);

    /// Makes the two edges at a vertex of degree 2 one; the edge of `outgoing[v]` disappears. Both loops must keep at
    /// least three edges. Returns the half-edge that remains and ended at v.
    int dissolve_vertex(int v);

    /// Puts a vertex into the edge of h, which is then the part up to it. Returns the vertex.
    int split_edge(int h, const Vec2& at);

    /// Moves the end of h to its start and removes h's edge. Both loops must keep at least three edges, and no other
    /// edge may join the two vertices. Returns the vertex that remains: the start of h.
    int contract_edge(int h);

    /// Number of edges in the cycle of h, counted up to `limit`.
    [[nodiscard]] int cycle_length(int h, int limit) const;

    [[nodiscard]] int degree(int v, int limit) const;

private:
    void link(int h, int following);
    void remove_edge(int e);
};

} // namespace kluft
