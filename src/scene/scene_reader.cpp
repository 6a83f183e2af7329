#include "kluft/scene/scene_reader.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <set>
#include <utility>

#include <fmt/format.h>

#include "kluft/core/diagnostics.hpp"
#include "kluft/core/nearest_name.hpp"
#include "kluft/scene/geojson.hpp"
#include "kluft/scene/outline.hpp"
#include "kluft/scene/scene_section.hpp"
#include "kluft/scene/scene_text.hpp"

namespace kluft {

namespace {

constexpr double most_hexagons = 2e7; ///< beyond what memory holds; the spacing's unit is wrong

template <class T> std::vector<std::string> names_of(const std::vector<T>& items) {
    std::vector<std::string> names;
    for (const auto& item : items) names.push_back(item.name);
    return names;
}

/// Fills a scene from a tree that has been checked against the schema, and checks what no table can say: references,
/// keys that exclude or need each other, geometry.
class SceneConversion {
public:
    SceneConversion(const SceneNode& root, std::filesystem::path directory, SceneErrors& errors)
        : root_(&root, {}, {}), directory_(std::move(directory)), errors_(errors) {}

    Scene convert() {
        scene_.title = root_.given_text("title").value_or("");
        read_analysis();
        read_materials();
        read_interfaces();
        read_geometry();
        read_boundaries();
        read_stages();
        read_options();
        check_whole();
        return std::move(scene_);
    }

private:
    void fail(const SceneSection& section, std::string_view key, const std::string& what) {
        errors_.add(section.position(key), key.empty() ? section.path() : section.path_of(key), what);
    }

    /// Index of the name that a key gives; nothing (and an error) for an unknown one, nothing without the key.
    std::optional<int> reference(const SceneSection& section, std::string_view key,
                                 const std::vector<std::string>& names, const std::string& what) {
        const auto name = section.given_text(key);
        return name ? named(section, key, *name, names, what) : std::nullopt;
    }

    std::optional<int> named(const SceneSection& section, std::string_view key, const std::string& name,
                             const std::vector<std::string>& names, const std::string& what) {
        const auto found = std::find(names.begin(), names.end(), name);
        if (found != names.end()) return static_cast<int>(found - names.begin());
        fail(section, key,
             fmt::format("expected the name of {} ({}), found {}{}", what, listed(names), in_quotes(name),
                         suggestion(name, names)));
        return std::nullopt;
    }

    /// The same with a default where there is only one name.
    int reference_or_only(const SceneSection& section, std::string_view key, const std::vector<std::string>& names,
                          const std::string& what) {
        if (section.has(key) || names.size() == 1) return reference(section, key, names, what).value_or(0);
        fail(section, key, fmt::format("expected the name of {} ({}), found nothing", what, listed(names)));
        return 0;
    }

    void read_analysis() {
        const auto analysis = root_.section("analysis");
        scene_.plane = static_cast<Plane>(analysis.choice("plane"));
        const SceneNode* gravity = analysis.value("gravity");
        if (gravity == nullptr) return;
        const Vec2 acceleration = analysis.point("gravity");
        scene_.gravity_x = acceleration.x();
        scene_.gravity_y = gravity->is_list() ? acceleration.y() : 0.0 - gravity_magnitude(*gravity);
    }

    static double gravity_magnitude(const SceneNode& node) {
        return read_quantity(node.text, Measure::acceleration).value.value_or(0.0);
    }

    /// Cohesion, friction angle and tensile strength: all three or none.
    std::optional<Strength> read_strength(const SceneSection& section) {
        constexpr std::array<std::string_view, 3> keys{"cohesion", "friction_angle", "tensile_strength"};
        const auto n_given = std::count_if(keys.begin(), keys.end(), [&](auto key) { return section.has(key); });
        if (n_given == 0) return std::nullopt;
        for (const auto key : keys)
            if (!section.has(key))
                fail(section, key,
                     "expected cohesion, friction_angle and tensile_strength together or none of them, found nothing");
        Strength strength{section.number("cohesion"), section.number("friction_angle"),
                          section.number("tensile_strength")};
        limit_tension(section, strength);
        return strength;
    }

    /// Mohr-Coulomb's apex: no tension above c cot(phi).
    void limit_tension(const SceneSection& section, Strength& strength) {
        if (strength.friction_angle <= 0.0) return;
        const double apex = strength.cohesion / std::tan(strength.friction_angle);
        if (strength.tensile_strength <= apex) return;
        scene_.warnings.push_back(fmt::format("{}: {:g} Pa is above cohesion cot(friction_angle); taken as {:g} Pa",
                                              section.path_of("tensile_strength"), strength.tensile_strength, apex));
        strength.tensile_strength = apex;
    }

    void read_materials() {
        for (const auto& section : root_.sections("materials")) {
            Material material;
            material.name = section.path().substr(std::string_view("materials.").size());
            material.density = section.number("density");
            material.youngs_modulus = section.number("youngs_modulus");
            material.poissons_ratio = section.number("poissons_ratio");
            material.strength = read_strength(section);
            scene_.materials.push_back(std::move(material));
        }
    }

    void read_interfaces() {
        const auto sections = root_.sections("interfaces");
        for (const auto& section : sections) {
            InterfaceType type;
            type.name = section.path().substr(std::string_view("interfaces.").size());
            const auto kind = section.given_choice("kind");
            type.kind = kind == 1 ? InterfaceKind::potential_crack : InterfaceKind::fracture;
            read_stiffness(section, type);
            type.dilation_angle = section.number("dilation_angle");
            type.cohesion_onset = section.given_number("cohesion_onset");
            type.contact_rounding = section.given_number("contact_rounding");
            type.friction_rounding = section.number("friction_rounding");
            if (kind == 0) read_fracture(section, type);
            if (kind == 1) read_potential_crack(section, type);
            scene_.interface_types.push_back(std::move(type));
        }
        for (std::size_t i = 0; i < sections.size(); ++i)
            if (sections[i].given_choice("kind") == 1) scene_.interface_types[i].fails_to = successor(sections[i]);
    }

    void read_stiffness(const SceneSection& section, InterfaceType& type) {
        type.normal_stiffness = section.given_number("normal_stiffness");
        type.shear_stiffness = section.given_number("shear_stiffness");
        type.normal_stiffness_times_spacing = section.given_number("normal_stiffness_times_spacing");
        type.shear_stiffness_times_spacing = section.given_number("shear_stiffness_times_spacing");
        type.stiffness_ratio = section.given_number("stiffness_ratio");
        type.shear_ratio = section.given_number("shear_ratio");
        check_stiffness_keys(section);
        if (type.stiffness_ratio && (*type.stiffness_ratio < 5.0 || *type.stiffness_ratio > 20.0))
            scene_.warnings.push_back(fmt::format("{}: {:g} is outside the good range, 5 to 20",
                                                  section.path_of("stiffness_ratio"), *type.stiffness_ratio));
    }

    void check_stiffness_keys(const SceneSection& section) {
        using Ways = std::array<std::pair<std::string_view, std::string_view>, 3>;
        constexpr Ways ways{{{"normal_stiffness", "shear_stiffness"},
                             {"normal_stiffness_times_spacing", "shear_stiffness_times_spacing"},
                             {"stiffness_ratio", "shear_ratio"}}};
        std::optional<std::string_view> first;
        for (const auto& [normal, shear] : ways) {
            if (!section.has(normal) && !section.has(shear)) continue;
            const std::string_view given = section.has(normal) ? normal : shear;
            if (first) {
                fail(section, given,
                     fmt::format("expected one way to give the stiffness, found {} beside {}", given, *first));
                continue;
            }
            first = given;
            if (normal == "stiffness_ratio") continue;
            for (const auto key : {normal, shear})
                if (!section.has(key))
                    fail(section, key, fmt::format("expected a value because {} is given, found nothing", given));
        }
    }

    void read_fracture(const SceneSection& section, InterfaceType& type) {
        type.friction_angle = section.number("friction_angle");
        type.cohesion = section.number("cohesion");
        if (section.number("tensile_strength") > 0.0)
            fail(section, "tensile_strength", "expected 0 or nothing for a fracture, which carries no tension");
        if (section.has("fails_to"))
            fail(section, "fails_to", "expected nothing for a fracture, which has failed already");
        if (type.dilation_angle > type.friction_angle)
            fail(section, "dilation_angle",
                 fmt::format("expected at most the friction angle ({:g} deg), found {}",
                             type.friction_angle * 180.0 / std::numbers::pi,
                             found_text(*section.value("dilation_angle"))));
    }

    void read_potential_crack(const SceneSection& section, InterfaceType& type) {
        type.strength = read_strength(section);
        for (const auto* key : {"dilation_angle", "cohesion_onset", "contact_rounding", "friction_rounding"})
            if (section.has(key))
                scene_.warnings.push_back(
                    fmt::format("{}: has no effect on a potential crack; the fracture that it fails to has its own",
                                section.path_of(key)));
    }

    /// What a potential crack becomes.
    int successor(const SceneSection& section) {
        std::vector<std::string> fractures;
        for (const auto& other : root_.sections("interfaces"))
            if (other.given_choice("kind") == 0)
                fractures.push_back(other.path().substr(std::string_view("interfaces.").size()));
        const int choice = reference_or_only(section, "fails_to", fractures, "a fracture");
        if (choice >= static_cast<int>(fractures.size())) return -1;
        const auto names = root_.section("interfaces").names();
        return static_cast<int>(std::find(names.begin(), names.end(), fractures[choice]) - names.begin());
    }

    void read_geometry() {
        const auto geometry = root_.section("geometry");
        auto& spec = scene_.geometry;
        read_domain(geometry.section("domain"));
        for (const auto& section : geometry.sections("fractures")) read_fractures(section);
        if (geometry.has("tessellation")) read_tessellation(geometry.section("tessellation"));
        spec.reference_spacing = geometry.number("reference_spacing");
        spec.minimum_area = geometry.number("minimum_area");
        if (!scene_.materials.empty())
            spec.material = reference_or_only(geometry, "material", names_of(scene_.materials), "a material");
        for (const auto& section : geometry.sections("regions")) {
            MaterialRegion region;
            region.polygon = read_polygon(section, "polygon");
            region.material = reference(section, "material", names_of(scene_.materials), "a material").value_or(0);
            spec.regions.push_back(std::move(region));
        }
    }

    void read_domain(const SceneSection& domain) {
        if (domain.node() == nullptr || !domain.node()->is_mapping()) return;
        constexpr std::array<std::string_view, 3> kinds{"rectangle", "polygon", "file"};
        const auto n_given = std::count_if(kinds.begin(), kinds.end(), [&](auto kind) { return domain.has(kind); });
        if (n_given != 1)
            return fail(domain, {},
                        fmt::format("expected one of rectangle, polygon, file, found {}",
                                    n_given == 0 ? "none of them" : "more than one"));
        if (domain.has("rectangle")) return read_rectangle(domain.section("rectangle"));
        if (domain.has("polygon")) return set_outline(read_polygon(domain, "polygon"));
        read_domain_file(domain);
    }

    void read_rectangle(const SceneSection& rectangle) {
        is_rectangle_ = true;
        const Vec2 lower = rectangle.point("origin");
        const Vec2 upper = lower + Vec2(rectangle.number("width"), rectangle.number("height"));
        set_outline({lower, {upper.x(), lower.y()}, upper, {lower.x(), upper.y()}});
    }

    void read_domain_file(const SceneSection& domain) {
        if (!domain.given_text("file")) return;
        try {
            auto area = read_geojson_area(directory_ / *domain.given_text("file"));
            scene_.geometry.holes = std::move(area.holes);
            set_outline(std::move(area.outline));
        } catch (const InputError& error) {
            fail(domain, "file", error.what());
        }
    }

    void set_outline(Polygon polygon) {
        if (polygon.empty()) return;
        outline_is_clockwise_ = signed_area(polygon) < 0.0;
        scene_.geometry.domain = counter_clockwise(polygon);
    }

    /// A polygon without its closing point; empty (and an error) if it is not simple.
    Polygon read_polygon(const SceneSection& section, std::string_view key) {
        auto points = section.given_points(key);
        if (!points) return {};
        if (points->size() > 3 && points->front() == points->back()) points->pop_back();
        if (!check_distinct(section, key, *points)) return {};
        if (signed_area(*points) == 0.0) {
            fail(section, key, "expected a polygon with an area, found points on a line");
            return {};
        }
        if (const auto sides = crossing_sides(*points)) {
            fail(section, key,
                 fmt::format("expected a simple polygon, found sides {} and {} that cross", sides->first,
                             sides->second));
            return {};
        }
        return *points;
    }

    bool check_distinct(const SceneSection& section, std::string_view key, const std::vector<Vec2>& points) {
        for (std::size_t i = 1; i < points.size(); ++i)
            if (points[i] == points[i - 1]) {
                fail(section, key,
                     fmt::format("expected successive points to differ, found {} and {} equal", i - 1, i));
                return false;
            }
        return true;
    }

    void read_fractures(const SceneSection& section) {
        FractureTrace trace;
        trace.interface_type = interface_of(section);
        const auto number = scene_.geometry.fractures.size() + 1;
        trace.name = section.given_text("name").value_or(fmt::format("fracture {}", number));
        if (section.has("trace") == section.has("file"))
            return fail(
                section, {},
                fmt::format("expected one of trace, file, found {}", section.has("trace") ? "both" : "none of them"));
        if (section.has("file")) return read_trace_file(section, trace);
        auto points = section.given_points("trace");
        if (!points || !check_distinct(section, "trace", *points)) return;
        trace.points = std::move(*points);
        add_trace(section, std::move(trace));
    }

    void read_trace_file(const SceneSection& section, const FractureTrace& common) {
        if (!section.given_text("file")) return;
        try {
            int number = 0;
            for (auto& line : read_geojson_traces(directory_ / *section.given_text("file"))) {
                FractureTrace trace = common;
                trace.points = std::move(line);
                trace.name = fmt::format("{} {}", section.given_text("name").value_or("trace"), ++number);
                add_trace(section, std::move(trace));
            }
        } catch (const InputError& error) {
            fail(section, "file", error.what());
        }
    }

    void add_trace(const SceneSection& section, FractureTrace trace) {
        const auto& domain = scene_.geometry.domain;
        if (!domain.empty() && !boxes_meet(domain, trace.points))
            scene_.warnings.push_back(fmt::format("{}: {} lies outside the domain", section.path(), trace.name));
        scene_.geometry.fractures.push_back(std::move(trace));
    }

    static bool boxes_meet(const std::vector<Vec2>& a, const std::vector<Vec2>& b) {
        const auto box = [](const std::vector<Vec2>& points) {
            Vec2 lower = points.front(), upper = points.front();
            for (const auto& point : points) {
                lower = lower.cwiseMin(point);
                upper = upper.cwiseMax(point);
            }
            return std::pair{lower, upper};
        };
        const auto [lower_a, upper_a] = box(a);
        const auto [lower_b, upper_b] = box(b);
        return (lower_a.array() <= upper_b.array()).all() && (lower_b.array() <= upper_a.array()).all();
    }

    /// Interface type that a fracture or the tessellation names.
    int interface_of(const SceneSection& section) {
        const int type = reference_or_only(section, "interface", names_of(scene_.interface_types), "an interface");
        used_interfaces_.insert(type);
        return type;
    }

    void read_tessellation(const SceneSection& section) {
        const auto hexagons = section.section("hexagons");
        Tessellation tessellation;
        tessellation.hexagons.spacing = hexagons.number("spacing");
        tessellation.hexagons.rotation = hexagons.number("rotation");
        tessellation.hexagons.offset = hexagons.point("offset");
        tessellation.hexagons.jitter = hexagons.number("jitter");
        tessellation.hexagons.seed = static_cast<std::uint64_t>(hexagons.integer("seed"));
        tessellation.interface_type = interface_of(section);
        if (section.has("region")) tessellation.region = read_polygon(section, "region");
        check_hexagon_count(hexagons, tessellation.hexagons.spacing);
        scene_.geometry.tessellation = std::move(tessellation);
    }

    void check_hexagon_count(const SceneSection& hexagons, double spacing) {
        if (spacing <= 0.0) return;
        const double area = std::abs(signed_area(scene_.geometry.domain));
        const double n_hexagons = area / (0.5 * std::numbers::sqrt3 * spacing * spacing);
        if (n_hexagons > most_hexagons)
            fail(hexagons, "spacing",
                 fmt::format("expected a spacing in m that fits the domain, found {}, which makes {:.0e} hexagons",
                             found_text(*hexagons.value("spacing")), n_hexagons));
    }

    void read_boundaries() {
        const auto sections = root_.sections("boundaries");
        if (is_rectangle_) {
            name_rectangle_sides(sections);
        } else if (std::none_of(sections.begin(), sections.end(), [](const SceneSection& section) {
                       return section.has("sides") || section.has("facing");
                   })) {
            name_facing_sides();
        } else {
            for (const auto& section : sections) name_sides(section);
            check_sides_once(sections);
        }
        read_supports(sections);
    }

    static std::string boundary_name(const SceneSection& section) {
        return section.path().substr(std::string_view("boundaries.").size());
    }

    void name_rectangle_sides(const std::vector<SceneSection>& sections) {
        for (const auto* name : {"bottom", "right", "top", "left"}) {
            const int side = static_cast<int>(scene_.geometry.boundaries.size());
            scene_.geometry.boundaries.push_back({name, {side}});
        }
        for (const auto& section : sections)
            for (const auto* key : {"sides", "facing"})
                if (section.has(key))
                    fail(section, key,
                         "expected nothing for a rectangle, whose boundaries are bottom, right, top, left");
    }

    void name_facing_sides() {
        for (const auto facing : {Facing::bottom, Facing::right, Facing::top, Facing::left}) {
            auto sides = sides_facing(scene_.geometry.domain, facing);
            if (!sides.empty())
                scene_.geometry.boundaries.push_back({std::string(facing_name(facing)), std::move(sides)});
        }
    }

    void name_sides(const SceneSection& section) {
        BoundarySides boundary{boundary_name(section), {}};
        const int n_sides = static_cast<int>(scene_.geometry.domain.size());
        if (section.has("sides") == section.has("facing")) {
            fail(
                section, {},
                fmt::format("expected one of sides, facing, found {}", section.has("sides") ? "both" : "none of them"));
        } else if (const auto facing = section.given_choice("facing")) {
            boundary.sides = sides_facing(scene_.geometry.domain, static_cast<Facing>(*facing));
            if (boundary.sides.empty() && n_sides > 0)
                fail(section, "facing", "expected a direction that a side of the domain faces, found none that does");
        } else if (n_sides > 0) {
            for (const long long side : section.integers("sides")) {
                if (side >= n_sides)
                    fail(section, "sides",
                         fmt::format("expected sides of the domain from 0 to {}, found {}", n_sides - 1, side));
                else if (side >= 0)
                    boundary.sides.push_back(
                        counter_clockwise_side(static_cast<int>(side), n_sides, outline_is_clockwise_));
            }
        }
        scene_.geometry.boundaries.push_back(std::move(boundary));
    }

    void check_sides_once(const std::vector<SceneSection>& sections) {
        std::set<int> seen;
        for (std::size_t i = 0; i < sections.size(); ++i)
            for (const int side : scene_.geometry.boundaries[i].sides)
                if (!seen.insert(side).second)
                    fail(sections[i], {},
                         fmt::format("expected each side of the domain once, found side {} again",
                                     counter_clockwise_side(side, static_cast<int>(scene_.geometry.domain.size()),
                                                            outline_is_clockwise_)));
    }

    void read_supports(const std::vector<SceneSection>& sections) {
        const auto names = names_of(scene_.geometry.boundaries);
        scene_.loads.supports.assign(names.size(), Support::none);
        if (scene_.geometry.domain.empty()) return;
        for (const auto& section : sections) {
            const auto found = std::find(names.begin(), names.end(), boundary_name(section));
            if (found != names.end())
                scene_.loads.supports[static_cast<std::size_t>(found - names.begin())] =
                    static_cast<Support>(section.choice("support"));
            else
                named(section, {}, boundary_name(section), names, "a boundary");
        }
    }

    void read_stages() {
        for (const auto& section : root_.sections("stages")) {
            Stage stage;
            stage.name = section.given_text("name").value_or(fmt::format("stage {}", scene_.loads.stages.size()));
            stage.platens = static_cast<Platens>(section.choice("platens"));
            stage.steps = section.count("steps");
            read_pressure(section, stage);
            read_motion(section, stage);
            const bool loads = section.has("pressure") || stage.motion || has_motion_key(section) || has_gravity();
            if (!loads)
                fail(section, {},
                     "expected a load (pressure, displacement, strain or stress) because there is no gravity, found "
                     "none");
            scene_.loads.stages.push_back(std::move(stage));
        }
    }

    [[nodiscard]] bool has_gravity() const { return scene_.gravity_x != 0.0 || scene_.gravity_y != 0.0; }

    static bool has_motion_key(const SceneSection& section) {
        return section.has("displacement") || section.has("strain") || section.has("stress");
    }

    std::optional<int> boundary_index(const SceneSection& section, std::string_view key, const std::string& name) {
        if (scene_.geometry.domain.empty()) return std::nullopt;
        return named(section, key, name, names_of(scene_.geometry.boundaries), "a boundary");
    }

    void read_pressure(const SceneSection& section, Stage& stage) {
        const auto pressure = section.section("pressure");
        for (const auto& name : pressure.names()) {
            const auto boundary = boundary_index(pressure, name, name);
            if (!boundary) continue;
            const SceneNode* value = pressure.value(name);
            if (value->is_scalar())
                stage.pressure[*boundary] = read_quantity(value->text, Measure::stress).value.value_or(0.0);
            if (scene_.loads.supports[static_cast<std::size_t>(*boundary)] != Support::none)
                scene_.warnings.push_back(
                    fmt::format("{}: has no effect where the boundary is supported", pressure.path_of(name)));
        }
    }

    void read_motion(const SceneSection& section, Stage& stage) {
        constexpr std::array<std::string_view, 3> keys{"displacement", "strain", "stress"};
        std::optional<std::string_view> first;
        for (std::size_t i = 0; i < keys.size(); ++i) {
            if (!section.has(keys[i])) continue;
            if (first) {
                fail(section, keys[i],
                     fmt::format("expected one platen in a stage, found {} beside {}", keys[i], *first));
                continue;
            }
            first = keys[i];
            const auto platen = section.section(keys[i]);
            const auto name = platen.given_text("boundary");
            const auto boundary = name ? boundary_index(platen, "boundary", *name) : std::nullopt;
            if (!boundary) continue;
            stage.motion = PlatenMotion{static_cast<PlatenControl>(i), *boundary, platen.number("value")};
            check_platen(platen, stage);
        }
    }

    void check_platen(const SceneSection& platen, const Stage& stage) {
        const int boundary = stage.motion->boundary;
        if (stage.pressure.contains(boundary))
            fail(platen, "boundary", "expected a boundary without a pressure in the same stage, found one with");
        if (scene_.loads.supports[static_cast<std::size_t>(boundary)] != Support::none)
            fail(platen, "boundary", "expected a boundary that can move, found one with a support");
    }

    void read_options() {
        const auto cracks = root_.section("cracks");
        scene_.cracks.criterion = static_cast<CrackCriterion>(cracks.choice("criterion"));
        scene_.cracks.update = static_cast<CrackUpdate>(cracks.choice("update"));
        scene_.cracks.every = cracks.count("every");
        scene_.cracks.event_tolerance = cracks.number("event_tolerance");
        const auto solver = root_.section("solver");
        scene_.solver.tolerance = solver.number("tolerance");
        scene_.solver.balance = solver.number("balance");
        scene_.solver.viscosity = solver.number("viscosity");
        scene_.solver.max_iterations = solver.count("max_iterations");
        scene_.solver.max_cuts = solver.count("max_cuts");
        scene_.solver.max_unbalanced_steps = solver.count("max_unbalanced_steps");
        scene_.solver.tangent = static_cast<Tangent>(solver.choice("tangent"));
        scene_.solver.repeatable = solver.boolean("repeatable");
        const auto output = root_.section("output");
        scene_.output.fields = output.boolean("fields");
        scene_.output.fields_every = output.count("fields_every");
        scene_.output.pictures = output.boolean("pictures");
        scene_.output.checkpoint_every = output.count("checkpoint_every");
    }

    void check_whole() {
        check_densities();
        check_strengths();
        check_spacing();
    }

    void check_densities() {
        if (!has_gravity()) return;
        for (const auto& section : root_.sections("materials"))
            if (!section.has("density"))
                fail(section, "density", "expected a number > 0 in kg/m3 because there is gravity, found nothing");
    }

    /// Potential cracks in use, and what becomes of them, need strengths and a spacing from somewhere.
    void check_strengths() {
        const auto interfaces = root_.sections("interfaces");
        for (const int type : used_interfaces_) {
            if (type >= static_cast<int>(interfaces.size())) continue;
            const auto& interface = scene_.interface_types[static_cast<std::size_t>(type)];
            if (interface.kind != InterfaceKind::potential_crack || interface.strength) continue;
            for (const auto& material : scene_.materials)
                if (!material.strength)
                    fail(interfaces[static_cast<std::size_t>(type)], {},
                         fmt::format("expected cohesion, friction_angle and tensile_strength here or in the material "
                                     "{}, found neither",
                                     material.name));
        }
    }

    void check_spacing() {
        if (root_.section("geometry").has("reference_spacing") || scene_.geometry.tessellation) return;
        const auto interfaces = root_.sections("interfaces");
        for (std::size_t i = 0; i < interfaces.size(); ++i) {
            const auto& type = scene_.interface_types[i];
            const bool is_used = used_interfaces_.contains(static_cast<int>(i));
            if (!is_used || type.normal_stiffness || type.shear_stiffness) continue;
            fail(interfaces[i], {},
                 "expected normal_stiffness and shear_stiffness in Pa/m, or a geometry.tessellation or a "
                 "geometry.reference_spacing that says what the spacing is, found none of them");
        }
    }

    SceneSection root_;
    std::filesystem::path directory_;
    SceneErrors& errors_;
    Scene scene_;
    bool is_rectangle_ = false;
    bool outline_is_clockwise_ = false;
    std::set<int> used_interfaces_;
};

} // namespace

Scene read_scene(const std::filesystem::path& file, const std::vector<std::string>& overrides) {
    return read_scene_text(read_scene_bytes(file), overrides, file);
}

Scene read_scene_text(std::string_view text, const std::vector<std::string>& overrides,
                      const std::filesystem::path& file) {
    SceneSources sources;
    SceneErrors errors(sources);
    const SceneNode root = build_scene_tree(text, file, overrides, sources, errors);
    if (!root.is_mapping()) errors.throw_if_any();
    check_against_schema(root, errors);
    Scene scene = SceneConversion(root, file.parent_path(), errors).convert();
    errors.throw_if_any();
    scene.name = file.stem().string();
    return scene;
}

} // namespace kluft
