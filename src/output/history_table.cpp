#include "kluft/output/history_table.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <string_view>
#include <type_traits>

#include <fmt/format.h>

#include "kluft/core/diagnostics.hpp"
#include "kluft/output/atomic_file.hpp"

namespace kluft {

namespace {

/// Calls visit(name, member) for each column in order. Record: StepRecord, const or not.
template <class Record, class Visit>
requires std::is_same_v<std::remove_const_t<Record>, StepRecord>
void visit_columns(Record& record, Visit&& visit) {
    visit("step", record.step);
    visit("stage", record.stage);
    visit("load_factor", record.load_factor);
    visit("axial_strain", record.axial_strain);
    visit("axial_stress", record.axial_stress);
    visit("lateral_strain", record.lateral_strain);
    visit("lateral_stress", record.lateral_stress);
    visit("differential_stress", record.differential_stress);
    visit("volumetric_strain", record.volumetric_strain);
    visit("cracks_tension", record.cracks_tension);
    visit("cracks_shear", record.cracks_shear);
    visit("open", record.open);
    visit("sliding", record.sliding);
    visit("locked", record.locked);
    visit("open_close_iterations", record.open_close_iterations);
    visit("crack_passes", record.crack_passes);
    visit("unbalanced_ratio", record.unbalanced_ratio);
    visit("balance_error", record.balance_error);
    visit("jumps", record.jumps);
    visit("net_broken", record.net_broken);
    visit("balanced", record.balanced);
    visit("elapsed_s", record.elapsed_s);
}

/// The columns that only some runs have; the same for members that are optional.
template <class Record, class Visit> void visit_optional_columns(Record& record, Visit&& visit) {
    if constexpr (std::is_same_v<std::remove_const_t<Record>, StepRecord>)
        visit("strength_factor", record.strength_factor);
}

template <class Record, class Visit>
requires std::is_same_v<std::remove_const_t<Record>, MotionRecord>
void visit_columns(Record& record, Visit&& visit) {
    visit("time_steps", record.time_steps);
    visit("kinetic_ratio", record.kinetic_ratio);
    visit("platen_imbalance", record.platen_imbalance);
    visit("external_work", record.external_work);
    visit("strain_energy", record.strain_energy);
    visit("kinetic_energy", record.kinetic_energy);
    visit("friction_energy", record.friction_energy);
    visit("damping_energy", record.damping_energy);
    visit("crack_energy", record.crack_energy);
    visit("detection_energy", record.detection_energy);
    visit("energy_error", record.energy_error);
}

template <class Record, class Visit>
requires std::is_same_v<std::remove_const_t<Record>, CrackRecord>
void visit_columns(Record& crack, Visit&& visit) {
    visit("step", crack.step);
    visit("pass", crack.pass);
    visit("interface", crack.interface);
    visit("x", crack.x);
    visit("y", crack.y);
    visit("mode", crack.mode);
    visit("p1", crack.p1);
    visit("p3", crack.p3);
    visit("axial_strain", crack.axial_strain);
}

template <class Record, class Visit>
requires std::is_same_v<std::remove_const_t<Record>, JumpRecord>
void visit_columns(Record& jump, Visit&& visit) {
    visit("step", jump.step);
    visit("load_factor", jump.load_factor);
    visit("released_energy", jump.released_energy);
    visit("largest_slip", jump.largest_slip);
    visit("blocks", jump.blocks);
}

std::string cell(int value) { return fmt::format("{}", value); }
std::string cell(double value) { return fmt::format("{:.17g}", value); }
std::string cell(bool value) { return value ? "1" : "0"; }
std::string cell(CrackMode mode) { return mode == CrackMode::tension ? "tension" : "shear"; }

template <class Record> std::string header_of() {
    std::string line;
    Record record;
    visit_columns(record, [&](std::string_view name, auto&) { line += fmt::format(",{}", name); });
    return line.substr(1);
}

template <class Record> std::string row_of(const Record& record) {
    std::string line;
    visit_columns(record, [&](std::string_view, const auto& value) { line += ',' + cell(value); });
    return line.substr(1);
}

template <class Number> bool parse_number(std::string_view text, Number& value) {
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    return error == std::errc() && end == text.data() + text.size();
}

/// Each returns what was expected when the text is something else, otherwise nothing.
std::string_view parse(std::string_view text, int& value) { return parse_number(text, value) ? "" : "an integer"; }
std::string_view parse(std::string_view text, double& value) {
    return parse_number(text, value) && std::isfinite(value) ? "" : "a finite number";
}
std::string_view parse(std::string_view text, bool& value) {
    value = text == "1";
    return text == "0" || text == "1" ? "" : "0 or 1";
}
std::string_view parse(std::string_view text, CrackMode& mode) {
    mode = text == "tension" ? CrackMode::tension : CrackMode::shear;
    return text == "tension" || text == "shear" ? "" : "tension or shear";
}

std::string_view parse(std::string_view text, std::optional<double>& value) { return parse(text, value.emplace()); }

std::vector<std::string_view> split(std::string_view line) {
    if (line.ends_with('\r')) line.remove_suffix(1);
    std::vector<std::string_view> cells;
    while (true) {
        const std::size_t comma = line.find(',');
        cells.push_back(line.substr(0, comma));
        if (comma == std::string_view::npos) return cells;
        line.remove_prefix(comma + 1);
    }
}

using Names = std::vector<std::string_view>;

constexpr std::size_t no_column = std::numeric_limits<std::size_t>::max();

bool contains(const Names& names, std::string_view name) {
    return std::find(names.begin(), names.end(), name) != names.end();
}

/// For each column of Record its index in the file; no_column for one that is missing and not needed. Without a list
/// all are needed but the optional ones, which come last.
template <class Record>
std::vector<std::size_t> column_order(const std::string& path, const Names& names, const Names* needed) {
    std::vector<std::size_t> order;
    std::vector<std::string> missing;
    Record record;
    visit_columns(record, [&](std::string_view name, auto&) {
        const auto found = std::find(names.begin(), names.end(), name);
        if (found != names.end()) {
            order.push_back(static_cast<std::size_t>(found - names.begin()));
            return;
        }
        order.push_back(no_column);
        if (needed == nullptr || contains(*needed, name)) missing.push_back(fmt::format("'{}'", name));
    });
    if (!missing.empty())
        throw InputError(
            fmt::format("{}:1: no {} {}", path, missing.size() == 1 ? "column" : "columns", fmt::join(missing, ", ")));
    visit_optional_columns(record, [&](std::string_view name, auto&) {
        const auto found = std::find(names.begin(), names.end(), name);
        order.push_back(found == names.end() ? no_column : static_cast<std::size_t>(found - names.begin()));
    });
    return order;
}

template <class Record>
Record parse_row(const std::string& place, std::string_view line, std::size_t n_columns,
                 const std::vector<std::size_t>& order) {
    const auto cells = split(line);
    if (cells.size() != n_columns)
        throw InputError(fmt::format("{}: expected {} columns, found {}", place, n_columns, cells.size()));
    Record record;
    std::size_t column = 0;
    const auto read_cell = [&](std::string_view name, auto& value) {
        const std::size_t index = order[column++];
        if (index == no_column) return;
        const std::string_view text = cells[index];
        const std::string_view expected = parse(text, value);
        if (!expected.empty())
            throw InputError(fmt::format("{}: {}: expected {}, found '{}'", place, name, expected, text.substr(0, 40)));
    };
    visit_columns(record, read_cell);
    visit_optional_columns(record, read_cell);
    return record;
}

/// Calls header(cells of the first line), then row(place, line) for each line that has its end.
template <class Header, class Row> void visit_lines(const std::filesystem::path& path, Header&& header, Row&& row) {
    const std::string content = read_file(path);
    std::string_view rest = content;
    constexpr std::string_view mark_of_encoding = "\xEF\xBB\xBF"; // that some programs begin a table with
    if (rest.starts_with(mark_of_encoding)) rest.remove_prefix(mark_of_encoding.size());
    if (rest.find('\n') == std::string_view::npos)
        throw InputError(fmt::format("{}:1: expected a line of column names", path.string()));
    header(split(rest.substr(0, rest.find('\n'))));
    rest.remove_prefix(rest.find('\n') + 1);
    for (std::size_t line = 2, end = rest.find('\n'); end != std::string_view::npos; end = rest.find('\n'), ++line) {
        row(fmt::format("{}:{}", path.string(), line), rest.substr(0, end));
        rest.remove_prefix(end + 1);
    }
}

template <class Record>
std::vector<Record> read_table(const std::filesystem::path& path, const Names* needed = nullptr) {
    std::size_t n_columns = 0;
    std::vector<std::size_t> order;
    std::vector<Record> records;
    visit_lines(
        path,
        [&](const Names& names) {
            n_columns = names.size();
            order = column_order<Record>(path.string(), names, needed);
        },
        [&](const std::string& place, std::string_view line) {
            records.push_back(parse_row<Record>(place, line, n_columns, order));
        });
    return records;
}

constexpr std::array<std::string_view, 3> histories_places{"step", "stage", "load_factor"};

StepRecord parse_histories_row(const std::string& place, std::string_view line,
                               const std::vector<std::string>& columns) {
    const auto cells = split(line);
    const std::size_t n_places = histories_places.size();
    if (cells.size() != n_places + columns.size())
        throw InputError(
            fmt::format("{}: expected {} columns, found {}", place, n_places + columns.size(), cells.size()));
    const auto read = [&](std::size_t column, std::string_view name, auto& value) {
        const std::string_view expected = parse(cells[column], value);
        if (!expected.empty())
            throw InputError(
                fmt::format("{}: {}: expected {}, found '{}'", place, name, expected, cells[column].substr(0, 40)));
    };
    StepRecord record;
    read(0, histories_places[0], record.step);
    read(1, histories_places[1], record.stage);
    read(2, histories_places[2], record.load_factor);
    for (std::size_t i = 0; i < columns.size(); ++i) read(n_places + i, columns[i], record.histories.emplace_back());
    return record;
}

} // namespace

std::string history_header() { return header_of<StepRecord>(); }
std::string motion_header() { return header_of<MotionRecord>(); }
std::string cracks_header() { return header_of<CrackRecord>(); }
std::string jumps_header() { return header_of<JumpRecord>(); }
std::string table_row(const StepRecord& record) {
    std::string row = row_of(record);
    visit_optional_columns(record, [&](std::string_view, const auto& value) {
        if (value) row += ',' + cell(*value);
    });
    return record.motion ? row + ',' + row_of(*record.motion) : row;
}
std::string table_row(const CrackRecord& crack) { return row_of(crack); }
std::string table_row(const JumpRecord& jump) { return row_of(jump); }
std::string histories_header(const std::vector<std::string>& columns) {
    return fmt::format("{},{}", fmt::join(histories_places, ","), fmt::join(columns, ","));
}
std::string histories_row(const StepRecord& record) {
    std::string line = fmt::format("{},{},{}", cell(record.step), cell(record.stage), cell(record.load_factor));
    for (const double value : record.histories) line += ',' + cell(value);
    return line;
}
std::vector<StepRecord> read_history(const std::filesystem::path& path) { return read_table<StepRecord>(path); }
std::vector<StepRecord> read_history(const std::filesystem::path& path, const std::vector<std::string_view>& needed) {
    return read_table<StepRecord>(path, &needed);
}
HistoriesTable read_histories(const std::filesystem::path& path) {
    HistoriesTable table;
    visit_lines(
        path,
        [&](const Names& names) {
            const std::size_t n_places = histories_places.size();
            if (names.size() < n_places || !std::equal(histories_places.begin(), histories_places.end(), names.begin()))
                throw InputError(fmt::format("{}:1: expected the columns {} and further ones, found '{}'",
                                             path.string(), fmt::join(histories_places, ","),
                                             fmt::format("{}", fmt::join(names, ",")).substr(0, 80)));
            table.columns.assign(names.begin() + n_places, names.end());
        },
        [&](const std::string& place, std::string_view line) {
            table.rows.push_back(parse_histories_row(place, line, table.columns));
        });
    return table;
}
std::vector<CrackRecord> read_cracks(const std::filesystem::path& path) { return read_table<CrackRecord>(path); }

} // namespace kluft
