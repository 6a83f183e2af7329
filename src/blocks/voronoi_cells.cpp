#include "kluft/blocks/voronoi_cells.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>

#include <boost/polygon/voronoi.hpp>
#include <fmt/format.h>

#include "kluft/core/diagnostics.hpp"
#include "kluft/core/mixed_bits.hpp"

namespace kluft {

namespace {

__extension__ using Wide = __int128;

/// Units of length in a square's side.
constexpr int unit_bits = 16;
constexpr std::int64_t units = std::int64_t{1} << unit_bits;

/// A place on the plane in units of a/65536, counted from the first square of a window.
struct GridPoint {
    std::int64_t x = 0;
    std::int64_t y = 0;
};

GridPoint operator-(const GridPoint& a, const GridPoint& b) { return {a.x - b.x, a.y - b.y}; }
GridPoint operator+(const GridPoint& a, const GridPoint& b) { return {a.x + b.x, a.y + b.y}; }

Wide cross(const GridPoint& a, const GridPoint& b) { return Wide{a.x} * b.y - Wide{a.y} * b.x; }
Wide square(const GridPoint& a) { return Wide{a.x} * a.x + Wide{a.y} * a.y; }

/// The integer next to a quotient, ties upwards.
std::int64_t rounded_quotient(Wide numerator, Wide denominator) {
    if (denominator < 0) return rounded_quotient(-numerator, -denominator);
    const Wide twice = 2 * numerator + denominator;
    const Wide whole = twice / (2 * denominator);
    return static_cast<std::int64_t>(twice < 0 && whole * 2 * denominator != twice ? whole - 1 : whole);
}

/// Centre of the circle through three points that are not in a line.
GridPoint circumcentre(const GridPoint& a, const GridPoint& b, const GridPoint& c) {
    const GridPoint p = b - a;
    const GridPoint q = c - a;
    const Wide twice = 2 * cross(p, q);
    return a + GridPoint{rounded_quotient(square(p) * q.y - square(q) * p.y, twice),
                         rounded_quotient(square(q) * p.x - square(p) * q.x, twice)};
}

/// Of a polygon, given relative to a point inside it; that point where the area vanishes.
GridPoint centroid(const std::vector<GridPoint>& polygon) {
    Wide twice = 0;
    Wide moment_x = 0;
    Wide moment_y = 0;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
        const GridPoint& p = polygon[i];
        const GridPoint& q = polygon[(i + 1) % polygon.size()];
        const Wide part = cross(p, q);
        twice += part;
        moment_x += part * (p.x + q.x);
        moment_y += part * (p.y + q.y);
    }
    if (twice <= 0) return {};
    return {rounded_quotient(moment_x, 3 * twice), rounded_quotient(moment_y, 3 * twice)};
}

/// A rectangle of whole squares of the plane.
struct Window {
    std::int64_t first_column = 0;
    std::int64_t first_row = 0;
    int n_columns = 0;
    int n_rows = 0;
};

/// Coordinate of a random point about the middle of its square: the sum of three uniform numbers, each a square wide.
std::int64_t scattered(int square, std::uint64_t bits) {
    const auto fraction = [bits](int i) { return static_cast<std::int64_t>(bits >> (i * unit_bits)) & (units - 1); };
    return (square - 1) * units + fraction(1) + fraction(2) + fraction(3);
}

/// The random point of a square, relative to the window's first one.
GridPoint point_of_square(std::uint64_t seed, const Window& window, int column, int row) {
    const auto place = [](std::int64_t first, int i) { return static_cast<std::uint64_t>(first + i); };
    std::uint64_t bits = mixed_bits(mixed_bits(seed) ^ place(window.first_column, column));
    bits = mixed_bits(bits ^ place(window.first_row, row));
    return {scattered(column, bits), scattered(row, mixed_bits(bits))};
}

std::vector<GridPoint> random_points(std::uint64_t seed, const Window& window) {
    std::vector<GridPoint> points;
    points.reserve(static_cast<std::size_t>(window.n_columns) * window.n_rows);
    for (int row = 0; row < window.n_rows; ++row) {
        for (int column = 0; column < window.n_columns; ++column)
            points.push_back(point_of_square(seed, window, column, row));
    }
    return points;
}

using Diagram = boost::polygon::voronoi_diagram<double>;

/// Which cells are neighbours and which meet where, by exact predicates on integer coordinates.
void construct(Diagram& diagram, const std::vector<GridPoint>& points, const Window& window) {
    using Point = boost::polygon::point_data<std::int32_t>;
    const std::int64_t middle_x = window.n_columns / 2 * units; // 32 bits with a sign reach both sides of it
    const std::int64_t middle_y = window.n_rows / 2 * units;
    std::vector<Point> sites;
    sites.reserve(points.size());
    for (const GridPoint& p : points)
        sites.emplace_back(static_cast<std::int32_t>(p.x - middle_x), static_cast<std::int32_t>(p.y - middle_y));
    boost::polygon::construct_voronoi(sites.begin(), sites.end(), &diagram);
}

int point_of(const Diagram::edge_type& edge) { return static_cast<int>(edge.cell()->source_index()); }

/// Where cells meet, in the order of the diagram's vertices.
std::vector<GridPoint> vertices_of(const Diagram& diagram, const std::vector<GridPoint>& points) {
    std::vector<GridPoint> vertices;
    vertices.reserve(diagram.num_vertices());
    for (const auto& vertex : diagram.vertices()) {
        const Diagram::edge_type& edge = *vertex.incident_edge();
        vertices.push_back(circumcentre(points[point_of(edge)], points[point_of(*edge.twin())],
                                        points[point_of(*edge.prev()->twin())]));
    }
    return vertices;
}

std::size_t start_of(const Diagram::edge_type& edge, const Diagram& diagram) {
    return static_cast<std::size_t>(edge.vertex0() - diagram.vertices().data());
}

/// Centroid of a cell relative to its point; zero for a cell without an end.
GridPoint centroid_of(const Diagram::cell_type& cell, const GridPoint& point, const Diagram& diagram,
                      const std::vector<GridPoint>& vertices) {
    std::vector<GridPoint> corners;
    const Diagram::edge_type* edge = cell.incident_edge();
    do {
        if (edge->is_infinite()) return {};
        corners.push_back(vertices[start_of(*edge, diagram)] - point);
        edge = edge->next();
    } while (edge != cell.incident_edge());
    return centroid(corners);
}

void relax(std::vector<GridPoint>& points, const Window& window) {
    Diagram diagram;
    construct(diagram, points, window);
    const std::vector<GridPoint> vertices = vertices_of(diagram, points);
    for (const auto& cell : diagram.cells()) {
        GridPoint& point = points[cell.source_index()];
        point = point + centroid_of(cell, point, diagram, vertices);
    }
}

double side_of_squares(double spacing) { return spacing * std::sqrt(0.5 * std::numbers::sqrt3); }

/// Rows of squares between the box and what a pass may have got wrong for want of cells beyond the window. No place is
/// farther than 2 sqrt(2) a from the point of its own square, so that a pass carries an error by less than 6 a.
int margin(int relaxation) { return 4 + 6 * (relaxation + 1); }

void check(const VoronoiCells& cells, const Box& box) {
    const auto refuse = [](const char* key, const std::string& message) {
        throw InputError(fmt::format("geometry.tessellation.voronoi.{}: {}", key, message));
    };
    constexpr double farthest = 1e9;
    constexpr double most_in_a_row = 6e4;
    constexpr double most_in_box = 5.0 * most_cells; // of which the body may fill a part
    const double d = cells.spacing;
    if (!(d > 0.0) || !std::isfinite(d)) refuse("spacing", fmt::format("expected a length above 0, found {}", d));
    if (cells.relaxation < 0 || cells.relaxation > most_relaxation)
        refuse("relaxation", fmt::format("expected 0 to {} passes, found {}", most_relaxation, cells.relaxation));
    if (!cells.offset.allFinite() || cells.offset.cwiseAbs().maxCoeff() > farthest * d)
        refuse("offset", fmt::format("expected at most {:.0g} spacings, found ({}, {}) m", farthest, cells.offset.x(),
                                     cells.offset.y()));
    const Vec2 n = (box.upper - box.lower) / side_of_squares(d);
    if (n.maxCoeff() > most_in_a_row || n.prod() > most_in_box)
        refuse("spacing", fmt::format("{} m makes {:.2g} by {:.2g} cells, more than {:.0g} in a row or {:.0g} in one "
                                      "scene",
                                      d, n.x(), n.y(), most_in_a_row, most_in_box));
}

Window window_on(const VoronoiCells& cells, const Box& box) {
    const double a = side_of_squares(cells.spacing);
    const int around = margin(cells.relaxation);
    const auto first = [&](double lower, double offset) {
        return static_cast<std::int64_t>(std::floor((lower - offset) / a)) - around;
    };
    const auto count = [&](double lower, double upper) {
        return static_cast<int>(std::ceil((upper - lower) / a)) + 1 + 2 * around;
    };
    return {first(box.lower.x(), cells.offset.x()), first(box.lower.y(), cells.offset.y()),
            count(box.lower.x(), box.upper.x()), count(box.lower.y(), box.upper.y())};
}

} // namespace

double voronoi_reach(const VoronoiCells& cells) { return 2.0 * std::numbers::sqrt2 * side_of_squares(cells.spacing); }

VoronoiNet voronoi_net(const VoronoiCells& cells, const Box& box) {
    check(cells, box);
    const Window window = window_on(cells, box);
    std::vector<GridPoint> points = random_points(cells.seed, window);
    for (int pass = 0; pass < cells.relaxation; ++pass) relax(points, window);

    const double unit = side_of_squares(cells.spacing) / static_cast<double>(units);
    const auto position = [&](const GridPoint& p) -> Vec2 {
        return cells.offset + unit * Vec2(static_cast<double>(window.first_column * units + p.x),
                                          static_cast<double>(window.first_row * units + p.y));
    };
    const Vec2 reach = Vec2::Constant(4.0 * cells.spacing);
    const Box near{box.lower - reach, box.upper + reach};
    VoronoiNet net;
    std::vector<int> number(points.size(), -1);
    for (std::size_t i = 0; i < points.size(); ++i) {
        const Vec2 at = position(points[i]);
        if ((at.array() < near.lower.array()).any() || (at.array() > near.upper.array()).any()) continue;
        number[i] = static_cast<int>(net.points.size());
        net.points.push_back(at);
    }
    Diagram diagram;
    construct(diagram, points, window);
    const std::vector<GridPoint> vertices = vertices_of(diagram, points);
    for (const auto& edge : diagram.edges()) {
        const int left = number[point_of(edge)];
        const int right = number[point_of(*edge.twin())];
        if (edge.is_infinite() || left < 0 || right < 0 || left > right) continue;
        net.edges.push_back({position(vertices[start_of(edge, diagram)]),
                             position(vertices[start_of(*edge.twin(), diagram)]), left, right});
    }
    return net;
}

std::vector<std::pair<Vec2, Vec2>> voronoi_edges(const VoronoiCells& cells, const Box& box,
                                                 const std::function<bool(const Vec2&)>& keeps) {
    const VoronoiNet net = voronoi_net(cells, box);
    std::vector<char> kept;
    kept.reserve(net.points.size());
    for (const Vec2& point : net.points) kept.push_back(keeps(point) ? 1 : 0);
    std::vector<std::pair<Vec2, Vec2>> edges;
    for (const VoronoiNet::Edge& edge : net.edges) {
        if (kept[edge.left] == 0 && kept[edge.right] == 0) continue;
        const Box around = bounding_box({edge.start, edge.end});
        const bool meets =
            (around.lower.array() <= box.upper.array()).all() && (box.lower.array() <= around.upper.array()).all();
        if (meets) edges.emplace_back(edge.start, edge.end);
    }
    return edges;
}

} // namespace kluft
