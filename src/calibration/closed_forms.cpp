#include "kluft/calibration/closed_forms.hpp"

#include <algorithm>
#include <cmath>

#include "kluft/calibration/least_squares.hpp"
#include "kluft/constitutive/strength_envelope.hpp"
#include "kluft/core/diagnostics.hpp"
#include "kluft/scene/scene_reader.hpp"

namespace kluft {

namespace {

constexpr double difference_step = 1e-3;
constexpr double pull_to_start = 1e-4;
constexpr double most_lateral = 0.3; // cosine of the angle between the normals of a lateral boundary and the platen's

/// The strength of the net's potential cracks; nothing without such a net.
std::optional<Strength> strength_of_net(const Scene& scene) {
    if (!scene.geometry.tessellation) return std::nullopt;
    const InterfaceType& type =
        scene.interface_types[static_cast<std::size_t>(scene.geometry.tessellation->interface_type)];
    if (type.kind != InterfaceKind::potential_crack) return std::nullopt;
    if (type.strength) return type.strength;
    return scene.materials[static_cast<std::size_t>(scene.geometry.material)].strength;
}

Vec2 outward_normal(const Scene& scene, std::size_t boundary) {
    const Polygon& domain = scene.geometry.domain;
    constexpr double faces_all_ways = 1e-9; // of the length: what is left of the sum is round-off
    Vec2 sum = Vec2::Zero();
    double length = 0.0;
    for (const int side : scene.geometry.boundaries[boundary].sides) {
        const auto i = static_cast<std::size_t>(side);
        if (i >= domain.size()) continue;
        const Vec2 along = domain[(i + 1) % domain.size()] - domain[i];
        sum += right_normal(along);
        length += along.norm();
    }
    return sum.norm() > faces_all_ways * length ? Vec2(sum.normalized()) : Vec2(Vec2::Zero());
}

/// The stage that first moves a platen.
std::optional<std::size_t> first_platen_stage(const Scene& scene) {
    const auto& stages = scene.loads.stages;
    const auto found = std::ranges::find_if(stages, [](const Stage& stage) { return stage.motion.has_value(); });
    if (found == stages.end()) return std::nullopt;
    return static_cast<std::size_t>(found - stages.begin());
}

/// Mean pressure on the boundaries beside the platen when it starts to move (Pa).
double lateral_pressure(const Scene& scene, std::size_t platen_stage) {
    const auto& stages = scene.loads.stages;
    const Vec2 axis = outward_normal(scene, static_cast<std::size_t>(stages[platen_stage].motion->boundary));
    double sum = 0.0;
    int n_sides = 0;
    for (std::size_t i = 0; i < scene.geometry.boundaries.size(); ++i) {
        const Vec2 normal = outward_normal(scene, i);
        if (normal.isZero() || std::abs(normal.dot(axis)) > most_lateral) continue;
        ++n_sides;
        double pressure = 0.0;
        for (std::size_t s = 0; s <= platen_stage; ++s)
            if (const auto found = stages[s].pressure.find(static_cast<int>(i)); found != stages[s].pressure.end())
                pressure = found->second;
        sum += pressure;
    }
    return n_sides > 0 ? sum / n_sides : 0.0;
}

std::optional<double> expected_peak(const Scene& scene, const Strength& strength) {
    const auto stage = first_platen_stage(scene);
    if (!stage || !(scene.loads.stages[*stage].motion->value > 0.0)) return std::nullopt;
    return compressive_strength(strength, lateral_pressure(scene, *stage));
}

/// The residual of a target at x; nothing where theory knows none.
std::optional<double> expected_residual(const Calibration& calibration, const CalibrationTarget& target,
                                        const Eigen::VectorXd& x) {
    std::vector<StudySetting> settings = settings_at(calibration, x);
    settings.insert(settings.end(), target.set.begin(), target.set.end());
    try {
        const auto value = expected_value(target, read_scene(target.scene, assignments(settings)));
        if (!value) return std::nullopt;
        return (*value - target.value) / (target.tolerance * target.value);
    } catch (const InputError&) {
        return std::nullopt;
    }
}

} // namespace

std::optional<double> expected_value(const CalibrationTarget& target, const Scene& scene) {
    if (!scene.geometry.fractures.empty()) return std::nullopt;
    const auto strength = strength_of_net(scene);
    if (!strength || !(strength->cohesion > 0.0)) return std::nullopt;
    switch (target.quantity) {
    case TargetQuantity::peak_stress:
        return expected_peak(scene, *strength);
    case TargetQuantity::tensile_strength:
        return capped(*strength).strength.tensile_strength;
    case TargetQuantity::cohesion:
        return strength->cohesion;
    case TargetQuantity::friction_angle:
        return strength->friction_angle;
    default:
        return std::nullopt;
    }
}

ExpectedRows expected_rows(const Calibration& calibration, const std::vector<std::size_t>& targets,
                           const Eigen::VectorXd& x) {
    const auto n = static_cast<Eigen::Index>(targets.size());
    ExpectedRows rows{Eigen::VectorXd::Zero(n), Eigen::MatrixXd::Zero(n, x.size()), std::vector<char>(targets.size())};
    for (Eigen::Index t = 0; t < n; ++t) {
        const auto at = static_cast<std::size_t>(t);
        const CalibrationTarget& target = calibration.targets[targets[at]];
        const auto here = expected_residual(calibration, target, x);
        if (!here) continue;
        rows.values[t] = *here;
        rows.known[at] = 1;
        for (Eigen::Index i = 0; i < x.size(); ++i) {
            Eigen::VectorXd before = x;
            Eigen::VectorXd after = x;
            before[i] -= difference_step;
            after[i] += difference_step;
            const auto low = expected_residual(calibration, target, before);
            const auto high = expected_residual(calibration, target, after);
            if (low && high) rows.jacobian(t, i) = (*high - *low) / (2.0 * difference_step);
        }
    }
    return rows;
}

std::optional<Eigen::VectorXd> expected_start(const Calibration& calibration, const std::vector<std::size_t>& targets,
                                              const Eigen::VectorXd& start, const std::vector<char>& may_move) {
    const ExpectedRows first = expected_rows(calibration, targets, start);
    if (std::ranges::find(first.known, 1) == first.known.end()) return std::nullopt;
    Eigen::VectorXd lower = start;
    Eigen::VectorXd upper = start;
    for (Eigen::Index i = 0; i < start.size(); ++i) {
        if (!may_move[static_cast<std::size_t>(i)]) continue;
        lower[i] = lower_bounds(calibration)[i];
        upper[i] = upper_bounds(calibration)[i];
    }
    const Eigen::Index n = start.size();
    const auto n_rows = static_cast<Eigen::Index>(targets.size());
    const ResidualFunction function = [&](const Eigen::VectorXd& x) -> std::optional<ResidualRows> {
        const ExpectedRows rows = expected_rows(calibration, targets, x);
        if (rows.known != first.known) return std::nullopt;
        ResidualRows all{Eigen::VectorXd(n_rows + n), Eigen::MatrixXd(n_rows + n, n)};
        all.values << rows.values, pull_to_start * (x - start);
        all.jacobian << rows.jacobian, pull_to_start * Eigen::MatrixXd::Identity(n, n);
        return all;
    };
    return minimise_squares(function, start, lower, upper, {.residual = 1e-3, .n_judged = n_rows}).x;
}

} // namespace kluft
