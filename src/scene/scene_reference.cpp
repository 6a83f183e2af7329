#include "kluft/scene/scene_reference.hpp"

#include <algorithm>
#include <string_view>

#include <fmt/format.h>

#include "kluft/scene/quantity.hpp"
#include "kluft/scene/scene_schema.hpp"

namespace kluft {

namespace {

constexpr std::string_view introduction = R"(# Scenes

A scene is a YAML file that says everything about a run: rock, fractures, geometry, loading, solution and output. The
scene's name is the file's stem. `kluft check SCENE` reads a scene and runs nothing.

This page is written from the table of keys that also checks scenes, so it is complete. So is the JSON Schema that
`kluft schema >scene.schema.json` says: with the first line `# yaml-language-server: $schema=scene.schema.json` in a scene,
editors complete its keys and mark mistakes. The models name `docs/schema/scene.json`, which is the same.

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
  bottom: {support: pinned}
stages:
  - {name: weight, pressure: {left: 0.1 MPa, right: 0.1 MPa, top: 0.1 MPa}}
  - {name: platen, strain: {boundary: top, value: 1 %}, steps: 20}
```

## Numbers

Plain numbers are in SI units, angles in degrees. A number may carry its unit, `25 MPa`, `38 cm`, `200 MPa/m`,
`2650 kg/m3`, `1.3 %`, `30 deg`; it is converted and its dimension is checked. Units combine with `/`, `*` and blanks and
take powers (`m3`, `m^3`, `s-2`). Known units: UNITS.
`nan`, `inf`, leading zeros (`012`), hexadecimal, decimal commas and digit groups are refused, and so is a number in quotes without a
unit. Pressures, stresses of platens, strains and inward displacements are positive in compression; tensile strengths are
positive.

## Text

Names of materials, interfaces and boundaries are made of letters, digits, `_` and `-`. A file is UTF-8 text of at most
1 MB with lines that end in LF or CR LF; large geometry goes into maps (GeoJSON of at most 100 MB) that the scene names. All
are regular files: pipes and devices are refused. Lengths and coordinates are at most 1e9 m, and a net has at most 2e6
cells. YAML's anchors, aliases and tags, several documents in
one file and duplicate keys are refused. JSON is YAML too.

## Maps

The domain and the fractures may be maps: GeoJSON, and in a build with GDAL (`kluft --version` says) GeoPackage (`.gpkg`) and
shapefile (`.shp` with its `.shx` and `.dbf`). Coordinates of the scene are then those of the map, in metres. The domain is a window on
the map: traces are clipped to it, one line tells how many lie outside, and a map of which nothing lies inside is an error.

```yaml
geometry:
  crs: EPSG:25832
  domain: {rectangle: {origin: [691400, 5334600], width: 200, height: 200}}
  fractures:
    - file: outcrop.gpkg
      layer: traces
      attribute: set
      interfaces: [{value: A, interface: bedding}, {value: B, interface: joint}]
```

Coordinates in degrees are projected to `geometry.crs`, and refused without it; systems in other units than metres likewise. Without
`geometry.crs` all maps of a scene have to be in one system. A map that does not say its system is in metres where a coordinate is beyond
180 or 90. Otherwise, beside `geometry.crs`, GeoJSON is in degrees (RFC 7946) and other files need `file_crs`; without it small numbers
about the origin are metres, which a warning tells, and a small area far from the origin is refused as degrees. `file_crs: local` ends all
doubt: metres of the scene. `attribute` chooses the kind of interface: by the list `interfaces`, or, without it, as the name of an
interface; `interface` is for all other values. Heights are left out, arcs become chords of four degrees.

## Extending and overriding

`extends: other.yaml` (relative to the file that says it) takes another scene and changes it: mappings merge key by key,
lists and single values replace. `null` (or `~`) removes a key that the other scene has, which is how to change from one
way of giving a stiffness to another, or from a rectangle to a polygon.

`--set key.path=value` on the command line does the same after that. The path goes through mappings by key and through
lists by index from 0 (the number of items appends one); the value is YAML:
`--set stages.1.steps=200 --set geometry.tessellation.triangles.spacing=0.03 --set geometry.tessellation=null`.
A mapping is merged here, too: `--set 'stages.1={steps: 200}'` keeps all else of the stage; an empty one, which changes nothing,
is refused.

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
    return scene_schema().expected_text(rule);
}

} // namespace

std::string scene_reference_markdown() {
    std::string page(introduction);
    replace_all(page, "UNITS", known_units());
    for (const auto& rule : scene_schema()) {
        if (rule.path.find('.') == std::string_view::npos) {
            page += fmt::format("\n### `{}`\n\n{}\n\nTakes {}. Default: {}.\n", rule.path, rule.doc, shown_type(rule),
                                default_text(rule));
            if (!scene_schema().child_keys(rule.path).empty())
                page += "\n| key | takes | default | meaning |\n|---|---|---|---|\n";
        } else {
            page += fmt::format("| `{}` | {} | {} | {} |\n", shown_path(rule.path), shown_type(rule),
                                default_text(rule), rule.doc);
        }
    }
    return page;
}

} // namespace kluft
