// The cut against GEOS, which nodes and polygonizes in floating point with algorithms of its own.
#include <geos_c.h>

#include <cstdarg>

#include <gtest/gtest.h>

#include "blocks/cut_scenes.hpp"

namespace kluft {
namespace {

using namespace cut_scenes;

class Geos {
public:
    Geos() : context_(GEOS_init_r()) {}
    ~Geos() { GEOS_finish_r(context_); }
    Geos(const Geos&) = delete;
    Geos& operator=(const Geos&) = delete;

    struct Faces {
        std::vector<double> areas; ///< ascending
        double narrow = 0.0;       ///< area of those that are too narrow, which are not among them
    };

    /// Those inside the outline.
    Faces faces_in(const Polygon& outline, const std::vector<std::vector<Vec2>>& traces, double least_width) {
        std::vector<Vec2> ring = outline;
        ring.push_back(outline.front());
        std::vector<GEOSGeometry*> lines{line(ring)};
        for (const auto& trace : traces) lines.push_back(line(trace));
        GEOSGeometry* all = GEOSGeom_createCollection_r(context_, GEOS_MULTILINESTRING, lines.data(),
                                                        static_cast<unsigned>(lines.size()));
        GEOSGeometry* noded = GEOSUnaryUnion_r(context_, all);
        const GEOSGeometry* const parts[] = {noded};
        GEOSGeometry* faces = GEOSPolygonize_r(context_, parts, 1);
        Faces found;
        for (int i = 0; i < GEOSGetNumGeometries_r(context_, faces); ++i) {
            const GEOSGeometry* face = GEOSGetGeometryN_r(context_, faces, i);
            if (!contains(outline, point_in(face))) continue;
            double area = 0.0;
            double perimeter = 0.0;
            GEOSArea_r(context_, face, &area);
            GEOSLength_r(context_, face, &perimeter);
            if (2.0 * area < least_width * perimeter)
                found.narrow += area;
            else
                found.areas.push_back(area);
        }
        for (GEOSGeometry* geometry : {all, noded, faces}) GEOSGeom_destroy_r(context_, geometry);
        std::sort(found.areas.begin(), found.areas.end());
        return found;
    }

private:
    GEOSGeometry* line(const std::vector<Vec2>& points) {
        GEOSCoordSequence* sequence = GEOSCoordSeq_create_r(context_, static_cast<unsigned>(points.size()), 2);
        for (unsigned i = 0; i < points.size(); ++i) {
            GEOSCoordSeq_setXY_r(context_, sequence, i, points[i].x(), points[i].y());
        }
        return GEOSGeom_createLineString_r(context_, sequence);
    }

    Vec2 point_in(const GEOSGeometry* face) {
        GEOSGeometry* point = GEOSPointOnSurface_r(context_, face);
        Vec2 at;
        GEOSGeomGetX_r(context_, point, &at.x());
        GEOSGeomGetY_r(context_, point, &at.y());
        GEOSGeom_destroy_r(context_, point);
        return at;
    }

    GEOSContextHandle_t context_;
};

std::vector<std::vector<Vec2>> points_of(const GeometrySpec& spec) {
    std::vector<std::vector<Vec2>> traces;
    for (const FractureTrace& trace : spec.fractures) traces.push_back(trace.points);
    return traces;
}

void expect_same_faces(const GeometrySpec& spec) {
    Geos geos;
    const CutBody body = cut_blocks(spec);
    EXPECT_EQ(faults(spec, body), "");
    // Where a crumb's sides have collapsed, corners are elsewhere by at most that (limits.crumb).
    const double moved = body.report.collapsed_edges > 0 ? 4.0 * std::sqrt(body.report.minimum_area) : 0.0;
    std::vector<std::pair<double, double>> blocks; // area and perimeter
    for (const Block& block : body.system.blocks) {
        double perimeter = 0.0;
        for (const Edge& edge : block.edges)
            perimeter += (edge_end(body.system, edge) - edge_start(body.system, edge)).norm();
        blocks.emplace_back(block.area, perimeter);
    }
    std::ranges::sort(blocks);
    Geos::Faces expected = geos.faces_in(spec.domain, points_of(spec), body.report.minimum_width);
    double merged = expected.narrow; // with neighbours, as are crumbs
    std::erase_if(expected.areas, [&](double area) {
        const bool is_crumb = area < body.report.minimum_area;
        if (is_crumb) merged += area;
        return is_crumb;
    });
    ASSERT_EQ(blocks.size(), expected.areas.size());
    for (std::size_t i = 0; i < blocks.size(); ++i)
        EXPECT_NEAR(blocks[i].first, expected.areas[i], 1e-9 + merged + moved * blocks[i].second) << i;
}

class AgainstPolygonizer : public testing::TestWithParam<int> {};

TEST_P(AgainstPolygonizer, StraightTracesGiveTheSameBlocks) {
    Uniform uniform(GetParam());
    GeometrySpec spec = rectangle(1, 1);
    add_random_traces(spec, 10 + 10 * GetParam(), 1, 1, uniform);
    expect_same_faces(spec);
}

// Bent traces, short against the body: many end freely, some close loops, and blocks have holes.
TEST_P(AgainstPolygonizer, BentTracesGiveTheSameBlocks) {
    Uniform uniform(500 + GetParam());
    GeometrySpec spec = rectangle(1, 1);
    spec.domain = {{0, 0}, {1, 0.1}, {0.9, 0.6}, {1.1, 1}, {0.4, 0.8}, {0.1, 1.2}};
    for (int i = 0; i < 60; ++i) {
        std::vector<Vec2> points{{uniform(), uniform()}};
        for (int k = 0; k < 6; ++k) points.push_back(points.back() + Vec2(uniform(-0.2, 0.2), uniform(-0.2, 0.2)));
        if (i % 4 == 0) points.push_back(points.front());
        add_trace(spec, points);
    }
    spec.boundaries.clear();
    expect_same_faces(spec);
}

// Hexagon edges given as traces, so that nothing but rounding is mended, and fractures through them.
TEST_P(AgainstPolygonizer, HexagonsAndTracesGiveTheSameBlocks) {
    Uniform uniform(900 + GetParam());
    GeometrySpec spec = rectangle(1, 1);
    const HexagonLattice lattice{.spacing = 0.13, .rotation = uniform(), .offset = {uniform(), uniform()}};
    for (const auto& [a, b] : hexagon_edges(lattice, {Vec2(0, 0), Vec2(1, 1)}, [](const Vec2&) { return true; })) {
        add_trace(spec, {a, b});
    }
    add_random_traces(spec, 6, 1, 1, uniform);
    expect_same_faces(spec);
}

INSTANTIATE_TEST_SUITE_P(Seeds, AgainstPolygonizer, testing::Range(0, 12));

} // namespace
} // namespace kluft
