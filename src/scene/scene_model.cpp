#include "kluft/scene/scene_model.hpp"

#include <algorithm>
#include <string>
#include <utility>

#include <fmt/format.h>

namespace kluft {

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

namespace {

/// What is to be said of fractures that the map has and the body has not; "" if there are none.
std::string loss_in_words(const GeometrySpec& spec, const CutReport& cut) {
    constexpr std::size_t most_named = 5;
    const auto& lost = cut.lost_fractures;
    if (lost.empty()) return {};
    std::string names;
    for (std::size_t i = 0; i < std::min(lost.size(), most_named); ++i) {
        const std::string& name = spec.fractures[lost[i]].name;
        names += (i > 0 ? ", " : "") + (name.empty() ? fmt::format("geometry.fractures.{}", lost[i]) : name);
    }
    if (lost.size() > most_named) names += fmt::format(" and {} more", lost.size() - most_named);
    return fmt::format(
        "nothing is left in the body of {} {}: {}. What is shorter than {:.3g} m, lies nearer than that to another "
        "fracture or to the outline, or ends inside a block of the net is not resolved",
        lost.size(), lost.size() == 1 ? "fracture" : "fractures", names, cut.resolution);
}

} // namespace

SceneModel build_scene_model(const Scene& scene) {
    CutBody body = cut_blocks(scene.geometry);
    const std::string loss = loss_in_words(scene.geometry, body.report);
    SceneModel result{build_model(std::move(body.system), model_input(scene)), std::move(body.report)};
    if (!loss.empty()) result.model.warnings.push_back(loss);
    return result;
}

} // namespace kluft
