#include "kluft/studies/strength_tests.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string_view>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "kluft/core/diagnostics.hpp"
#include "kluft/core/nearest_name.hpp"
#include "kluft/output/atomic_file.hpp"
#include "kluft/output/envelope.hpp"
#include "kluft/output/history_table.hpp"
#include "kluft/output/summary.hpp"
#include "kluft/scene/quantity.hpp"
#include "kluft/studies/finished_run.hpp"

namespace kluft {

namespace {

namespace fs = std::filesystem;

/// `net_locked` of summary.json.
bool net_locked_in(const fs::path& summary) {
    const auto json = nlohmann::json::parse(read_file(summary));
    const auto key = json.find("net_locked");
    if (key == json.end() || key->is_null()) return false;
    if (!key->is_boolean())
        throw InputError(
            fmt::format("{}: net_locked: expected true or false, found {}", summary.string(), key->dump()));
    return key->get<bool>();
}

/// Text of a cell and the column in its line where it begins, from 1.
struct Cell {
    std::string text;
    std::size_t column = 1;
};

std::string trimmed(const std::string& text) {
    constexpr const char* blanks = " \t\r";
    const std::size_t first = text.find_first_not_of(blanks);
    return first == std::string::npos ? "" : text.substr(first, text.find_last_not_of(blanks) - first + 1);
}

/// The beginning of a text for a message; control characters are question marks.
std::string shown(std::string_view text) {
    constexpr std::size_t longest = 60;
    std::string beginning(text.substr(0, longest));
    std::ranges::replace_if(
        beginning, [](char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7f; }, '?');
    return beginning;
}

/// Cells between commas; quotes around a cell keep its commas, two quotes in it are one.
std::vector<Cell> cells_of_line(std::string_view line) {
    std::vector<Cell> cells(1);
    bool quoted = false;
    for (std::size_t i = 0; i < line.size(); ++i) {
        const char c = line[i];
        const bool doubled = quoted && c == '"' && i + 1 < line.size() && line[i + 1] == '"';
        if (doubled) {
            cells.back().text += '"';
            ++i;
        } else if (c == '"') {
            quoted = !quoted;
        } else if (c == ',' && !quoted) {
            cells.push_back({"", i + 2});
        } else {
            cells.back().text += c;
        }
    }
    for (Cell& cell : cells) cell.text = trimmed(cell.text);
    return cells;
}

const std::vector<std::string> column_names{"sigma_3",  "sigma_1",    "run",      "peak_reached",
                                            "balanced", "net_locked", "unloaded", "moves_platen"};
enum Column : std::size_t {
    sigma_3_column,
    sigma_1_column,
    run_column,
    peak_reached_column,
    balanced_column,
    net_locked_column,
    unloaded_column,
    moves_platen_column,
    n_known
};

/// Where the known columns are, and what a number in them is multiplied by.
struct TableLayout {
    std::size_t n_columns = 0;
    std::array<std::optional<std::size_t>, n_known> index;
    std::array<double, n_known> factor{1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0};
};

/// The messages of a file so far, each with its place.
class TableFlaws {
public:
    explicit TableFlaws(const fs::path& path) : path_(path.string()) {}

    void add(std::size_t line, std::size_t column, const std::string& message) {
        messages_.push_back(fmt::format("{}:{}:{}: {}", path_, line, column, message));
    }
    void raise() const {
        if (!messages_.empty()) throw InputError(messages_);
    }

private:
    std::string path_;
    std::vector<std::string> messages_;
};

/// "sigma_1 (MPa)" as name and unit.
std::pair<std::string, std::string> name_and_unit(const std::string& text) {
    const std::size_t open = text.find_first_of("([");
    if (open == std::string::npos) return {text, ""};
    const std::size_t close = text.find_first_of(")]", open);
    return {trimmed(text.substr(0, open)), trimmed(text.substr(open + 1, close - open - 1))};
}

void read_unit(const Cell& cell, const std::string& unit, std::size_t column, TableLayout& layout, TableFlaws& flaws) {
    if (unit.empty()) return;
    if (column != sigma_3_column && column != sigma_1_column) {
        flaws.add(1, cell.column, fmt::format("{}: expected no unit, found '{}'", column_names[column], unit));
        return;
    }
    const QuantityReading one = read_quantity("1 " + unit, Measure::stress);
    if (one.value)
        layout.factor[column] = *one.value;
    else
        flaws.add(1, cell.column,
                  fmt::format("{}: expected a unit of stress as in '{} (MPa)', found '{}'{}", column_names[column],
                              column_names[column], unit, one.problem));
}

std::vector<std::string> missing_columns(const TableLayout& layout) {
    std::vector<std::string> missing;
    for (std::size_t i = 0; i < n_known; ++i)
        if (!layout.index[i]) missing.push_back(column_names[i]);
    return missing;
}

TableLayout layout_of(std::string_view line, TableFlaws& flaws) {
    const auto cells = cells_of_line(line);
    TableLayout layout{.n_columns = cells.size()};
    std::vector<std::pair<std::string, std::size_t>> others;
    for (std::size_t i = 0; i < cells.size(); ++i) {
        const auto [name, unit] = name_and_unit(cells[i].text);
        const auto known = std::ranges::find(column_names, name);
        if (known == column_names.end()) {
            others.emplace_back(name, cells[i].column);
            continue;
        }
        const auto column = static_cast<std::size_t>(known - column_names.begin());
        if (layout.index[column]) flaws.add(1, cells[i].column, fmt::format("a second column '{}'", name));
        layout.index[column] = i;
        read_unit(cells[i], unit, column, layout, flaws);
    }
    const auto missing = missing_columns(layout);
    for (const auto& [name, column] : others)
        if (const std::string meant = suggestion(name, missing); !meant.empty())
            flaws.add(1, column, fmt::format("unknown column '{}'{}", name, meant));
    for (const std::size_t needed : {sigma_3_column, sigma_1_column})
        if (!layout.index[needed])
            flaws.add(1, 1, fmt::format("expected a column '{}', found '{}'", column_names[needed], shown(line)));
    return layout;
}

std::optional<double> read_stress(const Cell& cell, std::size_t line, Column column, const TableLayout& layout,
                                  TableFlaws& flaws) {
    constexpr double largest = 1e15; // Pa
    const std::string& name = column_names[column];
    const auto number = read_number(cell.text);
    if (!number) {
        flaws.add(line, cell.column,
                  fmt::format("{}: expected a number, found '{}'{}", name, shown(cell.text), number_flaw(cell.text)));
        return std::nullopt;
    }
    const double stress = *number * layout.factor[column];
    if (std::abs(stress) <= largest) return stress;
    flaws.add(line, cell.column,
              fmt::format("{}: expected a stress within {:.0e} Pa, found '{}'", name, largest, shown(cell.text)));
    return std::nullopt;
}

/// 0 or 1; `otherwise` without such a column or with an empty cell.
bool read_flag(const std::vector<Cell>& cells, std::size_t line, Column column, const TableLayout& layout,
               bool otherwise, TableFlaws& flaws) {
    if (!layout.index[column]) return otherwise;
    const Cell& cell = cells[*layout.index[column]];
    if (cell.text.empty()) return otherwise;
    if (cell.text == "1" || cell.text == "true") return true;
    if (cell.text != "0" && cell.text != "false")
        flaws.add(line, cell.column,
                  fmt::format("{}: expected 0 or 1, found '{}'", column_names[column], shown(cell.text)));
    return false;
}

void check_order(const PeakPoint& point, const Cell& cell, std::size_t line, TableFlaws& flaws) {
    if (point.sigma_1 >= point.sigma_3) return;
    flaws.add(line, cell.column,
              fmt::format("sigma_1: expected at least sigma_3 = {:.6g} Pa, found {:.6g} Pa (compression is positive; a "
                          "tension test has sigma_1 = 0 and sigma_3 = -sigma_t)",
                          point.sigma_3, point.sigma_1));
}

PeakPoint read_row(const std::vector<Cell>& cells, std::size_t line, const TableLayout& layout, TableFlaws& flaws) {
    PeakPoint point;
    if (layout.index[run_column]) point.run = cells[*layout.index[run_column]].text;
    const Cell& sigma_1_cell = cells[*layout.index[sigma_1_column]];
    const auto sigma_3 = read_stress(cells[*layout.index[sigma_3_column]], line, sigma_3_column, layout, flaws);
    const auto sigma_1 = read_stress(sigma_1_cell, line, sigma_1_column, layout, flaws);
    point.sigma_3 = sigma_3.value_or(0.0);
    point.sigma_1 = sigma_1.value_or(point.sigma_3);
    if (sigma_3 && sigma_1) check_order(point, sigma_1_cell, line, flaws);
    point.peak_reached = read_flag(cells, line, peak_reached_column, layout, true, flaws);
    point.balanced = read_flag(cells, line, balanced_column, layout, true, flaws);
    point.net_locked = read_flag(cells, line, net_locked_column, layout, false, flaws);
    point.unloaded = read_flag(cells, line, unloaded_column, layout, false, flaws);
    point.moves_platen = read_flag(cells, line, moves_platen_column, layout, true, flaws);
    return point;
}

/// Lines without their ends; a mark of the encoding before the first is dropped.
std::vector<std::string_view> lines_of_text(std::string_view text) {
    if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);
    std::vector<std::string_view> lines;
    while (!text.empty()) {
        const std::size_t end = std::min(text.find('\n'), text.size());
        std::string_view line = text.substr(0, end);
        if (line.ends_with('\r')) line.remove_suffix(1);
        lines.push_back(line);
        text.remove_prefix(std::min(end + 1, text.size()));
    }
    return lines;
}

bool is_blank(std::string_view line) { return line.find_first_not_of(" \t,") == std::string_view::npos; }

} // namespace

PeakPoint read_peak(const fs::path& directory, const std::string& run) {
    require_results(directory);
    const std::vector<StepRecord> history = read_history(directory / "history.csv");
    const fs::path fine = directory / "equilibria.csv";
    const std::vector<StepRecord> equilibria = fs::exists(fine) ? read_history(fine) : std::vector<StepRecord>{};
    const std::vector<StepRecord>& rows = equilibria.empty() ? history : equilibria;
    const fs::path summary_file = directory / "summary.json";
    if (!fs::exists(summary_file)) {
        const FinishedRun known = read_finished_run(directory, run);
        PeakPoint point = peak_point(run, rows, known.platen_stage);
        point.moves_platen = known.platen_stage || !known.model;
        return point;
    }
    const RunSummary summary = read_summary(summary_file);
    if (const std::string missing = missing_rows(history, equilibria, summary); !missing.empty())
        throw InputError(fmt::format("{}: expected all rows of the run, found that {}", directory.string(), missing));
    PeakPoint point = peak_point(run, rows, summary.platen_stage);
    point.balanced = summary.status != RunStatus::unbalanced;
    point.moves_platen = summary.platen_stage.has_value();
    point.net_locked = net_locked_in(summary_file);
    point.peak_reached =
        point.peak_reached || summary.status == RunStatus::collapsed; // a platen that is loaded by stress
    return point;
}

std::vector<PeakPoint> read_strength_table(const fs::path& path) {
    const std::string content = read_file(path);
    const auto lines = lines_of_text(content);
    TableFlaws flaws(path);
    const TableLayout layout = layout_of(lines.empty() ? "" : lines.front(), flaws);
    flaws.raise();
    std::vector<PeakPoint> points;
    for (std::size_t i = 1; i < lines.size(); ++i) {
        if (is_blank(lines[i])) continue;
        const auto cells = cells_of_line(lines[i]);
        if (cells.size() != layout.n_columns) {
            flaws.add(i + 1, 1, fmt::format("expected {} columns, found {}", layout.n_columns, cells.size()));
            continue;
        }
        points.push_back(read_row(cells, i + 1, layout, flaws));
        if (points.back().run.empty()) points.back().run = fmt::format("{} {}", path.stem().string(), points.size());
    }
    flaws.raise();
    if (points.empty()) throw InputError(path.string() + ": expected a row for each test, found none");
    return points;
}

} // namespace kluft
