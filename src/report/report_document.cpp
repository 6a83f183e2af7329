#include "kluft/report/report_document.hpp"

#include <algorithm>
#include <cstdint>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "kluft/report/report_page.hpp"

namespace kluft {

namespace {

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
    void operator()(const ReportAnswer& answer) {
        text += fmt::format("**{}: {}**\n\n{}\n\n", for_markdown(answer.name), for_markdown(answer.value),
                            for_markdown(answer.sentence));
        if (!answer.command.empty()) text += "    " + one_line(answer.command) + "\n\n";
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
    bool in_section = false;
    int n_commands = 0;

    void operator()(const ReportHeading& heading) {
        if (heading.level <= 2) end_section();
        if (heading.level == 2) {
            text += "<section class=\"long\">\n";
            in_section = true;
        }
        text += fmt::format("<h{0}>{1}</h{0}>\n", heading.level, html_text(heading.text));
    }
    void operator()(const ReportAnswer& answer) {
        text += fmt::format("<div class=\"answer{}\" role=\"region\" aria-label=\"Answer\">\n<p class=\"name\">{}</p>\n"
                            "<p class=\"value\">{}</p>\n<p>{}</p>\n",
                            answer.firm ? "" : " open", html_text(answer.name), html_text(answer.value),
                            html_text(answer.sentence));
        if (!answer.command.empty()) {
            const std::string id = fmt::format("command-{}", ++n_commands);
            text +=
                fmt::format("<div class=\"command\"><code id=\"{0}\" tabindex=\"0\">{1}</code><button class=\"act\" "
                            "data-copy=\"{0}\">Copy</button></div>\n",
                            id, html_text(answer.command));
        }
        text += "</div>\n";
    }
    void operator()(const ReportParagraph& paragraph) { text += "<p>" + html_text(paragraph.text) + "</p>\n"; }
    void operator()(const ReportList& list) {
        text += "<ul>\n";
        for (const std::string& item : list.items) text += "<li>" + html_text(item) + "</li>\n";
        text += "</ul>\n";
    }
    void operator()(const ReportTable& table) {
        text += "<div class=\"scroll\" tabindex=\"0\"><table class=\"sortable\"><thead><tr>";
        for (std::size_t i = 0; i < table.head.size(); ++i)
            text += (i < table.n_words ? "<th>" : "<th class=number>") + html_text(table.head[i]) + "</th>";
        text += "</tr></thead>\n<tbody>\n";
        for (std::size_t r = 0; r < table.rows.size(); ++r) {
            const bool marked = std::ranges::find(table.marked, r) != table.marked.end();
            text += marked ? "<tr class=marked>" : "<tr>";
            for (std::size_t i = 0; i < table.rows[r].size(); ++i)
                text += (i < table.n_words ? "<td>" : "<td class=number>") + html_text(table.rows[r][i]) + "</td>";
            text += "</tr>\n";
        }
        text += "</tbody></table></div>\n";
    }
    void operator()(const ReportPicture& picture) {
        text += fmt::format("<figure><img src=\"data:image/svg+xml;base64,{}\" alt=\"{}\"></figure>\n",
                            base64(picture.svg), html_text(picture.text));
    }
    void end_section() {
        if (in_section) text += "</section>\n";
        in_section = false;
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
    writer.end_section();
    return html_of({title_of(document), std::move(writer.text), {}, {}, false});
}

} // namespace kluft
