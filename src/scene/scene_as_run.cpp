#include "kluft/scene/scene_as_run.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "kluft/core/diagnostics.hpp"
#include "kluft/core/digest.hpp"
#include "kluft/core/input_file.hpp"
#include "kluft/maps/map_file.hpp"
#include "kluft/scene/scene_text.hpp"
#include "kluft/scene/scene_tree.hpp"
#include "kluft/scene/scene_writer.hpp"

namespace kluft {

namespace {

constexpr std::string_view heading =
    "# The scene as run: what it extends and what --set changed is in it, geometry files have their full names.\n"
    "# kluft run writes this file anew; it can be run itself: kluft run scene.yaml -o OTHER\n";
constexpr std::string_view digest_mark = "# digest ";

/// A value of a scene that is no mapping or list, or an empty one.
struct Leaf {
    std::string path;
    std::string value;

    bool operator==(const Leaf&) const = default;
    auto operator<=>(const Leaf&) const = default;
};

void collect_leaves(const SceneNode& node, const std::string& path, std::vector<Leaf>& leaves) {
    for (std::size_t i = 0; i < node.items.size(); ++i) {
        const std::string key = node.is_mapping() ? node.keys[i].text : std::to_string(i);
        collect_leaves(node.items[i], joined_path(path, key), leaves);
    }
    if (!node.items.empty() || path.empty()) return;
    leaves.push_back({path, node.is_mapping() ? "{}" : node.is_list() ? "[]" : node.text});
}

SceneNode tree_of_text(std::string_view text) {
    SceneSources sources;
    SceneErrors errors(sources);
    const int source = sources.add_file("scene.yaml", text);
    return parse_scene_tree(text, source, {source, 1, 1}, errors);
}

/// All that a scene says but its title, in the order of the text.
std::vector<Leaf> leaves_of(const SceneNode& tree) {
    std::vector<Leaf> leaves;
    collect_leaves(tree, {}, leaves);
    std::erase_if(leaves, [](const Leaf& leaf) { return leaf.path == "title"; });
    return leaves;
}

std::string title_of(const SceneNode& tree) {
    const SceneNode* title = tree.find("title");
    return title == nullptr ? std::string{} : title->text;
}

/// Of the content of a file; of one that is gone, of nothing.
std::string digest_of_content(const std::filesystem::path& file) {
    constexpr std::size_t largest = 1'000'000'000; // bytes; the readers of such files allow less
    try {
        return Digest().add(read_input_file(file, "a file of the geometry", largest)).text();
    } catch (const InputError&) {
        return {};
    }
}

/// Of a map and of the files that belong to it.
std::string digest_of_map(const std::string& file) {
    const std::string digest = digest_of_content(file);
    const auto others = companions(file);
    if (others.empty()) return digest;
    Digest all;
    all.add(digest);
    for (const auto& other : others) all.add(digest_of_content(other));
    return all.text();
}

std::string digest_of_leaves(std::vector<Leaf> leaves) {
    std::ranges::sort(leaves);
    Digest digest;
    for (const Leaf& leaf : leaves)
        digest.add(leaf.path).add(names_geometry_file(leaf.path) ? digest_of_map(leaf.value) : leaf.value);
    return digest.text();
}

/// The digest that stands in the text of a scene as run.
std::string_view noted_digest(std::string_view text) {
    const std::size_t line = text.find(digest_mark);
    if (line == std::string_view::npos) return {};
    const std::string_view rest = text.substr(line + digest_mark.size());
    return rest.substr(0, rest.find('\n'));
}

using ValueByPath = std::map<std::string, std::string>;

ValueByPath by_path(const std::vector<Leaf>& leaves) {
    ValueByPath values;
    for (const Leaf& leaf : leaves) values.emplace(leaf.path, leaf.value);
    return values;
}

/// Null where there is none.
const std::string* value_at(const ValueByPath& values, const std::string& path) {
    const auto found = values.find(path);
    return found == values.end() ? nullptr : &found->second;
}

/// Whether a run that goes on may have another value of it.
bool may_change_on_the_way(const Leaf& leaf) {
    if (leaf.path == "cracks.strength_noise" || leaf.path == "cracks.strength_seed")
        return false; // strengths of the body
    constexpr std::array<std::string_view, 3> sections{"solver.", "cracks.", "output."};
    return leaf.path.ends_with(".stop_after_drop") ||
           std::ranges::any_of(sections, [&](std::string_view section) { return leaf.path.starts_with(section); });
}

std::string difference_at(const std::string& path, const std::string* there, const std::string* here) {
    const auto words = [](const std::string* value) { return value == nullptr ? "absent" : in_quotes(*value); };
    return fmt::format("{} is {} there and {} here", path, words(there), words(here));
}

/// In words, the first key with another value; files may have other names.
std::string first_difference(const std::vector<Leaf>& there, const std::vector<Leaf>& here) {
    const ValueByPath values_there = by_path(there), values_here = by_path(here);
    bool has_files = false;
    for (const Leaf& leaf : here) {
        has_files = has_files || names_geometry_file(leaf.path);
        const std::string* value = value_at(values_there, leaf.path);
        if (value != nullptr && (*value == leaf.value || names_geometry_file(leaf.path))) continue;
        return difference_at(leaf.path, value, &leaf.value);
    }
    for (const Leaf& leaf : there)
        if (value_at(values_here, leaf.path) == nullptr) return difference_at(leaf.path, &leaf.value, nullptr);
    return has_files ? "a file of the geometry has another content" : "scene.yaml has been changed since";
}

} // namespace

std::string write_scene_as_run(const Scene& scene) {
    SceneNode tree = tree_of_text(scene.text);
    const std::string digest = digest_of_leaves(leaves_of(tree));
    if (tree.is_mapping() && tree.find("title") == nullptr && is_scene_text(scene.name)) {
        SceneNode title;
        title.kind = SceneNode::Kind::scalar;
        title.text = scene.name;
        const std::ptrdiff_t at = tree.keys.empty() ? 0 : 1; // behind kluft: 1
        tree.keys.insert(tree.keys.begin() + at, {"title", {}});
        tree.items.insert(tree.items.begin() + at, std::move(title));
    }
    return fmt::format("{}{}{}\n{}", heading, digest_mark, digest, write_readable_scene(tree));
}

std::string body_difference(std::string_view earlier, const Scene& scene) {
    std::vector<Leaf> there = leaves_of(tree_of_text(earlier));
    std::vector<Leaf> here = leaves_of(tree_of_text(scene.text));
    for (std::vector<Leaf>* const leaves : {&there, &here}) std::erase_if(*leaves, may_change_on_the_way);
    return digest_of_leaves(there) == digest_of_leaves(here) ? "" : first_difference(there, here);
}

std::vector<std::string> geometry_files(const Scene& scene) {
    std::vector<std::string> files;
    for (const Leaf& leaf : leaves_of(tree_of_text(scene.text)))
        if (names_geometry_file(leaf.path)) files.push_back(leaf.value);
    return files;
}

bool is_scene_as_run(std::string_view text) { return text.starts_with(heading.substr(0, heading.find('\n'))); }

std::optional<std::string> scene_as_run_in(const std::filesystem::path& directory) {
    constexpr std::size_t largest = 100'000'000; // bytes
    try {
        std::string text = read_input_file(directory / "scene.yaml", "a scene", largest);
        if (is_scene_as_run(text)) return text;
    } catch (const InputError&) {
        return std::nullopt;
    }
    return std::nullopt;
}

std::string difference_from_scene_file(const std::filesystem::path& directory, const Scene& of_state) {
    const std::optional<std::string> as_run = scene_as_run_in(directory);
    return as_run ? body_difference(*as_run, of_state) : "";
}

std::string scene_difference(std::string_view earlier, const Scene& scene) {
    const SceneNode tree = tree_of_text(earlier);
    const std::vector<Leaf> there = leaves_of(tree);
    const std::vector<Leaf> here = leaves_of(tree_of_text(scene.text));
    const std::string digest = is_scene_as_run(earlier) ? std::string(noted_digest(earlier)) : digest_of_leaves(there);
    if (digest != digest_of_leaves(here)) return first_difference(there, here);
    const std::string title = title_of(tree);
    if (title.empty() || scene.title.empty() || title == scene.title) return {};
    return difference_at("title", &title, &scene.title);
}

} // namespace kluft
