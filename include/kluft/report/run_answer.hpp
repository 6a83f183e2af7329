// What a run answers, in words: the strength, the factor of safety, or that the body stands, and what is to be known of it.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "kluft/output/summary.hpp"
#include "kluft/simulation/step_record.hpp"

namespace kluft {

/// What is known of a run.
struct RunFacts {
    std::optional<RunSummary> summary; ///< none of a run that was killed or still runs
    CurveNumbers numbers;
    std::optional<int> platen_stage;
    double sense = 1.0;             ///< of the platen: 1 presses, -1 pulls
    std::optional<StepRecord> peak; ///< the equilibrium of the peak stress
    std::optional<double> stood;    ///< largest strength factor with which the body stood while strengths were reduced
    std::vector<std::string> reduced_alone; ///< interfaces whose strengths alone were reduced; empty: all
    std::size_t n_merged = 0;               ///< pieces too small that were merged when the body was cut
    bool reduces_strength = false;          ///< a stage looks for the factor of safety
    bool tables_are_whole = true;           ///< they give the numbers that the run wrote at its end
};

struct RunAnswer {
    std::string name;     ///< of what is answered: "Strength", "Factor of safety", "Equilibrium"
    std::string value;    ///< with unit, "at least" before a bound and the band behind it where it is known
    std::string sentence; ///< what the value is, or why there is none
    bool firm = false;    ///< otherwise a bound, or no answer
    std::vector<std::string> warnings; ///< what lies against it: of the result first, then those that the run gave
};

[[nodiscard]] RunAnswer run_answer(const RunFacts& facts);

} // namespace kluft
