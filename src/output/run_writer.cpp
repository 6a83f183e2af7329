#include "kluft/output/run_writer.hpp"

#include <deque>
#include <exception>
#include <utility>

#include <fmt/format.h>

#include "kluft/core/diagnostics.hpp"
#include "kluft/output/append_table.hpp"
#include "kluft/output/atomic_file.hpp"
#include "kluft/output/blocks_picture.hpp"
#include "kluft/output/curve_picture.hpp"
#include "kluft/output/history_table.hpp"
#include "kluft/output/state_file.hpp"
#include "kluft/output/vtu.hpp"

namespace kluft {

namespace fs = std::filesystem;

namespace {

/// A table whose rows wait while the disk is full, so that none is missing once there is room again.
class PatientTable {
public:
    explicit PatientTable(AppendTable table) : table_(std::move(table)) {}
    void append(std::string row) {
        waiting_.push_back(std::move(row));
        write_waiting();
    }
    void sync() {
        write_waiting();
        table_.sync();
    }

private:
    void write_waiting() {
        while (!waiting_.empty()) {
            table_.append(waiting_.front());
            waiting_.pop_front();
        }
    }

    AppendTable table_;
    std::deque<std::string> waiting_;
};

} // namespace

struct RunWriter::Tables {
    PatientTable history;
    PatientTable equilibria;
    PatientTable cracks;
    PatientTable jumps;
    std::optional<PatientTable> histories;
    std::optional<FieldSeries> fields;
};

namespace {

void remove_results_but_tables_and_state(const fs::path& directory) {
    for (const char* name : {"summary.json", "curve.png", "curve.svg", "blocks.png", "blocks.svg"})
        remove_file(directory / name);
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

private:
    std::exception_ptr error_;
};

bool is_due(int step, int every) { return every > 0 && step % every == 0; }

} // namespace

void remove_results(const fs::path& directory) {
    remove_results_but_tables_and_state(directory);
    FieldSeries::remove(directory);
    for (const char* name : {"state.h5", "history.csv", "equilibria.csv", "cracks.csv", "jumps.csv", "histories.csv"})
        remove_file(directory / name);
}

RunWriter::RunWriter(fs::path directory, const BlockSystem& system, RunWriterOptions options)
    : directory_(std::move(directory)), system_(system), options_(std::move(options)) {
    make_directory(directory_);
    const fs::path history = directory_ / "history.csv";
    const fs::path equilibria = directory_ / "equilibria.csv";
    const fs::path cracks = directory_ / "cracks.csv";
    const fs::path jumps = directory_ / "jumps.csv";
    const fs::path histories = directory_ / "histories.csv";
    const std::string histories_columns = histories_header(options_.history_columns);
    std::string header = history_header();
    if (options_.strength_factor) header += ",strength_factor";
    if (options_.motion) header += ',' + motion_header();
    if (options_.resumed_step) {
        const int last = *options_.resumed_step;
        tables_ = std::make_unique<Tables>(Tables{PatientTable(AppendTable::resume(history, header, last)),
                                                  PatientTable(AppendTable::resume(equilibria, header, last)),
                                                  PatientTable(AppendTable::resume(cracks, cracks_header(), last)),
                                                  PatientTable(AppendTable::resume(jumps, jumps_header(), last)),
                                                  {},
                                                  {}});
        if (!options_.history_columns.empty())
            tables_->histories.emplace(AppendTable::resume(histories, histories_columns, last));
        else
            remove_file(histories);
        remove_results_but_tables_and_state(directory_);
        history_ = read_history(history);
        equilibria_ = read_history(equilibria);
        if (history_.empty() || history_.back().step != last)
            throw InputError(fmt::format("{}: does not reach the saved load step {}", history.string(), last));
        if (options_.fields) tables_->fields = FieldSeries::resume(directory_, last);
    } else {
        remove_results(directory_);
        tables_ = std::make_unique<Tables>(Tables{PatientTable(AppendTable::create(history, header)),
                                                  PatientTable(AppendTable::create(equilibria, header)),
                                                  PatientTable(AppendTable::create(cracks, cracks_header())),
                                                  PatientTable(AppendTable::create(jumps, jumps_header())),
                                                  {},
                                                  {}});
        if (!options_.history_columns.empty())
            tables_->histories.emplace(AppendTable::create(histories, histories_columns));
        if (options_.fields) tables_->fields = FieldSeries::create(directory_);
    }
}

RunWriter::~RunWriter() = default;

bool RunWriter::is_known(const StepRecord& record) const {
    return options_.resumed_step && record.step <= *options_.resumed_step;
}

void RunWriter::equilibrium(const StepRecord& record) {
    if (is_known(record)) return;
    equilibria_.push_back(record);
    tables_->equilibria.append(table_row(record));
}

void RunWriter::crack(const CrackRecord& crack) { tables_->cracks.append(table_row(crack)); }

void RunWriter::jump(const JumpRecord& jump) { tables_->jumps.append(table_row(jump)); }

void RunWriter::step(const StepRecord& record, const State& state, const std::function<FieldRecord()>& fields,
                     bool last_of_stage) {
    if (is_known(record)) return;
    history_.push_back(record);
    tables_->history.append(table_row(record));
    if (tables_->histories) tables_->histories->append(histories_row(record));
    if (options_.fields && (record.step == 0 || last_of_stage || is_due(record.step, options_.fields_every)))
        write_fields(record, fields());
    if (last_of_stage || is_due(record.step, options_.checkpoint_every)) checkpoint(state);
}

void RunWriter::checkpoint(const State& state) {
    tables_->history.sync();
    tables_->equilibria.sync();
    tables_->cracks.sync();
    tables_->jumps.sync();
    if (tables_->histories) tables_->histories->sync();
    write_state(directory_ / "state.h5", state, options_.fingerprint, options_.scene_text);
}

void RunWriter::write_fields(const StepRecord& record, const FieldRecord& fields) {
    tables_->fields->add(system_, fields, options_.material_names, record);
}

void RunWriter::write_pictures(const FieldRecord& fields) const {
    const CurvePlot curve = stress_strain_plot(options_.title, {{"", history_, equilibria_, options_.platen_stage}});
    const BlocksPlot blocks{options_.title, after_title(history_), 1.0, options_.material_names, {}};
    const bool svg = system_.n_blocks() <= most_blocks_in_svg;
    FirstError errors;
    errors.attempt([&] { write_curves(directory_ / "curve.png", curve); });
    errors.attempt([&] { write_curves(directory_ / "curve.svg", curve); });
    errors.attempt([&] { write_blocks(directory_ / "blocks.png", system_, fields, blocks); });
    if (svg) errors.attempt([&] { write_blocks(directory_ / "blocks.svg", system_, fields, blocks); });
    errors.rethrow();
}

RunSummary RunWriter::summary_of(const RunOutcome& outcome) const {
    RunSummary summary;
    summary.status = outcome.report.status;
    summary.title = options_.title;
    summary.numbers = curve_numbers(equilibria_, history_, options_.platen_stage, options_.plane);
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
    summary.falling = outcome.report.falling;
    summary.motion = outcome.report.motion;
    return summary;
}

RunSummary RunWriter::finish(const RunOutcome& outcome, const State& state,
                             const std::function<FieldRecord()>& fields) {
    RunSummary summary = summary_of(outcome);
    FirstError errors;
    // Out of memory in the middle of a report the rows may end before the state; then the last saved state stays.
    if (!history_.empty() && history_.back().step == state.at.step) errors.attempt([&] { checkpoint(state); });
    errors.attempt([&] { write_summary(directory_ / "summary.json", summary); });
    errors.attempt([&] {
        const bool fields_missing =
            options_.fields && !history_.empty() &&
            (tables_->fields->steps().empty() || tables_->fields->steps().back() != history_.back().step);
        if (!fields_missing && !options_.pictures) return;
        const FieldRecord last = fields();
        FirstError parts;
        if (fields_missing) parts.attempt([&] { write_fields(history_.back(), last); });
        if (options_.pictures) parts.attempt([&] { write_pictures(last); });
        parts.rethrow();
    });
    // The summary was written before the pictures, which may need more memory than there is; now it counts theirs too.
    summary.peak_memory_bytes = peak_memory_bytes();
    errors.attempt([&] { write_summary(directory_ / "summary.json", summary); });
    errors.rethrow();
    return summary;
}

} // namespace kluft
