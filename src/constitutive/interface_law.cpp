#include "kluft/constitutive/interface_law.hpp"

#include <algorithm>
#include <cmath>

namespace kluft {

namespace {

/// Rounded |t_s|/limit as a function of x = |trial|/limit, and its derivative.
struct RoundedShear {
    double value;
    double slope;
};

RoundedShear rounded_shear(double x, double s) {
    if (x <= 1.0 - s) return {x, 1.0};
    if (x >= 1.0 + s) return {1.0, 0.0};
    const double rest = 1.0 + s - x;
    return {1.0 - rest * rest / (4.0 * s), rest / (2.0 * s)};
}

/// Plastic slip beyond the rounding: the root of k_s d = max(0, |trial| - (1 + s) limit(gap - tan(psi) d)), whose
/// left side minus right side increases with d. Newton from d = 0, kept inside a bracket (17).
template <class LimitAtGap>
double plastic_slip(const InterfaceLaw& law, double trial, double elastic_gap, double factor, LimitAtGap limit_at_gap) {
    const auto limit_at = [&](double d) { return limit_at_gap(elastic_gap - law.tan_dilation * d); };
    if (trial <= factor * limit_at(0.0).value) return 0.0;
    double low = 0.0;
    double high = trial / law.shear_stiffness;
    double d = low;
    for (int i = 0; i < 60; ++i) {
        const auto limit = limit_at(d);
        const double value = trial - factor * limit.value - law.shear_stiffness * d;
        (value > 0.0 ? low : high) = d;
        const double slope = factor * limit.by_gap * law.tan_dilation - law.shear_stiffness;
        double next = d - value / slope;
        if (next <= low || next >= high) next = 0.5 * (low + high);
        if (std::abs(next - d) <= 1e-15 * high) return next;
        d = next;
    }
    return d;
}

/// The contact pressure, negative where the gap is open: it vanishes at the end of the closed part.
ContactPressure signed_pressure(const InterfaceLaw& law, double gap) {
    if (gap < 0.0) return contact_pressure(law, gap);
    return {-law.normal_stiffness * gap, -law.normal_stiffness};
}

/// The share of the cohesion that acts at a pressure, its integral from there down to zero, and its derivative.
struct CohesionShare {
    CohesionShare(double pressure, double onset) {
        if (pressure <= 0.0) return;
        const bool whole = pressure >= onset;
        value = whole ? 1.0 : pressure / onset;
        integral = whole ? pressure - 0.5 * onset : 0.5 * pressure * pressure / onset;
        slope = whole ? 0.0 : 1.0 / onset;
    }
    double value = 0.0;
    double integral = 0.0;
    double slope = 0.0;
};

/// Mean share of the cohesion over a piece along which the pressure is linear (15), and its derivatives with respect to the
/// pressures at its ends.
struct MeanShare {
    MeanShare(double from, double to, double onset) {
        const double largest = std::max({std::abs(from), std::abs(to), onset});
        if (std::abs(to - from) <= even_pressure * largest) {
            const CohesionShare middle(0.5 * (from + to), onset);
            value = middle.value;
            by_from = by_to = 0.5 * middle.slope;
            return;
        }
        const CohesionShare first(from, onset);
        const CohesionShare last(to, onset);
        value = (last.integral - first.integral) / (to - from);
        by_from = (value - first.value) / (to - from);
        by_to = (last.value - value) / (to - from);
    }
    static constexpr double even_pressure = 1e-6; ///< difference over a piece, relative, that is none
    double value = 0.0;
    double by_from = 0.0;
    double by_to = 0.0;
};

ShearLimit limit_under(const InterfaceLaw& law, const ContactPressure& pressure, double elastic_gap,
                       const ContactPiece& piece) {
    ShearLimit limit{pressure.value * law.tan_friction, law.tan_friction * pressure.slope, 0.0};
    if (law.cohesion == 0.0) return limit;
    const auto from = signed_pressure(law, elastic_gap + piece.from * piece.tilt);
    const auto to = signed_pressure(law, elastic_gap + piece.to * piece.tilt);
    const MeanShare share(from.value, to.value, law.cohesion_onset);
    limit.value += law.cohesion * share.value;
    limit.by_gap += law.cohesion * (share.by_from * from.slope + share.by_to * to.slope);
    limit.by_tilt = law.cohesion * (piece.from * share.by_from * from.slope + piece.to * share.by_to * to.slope);
    return limit;
}

} // namespace

ContactPressure contact_pressure(const InterfaceLaw& law, double gap) {
    if (gap >= 0.0) return {0.0, 0.0};
    const double g0 = law.contact_rounding / law.normal_stiffness;
    if (gap <= -2.0 * g0) return {-law.normal_stiffness * (gap + g0), -law.normal_stiffness};
    return {law.normal_stiffness * gap * gap / (4.0 * g0), law.normal_stiffness * gap / (2.0 * g0)};
}

double contact_energy(const InterfaceLaw& law, double gap) {
    if (gap >= 0.0) return 0.0;
    const double k = law.normal_stiffness;
    const double g0 = law.contact_rounding / k;
    if (gap > -2.0 * g0) return -k * gap * gap * gap / (12.0 * g0);
    return 0.5 * k * (gap + g0) * (gap + g0) + k * g0 * g0 / 6.0;
}

ShearLimit shear_limit(const InterfaceLaw& law, double elastic_gap, const ContactPiece& piece) {
    return limit_under(law, contact_pressure(law, elastic_gap), elastic_gap, piece);
}

PointTraction fracture_traction(const InterfaceLaw& law, const PointHistory& start, double gap, double slip,
                                const ContactPiece& piece, const std::optional<double>& held_limit) {
    const auto limit_at = [&](double elastic_gap) {
        return held_limit ? ShearLimit{*held_limit, 0.0, 0.0} : shear_limit(law, elastic_gap, piece);
    };
    PointTraction result;
    result.history.dilation = start.dilation;
    const double trial = start.shear_trial + law.shear_stiffness * slip;
    const double sign = trial < 0.0 ? -1.0 : 1.0;
    const double factor = 1.0 + law.friction_rounding;
    const double undilated = gap - start.dilation;

    const double plastic =
        law.tan_dilation != 0.0 ? plastic_slip(law, std::abs(trial), undilated, factor, limit_at) : 0.0;
    const double elastic_gap = undilated - law.tan_dilation * plastic;
    const auto pressure = contact_pressure(law, elastic_gap);
    const auto limit = held_limit ? ShearLimit{*held_limit, 0.0, 0.0} : limit_under(law, pressure, elastic_gap, piece);
    if (pressure.value <= 0.0 && limit.value <= 0.0) {
        result.state = ContactState::open;
        return result;
    }

    // Derivatives of the elastic gap with respect to (gap, |trial|, tilt), through the plastic slip where the point dilates.
    double by_gap = 1.0;
    double by_trial = 0.0;
    double by_tilt = 0.0;
    if (plastic > 0.0) {
        const double stiffness = law.shear_stiffness - factor * limit.by_gap * law.tan_dilation;
        by_gap = 1.0 + law.tan_dilation * factor * limit.by_gap / stiffness;
        by_trial = -law.tan_dilation / stiffness;
        by_tilt = law.tan_dilation * factor * limit.by_tilt / stiffness;
        result.history.dilation += law.tan_dilation * plastic;
    }
    result.normal = -pressure.value;
    result.tangent(0, 0) = -pressure.slope * by_gap;
    result.tangent(0, 1) = -pressure.slope * by_trial * sign * law.shear_stiffness;
    result.by_tilt(0) = -pressure.slope * by_tilt;
    if (limit.value <= 0.0) {
        result.state = ContactState::sliding;
        return result;
    }
    const double x = std::abs(trial) / limit.value;
    const auto shear = rounded_shear(x, law.friction_rounding);
    const double dshear_dlimit = shear.value - x * shear.slope;
    result.shear = sign * limit.value * shear.value;
    result.tangent(1, 0) = sign * dshear_dlimit * limit.by_gap * by_gap;
    result.tangent(1, 1) = law.shear_stiffness * (shear.slope + dshear_dlimit * limit.by_gap * by_trial);
    result.by_tilt(1) = sign * dshear_dlimit * (limit.by_gap * by_tilt + limit.by_tilt);
    result.state = x >= 1.0 ? ContactState::sliding : ContactState::locked;
    result.history.shear_trial = sign * std::min(std::abs(trial), factor * limit.value);
    return result;
}

} // namespace kluft
