#include "kluft/output/report_document.hpp"

#include <algorithm>
#include <cstdint>

#include <fmt/format.h>

namespace kluft {

namespace {

constexpr const char* style =
    "body { font: 15px/1.45 sans-serif; max-width: 62em; margin: 2em auto; padding: 0 1em; color: #1a1a1a }\n"
    "table { border-collapse: collapse; font-size: 13px } td, th { padding: .2em .7em; border-bottom: 1px solid #ddd; "
    "text-align: left }\n"
    "td.number { text-align: right; font-variant-numeric: tabular-nums } tr.marked td { background: #f8dedb } img { "
    "max-width: 100% }\n"
    "h2 { margin-top: 2em }";

std::string one_line(const std::string& text) {
    std::string result;
    for (const char c : text) result += c == '\n' || c == '\r' ? ' ' : c;
    return result;
}

std::string for_markdown(const std::string& text) {
    std::string result;
    for (const char c : one_line(text)) {
        if (std::string_view("|*`<[\\_").find(c) != std::string_view::npos) result += '\\';
        result += c;
    }
    return result;
}

std::string for_html(const std::string& text) {
    std::string result;
    for (const char c : text) {
        switch (c) {
        case '&':
            result += "&amp;";
            break;
        case '<':
            result += "&lt;";
            break;
        case '>':
            result += "&gt;";
            break;
        case '"':
            result += "&quot;";
            break;
        default:
            result += c;
        }
    }
    return result;
}

std::string markdown_row(const std::vector<std::string>& cells) {
    std::string line = "|";
    for (const std::string& cell : cells) line += " " + for_markdown(cell) + " |";
    return line + "\n";
}

struct MarkdownWriter {
    std::string text;

    void operator()(const ReportHeading& heading) {
        text += std::string(static_cast<std::size_t>(heading.level), '#') + " " + for_markdown(heading.text) + "\n\n";
    }
    void operator()(const ReportParagraph& paragraph) { text += for_markdown(paragraph.text) + "\n\n"; }
    void operator()(const ReportList& list) {
        for (const std::string& item : list.items) text += "- " + for_markdown(item) + "\n";
        text += "\n";
    }
    void operator()(const ReportTable& table) {
        text += markdown_row(table.head) + "|";
        for (std::size_t i = 0; i < table.head.size(); ++i) text += i < table.n_words ? "---|" : "---:|";
        text += "\n";
        for (const auto& row : table.rows) text += markdown_row(row);
        text += "\n";
    }
    void operator()(const ReportPicture& picture) {
        text += fmt::format("![{}]({})\n\n", for_markdown(picture.text), picture.file);
    }
};

struct HtmlWriter {
    std::string text;

    void operator()(const ReportHeading& heading) {
        text += fmt::format("<h{0}>{1}</h{0}>\n", heading.level, for_html(heading.text));
    }
    void operator()(const ReportParagraph& paragraph) { text += "<p>" + for_html(paragraph.text) + "</p>\n"; }
    void operator()(const ReportList& list) {
        text += "<ul>\n";
        for (const std::string& item : list.items) text += "<li>" + for_html(item) + "</li>\n";
        text += "</ul>\n";
    }
    void operator()(const ReportTable& table) {
        text += "<table><tr>";
        for (const std::string& cell : table.head) text += "<th>" + for_html(cell) + "</th>";
        text += "</tr>\n";
        for (std::size_t r = 0; r < table.rows.size(); ++r) {
            bool marked = false;
            for (const std::size_t row : table.marked) marked = marked || row == r;
            text += marked ? "<tr class=marked>" : "<tr>";
            for (std::size_t i = 0; i < table.rows[r].size(); ++i)
                text += (i < table.n_words ? "<td>" : "<td class=number>") + for_html(table.rows[r][i]) + "</td>";
            text += "</tr>\n";
        }
        text += "</table>\n";
    }
    void operator()(const ReportPicture& picture) {
        text += fmt::format("<p><img src=\"data:image/svg+xml;base64,{}\" alt=\"{}\"></p>\n", base64(picture.svg),
                            for_html(picture.text));
    }
};

std::string title_of(const ReportDocument& document) {
    for (const ReportPart& part : document)
        if (const auto* const heading = std::get_if<ReportHeading>(&part)) return heading->text;
    return "Report";
}

} // namespace

std::string base64(std::string_view bytes) {
    constexpr std::string_view letters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string result;
    result.reserve((bytes.size() + 2) / 3 * 4);
    for (std::size_t i = 0; i < bytes.size(); i += 3) {
        const auto byte = [&](std::size_t k) {
            return i + k < bytes.size() ? static_cast<std::uint32_t>(static_cast<unsigned char>(bytes[i + k])) : 0U;
        };
        const std::uint32_t group = byte(0) << 16U | byte(1) << 8U | byte(2);
        const std::size_t n_letters = std::min<std::size_t>(bytes.size() - i, 3) + 1;
        for (std::size_t k = 0; k < 4; ++k)
            result += k < n_letters ? letters[group >> (18U - 6U * static_cast<unsigned>(k)) & 63U] : '=';
    }
    return result;
}

std::string report_markdown(const ReportDocument& document) {
    MarkdownWriter writer;
    for (const ReportPart& part : document) std::visit(writer, part);
    if (writer.text.ends_with("\n\n")) writer.text.pop_back();
    return writer.text;
}

std::string report_html(const ReportDocument& document) {
    HtmlWriter writer;
    for (const ReportPart& part : document) std::visit(writer, part);
    return fmt::format("<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>{}</title><style>{}"
                       "</style></head><body>\n{}</body></html>\n",
                       for_html(title_of(document)), style, writer.text);
}

} // namespace kluft
