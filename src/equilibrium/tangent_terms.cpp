#include "tangent_terms.hpp"

namespace kluft {

namespace {

constexpr double touching_gap = 1e-6; ///< of the lattice spacing

} // namespace

PointTangent point_tangent(const EquilibriumProblem& problem, const ContactPoint& point, const Eigen::VectorXd& q,
                           TangentKind kind) {
    if (kind == TangentKind::touching) {
        const double undilated = gap_and_slip(point, q).gap - point.history.dilation;
        const bool touches = undilated <= touching_gap * problem.body.system->spacing;
        if (!touches) return {};
        return {.by_motion = full_stiffness((*problem.body.laws)[point.law])};
    }
    const PointTraction traction = contact_traction(*problem.body.laws, point, q);
    if (traction.state == ContactState::open) return {};
    if (kind == TangentKind::symmetric) return {.by_motion = symmetric_tangent(traction)};
    return {.by_motion = traction.tangent, .by_tilt = traction.by_tilt};
}

TiltTangent::TiltTangent(const ContactPoint& point, const Vec2& by_tilt) {
    const Vec2 force = point.weight * (by_tilt(0) * point.normal + by_tilt(1) * point.tangent);
    force_b = displacement_row(force, point.xi_b);
    force_a = -displacement_row(force, point.xi_a);
    row_b = displacement_row(point.normal, point.piece.xi_b);
    row_a = -displacement_row(point.normal, point.piece.xi_a);
    row_a.head<2>().setZero(); // a translation turns nothing
    row_b.head<2>().setZero();
}

} // namespace kluft
