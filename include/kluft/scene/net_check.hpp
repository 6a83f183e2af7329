// What a net must not do in silence: give mapped fractures their stiffness, lock, or be too soft or too stiff.
#pragma once

#include <set>
#include <string>
#include <vector>

#include "kluft/blocks/block_system.hpp"
#include "kluft/scene/reading_context.hpp"
#include "kluft/scene/scene.hpp"

namespace kluft {

/// Indices of the materials that the blocks are made of, as far as they are known.
[[nodiscard]] std::set<int> materials_of_body(const Scene& scene);

/// An error for each interface of a mapped fracture (or that such a fracture fails to) without a stiffness of its own, at
/// the key that is missing. Returns the indices of those interfaces. `root` is the whole scene.
std::set<int> require_stiffness_of_joints(const SceneSection& root, const Scene& scene, ReadingContext& context);

/// Warnings: k_n d/E of the net outside the good range of its kind, whichever way the stiffness is given, with E of each
/// material of the body as it is given; and potential cracks of a net of interlocking cells that fail to a joint whose
/// friction lets the cells lock.
void warn_of_net(const SceneSection& root, const Scene& scene, ReadingContext& context);

/// Warnings of a body that is cut: cells of materials so soft beside the stiffest that their k_n d/E is above the good range; and rock that
/// lies outside the region of the net.
[[nodiscard]] std::vector<std::string> warnings_of_cut_net(const Scene& scene, const BlockSystem& system);

} // namespace kluft
