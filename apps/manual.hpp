// Pages of the manual, made from what the program says of itself.
#pragma once

#include <filesystem>
#include <string>

#include <CLI/CLI.hpp>

#include "kluft/scene/key_table.hpp"

namespace kluft {

/// Writes kluft.1, a page for each subcommand, and of the files that they read kluft-scene.5 and kluft-study.5. Throws
/// InputError and ResourceError where the directory cannot be written.
void write_manual(const CLI::App& app, const std::filesystem::path& directory);

/// The page of a kind of file, in the language of man.
[[nodiscard]] std::string manual_of_keys(const std::string& kind, const std::string& what, const KeyTable& table);

} // namespace kluft
