// What a calibration file says: a scene, parameters of it that may move, and what runs of it are to show.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "kluft/core/vector.hpp"
#include "kluft/scene/key_table.hpp"
#include "kluft/scene/quantity.hpp"
#include "kluft/studies/study.hpp"

namespace kluft {

/// A key of the scene that follows a parameter.
struct ParameterKey {
    std::string key;    ///< path, "interfaces.bond.normal_stiffness"
    double times = 1.0; ///< its value over the parameter's
    TextPosition at;
};

/// A number above zero that may move between bounds. SI, angles in radians.
struct CalibrationParameter {
    std::string name;
    std::vector<ParameterKey> keys;
    Measure measure = Measure::fraction;
    double start = 0.0;
    double from = 0.0;
    double to = 0.0;
};

enum class TargetQuantity {
    youngs_modulus, ///< of the elastic body
    poissons_ratio,
    peak_stress, ///< of runs, from here on
    peak_strain,
    residual_stress,
    tensile_strength,
    cohesion,
    friction_angle,
    curve
};

/// A number, or a curve, that runs of the scene are to show.
struct CalibrationTarget {
    TargetQuantity quantity = TargetQuantity::peak_stress;
    std::string name;       ///< "peak_stress", "peak_stress 2" where there are several
    double value = 0.0;     ///< SI, angles in radians; 0 for a curve
    double tolerance = 0.0; ///< relative; of a curve that of its distance
    double weight = 1.0;    ///< of the square of its residual
    std::vector<StudySetting> set;
    std::filesystem::path scene;        ///< absolute; of the calibration unless it has its own
    std::vector<std::string> pressures; ///< YAML texts; of an envelope
    std::vector<Vec2> curve;            ///< differential stress (Pa) over axial strain
    TextPosition at;
};

struct Calibration {
    std::string name; ///< the file's stem
    std::string title;
    std::filesystem::path file;
    std::filesystem::path scene; ///< absolute
    std::vector<CalibrationParameter> parameters;
    std::vector<CalibrationTarget> targets;
    ReplicaPlan replicas;
    int most_evaluations = 0; ///< of the strength stage
};

/// All keys of a calibration file, parents before children, as scene_schema has those of a scene.
[[nodiscard]] const KeyTable& calibration_schema();

/// Reads and checks a calibration file, its keys against the scene's schema and its start against the scene. Throws
/// InputError with one message for each thing that is wrong, as read_scene does.
[[nodiscard]] Calibration read_calibration(const std::filesystem::path& file);
[[nodiscard]] Calibration read_calibration_text(std::string_view text, const std::filesystem::path& file);

[[nodiscard]] std::string_view quantity_name(TargetQuantity quantity);
[[nodiscard]] Measure measure_of(TargetQuantity quantity);
/// Of the body before any crack: no run is needed for it.
[[nodiscard]] inline bool is_elastic(TargetQuantity quantity) { return quantity <= TargetQuantity::poissons_ratio; }
[[nodiscard]] inline bool is_of_envelope(TargetQuantity quantity) {
    return quantity == TargetQuantity::cohesion || quantity == TargetQuantity::friction_angle;
}

/// "12.5 MPa", "0.25", "35 deg": for people.
[[nodiscard]] std::string value_text(double value, Measure measure);
/// The same as a scene takes it back without loss: plain in SI, angles in degrees.
[[nodiscard]] std::string plain_text(double value, Measure measure);

/// The settings of the scene's keys at x, the natural logarithms of the parameters.
[[nodiscard]] std::vector<StudySetting> settings_at(const Calibration& calibration, const Eigen::VectorXd& x);
/// Logarithms of the starts and of the bounds.
[[nodiscard]] Eigen::VectorXd start_of(const Calibration& calibration);
[[nodiscard]] Eigen::VectorXd lower_bounds(const Calibration& calibration);
[[nodiscard]] Eigen::VectorXd upper_bounds(const Calibration& calibration);

} // namespace kluft
