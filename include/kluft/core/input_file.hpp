// Files that a user names, read whole.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>

namespace kluft {

/// The bytes of a regular file of at most `largest` bytes. `what` is what the file should be, as in "a scene"; it goes
/// into the messages, and `hint` behind that of a file that is too large. Pipes and devices are refused: they may never end, and nobody may ever write to them.
/// Throws InputError for what is missing, no regular file, larger, or cannot be read.
[[nodiscard]] std::string read_input_file(const std::filesystem::path& file, std::string_view what, std::size_t largest,
                                          std::string_view hint = {});

} // namespace kluft
