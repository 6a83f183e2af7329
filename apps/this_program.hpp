// Where the program that runs is.
#pragma once

#include <filesystem>
#include <string>

namespace kluft {

/// The path of this executable, which a command needs to start it again or to find its files; throws InputError.
[[nodiscard]] std::filesystem::path this_program(const std::string& command);

} // namespace kluft
