#include "kluft/scene/json_schema.hpp"

#include <cmath>
#include <string>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace kluft {

namespace {

using Json = nlohmann::ordered_json;

Json any_of(Json one, Json other) { return Json{{"anyOf", Json::array({std::move(one), std::move(other)})}}; }

Json integer_schema(const Range& range) {
    Json schema{{"type", "integer"}};
    if (std::isfinite(range.least)) schema[range.open_below ? "exclusiveMinimum" : "minimum"] = range.least;
    if (std::isfinite(range.most)) schema[range.open_above ? "exclusiveMaximum" : "maximum"] = range.most;
    return schema;
}

/// A plain number, or one with its unit in a text, whose size is left to the reader.
Json number_schema(const Range& range) {
    Json plain = integer_schema(range);
    plain["type"] = "number";
    return any_of(std::move(plain),
                  Json{{"type", "string"}, {"pattern", R"(^\s*[-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?\s*\S)"}});
}

/// YAML reads `name: 3` as a number, which is a name all the same.
Json text_schema() { return Json{{"type", Json::array({"string", "number", "boolean"})}}; }

Json point_schema() { return Json{{"type", "array"}, {"items", number_schema({})}, {"minItems", 2}, {"maxItems", 2}}; }

Json list_schema(Json items, int least_items) {
    Json schema{{"type", "array"}, {"items", std::move(items)}};
    if (least_items > 0) schema["minItems"] = least_items;
    return schema;
}

/// Writes the table of a kind of file as a schema.
class SchemaWriter {
public:
    SchemaWriter(const KeyTable& keys, Extending extending) : keys_(keys), extending_(extending) {}

    [[nodiscard]] Json mapping(std::string_view pattern) const {
        Json properties = Json::object();
        Json required = Json::array();
        for (const auto& key : keys_.child_keys(pattern)) {
            const KeyRule& rule = child(pattern, key);
            properties[key] = described(rule);
            if (rule.required && extending_ == Extending::never) required.push_back(key);
        }
        Json schema{{"type", "object"}, {"properties", std::move(properties)}, {"additionalProperties", false}};
        if (!required.empty()) schema["required"] = std::move(required);
        return schema;
    }

    /// Only what is required, of a mapping and all below it; null where nothing is.
    [[nodiscard]] Json requirements(std::string_view pattern) const {
        Json required = Json::array();
        Json properties = Json::object();
        for (const auto& key : keys_.child_keys(pattern)) {
            const KeyRule& rule = child(pattern, key);
            if (rule.required) required.push_back(key);
            if (Json below = requirements_below(rule); !below.is_null()) properties[key] = std::move(below);
        }
        if (required.empty() && properties.empty()) return {};
        return Json{{"required", required}, {"properties", properties}};
    }

private:
    [[nodiscard]] const KeyRule& child(std::string_view pattern, std::string_view key) const {
        return *keys_.find(keys_.child_pattern(pattern, key));
    }

    [[nodiscard]] Json requirements_below(const KeyRule& rule) const {
        if (rule.type == KeyType::mapping) return requirements(rule.path);
        const bool is_named = rule.type == KeyType::named;
        if (!is_named && rule.type != KeyType::list) return {};
        Json item = requirements(keys_.child_pattern(rule.path, is_named ? "*" : "#"));
        return item.is_null() ? Json{} : Json{{is_named ? "additionalProperties" : "items", std::move(item)}};
    }

    [[nodiscard]] Json described(const KeyRule& rule) const {
        const std::string told = rule.required ? "Required." : fmt::format("Default: {}.", default_text(rule));
        Json schema{{"description", fmt::format("{} {}", rule.doc, told)}};
        schema.update(or_null(value(rule)));
        return schema;
    }

    [[nodiscard]] Json or_null(Json schema) const {
        return extending_ == Extending::possible ? any_of(std::move(schema), Json{{"type", "null"}}) : schema;
    }

    [[nodiscard]] Json named(const KeyRule& rule) const {
        Json schema{{"type", "object"}, {"additionalProperties", or_null(value(child(rule.path, "*")))}};
        if (rule.least_items > 0 && extending_ == Extending::never) schema["minProperties"] = rule.least_items;
        return schema;
    }

    [[nodiscard]] Json value(const KeyRule& rule) const {
        switch (rule.type) {
        case KeyType::mapping:
            return mapping(rule.path);
        case KeyType::named:
            return named(rule);
        case KeyType::list:
            return list_schema(value(child(rule.path, "#")), rule.least_items);
        case KeyType::number:
            return number_schema(rule.range);
        case KeyType::integer:
            return integer_schema(rule.range);
        case KeyType::boolean:
            return Json{{"type", "boolean"}};
        case KeyType::text:
            return text_schema();
        case KeyType::value:
            return Json::object();
        case KeyType::choice:
            return choice(rule);
        case KeyType::choice_or_mapping:
            return any_of(choice(rule), mapping(rule.path));
        case KeyType::integer_or_mapping:
            return any_of(integer_schema(rule.range), mapping(rule.path));
        case KeyType::text_or_mapping:
            return any_of(text_schema(), mapping(rule.path));
        case KeyType::values_or_mapping:
            return any_of(list_schema(Json::object(), 1), mapping(rule.path));
        case KeyType::mapping_or_mappings:
            return any_of(mapping(rule.path), list_schema(mapping(rule.path), 1));
        case KeyType::point:
            return point_schema();
        case KeyType::points:
            return list_schema(point_schema(), rule.least_items);
        case KeyType::integers:
            return list_schema(integer_schema(rule.range), rule.least_items);
        case KeyType::texts:
            return list_schema(text_schema(), rule.least_items);
        case KeyType::gravity:
            return any_of(number_schema(rule.range), point_schema());
        }
        return {};
    }

    [[nodiscard]] static Json choice(const KeyRule& rule) { return Json{{"enum", rule.choices}}; }

    const KeyTable& keys_;
    Extending extending_;
};

} // namespace

std::string json_schema(const KeyTable& keys, std::string_view title, Extending extending) {
    const SchemaWriter writer(keys, extending);
    Json schema{{"$schema", "https://json-schema.org/draft/2020-12/schema"}, {"title", title}};
    schema.update(writer.mapping({}));
    if (extending == Extending::possible) {
        schema["if"] = Json{{"not", Json{{"required", Json::array({"extends"})}}}};
        schema["then"] = writer.requirements({});
    }
    return schema.dump(2) + "\n";
}

} // namespace kluft
