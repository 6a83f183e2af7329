#include "kluft/calibration/elastic_scene.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "kluft/blocks/block_cutter.hpp"
#include "kluft/core/dense_decompositions.hpp"
#include "kluft/core/diagnostics.hpp"
#include "kluft/scene/scene_model.hpp"
#include "kluft/scene/scene_reader.hpp"

namespace kluft {

namespace {

constexpr double log_step = 1e-3;        // error of order 4, 1e-12
constexpr double least_influence = 1e-9; // of a unit of log(parameter) on log(E) or nu
constexpr double to_start = 1e-5;        // pull towards the start, for what the targets do not determine
constexpr double least_singular = 1e-6;
constexpr double elastic_residual = 1e-7; // relative, where the fit ends

std::vector<StudySetting> joined(std::vector<StudySetting> first, const std::vector<StudySetting>& second) {
    first.insert(first.end(), second.begin(), second.end());
    return first;
}

bool same_settings(const std::vector<StudySetting>& a, const std::vector<StudySetting>& b) {
    return assignments(a) == assignments(b);
}

/// log(E/E*), nu/nu* - 1: nearly linear in the logarithms of stiffnesses, and relative.
ResidualRows relative_residuals(const Calibration& calibration, const std::vector<std::size_t>& targets,
                                const ResidualRows& values) {
    ResidualRows result = values;
    for (Eigen::Index i = 0; i < values.values.size(); ++i) {
        const CalibrationTarget& target = calibration.targets[targets[static_cast<std::size_t>(i)]];
        const double value = values.values[i];
        const bool by_log = target.quantity == TargetQuantity::youngs_modulus && value > 0.0;
        result.values[i] = by_log ? std::log(value / target.value) : value / target.value - 1.0;
        result.jacobian.row(i) /= by_log ? value : target.value;
    }
    return result;
}

/// Roots of the weights over the tolerances; the tightest target has its own weight, so that residuals stay relative.
Eigen::VectorXd weights_of(const Calibration& calibration, const std::vector<std::size_t>& targets) {
    double tightest = std::numeric_limits<double>::infinity();
    for (const std::size_t t : targets) tightest = std::min(tightest, calibration.targets[t].tolerance);
    Eigen::VectorXd weights(static_cast<Eigen::Index>(targets.size()));
    Eigen::Index next = 0;
    for (const std::size_t t : targets)
        weights[next++] = std::sqrt(calibration.targets[t].weight) * tightest / calibration.targets[t].tolerance;
    return weights;
}

} // namespace

bool moves_geometry(const CalibrationParameter& parameter) {
    return std::ranges::any_of(parameter.keys,
                               [](const ParameterKey& each) { return each.key.starts_with("geometry."); });
}

ElasticScene::ElasticScene(const Calibration& calibration, std::filesystem::path scene, std::vector<StudySetting> set,
                           const Eigen::VectorXd& x)
    : calibration_(calibration), scene_(std::move(scene)), set_(std::move(set)) {
    const Scene read = read_scene(scene_, assignments(joined(settings_at(calibration, x), set_)));
    Model model = build_scene_model(read).model;
    body_ = std::make_unique<ElasticBody>(model);
    system_ = std::move(model.system);
}

bool ElasticScene::is_of(const CalibrationTarget& target) const {
    return target.scene == scene_ && same_settings(target.set, set_);
}

bool ElasticScene::has_fractures() const {
    return std::ranges::any_of(system_.interfaces,
                               [](const Interface& each) { return each.origin == EdgeOrigin::fracture; });
}

std::optional<Eigen::VectorXd> ElasticScene::properties_at(const Eigen::VectorXd& x) const {
    try {
        const Scene scene = read_scene(scene_, assignments(joined(settings_at(calibration_, x), set_)));
        return elastic_properties(build_model(system_, model_input(scene)));
    } catch (const InputError&) {
        return std::nullopt;
    }
}

std::optional<Eigen::MatrixXd> ElasticScene::properties_by_x(const Eigen::VectorXd& x) const {
    Eigen::MatrixXd result;
    for (Eigen::Index i = 0; i < x.size(); ++i) {
        const bool is_fixed = moves_geometry(calibration_.parameters[static_cast<std::size_t>(i)]);
        const auto moved = [&](double steps) {
            Eigen::VectorXd beside = x;
            if (!is_fixed) beside[i] += steps * log_step;
            return properties_at(beside);
        };
        const auto before2 = moved(-2.0);
        const auto before = moved(-1.0);
        const auto after = moved(1.0);
        const auto after2 = moved(2.0);
        if (!before2 || !before || !after || !after2) return std::nullopt;
        if (i == 0) result.resize(after->size(), x.size());
        result.col(i) = (8.0 * (*after - *before) - (*after2 - *before2)) / (12.0 * log_step);
    }
    return result;
}

std::optional<ElasticPoint> ElasticScene::at(const Eigen::VectorXd& x) {
    const auto properties = properties_at(x);
    const auto by_x = properties_by_x(x);
    if (!properties || !by_x) return std::nullopt;
    try {
        const ElasticResponse response = body_->response(*properties);
        return ElasticPoint{response.youngs_modulus, response.poissons_ratio,
                            by_x->transpose() * response.modulus_gradient, by_x->transpose() * response.ratio_gradient};
    } catch (const InputError&) {
        return std::nullopt;
    }
}

ElasticTargets::ElasticTargets(const Calibration& calibration, const Eigen::VectorXd& x,
                               const std::vector<StudySetting>& more)
    : calibration_(calibration) {
    for (std::size_t i = 0; i < calibration.targets.size(); ++i) {
        CalibrationTarget target = calibration.targets[i];
        if (!is_elastic(target.quantity)) continue;
        target.set = joined(target.set, more);
        const auto known = std::ranges::find_if(scenes_, [&](const ElasticScene& each) { return each.is_of(target); });
        targets_.push_back(i);
        scene_of_.push_back(static_cast<std::size_t>(known - scenes_.begin()));
        if (known == scenes_.end()) scenes_.emplace_back(calibration, target.scene, target.set, x);
    }
}

bool ElasticTargets::have_fractures() const {
    return std::ranges::any_of(scenes_, [](const ElasticScene& each) { return each.has_fractures(); });
}

std::optional<ResidualRows> ElasticTargets::values_at(const Eigen::VectorXd& x) {
    std::vector<ElasticPoint> points;
    for (ElasticScene& scene : scenes_) {
        auto point = scene.at(x);
        if (!point) return std::nullopt;
        points.push_back(std::move(*point));
    }
    const auto n = static_cast<Eigen::Index>(targets_.size());
    ResidualRows result{Eigen::VectorXd(n), Eigen::MatrixXd(n, x.size())};
    for (Eigen::Index i = 0; i < n; ++i) {
        const auto at = static_cast<std::size_t>(i);
        const ElasticPoint& point = points[scene_of_[at]];
        const bool is_modulus = calibration_.targets[targets_[at]].quantity == TargetQuantity::youngs_modulus;
        result.values[i] = is_modulus ? point.youngs_modulus : point.poissons_ratio;
        result.jacobian.row(i) = is_modulus ? point.modulus_gradient : point.ratio_gradient;
    }
    return result;
}

std::optional<ResidualRows> ElasticTargets::residuals_at(const Eigen::VectorXd& x) {
    auto result = values_at(x);
    for (Eigen::Index i = 0; result && i < result->values.size(); ++i) {
        const CalibrationTarget& target = calibration_.targets[targets_[static_cast<std::size_t>(i)]];
        const double scale = target.tolerance * target.value;
        result->values[i] = (result->values[i] - target.value) / scale;
        result->jacobian.row(i) /= scale;
    }
    return result;
}

ElasticFit fit_elastic(const Calibration& calibration, ElasticTargets& targets, const Eigen::VectorXd& start) {
    const Eigen::Index n = start.size();
    const auto n_targets = static_cast<Eigen::Index>(targets.targets().size());
    const Eigen::VectorXd weights = weights_of(calibration, targets.targets());
    const ResidualFunction function = [&](const Eigen::VectorXd& x) -> std::optional<ResidualRows> {
        const auto values = targets.values_at(x);
        if (!values) return std::nullopt;
        const ResidualRows own = relative_residuals(calibration, targets.targets(), *values);
        ResidualRows all{Eigen::VectorXd(n_targets + n), Eigen::MatrixXd(n_targets + n, n)};
        all.values << own.values, to_start * (x - start);
        all.jacobian << own.jacobian, to_start * Eigen::MatrixXd::Identity(n, n);
        for (Eigen::Index i = 0; i < n_targets; ++i) {
            all.values[i] *= weights[i];
            all.jacobian.row(i) *= weights[i];
        }
        return all;
    };
    const auto first = function(start);
    if (!first) throw InputError("the elastic body of the scene has no equilibrium at the start of the parameters");
    // What E and nu do not depend on stays where it is.
    Eigen::VectorXd lower = start;
    Eigen::VectorXd upper = start;
    ElasticFit fit;
    std::vector<Eigen::Index> influencing;
    for (Eigen::Index i = 0; i < n; ++i) {
        fit.influences.push_back(first->jacobian.col(i).head(n_targets).norm() > least_influence ? 1 : 0);
        if (!fit.influences.back()) continue;
        influencing.push_back(i);
        lower[i] = lower_bounds(calibration)[i];
        upper[i] = upper_bounds(calibration)[i];
    }
    const auto result =
        minimise_squares(function, start, lower, upper, {.residual = elastic_residual, .n_judged = n_targets});
    fit.x = result.x;
    fit.evaluations = 1 + result.evaluations;
    if (influencing.empty() || static_cast<Eigen::Index>(influencing.size()) > n_targets) return fit;
    const Eigen::MatrixXd jacobian = result.residuals.jacobian.topRows(n_targets);
    const Eigen::VectorXd singular = singular_values(jacobian(Eigen::all, influencing)).values;
    fit.is_determined = singular.minCoeff() > least_singular * singular.maxCoeff();
    return fit;
}

} // namespace kluft
