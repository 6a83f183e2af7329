// Strength parameters from tests: Mohr-Coulomb's line, tension cut-off and Hoek-Brown's curve by least squares, with
// standard errors. The equations stand in docs/theory.md, (36) to (39).
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "kluft/core/vector.hpp"

namespace kluft {

/// The peak of a test. Pa, positive in compression.
struct PeakPoint {
    std::string run;
    double sigma_3 = 0.0;     ///< smaller principal stress at the peak; of a compression test the lateral stress
    double sigma_1 = 0.0;     ///< larger principal stress at the peak; of a compression test the axial stress
    bool peak_reached = true; ///< false: the stress had neither fallen nor levelled off
    bool balanced = true;     ///< false: the run ended out of balance
    bool net_locked = false;  ///< loose blocks of the net of potential cracks carried the load, as masonry does
    bool moves_platen = true; ///< false: a run under given loads, which has no strength of a test
    bool unloaded = false; ///< the lateral stress had been lowered before the stress fell: it failed under another one
};

/// What a test says about the strength.
enum class PeakUse {
    strength, ///< a point of the compressive strength, sigma_3 >= 0
    tension,  ///< a tensile strength, sigma_3 = -sigma_t < 0
    bound     ///< no strength: no platen, sides unloaded, not yet falling, out of balance or locked
};

[[nodiscard]] PeakUse use_of(const PeakPoint& point);
/// "moves no platen", "sides unloaded", "not yet falling", "unbalanced", "net locked", or "" for a strength.
[[nodiscard]] std::string bound_reason(const PeakPoint& point);

/// A number from measurements with its standard error, which is unknown where nothing is left over to tell the scatter.
struct Estimate {
    double value = 0.0;
    std::optional<double> error;
};

/// How near a least-squares line or curve comes to its points.
struct Residuals {
    std::size_t n_points = 0;
    double rms = 0.0;       ///< root of the mean square of what sigma_1 differs by (Pa)
    double r_squared = 1.0; ///< share of the variance of the ordinate that the regression explains
};

/// Mohr-Coulomb's line sigma_1 = 2 c cos(phi)/(1 - sin(phi)) + sigma_3 (1 + sin(phi))/(1 - sin(phi)).
struct Envelope {
    double cohesion = 0.0;          ///< Pa
    double friction_angle = 0.0;    ///< radians
    std::optional<Mat2> covariance; ///< of cohesion and friction angle (Pa, radians); none of two points
    Residuals residuals;

    [[nodiscard]] double sigma_1(double sigma_3) const;
    /// Shear strength c + sigma tan(phi) on a plane under the normal stress sigma (Pa).
    [[nodiscard]] double shear_strength(double sigma) const;
    [[nodiscard]] std::optional<double> cohesion_error() const;       ///< standard error (Pa)
    [[nodiscard]] std::optional<double> friction_angle_error() const; ///< standard error (radians)
    /// Half-width of the 95 % confidence interval of the shear strength at sigma: its standard error by the delta method
    /// times Student's t of n - 2 degrees of freedom (Pa). Nothing where the errors are unknown.
    [[nodiscard]] std::optional<double> confidence(double sigma) const;
};

/// Least squares of sigma_1 = q sigma_3 + b over the strengths among the points, each sigma_1 with the same variance
/// s^2 = sum of squared residuals/(n - 2). With q = tan^2(45 deg + phi/2), b = 2 c sqrt(q), the covariance of c and phi follows from
/// that of q and b by the delta method:
///   dc = db/(2 sqrt(q)) - b dq/(4 q sqrt(q)),   dphi = dq/((q + 1) sqrt(q)).
/// Throws InputError with fewer than two different sigma_3 among the strengths (saying what is a bound or in tension)
/// or when no Mohr-Coulomb line fits (slope not above zero).
[[nodiscard]] Envelope fit_envelope(const std::vector<PeakPoint>& points);

/// Hoek-Brown's curve of intact rock, s = 1, a = 1/2: sigma_1 = sigma_3 + sigma_ci (m_i sigma_3/sigma_ci + 1)^(1/2)
/// (Hoek and Brown 1980, 2019).
struct HoekBrown {
    Estimate sigma_ci; ///< uniaxial compressive strength (Pa)
    Estimate m_i;
    Residuals residuals; ///< r_squared that of (sigma_1 - sigma_3)^2

    /// For sigma_3 from lowest_sigma_3() on.
    [[nodiscard]] double sigma_1(double sigma_3) const;
    /// -sigma_ci/m_i: below it the curve has no value.
    [[nodiscard]] double lowest_sigma_3() const { return -sigma_ci.value / m_i.value; }
};

/// Either the curve or why there is none.
struct HoekBrownFit {
    std::optional<HoekBrown> curve;
    std::string problem;
};

/// Hoek and Brown's (1980) linear regression of (sigma_1 - sigma_3)^2 = m_i sigma_ci sigma_3 + sigma_ci^2 over the
/// strengths among the points, with standard errors by the delta method. There is no curve with fewer than three
/// different sigma_3 (those within 1 % of their range count once) and where sigma_ci^2 or m_i is not above zero.
[[nodiscard]] HoekBrownFit fit_hoek_brown(const std::vector<PeakPoint>& points);

/// Mean of -sigma_3 over the tension tests with its standard error s/sqrt(n), unknown of a single one. Nothing without
/// tension tests.
[[nodiscard]] std::optional<Estimate> fit_tensile_strength(const std::vector<PeakPoint>& points);

/// All of these.
struct StrengthFit {
    Envelope envelope;
    std::optional<Estimate> tensile_strength; ///< Pa, positive
    HoekBrownFit hoek_brown;
};

/// A tensile strength that is round-off beside the largest stress is zero. Throws as fit_envelope does.
[[nodiscard]] StrengthFit fit_strength(const std::vector<PeakPoint>& points);

/// Whether a test carried more than the fitted strength though it did not reach its own: its sigma_1 is above the line, or in
/// tension its -sigma_3 above the tensile strength. Never of a strength, nor of a locked net, whose load is not the rock's, nor of a
/// run without a platen.
[[nodiscard]] bool contradicts(const PeakPoint& bound, const StrengthFit& fit);

/// Where Mohr's circle of a curve's sigma_3, sigma_1 touches its envelope, `slope` being d sigma_1/d sigma_3 > 0 (Balmer
/// 1952): normal stress sigma_3 + (sigma_1 - sigma_3)/(slope + 1), shear stress (sigma_1 - sigma_3) sqrt(slope)/(slope + 1).
[[nodiscard]] Vec2 point_of_contact(double sigma_3, double sigma_1, double slope);

} // namespace kluft
