// A run whose load steps are taken one at a time. The run itself stands in a thread of its own, which waits after each load
// step; it never touches Python, and Python's threads go on while it computes.
#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <exception>
#include <filesystem>
#include <memory>
#include <mutex>
#include <new>
#include <optional>
#include <stdexcept>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <csignal>
#include <fmt/format.h>
#include <unistd.h>

#include "kluft/assembly/blas.hpp"
#include "kluft/core/diagnostics.hpp"
#include "kluft/core/processor_time.hpp"
#include "kluft/core/version.hpp"
#include "kluft/kinematics/affine.hpp"
#include "kluft/output/directory_lock.hpp"
#include "kluft/output/history_table.hpp"
#include "kluft/output/progress_line.hpp"
#include "kluft/output/run_log.hpp"
#include "kluft/output/run_writer.hpp"
#include "kluft/output/state_file.hpp"
#include "kluft/output/summary.hpp"
#include "kluft/output/vtu.hpp"
#include "kluft/report/run_page.hpp"
#include "kluft/scene/scene_model.hpp"
#include "kluft/scene/scene_reader.hpp"
#include "kluft/simulation/simulation.hpp"
#include "kluft/simulation/state_fields.hpp"
#include "kluft/studies/scene_run.hpp"
#include "module.hpp"

namespace py = pybind11;

namespace kluft {

namespace {

namespace fs = std::filesystem;

/// One run computes at a time in a process: the number of threads of the BLAS, and HDF5, are the whole process's.
std::mutex computing;

/// Of the BLAS, before any run has changed it.
int threads_of_process() {
    static const int threads = blas_threads();
    return threads;
}

/// Signals go to the thread of Python that listens to them.
class WithoutSignals {
public:
    WithoutSignals() {
        sigset_t asked;
        sigemptyset(&asked);
        for (const int signal : {SIGINT, SIGHUP, SIGQUIT, SIGALRM, SIGUSR1, SIGUSR2, SIGCHLD, SIGWINCH})
            sigaddset(&asked, signal);
        pthread_sigmask(SIG_BLOCK, &asked, &before_);
    }
    WithoutSignals(const WithoutSignals&) = delete;
    WithoutSignals& operator=(const WithoutSignals&) = delete;
    ~WithoutSignals() { pthread_sigmask(SIG_SETMASK, &before_, nullptr); }

private:
    sigset_t before_{};
};

constexpr const char* lock_holder = "a simulation in Python";

/// Where the results go; without a directory nothing is written.
struct Output {
    fs::path directory;
    std::optional<DirectoryLock> lock; ///< while the run goes on
    std::optional<RunWriter> writer;
    std::optional<RunLog> log;
    EarlierRuns earlier;
};

class Simulation : private StepObserver {
public:
    Simulation(const SceneText& text, const std::string& directory, bool resume, bool force, int threads)
        : scene_(read_scene_text(text.text, text.settings, text.file)), built_(build_for_run(scene_)),
          state_(initial_state(model())), writer_options_(run_writer_options(scene_, model())), threads_(threads) {
        if (!directory.empty()) open_output(directory, resume, force);
    }
    Simulation(const Simulation&) = delete;
    Simulation& operator=(const Simulation&) = delete;
    ~Simulation() override { close(); }

    /// Goes on to the end of the next load step; returns its row, none at the end of the run. `show` gets the progress in words.
    /// Ctrl-C, KeyboardInterrupt here, takes effect after the load step, and a second one between two solves.
    std::optional<std::string> advance(const py::object& show) {
        require_standing();
        if (closed_ || (ended_ && report_.status != RunStatus::interrupted)) return std::nullopt;
        if (is_a_copy())
            throw std::runtime_error(
                "a simulation that has been started does not go on in a process that was forked from its own; "
                "make one there");
        stop_ = false;
        if (closed_) stop_ = true; // by another thread, just now
        std::optional<py::error_already_set> interrupt;
        go_on();
        while (is_computing()) {
            try {
                if (PyErr_CheckSignals() != 0) throw py::error_already_set();
                if (!show.is_none() && !stop_) show(progress_text());
            } catch (py::error_already_set& error) {
                if (interrupt) stop_ = true;
                if (!interrupt) interrupt.emplace(error);
                if (!show.is_none() && !stop_) show("stopping after this load step; Ctrl-C again stops at once");
            }
        }
        snapshot_.reset();
        if (ended_) join();
        if (interrupt) {
            if (!ended_) save();
            throw py::error_already_set(*interrupt);
        }
        if (ended_) return std::nullopt;
        return row_;
    }

    /// Ends the run where it stands, with all its files; without effect on one that has ended.
    void close() {
        closed_ = true;
        stop_ = true;
        snapshot_.reset();
        const py::gil_scoped_release others;
        {
            const std::lock_guard only(joining_);
            if (!worker_.joinable()) return;
            if (is_a_copy()) return worker_.detach(); // the thread is none of this process
        }
        hand_over();
        join_worker();
    }

    /// Saves the state with all its rows.
    void save() {
        require_standing();
        const py::gil_scoped_release others;
        const std::lock_guard only(computing);
        if (output_ && output_->writer) output_->writer->checkpoint(state_);
    }

    [[nodiscard]] std::string header() const {
        std::string text = history_header();
        if (writer_options_.strength_factor) text += ",strength_factor";
        if (writer_options_.motion) text += ',' + motion_header();
        return text;
    }
    [[nodiscard]] std::string status() const { return ended_ ? status_name(report_.status) : "running"; }
    [[nodiscard]] std::string diagnosis() const { return report_.diagnosis; }
    [[nodiscard]] std::string closing() const { return closing_; }
    [[nodiscard]] std::vector<std::string> warnings() const {
        std::vector<std::string> all = scene_.warnings;
        all.insert(all.end(), model().warnings.begin(), model().warnings.end());
        return ended_ ? report_.warnings : all;
    }
    /// Load steps so far, the stage and its load factor.
    [[nodiscard]] LoadPlace place() {
        require_standing();
        return state_.at;
    }
    [[nodiscard]] int n_blocks() const { return model().system.n_blocks(); }

    /// The state after the last load step: copied once for each load step that is looked at, and never changed.
    [[nodiscard]] std::shared_ptr<const BodyState> snapshot() {
        require_standing();
        if (!snapshot_) snapshot_ = std::make_shared<const BodyState>(state_.body);
        return snapshot_;
    }
    [[nodiscard]] py::array unknowns() {
        return array_over(snapshot(), snapshot()->displacement.data(), {n_blocks(), n_block_unknowns});
    }
    [[nodiscard]] py::array interface_status() {
        const auto* const first = reinterpret_cast<const std::uint8_t*>(snapshot()->interfaces.data());
        return array_over(snapshot(), first, {static_cast<py::ssize_t>(snapshot()->interfaces.size())});
    }

    /// The field files of the blocks and of the interfaces, as a run writes them.
    [[nodiscard]] std::pair<py::bytes, py::bytes> fields() {
        require_standing();
        std::string blocks;
        std::string interfaces;
        {
            const py::gil_scoped_release others;
            const std::lock_guard only(computing);
            const FieldRecord record = fields_of_state(model(), state_);
            StepRecord row;
            row.step = state_.at.step;
            const FieldNames names{writer_options_.material_names, writer_options_.interface_type_names,
                                   writer_options_.fracture_names};
            blocks = blocks_vtu(model().system, record, names, row);
            interfaces = interfaces_vtu(model().system, record, names, row);
        }
        return {py::bytes(blocks), py::bytes(interfaces)};
    }

private:
    [[nodiscard]] const Model& model() const { return built_.model; }

    void open_output(const fs::path& directory, bool resume, bool force) {
        if (fs::exists(directory) && !fs::is_directory(directory))
            throw InputError(directory.string() + ": expected a directory for the results, found a file");
        if (resume && scene_.integrator == Integrator::explicit_motion)
            throw InputError("resume: expected analysis.integrator: implicit, found explicit; a saved state has no "
                             "velocities to go on with");
        output_.emplace();
        output_->directory = directory;
        const bool has_something = !resume || fs::is_directory(directory); // to go on from
        if (has_something) {
            output_->lock.emplace(directory, lock_holder);
            writer_options_.scene_file = scene_file_for(directory, scene_, resume || force);
        }
        if (resume) state_ = state_to_resume(directory, scene_, writer_options_.fingerprint);
        resumes_ = resume;
        open_files();
    }

    void open_files() {
        if (!output_) return;
        if (!output_->lock) output_->lock.emplace(output_->directory, lock_holder);
        if (resumes_) output_->earlier = earlier_runs(output_->directory); // before the writer removes it
        RunWriterOptions options = writer_options_;
        if (resumes_) options.resumed_step = state_.at.step;
        output_->writer.emplace(output_->directory, model().system, std::move(options));
        output_->log.emplace(output_->directory / "run.log", resumes_);
        output_->log->info(fmt::format("kluft {} runs {} from Python: {} blocks, {} interfaces", version(), scene_.name,
                                       n_blocks(), model().system.n_interfaces()));
        for (const std::string& warning : warnings()) output_->log->warning(warning);
    }

    /// Another thread of Python may ask while a load step changes the state.
    void require_standing() {
        const std::lock_guard lock(turn_);
        if (computes_) throw std::runtime_error("the simulation is in the middle of a load step");
    }

    // ---- taking turns ----------------------------------------------------------------------------------------------

    /// Hands the turn to the run, which is started where there is none.
    void go_on() {
        if (worker_.joinable()) return hand_over();
        if (ended_) { // interrupted: once more from the last state
            resumes_ = true;
            ended_ = false;
            open_files();
        }
        computes_ = true;
        started_in_ = getpid();
        const WithoutSignals during_the_start;
        worker_ = std::thread([this] { run(); });
    }

    void hand_over() {
        const std::lock_guard lock(turn_);
        if (ended_) return;
        computes_ = true;
        turn_changed_.notify_all();
    }

    /// Waits a moment for the run, without the interpreter; true if it is still computing.
    [[nodiscard]] bool is_computing() {
        constexpr std::chrono::milliseconds pause(50);
        const py::gil_scoped_release others;
        std::unique_lock lock(turn_);
        return !turn_changed_.wait_for(lock, pause, [&] { return !computes_; });
    }

    /// Several threads of Python may wait for the end.
    void join_worker() {
        const std::lock_guard only(joining_);
        if (worker_.joinable()) worker_.join();
    }

    /// Whether the process was forked since the run was started.
    [[nodiscard]] bool is_a_copy() const { return started_in_ != 0 && started_in_ != getpid(); }

    void join() {
        const py::gil_scoped_release others;
        join_worker();
        if (failure_) std::rethrow_exception(std::exchange(failure_, nullptr));
    }

    // ---- in the thread of the run -----------------------------------------------------------------------------------

    void run() {
        try {
            start_computing();
            report_ = run_stages(model(), scene_, state_, *this, stop_);
            finish();
        } catch (...) {
            failure_ = std::current_exception();
            report_.status = RunStatus::out_of_resources;
        }
        computing.unlock();
        const std::lock_guard lock(turn_);
        ended_ = true;
        computes_ = false;
        turn_changed_.notify_all();
    }

    void start_computing() {
        computing.lock();
        set_blas_threads(threads_ > 0 ? threads_ : threads_of_process());
    }

    /// Waits until Python wants the next load step.
    void wait_for_turn() {
        computing.unlock();
        {
            std::unique_lock lock(turn_);
            computes_ = false;
            turn_changed_.notify_all();
            turn_changed_.wait(lock, [&] { return computes_ || closed_; });
        }
        start_computing();
    }

    void finish() {
        warn_of_contacts(model(), state_, contacts_, report_);
        if (output_) {
            for (const std::string& warning : report_.warnings) output_->log->warning(warning);
            if (!report_.diagnosis.empty()) output_->log->error(report_.diagnosis);
        }
        add_earlier_warnings(scene_, model(), output_ ? output_->earlier : EarlierRuns{}, report_);
        if (!output_) return;
        const RunOutcome outcome{report_, unknowns_per_block(model().kinematics) * n_blocks(),
                                 output_->earlier.cpu_s + processor_seconds(), std::string(version()), blas_core()};
        const RunSummary summary =
            output_->writer->finish(outcome, state_, [&] { return fields_of_state(model(), state_); });
        for (const std::string& warning : summary.warnings) { // what only the numbers of the run have shown
            if (std::ranges::find(report_.warnings, warning) != report_.warnings.end()) continue;
            output_->log->warning(warning);
            report_.warnings.push_back(warning);
        }
        closing_ = closing_line(report_, summary, output_->directory);
        output_->log->info(closing_);
        const bool has_begun = report_.status != RunStatus::out_of_resources || state_.at.step > 0;
        if (scene_.output.report && has_begun)
            for (const std::string& warning : write_run_page(output_->directory, scene_, model(), built_.cut))
                output_->log->warning(warning);
        output_->writer.reset();
        output_->lock.reset();
    }

    void equilibrium(const StepRecord& record) override {
        if (output_) output_->writer->equilibrium(record);
    }
    void crack(const CrackRecord& crack) override {
        if (output_) output_->writer->crack(crack);
    }
    void jump(const JumpRecord& jump) override {
        if (output_) output_->writer->jump(jump);
    }
    void step(const StepRecord& record, const State& state, const std::function<FieldRecord()>& fields,
              bool last_of_stage) override {
        if (output_) output_->writer->step(record, state, fields, last_of_stage);
        contacts_.step(record, state);
        row_ = table_row(record);
        wait_for_turn();
    }
    void progress(const Progress& progress) override {
        const std::lock_guard lock(turn_);
        progress_ = progress;
    }

    [[nodiscard]] std::string progress_text() {
        const std::lock_guard lock(turn_);
        return progress_ ? kluft::progress_text(*progress_, std::nullopt) : std::string{};
    }

    const Scene scene_;
    const SceneModel built_;
    State state_;
    RunWriterOptions writer_options_;
    int threads_ = 0;
    std::optional<Output> output_;
    bool resumes_ = false;

    std::thread worker_;
    std::mutex turn_;
    std::condition_variable turn_changed_;
    bool computes_ = false;          ///< it is the turn of the run; guarded by turn_
    std::atomic<bool> ended_{false}; ///< the run has nothing more to do
    std::atomic<bool> stop_{false};
    std::atomic<bool> closed_{false};
    std::mutex joining_;   ///< of the thread
    pid_t started_in_ = 0; ///< the process in which the thread was started; 0: none was
    std::exception_ptr failure_;
    std::optional<Progress> progress_; ///< guarded by turn_

    std::string row_;
    ContactWatch contacts_{model(), scene_.cracks.criterion};
    RunReport report_;
    std::string closing_;
    std::shared_ptr<const BodyState> snapshot_;
};

std::unique_ptr<Simulation> make_simulation(const SceneText& scene, const std::string& directory, bool resume,
                                            bool force, int threads) {
    const py::gil_scoped_release others;
    return std::make_unique<Simulation>(scene, directory, resume, force, threads);
}

} // namespace

void bind_simulation(py::module_& module) {
    (void)threads_of_process();
    py::class_<Simulation>(module, "Simulation")
        .def(py::init(&make_simulation), py::arg("scene"), py::arg("directory"), py::arg("resume"), py::arg("force"),
             py::arg("threads"))
        .def("advance", &Simulation::advance, py::arg("show"))
        .def("close", &Simulation::close)
        .def("save", &Simulation::save)
        .def("fields", &Simulation::fields)
        .def_property_readonly("header", &Simulation::header)
        .def_property_readonly("status", &Simulation::status)
        .def_property_readonly("diagnosis", &Simulation::diagnosis)
        .def_property_readonly("closing", &Simulation::closing)
        .def_property_readonly("warnings", &Simulation::warnings)
        .def_property_readonly("step", [](Simulation& run) { return run.place().step; })
        .def_property_readonly("stage", [](Simulation& run) { return run.place().stage; })
        .def_property_readonly("load_factor", [](Simulation& run) { return run.place().load_factor; })
        .def_property_readonly("n_blocks", &Simulation::n_blocks)
        .def_property_readonly("unknowns", &Simulation::unknowns)
        .def_property_readonly("interface_status", &Simulation::interface_status);
}

} // namespace kluft
