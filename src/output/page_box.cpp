#include "kluft/output/page_box.hpp"

#include <algorithm>

namespace kluft {

// The part of the line inside the box, by its first and last parameter (Liang & Barsky 1984).
bool enters(const PageBox& box, const Vec2& from, const Vec2& to) {
    double first = 0.0;
    double last = 1.0;
    for (const int i : {0, 1}) {
        const double along = to[i] - from[i];
        if (along == 0.0) {
            if (from[i] < box.low[i] || from[i] > box.high[i]) return false;
            continue;
        }
        const double a = (box.low[i] - from[i]) / along;
        const double b = (box.high[i] - from[i]) / along;
        first = std::max(first, std::min(a, b));
        last = std::min(last, std::max(a, b));
    }
    return first <= last;
}

std::size_t Obstacles::met_by(const PageBox& box) const {
    constexpr std::size_t weight_of_text = 1000;
    std::size_t n_met = 0;
    for (const auto& line : lines)
        for (std::size_t i = 1; i < line.size(); ++i) n_met += enters(box, line[i - 1], line[i]) ? 1 : 0;
    for (const PageBox& other : boxes) {
        const bool apart = (box.high.array() < other.low.array()).any() || (other.high.array() < box.low.array()).any();
        if (!apart) n_met += weight_of_text;
    }
    return n_met;
}

} // namespace kluft
