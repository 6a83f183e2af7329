#include "kluft/scene/scene_reference.hpp"

#include <algorithm>
#include <cmath>
#include <string_view>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "kluft/scene/quantity.hpp"
#include "kluft/scene/scene_schema.hpp"

namespace kluft {

namespace {

using Json = nlohmann::ordered_json;

constexpr std::string_view introduction = R"(# Scenes

A scene is a YAML file that says everything about a run: rock, fractures, geometry, loading, solution and output. The
scene's name is the file's stem. `kluft check SCENE` reads a scene and runs nothing.

This page is written from the table of keys that also checks scenes, so it is complete. So is the JSON Schema that
`kluft schema >scene.schema.json` says: with the first line `# yaml-language-server: $schema=scene.schema.json` in a scene,
editors complete its keys and mark mistakes.

```yaml
kluft: 1
title: A block of sandstone with one fracture under gravity and a platen
analysis: {plane: strain, gravity: 9.81}
materials:
  sandstone: {density: 2300 kg/m3, youngs_modulus: 1.5 GPa, poissons_ratio: 0.25,
              cohesion: 0.15 MPa, friction_angle: 39.6 deg, tensile_strength: 0.05 MPa}
interfaces:
  joint: {kind: fracture, friction_angle: 30, normal_stiffness: 40 GPa/m, shear_stiffness: 20 GPa/m}
  crack: {kind: fracture, friction_angle: 35}
  bond: {kind: potential_crack, fails_to: crack}
geometry:
  domain: {rectangle: {width: 20 cm, height: 40 cm}}
  fractures:
    - {trace: [[-0.01, 0.1], [0.21, 0.3]], interface: joint}
  tessellation: {triangles: {spacing: 4 cm}, interface: bond}
boundaries:
  bottom: {support: smooth}
stages:
  - {name: weight, pressure: {left: 0.1 MPa, right: 0.1 MPa}}
  - {name: platen, strain: {boundary: top, value: 1 %}, steps: 20}
```

## Numbers

Plain numbers are in SI units, angles in degrees. A number may carry its unit, `25 MPa`, `38 cm`, `200 MPa/m`,
`2650 kg/m3`, `1.3 %`, `30 deg`; it is converted and its dimension is checked. Units combine with `/`, `*` and blanks and
take powers (`m3`, `m^3`, `s-2`). Known units: UNITS.
`nan`, `inf`, leading zeros (`012`), hexadecimal and digit groups are refused, and so is a number in quotes without a
unit. Pressures, stresses of platens, strains and inward displacements are positive in compression; tensile strengths are
positive.

## Text

Names of materials, interfaces and boundaries are made of letters, digits, `_` and `-`. A file is UTF-8 text of at most
1 MB with lines that end in LF or CR LF; large geometry goes into GeoJSON files (at most 100 MB) that the scene names. All
are regular files: pipes and devices are refused. Lengths and coordinates are at most 1e9 m, and a net has at most 2e6
cells. YAML's anchors, aliases and tags, several documents in
one file and duplicate keys are refused. JSON is YAML too.

## Extending and overriding

`extends: other.yaml` (relative to the file that says it) takes another scene and changes it: mappings merge key by key,
lists and single values replace. `null` (or `~`) removes a key that the other scene has, which is how to change from one
way of giving a stiffness to another, or from a rectangle to a polygon.

`--set key.path=value` on the command line does the same after that. The path goes through mappings by key and through
lists by index from 0 (the number of items appends one); the value is YAML:
`--set stages.1.steps=200 --set geometry.tessellation.triangles.spacing=0.03 --set geometry.tessellation=null`.

## Errors

Everything that is wrong is reported at once, one message each, with exit code 2:

```
case.yaml:12:5: materials.sandstone.densty: expected one of density, youngs_modulus, poissons_ratio, cohesion, friction_angle, tensile_strength, found 'densty'; did you mean 'density'?
      densty: 2300
--set stages.1.steps=0: stages.1.steps: expected an integer >= 1, found '0'
```

## Keys

`<name>` stands for a name that the scene chooses, `<i>` for an index.
)";

void replace_all(std::string& text, std::string_view from, std::string_view to) {
    for (std::size_t at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size()))
        text.replace(at, from.size(), to);
}

/// "materials.<name>.density" of "materials.*.density".
std::string shown_path(std::string_view path) {
    std::string text(path);
    replace_all(text, "*", "<name>");
    replace_all(text, "#", "<i>");
    return text;
}

std::string shown_type(const KeyRule& rule) {
    if (rule.type == KeyType::mapping) return "mapping";
    if (rule.type == KeyType::choice || rule.type == KeyType::choice_or_mapping) {
        std::string text;
        for (const auto& choice : rule.choices) text += fmt::format("{}`{}`", text.empty() ? "" : ", ", choice);
        return rule.type == KeyType::choice ? text : text + " or mapping";
    }
    return expected_text(rule);
}

std::string shown_default(const KeyRule& rule) {
    if (rule.required) return "required";
    if (rule.path.ends_with('*') || rule.path.ends_with('#')) return "";
    if (!rule.fallback_note.empty()) return std::string(rule.fallback_note);
    return rule.fallback.empty() ? "none" : fmt::format("`{}`", rule.fallback);
}

Json unit_number(const KeyRule& rule) {
    Json plain{{"type", rule.type == KeyType::integer ? "integer" : "number"}};
    if (std::isfinite(rule.range.least))
        plain[rule.range.open_below ? "exclusiveMinimum" : "minimum"] = rule.range.least;
    if (std::isfinite(rule.range.most)) plain[rule.range.open_above ? "exclusiveMaximum" : "maximum"] = rule.range.most;
    if (rule.type == KeyType::integer) return plain;
    const Json with_unit{{"type", "string"}, {"pattern", R"(^\s*[-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?\s*\S)"}};
    return Json{{"anyOf", Json::array({plain, with_unit})}};
}

Json point_schema(const KeyRule& rule) {
    KeyRule coordinate = rule;
    coordinate.range = {};
    return Json{{"type", "array"}, {"items", unit_number(coordinate)}, {"minItems", 2}, {"maxItems", 2}};
}

Json list_schema(Json items, const KeyRule& rule) {
    Json schema{{"type", "array"}, {"items", std::move(items)}};
    if (rule.least_items > 0) schema["minItems"] = rule.least_items;
    return schema;
}

Json mapping_schema(std::string_view pattern);

/// Takes null as well, which removes an inherited key.
Json or_null(Json schema) { return Json{{"anyOf", Json::array({std::move(schema), Json{{"type", "null"}}})}}; }

Json value_schema(const KeyRule& rule) {
    const auto child = [&](std::string_view key) { return value_schema(*find_rule(child_pattern(rule.path, key))); };
    switch (rule.type) {
    case KeyType::mapping:
        return mapping_schema(rule.path);
    case KeyType::named:
        return Json{{"type", "object"}, {"additionalProperties", or_null(child("*"))}};
    case KeyType::list:
        return list_schema(child("#"), rule);
    case KeyType::number:
    case KeyType::integer:
        return unit_number(rule);
    case KeyType::boolean:
        return Json{{"type", "boolean"}};
    case KeyType::text:
        return Json{{"type", Json::array({"string", "number", "boolean"})}};
    case KeyType::choice:
        return Json{{"enum", rule.choices}};
    case KeyType::choice_or_mapping:
        return Json{{"anyOf", Json::array({Json{{"enum", rule.choices}}, mapping_schema(rule.path)})}};
    case KeyType::point:
        return point_schema(rule);
    case KeyType::points:
        return list_schema(point_schema(rule), rule);
    case KeyType::integers: {
        KeyRule item = rule;
        item.type = KeyType::integer;
        return list_schema(unit_number(item), rule);
    }
    case KeyType::texts:
        return list_schema(Json{{"type", Json::array({"string", "number", "boolean"})}}, rule);
    case KeyType::gravity:
        return Json{{"anyOf", Json::array({unit_number(rule), point_schema(rule)})}};
    }
    return {};
}

Json described_schema(const KeyRule& rule) {
    Json schema{{"description", fmt::format("{} Default: {}.", rule.doc, shown_default(rule))}};
    schema.update(or_null(value_schema(rule)));
    return schema;
}

Json mapping_schema(std::string_view pattern) {
    Json properties = Json::object();
    for (const auto& key : child_keys(pattern))
        properties[key] = described_schema(*find_rule(child_pattern(pattern, key)));
    return Json{{"type", "object"}, {"properties", std::move(properties)}, {"additionalProperties", false}};
}

/// Only what is required, of a mapping and all below it; null where nothing is.
Json requirements(std::string_view pattern) {
    Json required = Json::array();
    Json properties = Json::object();
    for (const auto& key : child_keys(pattern)) {
        const KeyRule& rule = *find_rule(child_pattern(pattern, key));
        if (rule.required) required.push_back(key);
        Json below;
        if (rule.type == KeyType::mapping) below = requirements(rule.path);
        if (rule.type == KeyType::named)
            if (const Json item = requirements(child_pattern(rule.path, "*")); !item.is_null())
                below = Json{{"additionalProperties", item}};
        if (rule.type == KeyType::list)
            if (const Json item = requirements(child_pattern(rule.path, "#")); !item.is_null())
                below = Json{{"items", item}};
        if (!below.is_null()) properties[key] = below;
    }
    if (required.empty() && properties.empty()) return {};
    return Json{{"required", required}, {"properties", properties}};
}

} // namespace

std::string scene_reference_markdown() {
    std::string page(introduction);
    replace_all(page, "UNITS", known_units());
    for (const auto& rule : scene_schema()) {
        if (rule.path.find('.') == std::string_view::npos) {
            page += fmt::format("\n### `{}`\n\n{}\n\nTakes {}. Default: {}.\n", rule.path, rule.doc, shown_type(rule),
                                shown_default(rule));
            if (!child_keys(rule.path).empty()) page += "\n| key | takes | default | meaning |\n|---|---|---|---|\n";
        } else {
            page += fmt::format("| `{}` | {} | {} | {} |\n", shown_path(rule.path), shown_type(rule),
                                shown_default(rule), rule.doc);
        }
    }
    return page;
}

std::string scene_json_schema() {
    Json schema{{"$schema", "https://json-schema.org/draft/2020-12/schema"}, {"title", "Kluft scene"}};
    schema.update(mapping_schema({}));
    schema["if"] = Json{{"not", Json{{"required", Json::array({"extends"})}}}};
    schema["then"] = requirements({});
    return schema.dump(2) + "\n";
}

} // namespace kluft
