// The one table of all keys of a scene. It drives validation, docs/scene.md and the JSON Schema.
#pragma once

#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include "kluft/scene/quantity.hpp"

namespace kluft {

enum class KeyType {
    mapping,           ///< of the keys below it in the table
    named,             ///< a mapping of names that the scene chooses
    list,              ///< of the items below it in the table
    number,            ///< with or without a unit
    integer,           ///<
    boolean,           ///< true or false
    text,              ///<
    choice,            ///< one of `choices`
    choice_or_mapping, ///< one of them, or a mapping of the keys below it in the table
    point,             ///< [x, y]
    points,            ///< [[x, y], ...]
    integers,          ///< [0, 1, ...]
    texts,             ///< [name, ...]
    gravity            ///< a number or [x, y]
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
    std::string_view fallback{};        ///< the default as a scene would write it; "" for none
    std::string_view fallback_note{};   ///< the default in words where it is no constant
    bool required = false;
    int least_items = 0; ///< of named mappings, lists, points and texts
    std::string_view doc{};
};

/// All keys, parents before children, in the order of the documentation.
[[nodiscard]] const std::vector<KeyRule>& scene_schema();

/// The rule of a pattern path ("materials.*.density"); null if there is none.
[[nodiscard]] const KeyRule* find_rule(std::string_view pattern);

/// Pattern path of what lies under a key or an index: the named child, else the '*' or '#' child, else "".
[[nodiscard]] std::string child_pattern(std::string_view pattern, std::string_view key);

/// The keys that a mapping may have.
[[nodiscard]] std::vector<std::string> child_keys(std::string_view pattern);

/// "a number > 0 in Pa", "one of strain, stress": what a key takes, for messages and documentation.
[[nodiscard]] std::string expected_text(const KeyRule& rule);

/// " > 0", " >= 0 and < 0.5", " from -0.5 to 0.5", or "" without bounds. An integer's bound 2^31 - 1 is not told.
[[nodiscard]] std::string range_text(const Range& range, bool whole);

/// " in Pa", or "" for plain numbers.
[[nodiscard]] std::string unit_text(Measure measure);

} // namespace kluft
