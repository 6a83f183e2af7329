// The text of a scene as a tree that knows where every key and value was written. Nothing here knows what keys mean.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>
#include <tuple>
#include <vector>

#include "kluft/core/diagnostics.hpp"

namespace kluft {

/// Where something was written; line and column from 1.
struct TextPosition {
    int source = 0; ///< index into SceneSources
    int line = 1;
    int column = 1;
};

struct SceneKey {
    std::string text;
    TextPosition at;
    bool is_word = true; ///< false: a list, a mapping or nothing, which parse_scene_tree refuses and leaves out
};

/// Of mappings and lists in one another, in files and in the keys of overrides.
inline constexpr int deepest_level = 32;

struct SceneNode {
    enum class Kind { nothing, scalar, list, mapping };

    Kind kind = Kind::nothing;
    std::string text;             ///< of a scalar
    bool quoted = false;          ///< a scalar in quotes is never a number without a unit
    bool removes = false;         ///< nothing, written as `null` or `~`: removes what it overrides
    std::vector<SceneKey> keys;   ///< of a mapping, one per item
    std::vector<SceneNode> items; ///< of a list or a mapping
    TextPosition at;
    std::vector<SceneKey> removed; ///< keys of a mapping that `null` took away, at the places that say so

    [[nodiscard]] bool is_mapping() const { return kind == Kind::mapping; }
    [[nodiscard]] bool is_list() const { return kind == Kind::list; }
    [[nodiscard]] bool is_scalar() const { return kind == Kind::scalar; }

    /// The value of a key of a mapping; null if there is none.
    [[nodiscard]] const SceneNode* find(std::string_view key) const;
    [[nodiscard]] SceneNode* find(std::string_view key);
    /// Where a key that is not there was taken away, else where the node stands.
    [[nodiscard]] TextPosition place_without(std::string_view key) const;
    /// Takes away a key that is there, as is said at a place.
    void remove(std::string_view key, const TextPosition& said_at);
};

/// The files (and overrides) that a scene was read from, for the positions in messages.
class SceneSources {
public:
    /// A file's text. Returns the source's index.
    int add_file(const std::filesystem::path& file, std::string_view text);
    /// A command line override, "key.path=value". Returns the source's index.
    int add_override(const std::string& assignment);

    /// "scene.yaml:12:5", or "--set stages.1.steps=0" for an override.
    [[nodiscard]] std::string place(const TextPosition& at) const;
    /// The source's file; "" for an override.
    [[nodiscard]] std::string file(const TextPosition& at) const;
    /// The source's line, shortened to a window around the position; "" for an override.
    [[nodiscard]] std::string line(const TextPosition& at) const;
    /// What relative paths written there start from: the file's directory; for an override the first file's.
    [[nodiscard]] const std::filesystem::path& directory(const TextPosition& at) const;

private:
    struct Source {
        std::string name;
        std::filesystem::path directory;
        std::vector<std::string> lines;
    };
    std::vector<Source> sources_;
};

/// Collects everything that is wrong with a scene.
class SceneErrors {
public:
    explicit SceneErrors(const SceneSources& sources) : sources_(sources) {}

    /// "place: path: what" with the offending line below; `path` may be empty.
    void add(const TextPosition& at, const std::string& path, const std::string& what);
    [[nodiscard]] bool empty() const { return errors_.empty(); }
    [[nodiscard]] std::size_t size() const { return errors_.size(); }
    [[nodiscard]] const SceneSources& sources() const { return sources_; }
    /// Throws one InputError with all messages in the order of the text; does nothing if there are none.
    void throw_if_any() const;

private:
    struct Error {
        TextPosition at;
        InputProblem problem;
    };
    const SceneSources& sources_;
    std::vector<Error> errors_;
};

/// `text` between quotes for a message: control characters replaced, long text cut.
[[nodiscard]] std::string in_quotes(std::string_view text);

/// "materials.rock" from "materials" and "rock"; `path` may be empty.
[[nodiscard]] std::string joined_path(const std::string& path, std::string_view key);

/// Parses YAML (JSON included) strictly: one document, no anchors, aliases or tags, no duplicate keys, plain keys, no
/// deeper than 32 levels, at most 10 000 keys in a mapping. What is wrong goes to `errors`; the tree holds the rest.
[[nodiscard]] SceneNode parse_scene_tree(std::string_view text, int source, const TextPosition& origin,
                                         SceneErrors& errors);

/// Lays `over` on `base`: mappings merge, everything else replaces, `null` removes what the base has.
void merge_scene_trees(SceneNode& base, SceneNode over);

} // namespace kluft
