// Statistics of copies of a run: mean, scatter, confidence, and the band of their curves.
#pragma once

#include <optional>
#include <vector>

#include "kluft/core/vector.hpp"

namespace kluft {

/// The value that Student's t with n_freedom degrees of freedom exceeds with probability (1 - confidence)/2.
[[nodiscard]] double student_quantile(int n_freedom, double confidence);

struct EnsembleStatistics {
    int n = 0;
    double mean = 0.0;
    double deviation = 0.0;           ///< standard deviation, with n - 1
    std::optional<double> half_width; ///< of the 95 % confidence interval of the mean: t s/sqrt(n); none for n < 2
};

[[nodiscard]] EnsembleStatistics ensemble_statistics(const std::vector<double>& values);

/// Members that it takes until t s/sqrt(n) is at most `half_width` with 95 % confidence, t with n - 1 degrees of
/// freedom; both relative to the mean. At least 2, at most 1 000 000.
[[nodiscard]] int members_needed(double relative_deviation, double half_width);

/// Mean and standard deviation of several curves over a common grid.
struct CurveBand {
    std::vector<double> x;
    std::vector<double> mean;
    std::vector<double> deviation;
};

/// Of curves y(x) with ascending x, linear between their points, at `n_points` places from where all have begun to
/// where the first ends. Empty with fewer than two curves or without a common range.
[[nodiscard]] CurveBand curve_band(const std::vector<std::vector<Vec2>>& curves, int n_points);

} // namespace kluft
