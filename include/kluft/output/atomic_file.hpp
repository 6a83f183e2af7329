// Files that appear whole or not at all.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <string_view>

namespace kluft {

/// Replaces the file at `path` by one that holds `content`. Readers see the old file or the new one, never a part: the
/// bytes go to `<name>.part` in the same directory, reach the disk, and take the name by a rename. Of several processes that
/// write the same file each waits for the one before. A symbolic link is followed; what is not a regular file (a device, a
/// pipe) is written to directly.
/// Throws ResourceError (file and the system's reason) and leaves the old file as it was.
void write_file(const std::filesystem::path& path, std::string_view content);

/// Takes the next bytes of a file.
using Put = std::function<void(std::string_view bytes)>;
/// The same for content that is not in memory as a whole: `write` is called once and puts it part by part.
void write_file(const std::filesystem::path& path, const std::function<void(const Put& put)>& write);

/// The bytes of a regular file of at most 8 GB. Throws InputError when it cannot be read.
[[nodiscard]] std::string read_file(const std::filesystem::path& path);

/// Makes the directory and its parents. Throws ResourceError; InputError where the system has no directories but its own.
void make_directory(const std::filesystem::path& path);

/// Removes the file and what an interrupted write_file left of it. Throws ResourceError; no error if there is none.
void remove_file(const std::filesystem::path& path);

/// The name under which write_file prepares `path`.
[[nodiscard]] std::filesystem::path partial_name(const std::filesystem::path& path);

} // namespace kluft
