// Hexagons that nothing cuts, made without arithmetic, against the subdivision of everything.
#include "kluft/blocks/whole_cells.hpp"

#include <numbers>
#include <string>

#include <gtest/gtest.h>

#include "blocks/cut_scenes.hpp"
#include "kluft/core/diagnostics.hpp"

namespace kluft {
namespace {

using namespace cut_scenes;

/// A body of 1 m by 0.8 m with some 600 hexagons.
GeometrySpec net(HexagonLattice lattice = {}) {
    GeometrySpec spec = rectangle(1.0, 0.8);
    if (lattice.spacing == 0.0) lattice.spacing = 0.04;
    spec.tessellation = Tessellation{.hexagons = lattice};
    return spec;
}

bool same_report(const CutReport& a, const CutReport& b) {
    const auto same_piece = [](const auto& p, const auto& q) { return p.at == q.at && p.area == q.area; };
    const auto same_loss = [](const auto& p, const auto& q) {
        return p.fracture == q.fracture && p.cause == q.cause && p.other == q.other && p.length == q.length;
    };
    return std::ranges::equal(a.merged, b.merged, same_piece) && a.taken_off.size() == b.taken_off.size() &&
           std::ranges::equal(a.lost, b.lost, same_loss) && a.collapsed_edges == b.collapsed_edges &&
           a.joined_ends == b.joined_ends && a.pruned.size() == b.pruned.size() && a.resolution == b.resolution &&
           a.smallest_area == b.smallest_area && a.smallest_edge == b.smallest_edge &&
           a.smallest_angle == b.smallest_angle;
}

bool same_boundaries(const BlockSystem& a, const BlockSystem& b) {
    const auto same_edge = [](const auto& p, const auto& q) { return p.block == q.block && p.edge == q.edge; };
    return std::ranges::equal(a.boundaries, b.boundaries, [&](const Boundary& p, const Boundary& q) {
        return p.name == q.name && std::ranges::equal(p.edges, q.edges, same_edge);
    });
}

/// The body, or the message of why there is none.
struct Outcome {
    CutBody body;
    std::string message;
};

template <class Cut> Outcome outcome(const Cut& cut, const GeometrySpec& spec) {
    try {
        return {cut(spec), ""};
    } catch (const InputError& error) {
        return {{}, error.what()};
    }
}

void expect_same(const GeometrySpec& spec, const std::string& what) {
    const Outcome cut = outcome(cut_blocks, spec);
    const Outcome exact = outcome(cut_blocks_exactly, spec);
    EXPECT_EQ(cut.message, exact.message) << what;
    EXPECT_EQ(cut.body.system.n_blocks(), exact.body.system.n_blocks()) << what;
    EXPECT_TRUE(same_blocks(cut.body.system, exact.body.system)) << what;
    EXPECT_TRUE(same_boundaries(cut.body.system, exact.body.system)) << what;
    EXPECT_TRUE(same_report(cut.body.report, exact.body.report)) << what;
}

TEST(SlowWholeCells, MakeTheSameBodyAsTheExactSubdivisionOfAllHexagons) {
    expect_same(net(), "plain");
    for (const double rotation : {0.0, 0.1, std::numbers::pi / 6.0, 1.0, -2.0}) {
        for (const double jitter : {0.0, 0.1, 0.2499}) {
            for (const std::uint64_t seed : {1U, 7U}) {
                expect_same(net({.spacing = 0.031,
                                 .rotation = rotation,
                                 .offset = {0.013, -7.3},
                                 .jitter = jitter,
                                 .seed = seed}),
                            "rotation " + std::to_string(rotation) + ", jitter " + std::to_string(jitter));
            }
        }
    }
}

TEST(WholeCells, MakeTheSameBodyWhereTheNetIsCoarse) {
    for (const double spacing : {0.1, 0.2, 0.3, 0.5, 1.0, 5.0}) expect_same(net({.spacing = spacing}), "coarse");
    GeometrySpec strip = rectangle(3.0, 0.05);
    strip.tessellation = Tessellation{.hexagons = {.spacing = 0.02, .rotation = 0.3}};
    expect_same(strip, "strip");
}

TEST(WholeCells, MakeTheSameBodyFarFromTheOriginOfMaps) {
    GeometrySpec spec = net({.spacing = 0.03, .rotation = 0.2, .jitter = 0.15});
    add_trace(spec, {{0.1, 0.05}, {0.5, 0.43}, {0.93, 0.77}});
    const Vec2 far(4.5e5, 6.7e6);
    for (Vec2& p : spec.domain) p += far;
    for (Vec2& p : spec.fractures.front().points) p += far;
    expect_same(spec, "map coordinates");
}

// Cuts through a regular net along its axes leave many slivers of equal area and short edges of equal length, whose order
// decides what is left.
TEST(WholeCells, MakeTheSameBodyWhereSliversAreAlike) {
    const double d = 0.04;
    for (const double part : {0.01, 0.26, 0.49, 0.5, 0.51}) {
        GeometrySpec spec = net();
        const double row = 0.5 * std::numbers::sqrt3 * d;
        add_trace(spec, {{-0.1, (7.0 + part) * row}, {1.1, (7.0 + part) * row}});
        add_trace(spec, {{(9.0 + part) * d, -0.1}, {(9.0 + part) * d, 0.63}});
        const Vec2 along(0.5, 0.5 * std::numbers::sqrt3);
        const Vec2 from((4.0 + part) * d, 0.0);
        add_trace(spec, {from, from + 0.8 * along});
        spec.holes.push_back(
            {{12.0 * d, 8.0 * row}, {16.0 * d, 8.0 * row}, {16.0 * d, 12.0 * row}, {12.0 * d, 12.0 * row}});
        expect_same(spec, "part " + std::to_string(part));
    }
}

TEST(WholeCells, MakeTheSameBodyAroundHolesAndInRegions) {
    GeometrySpec spec = net({.spacing = 0.025, .rotation = 0.7, .jitter = 0.1});
    spec.domain = {{0, 0}, {1, 0.1}, {0.9, 0.4}, {0.5, 0.35}, {1.1, 0.9}, {0.4, 0.8}, {0.1, 1.2}};
    spec.boundaries.clear();
    expect_same(spec, "polygon");
    spec.holes.push_back({{0.2, 0.2}, {0.4, 0.25}, {0.3, 0.3}});
    spec.holes.push_back({{0.25, 0.5}, {0.25, 0.501}, {0.26, 0.501}, {0.26, 0.5}}); // inside a hexagon
    expect_same(spec, "holes");
    spec.tessellation->region = Polygon{{0.1, 0.1}, {0.6, 0.1}, {0.35, 0.7}, {0.5, 0.4}, {0.1, 0.7}};
    expect_same(spec, "region");
    spec.tessellation->region = Polygon{{0.42, 0.4}, {0.7, 0.55}, {0.6, 0.75}, {0.35, 0.75}};
    add_trace(spec, {{0.1, 0.15}, {0.15, 0.4}, {0.2, 0.15}, {0.1, 0.15}}); // a block of its own
    add_trace(spec, {{0.45, 0.55}, {0.6, 0.6}, {0.5, 0.65}, {0.45, 0.55}});
    add_trace(spec, {{-0.1, 0.45}, {1.2, 0.5}});
    expect_same(spec, "traces");
}

class WholeCellsInRandomBodies : public testing::TestWithParam<int> {};

TEST_P(WholeCellsInRandomBodies, MakeTheSameBody) {
    Uniform uniform(3000 + GetParam());
    GeometrySpec spec = net({.spacing = uniform(0.02, 0.06),
                             .rotation = GetParam() % 3 == 0 ? 0.0 : uniform(-4.0, 4.0),
                             .offset = {uniform(), uniform(-3.0, 3.0)},
                             .jitter = GetParam() % 2 == 0 ? 0.0 : uniform(0.0, 0.25),
                             .seed = static_cast<std::uint64_t>(GetParam())});
    spec.minimum_area = GetParam() % 4 == 0 ? 0.3 : 0.05;
    if (GetParam() % 5 == 1) {
        spec.domain = {{0, 0}, {1, 0.1}, {0.9, 0.6}, {1.1, 1}, {0.4, 0.8}, {0.1, 1.2}};
        spec.boundaries.clear();
    }
    if (GetParam() % 5 == 2) {
        for (int i = 0; i < 3; ++i) {
            const Vec2 at(0.2 + 0.3 * i, uniform(0.2, 0.6));
            Polygon hole;
            for (int k = 0; k < 7; ++k) {
                const double angle = 2.0 * std::numbers::pi * k / 7.0;
                hole.push_back(at + uniform(0.01, 0.1) * Vec2(std::cos(angle), std::sin(angle)));
            }
            spec.holes.push_back(hole);
        }
    }
    if (GetParam() % 5 == 3) {
        const Vec2 a(uniform(0.0, 0.5), uniform(0.0, 0.4));
        const Vec2 b = a + Vec2(uniform(0.2, 0.6), uniform(0.2, 0.5));
        spec.tessellation->region = Polygon{a, {b.x(), a.y()}, b, {a.x(), b.y()}};
    }
    add_random_traces(spec, GetParam() % 4, 1.0, 0.8, uniform);
    for (int i = 0; i < GetParam() % 3; ++i) { // bent ones, with loose ends and loops
        std::vector<Vec2> points{{uniform(0.1, 0.9), uniform(0.1, 0.7)}};
        for (int k = 0; k < 5; ++k) points.push_back(points.back() + Vec2(uniform(-0.15, 0.15), uniform(-0.15, 0.15)));
        if (i == 1) points.push_back(points.front());
        add_trace(spec, points);
    }
    expect_same(spec, "body " + std::to_string(GetParam()));
}

INSTANTIATE_TEST_SUITE_P(Seeds, WholeCellsInRandomBodies, testing::Range(0, 60));

} // namespace
} // namespace kluft
