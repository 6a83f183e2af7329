#include "kluft/simulation/run_report.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace kluft {

std::string factor_name(const std::vector<std::string>& reduced_alone) {
    if (reduced_alone.empty()) return "factor of safety";
    return fmt::format("factor of safety of {} alone", fmt::join(reduced_alone, ", "));
}

std::string factor_in_words(const std::vector<std::string>& reduced_alone, double factor,
                            const std::optional<double>& undoubted_factor, int digits) {
    std::string text = fmt::format("{} {:.{}g}", factor_name(reduced_alone), factor, digits);
    if (undoubted_factor) text += fmt::format(" (in doubt above {:.4g})", *undoubted_factor);
    return text;
}

} // namespace kluft
