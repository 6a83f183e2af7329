// Typed access to a checked mapping of a scene.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "kluft/blocks/geometry_spec.hpp"
#include "kluft/scene/scene_schema.hpp"
#include "kluft/scene/scene_tree.hpp"

namespace kluft {

/// A mapping of a scene with its place in the schema. Values that the schema check has refused (or that are missing
/// although required) read as the default, as if they had not been given: a scene with errors never gets out.
class SceneSection {
public:
    SceneSection(const SceneNode* node, std::string pattern, std::string path)
        : node_(node), pattern_(std::move(pattern)), path_(std::move(path)) {}

    [[nodiscard]] bool has(std::string_view key) const { return value(key) != nullptr; }
    [[nodiscard]] SceneSection section(std::string_view key) const;
    /// The items of a list of mappings, or the named mappings of a mapping of names.
    [[nodiscard]] std::vector<SceneSection> sections(std::string_view key) const;
    /// The keys of a mapping of names.
    [[nodiscard]] std::vector<std::string> names() const;

    [[nodiscard]] std::optional<double> given_number(std::string_view key) const; ///< without the default
    [[nodiscard]] double number(std::string_view key) const;                      ///< SI, radians
    [[nodiscard]] long long integer(std::string_view key) const;
    [[nodiscard]] int count(std::string_view key) const { return static_cast<int>(integer(key)); }
    [[nodiscard]] bool boolean(std::string_view key) const;
    [[nodiscard]] std::optional<std::string> given_text(std::string_view key) const;
    /// Index into the rule's choices.
    [[nodiscard]] std::optional<int> given_choice(std::string_view key) const;
    [[nodiscard]] int choice(std::string_view key) const;
    [[nodiscard]] Vec2 point(std::string_view key) const;
    [[nodiscard]] std::optional<std::vector<Vec2>> given_points(std::string_view key) const;
    [[nodiscard]] std::optional<Vec2> given_point(std::string_view key) const;
    [[nodiscard]] std::vector<long long> integers(std::string_view key) const;
    [[nodiscard]] std::vector<std::string> texts(std::string_view key) const;
    /// [gx, gy] of a key that takes gravity; a number is downwards.
    [[nodiscard]] std::optional<Vec2> given_gravity(std::string_view key) const;

    [[nodiscard]] const SceneNode* node() const { return node_; }
    [[nodiscard]] const SceneNode* value(std::string_view key) const;
    [[nodiscard]] const std::string& path() const { return path_; }
    /// The last key of the path: the name of a named mapping.
    [[nodiscard]] std::string name() const { return path_.substr(path_.rfind('.') + 1); }
    [[nodiscard]] std::string path_of(std::string_view key) const { return joined_path(path_, key); }
    /// Where the key's value stands, else the section itself, else the start of the scene.
    [[nodiscard]] TextPosition position(std::string_view key) const;
    [[nodiscard]] TextPosition position() const;

private:
    [[nodiscard]] const KeyRule& rule(std::string_view key) const;

    const SceneNode* node_;
    std::string pattern_;
    std::string path_;
};

} // namespace kluft
