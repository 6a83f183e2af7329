// Two runs side by side as a table: for the terminal, as Markdown and as JSON.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace kluft {

/// Whether a quantity decides if two runs agree, and how it does.
enum class Verdict {
    not_judged,
    within, ///< the tolerance
    missed
};

struct ComparedQuantity {
    std::string key;                  ///< in compare.json
    std::string name;                 ///< in the tables
    std::string unit;                 ///< in the tables; empty: a plain number
    double unit_size = 1.0;           ///< of the unit in SI
    std::optional<double> a;          ///< SI
    std::optional<double> b;          ///< SI
    std::optional<double> difference; ///< fraction: of b from a with its sign, or of two curves without one
    Verdict verdict = Verdict::not_judged;
};

/// What is said of a run besides its quantities.
struct ComparedRun {
    std::string name;
    std::string directory;
    std::string title;
    std::string status;     ///< as in summary.json; empty where it is not known
    std::string integrator; ///< the same
    std::optional<int> blocks;
};

struct ComparisonTable {
    ComparedRun a;
    ComparedRun b;
    double tolerance = 0.0; ///< fraction
    bool agree = false;
    std::vector<ComparedQuantity> quantities;
    std::optional<double> matching_distance; ///< within which cracks are matched (m)
    std::optional<double> curve_end;         ///< axial strain up to which the curves are compared
    std::vector<std::string> notes;          ///< what could not be compared, and why
    std::vector<std::string> pictures;       ///< names of files beside compare.md
};

/// Aligned columns; what is not known is '-', quantities that miss the tolerance are marked. Ends with a line that says
/// whether the runs agree.
[[nodiscard]] std::string comparison_text(const ComparisonTable& table);
/// The same as Markdown, with the pictures.
[[nodiscard]] std::string comparison_markdown(const ComparisonTable& table);
/// The same in SI units; what is not known or not a finite number is null.
[[nodiscard]] std::string comparison_json(const ComparisonTable& table);
/// Whether comparison_json has made the text.
[[nodiscard]] bool is_comparison_json(std::string_view text);

} // namespace kluft
