// What a run reports when it has ended.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "kluft/core/vector.hpp"
#include "kluft/simulation/run_costs.hpp"
#include "kluft/simulation/run_status.hpp"

namespace kluft {

/// Numbers that only some runs have.
struct RunResults {
    std::optional<double> factor_of_safety; ///< by a stage that reduces the strengths, if that found the limit
    std::optional<double>
        undoubted_factor; ///< the last one before that which speaks against the factor of safety (a warning)
    std::optional<double> estimated_error; ///< of the history up to its peak, where an accuracy was asked for
};

/// Calls visit(name, member) for each of them, by its name in summary.json and in the tables of a study. `results`:
/// RunResults, const or not.
template <class Results, class Visit> void visit_results(Results& results, Visit&& visit) {
    visit("factor_of_safety", results.factor_of_safety);
    visit("undoubted_factor", results.undoubted_factor);
    visit("estimated_error", results.estimated_error);
}

/// "factor of safety", and of what: "factor of safety of joint alone".
[[nodiscard]] std::string factor_name(const std::vector<std::string>& reduced_alone);

/// The name and value of a factor of safety to this many digits, and above what it is in doubt, if it is:
/// "factor of safety 1.43 (in doubt above 1.25)".
[[nodiscard]] std::string factor_in_words(const std::vector<std::string>& reduced_alone, double factor,
                                          const std::optional<double>& undoubted_factor, int digits);

/// A block that moves where the run has ended.
struct FallingBlock {
    std::string block; ///< its name, or its number
    int stage = 0;
    double load_factor = 0.0;
    Vec2 direction = Vec2::Zero(); ///< of length 1; zero where it only turns
    int turn = 0;                  ///< 1 where it also turns counter-clockwise, -1 clockwise
    double share_of_body = 0.0;    ///< its area over that of all blocks
};

struct RunReport {
    RunStatus status = RunStatus::done;
    std::string diagnosis; ///< names the blocks and interfaces concerned, or what ran out; empty for `done`
    std::string remark;    ///< of a run that was done before its last load step: where and why
    RunResults results;
    std::vector<std::string>
        reduced_alone; ///< interfaces whose strengths alone the factor of safety divides; empty: all
    RunCosts costs;    ///< also of the parts of the run before a resumed state
    int unbalanced_steps = 0;
    int detections = 0;
    int crack_checks = 0;
    std::vector<std::string> warnings;
    std::vector<FallingBlock> falling;  ///< the one furthest from balance first
    std::optional<MotionReport> motion; ///< of explicit runs
};

} // namespace kluft
