#include "kluft/scene/scene_model.hpp"

#include <utility>

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

SceneModel build_scene_model(const Scene& scene) {
    CutBody body = cut_blocks(scene.geometry);
    return {build_model(std::move(body.system), model_input(scene)), std::move(body.report)};
}

} // namespace kluft
