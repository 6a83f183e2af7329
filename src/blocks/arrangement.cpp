#include "kluft/blocks/arrangement.hpp"

#include <algorithm>

// With sanitizers the compiler takes an unused empty line of the kernel's for an uninitialised one.
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wmaybe-uninitialized"
#include <CGAL/Arr_curve_data_traits_2.h>
#include <CGAL/Arr_extended_dcel.h>
#include <CGAL/Arr_segment_traits_2.h>
#include <CGAL/Arrangement_2.h>
#include <CGAL/Exact_predicates_exact_constructions_kernel.h>
#pragma GCC diagnostic pop

namespace kluft {

namespace {

using Kernel = CGAL::Exact_predicates_exact_constructions_kernel;
using SegmentTraits = CGAL::Arr_segment_traits_2<Kernel>;

struct SmallerSource {
    int operator()(int a, int b) const { return std::min(a, b); }
};

using Traits = CGAL::Arr_curve_data_traits_2<SegmentTraits, int, SmallerSource>;
using Arrangement = CGAL::Arrangement_2<Traits, CGAL::Arr_extended_dcel<Traits, int, int, int>>;

Arrangement exact_arrangement(const std::vector<SourceSegment>& segments) {
    std::vector<Traits::Curve_2> curves;
    curves.reserve(segments.size());
    for (const SourceSegment& segment : segments) {
        if (segment.a == segment.b) continue;
        const SegmentTraits::Curve_2 line(Kernel::Point_2(segment.a.x(), segment.a.y()),
                                          Kernel::Point_2(segment.b.x(), segment.b.y()));
        curves.emplace_back(line, segment.source);
    }
    Arrangement arrangement;
    CGAL::insert(arrangement, curves.begin(), curves.end());
    return arrangement;
}

/// The double next to an exact coordinate. (The kernel's own conversion is content with five digits.)
double rounded(const Kernel::FT& x) {
    const auto& bounds = x.approx();
    if (bounds.is_point()) return bounds.inf();
    return CGAL::to_double(x.exact());
}

int number_faces(Arrangement& arrangement) {
    arrangement.unbounded_face()->set_data(0);
    int count = 1;
    for (auto f = arrangement.faces_begin(); f != arrangement.faces_end(); ++f) {
        if (!f->is_unbounded()) f->set_data(count++);
    }
    return count;
}

} // namespace

PlanarMap arrange(const std::vector<SourceSegment>& segments) {
    Arrangement arrangement = exact_arrangement(segments);
    PlanarMap map;
    map.faces.resize(number_faces(arrangement));

    int n_half_edges = 0;
    for (auto e = arrangement.edges_begin(); e != arrangement.edges_end(); ++e) {
        Arrangement::Halfedge_handle(e)->set_data(n_half_edges);
        e->twin()->set_data(n_half_edges + 1);
        n_half_edges += 2;
        map.sources.push_back(e->curve().data());
    }
    map.alive.assign(map.sources.size(), 1);
    map.half_edges.resize(n_half_edges);
    for (auto v = arrangement.vertices_begin(); v != arrangement.vertices_end(); ++v) {
        v->set_data(static_cast<int>(map.positions.size()));
        map.positions.emplace_back(rounded(v->point().x()), rounded(v->point().y()));
        map.outgoing.push_back(v->is_isolated() ? -1 : v->incident_halfedges()->twin()->data());
    }
    for (auto h = arrangement.halfedges_begin(); h != arrangement.halfedges_end(); ++h) {
        PlanarMap::HalfEdge& to = map.half_edges[h->data()];
        to = {h->source()->data(), h->next()->data(), h->prev()->data(), h->face()->data()};
        map.faces[to.face].push_back(h->data());
    }
    return map;
}

} // namespace kluft
