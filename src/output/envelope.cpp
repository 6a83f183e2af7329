#include "kluft/output/envelope.hpp"

#include <algorithm>
#include <cmath>
#include <string_view>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "json_number.hpp"
#include "kluft/core/diagnostics.hpp"
#include "kluft/core/nearest_name.hpp"
#include "kluft/core/units.hpp"
#include "kluft/core/version.hpp"
#include "kluft/output/atomic_file.hpp"
#include "kluft/output/summary.hpp"

namespace kluft {

namespace {

constexpr std::string_view own_columns = "run,sigma_3,sigma_1,fitted_sigma_1";

std::string use_name(PeakUse use) {
    switch (use) {
    case PeakUse::strength:
        return "strength";
    case PeakUse::tension:
        return "tension";
    case PeakUse::bound:
        return "bound";
    }
    return "";
}

std::size_t number_of(PeakUse use, const std::vector<PeakPoint>& points) {
    return static_cast<std::size_t>(
        std::ranges::count_if(points, [&](const PeakPoint& point) { return use_of(point) == use; }));
}

/// A cell of a table of comma-separated values.
std::string quoted_cell(std::string text) {
    std::ranges::replace_if(
        text, [](char c) { return c == '\n' || c == '\r'; }, ' ');
    if (text.find_first_of(",\"") == std::string::npos) return text;
    std::string cell = "\"";
    for (const char c : text) cell += c == '"' ? std::string("\"\"") : std::string(1, c);
    return cell + '"';
}

/// What a row of the table says of a test.
std::string remark(const PeakPoint& point, const StrengthFit& fit) {
    if (use_of(point) == PeakUse::tension) return "  tension";
    const std::string reason = bound_reason(point);
    if (reason.empty()) return "";
    return "  " + reason + (contradicts(point, fit) ? ", above the fit" : "");
}

/// "0.1234 +- 0.0056 MPa", without the error where it is not known.
std::string with_error(double value, const std::optional<double>& error, int decimals, const char* unit) {
    const std::string number = fmt::format("{:.{}f}", value, decimals);
    return error ? fmt::format("{} +- {:.{}f}{}", number, *error, decimals, unit) : number + unit;
}

std::string in_mega(const Estimate& stress) {
    const auto error = stress.error ? std::optional(*stress.error / mega) : std::nullopt;
    return with_error(stress.value / mega, error, 4, " MPa");
}

std::string quality(const Residuals& residuals) {
    return fmt::format("{} points, R^2 {:.4f}, rms residual {:.4f} MPa", residuals.n_points, residuals.r_squared,
                       residuals.rms / mega);
}

/// In MPa, without the sign of what is rounded to zero.
double shown_in_mega(double stress) {
    constexpr double half_of_last_digit = 5e-5;
    return std::abs(stress / mega) < half_of_last_digit ? 0.0 : stress / mega;
}

std::string mohr_coulomb_text(const Envelope& envelope) {
    const auto angle_error = envelope.friction_angle_error();
    std::string text =
        fmt::format("cohesion {}, friction angle {}\n  {}\n", in_mega({envelope.cohesion, envelope.cohesion_error()}),
                    with_error(envelope.friction_angle * degrees,
                               angle_error ? std::optional(*angle_error * degrees) : std::nullopt, 2, " deg"),
                    envelope.covariance ? "standard errors; " + quality(envelope.residuals)
                                        : "standard errors unknown: a line through two points leaves no residual");
    return text;
}

std::string tension_text(const StrengthFit& fit, std::size_t n_tension) {
    if (!fit.tensile_strength) return "";
    const double tensile = fit.tensile_strength->value;
    const Envelope& envelope = fit.envelope;
    std::string text =
        fmt::format("tensile strength {} ({}){}\n", in_mega(*fit.tensile_strength),
                    n_tension == 1 ? "one test, standard error unknown" : fmt::format("mean of {} tests", n_tension),
                    tensile > 0.0 ? fmt::format(", c/sigma_t {:.3f}", envelope.cohesion / tensile) : "");
    const double tangent = std::tan(envelope.friction_angle);
    if (tangent > 0.0 && tensile * tangent > envelope.cohesion)
        text += fmt::format("  the line's apex c cot(phi) = {:.4f} MPa is nearer: the cut-off does not act\n",
                            envelope.cohesion / tangent / mega);
    return text;
}

std::string hoek_brown_text(const HoekBrownFit& fit) {
    if (!fit.curve) return "Hoek-Brown: not fitted: " + fit.problem + '\n';
    return fmt::format("Hoek-Brown: sigma_ci {}, m_i {} (s = 1, a = 0.5)\n  standard errors; {}\n",
                       in_mega(fit.curve->sigma_ci), with_error(fit.curve->m_i.value, fit.curve->m_i.error, 3, ""),
                       quality(fit.curve->residuals));
}

/// A line that no rock has, most likely because its tests are not of one rock.
std::string implausible_text(const Envelope& envelope) {
    if (envelope.friction_angle < 0.0)
        return "warning: the friction angle is below zero: the strength sigma_1 - sigma_3 falls as the lateral stress "
               "rises; "
               "these tests are not of one material, or it is none that Mohr-Coulomb's criterion describes\n";
    if (envelope.cohesion < 0.0)
        return "warning: the cohesion is below zero: the line has no strength at small lateral stresses; these tests "
               "are not "
               "of one material, or it is none that Mohr-Coulomb's criterion describes\n";
    return "";
}

/// No rock is so weak: most likely the stresses of a table are in another unit than Pa.
std::string units_text(const std::vector<PeakPoint>& points) {
    constexpr double least = 1e3; // Pa
    double largest = 0.0;
    for (const PeakPoint& point : points)
        largest = std::max({largest, std::abs(point.sigma_1), std::abs(point.sigma_3)});
    if (largest >= least) return "";
    return fmt::format(
        "warning: all stresses are below 1 kPa (the largest is {:.4g} Pa); a table without units is read in "
        "Pa, its first line names others, as in 'sigma_3 (MPa),sigma_1 (MPa)'\n",
        largest);
}

std::string bounds_text(const std::vector<PeakPoint>& points, const StrengthFit& fit) {
    std::vector<std::string> bounds;
    std::vector<std::string> above;
    for (const PeakPoint& point : points) {
        if (use_of(point) != PeakUse::bound) continue;
        bounds.push_back(fmt::format("{} ({})", point.run, bound_reason(point)));
        if (contradicts(point, fit)) above.push_back(point.run);
    }
    if (bounds.empty()) return "";
    std::string text = fmt::format("{} {}, left out of the fit: {}\n", bounds.size(),
                                   bounds.size() == 1 ? "bound" : "bounds", listed(bounds));
    if (!above.empty())
        text += fmt::format("the fit is contradicted: it lies below what was carried by {}\n", listed(above));
    return text;
}

using EnvelopeJson = nlohmann::ordered_json;

EnvelopeJson hoek_brown_json(const HoekBrownFit& fit) {
    const auto number = [&](auto&& of) { return json_number(fit.curve ? of(*fit.curve) : std::nullopt); };
    using Number = std::optional<double>;
    EnvelopeJson json;
    json["sigma_ci"] = number([](const HoekBrown& curve) { return Number(curve.sigma_ci.value); });
    json["sigma_ci_error"] = number([](const HoekBrown& curve) { return curve.sigma_ci.error; });
    json["m_i"] = number([](const HoekBrown& curve) { return Number(curve.m_i.value); });
    json["m_i_error"] = number([](const HoekBrown& curve) { return curve.m_i.error; });
    json["s"] = 1.0;
    json["a"] = 0.5;
    json["r_squared"] = number([](const HoekBrown& curve) { return Number(curve.residuals.r_squared); });
    json["rms_residual"] = number([](const HoekBrown& curve) { return Number(curve.residuals.rms); });
    json["problem"] = fit.curve ? EnvelopeJson(nullptr) : EnvelopeJson(fit.problem);
    return json;
}

EnvelopeJson point_json(const PeakPoint& point, const StrengthFit& fit) {
    const std::string reason = bound_reason(point);
    EnvelopeJson json;
    json["run"] = point.run;
    json["sigma_3"] = json_number(point.sigma_3);
    json["sigma_1"] = json_number(point.sigma_1);
    json["fitted_sigma_1"] = json_number(fit.envelope.sigma_1(point.sigma_3));
    json["use"] = use_name(use_of(point));
    json["reason"] = reason.empty() ? EnvelopeJson(nullptr) : EnvelopeJson(reason);
    return json;
}

} // namespace

PeakPoint peak_point(const std::string& run, const std::vector<StepRecord>& equilibria,
                     std::optional<int> platen_stage) {
    const auto peak = peak_row(equilibria, platen_stage);
    if (!peak) throw InputError(run + ": no balanced equilibrium, so no peak");
    const auto numbers = curve_numbers(equilibria, {}, platen_stage, Plane::strain);
    const auto [low, high] = std::minmax(peak->lateral_stress, peak->axial_stress);
    return {.run = run,
            .sigma_3 = low,
            .sigma_1 = high,
            .peak_reached = is_strength(numbers),
            .net_locked = numbers.net_locked,
            .unloaded = is_unloaded_before_fall(equilibria, *peak, platen_stage)};
}

bool is_envelope_csv(std::string_view text) { return text.starts_with(own_columns); }

bool is_envelope_json(std::string_view text) {
    const EnvelopeJson json = EnvelopeJson::parse(text, nullptr, false);
    return json.is_object() && json.contains("cohesion_error") && json.contains("friction_angle_error");
}

std::string envelope_csv(const std::vector<PeakPoint>& points, const StrengthFit& fit) {
    std::string text = fmt::format("{},peak_reached,balanced,net_locked,unloaded,moves_platen,use\n", own_columns);
    for (const PeakPoint& point : points)
        text +=
            fmt::format("{},{:.17g},{:.17g},{:.17g},{:d},{:d},{:d},{:d},{:d},{}\n", quoted_cell(point.run),
                        point.sigma_3, point.sigma_1, fit.envelope.sigma_1(point.sigma_3), point.peak_reached,
                        point.balanced, point.net_locked, point.unloaded, point.moves_platen, use_name(use_of(point)));
    return text;
}

std::string envelope_text(const std::vector<PeakPoint>& points, const StrengthFit& fit) {
    std::size_t width = 3;
    for (const PeakPoint& point : points) width = std::max(width, point.run.size());
    std::string text = fmt::format("{:<{}}  sigma_3 (MPa)  sigma_1 (MPa)  fitted (MPa)\n", "run", width);
    for (const PeakPoint& point : points) {
        const bool tension = use_of(point) == PeakUse::tension;
        const std::string fitted = tension ? "-" : fmt::format("{:.4f}", fit.envelope.sigma_1(point.sigma_3) / mega);
        text += fmt::format("{:<{}}  {:13.4f}  {:13.4f}  {:>12}{}\n", point.run, width, shown_in_mega(point.sigma_3),
                            shown_in_mega(point.sigma_1), fitted, remark(point, fit));
    }
    return text + mohr_coulomb_text(fit.envelope) + tension_text(fit, number_of(PeakUse::tension, points)) +
           hoek_brown_text(fit.hoek_brown) + bounds_text(points, fit) + implausible_text(fit.envelope) +
           units_text(points);
}

std::string envelope_json(const std::vector<PeakPoint>& points, const StrengthFit& fit) {
    const Envelope& envelope = fit.envelope;
    const auto& tensile = fit.tensile_strength;
    const auto angle_error = envelope.friction_angle_error();
    EnvelopeJson json;
    json["cohesion"] = json_number(envelope.cohesion);
    json["cohesion_error"] = json_number(envelope.cohesion_error());
    json["friction_angle"] = json_number(envelope.friction_angle * degrees);
    json["friction_angle_error"] = json_number(angle_error ? std::optional(*angle_error * degrees) : std::nullopt);
    json["r_squared"] = json_number(envelope.residuals.r_squared);
    json["rms_residual"] = json_number(envelope.residuals.rms);
    json["tensile_strength"] = json_number(tensile ? std::optional(tensile->value) : std::nullopt);
    json["tensile_strength_error"] = json_number(tensile ? tensile->error : std::nullopt);
    json["cohesion_over_tensile_strength"] =
        json_number(tensile && tensile->value > 0.0 ? std::optional(envelope.cohesion / tensile->value) : std::nullopt);
    json["hoek_brown"] = hoek_brown_json(fit.hoek_brown);
    json["n_points"] = number_of(PeakUse::strength, points);
    json["n_tension"] = number_of(PeakUse::tension, points);
    json["n_bounds"] = number_of(PeakUse::bound, points);
    json["contradicted_by"] = EnvelopeJson::array();
    json["points"] = EnvelopeJson::array();
    for (const PeakPoint& point : points) {
        if (contradicts(point, fit)) json["contradicted_by"].push_back(point.run);
        json["points"].push_back(point_json(point, fit));
    }
    json["units"] = {{"stress", "Pa"}, {"angle", "deg"}};
    json["version"] = std::string(version());
    return json.dump(2, ' ', false, EnvelopeJson::error_handler_t::replace) + '\n';
}

void write_envelope(const std::filesystem::path& path, const std::string& title, const std::vector<PeakPoint>& points,
                    const StrengthFit& fit, const std::vector<NamedEnvelope>& others) {
    write_file(path, draw_envelope(title, points, fit, others, picture_format(path)));
}

} // namespace kluft
