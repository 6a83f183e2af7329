#include "kluft/scene/scene_model.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <limits>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "kluft/blocks/block_search.hpp"
#include "kluft/blocks/narrow_neck.hpp"
#include "kluft/core/diagnostics.hpp"
#include "kluft/core/memory.hpp"
#include "kluft/core/place_text.hpp"
#include "kluft/geometry/polygon.hpp"
#include "kluft/geometry/predicates.hpp"
#include "kluft/scene/body_lines.hpp"
#include "kluft/scene/coarse_places.hpp"
#include "kluft/scene/net_check.hpp"
#include "kluft/scene/scattered_sides.hpp"
#include "kluft/scene/traces_outside.hpp"

namespace kluft {

namespace {

constexpr std::size_t most_told = 3;     ///< warnings of one kind
constexpr double least_reference = 3e-3; ///< spacing over the size of a block

/// Of a fracture on the line of another one, with the interface that counts where they have two.
std::string overlaid(const LostFracture& lost, const Scene& scene) {
    const auto& fractures = scene.geometry.fractures;
    const FractureTrace& own = fractures[static_cast<std::size_t>(lost.fracture)];
    const FractureTrace& first = fractures[static_cast<std::size_t>(lost.other)];
    std::string text = fmt::format("{} runs along it already", first.name);
    if (own.interface_type == first.interface_type) return text;
    const auto name_of = [&](int type) { return scene.interface_types[static_cast<std::size_t>(type)].name; };
    return text + fmt::format(", so that the interface there is '{}' and not '{}'", name_of(first.interface_type),
                              name_of(own.interface_type));
}

double length_of(const std::vector<Vec2>& trace) {
    double length = 0.0;
    for (std::size_t i = 0; i + 1 < trace.size(); ++i) length += (trace[i + 1] - trace[i]).norm();
    return length;
}

/// Without a net: "; plane ends at (11, 11.29), 0.03 m before the outline of the body" of the first of the fractures that nearly reaches
/// another line; "" where none does.
std::string short_gap(const Scene& scene, const CutReport& report, const std::vector<int>& fractures) {
    constexpr double small = 0.05; // of the trace
    if (scene.geometry.tessellation) return {};
    std::vector<BodyLine> lines = body_lines(scene.geometry, report, scene.interface_types);
    for (BodyLine& line : lines) line.is_open = true; // potential cracks part blocks, too
    for (const LostFracture& lost : report.lost)      // for what they miss by
        if (lost.cause == LostFracture::Cause::separates_nothing)
            lines[static_cast<std::size_t>(lost.fracture)].points =
                scene.geometry.fractures[static_cast<std::size_t>(lost.fracture)].points;
    const LineSearch search(std::move(lines), report.resolution);
    for (const int fracture : fractures) {
        const BodyLine& trace = search.line(fracture);
        if (trace.points.empty()) continue;
        for (const Vec2& end : {trace.points.front(), trace.points.back()}) {
            if (!is_in_body(end, scene.geometry)) continue;
            const auto gap = search.bridge_at(end, fracture, small * length_of(trace.points));
            if (!gap) continue;
            return fmt::format("; {} ends at {}, {:.3g} m before {}", trace.name, place_text(end), gap->length,
                               search.line(gap->line).name);
        }
    }
    return {};
}

/// Why nothing is left of a fracture.
std::string reason(const LostFracture& lost, const Scene& scene, const CutReport& report) {
    const double resolution = report.resolution;
    switch (lost.cause) {
    case LostFracture::Cause::too_short:
        return fmt::format("it is shorter than {:.3g} m, the smallest length that the net resolves", resolution);
    case LostFracture::Cause::coincides:
        if (lost.other >= 0) return overlaid(lost, scene);
        return scene.geometry.holes.empty() ? "it lies on the outline of the domain"
                                            : "it lies on the outline of the domain or of a hole";
    case LostFracture::Cause::cuts_off_little:
        return fmt::format("what it cuts off is {:.3g} m2, less than {:.3g} m2, the smallest block "
                           "(`geometry.minimum_area`)",
                           lost.area, report.minimum_area);
    case LostFracture::Cause::cuts_off_a_hair:
        return fmt::format("what it cuts off from another line is narrower than {:.3g} m or smaller than {:.3g} m2, "
                           "the smallest block",
                           report.minimum_width, report.minimum_area);
    case LostFracture::Cause::too_near:
        return fmt::format("it lies nearer to another line than {:.3g} m, the smallest length that the net resolves, "
                           "or at less than 14 degrees to it",
                           resolution);
    case LostFracture::Cause::separates_nothing:
        return "it ends inside a block and separates nothing" + short_gap(scene, report, {lost.fracture});
    case LostFracture::Cause::in_part:
        return fmt::format("{:.3g} m of it are nearer to another line than {:.3g} m, the smallest length that the net "
                           "resolves, or at less than 14 degrees to it",
                           lost.length, resolution);
    }
    return {};
}

/// Of each cause the first few by name, and how many more.
std::vector<std::string> lost_fractures(const Scene& scene, const CutReport& report) {
    const auto trace_of = [&scene](const LostFracture& lost) -> const FractureTrace& {
        return scene.geometry.fractures[static_cast<std::size_t>(lost.fracture)];
    };
    std::vector<std::string> warnings;
    for (const auto cause :
         {LostFracture::Cause::too_short, LostFracture::Cause::coincides, LostFracture::Cause::cuts_off_little,
          LostFracture::Cause::cuts_off_a_hair, LostFracture::Cause::too_near, LostFracture::Cause::separates_nothing,
          LostFracture::Cause::in_part}) {
        std::vector<LostFracture> of_cause;
        std::ranges::copy_if(report.lost, std::back_inserter(of_cause),
                             [cause](const LostFracture& lost) { return lost.cause == cause; });
        const std::size_t n_told = std::min(of_cause.size(), most_told);
        for (std::size_t i = 0; i < n_told; ++i) {
            const FractureTrace& trace = trace_of(of_cause[i]);
            const std::size_t n_others = i + 1 == n_told ? of_cause.size() - n_told : 0;
            warnings.push_back(fmt::format(
                "{}: {} is left out{}: {}{}", trace.place, trace.name,
                cause == LostFracture::Cause::in_part ? " in part" : "", reason(of_cause[i], scene, report),
                n_others > 0 ? fmt::format("; and {} more fractures for a reason like this", n_others) : ""));
        }
    }
    return warnings;
}

/// Whether a fracture is told as left out, as a whole or in part.
bool is_told(const CutReport& report, int fracture) {
    return std::ranges::find(report.lost, fracture, &LostFracture::fracture) != report.lost.end();
}

/// Without a net a joint that ends inside a block does not even weaken it.
std::vector<std::string> pruned_pieces(const Scene& scene, const CutReport& report) {
    const GeometrySpec& geometry = scene.geometry;
    if (geometry.tessellation) return {};
    constexpr double large_part = 0.05; // of the trace: less is an end that was drawn too long
    const auto trace_of = [&](const LoosePiece& piece) -> const FractureTrace& {
        return geometry.fractures[static_cast<std::size_t>(piece.fracture)];
    };
    const auto is_worth_a_word = [&](const LoosePiece& piece) {
        return !is_told(report, piece.fracture) && piece.length > large_part * length_of(trace_of(piece).points);
    };
    const auto longest = std::ranges::find_if(report.pruned, is_worth_a_word);
    if (longest == report.pruned.end()) return {};
    std::vector<int> fractures; // that of the longest piece first
    for (const LoosePiece& piece : report.pruned)
        if (is_worth_a_word(piece)) fractures.push_back(piece.fracture);
    const FractureTrace& trace = trace_of(*longest);
    const std::size_t n_others = report.pruned.size() - 1;
    double all = 0.0;
    for (const LoosePiece& piece : report.pruned) all += piece.length;
    return {fmt::format("{}: {:.3g} m of {} end inside a block and are left out{}: without potential cracks "
                        "(`geometry.tessellation`) a block is cut by what goes through it, and has no other weakness{}",
                        trace.place, longest->length, trace.name,
                        n_others > 1    ? fmt::format(", as are {} other pieces, {:.3g} m in all", n_others, all)
                        : n_others == 1 ? ", as is another piece"
                                        : "",
                        short_gap(scene, report, fractures))};
}

/// A fracture that no longer comes to the surface holds what rests on it.
std::vector<std::string> closed_outcrops(const GeometrySpec& geometry, const CutReport& report) {
    std::vector<CutReport::Merged> closed;
    std::ranges::copy_if(report.merged, std::back_inserter(closed), [&](const CutReport::Merged& piece) {
        return piece.fracture >= 0 && piece.daylights && !is_told(report, piece.fracture);
    });
    if (closed.empty()) return {};
    std::ranges::stable_sort(closed, std::ranges::greater(), &CutReport::Merged::length);
    const auto trace_of = [&](const CutReport::Merged& piece) -> const FractureTrace& {
        return geometry.fractures[static_cast<std::size_t>(piece.fracture)];
    };
    std::string pieces;
    for (std::size_t i = 0; i < std::min(closed.size(), most_told); ++i)
        pieces += fmt::format("{}{:.3g} m of {} at about {}", i > 0 ? ", " : "", closed[i].length,
                              trace_of(closed[i]).name, place_text(closed[i].at));
    if (closed.size() > most_told) pieces += fmt::format(" and {} more", closed.size() - most_told);
    return {fmt::format(
        "{}: closed where they come to the outline: {}. A piece too small for a block lies there between two "
        "lines, and went into a neighbour; it may hold what would slide along. A finer net, or a trace that ends at "
        "the "
        "other one, leaves them open",
        trace_of(closed.front()).place, pieces)};
}

/// What is no part of the body any more.
std::vector<std::string> taken_off(const GeometrySpec& geometry, const CutReport& report) {
    if (report.taken_off.empty()) return {};
    const auto largest = std::ranges::max_element(report.taken_off, {}, &CutReport::Merged::area);
    double area = 0.0;
    for (const CutReport::Merged& piece : report.taken_off) area += piece.area;
    const std::size_t n = report.taken_off.size();
    return {fmt::format(
        "{}: {} too small for a block {} taken off the free surface, {:.3g} m2 in all{} at {}: in a neighbour "
        "it would lock a fracture that comes out there. A side that is named in `boundaries` keeps all of its rock",
        geometry.places.domain, n > 1 ? fmt::format("{} pieces", n) : "a piece", n > 1 ? "are" : "is", area,
        n > 1 ? ", the largest" : "", place_text(largest->at))};
}

std::vector<std::string> bare_net(const GeometrySpec& geometry, const BlockSystem& system) {
    const auto is_of_net = [](const Interface& each) { return each.origin == EdgeOrigin::tessellation; };
    if (!geometry.tessellation || std::ranges::any_of(system.interfaces, is_of_net)) return {};
    return {geometry.tessellation->region
                ? geometry.places.region + ": the net has no edge in it that lies in the body: nothing can crack"
                : geometry.places.tessellation + ": the net has no edge in the body: nothing can crack"};
}

/// A polygon beside the body, or between the middles of its blocks, changes nothing: it is hardly meant so.
std::vector<std::string> empty_regions(const GeometrySpec& geometry, const BlockSystem& system) {
    std::vector<std::string> warnings;
    for (std::size_t i = 0; i < geometry.regions.size(); ++i) {
        const auto lies_in = [&](const Block& block) {
            return contains(geometry.regions[i].polygon, system.origin + block.centroid);
        };
        if (std::ranges::none_of(system.blocks, lies_in))
            warnings.push_back(fmt::format(
                "geometry.regions.{}.polygon: the middle of no block lies in it: no block has its material", i));
    }
    return warnings;
}

double distance_to_outline(const Polygon& polygon, const Vec2& p) {
    double nearest = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < polygon.size(); ++i)
        nearest = std::min(nearest, distance_to_segment(p, polygon[i], polygon[(i + 1) % polygon.size()]));
    return nearest;
}

/// To two digits.
double rounded_down(double value) {
    const double unit = std::pow(10.0, std::floor(std::log10(value)) - 1.0);
    return unit * std::floor(value / unit);
}

/// What keeps a piece that was taken off.
std::string what_keeps(const CutReport::Merged& piece, const GeometrySpec& geometry, const CutReport& report) {
    const std::string named = "a boundary that names its side keeps the rock there";
    if (piece.width < report.minimum_width) return "a finer net, or " + named;
    const double whole = std::min(mean_cell_area(geometry), std::abs(signed_area(geometry.domain)));
    return fmt::format("`geometry.minimum_area` of at most {:.2g} keeps it as a block, or {}",
                       rounded_down(piece.area / whole), named);
}

/// Throws InputError for points of forces and histories in what was taken off, which belong to no block.
void refuse_points_taken_off(const Scene& scene, const CutBody& body) {
    const GeometrySpec& geometry = scene.geometry;
    const std::vector<CutReport::Merged>& taken = body.report.taken_off;
    if (taken.empty()) return;
    const double rounding = 1e-9 * (body.system.upper - body.system.lower).norm();
    std::vector<std::string> messages;
    const auto judge = [&](const std::string& key, const Vec2& p) {
        const bool is_in_domain = is_in_body(p, geometry) || distance_to_outline(geometry.domain, p) <= rounding;
        if (!is_in_domain || block_containing(body.system, p) >= 0) return;
        const auto away = [&](const CutReport::Merged& piece) { return (piece.at - p).norm(); };
        const CutReport::Merged& piece = *std::ranges::min_element(taken, {}, away);
        messages.push_back(fmt::format("{}: expected a point in a block, found {} in a piece of {:.3g} m2 that is too "
                                       "small for a block and is taken off the free surface; {}",
                                       key, place_text(p), piece.area, what_keeps(piece, geometry, body.report)));
    };
    const LoadProgram& loads = scene.loads;
    for (int i = 0; i < static_cast<int>(loads.forces.size()); ++i) {
        const PointForce& force = loads.forces[static_cast<std::size_t>(i)];
        const auto stage =
            std::ranges::find_if(loads.stages, [i](const Stage& each) { return each.forces.contains(i); });
        judge(fmt::format("stages.{}.forces.{}", stage - loads.stages.begin(), force.name), force.point);
    }
    for (const HistoryRequest& request : scene.output.histories)
        if (request.point) judge("output.histories." + request.name, *request.point);
    if (!messages.empty()) throw located(InputError(std::move(messages)), scene.places);
}

/// Where cells of a net belong to a polygon by their middles, it ends at their edges: cells of the rock beside it bridge a thin layer.
std::vector<std::string> ragged_regions(const GeometrySpec& geometry, const BlockSystem& system) {
    constexpr double far_off = 0.02; // of the spacing, on the average
    std::vector<std::string> warnings;
    if (!geometry.tessellation) return warnings;
    for (std::size_t i = 0; i < geometry.regions.size(); ++i) {
        const Polygon& polygon = geometry.regions[i].polygon;
        const auto lies_in = [&](int b) { return contains(polygon, system.origin + system.blocks[b].centroid); };
        double length = 0.0, off = 0.0, farthest = 0.0;
        for (const Interface& interface : system.interfaces) {
            if (lies_in(interface.block_a) == lies_in(interface.block_b)) continue;
            const Edge& edge = system.blocks[interface.block_a].edges[interface.edge_a];
            const Vec2 start = edge_start(system, edge), end = edge_end(system, edge);
            for (const Vec2& at : {start, end}) {
                const double distance = distance_to_outline(polygon, system.origin + at);
                off += 0.5 * (end - start).norm() * distance;
                farthest = std::max(farthest, distance);
            }
            length += (end - start).norm();
        }
        if (off <= far_off * system.spacing * length) continue;
        warnings.push_back(
            fmt::format("geometry.regions.{}.polygon: cells of the net belong to it by their middles, and its sides "
                        "come out ragged, {:.2g} m off on "
                        "the average and up to {:.2g} m: of a thin layer, cells of the rock beside it bridge it, so "
                        "that it deforms less and slides less "
                        "easily; `geometry.construction_lines` along it make a net of triangles follow it",
                        i, off / length, farthest));
    }
    return warnings;
}

std::vector<std::string> fine_details(const GeometrySpec& geometry, const CutReport& report) {
    std::vector<std::string> warnings;
    for (const FineDetail& detail : report.fine_details) {
        if (warnings.size() == most_told) {
            warnings.push_back(fmt::format("{}: {} more sides or holes are that small", geometry.places.domain,
                                           report.fine_details.size() - most_told));
            break;
        }
        const std::string hole = fmt::format("hole {}", detail.hole);
        const std::string what = detail.is_whole_hole ? hole
                                 : detail.hole < 0    ? std::string("a side of the outline")
                                                      : "a side of " + hole;
        warnings.push_back(
            fmt::format("{}: {} at {} is {:.3g} m {}, less than {:.3g} m, the smallest length that the net "
                        "resolves: triangles as small as that lie around it, and the run may fail there",
                        geometry.places.domain, what, place_text(detail.at), detail.size,
                        detail.is_whole_hole ? "wide" : "long", report.resolution));
    }
    return warnings;
}

/// Twice the area over the length of the outline: of a strip its width (m).
double width_of(const Polygon& domain) {
    double length = 0.0;
    for (std::size_t i = 0; i < domain.size(); ++i) length += (domain[(i + 1) % domain.size()] - domain[i]).norm();
    return 2.0 * std::abs(signed_area(domain)) / length;
}

/// A net that is coarser than the body has other edges than those that the laws of its stiffness are made for.
void blame_coarse_net(const GeometrySpec& geometry, const InputError& error) {
    if (!geometry.tessellation || !geometry.tessellation->triangles) return;
    const double spacing = geometry.tessellation->triangles->spacing;
    const double width = width_of(geometry.domain);
    if (spacing <= width) return;
    throw InputError(
        fmt::format("{}: the spacing of the net, {:.6g} m, is larger than the body, which is about {:.3g} m "
                    "wide (twice its area over its outline); with such a net {}",
                    geometry.places.spacing, spacing, width, error.what()));
}

/// Where the length that motions are measured by is small beside the blocks.
std::vector<std::string> small_reference(const GeometrySpec& geometry, const BlockSystem& system) {
    if (geometry.tessellation || geometry.reference_spacing == 0.0) return {};
    const double size = std::sqrt(area_of(system) / system.n_blocks());
    if (geometry.reference_spacing >= least_reference * size) return {};
    return {fmt::format(
        "{}: {:.3g} m is little beside the blocks, which are {:.3g} m wide on the average: gaps and motions are "
        "measured by it, and an equilibrium to which blocks have to move by more than a hundredth of it may not be "
        "found; without it the blocks' size is taken",
        geometry.places.reference_spacing, geometry.reference_spacing, size)};
}

/// Traces that nearly meet in one point cut slivers, unless a spacing says what is too small for a block.
std::vector<std::string> slivers(const GeometrySpec& geometry, const BlockSystem& system) {
    if (geometry.tessellation || geometry.reference_spacing > 0.0 || system.outline_type >= 0) return {};
    const double least = sliver_area(system);
    const auto n = std::ranges::count_if(system.blocks, [&](const Block& each) { return each.area < least; });
    if (n == 0) return {};
    const auto smallest = std::ranges::min_element(system.blocks, {}, &Block::area);
    const int b = static_cast<int>(smallest - system.blocks.begin());
    return {fmt::format(
        "geometry: block {} at {} is a sliver of {:.3g} m2{}, where the mean block has {:.3g} m2: such pieces between "
        "traces that nearly meet in one point may decide what a run finds; geometry.reference_spacing merges what is "
        "small "
        "beside it with a neighbour",
        block_label(system, b), place_text(system.origin + smallest->centroid), smallest->area,
        n > 1 ? fmt::format(", one of {}", n) : "", area_of(system) / system.n_blocks())};
}

/// A net follows sides of the outline that nearly touch, and fills what is between them.
std::vector<std::string> slivers_of_net(const GeometrySpec& geometry, const BlockSystem& system,
                                        const CutReport& report) {
    constexpr double tiny = 1e-6; // of a cell: far less than what a net resolves
    if (!geometry.tessellation || !report.fine_details.empty()) return {};
    const double cell = mean_cell_area(geometry);
    const auto smallest = std::ranges::min_element(system.blocks, {}, &Block::area);
    if (smallest->area >= tiny * cell) return {};
    const auto n = std::ranges::count_if(system.blocks, [&](const Block& each) { return each.area < tiny * cell; });
    const int b = static_cast<int>(smallest - system.blocks.begin());
    return {
        fmt::format("{}: block {} at {} is a sliver of {:.3g} m2{}, where a cell of the net has {:.3g} m2: sides of "
                    "the outline or of holes nearly touch there, and the run may fail there",
                    geometry.places.domain, block_label(system, b), place_text(system.origin + smallest->centroid),
                    smallest->area, n > 1 ? fmt::format(", one of {}", n) : "", cell)};
}

/// Where a trace passes a corner of the body closely, two parts hang together on what is between.
std::vector<std::string> necks(const GeometrySpec& geometry, const BlockSystem& system) {
    if (geometry.tessellation) return {};
    const std::vector<NarrowNeck> found = narrow_necks(system);
    if (found.empty()) return {};
    const auto beside = [](const NarrowNeck& neck) { return neck.width / std::sqrt(neck.smaller_part); };
    const NarrowNeck& neck = *std::ranges::min_element(found, {}, beside);
    return {fmt::format(
        "geometry: block {} is {:.2g} m wide at {}, beside a part of it of {:.3g} m2{}: a block does not break, and "
        "what "
        "hangs on so narrow a neck is held by it; a trace parts it that meets the corner there, or passes it within 2 "
        "% of "
        "geometry.reference_spacing",
        block_label(system, neck.block), neck.width, place_text(system.origin + neck.at), neck.smaller_part,
        found.size() > 1 ? fmt::format(", one of {} such blocks", found.size()) : "")};
}

/// What boundaries of all given blocks leave out inside the body.
std::vector<std::string> open_joints(const GeometrySpec& geometry, const BlockSystem& system, const CutReport& report) {
    if (report.inner_sides.empty()) return {};
    std::map<int, double> left_out; // by boundary (m)
    std::set<std::pair<int, int>> pairs;
    for (const InnerSide& side : report.inner_sides) {
        left_out[side.boundary] += side.length;
        pairs.insert(std::minmax(side.block, side.other));
    }
    std::vector<std::string> lengths;
    for (const auto& [boundary, length] : left_out)
        lengths.push_back(fmt::format("'{}' ({:.3g} m)", system.boundaries[boundary].name, length));
    const InnerSide& widest = *std::ranges::max_element(report.inner_sides, {}, &InnerSide::gap);
    const std::string others = pairs.size() > 1 ? fmt::format(", one of {} such pairs", pairs.size()) : "";
    return {fmt::format(
        "{}: blocks {} and {} {} at {}{}: their sides there lie in an open joint and not on the outside of the body, "
        "and "
        "are left out of {}; coordinates that agree close a joint, and a boundary with `block` has the sides of its "
        "block as they are",
        geometry.places.blocks, block_label(system, widest.block), block_label(system, widest.other),
        widest.gap > 0.0 ? fmt::format("are up to {:.2g} m apart", widest.gap)
                         : "share an edge, and their corners beside it do not meet,",
        place_text(widest.at), others, fmt::join(lengths, ", "))};
}

/// The interface types that bonds and fractures of the body have, and that surfaces have which meet where none was.
std::set<int> types_in(const Scene& scene, const BlockSystem& system) {
    std::set<int> types;
    for (const Interface& interface : system.interfaces) types.insert(interface.interface_type);
    if (system.outline_type >= 0) types.insert(system.outline_type);
    const std::vector<int> unbroken(types.begin(), types.end());
    for (const int type : unbroken)
        if (const int broken = scene.interface_types[static_cast<std::size_t>(type)].fails_to; broken >= 0)
            types.insert(broken);
    return types;
}

/// Fractures of the body with a cohesion whose friction has been forgotten: it slides at that cohesion however hard it is pressed.
std::vector<std::string> cohesion_without_friction(const Scene& scene, const BlockSystem& system) {
    std::vector<std::string> warnings;
    for (const int index : types_in(scene, system)) {
        const InterfaceType& type = scene.interface_types[static_cast<std::size_t>(index)];
        const std::string path = joined_path("interfaces", type.name);
        const bool is_meant =
            std::ranges::find(scene.places, joined_path(path, "friction_angle"), &KeyPlace::path) != scene.places.end();
        if (type.kind != InterfaceKind::fracture || !(type.cohesion > 0.0) || is_meant) continue;
        warnings.push_back(fmt::format(
            "{}: without friction_angle the fracture has no friction, and slides at {:.4g} MPa however hard "
            "it is pressed; friction_angle: 0 says that this is meant",
            joined_path(path, "cohesion"), 1e-6 * type.cohesion));
    }
    return warnings;
}

bool is_loaded(const Stage& stage, bool has_weight) {
    const auto is_pressure = [](const auto& each) { return each.second != 0.0; };
    const auto is_force = [](const auto& each) { return !each.second.isZero(); };
    return has_weight || stage.motion || std::ranges::any_of(stage.pressure, is_pressure) ||
           std::ranges::any_of(stage.forces, is_force);
}

/// Why a body with fractures has no interface; "" without fractures. It begins with the place of the first that is to blame.
std::string cause_of_no_interface(const Scene& scene, const CutReport& report) {
    const std::vector<FractureTrace>& fractures = scene.geometry.fractures;
    if (fractures.empty()) return {};
    const auto outside = traces_outside(scene.geometry);
    if (!outside.empty()) {
        const FractureTrace& first = fractures[outside.front().line];
        const std::string others = outside.size() > 1 ? fmt::format(", as are {} more", outside.size() - 1) : "";
        return fmt::format("{}: expected a trace that cuts the domain, found {} {}{}", first.place, first.name,
                           outside.front().in_hole ? "in a hole of it" : "outside it", others);
    }
    for (const auto& warnings : {lost_fractures(scene, report), pruned_pieces(scene, report)})
        if (!warnings.empty()) return warnings.front();
    return {};
}

/// Strengths of nothing, or of a body that carries nothing, have no factor of safety: any that is tried would be stood.
/// Interfaces that are not in this body may be in another one of the same study: a warning. Throws InputError for the others.
std::vector<std::string> strengths_of_nothing(const Scene& scene, const Model& model, const CutReport& report) {
    std::vector<std::string> warnings;
    const std::set<int> types = types_in(scene, model.system);
    const bool has_weight = has_gravity(model) && std::ranges::any_of(model.system.blocks, [&](const Block& block) {
                                return !block.fixed && model.densities[static_cast<std::size_t>(block.material)] > 0.0;
                            });
    bool loaded = false;
    for (std::size_t s = 0; s < model.loads.stages.size(); ++s) {
        const Stage& stage = model.loads.stages[s];
        loaded = loaded || is_loaded(stage, has_weight);
        if (!stage.strength_reduction) continue;
        const std::string key = fmt::format("stages.{}.strength_reduction", s);
        if (types.empty()) {
            const std::string cause = cause_of_no_interface(scene, report);
            if (cause.empty())
                throw InputError(key + ": expected a body with an interface whose strength can be divided, found one "
                                       "without any");
            throw InputError(
                fmt::format("{}; so the body has no interface whose strength {} could divide", cause, key));
        }
        const std::vector<int>& named = stage.strength_reduction->interface_types;
        std::vector<std::string> names;
        for (const int type : named) names.push_back(scene.interface_types[static_cast<std::size_t>(type)].name);
        if (!named.empty() && std::ranges::none_of(named, [&](int type) { return types.contains(type); }))
            warnings.push_back(
                fmt::format("{}.interfaces: none of {} occurs in the body: no strength is divided, and what is "
                            "found is no factor of safety",
                            key, fmt::join(names, ", ")));
        if (!loaded)
            throw InputError(
                fmt::format("{}: expected a body that carries loads, found none: no pressure, force or platen{}", key,
                            has_gravity(model) ? ", and gravity where no block that can move has a density above 0"
                                               : " or gravity"));
    }
    return warnings;
}

/// A pressure beside weight is often that of water, which would press in the joints that come out at its boundary too.
std::vector<std::string> pressed_joints(const Model& model) {
    if (!has_gravity(model)) return {};
    const BlockSystem& system = model.system;
    std::map<int, int> first_stage; // with a pressure on it, by boundary
    for (int s = 0; s < static_cast<int>(model.loads.stages.size()); ++s)
        for (const auto& [boundary, pressure] : model.loads.stages[s].pressure)
            if (pressure > 0.0) first_stage.emplace(boundary, s);
    std::vector<std::string> warnings;
    for (const auto& [boundary, stage] : first_stage) {
        std::set<int> vertices;
        for (const Block& block : system.blocks)
            for (const Edge& edge : block.edges)
                if (edge.boundary == boundary) vertices.insert({edge.start, edge.end});
        const auto n = std::ranges::count_if(system.interfaces, [&](const Interface& interface) {
            const Edge& edge = system.blocks[interface.block_a].edges[interface.edge_a];
            return model.bonds[static_cast<std::size_t>(law_of(interface))] == 0 &&
                   (vertices.contains(edge.start) || vertices.contains(edge.end));
        });
        if (n == 0) continue;
        const std::string& name = system.boundaries[boundary].name;
        warnings.push_back(fmt::format(
            "stages.{}.pressure.{}: the pressure acts on the face and not in the joints that come out there ({}): "
            "right "
            "for a membrane or a foundation; water would press in them as well (uplift), and the body be weaker than "
            "found",
            stage, name, n));
    }
    return warnings;
}

/// The blocks of the scene's body.
CutBody cut_body(const Scene& scene) {
    try {
        return cut_blocks(scene.geometry);
    } catch (const InputError& error) {
        throw located(error, scene.places);
    }
}

} // namespace

ModelInput model_input(const Scene& scene) {
    ModelInput input;
    input.plane = scene.plane;
    input.kinematics = scene.kinematics;
    input.gravity = {scene.gravity_x, scene.gravity_y};
    input.materials = scene.materials;
    input.interface_types = scene.interface_types;
    input.tessellation_type = scene.geometry.tessellation ? scene.geometry.tessellation->interface_type : -1;
    if (scene.geometry.tessellation) input.net_kind = net_kind(*scene.geometry.tessellation);
    input.strength_noise = scene.cracks.strength_noise;
    input.loads = scene.loads;
    input.histories = scene.output.histories;
    return input;
}

SceneModel build_scene_model(const Scene& scene) {
    CutBody body = cut_body(scene);
    refuse_points_taken_off(scene, body);
    SceneModel built;
    try {
        built.model = build_model(std::move(body.system), model_input(scene));
        for (const auto& warnings : {strengths_of_nothing(scene, built.model, body.report), pressed_joints(built.model),
                                     cohesion_without_friction(scene, built.model.system)})
            built.model.warnings.insert(built.model.warnings.end(), warnings.begin(), warnings.end());
    } catch (const InputError& error) {
        blame_coarse_net(scene.geometry, error);
        throw located(error, scene.places);
    }
    for (std::string& warning : built.model.warnings) warning = located(warning, scene.places);
    built.cut = std::move(body.report);
    for (const auto& warnings :
         {lost_fractures(scene, built.cut), fine_details(scene.geometry, built.cut), pruned_pieces(scene, built.cut),
          closed_outcrops(scene.geometry, built.cut), taken_off(scene.geometry, built.cut),
          small_reference(scene.geometry, built.model.system), slivers(scene.geometry, built.model.system),
          slivers_of_net(scene.geometry, built.model.system, built.cut), necks(scene.geometry, built.model.system),
          bare_net(scene.geometry, built.model.system), empty_regions(scene.geometry, built.model.system),
          ragged_regions(scene.geometry, built.model.system), scattered_sides(scene),
          open_joints(scene.geometry, built.model.system, built.cut), warnings_of_cut_net(scene, built.model.system),
          coarse_places(scene.geometry, built.cut, scene.interface_types),
          openings_in_large_blocks(scene.geometry, built.model.system, built.cut.resolution, scene.kinematics)})
        built.model.warnings.insert(built.model.warnings.end(), warnings.begin(), warnings.end());
    require_memory();
    return built;
}

} // namespace kluft
