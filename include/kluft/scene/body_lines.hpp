// The lines of a body, fractures and sides, and what lies between the end of one and the next.
#pragma once

#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "kluft/blocks/block_cutter.hpp"
#include "kluft/constitutive/material.hpp"
#include "kluft/geometry/segment_grid.hpp"

namespace kluft {

/// A fracture, or a side of the body or of a hole.
struct BodyLine {
    std::vector<Vec2> points; ///< none of a fracture that is left out
    std::string name;
    double graded = 0.0; ///< side of triangles along it, 0 where the scene gives none (m)
    bool is_open = true; ///< not a potential crack
};

/// Fractures first, in their order; then all sides. Of `types` the kind counts.
[[nodiscard]] std::vector<BodyLine> body_lines(const GeometrySpec& geometry, const CutReport& report,
                                               const std::vector<InterfaceType>& types);

/// Whether a point lies in the domain and in none of its holes.
[[nodiscard]] bool is_in_body(const Vec2& p, const GeometrySpec& geometry);

/// Rock between the end of an open fracture and another line.
struct RockBridge {
    int line = -1; ///< at the end of the bridge
    double length = std::numeric_limits<double>::infinity();
};

/// The lines with a grid of their segments. Lines that are nearer to each other than the resolution (m) are joined there.
class LineSearch {
public:
    LineSearch(std::vector<BodyLine> lines, double resolution);

    [[nodiscard]] const BodyLine& line(int i) const { return lines_[static_cast<std::size_t>(i)]; }

    /// The shortest one from an end of the line `own` that is shorter than a limit (m); none where the end lies on another line, and
    /// not where the lines themselves go round the rock on a way three times as long or less.
    [[nodiscard]] std::optional<RockBridge> bridge_at(const Vec2& end, int own, double limit) const;

private:
    /// Segments of other lines nearer than `reach` with their distances, ascending.
    [[nodiscard]] std::vector<std::pair<double, int>> nearest(const Vec2& p, int own, double reach) const;
    /// Where a line meets others, not farther from p than `reach`.
    [[nodiscard]] std::vector<Vec2> junctions_of(int own, const Vec2& p, double reach) const;
    std::vector<SegmentGrid::Segment> segments();

    std::vector<BodyLine> lines_;
    std::vector<int> line_of_; ///< of each segment
    double resolution_ = 0.0;
    SegmentGrid grid_;
};

} // namespace kluft
