#include "kluft/calibration/elastic_body.hpp"

#include <utility>
#include <vector>

#include <fmt/format.h>

#include "kluft/assembly/linear_solver.hpp"
#include "kluft/constitutive/block_elasticity.hpp"
#include "kluft/core/diagnostics.hpp"
#include "kluft/equilibrium/boundary_terms.hpp"
#include "kluft/equilibrium/equilibrium_problem.hpp"
#include "kluft/kinematics/rigid.hpp"
#include "kluft/loading/boundary_geometry.hpp"
#include "kluft/simulation/measurements.hpp"
#include "kluft/simulation/stage_loads.hpp"

namespace kluft {

namespace {

constexpr double unit_strain = 1.0; // all is linear in it

/// The loads of a test between smooth platens alone.
LoadProgram compression_test(const Model& model, int boundary) {
    LoadProgram program;
    program.supports.assign(model.system.boundaries.size(), Support::none);
    Stage stage;
    stage.name = "elastic test";
    stage.motion = PlatenMotion{
        .control = PlatenControl::strain, .boundary = boundary, .value = unit_strain, .glued = true, .place = ""};
    program.stages.push_back(std::move(stage));
    return program;
}

/// Of all interfaces, mapped fractures too, in the frames of the body as it was cut.
std::vector<Bond> all_interfaces(const BlockSystem& system, const Eigen::VectorXd& at_rest) {
    const double no_shear[n_bond_points] = {};
    std::vector<Bond> bonds;
    for (int i = 0; i < system.n_interfaces(); ++i) bonds.push_back(bond_at(system, i, at_rest, no_shear));
    return bonds;
}

BlockPattern pattern_of_bonds(const Model& model, const std::vector<Bond>& bonds) {
    std::vector<std::pair<int, int>> pairs;
    for (const Bond& bond : bonds) pairs.emplace_back(bond.block_a, bond.block_b);
    return {model.system.n_blocks(), pairs, model.kinematics};
}

/// Per unknown of all blocks, six each: the lateral strain, positive in extension, as histories measure it.
Eigen::VectorXd lateral_extension(const Model& model, const Gauges& gauges) {
    const BlockSystem& system = model.system;
    Eigen::VectorXd row = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(n_block_unknowns) * system.n_blocks());
    for (const Side& side : gauges.lateral) {
        for (const SidePart& part : side) {
            const Vec2 normal = boundary_frame(system, part.boundary).normal;
            for (std::size_t i = 0; i < part.edges.size(); ++i) {
                const auto& [b, e] = part.edges[i];
                const Edge& edge = system.blocks[b].edges[e];
                const Vec2 xi =
                    block_coordinates(system.blocks[b], 0.5 * (edge_start(system, edge) + edge_end(system, edge)));
                row.segment<n_block_unknowns>(n_block_unknowns * b) +=
                    part.shares[i] / gauges.width * displacement_row(normal, xi);
            }
        }
    }
    return row;
}

Gauges gauges_of_specimen(const Model& model) {
    Gauges gauges = make_gauges(model);
    if (gauges.moved < 0 || gauges.opposite < 0)
        throw InputError("boundaries: expected two opposite boundaries with names, between which the body is "
                         "compressed for youngs_modulus and poissons_ratio; found none");
    if (gauges.lateral[0].empty())
        throw InputError(fmt::format("boundaries: expected two boundaries across '{}', on which the lateral strain is "
                                     "measured for youngs_modulus and poissons_ratio; found none",
                                     model.system.boundaries[gauges.moved].name));
    return gauges;
}

double product(const Mat4& matrix, const Eigen::VectorXd& a, const Eigen::VectorXd& b, int block) {
    const int first = n_block_unknowns * block + 2;
    return a.segment<4>(first).dot(matrix * b.segment<4>(first));
}

/// a' (dK/dp) b for each elastic property p; a, b: six numbers per block.
Eigen::VectorXd by_properties(const Model& model, const std::vector<Bond>& bonds, const Eigen::VectorXd& a,
                              const Eigen::VectorXd& b) {
    const auto n_laws = static_cast<Eigen::Index>(model.laws.size());
    Eigen::VectorXd result = Eigen::VectorXd::Zero(2 * n_laws + 2 * static_cast<Eigen::Index>(model.moduli.size()) + 1);
    for (const Bond& bond : bonds) {
        for (int k = 0; k < n_bond_points; ++k) {
            const Vec2 of_a = relative_displacement(bond, k, a);
            const Vec2 of_b = relative_displacement(bond, k, b);
            result[2 * bond.law] += bond.weight * bond.normal().dot(of_a) * bond.normal().dot(of_b);
            result[2 * bond.law + 1] += bond.weight * bond.tangent.dot(of_a) * bond.tangent.dot(of_b);
        }
    }
    if (model.kinematics == Kinematics::rigid) return result;
    const Mat4 by_lambda = elastic_tangent(Mat2::Identity(), {.lambda = 1.0, .mu = 0.0}, true);
    const Mat4 by_mu = elastic_tangent(Mat2::Identity(), {.lambda = 0.0, .mu = 1.0}, true);
    for (int i = 0; i < model.system.n_blocks(); ++i) {
        const Eigen::Index at = 2 * (n_laws + model.system.blocks[i].material);
        result[at] += product(by_lambda, a, b, i);
        result[at + 1] += product(by_mu, a, b, i);
    }
    return result;
}

void set_properties(const Eigen::VectorXd& properties, Model& model) {
    Eigen::Index next = 0;
    for (InterfaceLaw& law : model.laws) {
        law.normal_stiffness = properties[next++];
        law.shear_stiffness = properties[next++];
    }
    for (ElasticModuli& moduli : model.moduli) {
        moduli.lambda = properties[next++];
        moduli.mu = properties[next++];
    }
    if (model.compliance_across) model.compliance_across = properties[next];
}

/// The slopes of the test and their derivatives.
struct Slopes {
    double axial = 0.0;   ///< axial stress over axial strain (Pa)
    double lateral = 0.0; ///< lateral extension over axial strain
    Eigen::VectorXd axial_gradient;
    Eigen::VectorXd lateral_gradient;
};

/// docs/theory.md, (41a).
ElasticResponse constants_with_fractures(const Slopes& slopes, double compliance_across) {
    ElasticResponse body;
    const double lateral = slopes.lateral / slopes.axial; // compliance
    body.youngs_modulus = 1.0 / (1.0 / slopes.axial + compliance_across);
    body.poissons_ratio = (lateral - compliance_across) * body.youngs_modulus;
    const Eigen::Index n = slopes.axial_gradient.size();
    Eigen::VectorXd compliance_gradient = -slopes.axial_gradient / (slopes.axial * slopes.axial);
    Eigen::VectorXd lateral_gradient = slopes.lateral_gradient / slopes.axial + slopes.lateral * compliance_gradient;
    compliance_gradient[n - 1] += 1.0; // the last property is the compliance across
    lateral_gradient[n - 1] -= 1.0;
    body.modulus_gradient = -body.youngs_modulus * body.youngs_modulus * compliance_gradient;
    body.ratio_gradient =
        body.youngs_modulus * lateral_gradient + (lateral - compliance_across) * body.modulus_gradient;
    return body;
}

ElasticResponse rock_constants(const Slopes& slopes, Plane plane) {
    if (plane == Plane::stress) return {slopes.axial, slopes.lateral, slopes.axial_gradient, slopes.lateral_gradient};
    ElasticResponse rock;
    const double sum = 1.0 + slopes.lateral;
    rock.poissons_ratio = slopes.lateral / sum;
    rock.ratio_gradient = slopes.lateral_gradient / (sum * sum);
    const double reduction = 1.0 - rock.poissons_ratio * rock.poissons_ratio;
    rock.youngs_modulus = slopes.axial * reduction;
    rock.modulus_gradient =
        reduction * slopes.axial_gradient - 2.0 * slopes.axial * rock.poissons_ratio * rock.ratio_gradient;
    return rock;
}

} // namespace

Eigen::VectorXd elastic_properties(const Model& model) {
    Eigen::VectorXd properties(static_cast<Eigen::Index>(2 * (model.laws.size() + model.moduli.size()) + 1));
    Eigen::Index next = 0;
    for (const InterfaceLaw& law : model.laws) {
        properties[next++] = law.normal_stiffness;
        properties[next++] = law.shear_stiffness;
    }
    for (const ElasticModuli& moduli : model.moduli) {
        properties[next++] = moduli.lambda;
        properties[next++] = moduli.mu;
    }
    properties[next] = model.compliance_across.value_or(0.0);
    return properties;
}

struct ElasticBody::Specimen {
    explicit Specimen(const Model& whole) : model(whole), gauges(gauges_of_specimen(whole)) {
        model.loads = compression_test(model, gauges.moved);
        at_rest.setZero(static_cast<Eigen::Index>(n_block_unknowns) * model.system.n_blocks());
        const StageStart start{at_rest, std::vector<double>(model.system.boundaries.size(), 0.0)};
        loads.constraints = StageLoads(model, start, model.loads.stages.front()).constraints();
        loads.constraints.move_to(1.0);
        placement.bonds = all_interfaces(model.system, at_rest);
        pattern = pattern_of_bonds(model, placement.bonds);
        lateral = lateral_extension(model, gauges);
        solver.analyze(pattern);
    }

    /// Six numbers per block of a small motion of the unknowns.
    [[nodiscard]] Eigen::VectorXd six_numbers(const Eigen::VectorXd& unknowns) const {
        if (model.kinematics == Kinematics::affine) return unknowns;
        Eigen::VectorXd q = at_rest;
        for (int b = 0; b < model.system.n_blocks(); ++b)
            q.segment<n_block_unknowns>(n_block_unknowns * b) =
                rigid_motion(at_rest, b, model.system.blocks[b].size) *
                unknowns.segment<n_rigid_unknowns>(n_rigid_unknowns * b);
        return q;
    }

    [[nodiscard]] BlockMatrix stiffness() {
        EquilibriumProblem problem;
        problem.body = {.kinematics = model.kinematics,
                        .system = &model.system,
                        .moduli = &model.moduli,
                        .laws = &model.laws,
                        .placement = &placement,
                        .loads = &loads};
        EquilibriumEvaluator evaluator(problem, pattern);
        Residual at_start;
        evaluator.reduced_residual(at_rest, at_start);
        BlockMatrix matrix;
        matrix.reset(pattern);
        evaluator.tangent(at_rest, TangentKind::symmetric, matrix);
        return matrix;
    }

    [[nodiscard]] Eigen::VectorXd on_unknowns(const Eigen::VectorXd& forces) const {
        Coordinates coordinates(model.system, model.kinematics);
        coordinates.turn_to(at_rest);
        Eigen::VectorXd reduced;
        coordinates.reduce(forces, reduced);
        return reduced;
    }

    Slopes slopes() {
        BlockMatrix matrix = stiffness();
        const Constraints& held = loads.constraints;
        Eigen::VectorXd prescribed;
        held.correction(at_rest, prescribed);
        Eigen::VectorXd forces;
        matrix.multiply(prescribed, forces);
        Eigen::VectorXd right_side = -forces;
        held.project(right_side);
        Eigen::VectorXd adjoint_side = on_unknowns(lateral);
        held.project(adjoint_side);
        project(held, matrix, matrix.trace() / (pattern.block_unknowns() * pattern.n_blocks()));
        if (!solver.factorize(std::move(matrix), Factorization::cholesky))
            throw InputError("the elastic body has no equilibrium: a part of it is held by nothing, or a stiffness is "
                             "zero");
        Eigen::VectorXd free, adjoint;
        solver.solve(right_side, free);
        solver.solve(adjoint_side, adjoint);
        held.project(free);
        held.project(adjoint);
        const Eigen::VectorXd q = six_numbers(prescribed + free);
        const Eigen::VectorXd z = six_numbers(adjoint);
        Slopes result;
        const double per_energy = 1.0 / (gauges.length * gauges.width * unit_strain);
        result.axial_gradient = per_energy * by_properties(model, placement.bonds, q, q);
        result.axial = result.axial_gradient.dot(elastic_properties(model)); // the energy is linear in the properties
        result.lateral = lateral.dot(q) / unit_strain;
        result.lateral_gradient = -by_properties(model, placement.bonds, z, q) / unit_strain;
        return result;
    }

    Model model;
    Gauges gauges;
    Eigen::VectorXd at_rest; ///< size 6 n_blocks
    Loads loads;
    Placement placement;
    BlockPattern pattern;
    Eigen::VectorXd lateral; ///< row of the lateral extension
    LinearSolver solver;
};

ElasticBody::ElasticBody(const Model& model) : specimen_(std::make_unique<Specimen>(model)) {}
ElasticBody::ElasticBody(ElasticBody&&) noexcept = default;
ElasticBody& ElasticBody::operator=(ElasticBody&&) noexcept = default;
ElasticBody::~ElasticBody() = default;

ElasticResponse ElasticBody::response(const Eigen::VectorXd& properties) {
    set_properties(properties, specimen_->model);
    const Slopes slopes = specimen_->slopes();
    const auto& across = specimen_->model.compliance_across;
    return across ? constants_with_fractures(slopes, *across) : rock_constants(slopes, specimen_->model.plane);
}

} // namespace kluft
