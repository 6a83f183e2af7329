#include "kluft/scene/scene_text.hpp"

#include <algorithm>
#include <optional>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "kluft/core/diagnostics.hpp"
#include "kluft/core/input_file.hpp"
#include "kluft/scene/scene_check.hpp"
#include "kluft/scene/scene_schema.hpp"

namespace kluft {

namespace {

constexpr std::size_t largest_scene = 1'000'000; ///< bytes; large geometry goes into files of its own
constexpr std::string_view hint = "; large geometry goes into maps (GeoJSON) that a scene names";
constexpr std::size_t longest_chain = 16; ///< of scenes that extend each other

/// Length of the UTF-8 character at `at`; 0 if there is none.
std::size_t character_length(std::string_view text, std::size_t at) {
    const auto first = static_cast<unsigned char>(text[at]);
    const std::size_t length = first < 0x80   ? 1
                               : first < 0xC2 ? 0
                               : first < 0xE0 ? 2
                               : first < 0xF0 ? 3
                               : first < 0xF5 ? 4
                                              : 0;
    if (length == 0 || at + length > text.size()) return 0;
    for (std::size_t i = 1; i < length; ++i)
        if ((static_cast<unsigned char>(text[at + i]) & 0xC0U) != 0x80U) return 0;
    return length;
}

/// Where a line ends in a way that YAML's readers do not agree upon; npos where none does.
std::size_t lone_carriage_return(std::string_view text) {
    for (std::size_t at = text.find('\r'); at != std::string_view::npos; at = text.find('\r', at + 1))
        if (at + 1 == text.size() || text[at + 1] != '\n') return at;
    return std::string_view::npos;
}

void require_scene_text(std::string_view text, const std::filesystem::path& file, std::string_view what) {
    if (text.size() > largest_scene)
        throw InputError(fmt::format("{}: expected {} of at most 1 MB, found more{}", file.string(), what, hint));
    if (!is_scene_text(text))
        throw InputError(fmt::format("{}: expected {} in UTF-8 text, found a binary file", file.string(), what));
    if (const std::size_t at = lone_carriage_return(text); at != std::string_view::npos)
        throw InputError(fmt::format("{}:{}: expected lines that end in LF or CR LF, found one that ends in CR alone",
                                     file.string(), 1 + std::ranges::count(text.substr(0, at), '\n')));
}

/// Reads and merges the chain of scenes.
class SceneChain {
public:
    SceneChain(SceneSources& sources, SceneErrors& errors) : sources_(sources), errors_(errors) {}

    SceneNode build(std::string_view text, const std::filesystem::path& file) {
        require_scene_text(text, file, "a scene");
        const int source = sources_.add_file(file, text);
        SceneNode tree = parse_scene_tree(text, source, {source, 1, 1}, errors_);
        if (tree.kind == SceneNode::Kind::nothing) {
            if (errors_.empty())
                errors_.add({source, 1, 1}, {}, "expected a mapping that begins with kluft: 1, found an empty file");
            errors_.throw_if_any(); // all else would follow from it
        }
        chain_.push_back(std::filesystem::weakly_canonical(file));
        const auto base = base_file(tree, file);
        if (!base) return tree;
        SceneNode merged = build(extended_bytes(*base, tree), *base);
        merge_scene_trees(merged, std::move(tree));
        return merged;
    }

private:
    std::string extended_bytes(const std::filesystem::path& base, const SceneNode& tree) {
        try {
            return read_scene_bytes(base);
        } catch (const InputError& error) {
            errors_.add(tree.find("extends")->at, "extends", error.what());
            errors_.throw_if_any();
            throw;
        }
    }

    /// The file that `tree` extends, if there is one.
    std::optional<std::filesystem::path> base_file(const SceneNode& tree, const std::filesystem::path& file) {
        const SceneNode* extends = tree.find("extends");
        if (extends == nullptr || !extends->is_scalar() || extends->text.empty()) return std::nullopt;
        const auto fail = [&](const std::string& found) {
            errors_.add(extends->at, "extends",
                        fmt::format("expected the file of another scene, found {}{}", in_quotes(extends->text), found));
            errors_.throw_if_any(); // what the other scene gives would be missed
            return std::nullopt;
        };
        const auto base = (file.parent_path() / extends->text).lexically_normal();
        std::error_code error;
        if (!std::filesystem::is_regular_file(base, error))
            return fail(std::filesystem::is_directory(base, error) ? ", which is a directory" : ", which is no file");
        if (std::find(chain_.begin(), chain_.end(), std::filesystem::weakly_canonical(base)) != chain_.end())
            return fail(", which leads back to itself");
        if (chain_.size() >= longest_chain) return fail(fmt::format(" after a chain of {} scenes", longest_chain));
        return base;
    }

    SceneSources& sources_;
    SceneErrors& errors_;
    std::vector<std::filesystem::path> chain_;
};

std::vector<std::string> split_path(std::string_view path) {
    std::vector<std::string> keys;
    for (std::size_t start = 0;;) {
        const std::size_t end = path.find('.', start);
        keys.emplace_back(path.substr(start, end - start));
        if (end == std::string_view::npos) return keys;
        start = end + 1;
    }
}

/// Lays one "key.path=value" on a tree.
class Override {
public:
    Override(const std::string& assignment, SceneSources& sources, SceneErrors& errors)
        : errors_(errors), at_{sources.add_override(assignment), 1, 1} {
        const std::size_t equals = assignment.find('=');
        if (equals == std::string::npos || equals == 0) {
            errors_.add(at_, {}, "expected key.path=value");
            return;
        }
        path_ = assignment.substr(0, equals);
        if (std::ranges::count(path_, '.') >= deepest_level) {
            errors_.add(at_, {}, fmt::format("expected a key of at most {} levels", deepest_level));
            return;
        }
        const std::string text = assignment.substr(equals + 1);
        if (!is_scene_text(text) || text.size() > largest_scene) {
            errors_.add(at_, path_, "expected a value in UTF-8 text");
            return;
        }
        if (path_ == "extends") {
            errors_.add(at_, path_, "expected a key that can be overridden; a scene extends another one in its file");
            return;
        }
        const std::size_t n_errors = errors_.size();
        SceneNode value = parse_scene_tree(text, at_.source, at_, errors_);
        if (errors_.size() > n_errors) return; // what the value would be said to be follows from that
        value.at = at_;
        value_ = std::move(value);
    }

    void apply(SceneNode& root) {
        if (value_) set(root, split_path(path_), 0, {}, {});
    }

private:
    void set(SceneNode& node, const std::vector<std::string>& keys, std::size_t depth, const std::string& pattern,
             const std::string& path) {
        if (depth == keys.size()) return lay(node);
        const std::string& key = keys[depth];
        const std::string below = scene_schema().child_pattern(pattern, key);
        if (node.kind == SceneNode::Kind::nothing) {
            node.kind = below.ends_with('#') ? SceneNode::Kind::list : SceneNode::Kind::mapping;
            node.at = at_;
        }
        const bool last = depth + 1 == keys.size();
        SceneNode* child = node.is_list()      ? item(node, key, path, last)
                           : node.is_mapping() ? entry(node, key, last)
                                               : nullptr;
        if (child != nullptr) return set(*child, keys, depth + 1, below, joined_path(path, key));
        if (node.is_scalar())
            errors_.add(
                at_, path,
                fmt::format("expected a mapping or a list for the key {}, found {}", in_quotes(key), found_text(node)));
    }

    /// Mappings merge, so that one without keys would change nothing of another one.
    void lay(SceneNode& node) {
        if (node.is_mapping() && !node.items.empty() && value_->is_mapping() && value_->items.empty())
            errors_.add(
                at_, path_,
                fmt::format("expected keys to merge with those that are there, or null, which removes {}; found "
                            "{{}}, which changes nothing",
                            in_quotes(path_)));
        else
            merge_scene_trees(node, std::move(*value_));
    }

    /// The item of a list, appended if it is the next one. Removes it and returns null for a `null` value.
    SceneNode* item(SceneNode& list, const std::string& key, const std::string& path, bool last) {
        const auto index = read_integer(key);
        const auto n_items = static_cast<long long>(list.items.size());
        if (!index || *index < 0 || *index > n_items) {
            errors_.add(at_, path,
                        fmt::format("expected an index from 0 to {} (the last one appends), found {}", n_items,
                                    in_quotes(key)));
            return nullptr;
        }
        if (last && value_->removes) {
            if (*index < n_items) list.items.erase(list.items.begin() + *index);
            return nullptr;
        }
        if (*index == n_items) {
            list.items.emplace_back();
            list.items.back().at = at_;
        }
        return &list.items[static_cast<std::size_t>(*index)];
    }

    /// The value of a key, created if there is none. Removes it and returns null for a `null` value.
    SceneNode* entry(SceneNode& mapping, const std::string& key, bool last) {
        SceneNode* found = mapping.find(key);
        if (last && value_->removes) {
            if (found != nullptr) mapping.remove(key, at_);
            return nullptr;
        }
        if (found != nullptr) return found;
        mapping.keys.push_back({key, at_});
        mapping.items.emplace_back();
        mapping.items.back().at = at_;
        return &mapping.items.back();
    }

    SceneErrors& errors_;
    TextPosition at_;
    std::string path_;
    std::optional<SceneNode> value_;
};

} // namespace

bool is_utf8(std::string_view text) {
    for (std::size_t at = 0; at < text.size();) {
        const std::size_t length = character_length(text, at);
        if (length == 0) return false;
        at += length;
    }
    return true;
}

bool is_scene_text(std::string_view text) {
    for (std::size_t at = 0; at < text.size();) {
        const auto c = static_cast<unsigned char>(text[at]);
        if (c < 0x20 && c != '\t' && c != '\n' && c != '\r') return false;
        const std::size_t length = character_length(text, at);
        if (length == 0) return false;
        at += length;
    }
    return true;
}

std::string read_scene_bytes(const std::filesystem::path& file, std::string_view what) {
    std::string text = read_input_file(file, what, largest_scene, hint);
    require_scene_text(text, file, what);
    return text;
}

SceneNode build_scene_tree(std::string_view text, const std::filesystem::path& file,
                           const std::vector<std::string>& overrides, SceneSources& sources, SceneErrors& errors) {
    SceneNode tree = SceneChain(sources, errors).build(text, file);
    for (const auto& assignment : overrides) Override(assignment, sources, errors).apply(tree);
    return tree;
}

} // namespace kluft
