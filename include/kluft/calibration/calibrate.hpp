// A calibration from its file to its result: the elastic stage, the strength stage, and what is to be said of both.
#pragma once

#include <atomic>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "kluft/calibration/calibration.hpp"
#include "kluft/calibration/response_search.hpp"
#include "kluft/calibration/target_runs.hpp"

namespace kluft {

/// SI, radians.
struct ParameterResult {
    double value = 0.0;
    std::optional<double> low; ///< of the 95 % confidence interval by the scatter of copies
    std::optional<double> high;
    bool at_bound = false;
    bool is_determined = true; ///< the targets tell it
};

/// SI, radians.
struct TargetResult {
    std::optional<double> found; ///< mean of the copies; of a curve its distance
    double error = 0.0;          ///< found less the value, relative; of a curve its distance
    bool met = false;
    std::vector<double> copies; ///< per copy
};

struct CalibrationResult {
    Eigen::VectorXd x; ///< logarithms of the parameters
    std::vector<ParameterResult> parameters;
    std::vector<TargetResult> targets;
    bool met = false;            ///< all targets
    bool stopped = false;        ///< by the user
    int elastic_evaluations = 0; ///< bodies solved in the elastic stage
    int evaluations = 0;         ///< parameter sets run in the strength stage
    std::vector<double> worst;   ///< per parameter set: the largest difference over its tolerance; infinite if not run
    std::vector<std::string> obstacles; ///< sentences: what stands in the way of the targets; empty when they are met
    std::vector<std::string> warnings;  ///< sentences: where the targets are not those of a run
    double elapsed_s = 0.0;
};

struct CalibrationOptions {
    RunPlace place;
    std::function<void(const std::string&)> say; ///< a line of progress; may be empty
};

/// Throws InputError where nothing can be evaluated at the start, ResourceError.
[[nodiscard]] CalibrationResult calibrate(const Calibration& calibration, const CalibrationOptions& options,
                                          const std::atomic<bool>& stop);

} // namespace kluft
