// The root of a function between two points by regula falsi with halved values, after the Illinois variant (Dowell and
// Jarratt 1971).
#pragma once

#include <algorithm>

namespace kluft {

/// An interval at whose ends g has different signs, g(low) < 0 <= g(high). It evaluates nothing: who seeks the root
/// asks where to, and gives back what g is there,
///
///     while (bracket.width() > enough) {
///         const double x = bracket.propose(0.01);
///         bracket.take(x, g(x));
///     }
struct Bracket {
    double low = 0.0;
    double high = 1.0;
    double g_low = 0.0;  ///< g(low), halved for every point taken since
    double g_high = 0.0; ///< g(high), in the same way

    [[nodiscard]] double width() const { return high - low; }

    /// Where the straight line between the ends is zero, and at least `margin` of the width inside either: with a
    /// margin the width falls at each step, whatever g is.
    [[nodiscard]] double propose(double margin) const {
        const double root = high - g_high * width() / (g_high - g_low);
        return std::clamp(root, low + margin * width(), high - margin * width());
    }

    /// Makes x one of the ends, by the sign of g there, and halves the value of the other: no end stays for ever.
    /// Dowell and Jarratt halve it only from the second time on that the same end stays.
    void take(double x, double g) {
        if (g >= 0.0) {
            high = x;
            g_high = g;
            g_low *= 0.5;
        } else {
            low = x;
            g_low = g;
            g_high *= 0.5;
        }
    }
};

} // namespace kluft
