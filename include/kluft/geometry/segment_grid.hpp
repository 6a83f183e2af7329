// Finds the segments near a place.
#pragma once

#include <utility>
#include <vector>

#include "kluft/geometry/polygon.hpp"

namespace kluft {

/// A uniform grid of about as many cells as there are segments; each cell lists the segments that pass through it.
class SegmentGrid {
public:
    using Segment = std::pair<Vec2, Vec2>;

    explicit SegmentGrid(std::vector<Segment> segments);

    /// Indices of all segments that have a point in `box`, ascending; and of some others.
    [[nodiscard]] std::vector<int> near(const Box& box) const;

    /// Distance from p to the nearest segment where that is at most `limit`, otherwise infinity (m).
    [[nodiscard]] double distance(const Vec2& p, double limit) const;

    /// The same, for many questions to one grid: `asked`, empty before the first of them, takes a mark for each segment, so
    /// that what lies in many cells of the box is no longer sorted as often.
    [[nodiscard]] std::vector<int> near(const Box& box, std::vector<char>& asked) const;

    [[nodiscard]] const Segment& segment(int i) const { return segments_[i]; }

private:
    template <class Visit> void visit_cells(const Box& box, const Visit& visit) const;
    [[nodiscard]] int column(double x) const;
    [[nodiscard]] int row(double y) const;

    std::vector<Segment> segments_;
    Vec2 lower_ = Vec2::Zero();
    double cell_ = 1.0;
    int n_x_ = 1;
    int n_y_ = 1;
    std::vector<std::vector<int>> cells_; ///< size n_x n_y, row by row
};

} // namespace kluft
