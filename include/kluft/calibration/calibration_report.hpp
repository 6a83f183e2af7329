// What a calibration leaves in its directory.
#pragma once

#include <filesystem>
#include <string>

#include "kluft/calibration/calibrate.hpp"

namespace kluft {

/// The base scene with the parameters found, as a scene of its own that extends it; targets, what was found and the
/// differences stand in comments. A key below a list takes the whole list with it, since lists replace what they override.
/// `directory`: where the file is to stand.
[[nodiscard]] std::string calibrated_scene(const Calibration& calibration, const CalibrationResult& result,
                                           const std::filesystem::path& directory);

/// All numbers of the result (SI, angles in degrees); what is not known is null.
[[nodiscard]] std::string calibration_json(const Calibration& calibration, const CalibrationResult& result);

/// The result in a few lines for the terminal.
[[nodiscard]] std::string calibration_text(const Calibration& calibration, const CalibrationResult& result);

/// Throws InputError where the directory is that of a run or of a calibration of another scene, or has a file that no calibration
/// wrote and that write_calibration would take the place of.
void require_no_other_calibration(const Calibration& calibration, const std::filesystem::path& directory);

/// Writes calibrated.yaml, calibration.json, report.html and its pictures into the directory. Throws ResourceError.
void write_calibration(const Calibration& calibration, const CalibrationResult& result,
                       const std::filesystem::path& directory);

} // namespace kluft
