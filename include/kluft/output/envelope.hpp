// The strength envelope of several triaxial runs: cohesion and friction angle, Mohr's circles.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "kluft/output/canvas.hpp"
#include "kluft/simulation/step_record.hpp"

namespace kluft {

/// A run's peak. Pa, positive in compression.
struct PeakPoint {
    std::string run;
    double sigma_3 = 0.0;     ///< lateral stress at the peak
    double sigma_1 = 0.0;     ///< axial stress at the peak
    bool peak_reached = true; ///< false: see `remark`
    std::string remark{};     ///< of a peak that is not reached: "still rising", "net locked"
};

/// Mohr-Coulomb's line sigma_1 = 2 c cos(phi)/(1 - sin(phi)) + sigma_3 (1 + sin(phi))/(1 - sin(phi)).
struct Envelope {
    double cohesion = 0.0;       ///< Pa
    double friction_angle = 0.0; ///< radians

    [[nodiscard]] double sigma_1(double sigma_3) const;
};

/// The peak of a run from the rows of equilibria.csv (or history.csv). Throws InputError when no row is balanced.
[[nodiscard]] PeakPoint peak_point(const std::string& run, const std::vector<StepRecord>& equilibria);

/// Least squares of sigma_1 on sigma_3. Throws InputError with fewer than two different sigma_3 or when no
/// Mohr-Coulomb line fits (slope not above zero).
[[nodiscard]] Envelope fit_envelope(const std::vector<PeakPoint>& points);

/// Columns `run,sigma_3,sigma_1,fitted_sigma_1,peak_reached` (Pa), one row per run.
[[nodiscard]] std::string envelope_csv(const std::vector<PeakPoint>& points, const Envelope& fit);
/// The same as an aligned table in MPa, with cohesion and friction angle below.
[[nodiscard]] std::string envelope_text(const std::vector<PeakPoint>& points, const Envelope& fit);

/// Another envelope to compare with.
struct NamedEnvelope {
    std::string label;
    Envelope envelope;
};

/// Mohr's circles of the peaks, the fitted line and further ones dashed, at one scale on both axes (MPa).
[[nodiscard]] std::string draw_envelope(const std::string& title, const std::vector<PeakPoint>& points,
                                        const Envelope& fit, const std::vector<NamedEnvelope>& others,
                                        PictureFormat format);
/// The same, written in the format that the extension names. Throws InputError, ResourceError.
void write_envelope(const std::filesystem::path& path, const std::string& title, const std::vector<PeakPoint>& points,
                    const Envelope& fit, const std::vector<NamedEnvelope>& others = {});

} // namespace kluft
