#include "kluft/equilibrium/equilibrium_problem.hpp"

#include <array>
#include <cmath>

#include <gtest/gtest.h>

#include "kluft/constitutive/lattice_stiffness.hpp"
#include "kluft/core/dense_decompositions.hpp"
#include "support/lattice_body.hpp"
#include "support/owned_problem.hpp"

namespace kluft {
namespace {

using cut_scenes::Uniform;
using Shape = Eigen::Matrix<double, 2, Eigen::Dynamic>; ///< displacement of a point over all unknowns

constexpr int bond = 0, joint = 1;

/// A small body of hexagons with two fractures, pressures, weight and a mass-like term, in a random state in which
/// the points of the fractures are open, stick or slide.
struct Body {
    explicit Body(std::uint64_t seed) : uniform(seed) {
        GeometrySpec spec = hexagon_spec(0.5, 0.4, 0.1, {0.03, 0.04}, bond);
        spec.tessellation->hexagons.jitter = 0.1;
        cut_scenes::add_trace(spec, {{-0.1, 0.1}, {0.6, 0.33}}, joint);
        cut_scenes::add_trace(spec, {{0.3, -0.1}, {0.23, 0.5}}, joint);
        system = cut_blocks(spec).system;
        q = random_motion(system, 3e-4, uniform);
        problem.body.system = &system;
        problem.body.moduli = &moduli;
        problem.body.laws = &laws;
        problem.placement.bonds = bonds_at(system, {1, 0}, at_rest(system));
        for (auto& each : problem.placement.bonds) each.shear_start = {uniform(-1e6, 1e6), uniform(-1e6, 1e6)};
        problem.start = random_motion(system, 3e-4, uniform);
        problem.eta.assign(system.blocks.size(), 0.0);
        for (double& eta : problem.eta) eta = uniform(1e9, 1e11);
        problem.set_density(2500.0);
        problem.loads.gravity = {1.5, -9.0};
    }
    void add_contacts() {
        const auto state = random_motion(system, 3e-4, uniform);
        problem.placement.contacts = detect_contacts(system, surfaces_of(system, {1, 0}, laws), state, 0.01, {}).points;
        for (auto& point : problem.placement.contacts) {
            point.history.shear_trial = uniform(-2e6, 2e6);
            point.history.dilation = uniform(0.0, 1e-5);
        }
    }
    void add_pressures() {
        for (int boundary = 0; boundary < 4; ++boundary) {
            const auto more = pressure_edges(system, boundary);
            problem.loads.pressure_edges.insert(problem.loads.pressure_edges.end(), more.begin(), more.end());
        }
        problem.loads.pressures = {1e8, 2e8, 3e8, 4e8};
    }

    Uniform uniform;
    std::vector<InterfaceLaw> laws{{.normal_stiffness = 1e11, .shear_stiffness = 4e10},
                                   {.normal_stiffness = 1e10,
                                    .shear_stiffness = 5e9,
                                    .tan_friction = 0.5,
                                    .cohesion = 2e5,
                                    .tan_dilation = 0.1,
                                    .cohesion_onset = 1e5,
                                    .contact_rounding = 2e5,
                                    .friction_rounding = 0.1}};
    std::vector<ElasticModuli> moduli{plane_moduli(10e9, 0.25, Plane::strain)};
    BlockSystem system;
    Eigen::VectorXd q;
    OwnedProblem problem;
};

Eigen::MatrixXd tangent_of(const EquilibriumProblem& problem, const Eigen::VectorXd& q, TangentKind kind) {
    const BlockPattern pattern = pattern_of(problem);
    BlockMatrix matrix;
    EquilibriumEvaluator(problem, pattern).tangent(q, kind, matrix);
    return dense(matrix);
}

Eigen::VectorXd forces_of(const EquilibriumProblem& problem, const Eigen::VectorXd& q) {
    const BlockPattern pattern = pattern_of(problem);
    Residual residual;
    EquilibriumEvaluator(problem, pattern).residual(q, residual);
    return residual.forces;
}

/// dR/dq by central differences, column by column.
Eigen::MatrixXd differences_of(const EquilibriumProblem& problem, const Eigen::VectorXd& q, double h) {
    const BlockPattern pattern = pattern_of(problem);
    EquilibriumEvaluator evaluator(problem, pattern);
    Eigen::MatrixXd result(q.size(), q.size());
    Residual plus, minus;
    Eigen::VectorXd moved = q;
    for (Eigen::Index i = 0; i < q.size(); ++i) {
        moved[i] = q[i] + h;
        evaluator.residual(moved, plus);
        moved[i] = q[i] - h;
        evaluator.residual(moved, minus);
        moved[i] = q[i];
        result.col(i) = (plus.forces - minus.forces) / (2.0 * h);
    }
    return result;
}

// Central differences of the residual. The state has points in every regime, and none within 1e-9 m of a corner of the
// law, where the residual is only once differentiable.
TEST(EquilibriumProblem, ExactTangentIsTheDerivativeOfTheResidualInEveryContactState) {
    std::array<int, 3> seen{};
    for (const std::uint64_t seed : {1U, 2U, 3U}) {
        Body body(seed);
        body.add_contacts();
        body.add_pressures();
        for (int i = 0; i < static_cast<int>(body.problem.placement.contacts.size()); ++i) {
            ++seen[static_cast<std::size_t>(contact_traction(body.problem.body, i, body.q).state)];
        }
        const Eigen::MatrixXd exact = tangent_of(body.problem, body.q, TangentKind::exact);
        const Eigen::MatrixXd expected = differences_of(body.problem, body.q, 1e-9);
        EXPECT_LT((exact - expected).cwiseAbs().maxCoeff(), 1e-6 * expected.cwiseAbs().maxCoeff()) << seed;
    }
    EXPECT_GT(seen[static_cast<std::size_t>(ContactState::open)], 10);
    EXPECT_GT(seen[static_cast<std::size_t>(ContactState::sliding)], 10);
    EXPECT_GT(seen[static_cast<std::size_t>(ContactState::locked)], 10);
}

TEST(EquilibriumProblem, SlidingPointsAndFollowerPressuresMakeTheExactTangentUnsymmetric) {
    Body body(1);
    const auto skew = [&] {
        const Eigen::MatrixXd k = tangent_of(body.problem, body.q, TangentKind::exact);
        return (k - k.transpose()).cwiseAbs().maxCoeff() / k.cwiseAbs().maxCoeff();
    };
    EXPECT_LT(skew(), 1e-14); // elastic and bonded
    body.add_pressures();
    EXPECT_GT(skew(), 1e-4);
    body.problem.loads.pressures.assign(4, 0.0);
    EXPECT_LT(skew(), 1e-14);
    body.add_contacts();
    EXPECT_GT(skew(), 1e-4);
}

TEST(SlowEquilibriumProblem, SymmetricTangentIsSymmetricAndHasNoNegativeEigenvalue) {
    for (const std::uint64_t seed : {1U, 2U}) {
        Body body(seed);
        body.add_contacts();
        body.add_pressures();
        body.problem.eta.clear();
        Mat2 compression;
        compression << 0.98, 0.0, 0.0, 0.97; // the exact tangent softens against turning there
        const Eigen::VectorXd q = body.q + affine_motion(body.system, compression);
        const Eigen::MatrixXd k = tangent_of(body.problem, q, TangentKind::symmetric);
        const double largest = k.cwiseAbs().maxCoeff();
        EXPECT_LT((k - k.transpose()).cwiseAbs().maxCoeff(), 1e-14 * largest);
        EXPECT_GT(symmetric_eigenvalues(k)[0], -1e-12 * largest);
        const Eigen::MatrixXd exact = tangent_of(body.problem, q, TangentKind::exact);
        EXPECT_LT(symmetric_eigenvalues(0.5 * (exact + exact.transpose()))[0], -1e-6 * largest);
    }
}

// Before any load every closed fracture is as stiff as if it were bonded with its own k_n and k_s; two points per edge
// integrate the same cubics as three.
TEST(EquilibriumProblem, TouchingTangentOfABodyAtRestIsThatOfBondsOfTheSameStiffness) {
    Body body(1);
    const auto rest = at_rest(body.system);
    body.problem.placement.contacts =
        detect_contacts(body.system, surfaces_of(body.system, {1, 0}, body.laws), rest, 1e-3, {}).points;
    ASSERT_FALSE(body.problem.placement.contacts.empty());
    const Eigen::MatrixXd touching = tangent_of(body.problem, rest, TangentKind::touching);
    EXPECT_GT((touching - tangent_of(body.problem, rest, TangentKind::exact)).norm(), 0.01 * touching.norm());
    body.problem.placement.contacts.clear();
    body.problem.placement.bonds = bonds_at(body.system, {1, 1}, rest);
    const Eigen::MatrixXd bonded = tangent_of(body.problem, rest, TangentKind::exact);
    EXPECT_LT((touching - bonded).cwiseAbs().maxCoeff(), 1e-12 * bonded.cwiseAbs().maxCoeff());
}

/// Integral of f over a block: fan of triangles about the centroid, exact for quadratic f (edge midpoints).
template <class Function> double integral(const BlockSystem& system, int b, Function f) {
    const Block& block = system.blocks[b];
    double sum = 0.0;
    for (const Edge& edge : block.edges) {
        const Vec2& p = edge_start(system, edge);
        const Vec2& r = edge_end(system, edge);
        const double area = 0.5 * cross(p - block.centroid, r - block.centroid);
        sum += area / 3.0 * (f(0.5 * (p + r)) + f(0.5 * (p + block.centroid)) + f(0.5 * (r + block.centroid)));
    }
    return sum;
}

/// Energy of blocks, bonds, weight and mass-like term, from other formulas than the program's: singular values of F for
/// the blocks, positions of the Gauss points on the edges for the bonds, quadrature for the mass-like term.
double energy(const Body& body, const Eigen::VectorXd& q) {
    const BlockSystem& system = body.system;
    double sum = 0.0;
    for (int b = 0; b < system.n_blocks(); ++b) {
        const Block& block = system.blocks[b];
        const ElasticModuli& m = body.moduli[0];
        const Mat2 f = deformation_gradient(q, b, block.size);
        const Vec2 stretch = singular_values(f).values - Vec2::Ones();
        sum += block.area * (m.mu * stretch.squaredNorm() + 0.5 * m.lambda * stretch.sum() * stretch.sum());
        sum -= 2500.0 * block.area * body.problem.loads.gravity.dot(displacement_at(q, b, Vec2::Zero()));
        sum += 0.5 * body.problem.eta[b] * integral(system, b, [&](const Vec2& x) {
                   const Vec2 xi = (x - block.centroid) / block.size;
                   return (displacement_at(q, b, xi) - displacement_at(body.problem.start, b, xi)).squaredNorm();
               });
    }
    std::size_t bonds = 0;
    for (const Interface& interface : system.interfaces) {
        if (interface.interface_type != bond) continue;
        const Edge& edge = system.blocks[interface.block_a].edges[interface.edge_a];
        const Vec2 start = edge_start(system, edge), extent = edge_end(system, edge) - start;
        const Vec2 t = extent.normalized(), n(t.y(), -t.x());
        for (const std::size_t k : {0U, 1U}) {
            const Vec2 x = start + std::array{0.2113248654051871, 0.7886751345948129}[k] * extent;
            const auto moved = [&](int b) {
                const Block& block = system.blocks[b];
                return displacement_at(q, b, (x - block.centroid) / block.size);
            };
            const Vec2 opening = moved(interface.block_b) - moved(interface.block_a);
            const double gap = n.dot(opening), slip = t.dot(opening);
            const double shear = body.problem.placement.bonds[bonds].shear_start[k];
            sum += 0.5 * extent.norm() * (0.5 * 1e11 * gap * gap + shear * slip + 0.5 * 4e10 * slip * slip);
        }
        ++bonds;
    }
    return sum;
}

// Central differences of the energy; its size over the step bounds the round-off.
TEST(EquilibriumProblem, ResidualOfABondedBodyIsTheGradientOfItsEnergy) {
    const Body body(4);
    const Eigen::VectorXd forces = forces_of(body.problem, body.q);
    Eigen::VectorXd moved = body.q;
    const double h = 1e-6;
    for (Eigen::Index i = 0; i < body.q.size(); ++i) {
        moved[i] = body.q[i] + h;
        const double plus = energy(body, moved);
        moved[i] = body.q[i] - h;
        const double minus = energy(body, moved);
        moved[i] = body.q[i];
        EXPECT_NEAR(forces[i], (plus - minus) / (2.0 * h), 1e-7 * forces.cwiseAbs().maxCoeff()) << i;
    }
}

/// N of the point X of block b over all unknowns, from theory (3).
Shape shape_at(const BlockSystem& system, int b, const Vec2& x) {
    const Vec2 xi = (x - system.blocks[b].centroid) / system.blocks[b].size;
    Shape n = Shape::Zero(2, 6 * system.n_blocks());
    n.block<2, 2>(0, 6 * b).setIdentity();
    n.block<2, 2>(0, 6 * b + 2) = xi.x() * Mat2::Identity();
    n.block<2, 2>(0, 6 * b + 4) = xi.y() * Mat2::Identity();
    return n;
}

// The dense sum over blocks, points, edges and masses, each with its N over all unknowns.
TEST(EquilibriumProblem, SparseTangentAgreesWithTheDenseSumOfItsParts) {
    Body body(7);
    body.add_contacts();
    body.add_pressures();
    const BlockSystem& system = body.system;
    const OwnedProblem& problem = body.problem;
    Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(body.q.size(), body.q.size());
    const auto opening_at = [&](const auto& pair, const Vec2& xi_a, const Vec2& xi_b) -> Shape {
        const Block& a = system.blocks[pair.block_a];
        const Block& b = system.blocks[pair.block_b];
        return shape_at(system, pair.block_b, b.centroid + b.size * xi_b) -
               shape_at(system, pair.block_a, a.centroid + a.size * xi_a);
    };
    const auto add_point = [&](double weight, const Shape& opening, const Vec2& normal, const Vec2& along,
                               const Mat2& tangent) {
        Mat2 frame;
        frame.col(0) = normal;
        frame.col(1) = along;
        sum += weight * opening.transpose() * frame * tangent * frame.transpose() * opening;
    };
    for (int i = 0; i < static_cast<int>(problem.placement.bonds.size()); ++i) {
        const Bond& each = problem.placement.bonds[i];
        for (int k = 0; k < n_bond_points; ++k) {
            add_point(each.weight, opening_at(each, each.xi_a[k], each.xi_b[k]), each.normal(), each.tangent,
                      bond_traction(problem.body, i, k, body.q).tangent);
        }
    }
    for (int i = 0; i < static_cast<int>(problem.placement.contacts.size()); ++i) {
        const ContactPoint& point = problem.placement.contacts[i];
        add_point(point.weight, opening_at(point, point.xi_a, point.xi_b), point.normal, point.tangent,
                  contact_traction(problem.body, i, body.q).tangent);
        const Shape here = opening_at(point, point.xi_a, point.xi_b);
        const Shape whole_overlap =
            opening_at(point, point.xi_a + point.piece.xi_a, point.xi_b + point.piece.xi_b) - here;
        const Vec2 by_tilt = contact_traction(problem.body, i, body.q).by_tilt;
        sum += point.weight * here.transpose() * (by_tilt(0) * point.normal + by_tilt(1) * point.tangent) *
               (point.normal.transpose() * whole_overlap);
    }
    for (int b = 0; b < system.n_blocks(); ++b) {
        const Block& block = system.blocks[b];
        sum.block<4, 4>(6 * b + 2, 6 * b + 2) +=
            elastic_tangent(deformation_gradient(body.q, b, block.size), body.moduli[0], false);
        for (int i = 0; i < 6; ++i) {
            for (int j = 0; j < 6; ++j) {
                sum(6 * b + i, 6 * b + j) += problem.eta[b] * integral(system, b, [&](const Vec2& x) {
                                                 const Shape n = shape_at(system, b, x);
                                                 return n.col(6 * b + i).dot(n.col(6 * b + j));
                                             });
            }
        }
    }
    Mat2 turn; // of an extent to its right normal
    turn << 0, 1, -1, 0;
    for (int boundary = 0; boundary < 4; ++boundary) {
        for (const auto& [b, e] : system.boundaries[boundary].edges) {
            const Edge& edge = system.blocks[b].edges[e];
            const Vec2& start = edge_start(system, edge);
            const Vec2& end = edge_end(system, edge);
            sum += problem.loads.pressures[boundary] * shape_at(system, b, 0.5 * (start + end)).transpose() * turn *
                   (shape_at(system, b, end) - shape_at(system, b, start));
        }
    }
    const Eigen::MatrixXd sparse = tangent_of(problem, body.q, TangentKind::exact);
    EXPECT_LT((sparse - sum).cwiseAbs().maxCoeff(), 1e-12 * sum.cwiseAbs().maxCoeff());
}

// Statics: forces between blocks cancel, so the sum over all blocks is that of the loads, here the weight and 100 MPa on
// the bottom alone, whose resultant is the pressure times the chord of the boundary.
TEST(EquilibriumProblem, ForcesBetweenBlocksCancelInTheSumOverTheBody) {
    Body body(9);
    body.add_contacts();
    body.add_pressures();
    body.problem.loads.pressures = {1e8, 0.0, 0.0, 0.0};
    body.problem.eta.clear();
    const Eigen::VectorXd forces = forces_of(body.problem, at_rest(body.system));
    Vec2 sum = Vec2::Zero();
    for (int b = 0; b < body.system.n_blocks(); ++b) sum += forces.segment<2>(6 * b);
    const Vec2 loads = 2500.0 * 0.5 * 0.4 * body.problem.loads.gravity + Vec2(0.0, 1e8 * 0.5);
    EXPECT_LT((sum + loads).norm(), 1e-10 * forces.norm());
}

// A piece of a hexagon counts with at least the area given: half the area counts twice.
TEST(EquilibriumProblem, SmallBlockCountsWithTheLeastAreaInTheMassLikeTerm) {
    GeometrySpec spec = cut_scenes::rectangle(1.0, 1.0);
    const BlockSystem system = cut_blocks(spec).system;
    OwnedProblem problem;
    problem.body.system = &system;
    problem.eta = {3e6};
    problem.start = at_rest(system);
    Eigen::VectorXd q = at_rest(system);
    q << 0.1, 0.0, 0.0, 0.0, 0.0, 0.0;
    EXPECT_DOUBLE_EQ(viscous_force(problem, q).norm, 3e5);
    EXPECT_DOUBLE_EQ(viscous_force(problem, q).sum, 3e5);
    problem.least_mass_area = 0.5;
    EXPECT_DOUBLE_EQ(viscous_force(problem, q).norm, 3e5);
    problem.least_mass_area = 2.0;
    EXPECT_DOUBLE_EQ(viscous_force(problem, q).norm, 6e5);
    q << 0.0, 0.0, 0.1, 0.0, 0.0, 0.0; // stretching: second moment 1/12 of a unit square
    EXPECT_NEAR(viscous_force(problem, q).norm, 6e5 / 12.0, 1e-6);
}

} // namespace
} // namespace kluft
