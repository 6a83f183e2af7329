#include "kluft/equilibrium/loose_blocks.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "interior_point.hpp"
#include "kluft/kinematics/affine.hpp"
#include "kluft/loading/platen.hpp"

namespace kluft {

namespace {

constexpr double steepest_friction =
    100.0; ///< tangent: of a platen on which all points stick, and beside friction of cohesion

constexpr double eta_of_following = 1e-5; ///< of that of (26), where it is asked whether the platens can be followed
constexpr double opening_friction =
    7.0;                                ///< first openings, of the motion of the platens, where friction opens contacts
constexpr double enough_viscous = 0.5;  ///< of the work of platens that are followed
constexpr double known_well = 0.01;     ///< of that work: what the products may still be off
constexpr double followed_error = 1e-4; ///< of the motion of the platens

constexpr double eta_of_parting = 1e-3;  ///< of that of (26)
constexpr double clearance = 1e-8;       ///< of the spacing, that is asked for between blocks
constexpr double least_clearance = 1e-3; ///< of the motion of the platens: not more than this
constexpr double small_products = 5e-7;  ///< of the first ones
constexpr double parted_error = 1e-3;    ///< of the clearance
constexpr double first_force = 1e-4;     ///< of the stiffness times the motion of the platens
constexpr double least_limit = 1e-6;     ///< of the first force: friction that holds nothing
constexpr double small_change = 0.1;     ///< of the motion, from one set of limits to the next
constexpr int most_limits = 5;           ///< sets of friction limits

/// A point where two blocks, or a block and a platen, may press on each other.
struct Spot {
    RelativeDisplacement widening, slip;
    double at_start = 0.0;     ///< gap (m)
    double compliance = 0.0;   ///< m2/N
    double tan_friction = 0.0; ///< of the shear force over the pressing force
    double tan_dilation = 0.0;
    double cohesion = 0.0; ///< N/m
    double onset = 0.0;    ///< pressing force from which the cohesion is whole (N/m)
    double pressing = 0.0; ///< force, at the start or as found last (N/m)

    /// The steepest that the shear force rises with small pressing forces.
    [[nodiscard]] double steepest() const {
        return tan_friction + (cohesion > 0.0 ? std::min(cohesion / onset, steepest_friction) : 0.0);
    }
    /// Of the shear force beside what dilation resists.
    [[nodiscard]] double friction_limit() const {
        if (pressing <= 0.0) return 0.0;
        return (tan_friction - tan_dilation) * pressing + cohesion * std::min(1.0, pressing / onset);
    }
};

void append_contacts(const EquilibriumProblem& problem, std::vector<Spot>& spots) {
    for (const ContactPoint& point : problem.body.placement->contacts) {
        const InterfaceLaw& law = (*problem.body.laws)[point.law];
        const double gap = gap_and_slip(point, problem.start).gap - point.history.dilation;
        const double pressure = contact_pressure(law, gap).value;
        Spot spot;
        spot.widening = {point.block_a, point.block_b, -displacement_row(point.normal, point.xi_a),
                         displacement_row(point.normal, point.xi_b)};
        spot.slip = {point.block_a, point.block_b, -displacement_row(point.tangent, point.xi_a),
                     displacement_row(point.tangent, point.xi_b)};
        spot.at_start = pressure > 0.0 ? -pressure / law.normal_stiffness : gap;
        spot.compliance = 1.0 / (point.weight * law.normal_stiffness);
        spot.tan_friction = law.tan_friction;
        spot.tan_dilation = law.tan_dilation;
        spot.cohesion = law.cohesion * point.weight;
        spot.onset = law.cohesion_onset * point.weight;
        spot.pressing = pressure * point.weight;
        spots.push_back(spot);
    }
}

void append_platen_points(const EquilibriumProblem& problem, std::vector<Spot>& spots) {
    const BlockSystem& system = *problem.body.system;
    const Loads& loads = *problem.body.loads;
    for (const PlatenPoint& point : loads.platen_points) {
        const Platen& platen = *std::ranges::find(loads.platens, point.boundary, &Platen::boundary);
        if (platen.glued || point.contact == PlatenContact::beyond) continue;
        const Vec2 xi = block_coordinates(system.blocks[point.block], system.vertices[point.vertex]);
        Spot spot;
        spot.widening = {.block_a = point.block, .row_a = -displacement_row(platen.normal, xi)};
        spot.slip = {.block_a = point.block, .row_a = -displacement_row(platen.tangent(), xi)};
        spot.at_start = point.reach + platen.moved - platen.normal.dot(displacement_at(problem.start, point.block, xi));
        spot.tan_friction = std::min(platen.tan_friction, steepest_friction);
        spots.push_back(spot);
    }
}

bool is_of_platen(const Spot& spot) { return spot.widening.block_b < 0; }

/// How far the platens have moved into the body as it lies at the start (m).
double motion_of_platens(const std::vector<Spot>& spots) {
    double farthest = 0.0;
    for (const Spot& spot : spots)
        if (is_of_platen(spot)) farthest = std::max(farthest, -spot.at_start);
    return farthest;
}

/// A force that hardly deforms the stiffest material over such a motion (N/m).
double small_force(const LoadedBody& body, double motion) {
    double modulus = 0.0;
    for (const ElasticModuli& moduli : *body.moduli) modulus = std::max(modulus, 2.0 * moduli.mu + moduli.lambda);
    return first_force * modulus * motion;
}

/// Adds the conditions that a gap opens by `slope` times the slip, one way and the other.
void append_gaps(const Spot& spot, int index, double slope, double clear, std::vector<GapCondition>& gaps) {
    for (const double sign : {-1.0, 1.0}) {
        GapCondition gap{
            .widening = spot.widening, .at_start = spot.at_start - clear, .compliance = spot.compliance, .spot = index};
        gap.widening.row_a += sign * slope * spot.slip.row_a;
        gap.widening.row_b += sign * slope * spot.slip.row_b;
        gaps.push_back(gap);
        if (slope == 0.0) return;
    }
}

/// Ways of at least this length, and forces that make all products alike.
void begin_gaps(double way, double force, std::vector<GapCondition>& gaps) {
    for (GapCondition& gap : gaps) {
        gap.pair.way = std::max(way, gap.at_start);
        gap.pair.force = force * way / gap.pair.way;
    }
}

/// Of the platens along a motion (N).
double work_of_platens(const std::vector<GapCondition>& gaps, const Eigen::VectorXd& motion) {
    double sum = 0.0;
    for (const GapCondition& gap : gaps)
        if (gap.widening.block_b < 0) sum += gap.pair.force * gap.widening.of(motion);
    return sum;
}

/// Whether the platens can be followed by a motion that friction cannot resist. Source: (29h).
bool can_follow(LinearSolver& linear_solver, const EquilibriumProblem& problem, const BlockPattern& pattern,
                const std::vector<Spot>& spots, int& n_systems) {
    const double motion = motion_of_platens(spots);
    BareProblem bare(problem, pattern, eta_of_following);
    MotionConditions conditions;
    for (std::size_t i = 0; i < spots.size(); ++i)
        append_gaps(spots[i], static_cast<int>(i), spots[i].steepest(), 0.0, conditions.gaps);
    begin_gaps(opening_friction * motion, small_force(problem.body, motion), conditions.gaps);
    Eigen::VectorXd q = problem.start;
    bool follows = false;
    const auto ends = [&](const Eigen::VectorXd& at) {
        if (conditions.largest_error(at - problem.start) > followed_error * motion) return false;
        const double work = work_of_platens(conditions.gaps, at - problem.start);
        follows = enough_viscous * work <= bare.viscous_work(at);
        return follows || conditions.mean_product() * static_cast<double>(conditions.gaps.size()) <= known_well * work;
    };
    return find_motion(linear_solver, bare, conditions, q, n_systems, ends) && follows;
}

/// Where blocks go that rub with the friction limits of these forces on the spots. Source: (29f).
std::optional<Eigen::VectorXd> part_with_limits(LinearSolver& linear_solver, const EquilibriumProblem& problem,
                                                const BlockPattern& pattern, std::vector<Spot>& spots, int& n_systems) {
    const double motion = motion_of_platens(spots);
    const double force = small_force(problem.body, motion);
    const double clear = std::min(clearance * problem.body.system->spacing, least_clearance * motion);
    BareProblem bare(problem, pattern, eta_of_parting);
    MotionConditions conditions;
    for (std::size_t i = 0; i < spots.size(); ++i) {
        const Spot& spot = spots[i];
        append_gaps(spot, static_cast<int>(i), spot.tan_dilation, spot.pressing > 0.0 ? 0.0 : clear, conditions.gaps);
        const double limit = spot.friction_limit();
        if (limit <= least_limit * force) continue;
        const ComplementaryPair pair{.force = limit, .way = motion * std::min(1.0, force / limit)};
        conditions.frictions.push_back({.slip = spot.slip, .forth = pair, .back = pair});
    }
    begin_gaps(motion, force, conditions.gaps);
    const double first_product = conditions.mean_product();
    Eigen::VectorXd q = problem.start;
    const bool found = find_motion(linear_solver, bare, conditions, q, n_systems, [&](const Eigen::VectorXd& at) {
        return conditions.mean_product() <= small_products * first_product &&
               conditions.largest_error(at - problem.start) <= parted_error * clear;
    });
    if (!found) return std::nullopt;
    for (Spot& spot : spots) spot.pressing = 0.0;
    for (const GapCondition& gap : conditions.gaps) spots[gap.spot].pressing += gap.pair.force;
    return q;
}

} // namespace

PartedBlocks part_blocks(LinearSolver& linear_solver, const EquilibriumProblem& problem, const BlockPattern& pattern) {
    PartedBlocks parted;
    std::vector<Spot> spots;
    append_contacts(problem, spots);
    append_platen_points(problem, spots);
    if (motion_of_platens(spots) <= 0.0) return parted;
    if (!can_follow(linear_solver, problem, pattern, spots, parted.iterations)) return parted;
    const BlockSystem& system = *problem.body.system;
    Eigen::VectorXd last = problem.start;
    for (int i = 0; i < most_limits; ++i) {
        auto q = part_with_limits(linear_solver, problem, pattern, spots, parted.iterations);
        if (!q) return parted;
        const double change = relative_motion(system, *q - last);
        last = std::move(*q);
        if (change <= small_change * relative_motion(system, last - problem.start)) break;
    }
    parted.displacement = std::move(last);
    return parted;
}

} // namespace kluft
