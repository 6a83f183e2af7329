#include "kluft/output/comparison_table.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "json_number.hpp"
#include "kluft/core/nearest_name.hpp"
#include "kluft/core/units.hpp"
#include "kluft/core/version.hpp"

namespace kluft {

namespace {

using Json = nlohmann::ordered_json;
using Cells = std::array<std::string, 5>;

constexpr const char* unknown = "-";
const Cells column_names{"quantity", "A", "B", "difference", ""};

bool known(const std::optional<double>& value) { return value && std::isfinite(*value); }

std::string value_cell(const ComparedQuantity& quantity, const std::optional<double>& value) {
    if (!known(value)) return unknown;
    const double shown = *value / quantity.unit_size;
    const bool is_count = quantity.unit.empty() && shown == std::floor(shown) && std::abs(shown) < 1e15;
    return is_count ? fmt::format("{:.0f}", shown) : fmt::format("{:.4g}", shown);
}

std::string difference_cell(const ComparedQuantity& quantity) {
    if (!known(quantity.difference)) return unknown;
    const double shown = percent * *quantity.difference;
    constexpr double invisible = 0.005;
    const bool has_sign = quantity.a && std::abs(shown) >= invisible;
    return has_sign ? fmt::format("{:+.2f} %", shown) : fmt::format("{:.2f} %", std::abs(shown));
}

std::string verdict_cell(Verdict verdict) {
    switch (verdict) {
    case Verdict::not_judged:
        return "";
    case Verdict::within:
        return "within";
    case Verdict::missed:
        return "MISS";
    }
    return "";
}

Cells cells_of(const ComparedQuantity& quantity) {
    const std::string name =
        quantity.unit.empty() ? quantity.name : fmt::format("{} ({})", quantity.name, quantity.unit);
    return {name, value_cell(quantity, quantity.a), value_cell(quantity, quantity.b), difference_cell(quantity),
            verdict_cell(quantity.verdict)};
}

/// Columns of a text are as wide as their widest cell counted in bytes: all cells are ASCII.
std::array<std::size_t, 5> widths_of(const std::vector<Cells>& rows) {
    std::array<std::size_t, 5> widths{};
    for (const Cells& row : rows)
        for (std::size_t i = 0; i < row.size(); ++i) widths[i] = std::max(widths[i], row[i].size());
    return widths;
}

std::string text_row(const Cells& row, const std::array<std::size_t, 5>& widths) {
    std::string line = fmt::format("{:<{}}  {:>{}}  {:>{}}  {:>{}}  {}", row[0], widths[0], row[1], widths[1], row[2],
                                   widths[2], row[3], widths[3], row[4]);
    line.erase(line.find_last_not_of(' ') + 1);
    return line + '\n';
}

std::string run_facts(const ComparedRun& run) {
    std::vector<std::string> facts;
    if (!run.status.empty()) facts.push_back(run.status);
    if (!run.integrator.empty()) facts.push_back(run.integrator);
    if (run.blocks) facts.push_back(fmt::format("{} blocks", *run.blocks));
    return facts.empty() ? "no summary" : listed(facts);
}

std::string conclusion(const ComparisonTable& table) {
    const std::string tolerance = fmt::format("{:.4g} %", percent * table.tolerance);
    if (table.agree) return "The runs agree within " + tolerance + ".";
    std::vector<std::string> missed;
    for (const ComparedQuantity& quantity : table.quantities)
        if (quantity.verdict == Verdict::missed) missed.push_back(quantity.name);
    if (missed.empty()) return "Nothing that could be judged.";
    return fmt::format("The runs do not agree within {}: {}.", tolerance, listed(missed));
}

/// What the words of the table mean.
std::vector<std::string> explanations(const ComparisonTable& table) {
    std::vector<std::string> lines{"Differences are those of B from A, relative to A."};
    if (known(table.curve_end))
        lines.push_back(
            fmt::format("The curves of differential stress are compared at equal axial strains up to {:.4g} "
                        "%, relative to the peak differential stress of A.",
                        percent * *table.curve_end));
    if (known(table.matching_distance))
        lines.push_back(fmt::format("A crack is matched by one of the same mode within {:.4g} m in the other run, the "
                                    "nearest pairs first, each crack once.",
                                    *table.matching_distance));
    return lines;
}

/// Text in a table or a heading of Markdown.
std::string escaped(const std::string& text) {
    std::string result;
    for (const char c : text) {
        if (c == '\n' || c == '\r') {
            result += ' ';
            continue;
        }
        if (c == '|' || c == '*' || c == '_' || c == '`' || c == '<' || c == '[' || c == '\\') result += '\\';
        result += c;
    }
    return result;
}

std::string markdown_row(const Cells& row) {
    return fmt::format("| {} | {} | {} | {} | {} |\n", row[0], row[1], row[2], row[3], row[4]);
}

std::string markdown_run(char letter, const ComparedRun& run) {
    return fmt::format("- {}: {} in {} ({})\n", letter, escaped(run.title.empty() ? run.name : run.title),
                       escaped(run.directory), escaped(run_facts(run)));
}

Json text_or_null(const std::string& text) { return text.empty() ? Json(nullptr) : Json(text); }

Json run_json(const ComparedRun& run) {
    Json json;
    json["name"] = run.name;
    json["directory"] = run.directory;
    json["title"] = run.title;
    json["status"] = text_or_null(run.status);
    json["integrator"] = text_or_null(run.integrator);
    json["blocks"] = run.blocks ? Json(*run.blocks) : Json(nullptr);
    return json;
}

Json quantity_json(const ComparedQuantity& quantity) {
    Json json;
    json["a"] = json_number(quantity.a);
    json["b"] = json_number(quantity.b);
    json["difference"] = json_number(quantity.difference);
    json["within"] =
        quantity.verdict == Verdict::not_judged ? Json(nullptr) : Json(quantity.verdict == Verdict::within);
    return json;
}

} // namespace

std::string comparison_text(const ComparisonTable& table) {
    std::vector<Cells> rows{column_names};
    for (const ComparedQuantity& quantity : table.quantities) rows.push_back(cells_of(quantity));
    const auto widths = widths_of(rows);
    std::string text = fmt::format("A  {}  ({})\nB  {}  ({})\n\n", table.a.directory, run_facts(table.a),
                                   table.b.directory, run_facts(table.b));
    for (const Cells& row : rows) text += text_row(row, widths);
    text += '\n';
    for (const std::string& note : table.notes) text += "note: " + note + '\n';
    return text + conclusion(table) + '\n';
}

std::string comparison_markdown(const ComparisonTable& table) {
    std::string text = fmt::format("# {} and {}\n\n", escaped(table.a.name), escaped(table.b.name));
    text += markdown_run('A', table.a) + markdown_run('B', table.b) + '\n';
    text += markdown_row(column_names) + "|---|---:|---:|---:|---|\n";
    for (const ComparedQuantity& quantity : table.quantities) {
        Cells row = cells_of(quantity);
        if (quantity.verdict == Verdict::missed)
            for (std::string& cell : row) cell = fmt::format("**{}**", cell);
        text += markdown_row(row);
    }
    text += '\n' + conclusion(table);
    for (const std::string& line : explanations(table)) text += ' ' + line;
    text += '\n';
    for (const std::string& note : table.notes) text += "\nNote: " + escaped(note) + '\n';
    for (const std::string& picture : table.pictures)
        text += fmt::format("\n![{}]({})\n", picture.substr(0, picture.find('.')), picture);
    return text;
}

std::string comparison_json(const ComparisonTable& table) {
    Json json;
    json["agree"] = table.agree;
    json["tolerance"] = json_number(table.tolerance);
    json["a"] = run_json(table.a);
    json["b"] = run_json(table.b);
    json["quantities"] = Json::object();
    for (const ComparedQuantity& quantity : table.quantities)
        json["quantities"][quantity.key] = quantity_json(quantity);
    json["matching_distance"] = json_number(table.matching_distance);
    json["curve_end"] = json_number(table.curve_end);
    json["notes"] = table.notes;
    json["pictures"] = table.pictures;
    json["version"] = std::string(version());
    return json.dump(2, ' ', false, Json::error_handler_t::replace) + '\n';
}

bool is_comparison_json(std::string_view text) {
    const Json json = Json::parse(text, nullptr, false);
    return json.is_object() && json.contains("agree") && json.contains("matching_distance");
}

} // namespace kluft
