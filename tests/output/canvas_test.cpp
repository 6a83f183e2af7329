#include "kluft/output/canvas.hpp"

#include <cstdint>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "kluft/core/diagnostics.hpp"

// Fontconfig keeps its caches until the program ends; the leak check of a sanitizer build looks away from them.
extern "C" const char* __lsan_default_suppressions(); // NOLINT: the sanitizer's own name
extern "C" const char* __lsan_default_suppressions() { return "leak:libfontconfig"; } // NOLINT

namespace kluft {
namespace {

using ::testing::HasSubstr;

int big_endian(const std::string& bytes, std::size_t at) {
    std::uint32_t value = 0;
    for (std::size_t i = at; i < at + 4; ++i) value = 256U * value + static_cast<unsigned char>(bytes[i]);
    return static_cast<int>(value);
}

// Width and height stand at bytes 16 and 20 of a PNG file.
TEST(Canvas, HasThePixelsOfThePage) {
    const std::string png = draw_picture(PictureFormat::png, 100.0, 40.0, 2.5, [](Canvas& canvas) {
        EXPECT_EQ(canvas.width(), 100.0);
        canvas.line({0.0, 0.0}, {100.0, 40.0}, {});
    });
    EXPECT_EQ(big_endian(png, 16), 250);
    EXPECT_EQ(big_endian(png, 20), 100);
}

// The text follows the 33 bytes of the head; bit by bit, the check of a chunk is that of PNG's appendix D.
TEST(Canvas, APngSaysWhatMadeIt) {
    const std::string png = draw_picture(PictureFormat::png, 10.0, 10.0, 1.0, [](Canvas&) {});
    EXPECT_TRUE(is_drawn_png(png));
    EXPECT_FALSE(is_drawn_png("mine"));
    const std::size_t n = 14;
    EXPECT_FALSE(is_drawn_png(std::string(png).erase(33, 12 + n)));
    EXPECT_EQ(big_endian(png, 33), static_cast<int>(n));
    EXPECT_EQ(png.substr(37, 4 + n), std::string("tEXtSoftware\0Kluft", 4 + n));
    std::uint32_t check = 0xffffffffU;
    for (const char c : png.substr(37, 4 + n)) {
        check ^= static_cast<unsigned char>(c);
        for (int bit = 0; bit < 8; ++bit) check = (check >> 1U) ^ ((check & 1U) != 0U ? 0xedb88320U : 0U);
    }
    EXPECT_EQ(static_cast<std::uint32_t>(big_endian(png, 41 + n)), ~check);
}

TEST(Canvas, SaysWhenAPictureIsTooLarge) {
    EXPECT_THROW((void)draw_picture(PictureFormat::png, 1e5, 1e5, 10.0, [](Canvas&) {}), ResourceError);
}

TEST(Canvas, ShrinksTextThatWouldBeTooWide) {
    (void)draw_picture(PictureFormat::svg, 100.0, 40.0, 1.0, [](Canvas& canvas) {
        const TextStyle style{.size = 10.0};
        EXPECT_GT(canvas.text_width("wide text", style), canvas.text_width("text", style));
        EXPECT_NO_THROW(canvas.text_within(5.0, {0.0, 20.0}, "wide text \xff", style));
    });
}

// Whoever edits the picture, or searches a document for a word of it, finds the words.
TEST(Canvas, TextOfAnSvgIsText) {
    const std::string svg = draw_picture(PictureFormat::svg, 100.0, 40.0, 1.0, [](Canvas& canvas) {
        canvas.begin_part({10.0, 5.0});
        canvas.text({20.0, 15.0}, "c < 8 MPa & \xcf\x86", {.size = 8.0, .across = Align::middle});
        canvas.end_part();
    });
    EXPECT_THAT(svg, HasSubstr(">c &lt; 8 MPa &amp; \xcf\x86</text>"));
    EXPECT_THAT(svg, HasSubstr("translate(30.00 20.00)"));
    EXPECT_THAT(svg, HasSubstr("text-anchor=\"middle\""));
    EXPECT_TRUE(svg.ends_with("</svg>\n"));
}

TEST(Canvas, KnowsTheFormatFromTheNameOfTheFile) {
    EXPECT_EQ(picture_format("a/b.png"), PictureFormat::png);
    EXPECT_EQ(picture_format("b.svg"), PictureFormat::svg);
    EXPECT_EQ(picture_format("b.pdf"), PictureFormat::pdf);
    EXPECT_THROW((void)picture_format("b.gif"), InputError);
    EXPECT_THROW((void)picture_format("png"), InputError);
}

TEST(Canvas, HasColoursThatRepeatAfterSeven) {
    EXPECT_EQ(series_colour(0).blue, series_colour(7).blue);
    EXPECT_NEAR(colour(0x0072B2).green, 0x72 / 255.0, 1e-15);
}

} // namespace
} // namespace kluft
