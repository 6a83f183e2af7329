#include "kluft/scene/load_reader.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "kluft/scene/quantity.hpp"

namespace kluft {

namespace {

/// In the order of PlatenControl.
constexpr std::array<std::string_view, 3> platen_keys{"displacement", "strain", "stress"};

class LoadReader {
public:
    LoadReader(const std::vector<std::string>& boundaries, const std::vector<std::string>& blocks,
               const std::vector<std::string>& interfaces, bool has_gravity, ReadingContext& context)
        : boundaries_(boundaries), blocks_(blocks), interfaces_(interfaces), context_(context),
          has_gravity_(has_gravity) {}

    void read_supports(const std::vector<SceneSection>& sections) {
        loads_.supports.assign(boundaries_.size(), Support::none);
        for (const auto& section : sections) {
            const auto boundary = boundary_index(section, {}, section.name());
            if (boundary) support(*boundary) = static_cast<Support>(section.choice("support"));
        }
    }

    void read_stage(const SceneSection& section) {
        Stage stage;
        stage.name = section.given_text("name").value_or(fmt::format("stage {}", loads_.stages.size()));
        stage.platen_friction = platen_friction(section);
        stage.steps = section.count("steps");
        if (section.has("pressure")) read_pressure(section.section("pressure"), stage);
        stage.gravity = section.given_gravity("gravity");
        has_gravity_ = has_gravity_ || stage.gravity.has_value();
        for (const auto& force : section.sections("forces")) read_force(force, stage);
        read_platen(section, stage);
        read_stop(section, stage);
        const bool has_platen =
            std::any_of(platen_keys.begin(), platen_keys.end(), [&](auto key) { return section.has(key); });
        if (section.has("platens") && !has_platen)
            context_.fail(section, "platens",
                          "expected a moved boundary (displacement, strain or stress) in the same stage, found none; "
                          "there are platens only in stages that move one");
        if (section.has("strength_reduction")) {
            read_strength_reduction(section, stage);
            loads_.stages.push_back(std::move(stage));
            return;
        }
        const bool has_pressure = section.has("pressure") && !section.value("pressure")->items.empty();
        if (!has_gravity_ && !has_platen && !has_pressure && loads_.forces.empty() && section.node()->is_mapping())
            context_.fail(section, {},
                          "expected a load (pressure, displacement, strain, stress or forces) because there is no "
                          "gravity, found none");
        loads_.stages.push_back(std::move(stage));
    }

    LoadProgram take() { return std::move(loads_); }

private:
    Support& support(int boundary) { return loads_.supports[static_cast<std::size_t>(boundary)]; }

    std::optional<int> boundary_index(const SceneSection& section, std::string_view key, const std::string& name) {
        return boundaries_.empty() ? std::nullopt : context_.index_of(section, key, name, boundaries_, "a boundary");
    }

    void read_pressure(const SceneSection& pressure, Stage& stage) {
        for (const auto& name : pressure.names()) {
            const auto boundary = boundary_index(pressure, name, name);
            const SceneNode& value = *pressure.value(name);
            if (!boundary || !value.is_scalar()) continue;
            stage.pressure[*boundary] = read_quantity(value.text, Measure::stress).value.value_or(0.0);
            if (support(*boundary) != Support::none)
                context_.warn(pressure, name, "a pressure has no effect where the boundary is supported");
        }
    }

    void read_force(const SceneSection& section, Stage& stage) {
        if (!section.node()->is_mapping()) return;
        const std::string name = section.name();
        const auto known = std::find_if(loads_.forces.begin(), loads_.forces.end(),
                                        [&](const PointForce& force) { return force.name == name; });
        const auto block = section.given_text("block");
        if (block && !context_.index_of(section, "block", *block, blocks_, "a block or a set of one")) return;
        const auto index = static_cast<int>(known - loads_.forces.begin());
        if (known == loads_.forces.end()) {
            if (!section.has("point"))
                context_.fail(section, {}, "expected a point [x, y] in m because the force is new, found nothing");
            loads_.forces.push_back({name, block.value_or(""), section.point("point")});
        } else if ((block && *block != known->block) ||
                   (section.has("point") && section.given_point("point").value_or(known->point) != known->point)) {
            context_.fail(section, {},
                          "expected the block and the point where the force acts in the stages before, found others; a "
                          "force elsewhere needs another name");
        }
        stage.forces[index] = section.point("force");
    }

    void read_platen(const SceneSection& section, Stage& stage) {
        std::optional<std::string_view> first;
        for (std::size_t i = 0; i < platen_keys.size(); ++i) {
            const auto key = platen_keys[i];
            if (!section.has(key)) continue;
            if (first) {
                context_.fail(section, key,
                              fmt::format("expected one platen in a stage, found {} beside {}", key, *first));
                continue;
            }
            first = key;
            const auto platen = section.section(key);
            const auto name = platen.given_text("boundary");
            const auto boundary = name ? boundary_index(platen, "boundary", *name) : std::nullopt;
            if (!boundary) continue;
            stage.motion = PlatenMotion{static_cast<PlatenControl>(i),
                                        *boundary,
                                        platen.number("value"),
                                        platen.boolean("glued"),
                                        context_.place(platen, "boundary"),
                                        boundary_against(platen, *boundary)};
            check_platen(platen, *name, stage);
            if (stage.motion->value < 0.0 && !stage.motion->glued && !is_pressed(*boundary))
                context_.warn(
                    platen, "value",
                    "the platen leaves the body, which it holds in tension only if it is glued (glued: true)");
        }
    }

    /// What rests on a fixed platen, where the scene says so.
    std::optional<int> boundary_against(const SceneSection& platen, int moved) {
        const auto name = platen.given_text("against");
        if (!name) return std::nullopt;
        if (*name == "none") return -1;
        const auto against = boundary_index(platen, "against", *name);
        if (against == moved)
            context_.fail(
                platen, "against",
                fmt::format("expected another boundary than the one that is moved, or none, found {}", *name));
        return against;
    }

    /// Only where a platen of given travel acts on the boundary that the axial stress is measured on.
    void read_stop(const SceneSection& section, Stage& stage) {
        stage.stop_after_drop = section.given_number("stop_after_drop");
        if (!section.has("stop_after_drop")) return;
        if (!section.has("displacement") && !section.has("strain"))
            return context_.fail(section, "stop_after_drop",
                                 "expected a displacement or a strain of a platen in the same stage, found none");
        const auto first = std::ranges::find_if(loads_.stages, [](const Stage& s) { return s.motion.has_value(); });
        if (first == loads_.stages.end() || !stage.motion || first->motion->boundary == stage.motion->boundary) return;
        context_.fail(
            section, "stop_after_drop",
            fmt::format("expected a platen on '{}', on which the axial stress is measured because it is moved "
                        "first, found one on '{}'",
                        boundaries_[static_cast<std::size_t>(first->motion->boundary)],
                        boundaries_[static_cast<std::size_t>(stage.motion->boundary)]));
    }

    /// At the end of the stages so far: by the pressure that acts there, or by a platen, which may go back from where it has
    /// pressed.
    [[nodiscard]] bool is_pressed(int boundary) const {
        bool pressed = false;
        for (const Stage& stage : loads_.stages) {
            const auto pressure = stage.pressure.find(boundary);
            if (pressure != stage.pressure.end()) pressed = pressure->second > 0.0;
            if (stage.motion && stage.motion->boundary == boundary) pressed = true;
        }
        return pressed;
    }

    /// tan of the friction angle.
    static double platen_friction(const SceneSection& stage) {
        const SceneNode* node = stage.value("platens");
        if (node != nullptr && node->is_mapping()) return std::tan(stage.section("platens").number("friction_angle"));
        constexpr int rough = 1;
        return stage.choice("platens") == rough ? std::numeric_limits<double>::infinity() : 0.0;
    }

    /// The loads stay: it is not the first stage, and has none of its own.
    void read_strength_reduction(const SceneSection& stage_section, Stage& stage) {
        const auto section = stage_section.section("strength_reduction");
        StrengthReduction reduction;
        reduction.from = section.number("from");
        reduction.to = section.number("to");
        reduction.tolerance = section.number("tolerance");
        if (section.given_number("to") && !(reduction.to > reduction.from))
            context_.fail(section, "to",
                          fmt::format("expected a number > from ({:g}), found {:g}", reduction.from, reduction.to));
        if (const SceneNode* names = section.value("interfaces"); names != nullptr && names->is_list()) {
            for (const SceneNode& name : names->items) {
                if (!name.is_scalar()) continue;
                const auto type = context_.index_of(section, "interfaces", name.text, interfaces_, "an interface");
                if (!type) continue;
                reduction.interface_types.push_back(*type);
                reduction.names.push_back(name.text);
            }
        }
        if (loads_.stages.empty())
            context_.fail(stage_section, "strength_reduction",
                          "expected a stage before it that brings up the loads, found the first stage");
        for (const auto key : {"pressure", "displacement", "strain", "stress", "forces", "gravity"})
            if (stage_section.has(key))
                context_.fail(stage_section, key,
                              "expected no load in a stage with a strength_reduction, in which loads stay");
        stage.strength_reduction = std::move(reduction);
    }

    void check_platen(const SceneSection& platen, const std::string& name, const Stage& stage) {
        if (stage.pressure.contains(stage.motion->boundary))
            context_.fail(platen, "boundary",
                          fmt::format("expected a boundary without a pressure in the same stage, found '{}'", name));
    }

    const std::vector<std::string>& boundaries_;
    const std::vector<std::string>& blocks_;
    const std::vector<std::string>& interfaces_;
    ReadingContext& context_;
    bool has_gravity_; ///< in the analysis or a stage so far
    LoadProgram loads_;
};

} // namespace

LoadProgram read_loads(const SceneSection& root, const std::vector<std::string>& boundaries,
                       const std::vector<std::string>& blocks, const std::vector<std::string>& interfaces,
                       bool has_gravity, ReadingContext& context) {
    LoadReader reader(boundaries, blocks, interfaces, has_gravity, context);
    reader.read_supports(root.sections("boundaries"));
    for (const auto& section : root.sections("stages")) reader.read_stage(section);
    return reader.take();
}

} // namespace kluft
