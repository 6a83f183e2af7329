#include "kluft/scene/reading_context.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "kluft/core/nearest_name.hpp"

namespace kluft {

void ReadingContext::fail(const SceneSection& section, std::string_view key, const std::string& what) {
    errors.add(section.position(key), key.empty() ? section.path() : section.path_of(key), what);
}

void ReadingContext::warn(const SceneSection& section, std::string_view key, const std::string& what) {
    warnings.push_back(fmt::format("{}: {}", place(section, key), what));
}

std::string ReadingContext::place(const SceneSection& section, std::string_view key) const {
    return fmt::format("{}: {}", errors.sources().place(section.position(key)),
                       key.empty() ? section.path() : section.path_of(key));
}

std::optional<int> ReadingContext::index_of(const SceneSection& section, std::string_view key, const std::string& name,
                                            const std::vector<std::string>& names, const std::string& what) {
    const auto found = std::find(names.begin(), names.end(), name);
    if (found != names.end()) return static_cast<int>(found - names.begin());
    fail(section, key,
         fmt::format("expected the name of {} ({}), found {}{}", what, listed_near(name, names), in_quotes(name),
                     suggestion(name, names)));
    return std::nullopt;
}

std::optional<int> ReadingContext::reference(const SceneSection& section, std::string_view key,
                                             const std::vector<std::string>& names, const std::string& what) {
    if (const auto name = section.given_text(key)) return index_of(section, key, *name, names, what);
    if (section.has(key)) return std::nullopt;
    if (names.size() == 1) return 0;
    fail(section, key,
         names.empty() ? fmt::format("expected the name of {}, found nothing, and the scene has none yet", what)
                       : fmt::format("expected the name of {} ({}), found nothing", what, listed(names)));
    return std::nullopt;
}

} // namespace kluft
