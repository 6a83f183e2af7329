// The fields of a kept state, read back from the files that a run wrote.
#pragma once

#include <filesystem>

#include "kluft/blocks/block_system.hpp"
#include "kluft/simulation/step_record.hpp"

namespace kluft {

/// What `fields/blocks_<step>.vtu` and `fields/interfaces_<step>.vtu` of a results directory say of the body, without platens,
/// contacts and supports. Throws InputError where a file is missing, damaged or of another body.
[[nodiscard]] FieldRecord read_fields(const std::filesystem::path& directory, int step, const BlockSystem& system);

/// The same from the two files.
[[nodiscard]] FieldRecord read_fields(const std::filesystem::path& blocks, const std::filesystem::path& interfaces,
                                      const BlockSystem& system);

} // namespace kluft
