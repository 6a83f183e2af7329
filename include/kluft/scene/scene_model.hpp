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

/// What the scene says of the mechanics, for a body that has been cut already.
[[nodiscard]] ModelInput model_input(const Scene& scene);

/// Cuts the body and resolves its mechanics. Throws InputError.
[[nodiscard]] SceneModel build_scene_model(const Scene& scene);

} // namespace kluft
