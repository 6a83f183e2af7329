#include "kluft/core/digest.hpp"

#include <fmt/format.h>

namespace kluft {

std::string Digest::text() const { return fmt::format("{:016x}", state_); }

std::string told_apart(const std::string& name, std::string_view wanted) {
    return name + "-" + Digest().add(wanted).text().substr(0, 8);
}

} // namespace kluft
