// What the readers of a scene's parts share: errors, warnings and references by name.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "kluft/scene/scene_section.hpp"
#include "kluft/scene/scene_tree.hpp"

namespace kluft {

struct ReadingContext {
    SceneErrors& errors;
    std::vector<std::string> warnings{};

    /// An error at a key's value; with an empty key, or where the key is missing, at the section.
    void fail(const SceneSection& section, std::string_view key, const std::string& what);
    /// Something that is accepted, but hardly meant.
    void warn(const SceneSection& section, std::string_view key, const std::string& what);

    /// Where a key's value stands, or the section without it, for messages: file, line, column and the key's path.
    [[nodiscard]] std::string place(const SceneSection& section, std::string_view key) const;

    /// Index of `name`; nothing (and an error at the key) if it is unknown. `what`: "a material".
    std::optional<int> index_of(const SceneSection& section, std::string_view key, const std::string& name,
                                const std::vector<std::string>& names, const std::string& what);
    /// Index of the name that a key gives. Without the key the only name there is, else an error.
    std::optional<int> reference(const SceneSection& section, std::string_view key,
                                 const std::vector<std::string>& names, const std::string& what);
};

/// The `name` members of a list of values.
template <class T> [[nodiscard]] std::vector<std::string> names_of(const std::vector<T>& items) {
    std::vector<std::string> names;
    names.reserve(items.size());
    for (const auto& item : items) names.push_back(item.name);
    return names;
}

} // namespace kluft
