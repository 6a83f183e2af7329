#include "kluft/simulation/stability.hpp"

#include <utility>
#include <vector>

#include "kluft/assembly/block_columns.hpp"
#include "kluft/assembly/lu_factor.hpp"
#include "kluft/equilibrium/equilibrium_problem.hpp"
#include "kluft/equilibrium/newton_increment.hpp"
#include "kluft/simulation/mass_term.hpp"
#include "kluft/simulation/placement.hpp"
#include "kluft/simulation/state_fields.hpp"

namespace kluft {

namespace {

constexpr int most_unknowns =
    3'000; ///< its factorization with pivoting takes little memory beside the run; of 30 000 four times as much
constexpr double small_viscosity = 1e-6; ///< an equilibrium that is left more slowly than with this one is neutral

BlockPattern pattern_of(const Model& model, const LoadedBody& body) {
    std::vector<std::pair<int, int>> pairs;
    for (const Interface& interface : model.system.interfaces) pairs.emplace_back(interface.block_a, interface.block_b);
    for (const ContactPoint& point : body.placement->contacts) pairs.emplace_back(point.block_a, point.block_b);
    return BlockPattern(model.system.n_blocks(), pairs, model.kinematics);
}

} // namespace

bool is_unstable(const Model& model, const State& state) {
    const int unknowns = unknowns_per_block(model.kinematics) * model.system.n_blocks();
    const bool has_platen = model.loads.stages[static_cast<std::size_t>(state.at.stage)].motion.has_value();
    if (has_platen || unknowns > most_unknowns) return false;
    bool unstable = false;
    with_body_of_state(model, state, [&](const LoadedBody& body) {
        const Eigen::VectorXd& q = state.body.displacement;
        EquilibriumProblem problem{.body = body, .start = q};
        problem.eta.assign(model.system.blocks.size(), mass_coefficient(model, small_viscosity));
        problem.least_mass_area = least_mass_area(model.system);
        const BlockPattern pattern = pattern_of(model, body);
        EquilibriumEvaluator evaluator(problem, pattern);
        Residual residual;
        evaluator.reduced_residual(q, residual);
        BlockMatrix tangent;
        evaluator.tangent(q, TangentKind::exact, tangent);
        make_free(body.loads->constraints, tangent);
        LuFactor factor;
        const std::vector<int> position = elimination_order(pattern); // blocks change places whole: the sign stays
        factor.analyze(pattern, position);
        factor.gather(tangent);
        unstable = factor.factorize() && factor.has_negative_determinant();
    });
    return unstable;
}

std::string unstable_equilibrium_warning(const Model& model, const State& state) {
    if (!is_unstable(model, state)) return {};
    return "the body stands in an equilibrium that is not stable: whatever pushes it a little, it leaves it. It is "
           "symmetric, or has been led "
           "there in few load steps; incline gravity or move a force by a thousandth, and take more steps, to see "
           "where it goes";
}

} // namespace kluft
