#include "kluft/simulation/run_report.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace kluft {

std::string factor_name(const std::vector<std::string>& reduced_alone) {
    if (reduced_alone.empty()) return "factor of safety";
    return fmt::format("factor of safety of {} alone", fmt::join(reduced_alone, ", "));
}

} // namespace kluft
