#include "oracle/potential.hpp"

#include <cmath>

namespace kluft::oracle {

namespace {

/// Eq. (3): the two parts of D/h that a rotation mixes (a, b), without the 2 of the identity, and the two that it does
/// not (c, d).
struct Parts {
    double a, b, c, d;
};

Parts parts_of(const Eigen::Vector4d& gradient) {
    return {gradient[0] + gradient[3], gradient[1] - gradient[2], gradient[0] - gradient[3], gradient[1] + gradient[2]};
}

Eigen::Vector4d current(const ElasticBlock& block, const Eigen::VectorXd& x) {
    return (block.start + x.segment<4>(block.first_unknown)) / block.size;
}

/// s = tr S = hypot(2 + a, b), and s - 2 without the round-off of the difference.
struct Stretch {
    double trace, excess;
};

Stretch stretch_of(const Parts& p) {
    const double trace = std::hypot(2.0 + p.a, p.b);
    return {trace, (p.a * (4.0 + p.a) + p.b * p.b) / (trace + 2.0)};
}

/// Eq. (4) times the area.
double energy_of(const ElasticBlock& block, const Eigen::VectorXd& x) {
    const Parts p = parts_of(current(block, x));
    const double e = stretch_of(p).excess;
    return block.size * block.size *
           (0.5 * (block.mu + block.lambda) * e * e + 0.5 * block.mu * (p.c * p.c + p.d * p.d));
}

/// Derivatives of (4) by (a, b, c, d), back to D.
Eigen::Vector4d force_of(const ElasticBlock& block, const Eigen::VectorXd& x) {
    const Parts p = parts_of(current(block, x));
    const Stretch s = stretch_of(p);
    const double tension = (block.mu + block.lambda) * s.excess / s.trace;
    const double by_a = tension * (2.0 + p.a);
    const double by_b = tension * p.b;
    const double by_c = block.mu * p.c;
    const double by_d = block.mu * p.d;
    return block.size * Eigen::Vector4d(by_a + by_c, by_b + by_d, by_d - by_b, by_a - by_c);
}

Eigen::Matrix4d stiffness_of(const ElasticBlock& block, const Eigen::VectorXd& x) {
    const Parts p = parts_of(current(block, x));
    const Stretch s = stretch_of(p);
    const Eigen::Vector4d da(1, 0, 0, 1), db(0, 1, -1, 0), dc(1, 0, 0, -1), dd(0, 1, 1, 0);
    const Eigen::Vector4d along = ((2.0 + p.a) * da + p.b * db) / s.trace;
    const Eigen::Vector4d across = ((2.0 + p.a) * db - p.b * da) / s.trace;
    return (block.mu + block.lambda) * (along * along.transpose() + s.excess / s.trace * across * across.transpose()) +
           block.mu * (dc * dc.transpose() + dd * dd.transpose());
}

} // namespace

double LinearForm::at(const Eigen::VectorXd& x) const {
    double sum = constant;
    for (const Term& term : terms) sum += term.factor * x[term.unknown];
    return sum;
}

double Potential::energy(const Eigen::VectorXd& x) const {
    double sum = linear.dot(x);
    for (const ElasticBlock& block : blocks) sum += energy_of(block, x);
    for (const Spring& spring : springs) {
        const double stretch = spring.stretch.at(x);
        sum += stretch * (spring.force + 0.5 * spring.stiffness * stretch);
    }
    return sum;
}

Eigen::VectorXd Potential::gradient(const Eigen::VectorXd& x) const {
    Eigen::VectorXd sum = linear;
    for (const ElasticBlock& block : blocks) sum.segment<4>(block.first_unknown) += force_of(block, x);
    for (const Spring& spring : springs) {
        const double force = spring.force + spring.stiffness * spring.stretch.at(x);
        for (const auto& term : spring.stretch.terms) sum[term.unknown] += force * term.factor;
    }
    return sum;
}

Eigen::SparseMatrix<double> Potential::hessian(const Eigen::VectorXd& x) const {
    std::vector<Eigen::Triplet<double>> entries;
    for (const ElasticBlock& block : blocks) {
        const Eigen::Matrix4d stiffness = stiffness_of(block, x);
        for (int i = 0; i < 4; ++i) {
            for (int j = 0; j <= i; ++j)
                entries.emplace_back(block.first_unknown + i, block.first_unknown + j, stiffness(i, j));
        }
    }
    for (const Spring& spring : springs) {
        for (const auto& row : spring.stretch.terms) {
            for (const auto& column : spring.stretch.terms) {
                if (row.unknown >= column.unknown)
                    entries.emplace_back(row.unknown, column.unknown, spring.stiffness * row.factor * column.factor);
            }
        }
    }
    Eigen::SparseMatrix<double> result(n_unknowns, n_unknowns);
    result.setFromTriplets(entries.begin(), entries.end());
    return result;
}

} // namespace kluft::oracle
