// The strength envelope of several tests as table, document and picture with Mohr's circles.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "kluft/constitutive/strength_fit.hpp"
#include "kluft/output/canvas.hpp"
#include "kluft/simulation/step_record.hpp"

namespace kluft {

/// The peak of a run from the rows of equilibria.csv (or history.csv): axial and lateral stress at the peak in the sense
/// of the platen, the larger one as sigma_1. `platen_stage`: the first stage that moves a platen, which presses where it is
/// not known. Throws InputError when no row is balanced.
[[nodiscard]] PeakPoint peak_point(const std::string& run, const std::vector<StepRecord>& equilibria,
                                   std::optional<int> platen_stage = std::nullopt);

/// Columns `run,sigma_3,sigma_1,fitted_sigma_1,peak_reached,balanced,net_locked,unloaded,moves_platen,use` (Pa), one row per
/// test; `use` is strength, tension or bound. Names with commas or quotes are quoted (RFC 4180). read_strength_table reads it.
[[nodiscard]] std::string envelope_csv(const std::vector<PeakPoint>& points, const StrengthFit& fit);
/// Whether a text is such a table, and whether one is what envelope_json writes.
[[nodiscard]] bool is_envelope_csv(std::string_view text);
[[nodiscard]] bool is_envelope_json(std::string_view text);
/// The same as an aligned table in MPa, below it every parameter with its standard error, what is a bound and what
/// contradicts the line.
[[nodiscard]] std::string envelope_text(const std::vector<PeakPoint>& points, const StrengthFit& fit);
/// All numbers (Pa, angles in degrees), null for what is not known: cohesion, friction_angle, tensile_strength, each also with
/// _error, r_squared, rms_residual, n_points (strengths), n_tension, n_bounds, cohesion_over_tensile_strength,
/// hoek_brown {sigma_ci, sigma_ci_error, m_i, m_i_error, s, a, r_squared, rms_residual, problem}, contradicted_by (names),
/// points (the rows of the table), units, version.
[[nodiscard]] std::string envelope_json(const std::vector<PeakPoint>& points, const StrengthFit& fit);

/// Another envelope to compare with.
struct NamedEnvelope {
    std::string label;
    Envelope envelope;
};

/// Mohr's circles of the tests (of bounds the dashed half that is certain, with an arrow), the fitted line with the
/// 95 % confidence band of its shear strength, the tension cut-off, the envelope of Hoek-Brown's curve and further lines
/// dashed, at one scale on both axes (MPa). Of more than twelve tests the legend tells the kinds only.
[[nodiscard]] std::string draw_envelope(const std::string& title, const std::vector<PeakPoint>& points,
                                        const StrengthFit& fit, const std::vector<NamedEnvelope>& others,
                                        PictureFormat format);
/// The same, written in the format that the extension names. Throws InputError, ResourceError.
void write_envelope(const std::filesystem::path& path, const std::string& title, const std::vector<PeakPoint>& points,
                    const StrengthFit& fit, const std::vector<NamedEnvelope>& others = {});

} // namespace kluft
