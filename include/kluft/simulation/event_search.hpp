// Where, on the way to a load factor, a failure index reaches one (docs/theory.md, events).
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>
#include <utility>

#include "kluft/core/bracket.hpp"

namespace kluft {

/// What an event is searched for with.
struct EventGoal {
    double last_without = 1.0; ///< up to this index at the end there is no event
    double index = 1.0;        ///< that the event should have
    double reach = 0.0;        ///< how far from it is near enough
    double least_width = 0.0;  ///< load factors between which an event is not searched any further
};

/// An equilibrium at an event, or at the end where there is none.
template <class Equilibrium> struct EventCut {
    Equilibrium found;
    /// Load factors that enclose the event, where it was not met; infinite elsewhere.
    double width = std::numeric_limits<double>::infinity();
};

inline constexpr int quick_event_trials = 12; ///< then the interval is halved: a kink of the index may be crept up to
inline constexpr int max_event_trials = 60;
inline constexpr int max_trials_without = 6;         ///< an equilibrium
inline constexpr double largest_useful_index = 10.0; ///< a strength of zero makes f infinite

/// Where in the bracket the next trial of a search is made.
[[nodiscard]] inline double event_trial(const Bracket& bracket, int trial) {
    return trial < quick_event_trials ? bracket.propose(0.01) : bracket.low + 0.5 * bracket.width();
}

/// The first event in (from, end.load_factor]. `index_of(equilibrium)` and `index_at_start()` evaluate the index, each
/// under the loads of its own load factor; `find_at(load_factor, share, end)` searches an equilibrium between the start
/// (share 0) and `end` (share 1). Illinois on the load factor. Where a trial has no balanced result, one at a smaller load
/// factor follows; where the event stays among those, the last equilibrium before it is returned, if one was found.
template <class Equilibrium, class IndexOf, class IndexAtStart, class FindAt>
EventCut<Equilibrium> first_event(const EventGoal& goal, double from, Equilibrium end, IndexOf index_of,
                                  IndexAtStart index_at_start, FindAt find_at) {
    const double at_end = index_of(end);
    if (at_end <= goal.last_without) return {std::move(end)};
    Bracket bracket{from, end.load_factor, index_at_start() - goal.index, at_end - goal.index};
    if (bracket.g_low >= 0.0) return {std::move(end)};
    double without = bracket.high; // the least load factor at which no equilibrium was found
    int n_without = 0;
    std::optional<Equilibrium> before; // the last one before the event
    for (int i = 0; i < max_event_trials && bracket.width() > goal.least_width; ++i) {
        double at = event_trial(bracket, i);
        if (at >= without) at = std::midpoint(bracket.low, without);
        Equilibrium next = find_at(at, (at - from) / (bracket.high - from), end);
        if (!next.balanced) {
            without = at;
            if (++n_without > max_trials_without) break;
            continue;
        }
        const double g = index_of(next) - goal.index;
        const bool is_event = std::abs(g) <= goal.reach;
        if (is_event) return {std::move(next)};
        bracket.take(at, g);
        (bracket.high == at ? end : before.emplace()) = std::move(next);
    }
    if (without < bracket.high && before) return {std::move(*before)}; // the event lies where no equilibrium was found
    return {std::move(end), bracket.width()};
}

/// The part of the way to its end (0..1) at which an index is expected to reach one. `index_at(share)`; the index at the
/// end is above one by more than `tolerance`, and that at the start below one, or the answer is 1.
template <class IndexAt> double expected_event(double tolerance, IndexAt index_at) {
    Bracket bracket{0.0, 1.0, index_at(0.0) - 1.0, index_at(1.0) - 1.0};
    if (bracket.g_high <= tolerance || bracket.g_low >= 0.0) return 1.0;
    double at = bracket.high;
    for (int i = 0; i < quick_event_trials && std::abs(bracket.g_high) > 0.1 * tolerance; ++i) {
        at = bracket.propose(0.0);
        bracket.take(at, index_at(at) - 1.0);
    }
    return at;
}

} // namespace kluft
