#include "legend.hpp"

#include <algorithm>
#include <utility>

namespace kluft {

namespace {

constexpr double indent = 27.0; // of the text behind its sample
constexpr double gap = 8.0;     // between columns

/// Of UTF-8 text: bytes that begin a character.
std::size_t n_characters(const std::string& text) {
    return static_cast<std::size_t>(
        std::ranges::count_if(text, [](char c) { return (static_cast<unsigned char>(c) & 0xC0U) != 0x80U; }));
}

} // namespace

LegendEntry line_entry(std::string label, const Stroke& stroke) {
    return {std::move(label), [stroke](Canvas& canvas, const Vec2& middle) {
                canvas.line(middle - Vec2(9.0, 0.0), middle + Vec2(9.0, 0.0), stroke);
            }};
}

LegendGrid::LegendGrid(std::vector<LegendEntry> entries, double width) : entries_(std::move(entries)), width_(width) {
    constexpr double letter = 4.9; // mean width; labels that are wider are drawn smaller
    constexpr std::size_t most_columns = 3;
    std::size_t letters = 1;
    for (const LegendEntry& entry : entries_) letters = std::max(letters, n_characters(entry.label));
    const auto fitting = static_cast<std::size_t>(width_ / (letter * static_cast<double>(letters) + indent + gap));
    n_columns_ = std::clamp(fitting, std::size_t{1}, most_columns);
    n_rows_ = (entries_.size() + n_columns_ - 1) / n_columns_;
}

double LegendGrid::height() const { return n_rows_ > 0 ? legend_line * static_cast<double>(n_rows_) + 8.0 : 0.0; }

void LegendGrid::draw(Canvas& canvas, const Vec2& corner) const {
    const double column = width_ / static_cast<double>(n_columns_);
    for (std::size_t i = 0; i < entries_.size(); ++i) {
        const std::size_t place = i / n_rows_; // the column
        const std::size_t row = i % n_rows_;
        const Vec2 at =
            corner + Vec2(column * static_cast<double>(place), legend_line * (static_cast<double>(row) + 0.5));
        entries_[i].draw_sample(canvas, at + Vec2(11.0, 0.0));
        canvas.text_within(column - indent - gap, at + Vec2(indent, 0.0), entries_[i].label, legend_style);
    }
}

} // namespace kluft
