#include "kluft/output/envelope.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "kluft/core/diagnostics.hpp"
#include "kluft/core/units.hpp"
#include "kluft/output/atomic_file.hpp"
#include "kluft/output/summary.hpp"

namespace kluft {

namespace {

/// Slope and intercept of sigma_1 over sigma_3.
std::pair<double, double> fitted_line(const std::vector<PeakPoint>& points) {
    const auto n = static_cast<double>(points.size());
    double x_mean = 0.0;
    double y_mean = 0.0;
    for (const PeakPoint& point : points) {
        x_mean += point.sigma_3 / n;
        y_mean += point.sigma_1 / n;
    }
    double xx = 0.0;
    double xy = 0.0;
    double largest = 0.0;
    for (const PeakPoint& point : points) {
        xx += (point.sigma_3 - x_mean) * (point.sigma_3 - x_mean);
        xy += (point.sigma_3 - x_mean) * (point.sigma_1 - y_mean);
        largest = std::max({largest, std::abs(point.sigma_3), std::abs(point.sigma_1)});
    }
    constexpr double distinct = 1e-6; // of the largest stress
    if (points.size() < 2 || std::sqrt(xx) <= distinct * largest)
        throw InputError("an envelope needs at least two runs with different lateral stresses");
    const double slope = xy / xx;
    return {slope, y_mean - slope * x_mean};
}

} // namespace

double Envelope::sigma_1(double sigma_3) const {
    const double sine = std::sin(friction_angle);
    return (2.0 * cohesion * std::cos(friction_angle) + sigma_3 * (1.0 + sine)) / (1.0 - sine);
}

PeakPoint peak_point(const std::string& run, const std::vector<StepRecord>& equilibria) {
    const auto peak = peak_row(equilibria, std::nullopt);
    if (!peak) throw InputError(run + ": no balanced equilibrium, so no peak");
    const auto numbers = curve_numbers(equilibria, {}, std::nullopt, Plane::strain);
    return {run, peak->lateral_stress, peak->axial_stress, numbers.peak_reached, peak_remark(numbers)};
}

Envelope fit_envelope(const std::vector<PeakPoint>& points) {
    const auto [slope, intercept] = fitted_line(points);
    if (!(slope > 0.0))
        throw InputError(fmt::format("no Mohr-Coulomb envelope fits: sigma_1 changes by {:.3g} per sigma_3, which must "
                                     "be above 0",
                                     slope));
    // slope = (1 + sin)/(1 - sin) = tan^2(45 deg + phi/2); intercept = 2 c cos/(1 - sin) = 2 c sqrt(slope)
    return {0.5 * intercept / std::sqrt(slope), std::asin((slope - 1.0) / (slope + 1.0))};
}

std::string envelope_csv(const std::vector<PeakPoint>& points, const Envelope& fit) {
    std::string text = "run,sigma_3,sigma_1,fitted_sigma_1,peak_reached\n";
    for (const PeakPoint& point : points)
        text += fmt::format("{},{:.17g},{:.17g},{:.17g},{}\n", point.run, point.sigma_3, point.sigma_1,
                            fit.sigma_1(point.sigma_3), point.peak_reached ? 1 : 0);
    return text;
}

std::string envelope_text(const std::vector<PeakPoint>& points, const Envelope& fit) {
    std::size_t width = 3;
    for (const PeakPoint& point : points) width = std::max(width, point.run.size());
    std::string text = fmt::format("{:<{}}  sigma_3 (MPa)  sigma_1 (MPa)  fitted (MPa)\n", "run", width);
    for (const PeakPoint& point : points)
        text += fmt::format("{:<{}}  {:13.4f}  {:13.4f}  {:12.4f}{}{}\n", point.run, width, point.sigma_3 / mega,
                            point.sigma_1 / mega, fit.sigma_1(point.sigma_3) / mega, point.peak_reached ? "" : "  ",
                            point.remark);
    return text + fmt::format("cohesion {:.4f} MPa, friction angle {:.2f} deg\n", fit.cohesion / mega,
                              fit.friction_angle * degrees);
}

void write_envelope(const std::filesystem::path& path, const std::string& title, const std::vector<PeakPoint>& points,
                    const Envelope& fit, const std::vector<NamedEnvelope>& others) {
    write_file(path, draw_envelope(title, points, fit, others, picture_format(path)));
}

} // namespace kluft
