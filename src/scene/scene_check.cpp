#include "kluft/scene/scene_check.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <set>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "kluft/core/nearest_name.hpp"

namespace kluft {

namespace {

constexpr double smallest_size = 1e-12; ///< m: below it squares of a body's lengths lose their digits

/// Beyond this something is wrong with the unit, and squares of it would leave the range of a double.
double largest(Measure measure) {
    switch (measure) {
    case Measure::length:
        return 1e9;
    case Measure::stress:
        return 1e15;
    case Measure::stiffness:
        return 1e18;
    case Measure::line_force:
        return 1e15;
    default:
        return 1e9;
    }
}

bool inside(double value, double least, double most, const Range& range) {
    return (range.open_below ? value > least : value >= least) && (range.open_above ? value < most : value <= most);
}

/// What is wrong with a number; "" if nothing.
std::string number_problem(const SceneNode& node, Measure measure, const Range& range) {
    if (!node.is_scalar()) return found_text(node);
    if (node.quoted && read_number(node.text)) return found_text(node) + ", which is text";
    const QuantityReading reading = read_quantity(node.text, measure);
    if (!reading.value) return found_text(node) + reading.problem;
    if (!inside(*reading.value, to_si(range.least, measure), to_si(range.most, measure), range))
        return found_text(node);
    const bool is_size = measure == Measure::length && range.open_below && range.least == 0.0;
    if (is_size && *reading.value < smallest_size)
        return fmt::format("{}, which is below {:g} m", found_text(node), smallest_size);
    if (std::abs(*reading.value) > largest(measure))
        return fmt::format("{}, which is beyond {:g}{}{}", found_text(node), largest(measure),
                           measure == Measure::fraction ? "" : " ", unit_name(measure));
    return {};
}

std::string integer_problem(const SceneNode& node, const Range& range) {
    if (!node.is_scalar() || node.quoted) return found_text(node);
    const auto value = read_integer(node.text);
    if (value && inside(static_cast<double>(*value), range.least, range.most, range)) return {};
    const bool says_most = range.most < largest_integer; // what is expected names the limit (range_text)
    const auto number = read_number(node.text);
    if (!says_most && number && *number > range.most)
        return fmt::format("{}, which is beyond {:.0f}", found_text(node), range.most);
    return found_text(node) + (value ? "" : number_flaw(node.text));
}

std::string choice_problem(const SceneNode& node, const KeyRule& rule) {
    if (std::find(rule.choices.begin(), rule.choices.end(), node.text) != rule.choices.end()) return {};
    return found_text(node) + suggestion(node.text, rule.choices);
}

std::string text_problem(const SceneNode& node) {
    const auto is_control = [](char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7F; };
    if (std::any_of(node.text.begin(), node.text.end(), is_control))
        return found_text(node) + ", which has control characters";
    return node.text.empty() ? found_text(node) : std::string{};
}

bool is_name(std::string_view text) {
    return !text.empty() && text.size() <= 64 && std::all_of(text.begin(), text.end(), [](char c) {
        const auto u = static_cast<unsigned char>(c);
        return (u >= 'a' && u <= 'z') || (u >= 'A' && u <= 'Z') || (u >= '0' && u <= '9') || u == '_' || u == '-' ||
               u >= 0x80;
    });
}

/// Whether the key after the number on the same line is its decimals, "5 %" after 0.
bool is_decimals(const SceneNode& mapping, std::size_t i) {
    const SceneNode& number = mapping.items[i - 1];
    const std::string& decimals = mapping.keys[i].text;
    return mapping.items[i].kind == SceneNode::Kind::nothing && number.is_scalar() && !number.quoted &&
           read_integer(number.text) && !decimals.empty() && decimals.front() >= '0' && decimals.front() <= '9' &&
           mapping.keys[i].at.source == number.at.source && mapping.keys[i].at.line == number.at.line;
}

void refuse_decimal_commas_in(SceneNode& node, const std::string& path, SceneErrors& errors) {
    for (std::size_t i = 1; i < node.keys.size(); ++i) {
        if (!is_decimals(node, i)) continue;
        SceneNode& number = node.items[i - 1];
        const std::string found = in_quotes(number.text + "," + node.keys[i].text);
        number.text += "." + node.keys[i].text;
        errors.add(number.at, joined_path(path, node.keys[i - 1].text),
                   fmt::format("expected a number with a decimal point, {}, found {}", in_quotes(number.text), found));
        node.keys.erase(node.keys.begin() + static_cast<std::ptrdiff_t>(i));
        node.items.erase(node.items.begin() + static_cast<std::ptrdiff_t>(i));
    }
    for (std::size_t i = 0; i < node.items.size(); ++i)
        refuse_decimal_commas_in(node.items[i],
                                 joined_path(path, node.is_mapping() ? node.keys[i].text : std::to_string(i)), errors);
}

/// Walks a scene along the table.
class SchemaCheck {
public:
    SchemaCheck(const KeyTable& keys, SceneErrors& errors) : keys_(keys), errors_(errors) {}

    void check(const SceneNode& node, const KeyRule& rule, const std::string& path) {
        switch (rule.type) {
        case KeyType::mapping:
            check_mapping(node, rule.path, path, keys_.expected_text(rule));
            break;
        case KeyType::choice_or_mapping:
            if (node.is_mapping())
                check_mapping(node, rule.path, path, keys_.expected_text(rule));
            else
                check_scalar(node, rule, path);
            break;
        case KeyType::named:
            check_named(node, rule, path);
            break;
        case KeyType::list:
            check_list(node, rule, path);
            break;
        case KeyType::point:
            check_point(node, rule, path, keys_.expected_text(rule));
            break;
        case KeyType::points:
            check_points(node, rule, path);
            break;
        case KeyType::integers:
            check_integers(node, rule, path);
            break;
        case KeyType::texts:
            check_texts(node, rule, path);
            break;
        case KeyType::gravity:
            check_gravity(node, rule, path);
            break;
        default:
            check_scalar(node, rule, path);
            break;
        }
    }

    void check_mapping(const SceneNode& node, std::string_view pattern, const std::string& path,
                       const std::string& expected) {
        if (!node.is_mapping()) return fail(node, path, expected, found_text(node));
        const auto valid = keys_.child_keys(pattern);
        std::vector<std::string> missing;
        std::copy_if(valid.begin(), valid.end(), std::back_inserter(missing),
                     [&](const std::string& key) { return node.find(key) == nullptr; });
        std::set<std::string> mistyped;
        for (std::size_t i = 0; i < node.keys.size(); ++i) {
            const SceneKey& key = node.keys[i];
            const auto known = std::find(valid.begin(), valid.end(), key.text);
            if (known != valid.end())
                check(node.items[i], *keys_.find(joined_path(std::string(pattern), key.text)),
                      joined_path(path, key.text));
            else
                mistyped.insert(refuse_key(key, valid, missing, path));
        }
        for (const auto& key : missing) {
            const KeyRule& rule = *keys_.find(joined_path(std::string(pattern), key));
            if (rule.required && !mistyped.contains(key))
                errors_.add(node.place_without(key), joined_path(path, key),
                            fmt::format("expected {}, found nothing", keys_.expected_text(rule)));
        }
    }

private:
    void fail(const SceneNode& node, const std::string& path, const std::string& expected, const std::string& found) {
        errors_.add(node.at, path, fmt::format("expected {}, found {}", expected, found));
    }

    /// Returns the valid key that is probably meant, "" if there is none.
    std::string refuse_key(const SceneKey& key, const std::vector<std::string>& valid,
                           const std::vector<std::string>& missing, const std::string& path) {
        std::vector<std::string> candidates = missing;
        candidates.insert(candidates.end(), valid.begin(), valid.end());
        const std::string meant = nearest_name(key.text, candidates);
        errors_.add(key.at, joined_path(path, key.text),
                    fmt::format("expected one of {}, found {}{}", listed(valid), in_quotes(key.text),
                                suggestion(key.text, candidates)));
        return meant;
    }

    void check_named(const SceneNode& node, const KeyRule& rule, const std::string& path) {
        if (!node.is_mapping()) return fail(node, path, keys_.expected_text(rule), found_text(node));
        if (static_cast<int>(node.items.size()) < rule.least_items)
            fail(node, path, keys_.expected_text(rule), found_text(node));
        const KeyRule* item = keys_.find(keys_.child_pattern(rule.path, "*"));
        for (std::size_t i = 0; i < node.keys.size(); ++i) {
            const std::string& name = node.keys[i].text;
            if (!is_name(name))
                errors_.add(node.keys[i].at, joined_path(path, name),
                            fmt::format("expected a name of letters, digits, '_' and '-', found {}", in_quotes(name)));
            check(node.items[i], *item, joined_path(path, name));
        }
    }

    /// Whether it is a list with as many items as the rule asks for; an error if not.
    bool is_long_enough(const SceneNode& node, const KeyRule& rule, const std::string& path) {
        const bool enough = node.is_list() && static_cast<int>(node.items.size()) >= rule.least_items;
        if (!enough) fail(node, path, keys_.expected_text(rule), found_text(node));
        return enough;
    }

    void check_list(const SceneNode& node, const KeyRule& rule, const std::string& path) {
        if (!is_long_enough(node, rule, path)) return;
        const KeyRule* item = keys_.find(keys_.child_pattern(rule.path, "#"));
        for (std::size_t i = 0; i < node.items.size(); ++i)
            check(node.items[i], *item, joined_path(path, std::to_string(i)));
    }

    void check_point(const SceneNode& node, const KeyRule& rule, const std::string& path, const std::string& expected) {
        if (!node.is_list() || node.items.size() != 2) return fail(node, path, expected, found_text(node));
        for (std::size_t i = 0; i < 2; ++i) {
            const std::string problem = number_problem(node.items[i], rule.measure, Range{});
            if (!problem.empty())
                fail(node.items[i], joined_path(path, std::to_string(i)), "a number" + unit_text(rule.measure),
                     problem);
        }
    }

    void check_points(const SceneNode& node, const KeyRule& rule, const std::string& path) {
        if (!is_long_enough(node, rule, path)) return;
        const std::string expected = "a point [x, y]" + unit_text(rule.measure);
        for (std::size_t i = 0; i < node.items.size(); ++i)
            check_point(node.items[i], rule, joined_path(path, std::to_string(i)), expected);
    }

    void check_integers(const SceneNode& node, const KeyRule& rule, const std::string& path) {
        if (!is_long_enough(node, rule, path)) return;
        const std::string expected = "an integer" + range_text(rule.range, true);
        for (std::size_t i = 0; i < node.items.size(); ++i) {
            const std::string problem = integer_problem(node.items[i], rule.range);
            if (!problem.empty()) fail(node.items[i], joined_path(path, std::to_string(i)), expected, problem);
        }
    }

    void check_texts(const SceneNode& node, const KeyRule& rule, const std::string& path) {
        if (!is_long_enough(node, rule, path)) return;
        for (std::size_t i = 0; i < node.items.size(); ++i) {
            const SceneNode& item = node.items[i];
            const std::string problem = item.is_scalar() ? text_problem(item) : found_text(item);
            if (!problem.empty()) fail(item, joined_path(path, std::to_string(i)), "text", problem);
        }
    }

    void check_gravity(const SceneNode& node, const KeyRule& rule, const std::string& path) {
        if (node.is_list()) return check_point(node, rule, path, keys_.expected_text(rule));
        const std::string problem = number_problem(node, rule.measure, rule.range);
        if (!problem.empty()) fail(node, path, keys_.expected_text(rule), problem);
    }

    void check_scalar(const SceneNode& node, const KeyRule& rule, const std::string& path) {
        const std::string problem = scalar_problem(node, rule);
        if (!problem.empty()) fail(node, path, keys_.expected_text(rule), problem);
    }

    const KeyTable& keys_;
    SceneErrors& errors_;
};

} // namespace

std::string found_text(const SceneNode& node) {
    switch (node.kind) {
    case SceneNode::Kind::nothing:
        return "nothing";
    case SceneNode::Kind::scalar:
        return in_quotes(node.text);
    case SceneNode::Kind::list:
        return node.items.empty() ? "an empty list" : fmt::format("a list of {}", node.items.size());
    case SceneNode::Kind::mapping:
        return node.items.empty() ? "an empty mapping" : "a mapping";
    }
    return {};
}

std::string scalar_problem(const SceneNode& node, const KeyRule& rule) {
    if (rule.type == KeyType::number) return number_problem(node, rule.measure, rule.range);
    if (rule.type == KeyType::integer) return integer_problem(node, rule.range);
    if (!node.is_scalar()) return found_text(node);
    if (rule.type == KeyType::choice || rule.type == KeyType::choice_or_mapping) return choice_problem(node, rule);
    if (rule.type == KeyType::boolean)
        return !node.quoted && (node.text == "true" || node.text == "false") ? std::string{} : found_text(node);
    return text_problem(node);
}

void refuse_decimal_commas(SceneNode& root, SceneErrors& errors) { refuse_decimal_commas_in(root, {}, errors); }

void check_against_schema(const SceneNode& root, SceneErrors& errors) {
    SchemaCheck(scene_schema(), errors).check_mapping(root, {}, {}, "a mapping that begins with kluft: 1");
}

} // namespace kluft
