#include "kluft/report/run_answer.hpp"

#include <algorithm>
#include <cstddef>

#include <fmt/format.h>

namespace kluft {

namespace {

constexpr double percent = 100.0;

/// In the unit that leaves it between 1 and 1000 where there is one.
std::string stress_in_words(double stress) {
    const double size = stress < 0.0 ? -stress : stress;
    if (size >= 1e9) return fmt::format("{:.4g} GPa", 1e-9 * stress);
    if (size >= 1e5 || size == 0.0) return fmt::format("{:.4g} MPa", 1e-6 * stress);
    if (size >= 1e2) return fmt::format("{:.4g} kPa", 1e-3 * stress);
    return fmt::format("{:.4g} Pa", stress);
}

std::string counted(int n, const std::string& one, const std::string& several) {
    return fmt::format("{} {}", n, n == 1 ? one : several);
}

bool has_status(const RunFacts& facts, RunStatus status) { return facts.summary && facts.summary->status == status; }

std::string place_of_peak(const RunFacts& facts) {
    if (!facts.numbers.peak_strain) return "";
    std::string text = fmt::format("at {:.4g} % axial strain", percent * facts.sense * *facts.numbers.peak_strain);
    if (facts.peak && facts.peak->lateral_stress != 0.0)
        text += " under a lateral stress of " + stress_in_words(facts.peak->lateral_stress);
    return text;
}

RunAnswer factor_of_safety(const RunFacts& facts) {
    RunAnswer answer;
    answer.name = factor_name(facts.reduced_alone);
    answer.name.front() = 'F';
    const std::string rest = facts.reduced_alone.empty() ? "" : " All other interfaces keep theirs.";
    const std::string strengths = facts.reduced_alone.empty() ? "its strengths" : "these strengths";
    if (facts.summary && facts.summary->results.factor_of_safety) {
        answer.value = fmt::format("{:.4g}", *facts.summary->results.factor_of_safety);
        answer.sentence = "The strengths divided by it are those with which the body just stands." + rest;
        answer.firm = !facts.summary->results.undoubted_factor;
        if (!answer.firm)
            answer.sentence +=
                fmt::format(" It is in doubt above {:.4g}: see the warning.", *facts.summary->results.undoubted_factor);
        return answer;
    }
    if (facts.stood) {
        answer.value = fmt::format("at least {:.4g}", *facts.stood);
        answer.sentence =
            fmt::format("The body stands with {} divided by it; the limit was not found.{}", strengths, rest);
    } else {
        answer.value = "not found";
        answer.sentence = "The run has no equilibrium from which strengths could be reduced.";
    }
    return answer;
}

RunAnswer strength(const RunFacts& facts) {
    const CurveNumbers& numbers = facts.numbers;
    RunAnswer answer;
    answer.name = facts.sense < 0.0 ? "Tensile strength" : "Strength";
    if (!numbers.peak_stress) {
        answer.value = "not found";
        answer.sentence = "No load step of the platen is balanced.";
        return answer;
    }
    const std::string value = stress_in_words(facts.sense * *numbers.peak_stress);
    const std::string place = place_of_peak(facts);
    if (numbers.net_locked) {
        answer.value = value + " before the net locked";
        answer.sentence =
            fmt::format("The largest axial stress before nearly all bonds of the net had failed, {}.", place);
        return answer;
    }
    if (numbers.sides_unloaded) {
        answer.value = "at least " + value;
        answer.sentence = fmt::format("The largest axial stress of all balanced states, {}; the sides were unloaded "
                                      "before it fell, so that the body failed under another lateral stress.",
                                      place);
        return answer;
    }
    if (numbers.peak_reached) {
        answer.sentence =
            fmt::format("The largest axial stress of all balanced states, {}; it falls behind it.", place);
    } else if (numbers.levelled_off) {
        answer.sentence = fmt::format("The largest axial stress of all balanced states, {}; over the last third of the "
                                      "strain it has changed by 1 % or less: the body gives way at this stress.",
                                      place);
    } else if (has_status(facts, RunStatus::collapsed)) {
        answer.sentence = fmt::format("The largest axial stress that the body bears, {}; above it there is no "
                                      "equilibrium.",
                                      place);
    } else {
        answer.value = "at least " + value;
        answer.sentence =
            fmt::format("The largest axial stress so far, {}; where the run ends it has not fallen.", place);
        return answer;
    }
    answer.firm = true;
    answer.value = value;
    if (facts.summary && facts.summary->results.estimated_error) {
        const double error = *facts.summary->results.estimated_error;
        answer.value += fmt::format(" \u00b1 {}", stress_in_words(error * *numbers.peak_stress * facts.sense));
        answer.sentence +=
            fmt::format(" The band is the estimated error of the load steps, {:.2g} %; what the net and the "
                        "scatter of strengths add is told by a study.",
                        percent * error);
    }
    return answer;
}

RunAnswer equilibrium(const RunFacts& facts) {
    RunAnswer answer;
    answer.name = "Equilibrium";
    answer.firm = has_status(facts, RunStatus::done) && facts.numbers.unbalanced_steps == 0;
    if (answer.firm) {
        answer.value = "found";
        answer.sentence = fmt::format("The body stands: every one of {} is balanced, the last one under all loads.",
                                      counted(facts.numbers.steps, "load step", "load steps"));
    } else if (has_status(facts, RunStatus::done)) {
        answer.value = "found at the end";
        answer.sentence = "The body stands under all loads.";
    } else {
        answer.value = "not found";
        answer.sentence = "The body was not found to stand under all loads.";
    }
    return answer;
}

/// What the way in which the run ended says against the answer.
void add_end(const RunFacts& facts, std::vector<std::string>& warnings) {
    if (!facts.summary) {
        warnings.emplace_back("The run has not ended, or was killed: the numbers are those of its tables so far.");
        return;
    }
    const std::string message = facts.summary->message.empty() ? "" : ": " + facts.summary->message;
    switch (facts.summary->status) {
    case RunStatus::done:
    case RunStatus::collapsed:
        return;
    case RunStatus::no_equilibrium:
        warnings.push_back("The run ended early, without an equilibrium" + message);
        return;
    case RunStatus::unbalanced:
        warnings.push_back("The run ended early, out of balance" + message);
        return;
    case RunStatus::out_of_resources:
        warnings.push_back("The run ended early, out of disk or memory" + message);
        return;
    case RunStatus::interrupted:
        warnings.push_back((facts.summary->motion
                                ? "The run was stopped before its end"
                                : "The run was stopped before its end; kluft run --resume goes on with it") +
                           message);
        return;
    }
}

/// "Blocks 12, 7 and 31 more, 2.1 % of the body, move where the run has ended (stage 1, load factor 0.4)."
std::string moving_in_words(const std::vector<FallingBlock>& falling) {
    constexpr std::size_t most_named = 5;
    const std::size_t n_named = std::min(falling.size(), most_named);
    std::string names = falling.front().block;
    for (std::size_t i = 1; i < n_named; ++i) names += (i + 1 == falling.size() ? " and " : ", ") + falling[i].block;
    if (falling.size() > n_named) names += fmt::format(" and {} more", falling.size() - n_named);
    double share = 0.0;
    for (const FallingBlock& each : falling) share += each.share_of_body;
    if (share > 0.0) names += fmt::format(", {:.3g} % of the body,", percent * share);
    return fmt::format("{} {} {} where the run has ended (stage {}, load factor {:.4g}).",
                       falling.size() == 1 ? "Block" : "Blocks", names, falling.size() == 1 ? "moves" : "move",
                       falling.front().stage, falling.front().load_factor);
}

void add_doubts(const RunFacts& facts, std::vector<std::string>& warnings) {
    const CurveNumbers& numbers = facts.numbers;
    if (facts.platen_stage && numbers.net_locked)
        warnings.emplace_back(
            "The net locked: loose cells carry more than the rock did with its bonds, as masonry does. "
            "What is above the value is no strength of the rock.");
    else if (facts.platen_stage && numbers.peak_stress && !is_strength(numbers) &&
             !has_status(facts, RunStatus::collapsed))
        warnings.emplace_back(
            "No peak yet: the axial stress has neither fallen by 1 % below its largest value nor levelled off. "
            "More strain, or more load, shows whether it does.");
    if (facts.platen_stage && numbers.jumps_to_peak > 0)
        warnings.push_back(
            fmt::format("{} before the peak: at fixed loads the body lost its balance and moved to another "
                        "one, so that the peak depends on that motion.",
                        counted(numbers.jumps_to_peak, "jump", "jumps")));
    if (!facts.platen_stage && numbers.jumps > 0)
        warnings.push_back(
            fmt::format("{}: at fixed loads the body lost its balance and moved on to where it stands now; "
                        "jumps.csv says how far.",
                        counted(numbers.jumps, "jump", "jumps")));
    if (numbers.unbalanced_steps > 0)
        warnings.push_back(
            fmt::format("{} not balanced: hollow in the curve, and left out where the peak is looked for.",
                        counted(numbers.unbalanced_steps, "load step is", "load steps are")));
    if (!facts.tables_are_whole)
        warnings.emplace_back(
            "The tables in the directory do not give the numbers of summary.json: one of them is cut or was changed.");
    if (facts.n_merged > 0)
        warnings.push_back(fmt::format("{} merged with a neighbour when the body was cut (geometry.minimum_area).",
                                       counted(static_cast<int>(facts.n_merged), "sliver was", "slivers were")));
    if (facts.summary && !facts.summary->falling.empty()) warnings.push_back(moving_in_words(facts.summary->falling));
}

} // namespace

RunAnswer run_answer(const RunFacts& facts) {
    RunAnswer answer = facts.reduces_strength ? factor_of_safety(facts)
                       : facts.platen_stage   ? strength(facts)
                                              : equilibrium(facts);
    answer.firm = answer.firm && facts.tables_are_whole;
    add_end(facts, answer.warnings);
    add_doubts(facts, answer.warnings);
    if (facts.summary)
        answer.warnings.insert(answer.warnings.end(), facts.summary->warnings.begin(), facts.summary->warnings.end());
    return answer;
}

} // namespace kluft
