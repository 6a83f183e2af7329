#include "kluft/scene/geometry_reader.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <map>
#include <numeric>
#include <optional>
#include <set>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "kluft/blocks/hexagon_lattice.hpp"
#include "kluft/blocks/triangle_net.hpp"
#include "kluft/core/diagnostics.hpp"
#include "kluft/core/nearest_name.hpp"
#include "kluft/core/place_text.hpp"
#include "kluft/geometry/polygon.hpp"
#include "kluft/geometry/predicates.hpp"
#include "kluft/maps/coordinate_system.hpp"
#include "kluft/maps/gdal.hpp"
#include "kluft/scene/map_reader.hpp"
#include "kluft/scene/outline.hpp"
#include "kluft/scene/scene_check.hpp"
#include "kluft/scene/traces_outside.hpp"

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

std::string box_text(const std::vector<Vec2>& points) {
    const Box box = bounding_box(points);
    return fmt::format("from {} to {}", place_text(box.lower), place_text(box.upper));
}

/// "expected one of a, b, found both"; counts how many of the keys are given. A misspelt one is told as a key that is not known,
/// and no second time here.
bool gives_one_of(const SceneSection& section, const std::vector<std::string>& keys, ReadingContext& context,
                  std::string_view why_none = "") {
    std::vector<std::string> given;
    for (const auto& key : keys)
        if (section.has(key)) given.push_back(key);
    if (given.size() == 1) return true;
    const auto is_misspelt = [&](const std::string& key) {
        return std::ranges::find(keys, key) == keys.end() && !nearest_name(key, keys).empty();
    };
    if (given.empty() && std::ranges::any_of(section.names(), is_misspelt)) return false;
    context.fail(section, {},
                 fmt::format("expected one of {}, found {}", fmt::join(keys, ", "),
                             given.empty() ? fmt::format("none of them{}", why_none)
                                           : fmt::format("{}", fmt::join(given, " and "))));
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
        read_crs(geometry);
        if (geometry.has("domain")) read_domain(geometry.section("domain"));
        for (const auto& section : geometry.sections("fractures")) read_fracture(section);
        look_for_traces_outside(geometry);
        if (geometry.has("tessellation")) read_tessellation(geometry.section("tessellation"));
        read_construction_lines(geometry);
        read_reference_spacing(geometry);
        spec_.minimum_area = geometry.given_number("minimum_area");
        if (!materials_.empty() && geometry.node() != nullptr)
            spec_.material = context_.reference(geometry, "material", materials_, "a material").value_or(-1);
        for (const auto& section : geometry.sections("regions")) read_region(section);
        for (const auto& section : geometry.sections("sets")) read_set(section);
        if (!spec_.domain.empty()) name_boundaries(root_.sections("boundaries"));
        return std::move(spec_);
    }

private:
    void read_reference_spacing(const SceneSection& geometry) {
        spec_.reference_spacing = geometry.number("reference_spacing");
        spec_.places.reference_spacing = context_.place(geometry, "reference_spacing");
    }

    // ---- given blocks ----------------------------------------------------------------------------------------

    GeometrySpec read_given(const SceneSection& geometry) {
        read_crs(geometry);
        for (const auto* key : {"fractures", "tessellation", "construction_lines", "regions"})
            if (geometry.has(key))
                context_.fail(
                    geometry, key,
                    fmt::format("expected nothing beside blocks, found {}", found_text(*geometry.value(key))));
        read_reference_spacing(geometry);
        spec_.minimum_area = geometry.given_number("minimum_area");
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
        for (const auto& section : sections)
            if (section.has("hole"))
                context_.fail(
                    section, "hole",
                    fmt::format("expected nothing for given blocks, found {}", found_text(*section.value("hole"))));
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
            if (domain.has("holes"))
                context_.fail(domain, "holes", "expected the holes in the map's polygon, found some beside `file`");
            return read_domain_file(domain);
        }
        for (const auto& hole : domain.sections("holes"))
            if (hole.node()->is_mapping()) spec_.holes.push_back(read_polygon(hole, "polygon"));
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

    /// The coordinate system of the scene.
    void read_crs(const SceneSection& geometry) {
        const auto crs = geometry.given_text("crs");
        if (!crs) return;
        given_crs_ = canonical_crs(*crs);
        spec_.crs = given_crs_;
        crs_place_ = "geometry.crs";
        if (!gdal_problem().empty()) return; // where it is needed that is told
        try {
            const CoordinateSystem system = describe_crs(given_crs_);
            const bool is_in_metres = !system.is_geographic && system.unit == 1.0;
            if (!is_in_metres)
                context_.fail(
                    geometry, "crs",
                    fmt::format("expected a coordinate system in metres such as EPSG:25832, found {}, in {}",
                                system.name,
                                system.is_geographic ? "degrees" : fmt::format("units of {:g} m", system.unit)));
        } catch (const InputError& error) {
            context_.fail(geometry, "crs", error.what());
        }
    }

    /// What a section says of its map.
    [[nodiscard]] MapRequest map_request(const SceneSection& section, const std::filesystem::path& file) const {
        return {.file = file,
                .layer = section.given_text("layer").value_or(""),
                .attribute = {},
                .file_crs = section.given_text("file_crs").value_or(""),
                .scene_crs = given_crs_};
    }

    /// Takes over the coordinate system of a map where the scene names none; all maps of a scene have the same one.
    void take_crs(const std::string& crs, const std::filesystem::path& file) {
        if (crs.empty() || crs == spec_.crs) return;
        if (!spec_.crs.empty())
            throw InputError(
                fmt::format("{}: expected the coordinate system of {}, {}, or `geometry.crs`, to which both "
                            "are projected, found {}",
                            file.string(), crs_place_, spec_.crs, crs));
        spec_.crs = crs;
        crs_place_ = file.string();
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
            auto area = read_map_area(map_request(domain, *file));
            take_crs(area.crs, *file);
            if (!area.remark.empty()) context_.warn(domain, "file", area.remark);
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
        const auto name = section.given_text("name");
        trace.name = name.value_or(fmt::format("fracture {}", spec_.fractures.size() + 1));
        trace.place = context_.place(section, {});
        const bool is_map = section.node()->is_mapping() && section.has("file");
        if (!is_map || !section.has("attribute")) trace.interface_type = interface_of(section);
        if (!section.node()->is_mapping() || !gives_one_of(section, {"trace", "file"}, context_)) return;
        if (is_map) return read_trace_file(section, trace);
        for (const auto* key : {"layer", "file_crs", "attribute", "interfaces"})
            if (section.has(key)) context_.fail(section, key, "expected `file` beside it, found `trace`");
        auto points = section.given_points("trace");
        if (!points || !has_distinct_points(section, "trace", *points)) return;
        trace.points = std::move(*points);
        spec_.fractures.push_back(std::move(trace));
    }

    /// One trace per line of the file, numbered from 1.
    void read_trace_file(const SceneSection& section, const FractureTrace& common) {
        if (section.has("interfaces") && !section.has("attribute"))
            context_.fail(section, "interfaces", "expected `attribute` beside it, whose values it names, found none");
        const auto file = file_of(section);
        if (!file) return;
        try {
            MapRequest request = map_request(section, *file);
            request.attribute = section.given_text("attribute").value_or("");
            MappedTraces read = read_map_traces(request);
            take_crs(read.crs, *file);
            if (!read.remark.empty()) context_.warn(section, "file", read.remark);
            const auto types = interfaces_of_traces(section, read.traces, common.interface_type);
            for (std::size_t i = 0; i < read.traces.size(); ++i) {
                FractureTrace trace = common;
                trace.points = std::move(read.traces[i].points);
                trace.interface_type = types[i];
                trace.name = fmt::format("{} {}", section.given_text("name").value_or("trace"), i + 1);
                spec_.fractures.push_back(std::move(trace));
            }
            n_mapped_ += read.traces.size();
        } catch (const InputError& error) {
            const std::string& key = error.problems().front().path;
            context_.fail(section, key.empty() ? "file" : key, error.what());
        }
    }

    /// The kind of interface of each trace of a map: by an attribute where there is one.
    std::vector<int> interfaces_of_traces(const SceneSection& section, const std::vector<MappedTrace>& traces,
                                          int common) {
        std::vector<int> types(traces.size(), common);
        if (!section.has("attribute")) return types;
        const std::map<std::string, int> chosen = interfaces_by_value(section);
        const bool has_others = section.has("interface");
        const int others = has_others ? interface_of(section) : -1;
        std::map<std::string, int> unknown;
        for (std::size_t i = 0; i < traces.size(); ++i) {
            const auto& value = traces[i].attribute;
            const auto found = value ? chosen.find(*value) : chosen.end();
            types[i] = found == chosen.end() ? others : found->second;
            if (found == chosen.end() && !has_others) ++unknown[value ? in_quotes(*value) : "no value"];
        }
        if (!unknown.empty())
            fail_unknown_values(section, unknown);
        else
            warn_of_absent_values(section, traces);
        return types;
    }

    /// A value that is misspelt chooses no interface, and nothing else would tell of it.
    void warn_of_absent_values(const SceneSection& section, const std::vector<MappedTrace>& traces) {
        std::set<std::string> values;
        for (const MappedTrace& trace : traces)
            if (trace.attribute) values.insert(*trace.attribute);
        const std::vector<std::string> found(values.begin(), values.end());
        for (const auto& each : section.sections("interfaces")) {
            const auto value = each.given_text("value");
            if (!value || values.contains(*value)) continue;
            context_.warn(each, "value",
                          fmt::format("no trace of the map has the value {}, so that none takes this interface; the "
                                      "values of {} are {}{}",
                                      in_quotes(*value), in_quotes(section.given_text("attribute").value_or("")),
                                      listed_near(*value, found), suggestion(*value, found)));
        }
    }

    /// Interfaces by the values of the attribute: those of `interfaces`, or the names of all interfaces themselves.
    std::map<std::string, int> interfaces_by_value(const SceneSection& section) {
        std::map<std::string, int> chosen;
        if (!section.has("interfaces"))
            for (std::size_t i = 0; i < interfaces_.size(); ++i) chosen[interfaces_[i]] = static_cast<int>(i);
        for (const auto& each : section.sections("interfaces")) {
            const auto value = each.given_text("value");
            if (!value) continue;
            if (chosen.contains(*value))
                context_.fail(each, "value",
                              fmt::format("expected each value once, found {} again", in_quotes(*value)));
            chosen[*value] = interface_of(each);
        }
        return chosen;
    }

    void fail_unknown_values(const SceneSection& section, const std::map<std::string, int>& unknown) {
        constexpr std::size_t most_told = 8;
        std::vector<std::string> told;
        int n_traces = 0;
        for (const auto& [value, n] : unknown) {
            n_traces += n;
            if (told.size() < most_told) told.push_back(fmt::format("{} ({})", value, n));
        }
        if (unknown.size() > most_told) told.emplace_back("...");
        context_.fail(section, "attribute",
                      fmt::format("expected values that {}, or `interface` for all others, found {} traces with {}",
                                  section.has("interfaces") ? "`interfaces` names" : "are names of interfaces",
                                  n_traces, fmt::join(told, ", ")));
    }

    /// One line for all of them. A map of which nothing lies in the domain is a mistake, most often of its coordinates.
    void look_for_traces_outside(const SceneSection& geometry) {
        if (spec_.domain.empty() || spec_.fractures.empty()) return;
        const auto outside = traces_outside(spec_);
        if (outside.empty()) return;
        const std::size_t n = spec_.fractures.size();
        if (outside.size() == n && n_mapped_ > 0) {
            std::vector<Vec2> places;
            for (const FractureTrace& trace : spec_.fractures)
                places.insert(places.end(), trace.points.begin(), trace.points.end());
            return context_.fail(
                geometry, "fractures",
                fmt::format("expected traces in the domain, which lies {}, found {} of {} outside{}: they "
                            "lie {}",
                            box_text(spec_.domain), n, n, those_in_holes(outside), box_text(places)));
        }
        if (outside.size() == 1) {
            const FractureTrace& trace = spec_.fractures[outside.front().line];
            context_.warnings.push_back(
                fmt::format("{}: {} lies {}", trace.place, trace.name, whereabouts(outside.front())));
        } else {
            context_.warn(
                geometry, "fractures",
                fmt::format("{} of {} traces lie outside the domain{}", outside.size(), n, those_in_holes(outside)));
        }
    }

    static std::string_view whereabouts(const LineOutside& line) {
        return line.in_hole ? "in a hole of the domain" : "outside the domain";
    }

    /// ", 2 of them in its holes"; "" where none is.
    static std::string those_in_holes(const std::vector<LineOutside>& outside) {
        const auto n = std::ranges::count(outside, true, &LineOutside::in_hole);
        return n > 0 ? fmt::format(", {} of them in its holes", n) : "";
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
        spec_.places.tessellation = context_.place(section, {});
        spec_.places.region = context_.place(section, "region");
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
        look_for_grading_of_nothing(section, grading);
        if (!grading.region.empty() && grading.region_spacing > 0.0)
            check_cell_count(section, "region_spacing", "triangles", triangle_area(1.0),
                             std::min(std::abs(signed_area(grading.region)), net_area_));
        return grading;
    }

    void read_construction_lines(const SceneSection& geometry) {
        const auto sections = geometry.sections("construction_lines");
        std::vector<SceneSection> given;
        if (!sections.empty() && !(spec_.tessellation && spec_.tessellation->triangles))
            context_.fail(geometry, "construction_lines",
                          "expected geometry.tessellation.triangles, which follow them, found none");
        for (const auto& section : sections) {
            if (!section.node()->is_mapping()) continue;
            const auto points = section.given_points("trace");
            if (!points || !has_distinct_points(section, "trace", *points)) continue;
            spec_.construction_lines.push_back(*points);
            given.push_back(section);
        }
        if (spec_.domain.empty()) return;
        for (const LineOutside& each : lines_outside(spec_.domain, spec_.holes, spec_.construction_lines))
            context_.warn(given[each.line], "trace", fmt::format("the line lies {}", whereabouts(each)));
    }

    /// What a net is to be finer at and the body does not have.
    void look_for_grading_of_nothing(const SceneSection& grading, const TriangleGrading& given) {
        if (spec_.domain.empty()) return;
        const auto warn = [&](std::string_view key, std::string_view why) {
            context_.warn(grading, key, fmt::format("has no effect: {}", why));
        };
        if (grading.has("fractures") && traces_outside(spec_).size() == spec_.fractures.size())
            warn("fractures", "there is no mapped fracture in the domain");
        if (grading.has("openings") && spec_.holes.empty()) warn("openings", "the domain has no holes");
        if (!given.region.empty() && is_outside(given.region, spec_.domain, spec_.holes))
            warn("region", "it has no part in the body");
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
            for (const auto& section : sections)
                if (!section.has("hole") || section.has("sides") || section.has("facing")) name_sides(section);
            check_sides_once();
        }
        name_walls_of_holes(sections);
    }

    /// Beside the boundaries of the outline.
    void name_walls_of_holes(const std::vector<SceneSection>& sections) {
        std::set<long long> named;
        for (const auto& section : sections) {
            if (!section.has("hole") || section.has("sides") || section.has("facing")) continue;
            const std::vector<std::string> taken = names_of(spec_.boundaries);
            BoundarySides wall{section.name(), {}};
            if (std::ranges::find(taken, wall.name) != taken.end()) {
                context_.fail(
                    section, "hole",
                    fmt::format("expected a name that no part of the outline has, found {}", in_quotes(wall.name)));
                continue;
            }
            const long long hole = section.integer("hole");
            const std::string problem = problem_of_hole(hole);
            if (!problem.empty())
                context_.fail(section, "hole", problem);
            else if (!named.insert(hole).second)
                context_.fail(section, "hole", fmt::format("expected each hole once, found {} again", hole));
            else
                wall.sides = sides_of_hole(static_cast<int>(hole));
            spec_.boundaries.push_back(std::move(wall));
        }
    }

    [[nodiscard]] std::string problem_of_hole(long long hole) const {
        const auto n_holes = static_cast<long long>(spec_.holes.size());
        if (hole >= 0 && hole < n_holes) return {};
        if (n_holes == 0) return "expected a domain with holes, found none";
        return fmt::format("expected a hole of the domain from 0 to {}, found {}", n_holes - 1, hole);
    }

    [[nodiscard]] std::vector<int> sides_of_hole(int hole) const {
        auto first = static_cast<int>(spec_.domain.size());
        for (int i = 0; i < hole; ++i) first += static_cast<int>(spec_.holes[static_cast<std::size_t>(i)].size());
        std::vector<int> sides(spec_.holes[static_cast<std::size_t>(hole)].size());
        std::iota(sides.begin(), sides.end(), first);
        return sides;
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
            if (sides.empty()) continue;
            spec_.boundaries.push_back(
                {.name = std::string(facing_name(facing)), .sides = std::move(sides), .by_direction = true});
        }
    }

    void name_sides(const SceneSection& section) {
        BoundarySides boundary{section.name(), {}};
        constexpr auto names_end = ": once one boundary has `sides` or `facing`, each says its own";
        if (section.node()->is_mapping() && gives_one_of(section, {"sides", "facing", "hole"}, context_, names_end))
            boundary.sides = section.has("sides") ? counted_sides(section) : facing_sides(section);
        boundary.by_direction = section.has("facing");
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

    void check_sides_once() {
        const int n_sides = static_cast<int>(spec_.domain.size());
        std::set<int> seen;
        for (const BoundarySides& boundary : spec_.boundaries)
            for (const int side : boundary.sides)
                if (!seen.insert(side).second)
                    context_.fail(root_.section("boundaries"), boundary.name,
                                  fmt::format("expected each side of the domain once, found side {} again",
                                              counter_clockwise_side(side, n_sides, is_clockwise_)));
    }

    const SceneSection& root_;
    const std::vector<std::string>& materials_;
    const std::vector<std::string>& interfaces_;
    ReadingContext& context_;
    GeometrySpec spec_;
    bool is_rectangle_ = false;
    std::string given_crs_;    ///< by geometry.crs
    std::string crs_place_;    ///< where spec_.crs is from
    std::size_t n_mapped_ = 0; ///< traces from maps
    double net_area_ = 0.0;    ///< of the part of the domain that triangles fill (m2)
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
