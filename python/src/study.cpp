// Studies: the cases of a study file, run by the program in processes of their own.
#include <atomic>
#include <chrono>
#include <exception>
#include <filesystem>
#include <future>
#include <mutex>
#include <optional>
#include <string>

#include "kluft/output/directory_lock.hpp"
#include "kluft/studies/study.hpp"
#include "kluft/studies/study_report.hpp"
#include "kluft/studies/study_run.hpp"
#include "module.hpp"

namespace py = pybind11;

namespace kluft {

namespace {

/// The last word of the cases, which another thread shows.
class LastWord {
public:
    void say(std::string text) {
        const std::lock_guard lock(mutex_);
        text_ = std::move(text);
    }
    [[nodiscard]] std::string text() {
        const std::lock_guard lock(mutex_);
        return text_;
    }

private:
    std::mutex mutex_;
    std::string text_;
};

void run_cases(const std::string& text, const std::filesystem::path& file, const std::filesystem::path& directory,
               const std::filesystem::path& program, int jobs, LastWord& progress, const std::atomic<bool>& stop) {
    const ReadStudy read = read_study_text(text, {}, file);
    const DirectoryLock lock(directory, "a sweep in Python");
    prepare_study(read, program, directory);
    const StudyRunOptions options{program, jobs,
                                  [&](const StudyProgress& now) { progress.say(study_progress_text(now)); }};
    const StudyTable table = run_study(read, directory, options, stop);
    write_study_table(table);
    write_study_report(table, directory);
}

/// Runs what has not ended yet; `show` gets the progress in words. Ctrl-C lets the running cases save their states.
void run_study_of(const std::string& text, const std::string& file, const std::string& directory,
                  const std::string& program, int jobs, const py::object& show) {
    constexpr std::chrono::milliseconds pause(100);
    LastWord progress;
    std::atomic<bool> stop{false};
    std::optional<py::error_already_set> interrupt;
    auto cases =
        std::async(std::launch::async, [&] { run_cases(text, file, directory, program, jobs, progress, stop); });
    for (bool ended = false; !ended;) {
        {
            const py::gil_scoped_release others;
            ended = cases.wait_for(pause) == std::future_status::ready;
        }
        try {
            if (PyErr_CheckSignals() != 0) throw py::error_already_set();
            if (!show.is_none() && !stop) show(progress.text());
        } catch (py::error_already_set& error) {
            stop = true;
            if (!interrupt) interrupt.emplace(error);
        }
    }
    cases.get();
    if (interrupt) throw py::error_already_set(*interrupt);
}

} // namespace

void bind_study(py::module_& module) {
    module.def("run_study", run_study_of, py::arg("text"), py::arg("file"), py::arg("directory"), py::arg("program"),
               py::arg("jobs"), py::arg("show"));
}

} // namespace kluft
