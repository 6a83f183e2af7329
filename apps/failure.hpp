// The one end of a program that fails.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <string_view>

#include "commands.hpp"

namespace kluft {

/// Says on standard error what the exception in flight is about, and gives the exit code; within a catch only.
[[nodiscard]] ExitCode tell_failure() noexcept;

/// Ends the program without the exit handlers of libraries, and flushes what it has said.
[[noreturn]] void leave_without_handlers(ExitCode code);

/// Throws InputError where nothing can be made at `path`, which the option -o names: a part of it is too long or is a file; where it
/// or one above it is a link to what is not there; or where a pipe is there, which would wait for a reader. Throws ResourceError
/// where the nearest directory above it may not be written to or is on a read-only file system.
void require_possible_output(const std::string& path);

/// Throws InputError where what is to be the directory of the results is a file, or it or one above it a link to what is not there.
void require_no_file(const std::filesystem::path& directory);

/// Throws InputError where the directory of a file that -o names is not there, or where that file is a directory.
void require_directory_of(const std::string& file);

/// Throws InputError where the file that -o names is there, has something in it and is not `is_own` of its content: no `what` ("a
/// picture") that Kluft has made.
void require_own_file(const std::string& file, std::string_view what,
                      const std::function<bool(std::string_view content)>& is_own);

} // namespace kluft
