#include "kluft/studies/study_run.hpp"

#include <algorithm>
#include <chrono>
#include <deque>
#include <set>
#include <system_error>

#include <fmt/format.h>

#include "child_processes.hpp"
#include "kluft/core/diagnostics.hpp"
#include "kluft/core/shell_line.hpp"
#include "kluft/output/atomic_file.hpp"
#include "kluft/output/directory_lock.hpp"
#include "kluft/output/progress_line.hpp"
#include "kluft/studies/study_results.hpp"

namespace kluft {

namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

constexpr double seconds_between_tables = 3.0;
constexpr int bad_input = 2; ///< exit code

double sum_of(const std::optional<double>& earlier, double now) { return earlier.value_or(0.0) + now; }

/// One call of run_study.
class StudyRun {
public:
    StudyRun(const ReadStudy& read, const fs::path& directory, const StudyRunOptions& options,
             const std::atomic<bool>& stop)
        : read_(read), directory_(directory), options_(options), stop_(stop), results_(read_cases(read, directory)) {
        for (std::size_t i = 0; i < results_.size(); ++i)
            if (!results_[i].ended()) waiting_.push_back(i);
    }

    StudyTable run() {
        write_table();
        while (children_.n_running() > 0 || !waiting_.empty()) {
            if (stop_) stop_all();
            start_waiting();
            for (const EndedProcess& ended : children_.wait()) finish(ended);
            if (changed_ && seconds_since(written_) > seconds_between_tables) write_table();
            if (options_.show) options_.show(progress());
        }
        write_table();
        return study_table(read_, results_, directory_);
    }

private:
    [[nodiscard]] fs::path place(std::size_t i) const { return case_directory(directory_, read_.cases[i]); }

    void stop_all() {
        waiting_.clear();
        children_.interrupt();
    }

    void start_waiting() {
        for (std::size_t n = waiting_.size(); n > 0 && children_.n_running() < static_cast<std::size_t>(options_.jobs);
             --n) {
            const std::size_t i = waiting_.front();
            waiting_.pop_front();
            if (is_locked(place(i))) // by a run that a killed study has left and that saves its state
                waiting_.push_back(i);
            else
                start(i);
        }
    }

    void start(std::size_t i) {
        const PlannedCase& one = read_.cases[i];
        std::error_code error;
        const bool resume = one.resumable && !afresh_.contains(i) && fs::is_regular_file(place(i) / "state.h5", error);
        auto words = case_command(read_, one, options_.program, directory_);
        if (resume) {
            words.emplace_back("--resume");
            resumed_.insert(i);
        } else {
            words.emplace_back("--force"); // a case's directory is the study's, which knows what has to be run again
            remove_file(place(i) / "outcome.json");
        }
        children_.start(i, words, place(i) / "messages.txt", read_.study.time_limit);
        results_[i].status = CaseStatus::running;
    }

    /// Whether the scene, which the process of a case has read by itself, is no longer what the case was planned with.
    [[nodiscard]] bool has_changed(const PlannedCase& one) const {
        try {
            return scene_digest(read_.study.scene, assignments(one.set)) != one.digest;
        } catch (const InputError&) {
            return true;
        }
    }

    void finish(const EndedProcess& ended) {
        const std::size_t i = ended.tag;
        // A saved state that cannot be gone on from: once more from the start.
        if (resumed_.erase(i) > 0 && ended.exit_code == bad_input && !stop_) {
            afresh_.insert(i);
            waiting_.push_front(i);
            return;
        }
        if (has_changed(read_.cases[i])) {
            results_[i] = {};
            results_[i].status = CaseStatus::failed;
            results_[i].reason =
                "the scene has changed since the study began; kluft study --force runs what it says now";
            changed_ = true;
            return;
        }
        const auto earlier = read_outcome(place(i)).value_or(CaseOutcome{});
        write_outcome(place(i), {ended.exit_code, ended.signal, ended.out_of_time, sum_of(earlier.cpu_s, ended.cpu_s),
                                 sum_of(earlier.elapsed_s, ended.elapsed_s)});
        results_[i] = read_case(read_.study, read_.cases[i], place(i));
        if (results_[i].ended()) {
            seconds_spent_ += ended.elapsed_s;
            steps_done_ += read_.cases[i].steps;
        }
        changed_ = true;
    }

    void write_table() {
        write_study_table(study_table(read_, results_, directory_));
        written_ = Clock::now();
        changed_ = false;
    }

    [[nodiscard]] StudyProgress progress() const {
        StudyProgress progress;
        progress.n_cases = results_.size();
        progress.n_running = children_.n_running();
        double steps_left = 0.0;
        for (std::size_t i = 0; i < results_.size(); ++i) {
            progress.n_ended += results_[i].ended() ? 1 : 0;
            progress.n_failed += results_[i].status == CaseStatus::failed ? 1 : 0;
        }
        for (const std::size_t i : children_.tags()) steps_left += read_.cases[i].steps;
        for (const std::size_t i : waiting_) steps_left += read_.cases[i].steps;
        if (steps_done_ > 0.0) {
            const double work = seconds_spent_ / steps_done_ * steps_left - children_.seconds_so_far();
            const auto lanes = std::min<double>(options_.jobs, static_cast<double>(waiting_.size()) +
                                                                   static_cast<double>(children_.n_running()));
            progress.seconds_left = std::max(work, 0.0) / std::max(lanes, 1.0);
        }
        return progress;
    }

    const ReadStudy& read_;
    const fs::path& directory_;
    const StudyRunOptions& options_;
    const std::atomic<bool>& stop_;
    std::vector<CaseResult> results_;
    std::deque<std::size_t> waiting_;
    std::set<std::size_t> resumed_; ///< running from a saved state
    std::set<std::size_t> afresh_;  ///< whose saved state is of no use
    ChildProcesses children_;
    double seconds_spent_ = 0.0; ///< on cases that ended
    double steps_done_ = 0.0;
    Clock::time_point written_{};
    bool changed_ = false;
};

} // namespace

std::string study_progress_text(const StudyProgress& progress) {
    std::string text =
        fmt::format("{} of {} cases ended, {} running", progress.n_ended, progress.n_cases, progress.n_running);
    if (progress.n_failed > 0) text += fmt::format(", {} failed", progress.n_failed);
    if (progress.seconds_left && progress.n_running > 0) text += ", left " + readable_time(*progress.seconds_left);
    return text;
}

std::vector<std::string> case_command(const ReadStudy& read, const PlannedCase& one, const fs::path& program,
                                      const fs::path& directory) {
    std::vector<std::string> words{program, "run", read.study.scene, "-o", case_directory(directory, one)};
    for (const auto& setting : run_settings(read, one)) words.insert(words.end(), {"--set", setting});
    words.insert(words.end(), {"--threads", "1", "--quiet"});
    return words;
}

void require_one_line(const std::string& what, const std::string& text) {
    if (text.find_first_of("\r\n") != std::string::npos)
        throw InputError(
            fmt::format("{}: expected one line, as cases.txt and the scripts of schedulers have one for each "
                        "case, found a line break in {}",
                        what, shell_line({text})));
}

void prepare_study(const ReadStudy& read, const fs::path& program, const fs::path& directory) {
    require_one_line("name of the study", read.study.name);
    for (const auto& one : read.cases)
        for (const auto& word : case_command(read, one, program, directory))
            require_one_line("command of case " + one.name, word);
    std::string lines;
    for (const auto& one : read.cases) {
        if (!one.refusal.empty()) continue;
        prepare_case(case_directory(directory, one), one, noted_scene(read.study.scene, directory));
        lines += shell_line(case_command(read, one, program, directory)) + '\n';
    }
    write_file(directory / "cases.txt", lines);
}

StudyTable run_study(const ReadStudy& read, const fs::path& directory, const StudyRunOptions& options,
                     const std::atomic<bool>& stop) {
    return StudyRun(read, directory, options, stop).run();
}

StudyTable collect_study(const ReadStudy& read, const fs::path& directory) {
    return study_table(read, read_cases(read, directory), directory);
}

void write_study_table(const StudyTable& table) { write_file(table.directory / "study.csv", study_csv(table)); }

} // namespace kluft
