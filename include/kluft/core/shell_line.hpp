// Command lines to be copied into a shell.
#pragma once

#include <string>
#include <vector>

namespace kluft {

/// Words as a POSIX shell takes them.
[[nodiscard]] std::string shell_line(const std::vector<std::string>& words);

} // namespace kluft
