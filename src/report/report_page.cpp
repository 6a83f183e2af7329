#include "kluft/report/report_page.hpp"

#include <stdexcept>

#include "page_files.hpp"

namespace kluft {

std::string html_text(std::string_view text) {
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

std::string filled(std::string_view page_template, const std::map<std::string, std::string>& texts) {
    std::string result;
    std::size_t at = 0;
    for (std::size_t open = page_template.find("{{"); open != std::string_view::npos;
         open = page_template.find("{{", at)) {
        const std::size_t close = page_template.find("}}", open);
        const std::string name(page_template.substr(open + 2, close - open - 2));
        const auto text = texts.find(name);
        if (close == std::string_view::npos || text == texts.end())
            throw std::logic_error("a page has no text for {{" + name + "}}");
        result += page_template.substr(at, open - at);
        result += text->second;
        at = close + 2;
    }
    return result += page_template.substr(at);
}

std::string escaped_json(const std::string& json) {
    std::string result;
    result.reserve(json.size());
    for (const char c : json) {
        if (c == '<')
            result += "\\u003c"; // a "<" is in a text there
        else
            result += c;
    }
    return result;
}

std::string data_element(const std::string& id, const std::string& json) {
    return "<script type=\"application/json\" id=\"" + id + "\">" + json + "</script>\n";
}

std::string html_of(const ReportPage& page) {
    std::string style(page_file("frame.css"));
    for (const std::string& name : page.further_styles) style += page_file(name);
    std::string programs;
    if (page.plots) programs += "<script>" + std::string(page_file("chart.min.js")) + "</script>\n";
    programs += "<script>\n(() => {\n\"use strict\";\n" + std::string(page_file("frame.js"));
    for (const std::string& name : page.further_programs) programs += page_file(name);
    programs += "})();\n</script>\n";
    return filled(page_file("frame.html"), {{"title", html_text(page.title)},
                                            {"style", std::move(style)},
                                            {"body", page.body},
                                            {"programs", std::move(programs)}});
}

bool is_report_page(std::string_view content) {
    constexpr std::size_t head = 1000;
    return content.substr(0, head).find(R"(<meta name="generator" content="Kluft">)") != std::string_view::npos;
}

} // namespace kluft
