#include "kluft/assembly/krylov.hpp"

#include <cmath>

#include "kluft/core/change_size.hpp"

namespace kluft {

void Gmres::extend_basis(int n) {
    while (static_cast<int>(v_.size()) < n) v_.emplace_back();
    while (static_cast<int>(z_.size()) < n) z_.emplace_back();
    while (static_cast<int>(h_.size()) < n) h_.emplace_back();
}

/// Givens' rotations: the earlier ones on a new column, and one more that makes it end on the diagonal.
void Gmres::rotate(int column) {
    Eigen::VectorXd& h = h_[column];
    for (int i = 0; i < column; ++i) {
        const double upper = cosine_[i] * h[i] + sine_[i] * h[i + 1];
        h[i + 1] = cosine_[i] * h[i + 1] - sine_[i] * h[i];
        h[i] = upper;
    }
    const double length = std::hypot(h[column], h[column + 1]);
    cosine_[column] = length > 0.0 ? h[column] / length : 1.0;
    sine_[column] = length > 0.0 ? h[column + 1] / length : 0.0;
    h[column] = length;
    right_side_[column + 1] = -sine_[column] * right_side_[column];
    right_side_[column] *= cosine_[column];
}

int Gmres::correct(const Operator& matrix, const Operator& precondition, int max_vectors, const Bound& bound,
                   const Eigen::VectorXd& r, Eigen::VectorXd& x) {
    const double norm = r.norm();
    if (norm == 0.0) return 0;
    if (!v_.empty() && v_.front().size() != r.size()) release();
    for (Eigen::VectorXd* const each : {&cosine_, &sine_, &right_side_}) {
        change_size(*each, max_vectors + 1);
        each->setZero();
    }
    right_side_[0] = norm;
    extend_basis(1);
    v_[0] = r / norm;
    int used = 0;
    bool exhausted = false; // the space is invariant
    double least = 0.0;
    while (used < max_vectors && !exhausted && (used == 0 || std::abs(right_side_[used]) > least)) {
        extend_basis(used + 2);
        precondition(v_[used], z_[used]);
        if (used == 0) least = bound(norm * z_[0].norm());
        Eigen::VectorXd& w = v_[used + 1];
        matrix(z_[used], w);
        Eigen::VectorXd& h = h_[used];
        h.setZero(used + 2);
        const double length = w.norm();
        for (int i = 0; i <= used; ++i) {
            h[i] = v_[i].dot(w);
            w -= h[i] * v_[i];
        }
        h[used + 1] = w.norm();
        exhausted = !(h[used + 1] > 1e-14 * length);
        if (!exhausted) w /= h[used + 1];
        rotate(used);
        ++used;
    }
    change_size(weights_, used);
    weights_ = right_side_.head(used);
    for (int i = used - 1; i >= 0; --i) {
        for (int j = i + 1; j < used; ++j) weights_[i] -= h_[j][i] * weights_[j];
        weights_[i] = h_[i][i] != 0.0 ? weights_[i] / h_[i][i] : 0.0;
    }
    for (int i = 0; i < used; ++i) x += weights_[i] * z_[i];
    return used;
}

} // namespace kluft
