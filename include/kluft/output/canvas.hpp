// A drawing surface for pictures: the same drawing code gives PNG, SVG and PDF.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "kluft/core/vector.hpp"

struct _cairo; // NOLINT: Cairo's own name of its drawing context

namespace kluft {

struct Colour {
    double red = 0.0;
    double green = 0.0;
    double blue = 0.0;
    double alpha = 1.0;
};

/// A colour from its usual notation 0xRRGGBB.
[[nodiscard]] constexpr Colour colour(unsigned rgb, double alpha = 1.0) {
    return {static_cast<double>(rgb >> 16U & 255U) / 255.0, static_cast<double>(rgb >> 8U & 255U) / 255.0,
            static_cast<double>(rgb & 255U) / 255.0, alpha};
}

/// Colours of distinct curves that colour-blind readers can tell apart (Okabe & Ito 2008); repeats after seven.
[[nodiscard]] Colour series_colour(std::size_t index);

struct Stroke {
    Colour colour;
    double width = 0.5;            ///< points
    std::vector<double> dash = {}; ///< on, off, ... in points; empty: solid
    bool round_caps = false;
};

enum class Align { low, middle, high }; ///< left, centre, right or top, middle, bottom of the text at the place

struct TextStyle {
    double size = 9.0; ///< points
    Colour colour = {0.13, 0.13, 0.13, 1.0};
    Align across = Align::low;
    Align down = Align::high; ///< high: the place is on the base line
    bool bold = false;
    double angle = 0.0; ///< radians, clockwise on the page
    double halo = 0.0;  ///< width of a white rim that keeps the text readable on lines, points
};

/// Lengths in points, x to the right, y down. Lives inside draw_picture.
class Canvas {
public:
    /// With `svg_texts`, texts are written there as elements of an SVG, not drawn.
    Canvas(_cairo* context, double width, double height, std::string* svg_texts = nullptr)
        : context_(context), width_(width), height_(height), svg_texts_(svg_texts) {}

    [[nodiscard]] double width() const { return width_; }
    [[nodiscard]] double height() const { return height_; }

    void fill_page(const Colour& colour);
    void fill_rectangle(const Vec2& corner, const Vec2& size, const Colour& colour);
    void stroke_rectangle(const Vec2& corner, const Vec2& size, const Stroke& stroke);
    /// Loops filled together by the even-odd rule, so that holes stay free.
    void fill_polygon(const std::vector<std::vector<Vec2>>& loops, const Colour& colour);
    void stroke_polygon(const std::vector<std::vector<Vec2>>& loops, const Stroke& stroke);
    void line(const Vec2& from, const Vec2& to, const Stroke& stroke);
    void polyline(const std::vector<Vec2>& points, const Stroke& stroke);
    /// Many separate segments in one go.
    void segments(const std::vector<std::pair<Vec2, Vec2>>& lines, const Stroke& stroke);
    void circle(const Vec2& centre, double radius, const Colour& fill, const Stroke& stroke);
    /// Part of a circle from one angle to another, clockwise on the page (radians).
    void arc(const Vec2& centre, double radius, double from, double to, const Stroke& stroke);
    /// Bytes that are not UTF-8 are shown as question marks.
    void text(const Vec2& at, const std::string& text, const TextStyle& style);
    /// The same in a smaller size where the text would be wider than `width`.
    void text_within(double width, const Vec2& at, const std::string& text, const TextStyle& style);
    [[nodiscard]] double text_width(const std::string& text, const TextStyle& style);

    /// Restricts what is drawn until the matching end_clip.
    void begin_clip(const Vec2& corner, const Vec2& size);
    void end_clip();

    /// Places are counted from `corner` until the matching end_part.
    void begin_part(const Vec2& corner);
    void end_part();

private:
    void set(const Colour& colour);
    void set(const Stroke& stroke);
    void set_font(const TextStyle& style);
    void trace(const std::vector<std::vector<Vec2>>& loops);

    _cairo* context_;
    double width_;
    double height_;
    std::string* svg_texts_;
};

enum class PictureFormat { png, svg, pdf };

/// The format that the file's extension names. Throws InputError when it is none of .png, .svg and .pdf.
[[nodiscard]] PictureFormat picture_format(const std::filesystem::path& path);

/// Bytes of a picture of the given size in points on a white page; a PNG has `pixels_per_point`. Texts of an SVG stand on top
/// of all else, as text that can be searched and edited.
/// Throws ResourceError when there is not enough memory.
[[nodiscard]] std::string draw_picture(PictureFormat format, double width, double height, double pixels_per_point,
                                       const std::function<void(Canvas&)>& draw);

/// Whether draw_picture has made the file: a PNG says so in a chunk of text, a PDF in a comment at its end, and a SVG has its texts in a group
/// of its own.
[[nodiscard]] bool is_drawn_picture(PictureFormat format, std::string_view content);

/// The same of a PNG.
[[nodiscard]] bool is_drawn_png(std::string_view content);

} // namespace kluft
