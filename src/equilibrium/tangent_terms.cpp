#include "tangent_terms.hpp"

namespace kluft {

namespace {

constexpr double touching_gap = 1e-6; ///< of the lattice spacing

} // namespace

Mat2 point_tangent(const EquilibriumProblem& problem, const ContactPoint& point, const Eigen::VectorXd& q,
                   TangentKind kind) {
    if (kind == TangentKind::touching) {
        const bool touches = gap_and_slip(point, q).gap <= touching_gap * problem.body.system->spacing;
        return touches ? full_stiffness((*problem.body.laws)[point.law]) : Mat2(Mat2::Zero());
    }
    const PointTraction traction = contact_traction(*problem.body.laws, point, q);
    if (traction.state == ContactState::open) return Mat2::Zero();
    return kind == TangentKind::symmetric ? symmetric_tangent(traction) : traction.tangent;
}

} // namespace kluft
