// What a scene amounts to, without running it.
#pragma once

#include <string>
#include <vector>

#include "kluft/scene/scene.hpp"
#include "kluft/scene/scene_model.hpp"

namespace kluft {

struct SceneAccount {
    int blocks = 0;
    int interfaces = 0;
    int unknowns = 0;
    double smallest_area = 0.0;  ///< m2
    double smallest_edge = 0.0;  ///< m
    double smallest_angle = 0.0; ///< between successive edges of a block (radians)
    int merged = 0;              ///< slivers that went into a neighbour
    double memory_bytes = 0.0;   ///< largest memory of a run, about

    struct Line {
        std::string name; ///< empty where the line goes on with what the one before says
        std::string text;
    };
    std::vector<Line> lines; ///< all of it in words
    std::vector<std::string> warnings;
};

[[nodiscard]] SceneAccount account_of(const Scene& scene, const SceneModel& built);

/// The account as `kluft check` says it, one line each.
[[nodiscard]] std::string text_of(const SceneAccount& account);

/// The account as an object of JSON: `scene`, `title`, `plane`, `kinematics`; `blocks`, `interfaces`, `unknowns`;
/// `smallest_area` (m2), `smallest_edge` (m), `smallest_angle` (degrees); `merged` slivers and pieces `taken_off` a free surface (`area`, `x`, `y`); `boundaries` with
/// `name`, `length` (m), mean outward `normal`, `lower` and `upper` corner of where they lie (m) and `support`; `interface_types` with
/// `name`, `kind`, `count`, `normal_stiffness` and `shear_stiffness` (Pa/m); `stages` with `name` and `steps`; `memory_bytes` of a
/// run, about; `warnings`.
[[nodiscard]] std::string json_of(const SceneAccount& account, const Scene& scene, const SceneModel& built);

} // namespace kluft
