#include "kluft/equilibrium/stiffness_reference.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "support/lattice_body.hpp"
#include "support/owned_problem.hpp"

namespace kluft {
namespace {

/// A body of hexagons cut by a fracture.
struct CutBody {
    static constexpr int bond = 0, joint = 1;

    CutBody() {
        GeometrySpec spec = hexagon_spec(0.5, 0.6, 0.1, {0.03, 0.04}, bond);
        cut_scenes::add_trace(spec, {{-0.1, 0.25}, {0.6, 0.4}}, joint);
        system = cut_blocks(spec).system;
        set_bonds({1, 0});
    }

    /// Which interface types are bonds; the others are fractures, detected in the body as it was cut.
    void set_bonds(const std::vector<char>& is_bond) {
        problem.body.system = &system;
        problem.body.moduli = &moduli;
        problem.body.laws = &laws;
        problem.placement.bonds = bonds_at(system, is_bond, at_rest(system));
        problem.placement.contacts =
            detect_contacts(system, surfaces_of(system, is_bond, laws), at_rest(system), 0.01, {}).points;
    }

    /// The symmetric tangent of bonds and contacts alone, dense.
    [[nodiscard]] Eigen::MatrixXd stiffness_of_interfaces(const Eigen::VectorXd& q) const {
        const auto tangent = [&](const EquilibriumProblem& p) {
            const BlockPattern pairs = pattern_of(problem);
            BlockMatrix stiffness;
            EquilibriumEvaluator(p, pairs).tangent(q, TangentKind::symmetric, stiffness);
            return dense(stiffness);
        };
        OwnedProblem without = problem;
        without.placement.bonds.clear();
        without.placement.contacts.clear();
        return tangent(problem) - tangent(without);
    }

    /// The symmetric tangent; lives until the next one.
    [[nodiscard]] const BlockMatrix& tangent(const Eigen::VectorXd& q) const {
        pattern = pattern_of(problem);
        EquilibriumEvaluator(problem, pattern).tangent(q, TangentKind::symmetric, matrix);
        return matrix;
    }

    /// The blocks above the fracture move as one.
    [[nodiscard]] Eigen::VectorXd moved_above(const Vec2& by) const {
        Eigen::VectorXd q = at_rest(system);
        for (int b = 0; b < system.n_blocks(); ++b) {
            const Vec2 at = system.blocks[b].centroid + system.origin;
            if (at.y() > 0.25 + 0.15 / 0.7 * (at.x() + 0.1)) q.segment<2>(n_block_unknowns * b) = by;
        }
        return q;
    }

    std::vector<InterfaceLaw> laws{{.normal_stiffness = 1e11, .shear_stiffness = 4e10},
                                   {.normal_stiffness = 5e10, .shear_stiffness = 2e10, .tan_friction = 0.6}};
    std::vector<ElasticModuli> moduli{plane_moduli(10e9, 0.25, Plane::strain)};
    BlockSystem system;
    OwnedProblem problem;
    mutable BlockPattern pattern;
    mutable BlockMatrix matrix;
};

/// What the changes add to a stiffness, entry by entry.
Eigen::MatrixXd dense(const std::vector<StiffnessChange>& changes, Eigen::Index n) {
    Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(n, n);
    for (const StiffnessChange& change : changes) {
        Eigen::MatrixXd rows = Eigen::MatrixXd::Zero(4, n);
        rows.middleCols<6>(6 * change.block_a) += change.rows_a;
        rows.middleCols<6>(6 * change.block_b) += change.rows_b;
        sum += rows.transpose() * change.stiffness * rows;
    }
    return sum;
}

TEST(StiffnessReference, HasNoChangesWhereNothingHasChanged) {
    const CutBody body;
    const Eigen::VectorXd q = body.moved_above({0.0, -1e-4});
    StiffnessReference reference;
    EXPECT_FALSE(reference.taken());
    reference.take(body.problem, q, TangentKind::symmetric, body.tangent(q));
    EXPECT_TRUE(reference.taken());
    EXPECT_TRUE(reference.changes(body.problem, q).empty());
    EXPECT_TRUE(reference.changes(body.problem, body.moved_above({0.0, -1.1e-4})).empty());
}

// The expected change is the difference of the assembled tangents. Three points of an overlap are four rows.
TEST(StiffnessReference, ChangesOfContactsAreTheDifferenceOfTheTangents) {
    const CutBody body;
    const Eigen::VectorXd closed = body.moved_above({0.0, -1e-4});
    const auto expect_difference = [&](const Eigen::VectorXd& from, const Eigen::VectorXd& to, const char* what) {
        StiffnessReference reference;
        reference.take(body.problem, from, TangentKind::symmetric, body.tangent(from));
        const auto& changes = reference.changes(body.problem, to);
        EXPECT_GT(changes.size(), 5U) << what;
        const Eigen::MatrixXd expected = body.stiffness_of_interfaces(to) - body.stiffness_of_interfaces(from);
        EXPECT_GT(expected.norm(), 1e8) << what;
        EXPECT_LT((dense(changes, closed.size()) - expected).norm(), 1e-9 * expected.norm()) << what;
    };
    expect_difference(closed, body.moved_above({0.0, 1e-4}), "opens");
    expect_difference(body.moved_above({0.0, 1e-4}), closed, "closes");
    expect_difference(closed, body.moved_above({1e-3, -1e-4}), "slides");
}

// All interfaces of one type fail at once: bonds of two Gauss points go, fractures of three points come, on the same
// edges. Those that are pressed together and locked are as stiff as before.
TEST(StiffnessReference, BrokenBondsAreChangesUnlessTheyStayLocked) {
    for (const bool opens : {true, false}) {
        CutBody body;
        const Eigen::VectorXd q = body.moved_above({0.0, opens ? 1e-4 : -1e-4});
        body.set_bonds({1, 1});
        const Eigen::MatrixXd bonded = body.stiffness_of_interfaces(q);
        StiffnessReference reference;
        reference.take(body.problem, q, TangentKind::symmetric, body.tangent(q));
        EXPECT_TRUE(reference.changes(body.problem, q).empty());
        body.set_bonds({1, 0});
        const auto& changes = reference.changes(body.problem, q);
        const Eigen::MatrixXd expected = body.stiffness_of_interfaces(q) - bonded;
        EXPECT_EQ(changes.size() > 5, opens);
        EXPECT_EQ(changes.empty(), !opens);
        EXPECT_LT((dense(changes, q.size()) - expected).norm(), 1e-9 * bonded.norm());
    }
}

// The expected change is the difference of the assembled tangents.
TEST(StiffnessReference, MassesThatCountAreChangesAndOthersAreNot) {
    CutBody body;
    const Eigen::VectorXd q = body.moved_above({0.0, -1e-4});
    body.problem.eta.assign(body.system.blocks.size(), 1e6);
    const Eigen::MatrixXd before = dense(body.tangent(q));
    StiffnessReference reference;
    reference.take(body.problem, q, TangentKind::symmetric, body.tangent(q));
    body.problem.eta[0] = 4e6; // against springs of 5e10 Pa/m
    EXPECT_TRUE(reference.changes(body.problem, q).empty());
    body.problem.eta[0] = 1e6;
    body.problem.eta[1] = 1e14;
    const auto& changes = reference.changes(body.problem, q);
    EXPECT_EQ(changes.size(), 2U);
    const Eigen::MatrixXd expected = dense(body.tangent(q)) - before;
    EXPECT_LT((dense(changes, q.size()) - expected).norm(), 1e-9 * expected.norm());
}

TEST(StiffnessReference, PatchKeepsItsNumberAsLongAsTheFactorLives) {
    const CutBody body;
    const Eigen::VectorXd closed = body.moved_above({0.0, -1e-4});
    StiffnessReference reference;
    reference.take(body.problem, closed, TangentKind::symmetric, body.tangent(closed));
    const auto first = reference.changes(body.problem, body.moved_above({0.0, 1e-4}));
    const auto second = reference.changes(body.problem, body.moved_above({0.0, 2e-4}));
    ASSERT_EQ(first.size(), second.size());
    for (std::size_t i = 0; i < first.size(); ++i) EXPECT_EQ(first[i].patch, second[i].patch);
}

} // namespace
} // namespace kluft
