#include "kluft/simulation/causes.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>

#include <fmt/format.h>

#include "kluft/geometry/polygon.hpp"
#include "kluft/simulation/placement.hpp"
#include "kluft/simulation/whole_body.hpp"

namespace kluft {

namespace {

constexpr double no_resultant = 1e-6;    ///< of the magnitudes of the loads
constexpr double clear_resultant = 0.01; ///< of these: more than what solver.balance leaves over
constexpr double whole_body = 0.9;       ///< of the area of the blocks: if so much moves, the body does
constexpr double suspicious_strain = 0.05;

/// Forces and moment of the loads on the body before it moved.
Vec3 resultant(const Model& model, const WholeBody& body, const Eigen::VectorXd& forces) {
    Vec3 sum = Vec3::Zero();
    for (int b = 0; b < model.system.n_blocks(); ++b) {
        const double* f = forces.data() + n_block_unknowns * b;
        const Block& block = model.system.blocks[b];
        sum += body.row(block.centroid, Vec2(f[0], f[1]));
        sum(2) += block.size * (f[3] - f[4]) / body.extent;
    }
    return sum;
}

/// Of all loads on the body before it moved.
struct WholeLoad {
    Vec3 sum;               ///< forces and moment (N/m)
    double magnitude = 0.0; ///< sum of the blocks' (N/m)
};

WholeLoad whole_load(const Model& model, const WholeBody& body, const LoadsAt& at) {
    const Placement without_contacts;
    const LoadedBody loaded = loaded_body(model, without_contacts, at);
    const Eigen::VectorXd at_rest =
        Eigen::VectorXd::Zero(static_cast<Eigen::Index>(n_block_unknowns) * model.system.n_blocks());
    Eigen::VectorXd forces;
    external_forces(loaded, at_rest, forces);
    WholeLoad load{.sum = resultant(model, body, forces)};
    for (const double each : load_magnitudes(loaded, at_rest)) load.magnitude += each;
    return load;
}

std::string pressures_in_words(const Model& model, const Loads& loads) {
    std::string text;
    for (std::size_t i = 0; i < loads.pressures.size(); ++i) {
        const Boundary& boundary = model.system.boundaries[i];
        if (boundary.edges.empty()) continue;
        text += fmt::format("{}{} {:.4g}", text.empty() ? "" : ", ", boundary.name, 1e-6 * loads.pressures[i]);
    }
    const bool any = std::ranges::any_of(loads.pressures, [](double p) { return p != 0.0; });
    return any ? fmt::format(" (pressures in MPa: {})", text) : "";
}

bool is_turn(const Vec3& motion) { return std::abs(motion(2)) > motion.head<2>().norm(); }

std::string direction_in_words(const Vec3& motion) {
    const Vec2 direction = motion.head<2>().normalized() + Vec2::Zero(); // no -0
    return fmt::format("({:.2g}, {:.2g})", direction.x(), direction.y());
}

std::string push_in_words(const Model& model, const Loads& loads, const Vec3& motion, double force) {
    const Vec3 along = force < 0.0 ? Vec3(-motion) : motion;
    if (is_turn(along))
        return fmt::format("the loads turn the body, and neither a support nor a platen holds it against that{}",
                           pressures_in_words(model, loads));
    return fmt::format(
        "the loads push the body towards {} with {:.4g} kN/m, where neither a support nor a platen holds it{}",
        direction_in_words(along), 1e-3 * std::abs(force), pressures_in_words(model, loads));
}

/// Of loads that balance but for what the edges of a side do not quite join.
std::string unheld_in_words(const Vec3& motion) {
    return fmt::format("nothing holds the body along {}, and what little its loads differ by there is more than "
                       "solver.balance: a support that is `pinned` holds it",
                       direction_in_words(motion));
}

bool moves_as_a_whole(const BlockSystem& system, const std::vector<MovingBlock>& moving) {
    std::set<int> blocks;
    for (const MovingBlock& each : moving) blocks.insert(each.block);
    double all = 0.0;
    double of_moving = 0.0;
    for (int b = 0; b < system.n_blocks(); ++b) {
        all += system.blocks[b].area;
        if (blocks.contains(b)) of_moving += system.blocks[b].area;
    }
    return of_moving >= whole_body * all;
}

/// Of a column of the densest block that can move, as high as all that has weight (Pa).
double largest_overburden(const Model& model, const Loads& loads) {
    std::vector<Vec2> corners;
    double densest = 0.0;
    for (const Block& block : model.system.blocks) {
        const double density = model.densities.empty() ? 0.0 : model.densities[block.material];
        if (block.fixed || !(density > 0.0)) continue;
        densest = std::max(densest, density);
        for (const Edge& edge : block.edges) corners.push_back(edge_start(model.system, edge));
    }
    if (corners.empty()) return 0.0;
    const Box box = bounding_box(corners);
    return densest * loads.gravity.norm() * (box.upper - box.lower).maxCoeff();
}

/// Of pressures, a platen and weight (Pa).
double largest_stress(const Model& model, const Loads& loads) {
    double stress = 0.0;
    for (const double pressure : loads.pressures) stress = std::max(stress, std::abs(pressure));
    if (loads.platen_force) stress = std::max(stress, std::abs(loads.platen_force->stress));
    return std::max(stress, largest_overburden(model, loads));
}

std::optional<std::string> soft_body(const Model& model, const Loads& loads) {
    const double stress = largest_stress(model, loads);
    if (model.effective_modulus <= 0.0 || stress <= suspicious_strain * model.effective_modulus) return std::nullopt;
    return fmt::format(
        "the loads of up to {:.4g} MPa are {:.2g} times the modulus of {:.4g} MPa of the body or its softest "
        "joint: is a unit missing there?",
        1e-6 * stress, stress / model.effective_modulus, 1e-6 * model.effective_modulus);
}

} // namespace

std::vector<std::string> likely_causes(const Model& model, const LoadsAt& at, const std::vector<MovingBlock>& moving) {
    const WholeBody body(model.system);
    const Loads& loads = at.loads;
    const auto [sum, magnitude] = whole_load(model, body, at);
    std::vector<std::string> causes;
    const bool as_a_whole = !loads.constraints.rows().empty() && moves_as_a_whole(model.system, moving);
    for (const Vec3& motion : free_motions(resistance(model.system, loads.constraints))) {
        const double force = motion.dot(sum);
        if (std::abs(force) > no_resultant * magnitude)
            causes.push_back(push_in_words(model, loads, motion, force));
        else if (as_a_whole)
            causes.push_back(is_turn(motion) ? std::string("nothing holds the body against a turn")
                                             : unheld_in_words(motion));
    }
    if (const auto soft = soft_body(model, loads)) causes.push_back(*soft);
    return causes;
}

std::string unheld_body_warning(const Model& model) {
    const BlockSystem& system = model.system;
    const WholeBody body(system);
    StageStart start = start_at_rest(system);
    for (int s = 0; s < static_cast<int>(model.loads.stages.size()); ++s) {
        const StageLoads stage_loads(model, start, model.loads.stages[s]);
        const PlatenHold hold{.points = {}, .constraints = stage_loads.constraints(), .friction = {}};
        if (!hold.constraints.rows().empty()) return {}; // supports hold in all stages, and platens leave pressures
        start.boundary_pressure = stage_loads.pressures(1.0);
        const LoadsAt at = loads_at(model, stage_loads, hold, s, 1.0);
        const auto [sum, magnitude] = whole_load(model, body, at);
        const Vec3 push(sum.x(), sum.y(), 0.0);
        const Vec3 motion = push.norm() > clear_resultant * magnitude ? push.normalized() : Vec3::UnitZ();
        const double force = motion.dot(sum);
        if (std::abs(force) > clear_resultant * magnitude)
            return fmt::format(
                "stages.{}: expected a support, a fixed block or a platen that holds the body, found none: "
                "{}",
                s, push_in_words(model, at.loads, motion, force));
    }
    return {};
}

} // namespace kluft
