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

/// Plastic slip beyond the rounding: the root of k_s d = max(0, |trial| - (1 + s) limit(p(gap - tan(psi) d))), whose
/// left side minus right side increases with d. Newton from d = 0, kept inside a bracket.
double plastic_slip(const InterfaceLaw& law, double trial, double elastic_gap, double factor) {
    const auto excess = [&](double d) {
        const double pressure = contact_pressure(law, elastic_gap - law.tan_dilation * d).value;
        return trial - factor * shear_limit(law, pressure).value - law.shear_stiffness * d;
    };
    if (excess(0.0) <= 0.0) return 0.0;
    double low = 0.0;
    double high = trial / law.shear_stiffness;
    double d = low;
    for (int i = 0; i < 60; ++i) {
        const auto pressure = contact_pressure(law, elastic_gap - law.tan_dilation * d);
        const auto limit = shear_limit(law, pressure.value);
        const double value = trial - factor * limit.value - law.shear_stiffness * d;
        (value > 0.0 ? low : high) = d;
        const double slope = factor * limit.slope * pressure.slope * law.tan_dilation - law.shear_stiffness;
        double next = d - value / slope;
        if (next <= low || next >= high) next = 0.5 * (low + high);
        if (std::abs(next - d) <= 1e-15 * high) return next;
        d = next;
    }
    return d;
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

ShearLimit shear_limit(const InterfaceLaw& law, double pressure) {
    if (pressure <= 0.0) return {0.0, 0.0};
    if (pressure >= law.cohesion_onset) return {law.cohesion + pressure * law.tan_friction, law.tan_friction};
    const double ramp = law.cohesion / law.cohesion_onset;
    return {pressure * (ramp + law.tan_friction), ramp + law.tan_friction};
}

PointTraction fracture_traction(const InterfaceLaw& law, const PointHistory& start, double gap, double slip) {
    PointTraction result;
    result.history.dilation = start.dilation;
    const double trial = start.shear_trial + law.shear_stiffness * slip;
    const double sign = trial < 0.0 ? -1.0 : 1.0;
    const double factor = 1.0 + law.friction_rounding;
    const double elastic_gap = gap - start.dilation;

    const double plastic = law.tan_dilation != 0.0 ? plastic_slip(law, std::abs(trial), elastic_gap, factor) : 0.0;
    const auto pressure = contact_pressure(law, elastic_gap - law.tan_dilation * plastic);
    if (pressure.value <= 0.0) {
        result.state = ContactState::open;
        return result;
    }
    const auto limit = shear_limit(law, pressure.value);

    // Derivatives of p with respect to (gap, |trial|), through the plastic slip where the point dilates.
    double dp_dgap = pressure.slope;
    double dp_dtrial = 0.0;
    if (plastic > 0.0) {
        const double stiffness = law.shear_stiffness - factor * limit.slope * pressure.slope * law.tan_dilation;
        dp_dgap = pressure.slope * (1.0 + law.tan_dilation * factor * limit.slope * pressure.slope / stiffness);
        dp_dtrial = -pressure.slope * law.tan_dilation / stiffness;
        result.history.dilation += law.tan_dilation * plastic;
    }
    result.normal = -pressure.value;
    result.tangent(0, 0) = -dp_dgap;
    result.tangent(0, 1) = -dp_dtrial * sign * law.shear_stiffness;
    if (limit.value <= 0.0) {
        result.state = ContactState::sliding;
        return result;
    }
    const double x = std::abs(trial) / limit.value;
    const auto shear = rounded_shear(x, law.friction_rounding);
    const double dshear_dlimit = shear.value - x * shear.slope;
    result.shear = sign * limit.value * shear.value;
    result.tangent(1, 0) = sign * dshear_dlimit * limit.slope * dp_dgap;
    result.tangent(1, 1) = law.shear_stiffness * (shear.slope + dshear_dlimit * limit.slope * dp_dtrial);
    result.state = x >= 1.0 ? ContactState::sliding : ContactState::locked;
    result.history.shear_trial = sign * std::min(std::abs(trial), factor * limit.value);
    return result;
}

} // namespace kluft
