#include "kluft/studies/ensemble.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <boost/math/distributions/students_t.hpp>

namespace kluft {

namespace {

constexpr double usual_confidence = 0.95;
constexpr int most_members = 1'000'000;

/// Linear between the points of an ascending curve that contains x.
double value_at(const std::vector<Vec2>& curve, double x) {
    auto after = std::ranges::lower_bound(curve, x, {}, [](const Vec2& point) { return point.x(); });
    if (after == curve.end()) return curve.back().y();
    if (after == curve.begin()) return curve.front().y();
    const Vec2& b = *after;
    const Vec2& a = *(after - 1);
    return b.x() > a.x() ? a.y() + (b.y() - a.y()) * (x - a.x()) / (b.x() - a.x()) : b.y();
}

double half_width_of_mean(double deviation, int n) {
    return student_quantile(n - 1, usual_confidence) * deviation / std::sqrt(static_cast<double>(n));
}

} // namespace

double student_quantile(int n_freedom, double confidence) {
    const boost::math::students_t distribution(static_cast<double>(n_freedom));
    return boost::math::quantile(boost::math::complement(distribution, 0.5 * (1.0 - confidence)));
}

EnsembleStatistics ensemble_statistics(const std::vector<double>& values) {
    EnsembleStatistics statistics;
    statistics.n = static_cast<int>(values.size());
    if (values.empty()) return statistics;
    for (const double value : values) statistics.mean += value / static_cast<double>(values.size());
    if (values.size() < 2) return statistics;
    double sum = 0.0;
    for (const double value : values) sum += (value - statistics.mean) * (value - statistics.mean);
    statistics.deviation = std::sqrt(sum / static_cast<double>(values.size() - 1));
    statistics.half_width = half_width_of_mean(statistics.deviation, statistics.n);
    return statistics;
}

int members_needed(double relative_deviation, double half_width) {
    int low = 2; // the half-width falls with n: bisection between a number that is too small and one that is enough
    if (half_width_of_mean(relative_deviation, low) <= half_width) return low;
    int high = most_members;
    if (half_width_of_mean(relative_deviation, high) > half_width) return high;
    while (high - low > 1) {
        const int middle = low + (high - low) / 2;
        (half_width_of_mean(relative_deviation, middle) <= half_width ? high : low) = middle;
    }
    return high;
}

CurveBand curve_band(const std::vector<std::vector<Vec2>>& curves, int n_points) {
    CurveBand band;
    if (curves.size() < 2 || n_points < 2) return band;
    double begin = -std::numeric_limits<double>::infinity();
    double end = std::numeric_limits<double>::infinity();
    for (const auto& curve : curves) {
        if (curve.empty()) return band;
        begin = std::max(begin, curve.front().x());
        end = std::min(end, curve.back().x());
    }
    if (!(end > begin)) return band;
    for (int i = 0; i < n_points; ++i) {
        const double x = begin + (end - begin) * i / (n_points - 1);
        std::vector<double> values;
        for (const auto& curve : curves) values.push_back(value_at(curve, x));
        const EnsembleStatistics statistics = ensemble_statistics(values);
        band.x.push_back(x);
        band.mean.push_back(statistics.mean);
        band.deviation.push_back(statistics.deviation);
    }
    return band;
}

} // namespace kluft
