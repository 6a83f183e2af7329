#include "kluft/output/blocks_picture.hpp"

#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "kluft/core/diagnostics.hpp"
#include "kluft/output/atomic_file.hpp"
#include "kluft/output/block_outline.hpp"
#include "kluft/output/colour_scale.hpp"
#include "output/hexagon_grid.hpp"
#include "output/temporary_directory.hpp"

namespace kluft {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;
using testing::TemporaryDirectory;

double lightness(const Colour& c) { return 0.2126 * c.red + 0.7152 * c.green + 0.0722 * c.blue; }

TEST(ColourScale, DarkensSteadilyAndClampsWhatLiesOutside) {
    const ColourScale scale(Axis{0.0, 2.0, 0.5});
    for (double value = 0.0; value < 2.0; value += 0.05)
        EXPECT_GT(lightness(scale(value)), lightness(scale(value + 0.05)));
    EXPECT_EQ(scale(-1.0).red, scale(0.0).red);
    EXPECT_EQ(scale(5.0).red, scale(2.0).red);
    EXPECT_EQ(scale(std::numeric_limits<double>::quiet_NaN()).red, scale(0.0).red);
}

TEST(ColourScale, EndsAtARoundNumberAboveAllButTheLargestValues) {
    std::vector<double> values(1000, 1.3);
    values[7] = 400.0;
    values[8] = std::numeric_limits<double>::infinity();
    EXPECT_EQ(scale_for(values).axis().low, 0.0);
    EXPECT_NEAR(scale_for(values).axis().high, 1.4, 1e-12);
    EXPECT_GT(scale_for({}).axis().high, 0.0);
}

TEST(ColourScale, OfFewValuesEndsAboveTheLargest) {
    EXPECT_NEAR(scale_for({0.013, 1800.0}).axis().high, 2000.0, 1e-9);
    std::vector<double> values(100, -1.3);
    values[7] = -400.0;
    EXPECT_NEAR(scale_for(values).axis().low, -400.0, 1e-9);
}

BlocksPlot plot_of(const std::string& title) { return {title, "after", 1.0, {"sandstone"}, {true}}; }

std::size_t count(const std::string& text, const std::string& part) {
    std::size_t n = 0;
    for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++n;
    return n;
}

TEST(BlocksPicture, IsWrittenAsPngAndSvg) {
    const TemporaryDirectory directory;
    const BlockSystem system = testing::hexagon_grid(6, 10, 0.05);
    Mat2 gradient;
    gradient << 0.004, 0.0, 0.0, -0.012;
    auto fields = testing::affine_fields(system, gradient, -1e6 * Mat2::Identity());
    fields.interfaces[30] = {false, true, CrackMode::tension, ContactState::open, 0.0, 0.0, 1e-3, 0.0};
    fields.interfaces[31] = {false, true, CrackMode::shear, ContactState::sliding, 0.0, 0.0, 0.0, 2e-3};
    fields.displacement[3].x() = std::numeric_limits<double>::quiet_NaN();
    write_blocks(directory / "b.png", system, fields, plot_of("t"));
    write_blocks(directory / "b.svg", system, fields, plot_of("t"));
    write_geometry(directory / "g.png", system, plot_of("t"));
    write_geometry(directory / "g.svg", system, plot_of("t"));
    for (const char* name : {"b.png", "g.png"}) EXPECT_THAT(read_file(directory / name), StartsWith("\x89PNG"));
    const std::string svg = read_file(directory / "b.svg");
    EXPECT_THAT(svg, HasSubstr("</svg>"));
    // Red of the tension crack, blue of the shear crack: each once in the body and once in the legend.
    EXPECT_EQ(count(svg, "stroke:rgb(84.313725%,9.803922%,10.980392%)"), 2U);
    EXPECT_EQ(count(svg, "stroke:rgb(12.156863%,30.980392%,84.705882%)"), 2U);
}

// An arrow is two lines and two heads, white below purple; one is in the legend. Blocks that are not there, or are gone, have none.
TEST(BlocksPicture, MarksWhatMovesOn) {
    const BlockSystem system = testing::hexagon_grid(6, 10, 0.05);
    auto fields = testing::affine_fields(system, Mat2::Zero(), Mat2::Zero());
    const std::string purple = "stroke:rgb(55.686275%,14.117647%,66.666667%)";
    BlocksPlot plot = plot_of("t");
    const auto n_strokes = [&] { return count(draw_blocks(system, fields, plot, PictureFormat::svg), purple); };
    EXPECT_EQ(n_strokes(), 0U);
    plot.moving = {{.block = "5", .direction = {0.6, -0.8}}, {.block = "7", .turn = 1}};
    EXPECT_EQ(n_strokes(), 3U);
    plot.moving.push_back({.block = "no block", .direction = {1.0, 0.0}});
    plot.moving.push_back({.block = "99999", .direction = {1.0, 0.0}});
    EXPECT_EQ(n_strokes(), 3U);
    const auto first = first_vertices(system);
    for (std::size_t v = first[5]; v < first[6]; ++v) fields.displacement[v].x() = 1e6;
    EXPECT_EQ(n_strokes(), 2U);
}

// Hexagons of a row in a picture of 360 by 450 points: those of 0.05 m, 52 points apart, have an arrow each; of those of 0.01 m, 10 points
// apart, every second one has, for an arrow takes 14 points.
TEST(BlocksPicture, MarksNoMoreOfWhatMovesOnThanHasRoom) {
    const auto drawn = [](int columns, int rows, double spacing) {
        const BlockSystem system = testing::hexagon_grid(columns, rows, spacing);
        BlocksPlot plot = plot_of("t");
        for (int b = 0; b < columns; ++b) plot.moving.push_back({.block = std::to_string(b), .direction = {0.0, -1.0}});
        const auto fields = testing::affine_fields(system, Mat2::Zero(), Mat2::Zero());
        return draw_blocks(system, fields, plot, PictureFormat::svg);
    };
    const std::string purple = "stroke:rgb(55.686275%,14.117647%,66.666667%)"; // one is in the legend
    EXPECT_EQ(count(drawn(6, 10, 0.05), purple), 7U);
    const std::string fine = drawn(30, 50, 0.01);
    EXPECT_EQ(count(fine, purple), 16U);
    EXPECT_THAT(fine, HasSubstr("arrows that would overlap are left out"));
}

// Text is drawn as shapes: another label makes another picture.
TEST(BlocksPicture, NamesJointsOfGivenBlocksOtherwiseThanThoseOfANet) {
    BlockSystem system = testing::hexagon_grid(6, 10, 0.05);
    BlocksPlot plot = plot_of("t");
    plot.bonded_types = {false};
    const std::string of_net = draw_geometry(system, plot, PictureFormat::svg);
    for (Interface& each : system.interfaces) each.origin = EdgeOrigin::given;
    EXPECT_NE(draw_geometry(system, plot, PictureFormat::svg), of_net);
}

TEST(BlocksPicture, DrawsABlockWithAHole) {
    const BlockSystem system = testing::block_with_hole();
    const auto fields = testing::affine_fields(system, Mat2::Zero(), Mat2::Zero());
    EXPECT_THAT(draw_blocks(system, fields, plot_of("hole"), PictureFormat::svg), HasSubstr("fill-rule:evenodd"));
    EXPECT_THAT(draw_geometry(system, plot_of("hole"), PictureFormat::png), StartsWith("\x89PNG"));
}

TEST(BlocksPicture, KeepsTheBodyLargeWhenABlockFliesAway) {
    const BlockSystem system = testing::hexagon_grid(6, 10, 0.05);
    auto fields = testing::affine_fields(system, Mat2::Zero(), Mat2::Zero());
    for (std::size_t i = 0; i < 6; ++i) fields.displacement[i] = {0.0, -500.0};
    EXPECT_THAT(draw_blocks(system, fields, plot_of(""), PictureFormat::png), StartsWith("\x89PNG"));
}

// The legend has a line more, of one glyph for each letter and space; for two blocks it is longer by an s.
TEST(BlocksPicture, SaysHowManyBlocksHaveLeftIt) {
    const BlockSystem system = testing::hexagon_grid(6, 10, 0.05);
    const auto picture_with_away = [&](int n_away) {
        auto fields = testing::affine_fields(system, Mat2::Zero(), Mat2::Zero());
        for (int i = 0; i < 6 * n_away; ++i) fields.displacement[i] = {0.0, -500.0};
        return draw_blocks(system, fields, plot_of(""), PictureFormat::svg);
    };
    EXPECT_THAT(picture_with_away(0), Not(HasSubstr("outside the picture")));
    EXPECT_THAT(picture_with_away(1), HasSubstr(">1 block outside the picture<"));
    EXPECT_THAT(picture_with_away(2), HasSubstr(">2 blocks outside the picture<"));
}

TEST(BlocksPicture, IsNotDrawnAsSvgWithTooManyBlocks) {
    const BlockSystem system = testing::hexagon_grid(200, 101, 0.05);
    ASSERT_GT(system.n_blocks(), most_blocks_in_svg);
    EXPECT_THROW((void)draw_geometry(system, plot_of(""), PictureFormat::svg), InputError);
}

} // namespace
} // namespace kluft
