#include "kluft/equilibrium/loose_blocks.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "kluft/equilibrium/newton_increment.hpp"
#include "kluft/kinematics/affine.hpp"
#include "kluft/loading/platen.hpp"

namespace kluft {

namespace {

constexpr int most_iterations = 25;
constexpr double clearance = 1e-8;         ///< of the spacing, that is asked for between blocks
constexpr double first_opening = 1e-3;     ///< of the spacing
constexpr double first_force = 0.05;       ///< on each point, of the stress that the body has carried, on the spacing
constexpr double small_products = 1e-9;    ///< of the first ones, where the blocks' places count
constexpr double fairly_small = 1e-6;      ///< the same, where only the forces of platens do
constexpr double small_platen_force = 0.1; ///< of what counts as none
constexpr double small_error = 1e-3;       ///< of the clearance
constexpr double short_of_zero = 0.99;     ///< of the way to where a force or an opening would be zero
constexpr double worthwhile_step = 0.1;    ///< of a prediction: of a shorter one the terms of second order mean nothing
constexpr double least_centring = 1e-3;    ///< of the mean product
constexpr double steepest_friction = 100.0; ///< tangent, on a platen on which all points stick

/// A condition (29f) or (29h) on the motion of two blocks, or of a block and a platen.
struct Gap {
    int block_a = 0;
    int block_b = -1;          ///< none: a platen
    Vec6 row_a = Vec6::Zero(); ///< of the gap, by the numbers of the blocks
    Vec6 row_b = Vec6::Zero();
    double compliance = 0.0; ///< m2/N
    double at_start = 0.0;   ///< less the clearance (m)

    double force = 0.0;   ///< positive: pressing (N/m)
    double opening = 0.0; ///< positive: the gap and what the force has closed of it (m)
    double force_change = 0.0;
    double opening_change = 0.0;
    double error = 0.0;     ///< of the opening, beside the gap at q (m)
    double stiffness = 0.0; ///< of the linearised condition (N/m2)

    [[nodiscard]] double widening(const Eigen::VectorXd& motion) const {
        double sum = row_a.dot(motion.segment<n_block_unknowns>(n_block_unknowns * block_a));
        if (block_b >= 0) sum += row_b.dot(motion.segment<n_block_unknowns>(n_block_unknowns * block_b));
        return sum;
    }

    void add_force_to(Eigen::VectorXd& forces, double size) const {
        forces.segment<n_block_unknowns>(n_block_unknowns * block_a) -= size * row_a;
        if (block_b >= 0) forces.segment<n_block_unknowns>(n_block_unknowns * block_b) -= size * row_b;
    }

    void add_stiffness_to(BlockMatrix& matrix) const {
        const BlockPattern& pattern = *matrix.pattern;
        matrix.values[pattern.diagonal(block_a)] += stiffness * row_a * row_a.transpose();
        if (block_b < 0) return;
        matrix.values[pattern.find(block_a, block_b)] += stiffness * row_a * row_b.transpose();
        matrix.values[pattern.find(block_b, block_a)] += stiffness * row_b * row_a.transpose();
        matrix.values[pattern.diagonal(block_b)] += stiffness * row_b * row_b.transpose();
    }
};

/// The largest shear traction over the pressure: of a law with cohesion where its pressure is small.
double steepest_of(const InterfaceLaw& law) {
    return law.tan_friction + (law.cohesion > 0.0 ? law.cohesion / law.cohesion_onset : 0.0);
}

/// Adds the gap whose opening is less by `slope` times the slip, one way and the other.
void append_sloped(const Gap& normal, const Gap& tangent, double slope, std::vector<Gap>& gaps) {
    for (const double sign : {-1.0, 1.0}) {
        Gap gap = normal;
        gap.row_a += sign * slope * tangent.row_a;
        gap.row_b += sign * slope * tangent.row_b;
        gaps.push_back(gap);
        if (slope == 0.0) return;
    }
}

void append_contacts(const EquilibriumProblem& problem, Passage passage, std::vector<Gap>& gaps) {
    for (const ContactPoint& point : problem.body.placement->contacts) {
        const InterfaceLaw& law = (*problem.body.laws)[point.law];
        Gap normal{.block_a = point.block_a, .block_b = point.block_b};
        Gap tangent = normal;
        normal.row_a = -displacement_row(point.normal, point.xi_a);
        normal.row_b = displacement_row(point.normal, point.xi_b);
        tangent.row_a = -displacement_row(point.tangent, point.xi_a);
        tangent.row_b = displacement_row(point.tangent, point.xi_b);
        normal.compliance = 1.0 / (point.weight * law.normal_stiffness);
        normal.at_start = gap_and_slip(point, problem.start).gap - point.history.dilation;
        append_sloped(normal, tangent, passage == Passage::sliding ? law.tan_dilation : steepest_of(law), gaps);
    }
}

void append_platen_points(const EquilibriumProblem& problem, Passage passage, std::vector<Gap>& gaps) {
    const BlockSystem& system = *problem.body.system;
    const Loads& loads = *problem.body.loads;
    for (const PlatenPoint& point : loads.platen_points) {
        const Platen& platen = *std::ranges::find(loads.platens, point.boundary, &Platen::boundary);
        if (platen.glued || point.contact == PlatenContact::beyond) continue;
        const Vec2 xi = block_coordinates(system.blocks[point.block], system.vertices[point.vertex]);
        Gap normal{.block_a = point.block};
        Gap tangent = normal;
        normal.row_a = -displacement_row(platen.normal, xi);
        tangent.row_a = -displacement_row(platen.tangent(), xi);
        normal.at_start =
            point.reach + platen.moved - platen.normal.dot(displacement_at(problem.start, point.block, xi));
        const double slope = passage == Passage::sliding ? 0.0 : std::min(platen.tan_friction, steepest_friction);
        append_sloped(normal, tangent, slope, gaps);
    }
}

/// A problem without its contacts, and with open platens.
class BareProblem {
public:
    BareProblem(const EquilibriumProblem& problem, const BlockPattern& pattern)
        : loads_(*problem.body.loads), problem_(problem), evaluator_(problem_, pattern) {
        placement_.bonds = problem.body.placement->bonds;
        problem_.body.placement = &placement_;
        problem_.body.loads = &loads_;
        open_platens(problem_.body, problem.start, loads_);
    }
    ~BareProblem() = default;
    BareProblem(const BareProblem&) = delete; // its parts refer to each other
    BareProblem& operator=(const BareProblem&) = delete;

    [[nodiscard]] const Constraints& constraints() const { return loads_.constraints; }
    [[nodiscard]] EquilibriumEvaluator& evaluator() { return evaluator_; }

private:
    Loads loads_;
    Placement placement_;
    EquilibriumProblem problem_;
    EquilibriumEvaluator evaluator_;
};

/// The iteration (29g) on the blocks and on the forces and openings of all gaps.
class InteriorIteration {
public:
    InteriorIteration(const EquilibriumProblem& problem, const BlockPattern& pattern, Passage passage)
        : bare_(problem, pattern), start_(problem.start), passage_(passage) {
        append_contacts(problem, passage, gaps_);
        append_platen_points(problem, passage, gaps_);
        const double spacing = problem.body.system->spacing;
        for (Gap& gap : gaps_) {
            gap.at_start -= clearance * spacing;
            gap.force = first_force * problem.body.carried_stress * spacing;
            gap.opening = std::max(first_opening * spacing, std::abs(gap.at_start));
        }
        first_product_ = mean_product(0.0);
        largest_error_ = small_error * clearance * spacing;
        largest_platen_force_ =
            small_platen_force * negligible_force(problem.body.carried_stress, area_of(*problem.body.system));
    }

    /// Sets up the tangent at q, and what is left of the equations there.
    void linearise(const Eigen::VectorXd& q, BlockMatrix& tangent) {
        bare_.evaluator().reduced_residual(q, of_bare_);
        bare_.evaluator().tangent(q, TangentKind::symmetric, tangent);
        const Eigen::VectorXd moved = q - start_;
        for (Gap& gap : gaps_) {
            const double closed = gap.compliance * gap.force;
            gap.error = error_of(gap, moved);
            gap.stiffness = gap.force / (gap.opening + closed);
            gap.add_stiffness_to(tangent);
        }
        bare_.constraints().correction(q, prescribed_);
        tangent.multiply(prescribed_, of_prescribed_);
        make_free(bare_.constraints(), tangent);
    }

    /// Finds the changes for which all products come to `target`, to first order, or with what the last changes make of the products
    /// beyond it.
    void find_changes(LinearSolver& linear_solver, double target, bool second_order, Eigen::VectorXd& increment) {
        Eigen::VectorXd right_side = of_bare_.forces + of_prescribed_;
        for (Gap& gap : gaps_) {
            const double beyond = second_order ? gap.force_change * gap.opening_change : 0.0;
            gap.force_change =
                (target - beyond - gap.force * (gap.opening + gap.error)) / (gap.opening + gap.compliance * gap.force);
            gap.add_force_to(right_side, gap.force + gap.force_change);
        }
        right_side *= -1.0;
        bare_.constraints().project(right_side);
        linear_solver.solve(right_side, increment);
        bare_.constraints().project(increment);
        increment += prescribed_;
        for (Gap& gap : gaps_) {
            const double widening = gap.widening(increment);
            gap.force_change -= gap.stiffness * widening;
            gap.opening_change = widening + gap.compliance * gap.force_change + gap.error;
        }
    }

    /// The longest step, up to 1, that takes no force and no opening beyond this share of its way to zero.
    [[nodiscard]] double step_length(double share) const {
        double step = 1.0;
        for (const Gap& gap : gaps_) {
            if (gap.force_change < 0.0) step = std::min(step, -share * gap.force / gap.force_change);
            if (gap.opening_change < 0.0) step = std::min(step, -share * gap.opening / gap.opening_change);
        }
        return step;
    }

    /// After a step of this length.
    [[nodiscard]] double mean_product(double step) const {
        double sum = 0.0;
        for (const Gap& gap : gaps_)
            sum += (gap.force + step * gap.force_change) * (gap.opening + step * gap.opening_change);
        return gaps_.empty() ? 0.0 : sum / static_cast<double>(gaps_.size());
    }

    void take(double step) {
        for (Gap& gap : gaps_) {
            gap.force += step * gap.force_change;
            gap.opening += step * gap.opening_change;
            gap.force_change = gap.opening_change = 0.0;
        }
    }

    [[nodiscard]] bool ends(const Eigen::VectorXd& q) const {
        const double small = passage_ == Passage::sliding ? small_products : fairly_small;
        if (mean_product(0.0) > small * first_product_) return false;
        const Eigen::VectorXd moved = q - start_;
        return std::ranges::all_of(gaps_,
                                   [&](const Gap& gap) { return std::abs(error_of(gap, moved)) <= largest_error_; });
    }

    /// Whether the platens do not press.
    [[nodiscard]] bool is_apart() const {
        double sum = 0.0;
        for (const Gap& gap : gaps_)
            if (gap.block_b < 0) sum += gap.force;
        return sum <= largest_platen_force_;
    }

private:
    static double error_of(const Gap& gap, const Eigen::VectorXd& moved) {
        return gap.at_start + gap.widening(moved) + gap.compliance * gap.force - gap.opening;
    }

    BareProblem bare_;
    Eigen::VectorXd start_;
    Passage passage_;
    std::vector<Gap> gaps_;
    double first_product_ = 0.0;        ///< mean (N)
    double largest_error_ = 0.0;        ///< of an opening (m)
    double largest_platen_force_ = 0.0; ///< N/m
    Residual of_bare_;
    Eigen::VectorXd prescribed_, of_prescribed_;
};

} // namespace

PartedBlocks part_blocks(LinearSolver& linear_solver, const EquilibriumProblem& problem, const BlockPattern& pattern,
                         Passage passage) {
    PartedBlocks parted;
    InteriorIteration iteration(problem, pattern, passage);
    Eigen::VectorXd q = problem.start;
    Eigen::VectorXd increment;
    BlockMatrix tangent;
    while (parted.iterations < most_iterations) {
        iteration.linearise(q, tangent);
        if (!linear_solver.factorize(std::move(tangent), Factorization::cholesky)) return parted;
        tangent = BlockMatrix{};
        ++parted.iterations;
        iteration.find_changes(linear_solver, 0.0, false, increment);
        const double predicted = iteration.step_length(1.0);
        const double mean = iteration.mean_product(0.0);
        const double share = mean > 0.0 ? iteration.mean_product(predicted) / mean : 0.0;
        const double centring = std::clamp(share * share * share, least_centring, 1.0);
        iteration.find_changes(linear_solver, centring * mean, predicted > worthwhile_step, increment);
        if (!increment.allFinite()) return parted;
        const double step = iteration.step_length(short_of_zero);
        iteration.take(step);
        q += step * increment;
        if (!iteration.ends(q)) continue;
        if (iteration.is_apart()) parted.displacement = std::move(q);
        return parted;
    }
    return parted;
}

} // namespace kluft
