#include "results_run.hpp"

#include <algorithm>
#include <cstdlib>
#include <vector>

#include <fmt/format.h>

#include "commands.hpp"
#include "kluft/core/diagnostics.hpp"
#include "kluft/core/nearest_name.hpp"
#include "kluft/output/field_series.hpp"
#include "kluft/output/history_table.hpp"
#include "kluft/output/kept_states.hpp"
#include "kluft/output/summary.hpp"
#include "kluft/report/run_of_results.hpp"
#include "kluft/scene/quantity.hpp"
#include "kluft/studies/finished_run.hpp"
#include "standard_output.hpp"

namespace kluft {

namespace fs = std::filesystem;

RunHeading heading_of(const fs::path& directory) {
    if (!fs::exists(directory / "summary.json")) return {run_name(directory), std::nullopt};
    const RunSummary summary = read_summary(directory / "summary.json");
    return {summary.title, summary.platen_stage};
}

bool moves_no_platen(const fs::path& directory) {
    return fs::exists(directory / "summary.json") && !heading_of(directory).platen_stage;
}

RunCurve read_curve(const fs::path& directory, const std::string& label) {
    require_results(directory);
    RunCurve curve;
    curve.label = label;
    curve.history = read_history(directory / "history.csv");
    if (curve.history.empty()) {
        require_saved_state(directory);
        throw InputError((directory / "history.csv").string() + ": no load step in it yet");
    }
    if (fs::exists(directory / "equilibria.csv")) curve.equilibria = read_history(directory / "equilibria.csv");
    curve.platen_stage = heading_of(directory).platen_stage;
    return curve;
}

void warn_of_missing_rows(const fs::path& directory) {
    if (!fs::exists(directory / "summary.json")) return;
    const RunCurve curve = read_curve(directory, {});
    const std::string missing = missing_rows(curve.history, curve.equilibria, read_summary(directory / "summary.json"));
    if (!missing.empty()) tell("warning: {}: {}\n", directory.string(), missing);
}

namespace {

int nearest_of(const std::vector<int>& steps, int step) {
    return *std::ranges::min_element(steps, {}, [&](int each) { return std::abs(each - step); });
}

/// The load step with the largest axial stress at its end.
int peak_step(const fs::path& directory) {
    const auto platen_stage = heading_of(directory).platen_stage;
    const auto step = platen_stage ? step_of_peak(read_curve(directory, {}).history, platen_stage) : std::nullopt;
    if (!step)
        throw InputError("--step peak: expected a finished run that moves a platen, found " + directory.string());
    return *step;
}

} // namespace

int step_asked_for(const std::string& text, const fs::path& directory) {
    const std::vector<int> steps = kept_steps(directory);
    if (steps.empty()) {
        require_saved_state(directory);
        throw InputError(directory.string() + ": expected fields of a load step, found none (output.fields: true)");
    }
    if (text.empty() || text == "last") return steps.back();
    if (text == "peak") {
        const int peak = peak_step(directory);
        const int nearest = nearest_of(steps, peak);
        if (nearest != peak) tell("the peak is at load step {}; the nearest state that is kept is {}\n", peak, nearest);
        return nearest;
    }
    const auto number = read_integer(text);
    if (!number)
        throw InputError(fmt::format("--step: expected a load step, peak or last, found '{}'{}", text,
                                     suggestion(text, {"peak", "last"})));
    const int step = static_cast<int>(std::clamp<long long>(*number, 0, steps.back()));
    if (*number != step || std::ranges::find(steps, step) == steps.end())
        throw InputError(fmt::format("--step: expected a load step whose fields are kept, the nearest of which is {}, "
                                     "found {} (output.fields_every: 1 keeps all)",
                                     nearest_of(steps, step), text));
    return step;
}

} // namespace kluft
