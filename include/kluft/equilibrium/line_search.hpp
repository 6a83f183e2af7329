// How far to go along an increment dq: the step length s in (0, 1] (docs/theory.md, "Open-close iteration").
#pragma once

#include <cmath>

#include "kluft/core/bracket.hpp"

namespace kluft {

inline constexpr int max_line_search_trials = 8;  ///< residuals of one search, that of the full step not counted
inline constexpr double accepted_end_slope = 0.3; ///< of |g(0)|: the full step is taken
inline constexpr double accepted_root_slope = 0.1;
inline constexpr double line_search_margin = 0.05; ///< of the bracket's width
inline constexpr double least_fall = 1e-4;         ///< of the norm, by a full step

/// Seeks the root of g(s) = R(q + s dq) . dq, the work along the increment (29). `slope(s)` gives g(s); `slope_at_zero`
/// is g(0) < 0. The first s that it asks for is 1.
template <class Slope> [[nodiscard]] double step_to_root(double slope_at_zero, Slope slope) {
    const double scale = std::abs(slope_at_zero);
    Bracket bracket{.low = 0.0, .high = 1.0, .g_low = slope_at_zero, .g_high = slope(1.0)};
    double s = bracket.high;
    if (bracket.g_high <= accepted_end_slope * scale) return s;
    for (int i = 0; i < max_line_search_trials; ++i) {
        s = bracket.propose(line_search_margin);
        const double g = slope(s);
        if (std::abs(g) < accepted_root_slope * scale) break;
        bracket.take(s, g);
    }
    return s;
}

/// Halves s = 1 until |R| falls; if it never does, the s with the smallest norm is returned. `norm(s)` gives
/// |R(q + s dq)|.
template <class Norm> [[nodiscard]] double step_by_halving(double norm_at_zero, Norm norm) {
    double best = 1.0;
    double best_norm = 0.0;
    double s = 1.0;
    for (int i = 0; i < max_line_search_trials; ++i, s *= 0.5) {
        const double at_s = norm(s);
        if (i == 0 || at_s < best_norm) {
            best = s;
            best_norm = at_s;
        }
        if (at_s < (1.0 - least_fall * s) * norm_at_zero) break;
    }
    return best;
}

} // namespace kluft
