// Keys that a scene gives and that something else in it makes meaningless.
#pragma once

#include "kluft/scene/reading_context.hpp"
#include "kluft/scene/scene.hpp"

namespace kluft {

/// Warnings: an interface of given blocks where the body is cut, a seed of strengths that do not scatter. `root` is the whole
/// scene.
void warn_of_keys_without_effect(const SceneSection& root, const Scene& scene, ReadingContext& context);

} // namespace kluft
