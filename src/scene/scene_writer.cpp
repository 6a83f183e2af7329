#include "kluft/scene/scene_writer.hpp"

#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <string_view>

#include <fmt/format.h>

namespace kluft {

namespace {

/// Whether YAML reads the text back as the same plain scalar, also inside [] and {}.
bool is_plain(std::string_view text) {
    const auto is_safe = [](char c) {
        return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
               std::string_view("_.+/% -").find(c) != std::string_view::npos;
    };
    if (text.empty() || !std::all_of(text.begin(), text.end(), is_safe)) return false;
    const bool starts_well = text.front() != ' ' && text.front() != '%' && !text.starts_with("- ");
    return starts_well && text.back() != ' ' && text != "-" && text != "null" && text != "Null" && text != "NULL" &&
           !text.starts_with("---") && !text.starts_with("...");
}

std::string scalar_text(std::string_view text, bool quoted) {
    if (!quoted && is_plain(text)) return std::string(text);
    std::string result = "\"";
    for (const char c : text) {
        if (c == '"' || c == '\\')
            result += fmt::format("\\{}", c);
        else if (static_cast<unsigned char>(c) < 0x20)
            result += fmt::format("\\x{:02x}", static_cast<unsigned>(static_cast<unsigned char>(c)));
        else
            result += c;
    }
    return result + "\"";
}

/// How lists of mappings are written.
enum class Lists { on_one_line, an_item_per_line };

class TreeWriter {
public:
    explicit TreeWriter(const SceneSources& sources, Lists lists = Lists::on_one_line)
        : sources_(sources), lists_(lists) {}

    /// The entries of a mapping, one per line.
    std::string block(const SceneNode& mapping, const std::string& path, int indent) const {
        std::string text;
        for (std::size_t i = 0; i < mapping.keys.size(); ++i) {
            const std::string& key = mapping.keys[i].text;
            if (path.empty() && key == "extends") continue;
            const SceneNode& value = mapping.items[i];
            text += fmt::format("{:{}}{}:", "", indent, scalar_text(key, false));
            if (value.is_mapping() && !value.items.empty())
                text += "\n" + block(value, joined_path(path, key), indent + 2);
            else if (lists_ == Lists::an_item_per_line && has_mappings(value))
                text += "\n" + items_below(value, joined_path(path, key), indent + 2);
            else
                text += fmt::format(" {}\n", inline_text(value, joined_path(path, key)));
        }
        return text;
    }

    /// The value of a key on one line.
    [[nodiscard]] std::string inline_text(const SceneNode& node, const std::string& path) const {
        switch (node.kind) {
        case SceneNode::Kind::nothing:
            return "null";
        case SceneNode::Kind::scalar:
            return names_geometry_file(path) ? scalar_text(absolute(node), false) : scalar_text(node.text, node.quoted);
        case SceneNode::Kind::list:
        case SceneNode::Kind::mapping:
            return collection_text(node, path);
        }
        return {};
    }

private:
    static bool has_mappings(const SceneNode& node) {
        return node.is_list() && std::ranges::any_of(node.items, &SceneNode::is_mapping);
    }

    /// The items of a list, one per line.
    [[nodiscard]] std::string items_below(const SceneNode& list, const std::string& path, int indent) const {
        std::string text;
        for (std::size_t i = 0; i < list.items.size(); ++i)
            text += fmt::format("{:{}}- {}\n", "", indent,
                                inline_text(list.items[i], joined_path(path, std::to_string(i))));
        return text;
    }

    [[nodiscard]] std::string collection_text(const SceneNode& node, const std::string& path) const {
        std::string text;
        for (std::size_t i = 0; i < node.items.size(); ++i) {
            const std::string key = node.is_mapping() ? node.keys[i].text : std::to_string(i);
            if (i > 0) text += ", ";
            if (node.is_mapping()) text += scalar_text(key, false) + ": ";
            text += inline_text(node.items[i], joined_path(path, key));
        }
        return node.is_mapping() ? fmt::format("{{{}}}", text) : fmt::format("[{}]", text);
    }

    [[nodiscard]] std::string absolute(const SceneNode& node) const {
        std::filesystem::path file = node.text;
        if (file.is_relative()) file = std::filesystem::absolute(sources_.directory(node.at) / file);
        return file.lexically_normal().string();
    }

    const SceneSources& sources_;
    Lists lists_;
};

} // namespace

bool names_geometry_file(std::string_view path) { return path.starts_with("geometry.") && path.ends_with(".file"); }

std::string write_scene_tree(const SceneNode& root, const SceneSources& sources) {
    return TreeWriter(sources).block(root, {}, 0);
}

std::string write_readable_scene(const SceneNode& written) {
    const SceneSources none;
    return TreeWriter(none, Lists::an_item_per_line).block(written, {}, 0);
}

std::string write_scene_value(const SceneNode& value) {
    const SceneSources none;
    return TreeWriter(none).inline_text(value, {});
}

} // namespace kluft
