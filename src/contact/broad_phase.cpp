#include "kluft/contact/broad_phase.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace kluft {

namespace {

struct CellEntry {
    std::int64_t cell;
    int box;
};

bool meet(const BlockBox& a, const BlockBox& b, double distance) {
    return ((a.lower - b.upper).array() <= distance).all() && ((b.lower - a.upper).array() <= distance).all();
}

/// Side of the grid's cells: the mean box, grown; a body of very unequal blocks only makes lists longer.
double cell_size(const std::vector<BlockBox>& boxes, double reach) {
    double sum = 0.0;
    for (const BlockBox& box : boxes) sum += (box.upper - box.lower).maxCoeff();
    return std::max(sum / static_cast<double>(boxes.size()) + 2.0 * reach, 1e-300);
}

std::vector<CellEntry> entries_by_cell(const std::vector<BlockBox>& boxes, double reach) {
    Vec2 lower = boxes.front().lower;
    Vec2 upper = boxes.front().upper;
    for (const BlockBox& box : boxes) {
        lower = lower.cwiseMin(box.lower);
        upper = upper.cwiseMax(box.upper);
    }
    lower.array() -= reach;
    const double cell = cell_size(boxes, reach);
    const auto column = [&](double x) { return static_cast<std::int64_t>(std::floor((x - lower.x()) / cell)); };
    const auto row = [&](double y) { return static_cast<std::int64_t>(std::floor((y - lower.y()) / cell)); };
    const std::int64_t n_columns = column(upper.x() + reach) + 1;

    std::vector<CellEntry> entries;
    entries.reserve(4 * boxes.size());
    for (int i = 0; i < static_cast<int>(boxes.size()); ++i) {
        const BlockBox& box = boxes[i];
        for (auto r = row(box.lower.y() - reach); r <= row(box.upper.y() + reach); ++r) {
            for (auto c = column(box.lower.x() - reach); c <= column(box.upper.x() + reach); ++c) {
                entries.push_back({r * n_columns + c, i});
            }
        }
    }
    std::sort(entries.begin(), entries.end(), [](const CellEntry& a, const CellEntry& b) {
        return a.cell != b.cell ? a.cell < b.cell : a.box < b.box;
    });
    return entries;
}

} // namespace

std::vector<std::pair<int, int>> meeting_boxes(const std::vector<BlockBox>& boxes, double reach) {
    std::vector<std::pair<int, int>> pairs;
    if (boxes.empty()) return pairs;
    const auto entries = entries_by_cell(boxes, reach);
    for (std::size_t first = 0; first < entries.size();) {
        std::size_t last = first;
        while (last < entries.size() && entries[last].cell == entries[first].cell) ++last;
        for (std::size_t i = first; i < last; ++i) {
            for (std::size_t j = i + 1; j < last; ++j) {
                const BlockBox& a = boxes[entries[i].box];
                const BlockBox& b = boxes[entries[j].box];
                if (meet(a, b, 2.0 * reach)) pairs.emplace_back(std::min(a.block, b.block), std::max(a.block, b.block));
            }
        }
        first = last;
    }
    std::sort(pairs.begin(), pairs.end());
    pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
    return pairs;
}

} // namespace kluft
