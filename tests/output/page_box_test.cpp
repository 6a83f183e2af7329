#include "kluft/output/page_box.hpp"

#include <gtest/gtest.h>

namespace kluft {
namespace {

TEST(PageBox, IsEnteredByALineThatCrossesItWithBothEndsOutside) {
    const PageBox box{{0.0, 0.0}, {2.0, 1.0}};
    EXPECT_TRUE(enters(box, {-1.0, 0.5}, {3.0, 0.5}));
    EXPECT_TRUE(enters(box, {1.0, -5.0}, {1.0, 5.0}));
    EXPECT_TRUE(enters(box, {0.5, 0.5}, {0.6, 0.5}));
    EXPECT_FALSE(enters(box, {-1.0, 0.5}, {3.0, 4.0}));
    EXPECT_FALSE(enters(box, {-1.0, 1.5}, {3.0, 1.5}));
    EXPECT_FALSE(enters(box, {3.0, 0.0}, {4.0, 0.0}));
}

TEST(PageBox, MeetsOneStretchOfALineAtATimeAndTextMoreThanAnyLine) {
    Obstacles obstacles{{{{-1.0, 0.5}, {1.0, 0.5}, {3.0, 0.5}}}, {}};
    const PageBox box{{0.0, 0.0}, {2.0, 1.0}};
    EXPECT_EQ(obstacles.met_by(box), 2U);
    EXPECT_EQ(obstacles.met_by({{0.0, 1.0}, {2.0, 2.0}}), 0U);
    obstacles.boxes.push_back({{1.0, 0.9}, {5.0, 3.0}});
    EXPECT_GT(obstacles.met_by(box), 100U);
}

} // namespace
} // namespace kluft
