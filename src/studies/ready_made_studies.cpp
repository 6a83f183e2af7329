#include "kluft/studies/ready_made_studies.hpp"

#include <algorithm>
#include <set>
#include <string_view>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "kluft/core/diagnostics.hpp"
#include "kluft/core/nearest_name.hpp"
#include "kluft/output/atomic_file.hpp"
#include "kluft/scene/scene_reader.hpp"
#include "kluft/studies/trade_study.hpp"

namespace kluft {

namespace {

namespace fs = std::filesystem;

constexpr std::string_view first_line = "# Ready-made by kluft study; written anew each time.";

/// A text in YAML's double quotes.
std::string quoted(const std::string& text) {
    std::string result = "\"";
    for (const char c : text) {
        if (c == '"' || c == '\\') result += '\\';
        result += c;
    }
    return result + '"';
}

/// The last stage that moves a platen or reduces strengths, or else the last one.
std::size_t studied_stage(const Scene& scene) {
    const auto& stages = scene.loads.stages;
    for (std::size_t i = stages.size(); i-- > 0;)
        if (stages[i].motion || stages[i].strength_reduction) return i;
    return stages.size() - 1;
}

const char* quantities_of(const Stage& stage) {
    if (stage.strength_reduction) return "factor_of_safety, cracks_tension, cracks_shear";
    return stage.motion ? "peak_stress, peak_strain, residual_stress, youngs_modulus, cracks_tension, cracks_shear"
                        : "cracks_tension, cracks_shear";
}

} // namespace

std::vector<std::string> ready_made_names() { return {"step-size", "trade"}; }

std::string ready_made_study(const std::string& name, const fs::path& scene,
                             const std::vector<std::string>& overrides) {
    const std::string begin = std::string(first_line) + '\n';
    if (name == "step-size") return begin + step_size_study(scene, overrides);
    if (name == "trade")
        return begin + trade_study(fs::absolute(scene).lexically_normal(), read_scene(scene, overrides));
    throw InputError("kluft study: expected one of " + listed(ready_made_names()) + ", found '" + name + "'");
}

bool is_ready_made(const fs::path& file) { return read_file(file).starts_with(std::string(first_line) + '\n'); }

std::string step_size_study(const fs::path& scene, const std::vector<std::string>& overrides) {
    const Scene read = read_scene(scene, overrides);
    const std::size_t stage = studied_stage(read);
    std::set<int> steps{25, 50, 100, 200, 400, 800};
    steps.insert(read.loads.stages[stage].steps);
    return fmt::format(
        R"(# How the results depend on the number of load steps.
title: {}
scene: {}
vary:
  stages.{}.steps: [{}]
quantities: [{}]
)",
        quoted("Load steps: " + heading_of(read)), quoted(fs::absolute(scene).lexically_normal().string()), stage,
        fmt::join(steps, ", "), quantities_of(read.loads.stages[stage]));
}

} // namespace kluft
