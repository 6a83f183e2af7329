// Tables of the keys that a file may have, which drive its checks, its documentation and its JSON Schema.
#pragma once

#include <cstddef>
#include <limits>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "kluft/scene/quantity.hpp"

namespace kluft {

enum class KeyType {
    mapping,             ///< of the keys below it in the table
    named,               ///< a mapping of names that the file chooses
    list,                ///< of the items below it in the table
    number,              ///< with or without a unit
    integer,             ///<
    boolean,             ///< true or false
    text,                ///<
    value,               ///< whatever stands there
    choice,              ///< one of `choices`
    choice_or_mapping,   ///< one of them, or a mapping of the keys below it in the table
    integer_or_mapping,  ///< an integer, or a mapping of the keys below it in the table
    text_or_mapping,     ///< a text, or a mapping of the keys below it in the table
    values_or_mapping,   ///< a list of values, or a mapping of the keys below it in the table
    mapping_or_mappings, ///< a mapping of the keys below it in the table, or a list of such mappings
    point,               ///< [x, y]
    points,              ///< [[x, y], ...]
    integers,            ///< [0, 1, ...]
    texts,               ///< [name, ...]
    gravity              ///< a number or [x, y]
};

/// Bounds of a number in its plain unit (degrees for angles).
struct Range {
    double least = -std::numeric_limits<double>::infinity();
    double most = std::numeric_limits<double>::infinity();
    bool open_below = false; ///< `least` itself is outside
    bool open_above = false;
};

/// Integers go up to here, which range_text does not say.
inline constexpr double largest_integer = 2147483647.0;

struct KeyRule {
    std::string_view path; ///< "materials.*.density", "stages.#.steps": '*' a name, '#' an index
    KeyType type = KeyType::text;
    Measure measure = Measure::fraction; ///< of numbers and coordinates
    Range range{};
    std::vector<std::string> choices{}; ///< of a choice
    std::string_view fallback{};        ///< the default as a file would write it; "" for none
    std::string_view fallback_note{};   ///< the default in words where it is no constant
    bool required = false;
    int least_items = 0; ///< of named mappings, lists, points and texts
    std::string_view doc{};
};

/// All keys of a kind of file, parents before children, in the order of the documentation.
class KeyTable {
public:
    explicit KeyTable(std::vector<KeyRule> rules);

    [[nodiscard]] auto begin() const { return rules_.begin(); }
    [[nodiscard]] auto end() const { return rules_.end(); }

    /// The rule of a pattern path ("materials.*.density"); null if there is none.
    [[nodiscard]] const KeyRule* find(std::string_view pattern) const;

    /// Pattern path of what lies under a key or an index: the named child, else the '*' or '#' child, else "".
    [[nodiscard]] std::string child_pattern(std::string_view pattern, std::string_view key) const;

    /// The keys that a mapping may have.
    [[nodiscard]] std::vector<std::string> child_keys(std::string_view pattern) const;

    /// "a number > 0 in Pa", "one of strain, stress": what a key takes, for messages and documentation.
    [[nodiscard]] std::string expected_text(const KeyRule& rule) const;

private:
    std::vector<KeyRule> rules_;
    std::map<std::string_view, std::size_t> index_; ///< of a path in rules_
};

/// " > 0", " >= 0 and < 0.5", " from -0.5 to 0.5", or "" without bounds. An integer's bound 2^31 - 1 is not told.
[[nodiscard]] std::string range_text(const Range& range, bool whole);

/// "required", "`25`", "none", or the default in words; "" for what stands under names and indices.
[[nodiscard]] std::string default_text(const KeyRule& rule);

/// " in Pa", or "" for plain numbers.
[[nodiscard]] std::string unit_text(Measure measure);

} // namespace kluft
