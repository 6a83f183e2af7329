#include "kluft/geometry/segment_grid.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "kluft/geometry/predicates.hpp"

namespace kluft {

SegmentGrid::SegmentGrid(std::vector<Segment> segments) : segments_(std::move(segments)) {
    std::vector<Vec2> ends;
    for (const auto& [a, b] : segments_) {
        ends.push_back(a);
        ends.push_back(b);
    }
    const Box box = ends.empty() ? Box{} : bounding_box(ends);
    const Vec2 extent = box.upper - box.lower;
    const double n = static_cast<double>(std::max<std::size_t>(segments_.size(), 1));
    lower_ = box.lower;
    cell_ = std::max({std::sqrt(extent.x() * extent.y() / n), extent.maxCoeff() / n, extent.maxCoeff() / 4096.0});
    if (!(cell_ > 0.0)) cell_ = 1.0;
    n_x_ = static_cast<int>(extent.x() / cell_) + 1;
    n_y_ = static_cast<int>(extent.y() / cell_) + 1;
    cells_.resize(static_cast<std::size_t>(n_x_) * n_y_);
    for (int i = 0; i < static_cast<int>(segments_.size()); ++i) {
        auto [a, b] = segments_[i];
        if (a.y() > b.y()) std::swap(a, b);
        const int first = row(a.y());
        const int last = row(b.y());
        for (int r = first; r <= last; ++r) {
            // The part of the segment in this row, and one column more on each side for rounding.
            const double rise = b.y() - a.y();
            const auto x_at = [&a = a, &b = b, rise](double y) {
                const double t = rise > 0.0 ? std::clamp((y - a.y()) / rise, 0.0, 1.0) : 0.0;
                return a.x() + t * (b.x() - a.x());
            };
            const double from = first == last ? a.x() : x_at(lower_.y() + r * cell_);
            const double to = first == last ? b.x() : x_at(lower_.y() + (r + 1) * cell_);
            const int left = std::max(0, column(std::min(from, to)) - 1);
            const int right = std::min(n_x_ - 1, column(std::max(from, to)) + 1);
            for (int c = left; c <= right; ++c) cells_[static_cast<std::size_t>(r) * n_x_ + c].push_back(i);
        }
    }
}

int SegmentGrid::column(double x) const {
    return static_cast<int>(std::clamp((x - lower_.x()) / cell_, 0.0, n_x_ - 1.0));
}

int SegmentGrid::row(double y) const { return static_cast<int>(std::clamp((y - lower_.y()) / cell_, 0.0, n_y_ - 1.0)); }

template <class Visit> void SegmentGrid::visit_cells(const Box& box, const Visit& visit) const {
    const int first_row = std::max(0, row(box.lower.y()) - 1);
    const int last_row = std::min(n_y_ - 1, row(box.upper.y()) + 1);
    for (int r = first_row; r <= last_row; ++r) {
        for (int c = column(box.lower.x()); c <= column(box.upper.x()); ++c)
            visit(cells_[static_cast<std::size_t>(r) * n_x_ + c]);
    }
}

std::vector<int> SegmentGrid::near(const Box& box) const {
    std::vector<int> found;
    visit_cells(box, [&found](const std::vector<int>& cell) { found.insert(found.end(), cell.begin(), cell.end()); });
    std::sort(found.begin(), found.end());
    found.erase(std::unique(found.begin(), found.end()), found.end());
    return found;
}

std::vector<int> SegmentGrid::near(const Box& box, std::vector<char>& asked) const {
    asked.resize(segments_.size(), 0);
    std::vector<int> found;
    visit_cells(box, [&](const std::vector<int>& cell) {
        for (const int i : cell) {
            if (asked[i] != 0) continue;
            asked[i] = 1;
            found.push_back(i);
        }
    });
    for (const int i : found) asked[i] = 0;
    std::sort(found.begin(), found.end());
    return found;
}

double SegmentGrid::distance(const Vec2& p, double limit) const {
    double least = std::numeric_limits<double>::infinity();
    const auto look = [&](int r, int c) {
        for (const int i : cells_[static_cast<std::size_t>(r) * n_x_ + c]) {
            const double away = distance_to_segment(p, segments_[i].first, segments_[i].second);
            if (away <= limit) least = std::min(least, away);
        }
    };
    // Cells in squares about that of the point q of the grid's box that is nearest to p. What lies beyond the square of
    // number k is farther than k cells from q, and at a right angle or more to p as seen from there.
    const Vec2 upper = lower_ + cell_ * Vec2(n_x_, n_y_);
    const double to_box = (p - p.cwiseMax(lower_).cwiseMin(upper)).norm();
    const int middle_column = column(p.x());
    const int middle_row = row(p.y());
    for (int k = 0; k <= std::max(n_x_, n_y_); ++k) {
        const double beyond = std::hypot(to_box, std::max(0, k - 2) * cell_); // one cell less for rounding
        if (beyond > std::min(limit, least)) break;
        for (int r = std::max(0, middle_row - k); r <= std::min(n_y_ - 1, middle_row + k); ++r) {
            const bool whole_row = r == middle_row - k || r == middle_row + k;
            const int step = whole_row || k == 0 ? 1 : 2 * k;
            for (int c = middle_column - k; c <= middle_column + k; c += step)
                if (c >= 0 && c < n_x_) look(r, c);
        }
    }
    return least;
}

} // namespace kluft
