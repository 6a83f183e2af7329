#include "kluft/output/cracks_picture.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "kluft/core/diagnostics.hpp"
#include "kluft/output/atomic_file.hpp"
#include "output/hexagon_grid.hpp"
#include "output/temporary_directory.hpp"

namespace kluft {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;
using testing::TemporaryDirectory;

const char* const red = "rgb(100%,0%,0%)";
const char* const blue = "rgb(0%,0%,100%)";

CracksPlot plot() {
    CracksPlot plot;
    plot.title = "Cracks";
    plot.heading = "before loading";
    plot.groups = {{"only a: 1", "1 in tension, 0 in shear", colour(0xFF0000), {{{10.1, 20.1}, {10.2, 20.1}, -1.0}}},
                   {"only b: 0", "", colour(0x0000FF), {}}};
    return plot;
}

TEST(CracksPicture, IsWrittenAsPngAndSvgWithEveryGroupInTheLegend) {
    const TemporaryDirectory directory;
    const BlockSystem system = testing::hexagon_grid(6, 8, 0.05, {10.0, 20.0});
    write_cracks(directory / "c.png", system, plot());
    write_cracks(directory / "c.svg", system, plot());
    EXPECT_THAT(read_file(directory / "c.png"), StartsWith("\x89PNG"));
    const std::string svg = read_file(directory / "c.svg");
    EXPECT_THAT(svg, ::testing::AllOf(HasSubstr("</svg>"), HasSubstr(red), HasSubstr(blue)));
}

TEST(CracksPicture, DrawsABodyWithoutCracks) {
    CracksPlot empty = plot();
    empty.groups.clear();
    const std::string svg = draw_cracks(testing::block_with_hole(), empty, PictureFormat::svg);
    EXPECT_THAT(svg, ::testing::AllOf(HasSubstr("</svg>"), Not(HasSubstr(red))));
}

// A dot is a circle, which has curves; and the page reaches as far as the crack.
TEST(CracksPicture, ShowsACrackOutsideTheBodyAndOneWithoutALine) {
    CracksPlot far = plot();
    far.groups[0].cracks = {{{30.0, 20.0}, {30.0, 20.0}, 1.0}};
    const BlockSystem system = testing::hexagon_grid(6, 8, 0.05, {10.0, 20.0});
    EXPECT_THAT(draw_cracks(system, far, PictureFormat::png), StartsWith("\x89PNG"));
    EXPECT_THAT(draw_cracks(system, far, PictureFormat::svg), HasSubstr(red));
}

TEST(CracksPicture, OfVeryManyBlocksIsNoSvg) {
    BlockSystem system = testing::block_with_hole();
    system.blocks.resize(20001, system.blocks.front());
    EXPECT_THROW((void)draw_cracks(system, {}, PictureFormat::svg), InputError);
}

} // namespace
} // namespace kluft
