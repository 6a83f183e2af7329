// Lines with and without a part in a square of 4 m with a square hole of 2 m in its middle.
#include "kluft/scene/traces_outside.hpp"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

namespace kluft {
namespace {

constexpr double quarter_turn = 1.5707963267948966;

/// Turned about the origin and moved, so that no side is along an axis.
std::vector<Vec2> placed(const std::vector<Vec2>& points, double turn, const Vec2& by) {
    std::vector<Vec2> result;
    for (const Vec2& p : points)
        result.push_back(by + Vec2(std::cos(turn) * p.x() - std::sin(turn) * p.y(),
                                   std::sin(turn) * p.x() + std::cos(turn) * p.y()));
    return result;
}

struct LineOfSquare {
    std::vector<Vec2> points;
    bool outside = false;
    bool in_hole = false;
};

TEST(LinesOutside, AreThoseWithoutAPartInTheBodyOrAlongItsOutline) {
    const std::vector<Vec2> domain{{-2, -2}, {2, -2}, {2, 2}, {-2, 2}};
    const std::vector<Vec2> hole{{-1, -1}, {1, -1}, {1, 1}, {-1, 1}};
    const std::vector<LineOfSquare> lines{{{{-1.9, 0}, {-1.1, 0}}},              // beside the hole
                                          {{{-3, 0}, {3, 0}}},                   // through all
                                          {{{-2, -1}, {-2, 1}}},                 // along the outline
                                          {{{-1, -0.5}, {-1, 0.5}}},             // along the wall
                                          {{{-1, -1.5}, {-1, 1.5}}},             // along the wall and on into the body
                                          {{{0, 0}, {0, 0.5}, {0, 1.5}}},        // out of the hole
                                          {{{-1, -1}, {-1, 1}, {1, 1}, {0, 0}}}, // along two walls, and into the hole
                                          {{{2.5, 0}, {3, 1}}, true},            // beside the body
                                          {{{2, 0}, {3, 0}}, true},              // touches the outline
                                          {{{3, 1}, {1, 3}, {2, 2}}, true},      // touches a corner
                                          {{{-0.5, -0.5}, {0.5, 0.5}}, true, true},  // in the hole
                                          {{{-1, 0}, {1, 0}}, true, true},           // from wall to wall
                                          {{{-1, -1}, {1, 1}}, true, true},          // from corner to corner
                                          {{{0, 0}, {1, 0}, {0, 0.5}}, true, true}}; // touches the wall
    for (const double turn : {0.0, quarter_turn, 0.3, 1.1}) {
        for (const Vec2& by : {Vec2(0, 0), Vec2(691400, 5334600)}) {
            std::vector<std::vector<Vec2>> given;
            for (const LineOfSquare& line : lines) given.push_back(placed(line.points, turn, by));
            std::vector<int> found(lines.size(), 0);
            for (const LineOutside& each : lines_outside(placed(domain, turn, by), {placed(hole, turn, by)}, given))
                found[each.line] = each.in_hole ? 2 : 1;
            for (std::size_t i = 0; i < lines.size(); ++i)
                EXPECT_EQ(found[i], lines[i].outside ? (lines[i].in_hole ? 2 : 1) : 0)
                    << "line " << i << " turned by " << turn << " and moved by " << by.x();
        }
    }
}

TEST(PolygonOutside, IsOneThatHasNoAreaInTheBody) {
    const Polygon domain{{-2, -2}, {2, -2}, {2, 2}, {-2, 2}};
    const std::vector<Polygon> holes{{{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}};
    EXPECT_TRUE(is_outside({{3, 0}, {4, 0}, {4, 1}}, domain, holes));
    EXPECT_TRUE(is_outside({{-0.5, -0.5}, {0.5, -0.5}, {0, 0.5}}, domain, holes));
    EXPECT_FALSE(is_outside({{-9, -9}, {9, -9}, {9, 9}, {-9, 9}}, domain, holes)); // around it
    EXPECT_FALSE(is_outside({{1.2, 0}, {1.8, 0}, {1.5, 1}}, domain, holes));
    EXPECT_FALSE(is_outside({{1, 1}, {3, 1}, {3, 3}, {1, 3}}, domain, holes));
}

} // namespace
} // namespace kluft
