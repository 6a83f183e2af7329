#include "kluft/blocks/open_joint.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <tuple>
#include <utility>

namespace kluft {

namespace {

// Of the size of the smaller block. Coordinates rounded to what a drawing shows are wrong by a few thousandths of it; an opening
// that is to be held or pressed inside is a good part of it.
constexpr double widest_gap = 0.05;
constexpr double widest_strip = 0.01;

/// The part of a covered side before one side of another block.
struct CoveringSide {
    CoveredPart part;
    double size = 0.0; ///< of the smaller block (m)
};

/// How wide what belongs to it is at most beside it (m).
double margin(const CoveringSide& each, double tolerance) {
    return (each.part.gap > tolerance ? widest_gap : widest_strip) * each.size;
}

/// Narrows the range of a parameter from 0 to 1 to where a linear function from `start` to `end` is within the limits.
void clip(double start, double end, double least, double most, std::pair<double, double>& range) {
    const double change = end - start;
    if (change == 0.0) {
        if (start < least || start > most) range = {1.0, 0.0};
        return;
    }
    const auto [first, last] = std::minmax({(least - start) / change, (most - start) / change});
    range = {std::max(range.first, first), std::min(range.second, last)};
}

void join(const CoveringSide& each, CoveringSide& group) {
    group.part.strips += std::max(0.0, each.part.from - group.part.to);
    group.part.to = std::max(group.part.to, each.part.to);
    group.size = std::min(group.size, each.size);
    if (each.part.gap > group.part.gap)
        std::tie(group.part.other, group.part.gap) = std::tie(each.part.other, each.part.gap);
}

std::optional<CoveringSide> covering(const SideOfBlock& side, const SideOfBlock& other,
                                     const std::vector<double>& sizes, double tolerance) {
    static const double least_cosine = std::cos(15.0 / 180.0 * std::numbers::pi);
    const double length = (side.end - side.start).norm();
    const Vec2 along = (side.end - side.start) / length;
    const Vec2 outward = right_normal(along);
    if (along.dot((other.end - other.start).normalized()) > -least_cosine) return std::nullopt;
    const double size = std::min(sizes[side.block], sizes[other.block]);
    const auto place = [&](const Vec2& p) { return std::pair(along.dot(p - side.start), outward.dot(p - side.start)); };
    const auto [s_start, t_start] = place(other.start);
    const auto [s_end, t_end] = place(other.end);
    std::pair<double, double> range{0.0, 1.0};
    clip(s_start, s_end, 0.0, length, range);
    clip(t_start, t_end, -2.0 * tolerance, reach_of_open_joints(size), range); // blocks touch within the tolerance
    if (range.first >= range.second) return std::nullopt;
    const auto between = [](double start, double end, double x) { return start + x * (end - start); };
    CoveringSide found;
    found.part.from = between(s_start, s_end, range.second); // the two sides run against each other
    found.part.to = between(s_start, s_end, range.first);
    found.part.other = other.block;
    found.part.gap = std::max({0.0, between(t_start, t_end, range.first), between(t_start, t_end, range.second)});
    found.size = size;
    if (found.part.to - found.part.from <= std::max(widest_strip * size, 4.0 * tolerance)) return std::nullopt;
    return found;
}

} // namespace

double reach_of_open_joints(double size) { return widest_gap * size; }

std::vector<CoveredPart> covered_parts(const std::vector<SideOfBlock>& sides, int s, const std::vector<int>& near,
                                       const std::vector<double>& sizes, double tolerance) {
    std::vector<CoveringSide> found;
    for (const int t : near) {
        if (sides[t].block == sides[s].block) continue;
        if (const auto part = covering(sides[s], sides[t], sizes, tolerance)) found.push_back(*part);
    }
    std::ranges::sort(
        found, {}, [](const CoveringSide& each) { return std::tuple(each.part.from, each.part.to, each.part.other); });
    std::vector<CoveringSide> groups;
    for (const CoveringSide& each : found) {
        const bool goes_on = !groups.empty() && each.part.from - groups.back().part.to <=
                                                    std::max(margin(each, tolerance), margin(groups.back(), tolerance));
        if (goes_on)
            join(each, groups.back());
        else
            groups.push_back(each);
    }
    const double length = (sides[s].end - sides[s].start).norm();
    std::vector<CoveredPart> parts;
    for (std::size_t i = 0; i < groups.size(); ++i) {
        const CoveredPart& own = groups[i].part;
        CoveredPart part = own;
        const double beside = margin(groups[i], tolerance);
        const double first = i > 0 ? groups[i - 1].part.to : 0.0;
        const double last = i + 1 < groups.size() ? groups[i + 1].part.from : length;
        const bool is_open = own.gap > tolerance;
        if (is_open || own.from - beside <= first) part.from = std::max(first, own.from - beside);
        if (is_open || own.to + beside >= last) part.to = std::min(last, own.to + beside);
        part.strips += (own.from - part.from) + (part.to - own.to);
        parts.push_back(part);
    }
    return parts;
}

} // namespace kluft
