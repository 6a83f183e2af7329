// A body between a support and a platen, for tests of equilibria and of the increments that lead to them.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "kluft/constitutive/lattice_stiffness.hpp"
#include "kluft/loading/boundary_geometry.hpp"
#include "support/lattice_body.hpp"
#include "support/owned_problem.hpp"

namespace kluft {

/// A body of hexagons cut by a fracture, pressed from the right; its bottom rests on a smooth support with one vertex
/// held, its top is moved by a platen: by a given displacement, or `travelling` under a given stress.
struct PressedBody {
    static constexpr int bond = 0, joint = 1;

    explicit PressedBody(bool travelling, const std::vector<char>& is_bond, Kinematics kinematics = Kinematics::affine,
                         double spacing = 0.1) {
        GeometrySpec spec = hexagon_spec(0.5, 0.6, spacing, {0.03, 0.04}, bond);
        cut_scenes::add_trace(spec, {{-0.1, 0.25}, {0.6, 0.4}}, joint);
        system = cut_blocks(spec).system;
        problem.body.kinematics = kinematics;
        problem.body.system = &system;
        problem.body.moduli = &moduli;
        problem.body.laws = &laws;
        problem.placement.bonds = bonds_at(system, is_bond, at_rest(system));
        if (!is_bond[joint]) {
            problem.placement.contacts =
                detect_contacts(system, surfaces_of(system, is_bond, laws), at_rest(system), 0.01, {}).points;
        }
        problem.loads.pressure_edges = pressure_edges(system, 1);
        problem.loads.pressures = {0.0, 2e6, 0.0, 0.0};
        std::vector<PrescribedDisplacement> rows;
        add_rows(0, 0.0, 0.0, rows);
        rows.push_back({rows.front().block, rows.front().xi, Vec2::UnitX(), 0, 0.0});
        rows.push_back({rows[2].block, rows[2].xi, Vec2::UnitX(), 0, 0.0});
        add_rows(2, travelling ? 0.0 : -4e-4, travelling ? -1.0 : 0.0, rows);
        problem.loads.constraints =
            kinematics == Kinematics::rigid ? Constraints(rows, system, at_rest(system)) : Constraints(rows);
        if (travelling) {
            problem.loads.platen_force = width_across(system, 2);
            problem.loads.platen_force->stress = 5e6;
        }
    }

    std::vector<InterfaceLaw> laws{{.normal_stiffness = 1e11, .shear_stiffness = 4e10},
                                   {.normal_stiffness = 5e10,
                                    .shear_stiffness = 2e10,
                                    .tan_friction = 0.6,
                                    .contact_rounding = 1e5,
                                    .friction_rounding = 0.1}};
    std::vector<ElasticModuli> moduli{plane_moduli(10e9, 0.25, Plane::strain)};
    BlockSystem system;
    OwnedProblem problem;

private:
    void add_rows(int boundary, double target, double rate, std::vector<PrescribedDisplacement>& rows) const {
        for (const auto& [b, e] : system.boundaries[boundary].edges) {
            const Edge& edge = system.blocks[b].edges[e];
            for (const Vec2& x : {edge_start(system, edge), edge_end(system, edge)}) {
                rows.push_back({b, block_coordinates(system.blocks[b], x), Vec2::UnitY(), boundary, target, rate});
            }
        }
    }
};

/// The rows of the problem's prescribed displacements over its unknowns, and their rates. T of rigid blocks at rest.
struct DenseRows {
    explicit DenseRows(const OwnedProblem& problem) {
        const auto& rows = problem.loads.constraints.rows();
        const int nu = unknowns_per_block(problem.body.kinematics);
        const auto n = static_cast<Eigen::Index>(rows.size());
        matrix = Eigen::MatrixXd::Zero(n, static_cast<Eigen::Index>(nu) * problem.body.system->n_blocks());
        rates.resize(n);
        for (Eigen::Index i = 0; i < n; ++i) {
            const Vec6 row = displacement_row(rows[i].direction, rows[i].xi);
            rates[i] = rows[i].rate;
            if (problem.body.kinematics == Kinematics::rigid) { // w turns about the centroid: dD = (0, 1, -1, 0) dw
                matrix.block<1, 3>(i, 3 * rows[i].block) << row[0], row[1], row[3] - row[4];
            } else {
                matrix.block<1, 6>(i, 6 * rows[i].block) = row.transpose();
            }
        }
    }

    static constexpr double scale = 1e10; ///< of the rows beside a tangent, as stiff as the body: a good condition

    /// The matrix of (dq, multipliers, travel) in K dq + C' multipliers = b and C dq - rates travel = c, in which the
    /// rows and c count `scale` times; its last row is left zero for the equation of the travel.
    [[nodiscard]] Eigen::MatrixXd bordered(const Eigen::MatrixXd& tangent) const {
        const Eigen::Index n = tangent.rows(), m = rates.size();
        Eigen::MatrixXd system = Eigen::MatrixXd::Zero(n + m + 1, n + m + 1);
        system.topLeftCorner(n, n) = tangent;
        system.block(0, n, n, m) = scale * matrix.transpose();
        system.block(n, 0, m, n) = scale * matrix;
        system.block(n, n + m, m, 1) = -scale * rates;
        return system;
    }

    Eigen::MatrixXd matrix; ///< one row per prescribed displacement
    Eigen::VectorXd rates;  ///< of a travelling platen's rows
};

} // namespace kluft
