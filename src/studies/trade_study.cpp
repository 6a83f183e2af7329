#include "kluft/studies/trade_study.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "kluft/core/diagnostics.hpp"
#include "kluft/core/nearest_name.hpp"
#include "kluft/core/units.hpp"
#include "kluft/scene/quantity.hpp"
#include "kluft/scene/scene_schema.hpp"
#include "kluft/scene/scene_tree.hpp"

namespace kluft {

namespace {

using Texts = std::vector<std::string>;

constexpr std::array<int, 6> step_counts{25, 50, 100, 200, 400, 800};
constexpr const char* event_tolerance_of_reference = "1e-3";

/// Keys that one integrator only takes: beside the other one they are refused.
constexpr std::array implicit_keys{"solver.detection_every", "solver.accuracy"};
constexpr std::array explicit_keys{"analysis.damping", "analysis.density_scaling", "analysis.loading_rate",
                                   "analysis.crack_check_interval"};

/// A key with the values that it takes.
struct Variation {
    std::string key;
    Texts values;
};

struct Variant {
    std::string name;
    std::vector<Variation> vary;
};

std::string number_text(double value) { return fmt::format("{:.12g}", value); }

/// A text in YAML's double quotes, in one line.
std::string quoted_line(const std::string& text) {
    std::string result = "\"";
    for (const char c : text) {
        if (c == '"' || c == '\\') result += '\\';
        result += c == '\n' || c == '\r' || c == '\t' ? ' ' : c;
    }
    return result + "\"";
}

bool is_known(const std::string& key) { return scene_schema().find(key) != nullptr; }

bool same_number(const std::string& a, const std::string& b) {
    const auto x = read_number(a);
    const auto y = read_number(b);
    return x && y ? *x == *y : a == b;
}

/// What the scene itself has at a key without lists on its way; null if nothing.
const SceneNode* node_at(const SceneNode& tree, const std::string& key) {
    const SceneNode* node = &tree;
    for (std::size_t begin = 0; node != nullptr && begin <= key.size();) {
        const std::size_t end = std::min(key.find('.', begin), key.size());
        node = node->find(std::string_view(key).substr(begin, end - begin));
        begin = end + 1;
    }
    return node;
}

/// What the scene itself says; else what holds without it.
std::string own_setting(const SceneNode& tree, const std::string& key) {
    const SceneNode* const node = node_at(tree, key);
    if (node != nullptr && node->is_scalar()) return node->text;
    const KeyRule* const rule = scene_schema().find(key);
    return rule != nullptr ? std::string(rule->fallback) : std::string{};
}

bool is_potential_crack(const Scene& scene, int type) {
    return type >= 0 && scene.interface_types[static_cast<std::size_t>(type)].kind == InterfaceKind::potential_crack;
}

/// Whether anything in the body can crack; of given blocks, whose interfaces are told by sets, any kind counts.
bool has_potential_cracks(const Scene& scene) {
    const GeometrySpec& geometry = scene.geometry;
    if (geometry.tessellation && is_potential_crack(scene, geometry.tessellation->interface_type)) return true;
    for (const FractureTrace& trace : geometry.fractures)
        if (is_potential_crack(scene, trace.interface_type)) return true;
    if (geometry.tessellation || !geometry.fractures.empty()) return false;
    return std::ranges::any_of(scene.interface_types,
                               [](const InterfaceType& type) { return type.kind == InterfaceKind::potential_crack; });
}

std::optional<std::size_t> main_stage(const Scene& scene) {
    const auto& stages = scene.loads.stages;
    for (std::size_t i = stages.size(); i-- > 0;)
        if (stages[i].motion || stages[i].strength_reduction) return i;
    return std::nullopt;
}

bool moves_platen(const Scene& scene) {
    return std::ranges::any_of(scene.loads.stages, [](const Stage& stage) { return stage.motion.has_value(); });
}

bool reduces_strengths(const Scene& scene) {
    return std::ranges::any_of(scene.loads.stages,
                               [](const Stage& stage) { return stage.strength_reduction.has_value(); });
}

/// Rigid blocks take no stiffness ratio for the interfaces of their net.
bool can_be_rigid(const Scene& scene) {
    if (scene.integrator != Integrator::implicit || !scene.geometry.tessellation) return false;
    const auto& net = scene.interface_types[static_cast<std::size_t>(scene.geometry.tessellation->interface_type)];
    return !net.stiffness_ratio && !net.shear_ratio;
}

/// Collects the variants of the study.
class TradeStudy {
public:
    TradeStudy(const Scene& scene, const SceneNode& tree)
        : scene_(scene), tree_(tree), cracks_(has_potential_cracks(scene)),
          implicit_(scene.integrator == Integrator::implicit) {
        const std::size_t stage = main_stage(scene).value_or(0);
        steps_key_ = fmt::format("stages.{}.steps", stage);
        own_.push_back({steps_key_, {fmt::format("{}", scene.loads.stages[stage].steps)}});
        if (implicit_)
            add_own_implicit_settings();
        else if (cracks_)
            own_.push_back({"analysis.crack_check_interval", {own_setting(tree, "analysis.crack_check_interval")}});
        add_steps();
        add_refinements();
        add_methods();
        add_models();
        add_reference();
    }

    [[nodiscard]] const std::vector<Variant>& variants() const { return variants_; }
    [[nodiscard]] const std::string& along() const { return steps_key_; }

private:
    /// An accuracy would take other steps than those given: only its own variant has one.
    void add_own_implicit_settings() {
        if (cracks_)
            for (const char* key : {"cracks.update", "cracks.every", "cracks.event_tolerance"})
                own_.push_back({key, {own_setting(tree_, key)}});
        for (const char* key : {"solver.tolerance", "solver.detection_every"})
            own_.push_back({key, {own_setting(tree_, key)}});
        if (node_at(tree_, "solver.accuracy") != nullptr) own_.push_back({"solver.accuracy", {"null"}});
    }

    [[nodiscard]] const std::string* own(const std::string& key) const {
        for (const Variation& each : own_)
            if (each.key == key) return &each.values.front();
        return nullptr;
    }

    /// The scene's own settings but for those given.
    [[nodiscard]] std::vector<Variation> own_but(const std::vector<Variation>& others) const {
        std::vector<Variation> all = own_;
        for (const Variation& other : others) {
            const auto same = std::ranges::find(all, other.key, &Variation::key);
            if (same == all.end())
                all.push_back(other);
            else
                *same = other;
        }
        return all;
    }

    void add(const std::string& name, const std::vector<Variation>& others) {
        variants_.push_back({name, own_but(others)});
    }

    /// A variant of those values of a key that are not the scene's own.
    void add_values(const std::string& name, const std::string& key, Texts values) {
        const std::string* const already = own(key);
        if (already != nullptr) std::erase_if(values, [&](const std::string& v) { return same_number(v, *already); });
        if (!values.empty()) add(name, {{key, std::move(values)}});
    }

    void add_steps() {
        std::vector<Variation> crossed{{steps_key_, {}}};
        for (const int steps : step_counts) crossed.front().values.push_back(fmt::format("{}", steps));
        if (cracks_ && implicit_) crossed.push_back({"cracks.update", {"all", "critical_first", "single", "event"}});
        add("steps", crossed);
        const int own_steps = static_cast<int>(*read_number(*own(steps_key_)));
        if (std::ranges::find(step_counts, own_steps) == step_counts.end()) add("own settings", {});
    }

    void add_refinements() {
        if (!implicit_) {
            if (cracks_) add_values("check interval", "analysis.crack_check_interval", {"2", "5", "10", "20"});
            return;
        }
        if (cracks_) add_values("check interval", "cracks.every", {"1", "2", "5"});
        if (cracks_ && *own("cracks.update") == "event")
            add_values("event tolerance", "cracks.event_tolerance", {"2e-2", "1e-2", "2.5e-3", "1e-3"});
        add_values("residual tolerance", "solver.tolerance", {"1e-3", "1e-4", "1e-5", "1e-6", "1e-7"});
        add_values("detection interval", "solver.detection_every", {"1", "2", "5"});
        add_accuracy();
    }

    void add_accuracy() {
        Texts values{"0.05", "0.02", "0.01"};
        const SceneNode* const given = node_at(tree_, "solver.accuracy");
        if (given != nullptr && given->is_scalar()) {
            std::erase_if(values, [&](const std::string& value) { return same_number(value, given->text); });
            values.insert(values.begin(), given->text);
        }
        add("accuracy", {{"solver.accuracy", values}});
    }

    /// Step counts of a method that is looked at beside the scene's: two, so that one can confirm the other.
    [[nodiscard]] Texts own_and_twice() const {
        const std::string& steps = *own(steps_key_);
        return {steps, number_text(2.0 * *read_number(steps))};
    }

    /// The scene's own settings with another integrator, without what that one does not take.
    void add_integrator(const std::string& name, const auto& refused) {
        std::vector<Variation> all = own_but({{steps_key_, own_and_twice()}, {"analysis.integrator", {name}}});
        for (const char* const key : refused) {
            std::erase_if(all, [&](const Variation& each) { return each.key == key; });
            if (node_at(tree_, key) != nullptr) all.push_back({key, {"null"}});
        }
        variants_.push_back({name, std::move(all)});
    }

    void add_methods() {
        if (!implicit_)
            add_integrator("implicit", explicit_keys);
        else if (scene_.kinematics == Kinematics::affine && !reduces_strengths(scene_))
            add_integrator("explicit", implicit_keys);
    }

    void add_models() {
        if (scene_.kinematics == Kinematics::rigid)
            add("affine blocks", {{"analysis.kinematics", {"affine"}}});
        else if (can_be_rigid(scene_))
            add("rigid blocks", {{"analysis.kinematics", {"rigid"}}});
        if (!scene_.geometry.tessellation) return;
        if (const auto& triangles = scene_.geometry.tessellation->triangles) {
            const std::string net = "geometry.tessellation.triangles";
            add("triangle size",
                {{net + ".spacing", {number_text(0.8 * triangles->spacing), number_text(1.25 * triangles->spacing)}}});
            add("other triangles", {{net + ".seed",
                                     {number_text(static_cast<double>(triangles->seed) + 1.0),
                                      number_text(static_cast<double>(triangles->seed) + 2.0)}}});
            return;
        }
        const HexagonLattice& hexagons = scene_.geometry.tessellation->hexagons;
        if (hexagons.spacing <= 0.0) return; // cells of another kind
        const std::string net = "geometry.tessellation.hexagons";
        add("hexagon size",
            {{net + ".spacing", {number_text(0.8 * hexagons.spacing), number_text(1.25 * hexagons.spacing)}}});
        add_turned(net + ".rotation", hexagons.rotation * degrees);
        if (hexagons.jitter == 0.0) add("jittered hexagons", {{net + ".jitter", {"0.1"}}});
        const std::string cells = "geometry.tessellation.voronoi";
        if (is_known(cells + ".spacing") && is_known(cells + ".seed"))
            add("Voronoi cells", {{net, {"null"}},
                                  {cells + ".spacing", {number_text(hexagons.spacing)}},
                                  {cells + ".seed", {"1", "2", "3"}}});
    }

    void add_turned(const std::string& key, double own_degrees) {
        constexpr std::array<double, 4> turns{0.0, 10.0, 20.0, 30.0};
        Texts values;
        for (const double turn : turns)
            if (std::abs(turn - own_degrees) > 1e-6) values.push_back(number_text(turn));
        add("turned hexagons", {{key, values}});
    }

    void add_reference() {
        std::vector<Variation> finest{{steps_key_, {fmt::format("{}", step_counts.back())}}};
        if (!implicit_) {
            add("reference", finest);
            return;
        }
        if (cracks_) {
            finest.push_back({"cracks.update", {"event"}});
            finest.push_back({"cracks.every", {"1"}});
            finest.push_back({"cracks.event_tolerance", {event_tolerance_of_reference}});
        }
        constexpr double tight = 1e-6;
        const auto own_tolerance = read_number(*own("solver.tolerance"));
        if (!own_tolerance || *own_tolerance > tight) finest.push_back({"solver.tolerance", {"1e-6"}});
        finest.push_back({"solver.detection_every", {"1"}});
        add("reference", finest);
    }

    const Scene& scene_;
    const SceneNode& tree_;
    bool cracks_;
    bool implicit_;
    std::string steps_key_;
    std::vector<Variation> own_; ///< numerical settings of the scene, one value each
    std::vector<Variant> variants_;
};

Texts usual_quantities(const Scene& scene) {
    if (moves_platen(scene)) return {"peak_stress", "peak_strain", "youngs_modulus", "residual_stress"};
    if (reduces_strengths(scene)) return {"factor_of_safety"};
    throw InputError(scene.name + ": expected a scene that moves a platen or reduces strengths, or quantities of "
                                  "summary.json to compare, found none of them");
}

SceneNode checked_tree(const Scene& scene) {
    SceneSources sources;
    const int source = sources.add_file(scene.name, scene.text);
    SceneErrors errors(sources);
    SceneNode tree = parse_scene_tree(scene.text, source, {source, 1, 1}, errors);
    errors.throw_if_any();
    return tree;
}

} // namespace

std::string trade_study(const std::filesystem::path& path, const Scene& scene, const Texts& quantities) {
    const Texts compared = quantities.empty() ? usual_quantities(scene) : quantities;
    const SceneNode tree = checked_tree(scene);
    const TradeStudy study(scene, tree);
    std::string text =
        fmt::format("title: {}\nscene: {}\ncombine: product\nvariants:\n",
                    quoted_line("Trade of accuracy against time: " + heading_of(scene)), quoted_line(path.string()));
    for (const Variant& variant : study.variants()) {
        text += fmt::format("  - name: {}\n    vary:\n", variant.name);
        for (const Variation& each : variant.vary)
            text += fmt::format("      {}: [{}]\n", each.key, listed(each.values));
    }
    text += fmt::format("quantities: [{}]\n", listed(compared));
    if (moves_platen(scene)) text += "curve: true\n";
    text += "reference:\n  case: {variant: reference}\n";
    text += fmt::format("along: {}\ntime_limit: 3600\n", study.along());
    return text;
}

} // namespace kluft
