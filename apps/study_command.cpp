// kluft study STUDY.yaml | step-size SCENE | trade SCENE
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include "commands.hpp"
#include "failure.hpp"
#include "kluft/core/diagnostics.hpp"
#include "kluft/core/nearest_name.hpp"
#include "kluft/output/atomic_file.hpp"
#include "kluft/output/directory_lock.hpp"
#include "kluft/studies/earlier_results.hpp"
#include "kluft/studies/ready_made_studies.hpp"
#include "kluft/studies/study.hpp"
#include "kluft/studies/study_emit.hpp"
#include "kluft/studies/study_report.hpp"
#include "kluft/studies/study_results.hpp"
#include "kluft/studies/study_run.hpp"
#include "standard_output.hpp"
#include "stop_request.hpp"
#include "this_program.hpp"

namespace kluft {

namespace {

namespace fs = std::filesystem;

/// Where the study stands: a line that is rewritten on a terminal, elsewhere one now and then.
class StudyProgressLine {
public:
    void show(const StudyProgress& progress) {
        const std::string text = study_progress_text(progress);
        const auto now = Clock::now();
        const std::chrono::duration<double> pause(terminal_ ? 0.2 : 10.0);
        if (text == shown_ || now - last_ < pause) return;
        tell("{}{}{}", terminal_ ? "\r" : "", cut(text), terminal_ ? "\033[K" : "\n");
        std::fflush(stderr);
        shown_ = text;
        last_ = now;
    }
    void clear() {
        if (terminal_ && !shown_.empty()) tell("\r\033[K");
        std::fflush(stderr);
    }

private:
    using Clock = std::chrono::steady_clock;

    [[nodiscard]] std::string cut(const std::string& text) const {
        winsize size{};
        if (!terminal_ || ioctl(STDERR_FILENO, TIOCGWINSZ, &size) != 0 || size.ws_col == 0) return text;
        return text.substr(0, size.ws_col - 1);
    }

    bool terminal_ = isatty(STDERR_FILENO) == 1;
    std::string shown_;
    Clock::time_point last_{};
};

/// The study file that the words name, and the directory of the results.
struct StudyPlace {
    fs::path file;
    fs::path directory;
    std::string ready_made; ///< text of the file; empty for a study file of the user's
};

StudyPlace ready_made(const StudyArguments& arguments) {
    const std::string& kind = arguments.words[0];
    if (arguments.words.size() < 2) throw InputError("kluft study " + kind + ": expected a scene after it, found none");
    const fs::path scene = arguments.words[1];
    const fs::path directory = arguments.directory.empty() ? fs::path("results") / (scene.stem().string() + "-" + kind)
                                                           : fs::path(arguments.directory);
    return {directory / "study.yaml", directory, ready_made_study(kind, scene, arguments.overrides)};
}

/// Writes the text of a ready-made study into the directory, where it may replace its like only.
void write_ready_made(const StudyPlace& place) {
    std::error_code error;
    if (fs::exists(place.file, error) && !is_ready_made(place.file))
        throw InputError(place.file.string() + ": expected a ready-made study or no file, found another study, which "
                                               "would be lost; choose another directory with -o");
    make_directory(place.directory);
    write_file(place.file, place.ready_made);
}

StudyPlace place_of(const StudyArguments& arguments) {
    const auto kinds = ready_made_names();
    if (std::ranges::find(kinds, arguments.words[0]) != kinds.end()) return ready_made(arguments);
    if (arguments.words.size() > 1)
        throw InputError(fmt::format("kluft study: expected one study file, or one of {} and a scene, found {} {}{}",
                                     listed(kinds), arguments.words[0], arguments.words[1],
                                     suggestion(arguments.words[0], kinds)));
    const fs::path file = arguments.words[0];
    return {file, arguments.directory.empty() ? fs::path("results") / file.stem() : fs::path(arguments.directory), {}};
}

/// The table and the report.
void write_results(const StudyTable& table, const std::string& quantity) {
    write_study_table(table);
    StudyReportOptions options;
    options.quantity = quantity;
    write_study_report(table, table.directory, options);
}

/// Before anything is run.
void refuse_unknown_quantity(const Study& study, const std::string& quantity) {
    if (quantity.empty() || std::ranges::find(study.quantities, quantity) != study.quantities.end()) return;
    throw InputError("kluft study: --quantity: expected one of " + listed(study.quantities) + ", found '" + quantity +
                     "'" + suggestion(quantity, study.quantities));
}

std::size_t n_with(const StudyTable& table, CaseStatus status) {
    return std::ranges::count(table.cases, status, &StudyCase::status);
}

/// "12 cases: 10 done, 1 without equilibrium, 1 failed; table in results/study.csv", and what failed and why.
void print_closing(const StudyTable& table) {
    std::string text = fmt::format("{} cases: {} done", table.cases.size(), n_with(table, CaseStatus::done));
    const auto add = [&](CaseStatus status, const char* what) {
        if (const auto n = n_with(table, status); n > 0) text += fmt::format(", {} {}", n, what);
    };
    add(CaseStatus::no_equilibrium, "without equilibrium");
    add(CaseStatus::refused, "refused");
    add(CaseStatus::failed, "failed");
    add(CaseStatus::waiting, "not run to the end");
    say("{}; table in {}, report in {}\n", text, (table.directory / "study.csv").string(),
        (table.directory / "study.html").string());
    constexpr int most_reasons = 10;
    int n_reasons = 0;
    for (const auto& one : table.cases) {
        if (one.reason.empty() || one.status == CaseStatus::waiting || ++n_reasons > most_reasons) continue;
        tell("{}: {}: {}\n", one.name, case_status_name(one.status), one.reason);
    }
    if (n_reasons > most_reasons) tell("and {} more\n", n_reasons - most_reasons);
}

ExitCode exit_code(const StudyTable& table) {
    if (stop_requested) return exit_code_of_stop();
    if (std::ranges::any_of(table.cases, &StudyCase::out_of_resources)) return ExitCode::out_of_resources;
    const bool missing = n_with(table, CaseStatus::failed) + n_with(table, CaseStatus::waiting) > 0;
    return missing ? ExitCode::missed : ExitCode::done;
}

int default_jobs() { return static_cast<int>(std::max(std::thread::hardware_concurrency(), 1U)); }

/// The words that gather the results of an emitted study.
std::vector<std::string> collect_command(const StudyArguments& arguments, const StudyPlace& place) {
    std::vector<std::string> words{this_program("study"), "study"};
    for (const auto& word : arguments.words) {
        std::error_code error;
        words.push_back(fs::is_regular_file(word, error) ? fs::absolute(word).lexically_normal().string() : word);
    }
    words.insert(words.end(), {"-o", fs::absolute(place.directory).lexically_normal(), "--collect"});
    if (!arguments.quantity.empty()) words.insert(words.end(), {"--quantity", arguments.quantity});
    for (const auto& override_text : arguments.overrides) words.insert(words.end(), {"--set", override_text});
    return words;
}

} // namespace

ExitCode study(const StudyArguments& arguments) {
    require_possible_output(arguments.directory);
    const StudyPlace place = place_of(arguments);
    const fs::path directory = fs::absolute(place.directory).lexically_normal();
    require_no_file(directory);
    if (!is_locked(directory)) require_no_run_in(directory); // a run that holds it is named below
    const std::string holder = "kluft study " + arguments.words.back();
    const auto require_own = [&](const ReadStudy& read) {
        if (arguments.force) return;
        require_no_other_study(read, directory,
                               arguments.emit.empty() ? std::vector<std::string>{} : emitted_files(arguments.emit));
    };
    std::optional<DirectoryLock> lock;
    if (!place.ready_made.empty()) {
        if (!arguments.collect) lock.emplace(directory, holder);
        require_own(read_study_text(place.ready_made, arguments.overrides, place.file));
        write_ready_made(place);
    }
    const ReadStudy read = read_study(place.file, arguments.overrides);
    require_own(read);
    refuse_unknown_quantity(read.study, arguments.quantity);
    if (arguments.collect) {
        if (!fs::is_directory(directory))
            throw InputError("kluft study --collect: expected the directory of a study, found no " +
                             directory.string());
        const StudyTable table = collect_study(read, directory);
        make_directory(directory);
        write_results(table, arguments.quantity);
        print_closing(table);
        return exit_code(table);
    }
    if (!lock) lock.emplace(directory, holder);
    const int jobs = arguments.jobs > 0 ? arguments.jobs : default_jobs();
    if (arguments.force) remove_other_study(read, directory);
    prepare_study(read, this_program("study"), directory);
    if (!arguments.emit.empty()) {
        const auto next = emit_study(arguments.emit, read, directory, jobs, collect_command(arguments, place));
        say("{}", next);
        return ExitCode::done;
    }
    listen_for_stop();
    StudyProgressLine line;
    StudyRunOptions options{this_program("study"), jobs, {}};
    if (!arguments.quiet) options.show = [&](const StudyProgress& progress) { line.show(progress); };
    const StudyTable table = run_study(read, directory, options, stop_requested);
    line.clear();
    write_results(table, arguments.quantity);
    print_closing(table);
    return exit_code(table);
}

} // namespace kluft
