#include "kluft/core/digest.hpp"

#include <fmt/format.h>

namespace kluft {

std::string Digest::text() const { return fmt::format("{:016x}", state_); }

} // namespace kluft
