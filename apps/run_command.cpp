// kluft run SCENE
#include <algorithm>
#include <filesystem>
#include <iterator>
#include <memory>
#include <new>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "commands.hpp"
#include "failure.hpp"
#include "kluft/assembly/blas.hpp"
#include "kluft/core/diagnostics.hpp"
#include "kluft/core/memory.hpp"
#include "kluft/core/processor_time.hpp"
#include "kluft/core/version.hpp"
#include "kluft/kinematics/affine.hpp"
#include "kluft/output/directory_lock.hpp"
#include "kluft/output/progress_line.hpp"
#include "kluft/output/run_log.hpp"
#include "kluft/output/run_writer.hpp"
#include "kluft/output/state_file.hpp"
#include "kluft/output/summary.hpp"
#include "kluft/report/run_page.hpp"
#include "kluft/scene/scene_model.hpp"
#include "kluft/scene/scene_reader.hpp"
#include "kluft/simulation/simulation.hpp"
#include "kluft/simulation/state_fields.hpp"
#include "kluft/studies/scene_run.hpp"
#include "standard_output.hpp"
#include "stop_request.hpp"

namespace kluft {

namespace {

namespace fs = std::filesystem;

/// Passes everything on to the files and keeps the terminal informed.
class RunObserver : public StepObserver {
public:
    RunObserver(const Model& model, CrackCriterion criterion, RunWriter& writer, bool quiet)
        : writer_(writer), contacts_(model, criterion) {
        if (!quiet) line_ = std::make_unique<ProgressLine>(ProgressLine::on_standard_error());
    }
    void equilibrium(const StepRecord& record) override { writer_.equilibrium(record); }
    void crack(const CrackRecord& crack) override { writer_.crack(crack); }
    void jump(const JumpRecord& jump) override { writer_.jump(jump); }
    void step(const StepRecord& record, const State& state, const std::function<FieldRecord()>& fields,
              bool last_of_stage) override {
        writer_.step(record, state, fields, last_of_stage);
        contacts_.step(record, state);
    }
    void progress(const Progress& progress) override {
        if (line_) line_->update(progress);
    }
    void clear() {
        if (line_) line_->clear();
    }

    [[nodiscard]] const ContactWatch& contacts() const { return contacts_; }

private:
    RunWriter& writer_;
    ContactWatch contacts_;
    std::unique_ptr<ProgressLine> line_;
};

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

/// Each is in the log, and told where the run is not quiet.
void warn(const std::vector<std::string>& warnings, RunLog& log, bool quiet) {
    for (const std::string& warning : warnings) {
        log.warning(warning);
        if (!quiet) tell("warning: {}\n", warning);
    }
}

/// Those of the warnings that have not been told.
std::vector<std::string> without(const std::vector<std::string>& told, const std::vector<std::string>& warnings) {
    std::vector<std::string> rest;
    std::ranges::copy_if(warnings, std::back_inserter(rest),
                         [&](const std::string& warning) { return std::ranges::find(told, warning) == told.end(); });
    return rest;
}

/// A report that cannot be written for want of disk or memory is an end like that of pictures.
void write_report(const SceneModel& built, const Scene& scene, const RunWriter& writer, const RunSummary& summary,
                  RunLog& log, const fs::path& directory, bool quiet) {
    try {
        warn(write_run_page(directory, scene, built.model, built.cut), log, quiet);
    } catch (const ResourceError& error) {
        log.error(error.what());
        writer.give_up(summary, error.what());
        throw;
    } catch (const std::bad_alloc&) {
        writer.give_up(summary, "out of memory");
        throw;
    }
}

/// The run itself; whatever happens, the last committed state and the tables reach the disk if the disk allows it.
ExitCode simulate(const SceneModel& built, const Scene& scene, State& state, RunWriter& writer, RunLog& log,
                  const fs::path& directory, const EarlierRuns& earlier, bool quiet) {
    const Model& model = built.model;
    RunObserver observer(model, scene.cracks.criterion, writer, quiet);
    RunReport report = run_stages(model, scene, state, observer, stop_requested);
    observer.clear();
    warn_of_contacts(model, state, observer.contacts(), report);
    warn(without(earlier.warnings, report.warnings), log, quiet);
    if (!report.diagnosis.empty()) {
        log.error(report.diagnosis);
        tell("{}\n", report.diagnosis);
    }
    add_earlier_warnings(scene, model, earlier, report);
    RunSummary summary;
    try {
        summary = writer.finish({report, unknowns_per_block(model.kinematics) * model.system.n_blocks(),
                                 earlier.cpu_s + processor_seconds(), std::string(version()), blas_core()},
                                state, [&] { return fields_of_state(model, state); });
    } catch (const ResourceError& error) {
        log.error(error.what());
        if (report.diagnosis == error.what()) return ExitCode::out_of_resources; // said already
        throw;
    }
    warn(without(report.warnings, summary.warnings), log, quiet); // what only its numbers have shown
    const std::string closing = closing_line(report, summary, directory);
    log.info(closing);
    const bool has_begun = report.status != RunStatus::out_of_resources || state.at.step > 0;
    if (scene.output.report && has_begun && !memory_ran_out())
        write_report(built, scene, writer, summary, log, directory, quiet);
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
    require_no_file(directory);
    if (arguments.resume && scene.integrator == Integrator::explicit_motion)
        throw InputError("--resume: expected analysis.integrator: implicit, found explicit; a saved state has no "
                         "velocities to go on with");
    if (!is_locked(directory))
        (void)scene_file_for(directory, scene, arguments.resume || arguments.force); // early; again under the lock
    const SceneModel built = build_for_run(scene);
    const Model& model = built.model;
    const int unknowns = unknowns_per_block(model.kinematics) * model.system.n_blocks();
    if (arguments.threads > 0) set_blas_threads(arguments.threads);

    RunWriterOptions options = run_writer_options(scene, model);
    std::optional<DirectoryLock> lock;
    const bool has_something = !arguments.resume || fs::is_directory(directory); // to go on from
    if (has_something) {
        lock.emplace(
            directory, "kluft run " + arguments.scene,
            "wait for its end or choose another directory with -o; neither --force nor --resume takes it away");
        options.scene_file = scene_file_for(directory, scene, arguments.resume || arguments.force);
    }
    State state = initial_state(model);
    if (arguments.resume) {
        state = state_to_resume(directory, scene, options.fingerprint);
        options.resumed_step = state.at.step;
    }
    const EarlierRuns earlier =
        arguments.resume ? earlier_runs(directory) : EarlierRuns{}; // before the writer removes it
    listen_for_stop();
    RunWriter writer(directory, model.system, std::move(options));
    RunLog log(directory / "run.log", arguments.resume);
    log.info(fmt::format("kluft {} runs {}: {} blocks, {} interfaces, {} unknowns", version(), arguments.scene,
                         model.system.n_blocks(), model.system.n_interfaces(), unknowns));
    for (const auto& override_text : arguments.overrides) log.info("--set " + override_text);
    RunReport before;
    add_earlier_warnings(scene, model, earlier, before);
    warn(before.warnings, log, arguments.quiet);
    return simulate(built, scene, state, writer, log, directory, earlier, arguments.quiet);
}

} // namespace kluft
