#include "kluft/blocks/triangle_net.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <numbers>
#include <optional>
#include <set>
#include <stdexcept>
#include <tuple>

// With sanitizers the compiler takes empty members of the kernel's for uninitialised ones.
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wmaybe-uninitialized"
#pragma GCC diagnostic ignored "-Wconversion"
#include <CGAL/Constrained_Delaunay_triangulation_2.h>
#include <CGAL/Delaunay_mesh_face_base_2.h>
#include <CGAL/Delaunay_mesh_size_criteria_2.h>
#include <CGAL/Delaunay_mesh_vertex_base_2.h>
#include <CGAL/Delaunay_mesher_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/lloyd_optimize_mesh_2.h>
#pragma GCC diagnostic pop

#include <fmt/format.h>

#include "kluft/core/diagnostics.hpp"
#include "kluft/core/mixed_bits.hpp"
#include "kluft/core/place_text.hpp"

namespace kluft {

namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using VertexBase = CGAL::Delaunay_mesh_vertex_base_2<Kernel>;
using FaceBase = CGAL::Delaunay_mesh_face_base_2<Kernel>;
using Structure = CGAL::Triangulation_data_structure_2<VertexBase, FaceBase>;
using Triangulation = CGAL::Constrained_Delaunay_triangulation_2<Kernel, Structure, CGAL::Exact_predicates_tag>;
using Criteria = CGAL::Delaunay_mesh_size_criteria_2<Triangulation>;
using Vertex = Triangulation::Vertex_handle;
using Face = Triangulation::Face_handle;

Kernel::Point_2 to_cgal(const Vec2& p) { return {p.x(), p.y()}; }
Vec2 from_cgal(const Kernel::Point_2& p) { return {p.x(), p.y()}; }
Vec2 place_of(const Vertex& vertex) { return from_cgal(vertex->point()); }

/// A line of the frame as the triangulation has it; `left` and `right` are faces of the map.
struct Line {
    Vertex start;
    Vertex end;
    int source = 0;
    int left = PlanarMap::outside;
    int right = PlanarMap::outside;
};

/// Random numbers in [0, 1) that follow from a seed, from the upper 53 bits.
class RandomNumbers {
public:
    explicit RandomNumbers(std::uint64_t seed) : state_(mixed_bits(seed)) {}

    double next() {
        state_ = mixed_bits(state_);
        return static_cast<double>(state_ >> 11U) * 0x1.0p-53;
    }

private:
    std::uint64_t state_;
};

/// Points with a circle about each, found by place.
class Circles {
public:
    Circles(const Box& box, double cell) : lower_(box.lower), cell_(cell) {
        const Vec2 n = ((box.upper - box.lower) / cell).array().ceil() + 1.0;
        n_columns_ = static_cast<int>(n.x());
        n_rows_ = static_cast<int>(n.y());
        cells_.resize(static_cast<std::size_t>(n_columns_) * n_rows_);
    }

    void add(const Vec2& place, double radius) {
        cells_[index(column(place.x()), row(place.y()))].emplace_back(place, radius);
        largest_ = std::max(largest_, radius);
    }

    /// Whether p lies nearer to a point than the sum of both radii, times `scale`.
    [[nodiscard]] bool covers(const Vec2& p, double radius, double scale) const {
        const double reach = scale * (radius + largest_);
        for (int j = row(p.y() - reach); j <= row(p.y() + reach); ++j) {
            for (int i = column(p.x() - reach); i <= column(p.x() + reach); ++i) {
                for (const auto& [place, other] : cells_[index(i, j)]) {
                    const double apart = scale * (radius + other);
                    if ((place - p).squaredNorm() < apart * apart) return true;
                }
            }
        }
        return false;
    }

private:
    [[nodiscard]] int column(double x) const {
        return std::clamp(static_cast<int>(std::floor((x - lower_.x()) / cell_)), 0, n_columns_ - 1);
    }
    [[nodiscard]] int row(double y) const {
        return std::clamp(static_cast<int>(std::floor((y - lower_.y()) / cell_)), 0, n_rows_ - 1);
    }
    [[nodiscard]] std::size_t index(int i, int j) const { return static_cast<std::size_t>(j) * n_columns_ + i; }

    Vec2 lower_;
    double cell_;
    int n_columns_ = 1;
    int n_rows_ = 1;
    double largest_ = 0.0;
    std::vector<std::vector<std::pair<Vec2, double>>> cells_;
};

std::vector<Line> lines_of(const TriangleFrame& frame, Triangulation& triangulation) {
    const PlanarMap& map = *frame.map;
    std::vector<Vertex> vertices(map.positions.size());
    const auto vertex = [&](int v) {
        if (vertices[v] == Vertex()) vertices[v] = triangulation.insert(to_cgal(map.positions[v]));
        return vertices[v];
    };
    std::vector<Line> lines;
    for (int h = 0; h < 2 * map.n_edges(); h += 2) {
        if (map.alive[PlanarMap::edge_of(h)] == 0) continue;
        lines.push_back({vertex(map.start(h)), vertex(map.end(h)), map.source(h), map.face(h), map.face(h + 1)});
    }
    for (const SourceSegment& piece : frame.free_pieces)
        lines.push_back({triangulation.insert(to_cgal(piece.a)), triangulation.insert(to_cgal(piece.b)), piece.source});
    return lines;
}

Box box_of_living_edges(const PlanarMap& map) {
    std::vector<Vec2> ends;
    for (int h = 0; h < 2 * map.n_edges(); ++h)
        if (map.alive[PlanarMap::edge_of(h)] != 0) ends.push_back(map.positions[map.start(h)]);
    return bounding_box(ends);
}

/// Cuts a line into equal pieces about as long as the side of the net in its middle. Returns their middles with half
/// their length as radius.
std::vector<std::pair<Vec2, double>> insert_in_pieces(const Line& line, const TriangleSize& size, bool cut,
                                                      Triangulation& triangulation) {
    const Vec2 a = place_of(line.start);
    const Vec2 b = place_of(line.end);
    const double length = (b - a).norm();
    std::vector<std::pair<Vec2, double>> middles;
    Vertex before = line.start;
    double done = 0.0;
    while (done < length) {
        // The side at the place that a piece of the side here would reach with its middle; the rest in equal parts.
        const double here = size.at(a + done / length * (b - a));
        const double there = size.at(a + std::min(1.0, (done + 0.5 * here) / length) * (b - a));
        const int n = cut ? std::max(1, static_cast<int>(std::lround((length - done) / there))) : 1;
        const double next = n == 1 ? length : done + (length - done) / n;
        const Vertex after = n == 1 ? line.end : triangulation.insert(to_cgal(a + next / length * (b - a)));
        triangulation.insert_constraint(before, after);
        middles.emplace_back(a + 0.5 * (done + next) / length * (b - a), 0.5 * (next - done));
        before = after;
        done = next;
    }
    return middles;
}

/// The pieces of a line, in order: the triangulation may have cut it further.
template <typename Use> void for_each_piece(const Triangulation& triangulation, const Line& line, const Use& use) {
    Vertex at = line.start;
    const Vec2 end = place_of(line.end);
    while (at != line.end) {
        const Vec2 ahead = (end - place_of(at)).normalized();
        Vertex best;
        double straightest = -1.0;
        auto edge = triangulation.incident_edges(at);
        const auto first = edge;
        do {
            const Vertex other = edge->first->vertex(Triangulation::cw(edge->second)) == at
                                     ? edge->first->vertex(Triangulation::ccw(edge->second))
                                     : edge->first->vertex(Triangulation::cw(edge->second));
            if (triangulation.is_infinite(other) || !triangulation.is_constrained({edge->first, edge->second}))
                continue;
            const double cosine = ahead.dot((place_of(other) - place_of(at)).normalized());
            if (cosine > straightest) {
                straightest = cosine;
                best = other;
            }
        } while (++edge != first);
        if (best == Vertex()) throw std::logic_error("a line of the net has lost its pieces");
        use(at, best);
        at = best;
    }
}

/// The face of the map in which each finite face of the triangulation lies. Free pieces may enclose some of it.
std::map<Face, int> faces_by_place(const Triangulation& triangulation, const std::vector<Line>& lines) {
    std::map<Face, int> place;
    std::vector<Face> stack;
    std::set<std::pair<Vertex, Vertex>> borders;
    const auto start = [&](const Vertex& a, const Vertex& b, int face) {
        Face on_left;
        int index = 0;
        if (face == PlanarMap::outside || !triangulation.is_edge(a, b, on_left, index)) return;
        if (on_left->vertex(Triangulation::ccw(index)) != a) on_left = on_left->neighbor(index);
        if (!triangulation.is_infinite(on_left) && place.emplace(on_left, face).second) stack.push_back(on_left);
    };
    for (const Line& line : lines) {
        if (line.left == line.right) continue;
        for_each_piece(triangulation, line, [&](const Vertex& a, const Vertex& b) {
            borders.insert(std::minmax(a, b));
            start(a, b, line.left);
            start(b, a, line.right);
        });
    }
    const auto is_border = [&borders](const Face& face, int i) {
        return borders.contains(std::minmax(face->vertex(Triangulation::ccw(i)), face->vertex(Triangulation::cw(i))));
    };
    while (!stack.empty()) {
        const Face face = stack.back();
        stack.pop_back();
        for (int i = 0; i < 3; ++i) {
            const Face across = face->neighbor(i);
            if (triangulation.is_infinite(across) || is_border(face, i)) continue;
            if (place.emplace(across, place.at(face)).second) stack.push_back(across);
        }
    }
    return place;
}

struct Corners {
    Vec2 a;
    Vec2 b;
    Vec2 c;
    [[nodiscard]] double area() const { return 0.5 * cross(b - a, c - a); }
    [[nodiscard]] Vec2 centroid() const { return (a + b + c) / 3.0; }
};

Corners corners_of(const Face& face) {
    return {place_of(face->vertex(0)), place_of(face->vertex(1)), place_of(face->vertex(2))};
}

/// What the net fills, as triangles in the triangulation's order, and a point in each face that it does not fill.
struct Filled {
    std::vector<Corners> triangles;
    std::vector<Kernel::Point_2> holes;
};

/// A point in each hole of the domain: in the largest triangle of each part that has no place in the map and that lines
/// separate from infinity.
std::vector<Kernel::Point_2> points_in_holes(const Triangulation& triangulation, const std::map<Face, int>& place) {
    std::vector<Kernel::Point_2> points;
    std::set<Face> seen;
    std::vector<Face> stack;
    for (auto first = triangulation.finite_faces_begin(); first != triangulation.finite_faces_end(); ++first) {
        if (place.contains(first) || !seen.insert(first).second) continue;
        bool reaches_infinity = false;
        double largest = 0.0;
        Vec2 inside = Vec2::Zero();
        stack.push_back(first);
        while (!stack.empty()) {
            const Face face = stack.back();
            stack.pop_back();
            const Corners corners = corners_of(face);
            if (corners.area() > largest) std::tie(largest, inside) = std::pair(corners.area(), corners.centroid());
            for (int i = 0; i < 3; ++i) {
                const Face across = face->neighbor(i);
                if (triangulation.is_constrained({face, i})) continue;
                if (triangulation.is_infinite(across))
                    reaches_infinity = true;
                else if (seen.insert(across).second)
                    stack.push_back(across);
            }
        }
        if (!reaches_infinity && largest > 0.0) points.push_back(to_cgal(inside));
    }
    return points;
}

Filled filled_part(const Triangulation& triangulation, const std::vector<Line>& lines, const TriangleFrame& frame) {
    struct Part {
        double in_region = 0.0; ///< area less that beyond the region
        double largest = 0.0;
        Vec2 inside = Vec2::Zero();
    };
    const std::map<Face, int> place = faces_by_place(triangulation, lines);
    std::vector<Part> parts(frame.map->n_faces());
    const auto face_of = [&place](const Face& face) {
        const auto found = place.find(face);
        return found == place.end() ? PlanarMap::outside : found->second;
    };
    Filled filled;
    filled.holes = points_in_holes(triangulation, place);
    for (auto face = triangulation.finite_faces_begin(); face != triangulation.finite_faces_end(); ++face) {
        const Corners corners = corners_of(face);
        const Vec2 middle = corners.centroid();
        const int in = face_of(face);
        if (in == PlanarMap::outside) continue;
        const bool in_region = frame.region.empty() || contains(frame.region, middle);
        parts[in].in_region += in_region ? corners.area() : -corners.area();
        if (corners.area() > parts[in].largest) {
            parts[in].largest = corners.area();
            parts[in].inside = middle;
        }
    }
    for (const Part& part : parts)
        if (part.largest > 0.0 && part.in_region <= 0.0) filled.holes.push_back(to_cgal(part.inside));
    for (auto face = triangulation.finite_faces_begin(); face != triangulation.finite_faces_end(); ++face) {
        const int in = face_of(face);
        if (in != PlanarMap::outside && parts[in].in_region > 0.0) filled.triangles.push_back(corners_of(face));
    }
    return filled;
}

/// What the side of a net is at least, cell by cell of a grid over the body: where it is large, most random places are
/// turned down, for which this is enough to know.
class LeastSides {
public:
    LeastSides(const std::vector<Corners>& triangles, const TriangleSize& size) {
        std::vector<Vec2> corners;
        for (const Corners& t : triangles) corners.insert(corners.end(), {t.a, t.b, t.c});
        const Box box = bounding_box(corners);
        lower_ = box.lower;
        cell_ = (box.upper - box.lower).maxCoeff() / n_cells;
        const double away = size.growth() * std::numbers::sqrt2 / 2.0 * cell_;
        constexpr double rounding = 1e-6;
        least_.reserve(static_cast<std::size_t>(n_cells) * n_cells);
        for (int j = 0; j < n_cells; ++j) {
            for (int i = 0; i < n_cells; ++i) {
                const Vec2 middle = lower_ + cell_ * Vec2(i + 0.5, j + 0.5);
                least_.push_back((1.0 - rounding) * (size.at(middle) - away));
            }
        }
    }

    [[nodiscard]] double at(const Vec2& place) const {
        const Vec2 cell = (place - lower_) / cell_;
        const int i = std::clamp(static_cast<int>(cell.x()), 0, n_cells - 1);
        const int j = std::clamp(static_cast<int>(cell.y()), 0, n_cells - 1);
        return least_[static_cast<std::size_t>(j) * n_cells + i];
    }

private:
    static constexpr int n_cells = 256; ///< in each direction
    Vec2 lower_ = Vec2::Zero();
    double cell_ = 1.0;
    std::vector<double> least_;
};

/// Random places in triangles, as dense as the net is to be.
class Darts {
public:
    Darts(const std::vector<Corners>& triangles, const TriangleSize& size, std::uint64_t seed)
        : triangles_(triangles), size_(size), random_(seed) {
        if (size.is_graded()) least_.emplace(triangles, size);
        double sum = 0.0;
        for (const Corners& triangle : triangles) area_up_to_.push_back(sum += triangle.area());
        smallest_ = size.largest();
        for (const Corners& t : triangles) {
            for (const Vec2& p : {t.a, t.b, t.c}) smallest_ = std::min(smallest_, size.at(p));
        }
    }

    Vec2 next() {
        while (true) {
            const Vec2 place = anywhere();
            const double least = least_ ? least_->at(place) : 0.0;
            if (least > smallest_) {
                const double most = smallest_ / least;
                const double share = random_.next();
                if (share >= most * most) continue;
                const double ratio = smallest_ / size_.at(place);
                if (share < ratio * ratio) return place;
                continue;
            }
            const double ratio = smallest_ / size_.at(place);
            if (ratio >= 1.0 || random_.next() < ratio * ratio) return place;
        }
    }

    /// Triangles that the mean area at each place asks for, from the mean of 1/a^2 over random places.
    double triangles_asked_for() {
        constexpr int n_samples = 20000;
        double sum = 0.0;
        for (int i = 0; i < n_samples; ++i) sum += 1.0 / triangle_area(size_.at(anywhere()));
        return area_up_to_.back() * sum / n_samples;
    }

private:
    Vec2 anywhere() {
        const double area = random_.next() * area_up_to_.back();
        const auto at = std::upper_bound(area_up_to_.begin(), area_up_to_.end(), area) - area_up_to_.begin();
        const Corners& t = triangles_[std::min<std::size_t>(at, triangles_.size() - 1)];
        double u = random_.next();
        double v = random_.next();
        if (u + v > 1.0) std::tie(u, v) = std::pair(1.0 - u, 1.0 - v);
        return t.a + u * (t.b - t.a) + v * (t.c - t.a);
    }

    const std::vector<Corners>& triangles_;
    const TriangleSize& size_;
    RandomNumbers random_;
    std::optional<LeastSides> least_;
    std::vector<double> area_up_to_;
    double smallest_ = 0.0;
};

/// Throws points into the filled part until there are `count`, nearer to each other the longer it takes.
std::vector<Vec2> scattered_points(int count, Darts& darts, const TriangleSize& size, Circles& circles) {
    constexpr double first_distance = 0.8; // in sides
    constexpr double shrinking = 0.96;
    constexpr int tries_per_point = 12;
    std::vector<Vec2> points;
    double distance = first_distance;
    int tries = 0;
    while (static_cast<int>(points.size()) < count) {
        const Vec2 place = darts.next();
        const double radius = 0.5 * size.at(place);
        if (!circles.covers(place, radius, distance)) {
            points.push_back(place);
            circles.add(place, radius);
        } else if (++tries > tries_per_point * (count - static_cast<int>(points.size()))) {
            distance *= shrinking;
            tries = 0;
        }
    }
    return points;
}

/// Adds points until no angle is too small. Lines that lie very close to each other ask for many.
void refine(Triangulation& triangulation, const std::vector<Kernel::Point_2>& holes, const TriangleFrame& frame) {
    constexpr double bound = 0.125; // on 1/(4 B^2), with B the ratio of circumradius to shortest edge
    const std::size_t most = 20 * triangulation.number_of_vertices() + 10000;
    CGAL::Delaunay_mesher_2<Triangulation, Criteria> mesher(triangulation, Criteria(bound, 0.0));
    mesher.set_seeds(holes.begin(), holes.end());
    mesher.init();
    while (!mesher.is_refinement_done()) {
        mesher.step_by_step_refine_mesh();
        if (triangulation.number_of_vertices() <= most) continue;
        const Vec2 last = frame.origin + place_of(std::prev(triangulation.finite_vertices_end()));
        throw InputError(fmt::format("{}: lines lie so close to each other that triangles without small angles are too "
                                     "many, at about {}",
                                     frame.places.net, place_text(last)));
    }
}

void relax(Triangulation& triangulation, const std::vector<Kernel::Point_2>& holes, int passes,
           const TriangleFrame& frame) {
    namespace set = CGAL::parameters;
    CGAL::lloyd_optimize_mesh_2(triangulation, set::max_iteration_number = passes, set::convergence = 0.0,
                                set::freeze_bound = 0.0, set::seeds_begin = holes.begin(), set::seeds_end = holes.end(),
                                set::mark = false);
    refine(triangulation, holes, frame);
}

std::vector<SourceSegment> edges_of(const Triangulation& triangulation, const std::vector<Line>& lines,
                                    int tessellation) {
    std::vector<SourceSegment> edges;
    for (const Line& line : lines) {
        for_each_piece(triangulation, line, [&](const Vertex& a, const Vertex& b) {
            edges.push_back({place_of(a), place_of(b), line.source});
        });
    }
    for (auto edge = triangulation.finite_edges_begin(); edge != triangulation.finite_edges_end(); ++edge) {
        const auto& [face, i] = *edge;
        const bool in_net = face->is_in_domain() && face->neighbor(i)->is_in_domain();
        if (!in_net || triangulation.is_constrained(*edge)) continue;
        edges.push_back({place_of(face->vertex(Triangulation::ccw(i))), place_of(face->vertex(Triangulation::cw(i))),
                         tessellation});
    }
    return edges;
}

void refuse(const char* key, const std::string& message) {
    throw InputError(fmt::format("geometry.tessellation.triangles.{}: {}", key, message));
}

void check_length(const char* key, double length) {
    if (!(length > 0.0) || !std::isfinite(length))
        refuse(key, fmt::format("expected a length above 0, found {}", length));
}

void check_net(const TriangleNet& net) {
    check_length("spacing", net.spacing);
    if (net.relaxation < 0 || net.relaxation > most_triangle_relaxation)
        refuse("relaxation",
               fmt::format("expected 0 to {} passes, found {}", most_triangle_relaxation, net.relaxation));
    const TriangleGrading& grading = net.grading;
    if (grading.fractures != 0.0) check_length("grading.fractures", grading.fractures);
    if (grading.openings != 0.0) check_length("grading.openings", grading.openings);
    if (!grading.region.empty()) check_length("grading.region_spacing", grading.region_spacing);
    if (!(grading.growth > 0.0) || !std::isfinite(grading.growth))
        refuse("grading.growth", fmt::format("expected a number above 0, found {}", grading.growth));
}

std::vector<SegmentGrid::Segment> sides_of(const Polygon& polygon) {
    std::vector<SegmentGrid::Segment> sides;
    for (std::size_t i = 0; i < polygon.size(); ++i) sides.emplace_back(polygon[i], polygon[(i + 1) % polygon.size()]);
    return sides;
}

/// Throws InputError where the lines of a graded net ask for too many triangles. Across a line with sides h beside it and
/// a far away, and c = sqrt(3)/4, their number per metre is 2 int dx/(c (h + growth x)^2) = 2 (1/h - 1/a)/(c growth).
void check_number_at_lines(const std::vector<Line>& lines, const TriangleSize& size, const TriangleFrame& frame) {
    double n_triangles = 0.0;
    for (const Line& line : lines) {
        const Vec2 a = place_of(line.start);
        const Vec2 b = place_of(line.end);
        const double side = size.at(0.5 * (a + b));
        const double across = 2.0 * (1.0 / side - 1.0 / size.largest()) / (triangle_area(1.0) * size.growth());
        n_triangles += (b - a).norm() * (1.0 / side + across);
    }
    if (n_triangles > most_cells)
        throw InputError(
            fmt::format("{}: expected sides that make at most {:.0e} triangles, found some that make about "
                        "{:.1e} at the lines of the body",
                        frame.places.grading, most_cells, n_triangles));
}

} // namespace

double triangle_area(double side) { return 0.25 * std::numbers::sqrt3 * side * side; }

double smallest_side(const TriangleNet& net) {
    double side = net.spacing;
    for (const double finer : {net.grading.fractures, net.grading.openings, net.grading.region_spacing})
        if (finer > 0.0) side = std::min(side, finer);
    return side;
}

TriangleSize::TriangleSize(const TriangleNet& net, std::vector<SegmentGrid::Segment> fractures,
                           std::vector<SegmentGrid::Segment> openings, const Polygon& region)
    : spacing_(net.spacing), growth_(net.grading.growth) {
    check_net(net);
    const auto add = [this](std::vector<SegmentGrid::Segment> segments, const Polygon& polygon, double side) {
        if (side > 0.0 && side < spacing_ && !segments.empty())
            features_.push_back({SegmentGrid(std::move(segments)), polygon, side});
    };
    add(std::move(fractures), {}, net.grading.fractures);
    add(std::move(openings), {}, net.grading.openings);
    add(sides_of(region), region, net.grading.region_spacing);
}

double TriangleSize::at(const Vec2& place) const {
    double side = spacing_;
    for (const Feature& feature : features_) {
        const bool inside = !feature.polygon.empty() && contains(feature.polygon, place);
        const double away = inside ? 0.0 : feature.segments.distance(place, (spacing_ - feature.side) / growth_);
        if (std::isfinite(away)) side = std::min(side, feature.side + growth_ * away);
    }
    return side;
}

double TriangleSize::level_at(const Vec2& place) const {
    constexpr double levels_per_octave = 4.0;
    return spacing_ * std::exp2(std::round(levels_per_octave * std::log2(at(place) / spacing_)) / levels_per_octave);
}

std::vector<SourceSegment> triangle_edges(const TriangleNet& net, const TriangleSize& size,
                                          const TriangleFrame& frame) {
    Triangulation triangulation;
    const std::vector<Line> lines = lines_of(frame, triangulation);
    if (size.is_graded()) check_number_at_lines(lines, size, frame);
    Circles circles(box_of_living_edges(*frame.map), size.largest());
    for (const Line& line : lines) {
        const Vec2 middle_of_line = 0.5 * (place_of(line.start) + place_of(line.end));
        const bool cut = frame.region.empty() || contains(frame.region, middle_of_line);
        for (const auto& [middle, half] : insert_in_pieces(line, size, cut, triangulation))
            circles.add(middle, 0.5 * half);
    }
    const Filled part = filled_part(triangulation, lines, frame);
    if (part.triangles.empty())
        throw InputError(frame.places.region + ": expected a polygon that holds a part of the body, found none in it");
    for (auto v = triangulation.finite_vertices_begin(); v != triangulation.finite_vertices_end(); ++v)
        circles.add(place_of(v), 0.5 * size.at(place_of(v)));

    Darts darts(part.triangles, size, net.seed);
    const double missing = darts.triangles_asked_for() - static_cast<double>(part.triangles.size());
    if (missing > most_cells)
        throw InputError(
            fmt::format("{}: expected sides that make at most {:.0e} triangles, found some that make about "
                        "{:.1e}",
                        frame.places.grading, most_cells, missing));
    const int count = std::max(0, static_cast<int>(std::lround(0.5 * missing))); // each point adds two triangles
    for (const Vec2& point : scattered_points(count, darts, size, circles)) triangulation.insert(to_cgal(point));
    refine(triangulation, part.holes, frame);
    if (net.relaxation > 0) relax(triangulation, part.holes, net.relaxation, frame);
    return edges_of(triangulation, lines, frame.tessellation);
}

} // namespace kluft
