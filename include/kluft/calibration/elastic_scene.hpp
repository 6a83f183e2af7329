// Young's modulus and Poisson's ratio of a scene's body by the parameters of a calibration, and the elastic stage.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "kluft/calibration/calibration.hpp"
#include "kluft/calibration/elastic_body.hpp"
#include "kluft/calibration/least_squares.hpp"

namespace kluft {

/// E and nu at x, the logarithms of the parameters, and their derivatives by x.
struct ElasticPoint {
    double youngs_modulus = 0.0; ///< Pa
    double poissons_ratio = 0.0;
    Eigen::VectorXd modulus_gradient; ///< Pa
    Eigen::VectorXd ratio_gradient;
};

/// Whether the parameter moves the geometry, so that the body would have to be cut anew.
[[nodiscard]] bool moves_geometry(const CalibrationParameter& parameter);

/// The body of a scene with some settings, cut once.
class ElasticScene {
public:
    /// Cuts the body at x. Throws InputError.
    ElasticScene(const Calibration& calibration, std::filesystem::path scene, std::vector<StudySetting> set,
                 const Eigen::VectorXd& x);

    /// Nothing where the scene's reader refuses the values at x or beside it, or where no equilibrium exists. The derivatives
    /// of the elastic properties by x are central differences with one extrapolation (Richardson), of order 4 with a step of
    /// 1e-3, of the scene's reader and build_model without a cut; those by parameters of the geometry are zero.
    [[nodiscard]] std::optional<ElasticPoint> at(const Eigen::VectorXd& x);

    /// Whether this is the body of a target.
    [[nodiscard]] bool is_of(const CalibrationTarget& target) const;

    /// Whether mapped fractures cut the body, which a run lets slip and the elastic body does not.
    [[nodiscard]] bool has_fractures() const;

private:
    [[nodiscard]] std::optional<Eigen::VectorXd> properties_at(const Eigen::VectorXd& x) const;
    [[nodiscard]] std::optional<Eigen::MatrixXd> properties_by_x(const Eigen::VectorXd& x) const;

    const Calibration& calibration_;
    std::filesystem::path scene_;
    std::vector<StudySetting> set_;
    BlockSystem system_;
    std::unique_ptr<ElasticBody> body_;
};

/// The elastic targets of a calibration over their bodies.
class ElasticTargets {
public:
    /// `more`: settings on top of those of the targets, as those of a replica.
    ElasticTargets(const Calibration& calibration, const Eigen::VectorXd& x,
                   const std::vector<StudySetting>& more = {});

    /// Indices into Calibration::targets.
    [[nodiscard]] const std::vector<std::size_t>& targets() const { return targets_; }
    /// Whether mapped fractures cut one of the bodies.
    [[nodiscard]] bool have_fractures() const;
    /// The values of the targets and their derivatives by x, one row per target.
    [[nodiscard]] std::optional<ResidualRows> values_at(const Eigen::VectorXd& x);
    /// The differences from the targets over the tolerances, one per target.
    [[nodiscard]] std::optional<ResidualRows> residuals_at(const Eigen::VectorXd& x);

private:
    const Calibration& calibration_;
    std::vector<std::size_t> targets_;
    std::vector<ElasticScene> scenes_;
    std::vector<std::size_t> scene_of_; ///< per target
};

/// What the elastic stage has found.
struct ElasticFit {
    Eigen::VectorXd x;
    int evaluations = 0;          ///< bodies that were solved
    std::vector<char> influences; ///< per parameter: E or nu depend on it
    bool is_determined = false;   ///< no other values of those parameters give the same E and nu nearby
};

/// Moves the parameters that E and nu depend on until the elastic targets are met, from `start`; of many solutions it takes
/// the nearest to the start. Throws InputError where nothing can be evaluated at the start.
[[nodiscard]] ElasticFit fit_elastic(const Calibration& calibration, ElasticTargets& targets,
                                     const Eigen::VectorXd& start);

} // namespace kluft
