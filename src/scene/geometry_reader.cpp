#include "kluft/scene/geometry_reader.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <set>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "kluft/blocks/hexagon_lattice.hpp"
#include "kluft/blocks/triangle_net.hpp"
#include "kluft/core/diagnostics.hpp"
#include "kluft/geometry/polygon.hpp"
#include "kluft/scene/geojson.hpp"
#include "kluft/scene/outline.hpp"
#include "kluft/scene/scene_check.hpp"

namespace kluft {

namespace {

constexpr int most_sides_checked = 2000; ///< of a polygon here; the block cutter checks all
constexpr int fixed_choice = 1;          ///< of a block's or a set's support

/// Where neighbouring points coincide, if anywhere: the second one's index.
std::optional<std::size_t> repeated_point(const std::vector<Vec2>& points) {
    for (std::size_t i = 1; i < points.size(); ++i)
        if (points[i] == points[i - 1]) return i;
    return std::nullopt;
}

/// What is wrong with a polygon whose successive points differ; "" if nothing.
std::string polygon_problem(const Polygon& polygon) {
    if (const auto crossing = crossing_sides(polygon))
        return fmt::format("expected a simple polygon, found sides {} and {} (counted from 0) that cross",
                           crossing->first, crossing->second);
    if (signed_area(polygon) == 0.0) return "expected a polygon with an area, found none";
    const bool touches = static_cast<int>(polygon.size()) < most_sides_checked && !is_simple(polygon);
    return touches ? "expected a simple polygon, found one that touches itself" : "";
}

void require_simple(const MappedArea& area, const std::filesystem::path& file) {
    const auto require = [&](const Polygon& ring, const std::string& name) {
        if (const std::string problem = polygon_problem(ring); !problem.empty())
            throw InputError(fmt::format("{}: {}: {}", file.string(), name, problem));
    };
    require(area.outline, "outline");
    for (std::size_t i = 0; i < area.holes.size(); ++i) require(area.holes[i], fmt::format("hole {}", i));
}

bool boxes_meet(const std::vector<Vec2>& a, const std::vector<Vec2>& b) {
    const Box box_a = bounding_box(a);
    const Box box_b = bounding_box(b);
    return (box_a.lower.array() <= box_b.upper.array()).all() && (box_b.lower.array() <= box_a.upper.array()).all();
}

/// "expected one of a, b, found both"; counts how many of the keys are given.
bool gives_one_of(const SceneSection& section, const std::vector<std::string_view>& keys, ReadingContext& context) {
    std::vector<std::string> given;
    for (const auto key : keys)
        if (section.has(key)) given.emplace_back(key);
    if (given.size() == 1) return true;
    context.fail(section, {},
                 fmt::format("expected one of {}, found {}", fmt::join(keys, ", "),
                             given.empty() ? "none of them" : fmt::format("{}", fmt::join(given, " and "))));
    return false;
}

class GeometryReader {
public:
    GeometryReader(const SceneSection& root, const std::vector<std::string>& materials,
                   const std::vector<std::string>& interfaces, ReadingContext& context)
        : root_(root), materials_(materials), interfaces_(interfaces), context_(context) {}

    GeometrySpec read() {
        const auto geometry = root_.section("geometry");
        const bool is_given = geometry.node() != nullptr && geometry.node()->is_mapping() &&
                              gives_one_of(geometry, {"domain", "blocks"}, context_) && geometry.has("blocks");
        if (is_given) return read_given(geometry);
        if (geometry.has("domain")) read_domain(geometry.section("domain"));
        for (const auto& section : geometry.sections("fractures")) read_fracture(section);
        if (geometry.has("tessellation")) read_tessellation(geometry.section("tessellation"));
        read_construction_lines(geometry);
        spec_.reference_spacing = geometry.number("reference_spacing");
        spec_.minimum_area = geometry.number("minimum_area");
        if (!materials_.empty() && geometry.node() != nullptr)
            spec_.material = context_.reference(geometry, "material", materials_, "a material").value_or(-1);
        for (const auto& section : geometry.sections("regions")) read_region(section);
        for (const auto& section : geometry.sections("sets")) read_set(section);
        if (!spec_.domain.empty()) name_boundaries(root_.sections("boundaries"));
        return std::move(spec_);
    }

private:
    // ---- given blocks ----------------------------------------------------------------------------------------

    GeometrySpec read_given(const SceneSection& geometry) {
        for (const auto* key : {"fractures", "tessellation", "construction_lines", "regions"})
            if (geometry.has(key))
                context_.fail(
                    geometry, key,
                    fmt::format("expected nothing beside blocks, found {}", found_text(*geometry.value(key))));
        spec_.reference_spacing = geometry.number("reference_spacing");
        spec_.minimum_area = geometry.number("minimum_area");
        spec_.places.blocks = context_.place(geometry, "blocks");
        const auto sections = geometry.sections("blocks");
        for (const auto& section : sections) read_block(geometry, section);
        if (geometry.has("blocks_interface") || !interfaces_.empty() || sections.size() > 1)
            spec_.blocks_interface =
                context_.reference(geometry, "blocks_interface", interfaces_, "an interface").value_or(-1);
        for (const auto& section : geometry.sections("sets")) read_set(section);
        name_block_boundaries(root_.sections("boundaries"));
        return std::move(spec_);
    }

    void read_block(const SceneSection& geometry, const SceneSection& section) {
        GivenBlock block;
        block.name = fmt::format("block {}", spec_.blocks.size() + 1);
        first_side_.push_back(n_sides_);
        block_is_clockwise_.push_back(0);
        if (section.node()->is_mapping()) {
            block.name = section.given_text("name").value_or(block.name);
            check_new_name(section, "name", block.name);
            const Polygon polygon = read_polygon(section, "polygon");
            block_is_clockwise_.back() = !polygon.empty() && signed_area(polygon) < 0.0 ? 1 : 0;
            block.polygon = counter_clockwise(polygon);
            block.material = material_of_block(geometry, section);
            block.fixed = section.choice("support") == fixed_choice;
        }
        n_sides_ += static_cast<int>(block.polygon.size());
        spec_.blocks.push_back(std::move(block));
    }

    int material_of_block(const SceneSection& geometry, const SceneSection& section) {
        if (materials_.empty()) return -1;
        const SceneSection& where = geometry.has("material") && !section.has("material") ? geometry : section;
        return context_.reference(where, "material", materials_, "a material").value_or(-1);
    }

    /// Blocks and sets share one list of names.
    void check_new_name(const SceneSection& section, std::string_view key, const std::string& name) {
        const auto names = block_names(spec_);
        if (std::find(names.begin(), names.end(), name) != names.end())
            context_.fail(section, key,
                          fmt::format("expected each name of a block or a set once, found '{}' again", name));
    }

    void read_set(const SceneSection& section) {
        BlockSetSpec set;
        set.name = section.name();
        check_new_name(section, {}, set.name);
        if (section.node()->is_mapping() && gives_one_of(section, {"polygon", "blocks"}, context_)) {
            if (section.has("polygon")) set.polygon = read_polygon(section, "polygon");
            const auto names = names_of(spec_.blocks);
            for (const auto& name : section.texts("blocks"))
                if (const auto block = context_.index_of(section, "blocks", name, names, "a given block"))
                    set.blocks.push_back(*block);
            set.fixed = section.choice("support") == fixed_choice;
        }
        spec_.sets.push_back(std::move(set));
    }

    void name_block_boundaries(const std::vector<SceneSection>& sections) {
        const bool gives_sides = std::any_of(sections.begin(), sections.end(), [](const SceneSection& section) {
            return section.has("sides") || section.has("facing") || section.has("block");
        });
        if (!gives_sides) {
            for (const auto facing : {Facing::bottom, Facing::right, Facing::top, Facing::left}) {
                auto sides = all_sides_facing(facing);
                if (!sides.empty()) spec_.boundaries.push_back({std::string(facing_name(facing)), std::move(sides)});
            }
            return;
        }
        for (const auto& section : sections) spec_.boundaries.push_back({section.name(), {}});
        std::set<int> taken;
        for (const bool of_one_block : {true, false}) {
            for (std::size_t i = 0; i < sections.size(); ++i)
                if (sections[i].has("block") == of_one_block) take_sides(sections[i], taken, spec_.boundaries[i]);
        }
    }

    /// The sides that a boundary asks for and no boundary of one block has. They are taken then.
    void take_sides(const SceneSection& section, std::set<int>& taken, BoundarySides& boundary) {
        if (!section.node()->is_mapping() || !gives_one_of(section, {"sides", "facing"}, context_)) return;
        std::vector<int> sides;
        if (const auto name = section.given_text("block")) {
            const auto block = context_.index_of(section, "block", *name, names_of(spec_.blocks), "a given block");
            if (!block) return;
            boundary.block = *name;
            sides = section.has("sides") ? counted_sides_of(section, *block) : facing_sides_of(section, *block);
        } else if (section.has("sides")) {
            context_.fail(section, "sides", "expected block: NAME beside it, found none");
        } else if (const auto choice = section.given_choice("facing")) {
            sides = all_sides_facing(static_cast<Facing>(*choice));
            std::erase_if(sides, [&](int side) { return taken.contains(side); });
        }
        for (const int side : sides)
            if (!taken.insert(side).second && !boundary.block.empty())
                context_.fail(
                    section, {},
                    fmt::format("expected each side of the block '{}' once, found one again", boundary.block));
        boundary.sides = std::move(sides);
    }

    std::vector<int> facing_sides_of(const SceneSection& section, int block) {
        const auto choice = section.given_choice("facing");
        if (!choice) return {};
        auto sides = sides_facing(spec_.blocks[block].polygon, static_cast<Facing>(*choice));
        if (sides.empty() && !spec_.blocks[block].polygon.empty())
            context_.fail(section, "facing",
                          fmt::format("expected a direction that a side of the block faces, found {}",
                                      found_text(*section.value("facing"))));
        for (int& side : sides) side += first_side_[block];
        return sides;
    }

    std::vector<int> counted_sides_of(const SceneSection& section, int block) {
        const int n_sides = static_cast<int>(spec_.blocks[block].polygon.size());
        std::vector<int> sides;
        for (const long long side : section.integers("sides")) {
            if (side >= 0 && side < n_sides)
                sides.push_back(first_side_[block] + counter_clockwise_side(static_cast<int>(side), n_sides,
                                                                            block_is_clockwise_[block] != 0));
            else if (side >= 0 && n_sides > 0)
                context_.fail(section, "sides",
                              fmt::format("expected sides of the block from 0 to {}, found {}", n_sides - 1, side));
        }
        return sides;
    }

    [[nodiscard]] std::vector<int> all_sides_facing(Facing facing) const {
        std::vector<int> all;
        for (std::size_t b = 0; b < spec_.blocks.size(); ++b)
            for (const int side : sides_facing(spec_.blocks[b].polygon, facing)) all.push_back(first_side_[b] + side);
        return all;
    }

    // ---- a domain that is cut --------------------------------------------------------------------------------

    void read_domain(const SceneSection& domain) {
        spec_.places.domain = context_.place(domain, {});
        if (!domain.node()->is_mapping() || !gives_one_of(domain, {"rectangle", "polygon", "file"}, context_)) return;
        if (domain.has("rectangle")) {
            read_rectangle(domain.section("rectangle"));
        } else if (domain.has("polygon")) {
            set_outline(read_polygon(domain, "polygon"));
        } else {
            read_domain_file(domain);
        }
    }

    void read_rectangle(const SceneSection& rectangle) {
        is_rectangle_ = true;
        const auto width = rectangle.given_number("width");
        const auto height = rectangle.given_number("height");
        if (!width || !height) return;
        const Vec2 lower = rectangle.point("origin");
        const Vec2 upper = lower + Vec2(*width, *height);
        const Polygon corners{lower, {upper.x(), lower.y()}, upper, {lower.x(), upper.y()}};
        if (signed_area(corners) > 0.0)
            set_outline(corners);
        else
            context_.fail(rectangle, {}, "expected a rectangle with an area, found one that vanishes in round-off");
    }

    /// The file that a key names; relative to the file that the key stands in.
    [[nodiscard]] std::optional<std::filesystem::path> file_of(const SceneSection& section) const {
        const auto name = section.given_text("file");
        if (!name) return std::nullopt;
        return (context_.errors.sources().directory(section.position("file")) / *name).lexically_normal();
    }

    void read_domain_file(const SceneSection& domain) {
        const auto file = file_of(domain);
        if (!file) return;
        spec_.places.domain = fmt::format("{}: {}", context_.place(domain, "file"), file->string());
        try {
            auto area = read_geojson_area(*file);
            require_simple(area, *file);
            spec_.holes = std::move(area.holes);
            set_outline(area.outline);
        } catch (const InputError& error) {
            context_.fail(domain, "file", error.what());
        }
    }

    void set_outline(const Polygon& polygon) {
        if (polygon.empty()) return;
        is_clockwise_ = signed_area(polygon) < 0.0;
        spec_.domain = counter_clockwise(polygon);
    }

    /// A polygon without its closing point; empty (and an error) if it is not simple.
    Polygon read_polygon(const SceneSection& section, std::string_view key) {
        auto points = section.given_points(key);
        if (!points) return {};
        if (points->size() > 3 && points->front() == points->back()) points->pop_back();
        if (!has_distinct_points(section, key, *points)) return {};
        const std::string problem = polygon_problem(*points);
        if (problem.empty()) return *points;
        context_.fail(section, key, problem);
        return {};
    }

    bool has_distinct_points(const SceneSection& section, std::string_view key, const std::vector<Vec2>& points) {
        const auto repeated = repeated_point(points);
        if (repeated)
            context_.fail(
                section, key,
                fmt::format("expected successive points to differ, found points {} and {} (counted from 0) equal",
                            *repeated - 1, *repeated));
        return !repeated;
    }

    void read_fracture(const SceneSection& section) {
        FractureTrace trace;
        trace.interface_type = interface_of(section);
        const auto name = section.given_text("name");
        trace.name = name.value_or(fmt::format("fracture {}", spec_.fractures.size() + 1));
        trace.place = context_.place(section, {});
        if (!section.node()->is_mapping() || !gives_one_of(section, {"trace", "file"}, context_)) return;
        if (section.has("file")) return read_trace_file(section, trace);
        auto points = section.given_points("trace");
        if (!points || !has_distinct_points(section, "trace", *points)) return;
        trace.points = std::move(*points);
        add_trace(section, std::move(trace));
    }

    /// One trace per line of the file, numbered from 1.
    void read_trace_file(const SceneSection& section, const FractureTrace& common) {
        const auto file = file_of(section);
        if (!file) return;
        try {
            int number = 0;
            for (auto& line : read_geojson_traces(*file)) {
                FractureTrace trace = common;
                trace.points = std::move(line);
                trace.name = fmt::format("{} {}", section.given_text("name").value_or("trace"), ++number);
                add_trace(section, std::move(trace));
            }
        } catch (const InputError& error) {
            context_.fail(section, "file", error.what());
        }
    }

    void add_trace(const SceneSection& section, FractureTrace trace) {
        if (!spec_.domain.empty() && !trace.points.empty() && !boxes_meet(spec_.domain, trace.points))
            context_.warn(section, {}, fmt::format("{} lies outside the domain", trace.name));
        spec_.fractures.push_back(std::move(trace));
    }

    /// Index of the interface that a fracture or the tessellation names; -1 for an error.
    int interface_of(const SceneSection& section) {
        if (!section.node()->is_mapping()) return -1;
        return context_.reference(section, "interface", interfaces_, "an interface").value_or(-1);
    }

    void read_tessellation(const SceneSection& section) {
        if (!section.node()->is_mapping()) return;
        if (!gives_one_of(section, {"triangles", "hexagons", "voronoi"}, context_)) return;
        Tessellation tessellation;
        if (section.has("region")) tessellation.region = read_polygon(section, "region");
        net_area_ = signed_area(spec_.domain);
        if (tessellation.region) net_area_ = std::min(net_area_, std::abs(signed_area(*tessellation.region)));
        if (section.has("triangles"))
            tessellation.triangles = read_triangles(section.section("triangles"));
        else if (section.has("hexagons"))
            tessellation.hexagons = read_hexagons(section.section("hexagons"));
        else
            tessellation.voronoi = read_voronoi(section.section("voronoi"));
        tessellation.interface_type = interface_of(section);
        spec_.tessellation = std::move(tessellation);
    }

    HexagonLattice read_hexagons(const SceneSection& section) {
        HexagonLattice hexagons;
        hexagons.spacing = section.number("spacing");
        hexagons.rotation = section.number("rotation");
        hexagons.offset = section.point("offset");
        hexagons.jitter = section.number("jitter");
        hexagons.seed = static_cast<std::uint64_t>(section.integer("seed"));
        check_cell_count(section, "spacing", "hexagons", hexagon_area(1.0), signed_area(spec_.domain));
        return hexagons;
    }

    VoronoiCells read_voronoi(const SceneSection& section) {
        VoronoiCells cells;
        cells.spacing = section.number("spacing");
        cells.offset = section.point("offset");
        cells.relaxation = section.count("relaxation");
        cells.seed = static_cast<std::uint64_t>(section.integer("seed"));
        check_cell_count(section, "spacing", "cells", hexagon_area(1.0), signed_area(spec_.domain));
        return cells;
    }

    TriangleNet read_triangles(const SceneSection& section) {
        TriangleNet net;
        spec_.places.net = context_.place(section, {});
        spec_.places.spacing = context_.place(section, "spacing");
        spec_.places.grading = context_.place(section, "grading");
        net.spacing = section.number("spacing");
        net.relaxation = section.count("relaxation");
        net.seed = static_cast<std::uint64_t>(section.integer("seed"));
        if (section.has("grading")) net.grading = read_grading(section.section("grading"));
        check_cell_count(section, "spacing", "triangles", triangle_area(1.0), net_area_);
        return net;
    }

    TriangleGrading read_grading(const SceneSection& section) {
        TriangleGrading grading;
        grading.fractures = section.given_number("fractures").value_or(0.0);
        grading.openings = section.given_number("openings").value_or(0.0);
        grading.growth = section.number("growth");
        if (section.has("region") != section.has("region_spacing"))
            context_.fail(section, section.has("region") ? "region" : "region_spacing",
                          "expected region and region_spacing together, found one of them");
        if (section.has("region")) grading.region = read_polygon(section, "region");
        grading.region_spacing = section.given_number("region_spacing").value_or(0.0);
        if (!grading.region.empty() && grading.region_spacing > 0.0)
            check_cell_count(section, "region_spacing", "triangles", triangle_area(1.0),
                             std::min(std::abs(signed_area(grading.region)), net_area_));
        return grading;
    }

    void read_construction_lines(const SceneSection& geometry) {
        const auto sections = geometry.sections("construction_lines");
        if (!sections.empty() && !(spec_.tessellation && spec_.tessellation->triangles))
            context_.fail(geometry, "construction_lines",
                          "expected geometry.tessellation.triangles, which follow them, found none");
        for (const auto& section : sections) {
            if (!section.node()->is_mapping()) continue;
            const auto points = section.given_points("trace");
            if (points && has_distinct_points(section, "trace", *points)) spec_.construction_lines.push_back(*points);
        }
    }

    /// `unit_area`: of a cell with a spacing of one metre; `area` of what is filled.
    void check_cell_count(const SceneSection& net, std::string_view key, std::string_view cells, double unit_area,
                          double area) {
        const auto spacing = net.given_number(key);
        if (!spacing) return;
        const double n_cells = area / (unit_area * *spacing * *spacing);
        if (n_cells > most_cells)
            context_.fail(net, key,
                          fmt::format("expected a spacing in m that makes at most {:.0e} {}, found {}, which makes "
                                      "about {:.1e}",
                                      most_cells, cells, found_text(*net.value(key)), n_cells));
    }

    void read_region(const SceneSection& section) {
        MaterialRegion region;
        region.polygon = read_polygon(section, "polygon");
        if (const auto name = section.given_text("material"))
            region.material = context_.index_of(section, "material", *name, materials_, "a material").value_or(-1);
        spec_.regions.push_back(std::move(region));
    }

    void name_boundaries(const std::vector<SceneSection>& sections) {
        for (const auto& section : sections)
            if (section.has("block"))
                context_.fail(
                    section, "block",
                    fmt::format("expected nothing for a domain that is cut, whose blocks have no names, found {}",
                                found_text(*section.value("block"))));
        const bool gives_sides = std::any_of(sections.begin(), sections.end(), [](const SceneSection& section) {
            return section.has("sides") || section.has("facing");
        });
        if (is_rectangle_) {
            name_rectangle_sides(sections);
        } else if (!gives_sides) {
            name_facing_sides();
        } else {
            for (const auto& section : sections) name_sides(section);
            check_sides_once(sections);
        }
    }

    void name_rectangle_sides(const std::vector<SceneSection>& sections) {
        for (const auto& section : sections)
            for (const auto* key : {"sides", "facing"})
                if (section.has(key))
                    context_.fail(section, key,
                                  fmt::format("expected nothing for a rectangle, whose boundaries are bottom, right, "
                                              "top, left, found {}",
                                              found_text(*section.value(key))));
        spec_.boundaries = {{"bottom", {0}}, {"right", {1}}, {"top", {2}}, {"left", {3}}};
    }

    void name_facing_sides() {
        for (const auto facing : {Facing::bottom, Facing::right, Facing::top, Facing::left}) {
            auto sides = sides_facing(spec_.domain, facing);
            if (!sides.empty()) spec_.boundaries.push_back({std::string(facing_name(facing)), std::move(sides)});
        }
    }

    void name_sides(const SceneSection& section) {
        BoundarySides boundary{section.name(), {}};
        if (section.node()->is_mapping() && gives_one_of(section, {"sides", "facing"}, context_))
            boundary.sides = section.has("sides") ? counted_sides(section) : facing_sides(section);
        spec_.boundaries.push_back(std::move(boundary));
    }

    std::vector<int> facing_sides(const SceneSection& section) {
        const auto choice = section.given_choice("facing");
        if (!choice) return {};
        auto sides = sides_facing(spec_.domain, static_cast<Facing>(*choice));
        if (sides.empty())
            context_.fail(section, "facing",
                          fmt::format("expected a direction that a side of the domain faces, found {}",
                                      found_text(*section.value("facing"))));
        return sides;
    }

    std::vector<int> counted_sides(const SceneSection& section) {
        const int n_sides = static_cast<int>(spec_.domain.size());
        std::vector<int> sides;
        for (const long long side : section.integers("sides")) {
            if (side >= 0 && side < n_sides)
                sides.push_back(counter_clockwise_side(static_cast<int>(side), n_sides, is_clockwise_));
            else if (side >= 0)
                context_.fail(section, "sides",
                              fmt::format("expected sides of the domain from 0 to {}, found {}", n_sides - 1, side));
        }
        return sides;
    }

    void check_sides_once(const std::vector<SceneSection>& sections) {
        const int n_sides = static_cast<int>(spec_.domain.size());
        std::set<int> seen;
        for (std::size_t i = 0; i < sections.size(); ++i)
            for (const int side : spec_.boundaries[i].sides)
                if (!seen.insert(side).second)
                    context_.fail(sections[i], {},
                                  fmt::format("expected each side of the domain once, found side {} again",
                                              counter_clockwise_side(side, n_sides, is_clockwise_)));
    }

    const SceneSection& root_;
    const std::vector<std::string>& materials_;
    const std::vector<std::string>& interfaces_;
    ReadingContext& context_;
    GeometrySpec spec_;
    bool is_rectangle_ = false;
    double net_area_ = 0.0; ///< of the part of the domain that triangles fill (m2)
    bool is_clockwise_ = false;
    int n_sides_ = 0;                      ///< of the given blocks so far
    std::vector<int> first_side_;          ///< per given block
    std::vector<char> block_is_clockwise_; ///< as the scene gives it
};

} // namespace

std::vector<std::string> block_names(const GeometrySpec& spec) {
    std::vector<std::string> names = names_of(spec.sets);
    for (const auto& block : spec.blocks) names.push_back(block.name);
    return names;
}

GeometrySpec read_geometry(const SceneSection& root, const std::vector<std::string>& materials,
                           const std::vector<std::string>& interfaces, ReadingContext& context) {
    return GeometryReader(root, materials, interfaces, context).read();
}

} // namespace kluft
