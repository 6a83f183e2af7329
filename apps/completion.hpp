// What the shell may complete a command line with.
#pragma once

#include <string>
#include <vector>

#include <CLI/CLI.hpp>

namespace kluft {

/// What can stand in the place of the last one of `words`, of which the user has typed the beginning; it may be "". The words
/// before it are those after the program's name. Directories end with '/', keys of a scene that have more below them with '.', those
/// that a value follows with '='.
[[nodiscard]] std::vector<std::string> completions(const CLI::App& app, const std::vector<std::string>& words);

/// The script that makes a shell ask for completions: of bash, zsh or fish.
[[nodiscard]] std::string completion_script(const std::string& shell);

} // namespace kluft
