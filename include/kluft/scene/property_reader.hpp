// Reads the materials and interfaces of a scene.
#pragma once

#include <vector>

#include "kluft/constitutive/material.hpp"
#include "kluft/scene/reading_context.hpp"

namespace kluft {

/// `root` is the whole scene. A tensile strength above the apex of Mohr-Coulomb's envelope, c cot(phi), is reduced to it
/// with a warning.
[[nodiscard]] std::vector<Material> read_materials(const SceneSection& root, ReadingContext& context);

/// Checks also that each gives its stiffness in one way only and that potential cracks fail to a fracture.
[[nodiscard]] std::vector<InterfaceType> read_interface_types(const SceneSection& root, ReadingContext& context);

} // namespace kluft
