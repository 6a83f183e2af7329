#include "kluft/simulation/step_control.hpp"

#include <algorithm>
#include <cmath>

namespace kluft {

namespace {

constexpr double safety = 0.9;
constexpr double largest_step_growth = 2.0;
constexpr double least_growth = 0.2;

} // namespace

bool is_accurate(double size, const StepError& error, double accuracy) {
    return error.path <= accuracy * size && error.chord <= accuracy;
}

double next_step_size(double size, const StepError& error, double accuracy) {
    double growth = largest_step_growth;
    if (error.path > 0.0) growth = std::min(growth, safety * accuracy * size / error.path);
    if (error.chord > 0.0) growth = std::min(growth, safety * std::sqrt(accuracy / error.chord));
    return size * std::max(growth, least_growth);
}

double fitted_step_size(double size, double remaining) { return remaining / std::ceil(remaining / size - 1e-9); }

Eigen::VectorXd weighted_stresses(const LoadedBody& body, const Eigen::VectorXd& q) {
    const auto stresses = block_stresses(body, q);
    Eigen::VectorXd result(3 * static_cast<Eigen::Index>(stresses.size()));
    double area = 0.0;
    for (const Block& block : body.system->blocks) area += block.area;
    for (std::size_t b = 0; b < stresses.size(); ++b) {
        const Mat2& s = stresses[b];
        result.segment<3>(3 * static_cast<Eigen::Index>(b)) =
            std::sqrt(body.system->blocks[b].area / area) *
            Eigen::Vector3d(s(0, 0), s(1, 1), std::sqrt(0.5) * (s(0, 1) + s(1, 0)));
    }
    return result;
}

std::vector<double> slip_indices(const Model& model, const LoadedBody& body, const Eigen::VectorXd& q) {
    std::vector<double> indices;
    for (const ContactPoint& point : body.placement->contacts) {
        const int fracture = point.interface >= 0 ? model.system.interfaces[point.interface].fracture : -1;
        if (fracture < 0) continue;
        if (fracture >= static_cast<int>(indices.size())) indices.resize(static_cast<std::size_t>(fracture) + 1, 0.0);
        const InterfaceLaw& law = (*body.laws)[point.law];
        const double limit = coulomb_limit(*body.laws, point, q);
        if (limit <= 0.0) continue;
        const double trial = point.history.shear_trial + law.shear_stiffness * gap_and_slip(point, q).slip;
        indices[fracture] = std::max(indices[fracture], std::abs(trial) / limit);
    }
    return indices;
}

} // namespace kluft
