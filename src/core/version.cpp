#include "kluft/core/version.hpp"

#include "kluft_commit.hpp"

namespace kluft {

std::string_view version() { return KLUFT_VERSION; }

std::string_view commit() { return KLUFT_COMMIT; }

} // namespace kluft
