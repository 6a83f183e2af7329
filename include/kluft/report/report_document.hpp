// A report of an answer, headings, paragraphs, lists, tables and pictures: as Markdown, and as one HTML file that needs no other.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace kluft {

struct ReportHeading {
    int level = 2; ///< 1 is the title
    std::string text;
};

/// What the report comes to, before all else.
struct ReportAnswer {
    std::string name;
    std::string value;
    std::string sentence;
    std::string command = {}; ///< a line to copy; may be empty
    bool firm = true;         ///< otherwise a bound, or none
};

struct ReportParagraph {
    std::string text;
};

struct ReportList {
    std::vector<std::string> items;
};

struct ReportTable {
    std::vector<std::string> head;
    std::vector<std::vector<std::string>> rows;
    std::vector<std::size_t> marked = {}; ///< rows that stand out in the HTML
    std::size_t n_words = 1;              ///< columns from the left that hold words; the others are set to the right
};

/// An SVG picture that stands beside the Markdown and inside the HTML.
struct ReportPicture {
    std::string file; ///< name of the PNG beside the report
    std::string text; ///< what it shows
    std::string svg;
};

using ReportPart = std::variant<ReportHeading, ReportAnswer, ReportParagraph, ReportList, ReportTable, ReportPicture>;
using ReportDocument = std::vector<ReportPart>;

/// Text is plain: what has a meaning in Markdown or HTML is escaped.
[[nodiscard]] std::string report_markdown(const ReportDocument& document);
/// In the frame of report_page.hpp: a section for each heading of level 2, tables that scroll and are sorted by a click on a head.
/// The title is that of the first heading.
[[nodiscard]] std::string report_html(const ReportDocument& document);

/// Base64 with padding (RFC 4648).
[[nodiscard]] std::string base64(std::string_view bytes);

} // namespace kluft
