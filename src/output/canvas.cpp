#include "kluft/output/canvas.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <memory>
#include <numbers>

#include <cairo-pdf.h>
#include <cairo-svg.h>
#include <cairo.h>
#include <fmt/format.h>
#include <zlib.h>

#include "kluft/core/diagnostics.hpp"
#include "kluft/core/memory.hpp"

namespace kluft {

namespace {

constexpr double full_turn = 2.0 * std::numbers::pi;

struct DestroySurface {
    void operator()(cairo_surface_t* surface) const { cairo_surface_destroy(surface); }
};
struct DestroyContext {
    void operator()(cairo_t* context) const { cairo_destroy(context); }
};
using Surface = std::unique_ptr<cairo_surface_t, DestroySurface>;
using Context = std::unique_ptr<cairo_t, DestroyContext>;

void check(cairo_status_t status) {
    if (status != CAIRO_STATUS_SUCCESS)
        throw ResourceError(std::string("cannot draw a picture: ") + cairo_status_to_string(status));
}

cairo_status_t collect(void* bytes, const unsigned char* part, unsigned length) noexcept {
    try {
        static_cast<std::string*>(bytes)->append(reinterpret_cast<const char*>(part), length);
        return CAIRO_STATUS_SUCCESS;
    } catch (...) {
        return CAIRO_STATUS_NO_MEMORY;
    }
}

/// Length of the UTF-8 character that begins at `at`, 0 where there is none.
std::size_t character_length(const std::string& text, std::size_t at) {
    const auto byte = [&](std::size_t i) { return i < text.size() ? static_cast<unsigned char>(text[i]) : 0U; };
    const unsigned first = byte(at);
    if (first >= 0x20U && first < 0x7fU) return 1;
    const std::size_t length = first >= 0xc2U && first < 0xe0U ? 2 : first >= 0xe0U && first < 0xf0U ? 3 : 0;
    for (std::size_t i = 1; i < length; ++i)
        if ((byte(at + i) & 0xc0U) != 0x80U) return 0;
    const bool overlong_or_surrogate =
        (first == 0xe0U && byte(at + 1) < 0xa0U) || (first == 0xedU && byte(at + 1) > 0x9fU);
    return overlong_or_surrogate ? 0 : length;
}

/// The text with a question mark for every byte that Cairo would refuse or could not show.
std::string printable(const std::string& text) {
    std::string shown;
    for (std::size_t i = 0; i < text.size();) {
        const std::size_t length = character_length(text, i);
        shown += length > 0 ? text.substr(i, length) : "?";
        i += std::max<std::size_t>(length, 1);
    }
    return shown;
}

/// Characters that have a meaning in XML are written by their names.
std::string xml_text(const std::string& text) {
    std::string written;
    for (const char c : text) {
        if (c == '&')
            written += "&amp;";
        else if (c == '<')
            written += "&lt;";
        else
            written += c;
    }
    return written;
}

std::string hex_colour(const Colour& colour) {
    const auto byte = [](double share) { return std::lround(255.0 * std::clamp(share, 0.0, 1.0)); };
    return fmt::format("#{:02x}{:02x}{:02x}", byte(colour.red), byte(colour.green), byte(colour.blue));
}

/// The text as an element of an SVG. Its anchor keeps it in place where the reader's font is another one.
std::string svg_text(const Vec2& at, const std::string& text, const TextStyle& style, double capital_height) {
    constexpr double degree = std::numbers::pi / 180.0;
    const auto anchor = [](Align align) {
        return align == Align::low ? "start" : align == Align::middle ? "middle" : "end";
    };
    const double y = style.down == Align::high ? 0.0 : (style.down == Align::middle ? 0.5 : 1.0) * capital_height;
    std::string attributes =
        fmt::format("transform=\"translate({:.2f} {:.2f}) rotate({:.3g})\" y=\"{:.2f}\" font-size=\"{:.3g}\" "
                    "text-anchor=\"{}\" fill=\"{}\" fill-opacity=\"{:.3g}\"",
                    at.x(), at.y(), style.angle / degree, y, style.size, anchor(style.across), hex_colour(style.colour),
                    style.colour.alpha);
    if (style.bold) attributes += " font-weight=\"bold\"";
    if (style.halo > 0.0)
        attributes += fmt::format(" stroke=\"#ffffff\" stroke-opacity=\"0.85\" stroke-width=\"{:.3g}\" "
                                  "stroke-linejoin=\"round\" paint-order=\"stroke\"",
                                  2.0 * style.halo);
    return fmt::format("<text {}>{}</text>\n", attributes, xml_text(text));
}

constexpr std::size_t head_of_png = 33; ///< bytes of the signature and of the chunk IHDR

std::string big_endian(std::uint32_t number) {
    std::string bytes;
    for (const unsigned shift : {24U, 16U, 8U, 0U}) bytes += static_cast<char>(number >> shift & 0xffU);
    return bytes;
}

/// The chunk of a PNG that says what made it.
std::string maker_chunk() {
    using namespace std::string_literals;
    const std::string text = "Software\0Kluft"s, named = "tEXt" + text;
    const auto* const bytes = reinterpret_cast<const Bytef*>(named.data()); // NOLINT: bytes are bytes
    const auto check = ::crc32(0, bytes, static_cast<uInt>(named.size()));
    return big_endian(static_cast<std::uint32_t>(text.size())) + named + big_endian(static_cast<std::uint32_t>(check));
}

void draw_on(cairo_surface_t* surface, double width, double height, double scale,
             const std::function<void(Canvas&)>& draw, std::string* svg_texts = nullptr) {
    require_memory(); // the libraries below wait for ever or crash where there is none
    check(cairo_surface_status(surface));
    const Context context(cairo_create(surface));
    cairo_scale(context.get(), scale, scale);
    Canvas canvas(context.get(), width, height, svg_texts);
    canvas.fill_page({1.0, 1.0, 1.0, 1.0});
    draw(canvas);
    check(cairo_status(context.get()));
}

} // namespace

Colour series_colour(std::size_t index) {
    constexpr std::array colours{colour(0x0072B2), colour(0xD55E00), colour(0x009E73), colour(0xCC79A7),
                                 colour(0xE69F00), colour(0x56B4E9), colour(0x333333)};
    return colours[index % colours.size()];
}

void Canvas::set(const Colour& colour) {
    cairo_set_source_rgba(context_, colour.red, colour.green, colour.blue, colour.alpha);
}

void Canvas::set(const Stroke& stroke) {
    set(stroke.colour);
    cairo_set_line_width(context_, stroke.width);
    cairo_set_dash(context_, stroke.dash.data(), static_cast<int>(stroke.dash.size()), 0.0);
    cairo_set_line_cap(context_, stroke.round_caps ? CAIRO_LINE_CAP_ROUND : CAIRO_LINE_CAP_BUTT);
    cairo_set_line_join(context_, CAIRO_LINE_JOIN_ROUND);
}

void Canvas::set_font(const TextStyle& style) {
    cairo_select_font_face(context_, "DejaVu Sans", CAIRO_FONT_SLANT_NORMAL,
                           style.bold ? CAIRO_FONT_WEIGHT_BOLD : CAIRO_FONT_WEIGHT_NORMAL);
    cairo_set_font_size(context_, style.size);
}

void Canvas::trace(const std::vector<std::vector<Vec2>>& loops) {
    for (const auto& loop : loops) {
        if (loop.empty()) continue;
        cairo_move_to(context_, loop.front().x(), loop.front().y());
        for (std::size_t i = 1; i < loop.size(); ++i) cairo_line_to(context_, loop[i].x(), loop[i].y());
        cairo_close_path(context_);
    }
}

void Canvas::fill_page(const Colour& page) {
    set(page);
    cairo_paint(context_);
}

void Canvas::fill_rectangle(const Vec2& corner, const Vec2& size, const Colour& fill) {
    set(fill);
    cairo_rectangle(context_, corner.x(), corner.y(), size.x(), size.y());
    cairo_fill(context_);
}

void Canvas::stroke_rectangle(const Vec2& corner, const Vec2& size, const Stroke& stroke) {
    set(stroke);
    cairo_rectangle(context_, corner.x(), corner.y(), size.x(), size.y());
    cairo_stroke(context_);
}

void Canvas::fill_polygon(const std::vector<std::vector<Vec2>>& loops, const Colour& fill) {
    set(fill);
    trace(loops);
    cairo_set_fill_rule(context_, CAIRO_FILL_RULE_EVEN_ODD);
    cairo_fill(context_);
}

void Canvas::stroke_polygon(const std::vector<std::vector<Vec2>>& loops, const Stroke& stroke) {
    set(stroke);
    trace(loops);
    cairo_stroke(context_);
}

void Canvas::line(const Vec2& from, const Vec2& to, const Stroke& stroke) { segments({{from, to}}, stroke); }

void Canvas::polyline(const std::vector<Vec2>& points, const Stroke& stroke) {
    set(stroke);
    for (const Vec2& point : points) cairo_line_to(context_, point.x(), point.y());
    cairo_stroke(context_);
}

void Canvas::segments(const std::vector<std::pair<Vec2, Vec2>>& lines, const Stroke& stroke) {
    set(stroke);
    // Cairo's time grows faster than the number of segments of one path.
    constexpr std::size_t segments_per_path = 500;
    for (std::size_t i = 0; i < lines.size(); ++i) {
        cairo_move_to(context_, lines[i].first.x(), lines[i].first.y());
        cairo_line_to(context_, lines[i].second.x(), lines[i].second.y());
        if (i % segments_per_path == segments_per_path - 1) cairo_stroke(context_);
    }
    cairo_stroke(context_);
}

void Canvas::circle(const Vec2& centre, double radius, const Colour& fill, const Stroke& stroke) {
    cairo_new_path(context_);
    cairo_arc(context_, centre.x(), centre.y(), radius, 0.0, full_turn);
    set(fill);
    cairo_fill_preserve(context_);
    set(stroke);
    cairo_stroke(context_);
}

void Canvas::arc(const Vec2& centre, double radius, double from, double to, const Stroke& stroke) {
    set(stroke);
    cairo_new_path(context_);
    cairo_arc(context_, centre.x(), centre.y(), radius, from, to);
    cairo_stroke(context_);
}

void Canvas::text(const Vec2& at, const std::string& text, const TextStyle& style) {
    const std::string shown = printable(text);
    set_font(style);
    set(style.colour);
    const auto share = [](Align align) { return align == Align::low ? 0.0 : align == Align::middle ? 0.5 : 1.0; };
    constexpr double capital_height = 0.73; // of DejaVu Sans, as a fraction of the font size
    if (svg_texts_ != nullptr) {
        Vec2 on_page = at;
        cairo_user_to_device(context_, &on_page.x(), &on_page.y());
        *svg_texts_ += svg_text(on_page, shown, style, capital_height * style.size);
        return;
    }
    cairo_save(context_);
    cairo_translate(context_, at.x(), at.y());
    cairo_rotate(context_, style.angle);
    const double x = -share(style.across) * text_width(text, style);
    const double y = (1.0 - share(style.down)) * capital_height * style.size;
    if (style.halo > 0.0) {
        cairo_move_to(context_, x, y);
        cairo_text_path(context_, shown.c_str());
        set(Stroke{{1.0, 1.0, 1.0, 0.85}, 2.0 * style.halo});
        cairo_stroke(context_);
        set(style.colour);
    }
    cairo_move_to(context_, x, y);
    cairo_show_text(context_, shown.c_str());
    cairo_restore(context_);
    cairo_new_path(context_);
}

void Canvas::text_within(double width, const Vec2& at, const std::string& shown, const TextStyle& style) {
    TextStyle fitted = style;
    fitted.size *= std::min(1.0, width / std::max(1.0, text_width(shown, style)));
    text(at, shown, fitted);
}

double Canvas::text_width(const std::string& text, const TextStyle& style) {
    set_font(style);
    cairo_text_extents_t extents;
    cairo_text_extents(context_, printable(text).c_str(), &extents);
    return extents.x_advance;
}

void Canvas::begin_clip(const Vec2& corner, const Vec2& size) {
    cairo_save(context_);
    cairo_rectangle(context_, corner.x(), corner.y(), size.x(), size.y());
    cairo_clip(context_);
}

void Canvas::end_clip() { cairo_restore(context_); }

void Canvas::begin_part(const Vec2& corner) {
    cairo_save(context_);
    cairo_translate(context_, corner.x(), corner.y());
}

void Canvas::end_part() { cairo_restore(context_); }

namespace {

constexpr std::string_view group_of_texts =
    "<g font-family=\"'DejaVu Sans', Verdana, sans-serif\" xml:space=\"preserve\">";
constexpr std::string_view table_of_pdf = "startxref"; ///< after it comes the end, which readers look for
constexpr std::string_view maker_of_pdf = "% Drawn by Kluft\n";

} // namespace

PictureFormat picture_format(const std::filesystem::path& path) {
    const std::string extension = path.extension();
    if (extension == ".png") return PictureFormat::png;
    if (extension == ".svg") return PictureFormat::svg;
    if (extension == ".pdf") return PictureFormat::pdf;
    throw InputError(path.string() + ": expected a picture's name that ends in .png, .svg or .pdf");
}

std::string draw_picture(PictureFormat format, double width, double height, double pixels_per_point,
                         const std::function<void(Canvas&)>& draw) {
    std::string bytes;
    std::string svg_texts;
    if (format != PictureFormat::png) {
        const auto create =
            format == PictureFormat::svg ? cairo_svg_surface_create_for_stream : cairo_pdf_surface_create_for_stream;
        const Surface surface(create(collect, &bytes, width, height));
        draw_on(surface.get(), width, height, 1.0, draw, format == PictureFormat::svg ? &svg_texts : nullptr);
        cairo_surface_finish(surface.get());
        check(cairo_surface_status(surface.get()));
        if (format == PictureFormat::pdf) bytes.insert(bytes.rfind(table_of_pdf), maker_of_pdf);
        if (!svg_texts.empty())
            bytes.insert(bytes.rfind("</svg>"), std::string(group_of_texts) + "\n" + svg_texts + "</g>\n");
    } else {
        const Surface surface(cairo_image_surface_create(CAIRO_FORMAT_RGB24,
                                                         static_cast<int>(std::lround(width * pixels_per_point)),
                                                         static_cast<int>(std::lround(height * pixels_per_point))));
        draw_on(surface.get(), width, height, pixels_per_point, draw);
        check(cairo_surface_write_to_png_stream(surface.get(), collect, &bytes));
        bytes.insert(head_of_png, maker_chunk());
    }
    return bytes;
}

bool is_drawn_picture(PictureFormat format, std::string_view content) {
    switch (format) {
    case PictureFormat::png:
        return is_drawn_png(content);
    case PictureFormat::svg:
        return content.find(group_of_texts) != std::string_view::npos;
    case PictureFormat::pdf:
        return content.find(std::string(maker_of_pdf) + std::string(table_of_pdf)) != std::string_view::npos;
    }
    return false;
}

bool is_drawn_png(std::string_view content) {
    return content.size() > head_of_png && content.substr(head_of_png).starts_with(maker_chunk());
}

} // namespace kluft
