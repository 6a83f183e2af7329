#include "kluft/calibration/target_runs.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include <fmt/format.h>

#include "kluft/core/diagnostics.hpp"
#include "kluft/core/digest.hpp"
#include "kluft/output/history_table.hpp"
#include "kluft/output/summary.hpp"
#include "kluft/scene/scene_reader.hpp"
#include "kluft/studies/comparison.hpp"
#include "kluft/studies/strength_tests.hpp"
#include "kluft/studies/study_results.hpp"

namespace kluft {

namespace {

namespace fs = std::filesystem;

/// A run before its copies are made: a scene and settings on top of it.
struct PlannedRun {
    std::size_t scene = 0; ///< of the calibration's scenes
    std::string name;      ///< from the settings
    std::vector<StudySetting> set;
};

/// The scenes of the calibration and its targets, each once.
std::vector<fs::path> scenes_of(const Calibration& calibration) {
    std::vector<fs::path> scenes{calibration.scene};
    for (const CalibrationTarget& target : calibration.targets)
        if (std::ranges::find(scenes, target.scene) == scenes.end()) scenes.push_back(target.scene);
    return scenes;
}

/// From all settings: a run with the same ones is the same run.
std::string name_of(const std::vector<StudySetting>& set) {
    Digest digest;
    for (const StudySetting& each : set) digest.add(each.assignment());
    return digest.text();
}

/// Stage 0 of the scene presses these boundaries.
std::vector<std::string> pressed_boundaries(const Scene& scene) {
    std::vector<std::string> names;
    for (const auto& [boundary, pressure] : scene.loads.stages.front().pressure)
        names.push_back(scene.geometry.boundaries[static_cast<std::size_t>(boundary)].name);
    return names;
}

/// The runs that a target takes at a place: one, or one per pressure of its envelope.
std::vector<PlannedRun> planned_runs(const Calibration& calibration, const CalibrationTarget& target,
                                     const Eigen::VectorXd& x) {
    const auto scenes = scenes_of(calibration);
    PlannedRun run;
    run.scene = static_cast<std::size_t>(std::ranges::find(scenes, target.scene) - scenes.begin());
    run.set = settings_at(calibration, x);
    run.set.insert(run.set.end(), target.set.begin(), target.set.end());
    run.name = name_of(run.set);
    if (!is_of_envelope(target.quantity)) return {run};
    const auto pressed = pressed_boundaries(read_scene(target.scene, assignments(run.set)));
    std::vector<PlannedRun> runs;
    for (const std::string& pressure : target.pressures) {
        runs.push_back(run);
        for (const std::string& boundary : pressed)
            runs.back().set.push_back({"stages.0.pressure." + boundary, pressure, target.at});
        runs.back().name = name_of(runs.back().set);
    }
    return runs;
}

/// The copies of a scene: with its own noise of the strengths if it has one, and another place or seed of its net.
ReplicaPlan plan_for(const Calibration& calibration, const Scene& scene) {
    ReplicaPlan plan = calibration.replicas;
    if (scene.cracks.strength_noise.deviation > 0.0) plan.strength_noise = scene.cracks.strength_noise.deviation;
    plan.offset = scene.geometry.tessellation.has_value();
    return plan;
}

std::string flow_mapping(const std::vector<StudySetting>& set) {
    std::map<std::string, std::string> values; // the later ones win
    for (const StudySetting& each : set) values[each.key] = each.value;
    std::string text;
    for (const auto& [key, value] : values) text += fmt::format("{}\"{}\": {}", text.empty() ? "" : ", ", key, value);
    return "{" + text + "}";
}

/// A study whose variants are the runs of one scene.
std::string study_text(const Calibration& calibration, const fs::path& scene, const std::vector<PlannedRun>& runs) {
    std::string text =
        fmt::format("scene: \"{}\"\nset: {{output.pictures: false, output.report: false, output.fields: false}}\n"
                    "curve: false\nreference: none\nvariants:\n",
                    scene.string());
    std::set<std::string> written;
    for (const PlannedRun& run : runs)
        if (written.insert(run.name).second)
            text += fmt::format("  - {{name: \"{}\", set: {}}}\n", run.name, flow_mapping(run.set));
    if (calibration.replicas.count == 0) return text;
    const ReplicaPlan plan = plan_for(calibration, read_scene(scene, assignments(runs.front().set)));
    return text + fmt::format("replicas: {{count: {}, seed: {}, strength_noise: {:.12g}, offset: {}}}\n", plan.count,
                              plan.seed, plan.strength_noise, plan.offset);
}

fs::path directory_of_scene(const fs::path& directory, std::size_t scene) {
    return directory / "runs" / std::to_string(scene);
}

fs::path directory_of_run(const Calibration& calibration, const fs::path& directory, const PlannedRun& run,
                          int replica) {
    const std::string copy = calibration.replicas.count > 0 ? fmt::format(",r{}", replica) : "";
    return directory_of_scene(directory, run.scene) / "cases" / (run.name + copy);
}

int n_copies(const Calibration& calibration) { return std::max(calibration.replicas.count, 1); }

/// Runs all of one scene. False when the user has stopped. Throws ResourceError where a run failed: what it has until then is not
/// what the values of the parameters give.
bool run_scene_of(const Calibration& calibration, const RunPlace& place, std::size_t scene,
                  const std::vector<PlannedRun>& runs, const std::atomic<bool>& stop) {
    const fs::path directory = directory_of_scene(place.directory, scene);
    const ReadStudy read =
        read_study_text(study_text(calibration, scenes_of(calibration)[scene], runs), {}, directory / "study.yaml");
    prepare_study(read, place.program, directory);
    const StudyTable table = run_study(read, directory, {place.program, place.jobs, place.show}, stop);
    if (stop) return false;
    for (const StudyCase& one : table.cases)
        if (one.status == CaseStatus::failed)
            throw ResourceError(fmt::format("{}: the run failed ({}); the same command goes on from here",
                                            (directory / "cases" / one.name).string(), one.reason));
    return true;
}

// ---- what a run tells ------------------------------------------------------------------------------------------------

/// The summary of a run whose peak is one; throws InputError for another one.
RunSummary summary_with_peak(const fs::path& directory) {
    RunSummary summary = read_summary(directory / "summary.json");
    const PeakPoint peak = read_peak(directory, directory.filename());
    if (peak.net_locked)
        throw InputError("loose blocks of the net carried the load, as masonry does, and not the rock");
    if (peak.unloaded)
        throw InputError(
            "the stress fell after the sides were unloaded: with their pressure the body could have borne more");
    if (is_strength(summary.numbers) || summary.status == RunStatus::collapsed) return summary;
    throw InputError(fmt::format("the stress had neither fallen nor levelled off where the run ended ({}{}{})",
                                 status_name(summary.status), summary.message.empty() ? "" : ": ",
                                 summary.message.substr(0, summary.message.find('\n'))));
}

double value_of_run(const CalibrationTarget& target, const fs::path& directory) {
    const RunSummary summary = summary_with_peak(directory);
    std::optional<double> value;
    if (target.quantity == TargetQuantity::peak_stress) value = summary.numbers.peak_stress;
    if (target.quantity == TargetQuantity::peak_strain) {
        if (summary.numbers.levelled_off)
            throw InputError("the stress levelled off: there is no peak to have a strain");
        value = summary.numbers.peak_strain;
    }
    if (target.quantity == TargetQuantity::residual_stress) value = summary.numbers.residual_stress;
    if (target.quantity == TargetQuantity::tensile_strength && summary.numbers.peak_stress) {
        value = -*summary.numbers.peak_stress;
        if (*value <= 0.0) throw InputError("the platen presses the body; a tensile strength asks for one that pulls");
    }
    if (!value) throw InputError(fmt::format("summary.json has no {}", quantity_name(target.quantity)));
    return *value;
}

PeakPoint peak_of_run(const fs::path& directory) {
    (void)summary_with_peak(directory);
    return read_peak(directory, directory.filename());
}

double value_of_envelope(const CalibrationTarget& target, const std::vector<fs::path>& directories) {
    std::vector<PeakPoint> peaks;
    for (const fs::path& directory : directories) peaks.push_back(peak_of_run(directory));
    const Envelope envelope = fit_envelope(peaks);
    return target.quantity == TargetQuantity::cohesion ? envelope.cohesion : envelope.friction_angle;
}

std::vector<Vec2> curve_of_run(const fs::path& directory) {
    const RunSummary summary = read_summary(directory / "summary.json");
    return growing_curve(platen_rows(read_history(directory / "history.csv"), summary.platen_stage.value_or(0)));
}

/// Linear between points whose x grows; x within them.
double interpolated_at(const std::vector<Vec2>& curve, double x) {
    const auto after = std::ranges::lower_bound(curve, x, {}, [](const Vec2& point) { return point.x(); });
    if (after == curve.begin()) return after->y();
    if (after == curve.end()) return curve.back().y();
    const Vec2& before = *(after - 1);
    return std::lerp(before.y(), after->y(), (x - before.x()) / (after->x() - before.x()));
}

/// Differences at equal steps of the measured strain over the largest measured stress; together they have the norm of the
/// root of their mean square over the tolerance.
Eigen::VectorXd rows_of_curve(const CalibrationTarget& target, const std::vector<Vec2>& curve) {
    const double end = target.curve.back().x();
    if (curve.size() < 2 || curve.back().x() < end * (1.0 - 1e-9))
        throw InputError(fmt::format("the run ends at an axial strain of {:.4g}, before the measured curve at {:.4g}",
                                     curve.empty() ? 0.0 : curve.back().x(), end));
    double largest = 0.0;
    for (const Vec2& point : target.curve) largest = std::max(largest, std::abs(point.y()));
    Eigen::VectorXd rows(n_compared_points);
    const double begin = std::max(target.curve.front().x(), curve.front().x());
    for (int i = 0; i < n_compared_points; ++i) {
        const double x = std::lerp(begin, end, static_cast<double>(i) / (n_compared_points - 1));
        rows[i] = (interpolated_at(curve, x) - interpolated_at(target.curve, x)) / largest;
    }
    return rows / (target.tolerance * std::sqrt(static_cast<double>(n_compared_points)));
}

/// The rows of all targets of one copy at a place; nothing and the reason where one of them is not told.
std::optional<Eigen::VectorXd> rows_of_copy(const Calibration& calibration, const RunTargets& targets,
                                            const fs::path& directory, const Eigen::VectorXd& x, int replica,
                                            std::string& note) {
    Eigen::VectorXd rows(targets.n_rows);
    for (std::size_t t = 0; t < targets.targets.size(); ++t) {
        const CalibrationTarget& target = calibration.targets[targets.targets[t]];
        std::vector<fs::path> directories;
        for (const PlannedRun& run : planned_runs(calibration, target, x))
            directories.push_back(directory_of_run(calibration, directory, run, replica));
        const auto own = rows_of_runs(target, directories, note);
        if (!own) return std::nullopt;
        rows.segment(targets.groups[t].first, targets.groups[t].n) = *own;
    }
    return rows;
}

} // namespace

std::string scenes_digest(const Calibration& calibration) {
    std::string digests;
    for (const CalibrationTarget& target : calibration.targets) {
        std::vector<StudySetting> set = settings_at(calibration, start_of(calibration));
        set.insert(set.end(), target.set.begin(), target.set.end());
        digests += scene_digest(target.scene, assignments(set)) + ' ';
    }
    return digests;
}

RunTargets run_targets(const Calibration& calibration) {
    RunTargets result;
    for (std::size_t i = 0; i < calibration.targets.size(); ++i) {
        const CalibrationTarget& target = calibration.targets[i];
        if (is_elastic(target.quantity)) continue;
        const Eigen::Index n = target.quantity == TargetQuantity::curve ? n_compared_points : 1;
        result.targets.push_back(i);
        const double of_row = target.tolerance * std::sqrt(static_cast<double>(n));
        result.groups.push_back({result.n_rows, n, target.weight, 1.0 / of_row});
        result.n_rows += n;
    }
    return result;
}

std::optional<Eigen::VectorXd> rows_of_runs(const CalibrationTarget& target, const std::vector<fs::path>& directories,
                                            std::string& note) {
    try {
        if (target.quantity == TargetQuantity::curve) return rows_of_curve(target, curve_of_run(directories.front()));
        const double value = is_of_envelope(target.quantity) ? value_of_envelope(target, directories)
                                                             : value_of_run(target, directories.front());
        return Eigen::VectorXd::Constant(1, (value - target.value) / (target.tolerance * target.value));
    } catch (const InputError& error) {
        note = fmt::format("{} of {}: {}", target.name, directories.front().filename().string(), error.what());
        return std::nullopt;
    }
}

std::optional<std::vector<Evaluation>> evaluate_by_runs(const Calibration& calibration, const RunTargets& targets,
                                                        const RunPlace& place,
                                                        const std::vector<Eigen::VectorXd>& places,
                                                        const std::atomic<bool>& stop) {
    std::map<std::size_t, std::vector<PlannedRun>> of_scene;
    for (const Eigen::VectorXd& x : places)
        for (const std::size_t t : targets.targets)
            for (PlannedRun& run : planned_runs(calibration, calibration.targets[t], x))
                of_scene[run.scene].push_back(std::move(run));
    std::string refusal;
    for (const auto& [scene, runs] : of_scene) {
        try {
            if (!run_scene_of(calibration, place, scene, runs, stop)) return std::nullopt;
        } catch (const InputError& error) {
            refusal = error.what(); // the scene's reader refuses these values of the parameters
        }
    }
    std::vector<Evaluation> evaluations;
    for (const Eigen::VectorXd& x : places) {
        Evaluation evaluation;
        evaluation.x = x;
        for (int replica = 0; replica < n_copies(calibration); ++replica)
            if (auto rows = rows_of_copy(calibration, targets, place.directory, x, replica, evaluation.note))
                evaluation.copies.push_back(std::move(*rows));
        if (!refusal.empty() && !evaluation.note.empty()) evaluation.note = refusal;
        // A mean over fewer copies at one place than at another would compare different nets.
        evaluation.is_usable = static_cast<int>(evaluation.copies.size()) == n_copies(calibration);
        evaluations.push_back(std::move(evaluation));
    }
    return evaluations;
}

std::vector<StudySetting> settings_of_copy(const Calibration& calibration, const fs::path& scene,
                                           const std::vector<StudySetting>& set, int replica) {
    if (calibration.replicas.count == 0) return {};
    const Scene read = read_scene(scene, assignments(set));
    ReplicaNet net;
    if (read.geometry.tessellation) {
        net.hexagons = read.geometry.tessellation->hexagons;
        net.voronoi = read.geometry.tessellation->voronoi.has_value();
        net.triangles = read.geometry.tessellation->triangles.has_value();
    }
    return replica_settings(plan_for(calibration, read), replica, net);
}

std::vector<PeakPoint> peaks_at(const Calibration& calibration, const CalibrationTarget& target,
                                const fs::path& directory, const Eigen::VectorXd& x) {
    std::vector<PeakPoint> peaks;
    for (const PlannedRun& run : planned_runs(calibration, target, x)) {
        for (int replica = 0; replica < n_copies(calibration); ++replica) {
            const fs::path place = directory_of_run(calibration, directory, run, replica);
            try {
                peaks.push_back(peak_of_run(place));
            } catch (const InputError&) {
                continue; // told of where it was evaluated
            }
        }
    }
    return peaks;
}

std::vector<Vec2> curve_at(const Calibration& calibration, const CalibrationTarget& target, const fs::path& directory,
                           const Eigen::VectorXd& x) {
    try {
        return curve_of_run(directory_of_run(calibration, directory, planned_runs(calibration, target, x).front(), 0));
    } catch (const InputError&) {
        return {};
    }
}

} // namespace kluft
