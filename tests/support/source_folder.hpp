// Where the sources are, for tests that read them.
#pragma once

#include <filesystem>

namespace kluft {

inline const std::filesystem::path source_folder = KLUFT_SOURCE_DIR;

} // namespace kluft
