// Which body a saved state belongs to.
#pragma once

#include <string>

#include "kluft/simulation/model.hpp"

namespace kluft {

/// A number of the body, its mechanics and its loads, as text: a saved state belongs to one of them.
[[nodiscard]] std::string fingerprint(const Model& model);

} // namespace kluft
