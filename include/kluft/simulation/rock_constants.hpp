// Whether the elastic constants of the rock can be had from the test that a run makes.
#pragma once

#include <string>

#include "kluft/blocks/block_system.hpp"
#include "kluft/simulation/model.hpp"

namespace kluft {

/// Whether a platen on a boundary is much narrower than the body.
[[nodiscard]] bool is_pressed_in_part(const BlockSystem& system, int boundary);

/// Whether the body is a specimen of even faces and straight sides between the platens of the first stage that moves one; else what follows from
/// its stress and strain is no constant of the rock, and a run has none.
[[nodiscard]] bool has_elastic_constants(const Model& model);

/// Why they cannot, of the first stage that moves a platen: what holds the body there besides two smooth platens, and its shape. "" where they can,
/// and where a platen presses a part of the body's width, of which build_model has warned.
[[nodiscard]] std::string elastic_constants_warning(const Model& model);

} // namespace kluft
