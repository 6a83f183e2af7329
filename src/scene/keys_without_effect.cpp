#include "kluft/scene/keys_without_effect.hpp"

#include <string_view>

#include <fmt/format.h>

namespace kluft {

void warn_of_keys_without_effect(const SceneSection& root, const Scene& scene, ReadingContext& context) {
    const auto warn = [&](const SceneSection& section, std::string_view key, std::string_view why) {
        if (section.has(key)) context.warn(section, key, fmt::format("has no effect: {}", why));
    };
    if (scene.geometry.blocks.empty())
        warn(root.section("geometry"), "blocks_interface",
             "it is that of given blocks; the interfaces of a domain stand in fractures and tessellation");
    if (scene.cracks.strength_noise.deviation == 0.0)
        warn(root.section("cracks"), "strength_seed", "without cracks.strength_noise the strengths do not scatter");
}

} // namespace kluft
