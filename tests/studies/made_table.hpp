// Tables of studies that nobody ran.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "kluft/studies/study_table.hpp"

namespace kluft::testing {

/// Of one quantity, peak_stress, without cases.
inline StudyTable made_table(const std::vector<std::string>& parameters, std::optional<std::size_t> along) {
    StudyTable table;
    table.title = "Made study";
    table.parameters = parameters;
    table.along = along;
    table.quantities = {"peak_stress"};
    table.reference_name = "a made reference";
    return table;
}

inline StudyCase done_case(const std::vector<std::string>& settings, double value, double error, double cpu_s) {
    StudyCase made;
    made.settings = settings;
    made.status = CaseStatus::done;
    made.quantities = {value};
    made.errors = {error};
    made.cpu_s = cpu_s;
    return made;
}

} // namespace kluft::testing
