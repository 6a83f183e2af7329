// The frame that all pages have: one HTML file that needs no other, no network, and shows what it says without its programs too.
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace kluft {

/// The text with what has a meaning in HTML escaped.
[[nodiscard]] std::string html_text(std::string_view text);

/// The template with each {{name}} replaced by its text, once. Throws std::logic_error for a name without a text.
[[nodiscard]] std::string filled(std::string_view page_template, const std::map<std::string, std::string>& texts);

/// Data inside a page: the element that a program reads by its id. `json`: without "<", as escaped_json leaves it.
[[nodiscard]] std::string data_element(const std::string& id, const std::string& json);

/// JSON that may stand inside a script element.
[[nodiscard]] std::string escaped_json(const std::string& json);

struct ReportPage {
    std::string title;
    std::string body;                          ///< HTML
    std::vector<std::string> further_styles;   ///< files of src/report/page, after frame.css
    std::vector<std::string> further_programs; ///< the same, after frame.js; they see each other's functions
    bool plots = false;                        ///< with the plot library
};

[[nodiscard]] std::string html_of(const ReportPage& page);

/// Whether html_of has made the page: its head says so.
[[nodiscard]] bool is_report_page(std::string_view content);

} // namespace kluft
