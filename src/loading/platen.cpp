#include "kluft/loading/platen.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <limits>
#include <map>
#include <set>
#include <utility>

#include "kluft/contact/detection.hpp"
#include "kluft/kinematics/affine.hpp"
#include "kluft/loading/boundary_geometry.hpp"
#include "kluft/loading/loaded_body.hpp"

namespace kluft {

namespace {

constexpr double least_pull = 1e-6;        ///< of the largest force on a point of the platens: less is none
constexpr double least_penetration = 1e-9; ///< of the largest displacement
constexpr double one_point = 5e-3;         ///< of a block's spacing: vertices nearer to each other are one point
constexpr double of_thickness = 0.1;       ///< of a block: those of a slab's own face are two
constexpr double in_plane = 1e-9;          ///< of the body's larger side
constexpr double in_line = 1e-6;           ///< twice the area of a triangle over the square of its longest side
constexpr double friction_change = 1e-5;   ///< of the largest force on a point: friction that has settled

Vec2 block_coordinates_of(const BlockSystem& system, const PlatenPoint& point) {
    return block_coordinates(system.blocks[point.block], system.vertices[point.vertex]);
}

Vec2 displacement_of(const BlockSystem& system, const PlatenPoint& point, const Eigen::VectorXd& q) {
    return displacement_at(q, point.block, block_coordinates_of(system, point));
}

/// Calls visit(block, vertex) for each vertex of each block on the outer edges of a boundary once.
template <class Visit> void for_each_vertex(const BlockSystem& system, int boundary, Visit visit) {
    std::set<std::pair<int, int>> done;
    for (const auto& [b, e] : outer_edges(system, boundary)) {
        if (system.blocks[b].fixed) continue;
        const Edge& edge = system.blocks[b].edges[e];
        for (const int vertex : {edge.start, edge.end})
            if (done.emplace(b, vertex).second) visit(b, vertex);
    }
}

const Platen* platen_on(const std::vector<Platen>& platens, int boundary) {
    const auto found = std::ranges::find(platens, boundary, &Platen::boundary);
    return found == platens.end() ? nullptr : &*found;
}

/// Forces of the platens on their points at equilibrium: against the normal, positive in compression, and along the face.
struct PointForces {
    std::vector<double> pressing, along; ///< N/m; zero where nothing is prescribed
    double largest = 0.0;                ///< magnitude of `pressing`
};

PointForces forces_on_points(const Eigen::VectorXd& residual, const Loads& loads) {
    const std::vector<double> of_rows = loads.constraints.row_forces(residual);
    const auto& rows = loads.constraints.rows();
    PointForces forces{std::vector<double>(loads.platen_points.size(), 0.0),
                       std::vector<double>(loads.platen_points.size(), 0.0)};
    for (std::size_t r = 0; r < rows.size(); ++r) {
        const int i = rows[r].platen_point;
        if (i < 0) continue;
        const Platen& platen = *platen_on(loads.platens, rows[r].boundary);
        const bool across = std::abs(rows[r].direction.dot(platen.normal)) > 0.5;
        if (!across) {
            forces.along[i] = of_rows[r];
            continue;
        }
        forces.pressing[i] = -of_rows[r];
        forces.largest = std::max(forces.largest, std::abs(of_rows[r]));
    }
    return forces;
}

/// One point of a platen and what decides its contact.
struct PointCheck {
    const Platen& platen;
    double pressing;    ///< N/m
    double along;       ///< N/m
    double largest;     ///< of all points (N/m)
    double penetration; ///< m
    double position;    ///< displacement along the face (m)
    double least_penetration;
};

/// A held point that is pulled opens.
bool update_pressed(const PointCheck& check, bool may_open, PlatenPoint& point) {
    if (check.pressing >= -least_pull * check.largest || !may_open) return false;
    point.contact = PlatenContact::open;
    point.friction = 0.0;
    return true;
}

bool update_open(const PointCheck& check, PlatenPoint& point) {
    if (check.penetration <= check.least_penetration) return false;
    point.contact = check.platen.tan_friction > 0.0 ? PlatenContact::sticking : PlatenContact::sliding;
    point.along = check.position;
    return true;
}

/// Coulomb's friction with the pressing force of the last solve.
bool update_friction(const PointCheck& check, PlatenPoint& point) {
    if (std::isinf(check.platen.tan_friction)) return false;
    const double limit = check.platen.tan_friction * std::max(0.0, check.pressing);
    const double least = friction_change * check.largest;
    if (point.contact == PlatenContact::sticking) {
        if (std::abs(check.along) <= limit + least) return false;
        point.contact = PlatenContact::sliding;
        point.friction = std::copysign(limit, check.along);
        return true;
    }
    const double slip = check.position - point.along;
    if (slip * point.friction > 0.0 && std::abs(slip) > check.least_penetration) { // it would push the point on
        point.contact = PlatenContact::sticking;
        point.friction = 0.0;
        return true;
    }
    const double friction = std::copysign(limit, point.friction);
    if (std::abs(friction - point.friction) <= least) return false;
    point.friction = friction;
    return true;
}

std::ptrdiff_t touching_points(const Platen& platen, const std::vector<PlatenPoint>& points) {
    return std::ranges::count_if(
        points, [&](const PlatenPoint& point) { return point.boundary == platen.boundary && touches(point.contact); });
}

/// Whether three vertices lie on a line.
bool are_in_line(const BlockSystem& system, int a, int b, int c) {
    const Vec2 ab = system.vertices[b] - system.vertices[a];
    const Vec2 ac = system.vertices[c] - system.vertices[a];
    return std::abs(cross(ab, ac)) <= in_line * std::max(ab.squaredNorm(), ac.squaredNorm());
}

/// A block stands on a vertex or an edge: where a third vertex has closed, the less pressed one of the two before it opens.
void open_third(const BlockSystem& system, const std::vector<double>& pressing, std::size_t closed,
                std::vector<PlatenPoint>& points) {
    std::vector<std::size_t> before;
    for (std::size_t i = 0; i < points.size(); ++i) {
        const bool same = points[i].block == points[closed].block && points[i].boundary == points[closed].boundary;
        if (same && i != closed && touches(points[i].contact)) before.push_back(i);
    }
    if (before.size() < 2) return;
    const auto [least, most] = std::ranges::minmax(before, {}, [&](std::size_t i) { return pressing[i]; });
    if (are_in_line(system, points[least].vertex, points[most].vertex, points[closed].vertex)) return;
    points[least].contact = PlatenContact::open;
    points[least].friction = 0.0;
}

/// Signorini's and Coulomb's conditions (28a) on one point.
bool update(const PointCheck& check, bool may_open, PlatenPoint& point) {
    if (point.contact == PlatenContact::open) return update_open(check, point);
    if (update_pressed(check, may_open, point)) return true;
    return check.platen.tan_friction > 0.0 && update_friction(check, point);
}

/// Vertices nearer to a vertex of the block than this are one point with it (m).
double one_point_of(const Block& block) {
    return std::min(one_point * spacing_of(block), of_thickness * thickness(block));
}

/// Whether a point of the platen on a boundary stands for a vertex of its block: two so near that their forces could only be a couple, which pulls.
bool has_near(const BlockSystem& system, const std::vector<PlatenPoint>& points, int boundary, int block, int vertex) {
    const double near = one_point_of(system.blocks[block]);
    return std::ranges::any_of(points, [&](const PlatenPoint& point) {
        return point.boundary == boundary && point.block == block &&
               (system.vertices[point.vertex] - system.vertices[vertex]).norm() < near;
    });
}

/// The points that a platen is laid on, as cut.
struct LaidFace {
    double plane = -std::numeric_limits<double>::infinity(); ///< of the outermost, along the normal (m)
    double low = std::numeric_limits<double>::infinity();    ///< along the tangent (m)
    double high = -std::numeric_limits<double>::infinity();
    double distance = 0.0; ///< from the plane and from the ends: no more than round-off (m)
};

LaidFace laid_face(const BlockSystem& system, const Platen& platen, const std::vector<PlatenPoint>& points) {
    LaidFace face;
    face.distance = in_plane * (system.upper - system.lower).maxCoeff();
    for (const PlatenPoint& point : points) {
        if (point.boundary != platen.boundary || !point.is_laid) continue;
        const Vec2& x = system.vertices[point.vertex];
        face.plane = std::max(face.plane, platen.normal.dot(x));
        face.low = std::min(face.low, platen.tangent().dot(x));
        face.high = std::max(face.high, platen.tangent().dot(x));
    }
    return face;
}

/// Vertices between the ends at which the platen is not laid on the body, as cut: of blocks that reach in front of its plane by more than
/// what is one point with it, and of faces in it that are none of its boundary.
std::set<int> uncovered_vertices(const BlockSystem& system, const Platen& platen, const LaidFace& face) {
    std::set<std::pair<int, int>> laid;
    for (const auto& [b, e] : outer_edges(system, platen.boundary)) laid.emplace(b, e);
    const auto place = [&](int vertex) { return platen.normal.dot(system.vertices[vertex]); };
    std::set<int> uncovered;
    for (int b = 0; b < system.n_blocks(); ++b) {
        const auto& edges = system.blocks[b].edges;
        const double front = face.plane + std::max(face.distance, one_point_of(system.blocks[b]));
        const bool in_front = std::ranges::any_of(edges, [&](const Edge& edge) { return place(edge.start) > front; });
        for (int e = 0; e < static_cast<int>(edges.size()); ++e) {
            const bool is_face = std::min(place(edges[e].start), place(edges[e].end)) >= face.plane - face.distance;
            if (in_front) uncovered.insert(edges[e].start);
            if (is_face && !laid.contains({b, e})) uncovered.insert({edges[e].start, edges[e].end});
        }
    }
    return uncovered;
}

/// Vertices in the plane of the platen or before it that it does not meet: where it is not laid on the body, its ends included.
void append_beyond(const BlockSystem& system, const Platen& platen, std::vector<PlatenPoint>& points) {
    const LaidFace face = laid_face(system, platen, points);
    const std::set<int> uncovered = uncovered_vertices(system, platen, face);
    std::set<std::pair<int, int>> known;
    std::set<int> laid;
    for (const PlatenPoint& point : points) {
        known.emplace(point.block, point.vertex);
        laid.insert(point.vertex);
    }
    std::vector<PlatenPoint> others;
    double low = face.low;
    double high = face.high;
    for (int b = 0; b < system.n_blocks(); ++b) {
        for (const Edge& edge : system.blocks[b].edges) {
            const Vec2& x = system.vertices[edge.start];
            const bool beside_lower_face = laid.contains(edge.start) && uncovered.contains(edge.start);
            if (platen.normal.dot(x) < face.plane - face.distance && !beside_lower_face) continue;
            if (known.contains({b, edge.start})) continue;
            low = std::min(low, platen.tangent().dot(x));
            high = std::max(high, platen.tangent().dot(x));
            others.push_back(
                {.boundary = platen.boundary, .block = b, .vertex = edge.start, .contact = PlatenContact::beyond});
        }
    }
    const bool goes_on_low = low < face.low - face.distance;
    const bool goes_on_high = high > face.high + face.distance;
    std::ranges::copy_if(others, std::back_inserter(points), [&](const PlatenPoint& point) {
        const double along = platen.tangent().dot(system.vertices[point.vertex]);
        return uncovered.contains(point.vertex) || (goes_on_low && along <= face.low + face.distance) ||
               (goes_on_high && along >= face.high - face.distance);
    });
}

/// Along the tangent, as cut: where a platen ends because the body goes on in the plane of its face; infinite where it does not.
struct PlatenEnds {
    double low = -std::numeric_limits<double>::infinity();
    double high = std::numeric_limits<double>::infinity();
};

PlatenEnds ends_of(const BlockSystem& system, const Platen& platen, const LaidFace& face,
                   const std::vector<PlatenPoint>& points) {
    PlatenEnds ends;
    for (const PlatenPoint& point : points) {
        if (point.boundary != platen.boundary || point.contact != PlatenContact::beyond) continue;
        const double along = platen.tangent().dot(system.vertices[point.vertex]);
        if (along <= face.low + face.distance) ends.low = face.low + face.distance;
        if (along >= face.high - face.distance) ends.high = face.high - face.distance;
    }
    return ends;
}

} // namespace

std::vector<PlatenPoint> laid_points(const BlockSystem& system, const Platen& platen, const Eigen::VectorXd& q) {
    std::vector<PlatenPoint> points;
    for_each_vertex(system, platen.boundary, [&](int block, int vertex) {
        if (has_near(system, points, platen.boundary, block, vertex)) return;
        PlatenPoint point{.boundary = platen.boundary, .block = block, .vertex = vertex, .is_laid = true};
        const Vec2 u = displacement_of(system, point, q);
        const bool sticks = platen.tan_friction > 0.0;
        point.contact = sticks ? PlatenContact::sticking : PlatenContact::sliding;
        point.reach = platen.normal.dot(u);
        point.along = platen.tangent().dot(u);
        points.push_back(point);
    });
    append_beyond(system, platen, points);
    return points;
}

double face_of(const BlockSystem& system, const Platen& platen, const std::vector<PlatenPoint>& points) {
    double outermost = -std::numeric_limits<double>::infinity();
    for (const PlatenPoint& point : points) {
        if (point.boundary != platen.boundary || !point.is_laid) continue;
        outermost = std::max(outermost, platen.normal.dot(system.vertices[point.vertex]) + point.reach);
    }
    return outermost;
}

double mean_reach(const Platen& platen, const std::vector<PlatenPoint>& points) {
    double sum = 0.0;
    int n = 0;
    for (const PlatenPoint& point : points) {
        if (point.boundary != platen.boundary || !point.is_laid) continue;
        sum += point.reach;
        ++n;
    }
    return n > 0 ? sum / n : 0.0;
}

void add_near_points(const BlockSystem& system, const Eigen::VectorXd& q, double distance, Loads& loads) {
    if (loads.platens.empty()) return;
    const double travel = platen_travel(loads, q);
    for (const Platen& platen : loads.platens) {
        std::set<std::pair<int, int>> known; // (block, vertex)
        std::map<int, double> laid_reach;    // of a vertex that faces have there
        for (const PlatenPoint& point : loads.platen_points) {
            if (point.boundary != platen.boundary) continue;
            known.emplace(point.block, point.vertex);
            if (!point.is_laid) continue;
            double& reach = laid_reach.emplace(point.vertex, point.reach).first->second;
            reach = std::max(reach, point.reach);
        }
        const double went = platen.moved + platen.rate * travel;
        const LaidFace laid = laid_face(system, platen, loads.platen_points);
        const PlatenEnds ends = ends_of(system, platen, laid, loads.platen_points);
        for (int b = 0; b < system.n_blocks(); ++b) {
            if (system.blocks[b].fixed) continue;
            for (const Edge& edge : system.blocks[b].edges) {
                const Vec2& x = system.vertices[edge.start];
                const double along = platen.tangent().dot(x);
                if (along <= ends.low || along >= ends.high) continue; // of a part of the body that it is not laid on
                PlatenPoint point{.boundary = platen.boundary,
                                  .block = b,
                                  .vertex = edge.start,
                                  .contact = PlatenContact::open,
                                  .reach = platen.face - platen.normal.dot(x)};
                const auto corner = laid_reach.find(edge.start); // between faces that are there
                if (corner != laid_reach.end()) point.reach = corner->second + one_point_of(system.blocks[b]);
                const double moved = platen.normal.dot(displacement_of(system, point, q));
                if (moved < point.reach + went - distance || known.contains({b, edge.start})) continue;
                if (platen.normal.dot(x) >= laid.plane - laid.distance &&
                    has_near(system, loads.platen_points, platen.boundary, b, edge.start))
                    continue;
                const bool is_before = platen.normal.dot(x) > laid.plane; // by little, or it would stand out
                if (corner != laid_reach.end() || is_before)
                    point.reach = std::max(point.reach, moved - went); // touches as it lies
                loads.platen_points.push_back(point);
            }
        }
    }
}

void append_rows(const BlockSystem& system, const Platen& platen, const PlatenPoint& point, int index,
                 std::vector<PrescribedDisplacement>& rows) {
    if (!touches(point.contact)) return;
    PrescribedDisplacement row;
    row.block = point.block;
    row.xi = block_coordinates_of(system, point);
    row.boundary = platen.boundary;
    row.platen_point = index;
    row.direction = platen.normal;
    row.start = point.reach;
    row.velocity = platen.velocity;
    row.rate = platen.rate;
    row.target = point.reach + platen.moved;
    rows.push_back(row);
    if (point.contact == PlatenContact::sliding) return;
    row.direction = platen.tangent();
    row.start = row.target = point.along;
    row.velocity = row.rate = 0.0;
    rows.push_back(row);
}

void hold_by_platens(const LoadedBody& body, const Eigen::VectorXd& q, Loads& loads) {
    const BlockSystem& system = *body.system;
    std::vector<PrescribedDisplacement> rows = loads.constraints.rows();
    std::erase_if(rows, [](const PrescribedDisplacement& row) { return row.platen_point >= 0; });
    loads.friction.clear();
    for (std::size_t i = 0; i < loads.platen_points.size(); ++i) {
        const PlatenPoint& point = loads.platen_points[i];
        const Platen& platen = *platen_on(loads.platens, point.boundary);
        append_rows(system, platen, point, static_cast<int>(i), rows);
        if (point.friction != 0.0)
            loads.friction.push_back(
                {point.block, block_coordinates_of(system, point), point.friction * platen.tangent()});
    }
    loads.constraints =
        body.kinematics == Kinematics::rigid ? Constraints(std::move(rows), system, q) : Constraints(std::move(rows));
}

bool update_platen_points(const BlockSystem& system, const Eigen::VectorXd& q, const Eigen::VectorXd& residual,
                          bool may_open, Loads& loads) {
    if (loads.platen_points.empty()) return false;
    const PointForces forces = forces_on_points(residual, loads);
    const double travel = platen_travel(loads, q);
    const double shortest = least_penetration * q.lpNorm<Eigen::Infinity>();
    bool changed = false;
    for (std::size_t i = 0; i < loads.platen_points.size(); ++i) {
        PlatenPoint& point = loads.platen_points[i];
        const Platen& platen = *platen_on(loads.platens, point.boundary);
        const bool is_glued = platen.glued && touches(point.contact);
        if (is_glued || point.contact == PlatenContact::beyond) continue;
        const Vec2 u = displacement_of(system, point, q);
        const double reach = point.reach + platen.moved + platen.rate * travel;
        const PointCheck check{platen,         forces.pressing[i],           forces.along[i],
                               forces.largest, platen.normal.dot(u) - reach, platen.tangent().dot(u),
                               shortest};
        const bool was_open = point.contact == PlatenContact::open;
        const bool is_last = platen.rate != 0.0 && !was_open && touching_points(platen, loads.platen_points) == 1;
        if (!update(check, may_open && !is_last, point)) continue;
        changed = true;
        if (was_open && !platen.glued) open_third(system, forces.pressing, i, loads.platen_points);
    }
    return changed;
}

double largest_pull(const Eigen::VectorXd& residual, const Loads& loads) {
    const PointForces forces = forces_on_points(residual, loads);
    double pull = 0.0;
    for (std::size_t i = 0; i < loads.platen_points.size(); ++i) {
        if (!platen_on(loads.platens, loads.platen_points[i].boundary)->glued)
            pull = std::max(pull, -forces.pressing[i]);
    }
    return pull > 0.0 ? pull / forces.largest : 0.0;
}

void meet_anew(const BlockSystem& system, const Platen& platen, const Eigen::VectorXd& q,
               std::vector<PlatenPoint>& points) {
    const auto gap = [&](const PlatenPoint& point) {
        return point.reach - platen.normal.dot(displacement_of(system, point, q));
    };
    const auto is_of_platen = [&](const PlatenPoint& point) {
        return point.boundary == platen.boundary && point.contact != PlatenContact::beyond;
    };
    const auto stick_or_slide = [&](PlatenPoint& point) {
        const bool slides = platen.tan_friction == 0.0;
        const bool goes_on = !slides && std::isfinite(platen.tan_friction) && touches(point.contact);
        if (goes_on) return;
        if (slides != (point.contact == PlatenContact::sliding))
            point.along = platen.tangent().dot(displacement_of(system, point, q));
        point.contact = slides ? PlatenContact::sliding : PlatenContact::sticking;
        point.friction = 0.0;
    };
    double least_gap = std::numeric_limits<double>::infinity();
    for (PlatenPoint& point : points) {
        if (!is_of_platen(point)) continue;
        least_gap = std::min(least_gap, gap(point));
        if (touches(point.contact)) stick_or_slide(point);
    }
    if (platen.rate == 0.0 || touching_points(platen, points) > 0) return;
    const double shortest = least_penetration * q.lpNorm<Eigen::Infinity>();
    for (PlatenPoint& point : points) {
        if (point.boundary != platen.boundary) continue;
        point.reach -= least_gap;
        if (is_of_platen(point) && gap(point) <= shortest) stick_or_slide(point);
    }
}

std::vector<PlatenFace> faces_of(const BlockSystem& system, const Loads& loads, const Eigen::VectorXd& q) {
    std::vector<PlatenFace> faces;
    const double travel = platen_travel(loads, q);
    for (const Platen& platen : loads.platens) {
        const LaidFace laid = laid_face(system, platen, loads.platen_points);
        if (laid.high < laid.low) continue;
        const Vec2 middle = laid.plane * platen.normal;
        const double outward = mean_reach(platen, loads.platen_points) + platen.moved + platen.rate * travel;
        faces.push_back({middle + laid.low * platen.tangent(), middle + laid.high * platen.tangent(), platen.normal,
                         outward * platen.normal});
    }
    return faces;
}

void keep_slips(const BlockSystem& system, const Eigen::VectorXd& q, const std::vector<Platen>& platens,
                std::vector<PlatenPoint>& points) {
    for (PlatenPoint& point : points) {
        if (point.contact != PlatenContact::sliding) continue;
        point.along = platen_on(platens, point.boundary)->tangent().dot(displacement_of(system, point, q));
    }
}

double platen_travel(const Loads& loads, const Eigen::VectorXd& q) {
    double sum = 0.0;
    double squares = 0.0;
    for (const PrescribedDisplacement& row : loads.constraints.rows()) {
        sum += row.rate * (row.direction.dot(displacement_at(q, row.block, row.xi)) - row.target);
        squares += row.rate * row.rate;
    }
    return squares > 0.0 ? sum / squares : 0.0;
}

} // namespace kluft
