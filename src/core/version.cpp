#include "kluft/core/version.hpp"

namespace kluft {

std::string_view version() { return KLUFT_VERSION; }

} // namespace kluft
