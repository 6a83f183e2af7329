// Runs the scenes of a calibration's targets at places of the parameters, and reads the targets' values from them.
#pragma once

#include <atomic>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "kluft/calibration/calibration.hpp"
#include "kluft/calibration/response_search.hpp"
#include "kluft/output/envelope.hpp"
#include "kluft/studies/study_run.hpp"

namespace kluft {

/// Points of the strain at which a curve is compared.
inline constexpr int n_compared_points = 21;

/// The targets that runs tell, with the rows of their residuals one after the other.
struct RunTargets {
    std::vector<std::size_t> targets; ///< indices into Calibration::targets
    std::vector<RowGroup> groups;     ///< per target
    Eigen::Index n_rows = 0;
};
[[nodiscard]] RunTargets run_targets(const Calibration& calibration);

/// Digest of all scenes of the calibration, with the starts and the settings of each target.
[[nodiscard]] std::string scenes_digest(const Calibration& calibration);

/// Where and how scenes are run.
struct RunPlace {
    std::filesystem::path directory; ///< runs stand in directory/runs/<number of the scene>/cases/<name>
    std::filesystem::path program;   ///< kluft itself
    int jobs = 1;
    std::function<void(const StudyProgress&)> show; ///< called often; may be empty
};

/// Runs what has not been run yet, each in a directory named after its settings, and gives the residuals of each copy at each
/// place. Nothing when `stop` has become true. Throws ResourceError.
[[nodiscard]] std::optional<std::vector<Evaluation>> evaluate_by_runs(const Calibration& calibration,
                                                                      const RunTargets& targets, const RunPlace& place,
                                                                      const std::vector<Eigen::VectorXd>& places,
                                                                      const std::atomic<bool>& stop);

/// The settings of copy `replica` on top of a scene's, as evaluate_by_runs runs it; empty without copies.
[[nodiscard]] std::vector<StudySetting> settings_of_copy(const Calibration& calibration,
                                                         const std::filesystem::path& scene,
                                                         const std::vector<StudySetting>& set, int replica);

/// Of one finished run: the rows of the target's residuals. Nothing, and the reason in `note`, where the run does not tell it.
/// `directories`: of the runs that the target takes, one per pressure of an envelope.
[[nodiscard]] std::optional<Eigen::VectorXd>
rows_of_runs(const CalibrationTarget& target, const std::vector<std::filesystem::path>& directories, std::string& note);

/// The peaks of the runs of an envelope at a place, of all copies, as far as they are there.
[[nodiscard]] std::vector<PeakPoint> peaks_at(const Calibration& calibration, const CalibrationTarget& target,
                                              const std::filesystem::path& directory, const Eigen::VectorXd& x);
/// The curve of the first copy at a place; empty where there is none.
[[nodiscard]] std::vector<Vec2> curve_at(const Calibration& calibration, const CalibrationTarget& target,
                                         const std::filesystem::path& directory, const Eigen::VectorXd& x);

} // namespace kluft
