#include "kluft/constitutive/block_elasticity.hpp"

#include <algorithm>

#include <Eigen/LU>

namespace kluft {

namespace {

struct Polar {
    Mat2 rotation;
    double trace; ///< tr S
};

Polar polar(const Mat2& f) {
    const double x = f(0, 0) + f(1, 1);
    const double y = f(1, 0) - f(0, 1);
    const double trace = Vec2(x, y).norm();
    Polar result{Mat2::Identity(), trace};
    if (trace > 0.0) result.rotation << x / trace, -y / trace, y / trace, x / trace;
    return result;
}

} // namespace

Mat2 first_piola_stress(const Mat2& f, const ElasticModuli& moduli) {
    const auto [rotation, trace] = polar(f);
    return 2.0 * moduli.mu * (f - rotation) + moduli.lambda * (trace - 2.0) * rotation;
}

Mat2 stress_of_gradient(const Mat2& h, const ElasticModuli& moduli) {
    const double a = h.trace();
    const double y = h(1, 0) - h(0, 1);
    const double trace = Vec2(2.0 + a, y).norm();
    const double excess = (a * (4.0 + a) + y * y) / (trace + 2.0); // tr S - 2
    Mat2 rotation;
    rotation << (2.0 + a) / trace, -y / trace, y / trace, (2.0 + a) / trace;
    const double on_diagonal = (excess - a) / trace; // 1 - R11
    Mat2 stretch = h;                                // F - R
    stretch(0, 0) += on_diagonal;
    stretch(1, 1) += on_diagonal;
    stretch(0, 1) += y / trace;
    stretch(1, 0) -= y / trace;
    return 2.0 * moduli.mu * stretch + moduli.lambda * excess * rotation;
}

double strain_energy_density(const Mat2& f, const ElasticModuli& moduli) {
    const auto [rotation, trace] = polar(f);
    return moduli.mu * (f - rotation).squaredNorm() + 0.5 * moduli.lambda * (trace - 2.0) * (trace - 2.0);
}

Mat2 cauchy_stress(const Mat2& f, const ElasticModuli& moduli) {
    const Mat2 stress = first_piola_stress(f, moduli) * f.transpose() / f.determinant();
    return 0.5 * (stress + stress.transpose());
}

Mat2 cauchy_stress_of_gradient(const Mat2& h, const ElasticModuli& moduli) {
    const Mat2 f = Mat2::Identity() + h;
    const Mat2 stress = stress_of_gradient(h, moduli) * f.transpose() / f.determinant();
    return 0.5 * (stress + stress.transpose());
}

Mat4 elastic_tangent(const Mat2& f, const ElasticModuli& moduli, bool positive) {
    const auto [rotation, trace] = polar(f);
    const Eigen::Vector4d r(rotation(0, 0), rotation(1, 0), rotation(0, 1), rotation(1, 1));
    const Eigen::Vector4d spin(rotation(0, 1), rotation(1, 1), -rotation(0, 0),
                               -rotation(1, 0)); // R W, W = [0 -1; 1 0]
    double along_spin = trace > 0.0 ? (moduli.lambda * (trace - 2.0) - 2.0 * moduli.mu) / trace : -moduli.mu;
    if (positive) along_spin = std::max(along_spin, -moduli.mu); // 2 mu + 2 along_spin is the eigenvalue
    return 2.0 * moduli.mu * Mat4::Identity() + moduli.lambda * r * r.transpose() +
           along_spin * spin * spin.transpose();
}

} // namespace kluft
