#include "commands.hpp"

namespace kluft {

std::string run_name(const std::filesystem::path& directory) {
    const auto whole = std::filesystem::absolute(directory).lexically_normal();
    const auto name = whole.has_filename() ? whole.filename() : whole.parent_path().filename();
    return name.empty() ? directory.string() : name.string();
}

} // namespace kluft
