#include "kluft/scene/scene_section.hpp"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "kluft/scene/scene_check.hpp"

namespace kluft {

namespace {

std::optional<double> number_of(const SceneNode& node, Measure measure) {
    return node.is_scalar() ? read_quantity(node.text, measure).value : std::nullopt;
}

std::optional<Vec2> point_of(const SceneNode& node, Measure measure) {
    if (!node.is_list() || node.items.size() != 2) return std::nullopt;
    const auto x = number_of(node.items[0], measure);
    const auto y = number_of(node.items[1], measure);
    return x && y ? std::optional(Vec2(*x, *y)) : std::nullopt;
}

int choice_index(const KeyRule& rule, std::string_view text) {
    const auto found = std::find(rule.choices.begin(), rule.choices.end(), text);
    return found == rule.choices.end() ? -1 : static_cast<int>(found - rule.choices.begin());
}

} // namespace

const SceneNode* SceneSection::value(std::string_view key) const {
    return node_ == nullptr ? nullptr : node_->find(key);
}

const KeyRule& SceneSection::rule(std::string_view key) const {
    const KeyRule* found = scene_schema().find(joined_path(pattern_, key));
    if (found == nullptr) throw std::logic_error("no rule for the key " + path_of(key));
    return *found;
}

SceneSection SceneSection::section(std::string_view key) const {
    return {value(key), std::string(rule(key).path), path_of(key)};
}

std::vector<SceneSection> SceneSection::sections(std::string_view key) const {
    const SceneNode* parent = value(key);
    if (parent == nullptr) return {};
    const std::string pattern = scene_schema().child_pattern(rule(key).path, "*");
    std::vector<SceneSection> result;
    for (std::size_t i = 0; i < parent->items.size(); ++i) {
        const std::string name = parent->is_mapping() ? parent->keys[i].text : std::to_string(i);
        result.emplace_back(&parent->items[i], pattern, joined_path(path_of(key), name));
    }
    return result;
}

std::vector<std::string> SceneSection::names() const {
    std::vector<std::string> result;
    if (node_ != nullptr)
        for (const auto& key : node_->keys) result.push_back(key.text);
    return result;
}

std::optional<double> SceneSection::given_number(std::string_view key) const {
    const SceneNode* node = value(key);
    if (node == nullptr || !scalar_problem(*node, rule(key)).empty()) return std::nullopt;
    return number_of(*node, rule(key).measure);
}

double SceneSection::number(std::string_view key) const {
    if (const auto given = given_number(key)) return *given;
    return read_quantity(rule(key).fallback, rule(key).measure).value.value_or(0.0);
}

long long SceneSection::integer(std::string_view key) const {
    const SceneNode* node = value(key);
    const bool valid = node != nullptr && scalar_problem(*node, rule(key)).empty();
    return read_integer(valid ? std::string_view(node->text) : rule(key).fallback).value_or(0);
}

bool SceneSection::boolean(std::string_view key) const {
    const SceneNode* node = value(key);
    const bool valid = node != nullptr && scalar_problem(*node, rule(key)).empty();
    return (valid ? std::string_view(node->text) : rule(key).fallback) == "true";
}

std::optional<std::string> SceneSection::given_text(std::string_view key) const {
    const SceneNode* node = value(key);
    if (node == nullptr || !scalar_problem(*node, rule(key)).empty()) return std::nullopt;
    return node->text;
}

std::optional<int> SceneSection::given_choice(std::string_view key) const {
    const auto text = given_text(key);
    return text ? std::optional(choice_index(rule(key), *text)) : std::nullopt;
}

int SceneSection::choice(std::string_view key) const {
    return given_choice(key).value_or(choice_index(rule(key), rule(key).fallback));
}

Vec2 SceneSection::point(std::string_view key) const {
    const SceneNode* node = value(key);
    return node == nullptr ? Vec2(Vec2::Zero()) : point_of(*node, rule(key).measure).value_or(Vec2::Zero());
}

std::optional<std::vector<Vec2>> SceneSection::given_points(std::string_view key) const {
    const SceneNode* node = value(key);
    if (node == nullptr || !node->is_list()) return std::nullopt;
    if (static_cast<int>(node->items.size()) < rule(key).least_items) return std::nullopt;
    std::vector<Vec2> points;
    for (const auto& item : node->items) {
        const auto point = point_of(item, rule(key).measure);
        if (!point) return std::nullopt;
        points.push_back(*point);
    }
    return points;
}

std::optional<Vec2> SceneSection::given_point(std::string_view key) const {
    const SceneNode* node = value(key);
    return node == nullptr ? std::nullopt : point_of(*node, rule(key).measure);
}

std::optional<Vec2> SceneSection::given_gravity(std::string_view key) const {
    const SceneNode* node = value(key);
    if (node == nullptr) return std::nullopt;
    if (node->is_list()) return given_point(key);
    const auto downwards = number_of(*node, rule(key).measure);
    if (!downwards) return std::nullopt;
    return Vec2(0.0, *downwards == 0.0 ? 0.0 : -*downwards);
}

std::vector<std::string> SceneSection::texts(std::string_view key) const {
    std::vector<std::string> result;
    const SceneNode* node = value(key);
    if (node == nullptr || !node->is_list()) return result;
    for (const auto& item : node->items)
        if (item.is_scalar()) result.push_back(item.text);
    return result;
}

std::vector<long long> SceneSection::integers(std::string_view key) const {
    std::vector<long long> result;
    const SceneNode* node = value(key);
    if (node == nullptr) return result;
    for (const auto& item : node->items)
        if (const auto integer = read_integer(item.text)) result.push_back(*integer);
    return result;
}

TextPosition SceneSection::position(std::string_view key) const {
    const SceneNode* node = value(key);
    if (node != nullptr) return node->at;
    return node_ == nullptr ? position() : node_->place_without(key);
}

TextPosition SceneSection::position() const { return node_ == nullptr ? TextPosition{} : node_->at; }

} // namespace kluft
