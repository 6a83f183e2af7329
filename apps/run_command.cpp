// kluft run SCENE
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <new>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "commands.hpp"
#include "earlier_results.hpp"
#include "failure.hpp"
#include "kluft/assembly/blas.hpp"
#include "kluft/core/diagnostics.hpp"
#include "kluft/core/memory.hpp"
#include "kluft/core/version.hpp"
#include "kluft/kinematics/affine.hpp"
#include "kluft/output/directory_lock.hpp"
#include "kluft/output/progress_line.hpp"
#include "kluft/output/run_log.hpp"
#include "kluft/output/run_writer.hpp"
#include "kluft/output/state_file.hpp"
#include "kluft/output/summary.hpp"
#include "kluft/reference/explicit_simulation.hpp"
#include "kluft/scene/scene_as_run.hpp"
#include "kluft/scene/scene_model.hpp"
#include "kluft/scene/scene_reader.hpp"
#include "kluft/simulation/contact_pressure.hpp"
#include "kluft/simulation/fingerprint.hpp"
#include "kluft/simulation/measurements.hpp"
#include "kluft/simulation/simulation.hpp"
#include "kluft/simulation/state_fields.hpp"
#include "kluft/simulation/strength_reduction.hpp"
#include "standard_output.hpp"
#include "stop_request.hpp"

namespace kluft {

namespace {

namespace fs = std::filesystem;

/// Below this many unknowns the BLAS gets one thread: more make it slower (measured), and one repeats to the bit.
constexpr int unknowns_worth_threads = 20000;

/// Passes everything on to the files and keeps the terminal informed.
class RunObserver : public StepObserver {
public:
    RunObserver(RunWriter& writer, bool quiet) : writer_(writer) {
        if (!quiet) line_ = std::make_unique<ProgressLine>(ProgressLine::on_standard_error());
    }
    void equilibrium(const StepRecord& record) override { writer_.equilibrium(record); }
    void crack(const CrackRecord& crack) override { writer_.crack(crack); }
    void jump(const JumpRecord& jump) override { writer_.jump(jump); }
    void step(const StepRecord& record, const State& state, const std::function<FieldRecord()>& fields,
              bool last_of_stage) override {
        for (const double stress : {record.axial_stress, record.lateral_stress})
            largest_stress_ = std::max(largest_stress_, std::abs(stress));
        writer_.step(record, state, fields, last_of_stage);
    }
    void progress(const Progress& progress) override {
        if (line_) line_->update(progress);
    }
    void clear() {
        if (line_) line_->clear();
    }

    /// Measured on the boundaries (Pa).
    [[nodiscard]] double largest_stress() const { return largest_stress_; }

private:
    RunWriter& writer_;
    double largest_stress_ = 0.0;
    std::unique_ptr<ProgressLine> line_;
};

RunWriterOptions writer_options(const Scene& scene, const Model& model) {
    RunWriterOptions options;
    options.fields = scene.output.fields;
    options.fields_every = scene.output.fields_every;
    options.pictures = scene.output.pictures;
    options.checkpoint_every = scene.output.checkpoint_every;
    options.checkpoint_seconds = scene.output.checkpoint_seconds;
    options.title = scene.title.empty() ? scene.name : scene.title;
    options.fingerprint = fingerprint(model);
    options.scene_text = scene.text;
    const int platen_stage = make_gauges(model).first_platen_stage;
    if (platen_stage >= 0) options.platen_stage = platen_stage;
    options.plane = scene.plane;
    options.strength_factor = reduction_of(model.loads, 0) != nullptr;
    options.motion = scene.integrator == Integrator::explicit_motion;
    options.history_columns = history_columns(model);
    for (const Material& material : scene.materials) options.material_names.push_back(material.name);
    for (const InterfaceType& type : scene.interface_types) options.interface_type_names.push_back(type.name);
    for (const FractureTrace& fracture : scene.geometry.fractures) options.fracture_names.push_back(fracture.name);
    for (const int type : model.law_types) options.law_names.push_back(scene.interface_types[type].name);
    return options;
}

/// Content of the scene.yaml to be written; "" where the directory has one of the user's own, which stays.
std::string scene_file_for(const fs::path& directory, const RunArguments& arguments, const Scene& scene) {
    if (!arguments.resume && !arguments.force) require_no_other_results(directory, scene);
    return has_own_scene_file(directory, scene) ? "" : write_scene_as_run(scene);
}

/// Processor time of the runs that this one goes on from (s): that of the last one that said so.
double earlier_cpu_s(const fs::path& directory) {
    try {
        return read_summary(directory / "summary.json").cpu_s;
    } catch (const InputError&) {
        return 0.0; // the run before was killed
    }
}

ExitCode exit_code(RunStatus status) {
    switch (status) {
    case RunStatus::done:
    case RunStatus::collapsed:
        return ExitCode::done;
    case RunStatus::no_equilibrium:
    case RunStatus::unbalanced:
        return ExitCode::no_equilibrium;
    case RunStatus::out_of_resources:
        return ExitCode::out_of_resources;
    case RunStatus::interrupted:
        return exit_code_of_stop();
    }
    return ExitCode::done;
}

std::string peak_in_words(const CurveNumbers& numbers) {
    if (numbers.net_locked)
        return " before the net locked (its loose cells carry more without a bond: no strength of the rock)";
    return numbers.peak_reached ? "" : fmt::format(" ({})", peak_remark(numbers));
}

std::string closing_line(const RunReport& report, const RunSummary& summary, const fs::path& directory) {
    std::string text = status_name(report.status);
    if (summary.platen_stage && summary.numbers.peak_stress) {
        text += fmt::format(": peak axial stress {:.4g} MPa at {:.4g} %{}", 1e-6 * *summary.numbers.peak_stress,
                            100.0 * summary.numbers.peak_strain.value_or(0.0), peak_in_words(summary.numbers));
        if (const int n = summary.numbers.jumps_to_peak; n > 0)
            text += fmt::format(" after {} {}", n, n == 1 ? "jump" : "jumps");
    }
    if (!report.remark.empty()) text += ", " + report.remark;
    if (report.results.factor_of_safety)
        text += fmt::format(", factor of safety {:.6g}", *report.results.factor_of_safety);
    if (summary.results.estimated_error)
        text += fmt::format(", estimated error {:.2g} %", 100.0 * *summary.results.estimated_error);
    const std::string work = report.motion ? fmt::format("{} time steps", report.motion->time_steps)
                                           : fmt::format("{} solves", summary.costs.open_close_iterations);
    text += fmt::format(", {} tension and {} shear cracks, {}, {:.1f} s; results in {}", summary.numbers.cracks_tension,
                        summary.numbers.cracks_shear, work, summary.costs.elapsed_s, directory.string());
    if (summary.numbers.unbalanced_steps > 0)
        text += fmt::format("; {} steps unbalanced", summary.numbers.unbalanced_steps);
    return text;
}

RunReport integrate(const Model& model, const Scene& scene, State& state, StepObserver& observer) {
    if (scene.integrator == Integrator::explicit_motion) {
        return run_explicit(model, scene.cracks, scene.solver, scene.explicit_options, state, observer, stop_requested);
    }
    return run_simulation(model, scene.cracks, scene.solver, state, observer, stop_requested);
}

/// Where memory has run out, what was run is all that counts.
void warn_of_contacts(const Model& model, const State& state, double largest_stress, RunReport& report) {
    if (report.status == RunStatus::out_of_resources || report.status == RunStatus::interrupted) return;
    try {
        const std::string warning = contact_pressure_warning(model, state, largest_stress);
        if (!warning.empty()) report.warnings.push_back(warning);
    } catch (const std::bad_alloc&) {
        return;
    }
}

std::vector<std::string> joined(std::vector<std::string> texts, const std::vector<std::string>& more) {
    texts.insert(texts.end(), more.begin(), more.end());
    return texts;
}

/// The run itself; whatever happens, the last committed state and the tables reach the disk if the disk allows it.
ExitCode simulate(const Model& model, const Scene& scene, State& state, RunWriter& writer, RunLog& log,
                  const fs::path& directory, double earlier_cpu, bool quiet) {
    RunObserver observer(writer, quiet);
    RunReport report = integrate(model, scene, state, observer);
    observer.clear();
    warn_of_contacts(model, state, observer.largest_stress(), report);
    for (const auto& warning : report.warnings) {
        log.warning(warning);
        if (!quiet) tell("warning: {}\n", warning);
    }
    if (!report.diagnosis.empty()) {
        log.error(report.diagnosis);
        tell("{}\n", report.diagnosis);
    }
    report.warnings = joined(joined(scene.warnings, model.warnings), report.warnings);
    RunSummary summary;
    try {
        summary = writer.finish({report, unknowns_per_block(model.kinematics) * model.system.n_blocks(),
                                 earlier_cpu + processor_seconds(), std::string(version()), blas_core()},
                                state, [&] { return fields_of_state(model, state); });
    } catch (const ResourceError& error) {
        log.error(error.what());
        if (report.diagnosis == error.what()) return ExitCode::out_of_resources; // said already
        throw;
    }
    const std::string closing = closing_line(report, summary, directory);
    log.info(closing);
    if (!quiet) say("{}\n", closing);
    if (const std::string lost = lost_output(); !lost.empty()) {
        log.error(lost);
        writer.give_up(summary, lost);
        return ExitCode::out_of_resources;
    }
    return exit_code(report.status);
}

} // namespace

ExitCode run(const RunArguments& arguments) {
    require_possible_output(arguments.directory);
    return_large_pieces();
    const Scene scene = read_scene(arguments.scene, arguments.overrides);
    const fs::path directory =
        arguments.directory.empty() ? fs::path("results") / scene.name : fs::path(arguments.directory);
    if (fs::exists(directory) && !fs::is_directory(directory))
        throw InputError(directory.string() + ": expected a directory for the results, found a file");
    if (arguments.resume && scene.integrator == Integrator::explicit_motion)
        throw InputError("--resume: expected analysis.integrator: implicit, found explicit; a saved state has no "
                         "velocities to go on with");
    if (!is_locked(directory)) (void)scene_file_for(directory, arguments, scene); // early; again under the lock
    const SceneModel built = build_scene_model(scene);
    const Model& model = built.model;
    const int unknowns = unknowns_per_block(model.kinematics) * model.system.n_blocks();
    const bool one_thread = scene.solver.repeatable || unknowns < unknowns_worth_threads;
    if (one_thread) {
        set_blas_threads(1);
    } else if (arguments.threads > 0) {
        set_blas_threads(arguments.threads);
    }

    RunWriterOptions options = writer_options(scene, model);
    std::optional<DirectoryLock> lock;
    const bool has_something = !arguments.resume || fs::is_directory(directory); // to go on from
    if (has_something) {
        lock.emplace(
            directory, "kluft run " + arguments.scene,
            "wait for its end or choose another directory with -o; neither --force nor --resume takes it away");
        options.scene_file = scene_file_for(directory, arguments, scene);
    }
    State state = initial_state(model);
    if (arguments.resume) {
        state = read_state(directory / "state.h5", options.fingerprint);
        options.resumed_step = state.at.step;
    }
    const double earlier_cpu = arguments.resume ? earlier_cpu_s(directory) : 0.0; // before the writer removes it
    listen_for_stop();
    RunWriter writer(directory, model.system, std::move(options));
    RunLog log(directory / "run.log", arguments.resume);
    log.info(fmt::format("kluft {} runs {}: {} blocks, {} interfaces, {} unknowns", version(), arguments.scene,
                         model.system.n_blocks(), model.system.n_interfaces(), unknowns));
    for (const auto& override_text : arguments.overrides) log.info("--set " + override_text);
    for (const auto* warnings : {&scene.warnings, &model.warnings}) {
        for (const auto& warning : *warnings) {
            log.warning(warning);
            if (!arguments.quiet) tell("warning: {}\n", warning);
        }
    }
    return simulate(model, scene, state, writer, log, directory, earlier_cpu, arguments.quiet);
}

} // namespace kluft
