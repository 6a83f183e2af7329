#include "kluft/constitutive/strength_fit.hpp"

#include <algorithm>
#include <cmath>

#include <boost/math/distributions/students_t.hpp>
#include <fmt/format.h>

#include "kluft/constitutive/strength_envelope.hpp"
#include "kluft/core/diagnostics.hpp"
#include "kluft/core/units.hpp"

namespace kluft {

namespace {

bool in_tension(const PeakPoint& point) {
    constexpr double rounding = 1e-9;
    return point.sigma_3 < -rounding * std::abs(point.sigma_1);
}

std::vector<PeakPoint> used_as(PeakUse use, const std::vector<PeakPoint>& points) {
    std::vector<PeakPoint> chosen;
    for (const PeakPoint& point : points)
        if (use_of(point) == use) chosen.push_back(point);
    return chosen;
}

/// y = intercept + slope x.
struct RegressionLine {
    double slope = 0.0;
    double intercept = 0.0;
    std::optional<Mat2> covariance; ///< of slope and intercept; none of two points
    double r_squared = 1.0;
};

/// Least squares over points (x, y) of which at least two x differ.
RegressionLine regression(const std::vector<Vec2>& points) {
    const auto n = static_cast<double>(points.size());
    Vec2 mean = Vec2::Zero();
    for (const Vec2& point : points) mean += point / n;
    double xx = 0.0;
    double xy = 0.0;
    double yy = 0.0;
    for (const Vec2& point : points) {
        const Vec2 from_mean = point - mean;
        xx += from_mean.x() * from_mean.x();
        xy += from_mean.x() * from_mean.y();
        yy += from_mean.y() * from_mean.y();
    }
    RegressionLine line{.slope = xy / xx};
    line.intercept = mean.y() - line.slope * mean.x();
    double left_over = 0.0;
    for (const Vec2& point : points) {
        const double residual = point.y() - mean.y() - line.slope * (point.x() - mean.x());
        left_over += residual * residual;
    }
    if (yy > 0.0) line.r_squared = 1.0 - left_over / yy;
    if (points.size() > 2) {
        const double variance = left_over / (n - 2.0);
        Mat2 covariance;
        covariance << 1.0 / xx, -mean.x() / xx, -mean.x() / xx, 1.0 / n + mean.x() * mean.x() / xx;
        line.covariance = variance * covariance;
    }
    return line;
}

template <class Curve>
Residuals residuals_of(const Curve& curve, double r_squared, const std::vector<PeakPoint>& points) {
    double sum = 0.0;
    for (const PeakPoint& point : points) {
        const double residual = point.sigma_1 - curve.sigma_1(point.sigma_3);
        sum += residual * residual;
    }
    return {points.size(), std::sqrt(sum / static_cast<double>(points.size())), r_squared};
}

/// sigma_3 that differ by more than 1 % of their range.
std::size_t n_different(const std::vector<PeakPoint>& points) {
    if (points.empty()) return 0;
    std::vector<double> values;
    for (const PeakPoint& point : points) values.push_back(point.sigma_3);
    std::ranges::sort(values);
    const double distinct = 0.01 * (values.back() - values.front());
    std::size_t n = 1;
    double last = values.front();
    for (const double value : values) {
        if (value - last <= distinct) continue;
        last = value;
        ++n;
    }
    return n;
}

bool has_two_lateral_stresses(const std::vector<PeakPoint>& strengths) {
    if (strengths.empty()) return false;
    constexpr double distinct = 1e-6;   // of the largest stress
    constexpr double smallest = 1e-100; // Pa; the square of less is not a number any more
    double low = strengths.front().sigma_3;
    double high = low;
    double largest = 0.0;
    for (const PeakPoint& point : strengths) {
        low = std::min(low, point.sigma_3);
        high = std::max(high, point.sigma_3);
        largest = std::max({largest, std::abs(point.sigma_3), std::abs(point.sigma_1)});
    }
    return high - low > std::max(distinct * largest, smallest);
}

std::string too_few_strengths(const std::vector<PeakPoint>& points, std::size_t n_strengths) {
    std::string text = "an envelope needs at least two runs with different lateral stresses that reached their peaks";
    if (n_strengths == points.size()) return text;
    text += fmt::format(": found {}", n_strengths);
    for (const PeakPoint& point : points) {
        const PeakUse use = use_of(point);
        if (use == PeakUse::bound) text += fmt::format("; {}: {}", point.run, bound_reason(point));
        if (use == PeakUse::tension) text += fmt::format("; {}: in tension", point.run);
    }
    return text;
}

/// Standard error of a number whose derivatives by slope and intercept are given.
std::optional<double> delta_error(const std::optional<Mat2>& covariance, const Vec2& derivatives) {
    if (!covariance) return std::nullopt;
    return std::sqrt(std::max(0.0, derivatives.dot(*covariance * derivatives)));
}

} // namespace

PeakUse use_of(const PeakPoint& point) {
    if (!bound_reason(point).empty()) return PeakUse::bound;
    return in_tension(point) ? PeakUse::tension : PeakUse::strength;
}

std::string bound_reason(const PeakPoint& point) {
    if (!point.moves_platen) return "moves no platen";
    if (point.net_locked) return "net locked";
    if (point.unloaded) return "sides unloaded";
    if (!point.peak_reached) return "not yet falling";
    return point.balanced ? "" : "unbalanced";
}

double Envelope::sigma_1(double sigma_3) const {
    return compressive_strength({.cohesion = cohesion, .friction_angle = friction_angle}, sigma_3);
}

double Envelope::shear_strength(double sigma) const { return cohesion + sigma * std::tan(friction_angle); }

std::optional<double> Envelope::cohesion_error() const { return delta_error(covariance, Vec2(1.0, 0.0)); }

std::optional<double> Envelope::friction_angle_error() const { return delta_error(covariance, Vec2(0.0, 1.0)); }

std::optional<double> Envelope::confidence(double sigma) const {
    if (residuals.n_points < 3) return std::nullopt;
    const double cosine = std::cos(friction_angle);
    const auto error = delta_error(covariance, Vec2(1.0, sigma / (cosine * cosine)));
    if (!error) return std::nullopt;
    constexpr double one_sided = 0.975;
    const boost::math::students_t student(static_cast<double>(residuals.n_points) - 2.0);
    return boost::math::quantile(student, one_sided) * *error;
}

Envelope fit_envelope(const std::vector<PeakPoint>& points) {
    const auto strengths = used_as(PeakUse::strength, points);
    if (!has_two_lateral_stresses(strengths)) throw InputError(too_few_strengths(points, strengths.size()));
    std::vector<Vec2> pairs;
    for (const PeakPoint& point : strengths) pairs.emplace_back(point.sigma_3, point.sigma_1);
    const RegressionLine line = regression(pairs);
    const double q = line.slope;
    if (!(q > 0.0))
        throw InputError(fmt::format("no Mohr-Coulomb envelope fits: sigma_1 changes by {:.3g} per sigma_3, which must "
                                     "be above 0",
                                     q));
    const double root = std::sqrt(q);
    Envelope envelope{.cohesion = 0.5 * line.intercept / root, .friction_angle = std::asin((q - 1.0) / (q + 1.0))};
    if (line.covariance) {
        Mat2 derivatives; // of c and phi (rows) by q and b (columns)
        derivatives << -0.25 * line.intercept / (q * root), 0.5 / root, 1.0 / ((q + 1.0) * root), 0.0;
        envelope.covariance = derivatives * *line.covariance * derivatives.transpose();
    }
    envelope.residuals = residuals_of(envelope, line.r_squared, strengths);
    return envelope;
}

double HoekBrown::sigma_1(double sigma_3) const {
    return sigma_3 + sigma_ci.value * std::sqrt(std::max(0.0, m_i.value * sigma_3 / sigma_ci.value + 1.0));
}

HoekBrownFit fit_hoek_brown(const std::vector<PeakPoint>& points) {
    const auto strengths = used_as(PeakUse::strength, points);
    const std::size_t n = n_different(strengths);
    constexpr std::size_t n_needed = 3;
    if (n < n_needed) return {{}, fmt::format("{} different sigma_3, at least {} are needed", n, n_needed)};
    std::vector<Vec2> pairs;
    for (const PeakPoint& point : strengths) {
        const double difference = point.sigma_1 - point.sigma_3;
        pairs.emplace_back(point.sigma_3, difference * difference);
    }
    const RegressionLine line = regression(pairs);
    if (!(line.intercept > 0.0))
        return {{}, fmt::format("sigma_ci^2 = {:.3g} MPa^2 is not above 0", line.intercept / (mega * mega))};
    const double sigma_ci = std::sqrt(line.intercept);
    const double m_i = line.slope / sigma_ci;
    if (!(m_i > 0.0)) return {{}, fmt::format("m_i = {:.3g} is not above 0", m_i)};
    HoekBrown curve;
    curve.sigma_ci = {sigma_ci, delta_error(line.covariance, Vec2(0.0, 0.5 / sigma_ci))};
    curve.m_i = {m_i, delta_error(line.covariance, Vec2(1.0 / sigma_ci, -0.5 * m_i / line.intercept))};
    curve.residuals = residuals_of(curve, line.r_squared, strengths);
    return {curve, ""};
}

std::optional<Estimate> fit_tensile_strength(const std::vector<PeakPoint>& points) {
    const auto tests = used_as(PeakUse::tension, points);
    if (tests.empty()) return std::nullopt;
    const auto n = static_cast<double>(tests.size());
    double mean = 0.0;
    for (const PeakPoint& test : tests) mean -= test.sigma_3 / n;
    if (tests.size() < 2) return Estimate{mean, std::nullopt};
    double squares = 0.0;
    for (const PeakPoint& test : tests) squares += (-test.sigma_3 - mean) * (-test.sigma_3 - mean);
    return Estimate{mean, std::sqrt(squares / (n - 1.0) / n)};
}

StrengthFit fit_strength(const std::vector<PeakPoint>& points) {
    StrengthFit fit{fit_envelope(points), fit_tensile_strength(points), fit_hoek_brown(points)};
    constexpr double round_off = 1e-12; // of the largest stress
    double largest = 0.0;
    for (const PeakPoint& point : points) largest = std::max(largest, std::abs(point.sigma_1));
    if (fit.tensile_strength && fit.tensile_strength->value < round_off * largest) fit.tensile_strength->value = 0.0;
    return fit;
}

bool contradicts(const PeakPoint& bound, const StrengthFit& fit) {
    if (use_of(bound) != PeakUse::bound || bound.net_locked || !bound.moves_platen) return false;
    if (in_tension(bound)) return fit.tensile_strength && -bound.sigma_3 > fit.tensile_strength->value;
    return bound.sigma_1 > fit.envelope.sigma_1(bound.sigma_3);
}

Vec2 point_of_contact(double sigma_3, double sigma_1, double slope) {
    const double distance = (sigma_1 - sigma_3) / (slope + 1.0);
    return {sigma_3 + distance, distance * std::sqrt(slope)};
}

} // namespace kluft
