// From a scene to the model that a run takes.
#pragma once

#include "kluft/blocks/block_cutter.hpp"
#include "kluft/scene/scene.hpp"
#include "kluft/simulation/model.hpp"

namespace kluft {

struct SceneModel {
    Model model;
    CutReport cut;
};

/// Cuts the body and resolves its mechanics. Throws InputError.
[[nodiscard]] SceneModel build_scene_model(const Scene& scene);

} // namespace kluft
