#include "kluft/scene/key_table.hpp"

#include <cmath>
#include <cstddef>
#include <utility>

#include <fmt/format.h>

#include "kluft/core/nearest_name.hpp"

namespace kluft {

namespace {

std::string join(std::string_view pattern, std::string_view key) {
    return pattern.empty() ? std::string(key) : fmt::format("{}.{}", pattern, key);
}

std::string number_text(double value) { return fmt::format("{:.15g}", value); }

} // namespace

KeyTable::KeyTable(std::vector<KeyRule> rules) : rules_(std::move(rules)) {
    for (std::size_t i = 0; i < rules_.size(); ++i) index_.emplace(rules_[i].path, i);
}

const KeyRule* KeyTable::find(std::string_view pattern) const {
    const auto found = index_.find(pattern);
    return found == index_.end() ? nullptr : &rules_[found->second];
}

std::string KeyTable::child_pattern(std::string_view pattern, std::string_view key) const {
    for (const std::string_view name : {key, std::string_view("*"), std::string_view("#")}) {
        std::string child = join(pattern, name);
        if (find(child) != nullptr) return child;
    }
    return {};
}

std::vector<std::string> KeyTable::child_keys(std::string_view pattern) const {
    std::vector<std::string> keys;
    const std::string prefix = pattern.empty() ? std::string{} : std::string(pattern) + ".";
    for (const auto& rule : rules_) {
        if (!rule.path.starts_with(prefix)) continue;
        const std::string_view rest = rule.path.substr(prefix.size());
        if (rest.find('.') == std::string_view::npos) keys.emplace_back(rest);
    }
    return keys;
}

std::string range_text(const Range& range, bool whole) {
    const bool below = std::isfinite(range.least);
    const bool above = std::isfinite(range.most) && !(whole && range.most >= largest_integer);
    if (below && above && range.least == range.most) return " equal to " + number_text(range.least);
    if (below && above && !range.open_below && !range.open_above)
        return fmt::format(" from {} to {}", number_text(range.least), number_text(range.most));
    std::string text;
    if (below) text += (range.open_below ? " > " : " >= ") + number_text(range.least);
    if (below && above) text += " and";
    if (above) text += (range.open_above ? " < " : " <= ") + number_text(range.most);
    return text;
}

std::string default_text(const KeyRule& rule) {
    if (rule.required) return "required";
    if (rule.path.ends_with('*') || rule.path.ends_with('#')) return "";
    if (!rule.fallback_note.empty()) return std::string(rule.fallback_note);
    return rule.fallback.empty() ? "none" : fmt::format("`{}`", rule.fallback);
}

std::string unit_text(Measure measure) {
    return measure == Measure::fraction ? std::string{} : fmt::format(" in {}", unit_name(measure));
}

std::string KeyTable::expected_text(const KeyRule& rule) const {
    const std::string unit = unit_text(rule.measure);
    switch (rule.type) {
    case KeyType::mapping:
        return fmt::format("a mapping of {}", listed(child_keys(rule.path)));
    case KeyType::named:
        return rule.least_items > 0 ? "a mapping of names, at least one" : "a mapping of names";
    case KeyType::list:
        return rule.least_items > 0 ? "a list of at least one" : "a list";
    case KeyType::number:
        return "a number" + range_text(rule.range, false) + unit;
    case KeyType::integer:
        return "an integer" + range_text(rule.range, true);
    case KeyType::boolean:
        return "true or false";
    case KeyType::text:
        return "text";
    case KeyType::value:
        return "a value";
    case KeyType::choice:
        return rule.choices.size() == 1 ? rule.choices[0] : "one of " + listed(rule.choices);
    case KeyType::choice_or_mapping:
        return fmt::format("one of {}, or a mapping of {}", listed(rule.choices), listed(child_keys(rule.path)));
    case KeyType::integer_or_mapping:
        return fmt::format("an integer{}, or a mapping of {}", range_text(rule.range, true),
                           listed(child_keys(rule.path)));
    case KeyType::text_or_mapping:
        return fmt::format("text, or a mapping of {}", listed(child_keys(rule.path)));
    case KeyType::values_or_mapping:
        return fmt::format("a list of values, or a mapping of {}", listed(child_keys(rule.path)));
    case KeyType::mapping_or_mappings:
        return fmt::format("a mapping of {}, or a list of such mappings", listed(child_keys(rule.path)));
    case KeyType::point:
        return "a point [x, y]" + unit;
    case KeyType::points:
        return fmt::format("a list of at least {} points [x, y]{}", rule.least_items, unit);
    case KeyType::integers:
        return "a list of at least one integer" + range_text(rule.range, true);
    case KeyType::texts:
        return fmt::format("a list of at least {} name{}", rule.least_items, rule.least_items == 1 ? "" : "s");
    case KeyType::gravity:
        return "a number >= 0 (downwards) or [gx, gy]" + unit;
    }
    return {};
}

} // namespace kluft
