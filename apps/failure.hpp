// The one end of a program that fails.
#pragma once

#include <string>

#include "commands.hpp"

namespace kluft {

/// Says on standard error what the exception in flight is about, and gives the exit code; within a catch only.
[[nodiscard]] ExitCode tell_failure() noexcept;

/// Ends the program without the exit handlers of libraries, and flushes what it has said.
[[noreturn]] void leave_without_handlers(ExitCode code);

/// Throws InputError where nothing can be made at `path`, which the option -o names: a part of it is too long or is a file, or the
/// nearest directory above it may not be written to.
void require_possible_output(const std::string& path);

/// Throws InputError where what is to be the directory of the results is a file.
void require_no_file(const std::filesystem::path& directory);

/// Throws InputError where the directory of a file that -o names is not there.
void require_directory_of(const std::string& file);

} // namespace kluft
