#include "kluft/output/run_writer.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <exception>
#include <list>
#include <new>
#include <sstream>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "kluft/core/diagnostics.hpp"
#include "kluft/core/memory.hpp"
#include "kluft/output/append_table.hpp"
#include "kluft/output/atomic_file.hpp"
#include "kluft/output/blocks_picture.hpp"
#include "kluft/output/curve_picture.hpp"
#include "kluft/output/field_series.hpp"
#include "kluft/output/histories_picture.hpp"
#include "kluft/output/history_table.hpp"
#include "kluft/output/state_file.hpp"

namespace kluft {

namespace fs = std::filesystem;

using Rows = std::vector<StepRecord>;

namespace {

/// A table to which the rows of a load step come together, once the step is committed. They wait while the disk is full, so
/// that none is missing once there is room again.
class StepTable {
public:
    explicit StepTable(AppendTable table) : table_(std::move(table)) {}
    /// A row of the load step in progress.
    void add(std::string row) { next_.push_back(std::move(row)); }
    void commit() noexcept { waiting_.splice(waiting_.end(), next_); }
    /// The rows of all committed steps.
    void write() {
        while (!waiting_.empty()) {
            table_.append(waiting_.front());
            waiting_.pop_front();
        }
    }
    void sync() {
        write();
        table_.sync();
    }
    [[nodiscard]] TableMark mark() const { return table_.mark(); }

private:
    AppendTable table_;
    std::list<std::string> next_, waiting_;
};

} // namespace

struct RunWriter::Tables {
    StepTable history;
    StepTable equilibria;
    StepTable cracks;
    StepTable jumps;
    std::optional<StepTable> histories;
    std::optional<FieldSeries> fields;
};

namespace {

constexpr std::array table_names{"history.csv", "equilibria.csv", "cracks.csv", "jumps.csv", "histories.csv"};

/// Calls visit(name, table) for each table of a run. `tables`: RunWriter::Tables, const or not.
template <class Tables, class Visit> void visit_tables(Tables& tables, Visit&& visit) {
    const auto& [history, equilibria, cracks, jumps, histories] = table_names;
    visit(history, tables.history);
    visit(equilibria, tables.equilibria);
    visit(cracks, tables.cracks);
    visit(jumps, tables.jumps);
    if (tables.histories) visit(histories, *tables.histories);
}

/// As they are saved with a state: a line "name bytes digest" for each table.
template <class Tables> std::string marks_in_words(const Tables& tables) {
    std::string text;
    visit_tables(tables, [&](const char* name, const StepTable& table) {
        const auto [bytes, digest] = table.mark();
        text += fmt::format("{} {} {}\n", name, bytes, digest);
    });
    return text;
}

/// What a table held when the state was saved.
TableMark saved_mark(const fs::path& state, const std::string& marks, const std::string& table) {
    std::istringstream lines(marks);
    TableMark mark;
    for (std::string name; lines >> name >> mark.bytes >> mark.digest;)
        if (name == table) return mark;
    throw InputError(
        fmt::format("{}: expected a state of a run with {}, found one of a run without it", state.string(), table));
}

constexpr std::array summary_and_pictures{"summary.json", "curve.png",     "curve.svg",     "blocks.png",
                                          "blocks.svg",   "histories.png", "histories.svg", "report.html"};

void remove_results_but_tables_and_state(const fs::path& directory) {
    for (const char* name : summary_and_pictures) remove_file(directory / name);
}

/// Runs each action and remembers the first error, so that one full disk does not cost the rest.
class FirstError {
public:
    template <class Action> void attempt(Action&& action) {
        try {
            action();
        } catch (...) {
            if (!error_) error_ = std::current_exception();
        }
    }
    void rethrow() const {
        if (error_) std::rethrow_exception(error_);
    }
    [[nodiscard]] bool any() const { return error_ != nullptr; }
    [[nodiscard]] std::string message() const {
        try {
            rethrow();
        } catch (const ResourceError& error) {
            return error.what();
        } catch (const std::bad_alloc&) {
            return "out of memory";
        }
        return {};
    }

private:
    std::exception_ptr error_;
};

double seconds_since(std::chrono::steady_clock::time_point then) {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - then).count();
}

SeriesNames series_names(const RunWriterOptions& options) {
    return {{options.material_names, options.interface_type_names, options.fracture_names},
            options.law_names,
            options.platen_stage.has_value()};
}

bool is_due(int step, int every) { return every > 0 && step % every == 0; }

} // namespace

std::vector<std::string> result_names() {
    std::vector<std::string> names(table_names.begin(), table_names.end());
    names.insert(names.end(), summary_and_pictures.begin(), summary_and_pictures.end());
    names.insert(names.end(), {"state.h5", "fields.pvd"});
    return names;
}

std::string first_result_in(const fs::path& directory) {
    std::vector<std::string> names = result_names();
    names.emplace_back("run.log");
    std::error_code error;
    for (const std::string& name : names)
        if (fs::exists(fs::symlink_status(directory / name, error))) return name;
    return first_kept_file(directory);
}

void remove_results(const fs::path& directory) {
    remove_results_but_tables_and_state(directory);
    FieldSeries::remove(directory);
    remove_file(directory / "state.h5");
    for (const char* name : table_names) remove_file(directory / name);
}

RunWriter::RunWriter(fs::path directory, const BlockSystem& system, RunWriterOptions options)
    : directory_(std::move(directory)), system_(system), options_(std::move(options)),
      kept_states_({options_.fields_every, options_.fields_at_cracks, options_.platen_stage}) {
    make_directory(directory_);
    std::string header = history_header();
    if (options_.strength_factor) header += ",strength_factor";
    if (options_.motion) header += ',' + motion_header();
    const bool has_histories = !options_.history_columns.empty();
    if (!options_.resumed_step) {
        remove_results(directory_);
        write_scene_file();
    }
    const fs::path state = directory_ / "state.h5";
    const std::string marks = options_.resumed_step ? read_state_tables(state) : "";
    const auto open = [&](const char* name, const std::string& columns) {
        return StepTable(options_.resumed_step
                             ? AppendTable::resume(directory_ / name, columns, saved_mark(state, marks, name))
                             : AppendTable::create(directory_ / name, columns));
    };
    const auto& [history, equilibria, cracks, jumps, histories] = table_names;
    tables_ = std::make_unique<Tables>(Tables{open(history, header),
                                              open(equilibria, header),
                                              open(cracks, cracks_header()),
                                              open(jumps, jumps_header()),
                                              {},
                                              {}});
    if (has_histories) tables_->histories.emplace(open(histories, histories_header(options_.history_columns)));
    Rows rows_before;
    if (options_.resumed_step) {
        if (!has_histories) remove_file(directory_ / histories);
        remove_results_but_tables_and_state(directory_);
        rows_before = read_history(directory_ / history);
        if (rows_before.empty() || rows_before.back().step != *options_.resumed_step)
            throw InputError(fmt::format("{}: does not reach the saved load step {}", (directory_ / history).string(),
                                         *options_.resumed_step));
        last_row_ = rows_before.back();
        for (const StepRecord& row : rows_before) kept_states_.add(row);
        write_scene_file();
    }
    if (options_.fields)
        tables_->fields = options_.resumed_step ? FieldSeries::resume(directory_, series_names(options_), rows_before)
                                                : FieldSeries::create(directory_, series_names(options_));
}

RunWriter::~RunWriter() = default;

bool RunWriter::is_known(const StepRecord& record) const {
    return options_.resumed_step && record.step <= *options_.resumed_step;
}

void RunWriter::write_scene_file() const {
    if (!options_.scene_file.empty()) write_file(directory_ / "scene.yaml", options_.scene_file);
}

void RunWriter::equilibrium(const StepRecord& record) {
    if (is_known(record)) return;
    tables_->equilibria.add(table_row(record));
}

void RunWriter::crack(const CrackRecord& crack) { tables_->cracks.add(table_row(crack)); }

void RunWriter::jump(const JumpRecord& jump) { tables_->jumps.add(table_row(jump)); }

void RunWriter::step(const StepRecord& record, const State& state, const std::function<FieldRecord()>& fields,
                     bool last_of_stage) {
    if (is_known(record)) return;
    tables_->history.add(table_row(record));
    if (tables_->histories) tables_->histories->add(histories_row(record));
    last_row_ = record;
    last_fields_ = nullptr;
    visit_tables(*tables_, [](const char*, StepTable& table) { table.commit(); }); // all rows of the step, or none
    visit_tables(*tables_, [](const char*, StepTable& table) { table.write(); });
    if (options_.fields || options_.pictures) last_fields_ = fields;
    if (options_.fields) keep_state(record, fields, last_of_stage);
    const bool long_ago = options_.checkpoint_seconds > 0.0 && seconds_since(saved_) > options_.checkpoint_seconds;
    if (last_of_stage || long_ago || is_due(record.step, options_.checkpoint_every)) checkpoint(state);
}

void RunWriter::checkpoint(const State& state) {
    FirstError errors;
    errors.attempt([&] { write_held_state(); });
    visit_tables(*tables_, [](const char*, StepTable& table) { table.sync(); });
    write_state(directory_ / "state.h5", state, options_.fingerprint, options_.scene_text, marks_in_words(*tables_));
    saved_ = Clock::now();
    errors.rethrow();
}

/// Writes the state of a load step if it is kept, and removes what is no longer. One that is kept for its stress waits in
/// memory until a state is saved: up to a peak each one is the largest.
void RunWriter::keep_state(const StepRecord& record, const std::function<FieldRecord()>& fields, bool last_of_stage) {
    std::vector<int> kept = tables_->fields->steps();
    std::erase_if(kept, [&](int step) { return !kept_states_.keeps(step); });
    kept_states_.add(record);
    if (last_of_stage) kept_states_.end_stage();
    if (held_ && !kept_states_.keeps(held_->record.step)) held_.reset();
    for (const int step : kept)
        if (!kept_states_.keeps(step)) tables_->fields->drop(step);
    if (!kept_states_.keeps(record.step)) return;
    if (kept_states_.for_its_stress() == record.step)
        held_ = {record, fields()};
    else
        write_fields(record, fields());
}

void RunWriter::write_held_state() {
    if (!held_) return;
    write_fields(held_->record, held_->fields);
    held_.reset();
}

void RunWriter::write_fields(const StepRecord& record, const FieldRecord& fields) {
    tables_->fields->add(system_, fields, record);
}

void RunWriter::write_pictures(const RunSummary& summary, const Rows& history, const Rows& equilibria,
                               const FieldRecord& fields) const {
    const std::string after = after_title(history, options_.platen_stage.has_value(), summary);
    const BlocksPlot blocks{options_.title, after, 1.0, options_.material_names, {}, summary.falling};
    const bool svg = system_.n_blocks() <= most_blocks_in_svg;
    FirstError errors;
    if (options_.platen_stage) { // otherwise nothing is loaded along an axis, and there is no such curve
        const CurvePlot curve = stress_strain_plot(options_.title, {{"", history, equilibria, options_.platen_stage}});
        errors.attempt([&] { write_curves(directory_ / "curve.png", curve); });
        errors.attempt([&] { write_curves(directory_ / "curve.svg", curve); });
    }
    if (tables_->histories) {
        const auto table = read_histories(directory_ / "histories.csv");
        const auto plots = histories_plots(options_.title, table, history, options_.platen_stage);
        errors.attempt([&] { write_curves(directory_ / "histories.png", plots); });
        errors.attempt([&] { write_curves(directory_ / "histories.svg", plots); });
    }
    errors.attempt([&] { write_blocks(directory_ / "blocks.png", system_, fields, blocks); });
    if (svg) errors.attempt([&] { write_blocks(directory_ / "blocks.svg", system_, fields, blocks); });
    errors.rethrow();
}

RunSummary RunWriter::summary_of(const RunOutcome& outcome, const Rows& history, const Rows& equilibria) const {
    RunSummary summary;
    summary.status = outcome.report.status;
    summary.title = options_.title;
    summary.numbers =
        curve_numbers(equilibria, history, options_.platen_stage, options_.plane, options_.compliance_across);
    clear_round_off(options_.modulus, summary.numbers);
    if (!outcome.report.remark.empty()) summary.numbers.residual_stress.reset(); // it ends while the stress falls
    summary.platen_stage = options_.platen_stage;
    summary.blocks = system_.n_blocks();
    summary.interfaces = system_.n_interfaces();
    summary.unknowns = outcome.unknowns;
    summary.costs = outcome.report.costs;
    summary.cpu_s = outcome.cpu_s;
    summary.peak_memory_bytes = peak_memory_bytes();
    summary.version = outcome.version;
    summary.blas_core = outcome.blas_core;
    summary.message = outcome.report.diagnosis.empty() ? outcome.report.remark : outcome.report.diagnosis;
    summary.results = outcome.report.results;
    summary.reduced_alone = outcome.report.reduced_alone;
    summary.warnings = outcome.report.warnings;
    const std::string& doubt = options_.elastic_constants_warning;
    const bool is_said =
        std::ranges::find(summary.warnings, doubt) != summary.warnings.end(); // by an earlier part of the run
    if (summary.numbers.youngs_modulus && !doubt.empty() && !is_said) summary.warnings.push_back(doubt);
    if (!options_.has_elastic_constants) clear_elastic_constants(summary.numbers);
    summary.falling = outcome.report.falling;
    summary.motion = outcome.report.motion;
    return summary;
}

void RunWriter::give_up(RunSummary summary, const std::string& why) const {
    summary.status = RunStatus::out_of_resources;
    if (summary.message != why) summary.message = summary.message.empty() ? why : why + "; " + summary.message;
    const fs::path path = directory_ / "summary.json";
    try {
        write_summary(path, summary);
    } catch (...) {
        std::error_code ignored;
        fs::remove(path, ignored); // rather none than one that says something else; and there may be room now
        FirstError().attempt([&] { write_summary(path, summary); });
    }
}

RunSummary RunWriter::finish(const RunOutcome& outcome, const State& state,
                             const std::function<FieldRecord()>& fields) {
    FirstError errors;
    // Out of memory in the middle of a report the rows end before the state; then the last saved state stays.
    if (last_row_ && last_row_->step == state.at.step) errors.attempt([&] { checkpoint(state); });
    Rows history;
    Rows equilibria;
    errors.attempt([&] {
        history = read_history(directory_ / "history.csv");
        equilibria = read_history(directory_ / "equilibria.csv");
    });
    RunSummary summary = summary_of(outcome, history, equilibria);
    errors.attempt([&] { write_summary(directory_ / "summary.json", summary); });
    errors.attempt([&] { write_held_state(); });
    errors.attempt([&] {
        if (memory_ran_out()) return; // what libraries draw and write there can be made of the state later
        const bool is_told = last_fields_ && last_row_ && last_row_->step == state.at.step;
        const bool fields_missing = options_.fields && is_told && !tables_->fields->has(last_row_->step);
        if (!fields_missing && !options_.pictures) return;
        const FieldRecord record = is_told ? last_fields_() : fields();
        FirstError parts;
        if (fields_missing) parts.attempt([&] { write_fields(*last_row_, record); });
        if (options_.pictures) parts.attempt([&] { write_pictures(summary, history, equilibria, record); });
        parts.rethrow();
    });
    // The summary was written before the pictures, which may need more memory than there is; now it counts theirs too.
    summary.peak_memory_bytes = peak_memory_bytes();
    errors.attempt([&] { write_summary(directory_ / "summary.json", summary); });
    if (errors.any()) give_up(summary, errors.message());
    errors.rethrow();
    return summary;
}

} // namespace kluft
