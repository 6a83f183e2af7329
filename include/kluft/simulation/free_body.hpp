// Bodies that supports and platens leave free to move as a whole.
#pragma once

#include <string>

#include "kluft/simulation/model.hpp"

namespace kluft {

/// What is to be said of the first stage whose pressures act along a translation of the whole body that neither a support nor a platen's
/// prescribed displacement resists: nothing but friction holds the body then, also where the pressures balance. "" where each is held,
/// where nothing at all is (which is refused elsewhere), and where weight acts along it, which pushes the body away.
[[nodiscard]] std::string free_body_warning(const Model& model);

} // namespace kluft
