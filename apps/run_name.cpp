#include <algorithm>

#include "commands.hpp"

namespace kluft {

std::string run_name(const std::filesystem::path& directory) {
    const auto whole = std::filesystem::absolute(directory).lexically_normal();
    const auto name = whole.has_filename() ? whole.filename() : whole.parent_path().filename();
    return name.empty() ? directory.string() : name.string();
}

std::vector<std::string> run_names(const std::vector<std::string>& directories) {
    std::vector<std::string> names;
    for (const auto& directory : directories) names.push_back(run_name(directory));
    auto sorted = names;
    std::ranges::sort(sorted);
    return std::ranges::adjacent_find(sorted) == sorted.end() ? names : directories;
}

} // namespace kluft
