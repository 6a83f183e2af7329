#include "manual.hpp"

#include <algorithm>
#include <cctype>
#include <sstream>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "kluft/core/version.hpp"
#include "kluft/output/atomic_file.hpp"
#include "kluft/scene/scene_schema.hpp"
#include "kluft/studies/study_schema.hpp"

namespace kluft {

namespace {

/// Text as man reads it: nothing in it is a request; what stands between back quotes is bold.
std::string roff(std::string_view text) {
    std::string written;
    bool bold = false;
    for (const char c : text) {
        if (c == '`') {
            written += bold ? "\\fR" : "\\fB";
            bold = !bold;
        } else if (c == '\\') {
            written += "\\e";
        } else if (c == '-') {
            written += "\\-";
        } else if ((c == '.' || c == '\'') && (written.empty() || written.back() == '\n')) {
            written += std::string("\\&") + c;
        } else {
            written += c;
        }
    }
    return bold ? written + "\\fR" : written;
}

std::string upper(std::string text) {
    std::ranges::transform(text, text.begin(), [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
    return text;
}

std::string heading(const std::string& name, int section, const std::string& description) {
    return fmt::format(".TH {} {} \"\" \"kluft {}\" \"Kluft\"\n.SH NAME\n{} \\- {}\n", upper(name), section, version(),
                       roff(name), roff(description));
}

struct Footer {
    std::string notes;
    std::string examples;
};

Footer parts_of(const std::string& footer) {
    for (const std::string_view word : {"Examples:", "Example:"})
        if (const auto at = footer.find(word); at != std::string::npos)
            return {footer.substr(0, at), footer.substr(at + word.size())};
    return {footer, {}};
}

std::string paragraphs(const std::string& text) {
    std::string written;
    std::istringstream lines(text);
    for (std::string line; std::getline(lines, line);)
        if (!line.empty()) written += ".PP\n" + roff(line) + "\n";
    return written;
}

std::string example_lines(const std::string& text) {
    std::string written = ".SH EXAMPLES\n.nf\n";
    std::istringstream lines(text);
    for (std::string line; std::getline(lines, line);) {
        line.erase(0, std::min(line.find_first_not_of(' '), line.size()));
        if (!line.empty()) written += roff(line) + "\n";
    }
    return written + ".fi\n";
}

std::string option_entry(const CLI::Option& option) {
    std::vector<std::string> names;
    for (const std::string& name : option.get_snames()) names.push_back("\\fB" + roff("-" + name) + "\\fR");
    for (const std::string& name : option.get_lnames()) names.push_back("\\fB" + roff("--" + name) + "\\fR");
    const std::string value = option.get_items_expected_max() > 0 ? " \\fIVALUE\\fR" : "";
    std::string text = option.get_description();
    if (!option.get_default_str().empty()) text += fmt::format(" (default: {})", option.get_default_str());
    return fmt::format(".TP\n{}{}\n{}\n", fmt::join(names, ", "), value, roff(text));
}

std::string argument_entry(const CLI::Option& option) {
    return fmt::format(".TP\n\\fI{}\\fR\n{}\n", roff(option.get_name(true, false)), roff(option.get_description()));
}

bool is_shown(const CLI::App* command) { return !command->get_group().empty(); }

std::string see_also(const CLI::App& app, const std::string& own) {
    std::vector<std::string> pages{"\\fBkluft\\fR(1)"};
    for (const CLI::App* sub : app.get_subcommands({}))
        if (is_shown(sub) && sub->get_name() != own)
            pages.push_back(fmt::format("\\fBkluft\\-{}\\fR(1)", roff(sub->get_name())));
    pages.insert(pages.end(), {"\\fBkluft\\-scene\\fR(5)", "\\fBkluft\\-study\\fR(5)"});
    return fmt::format(".SH SEE ALSO\n{}\n", fmt::join(pages, ", "));
}

std::string manual_of_command(const CLI::App& app, const CLI::App& command) {
    const std::string name = "kluft-" + command.get_name();
    std::string arguments, options, words;
    for (const CLI::Option* option : command.get_options()) {
        if (option->get_positional()) {
            arguments += argument_entry(*option);
            words += fmt::format(" \\fI{}\\fR{}", roff(option->get_name(true, false)),
                                 option->get_items_expected_max() > 1 ? " ..." : "");
        } else {
            options += option_entry(*option);
        }
    }
    const bool is_script = options.empty() && arguments.empty();
    if (is_script) words = " \\fIWORD\\fR ...";
    std::string page = heading(name, 1, command.get_description());
    page += fmt::format(".SH SYNOPSIS\n\\fBkluft {}\\fR{}{}\n.SH DESCRIPTION\n{}.\n", roff(command.get_name()),
                        options.empty() ? "" : " [\\fIOPTIONS\\fR]", words, roff(command.get_description()));
    if (is_script) page += roff(fmt::format("kluft {} --help says more.", command.get_name())) + "\n";
    const Footer footer = parts_of(command.get_footer());
    page += paragraphs(footer.notes);
    if (!arguments.empty()) page += ".SH ARGUMENTS\n" + arguments;
    if (!options.empty()) page += ".SH OPTIONS\n" + options;
    if (!footer.examples.empty()) page += example_lines(footer.examples);
    return page + see_also(app, command.get_name());
}

std::string manual_of_program(const CLI::App& app) {
    std::string page = heading("kluft", 1, app.get_description());
    page +=
        ".SH SYNOPSIS\n\\fBkluft\\fR \\fICOMMAND\\fR [\\fIOPTIONS\\fR] ...\n.SH DESCRIPTION\n" +
        roff("Kluft computes the strength of fractured rock. A scene, a file in YAML, says what the body is made of, "
             "how it is cut into blocks and how it is loaded.") +
        "\n.SH COMMANDS\n";
    for (const CLI::App* sub : app.get_subcommands({}))
        if (is_shown(sub))
            page +=
                fmt::format(".TP\n\\fBkluft\\-{}\\fR(1)\n{}\n", roff(sub->get_name()), roff(sub->get_description()));
    page += ".SH EXIT STATUS\n" +
            roff("0 done; 1 a comparison, a validation case or a target missed its tolerance; 2 bad input; 3 no "
                 "equilibrium; "
                 "4 out of disk or memory; 128 + n stopped by signal n.") +
            "\n";
    return page + example_lines(parts_of(app.get_footer()).examples) + see_also(app, "");
}

} // namespace

std::string manual_of_keys(const std::string& kind, const std::string& what, const KeyTable& table) {
    std::string page = heading("kluft-" + kind, 5, what);
    page += ".SH DESCRIPTION\n" +
            roff("A file in YAML with the keys below. * stands for a name that the file chooses, # for an index from "
                 "0. Numbers "
                 "are in SI units and angles in degrees, or carry their unit, as in `25 MPa`.") +
            "\n.SH KEYS\n";
    for (const KeyRule& rule : table) {
        std::string text = table.expected_text(rule);
        if (const std::string fallback = default_text(rule); !fallback.empty())
            text += "; " + (fallback == "required" ? fallback : "default: " + fallback);
        text += '.';
        if (!rule.doc.empty()) text += ' ' + std::string(rule.doc);
        page += fmt::format(".TP\n\\fB{}\\fR\n{}\n", roff(rule.path), roff(text));
    }
    return page + ".SH SEE ALSO\n\\fBkluft\\fR(1), \\fBkluft\\-run\\fR(1), \\fBkluft\\-study\\fR(1)\n";
}

void write_manual(const CLI::App& app, const std::filesystem::path& directory) {
    make_directory(directory);
    write_file(directory / "kluft.1", manual_of_program(app));
    for (const CLI::App* sub : app.get_subcommands({}))
        if (is_shown(sub))
            write_file(directory / fmt::format("kluft-{}.1", sub->get_name()), manual_of_command(app, *sub));
    write_file(directory / "kluft-scene.5", manual_of_keys("scene", "a body of rock and its loads", scene_schema()));
    write_file(directory / "kluft-study.5", manual_of_keys("study", "a scene with many settings", study_schema()));
}

} // namespace kluft
