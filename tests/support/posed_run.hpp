// Bodies with their loads posed in code, and what load steps of them work with, for tests below the level of scenes.
#pragma once

#include <atomic>
#include <numbers>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "blocks/cut_scenes.hpp"
#include "kluft/simulation/journal.hpp"
#include "kluft/simulation/load_step.hpp"
#include "kluft/simulation/simulation.hpp"

namespace kluft::posed {

constexpr double degree = std::numbers::pi / 180.0;
constexpr double gravity = 10.0;         ///< m/s2
constexpr double density = 2500.0;       ///< kg/m3
constexpr double tensile_strength = 1e6; ///< of the bond between two blocks (Pa)

inline Material stiff_rock() {
    Material rock;
    rock.name = "rock";
    rock.density = density;
    rock.youngs_modulus = 1e10;
    rock.strength = Strength{5e6, 40.0 * degree, tensile_strength};
    return rock;
}

/// A joint whose law has no roundings: closed forms hold to the digits asked for.
inline InterfaceType joint(double friction_angle) {
    InterfaceType type;
    type.name = "joint";
    type.normal_stiffness = 1e10;
    type.shear_stiffness = 1e10;
    type.friction_angle = friction_angle;
    type.contact_rounding = 0.0;
    type.cohesion_onset = 0.0;
    return type;
}

/// Two blocks of 1 m by 1 m, one on the other, the lower one on a fixed support. They are bonded until the bond fails to a
/// joint, and the upper one is pulled by a pressure at its top of -`pull` at the end of the only stage (Pa).
inline Model two_bonded_blocks(double pull, int steps = 1, Kinematics kinematics = Kinematics::affine) {
    GeometrySpec spec = cut_scenes::rectangle(1.0, 2.0);
    cut_scenes::add_trace(spec, {{-1.0, 1.0}, {2.0, 1.0}}, 0);
    spec.reference_spacing = 1.0;
    ModelInput input;
    input.materials = {stiff_rock()};
    InterfaceType crack = joint(30.0 * degree);
    crack.name = "crack";
    crack.kind = InterfaceKind::potential_crack;
    crack.fails_to = 1;
    input.interface_types = {crack, joint(30.0 * degree)};
    input.kinematics = kinematics;
    input.loads.supports = {Support::fixed, Support::none, Support::none, Support::none};
    Stage stage;
    stage.name = "pull";
    stage.pressure = {{2, -pull}};
    stage.steps = steps;
    input.loads.stages = {stage};
    return build_model(cut_blocks(spec).system, input);
}

/// A block of 2 m by 1 m on a fixed plane that dips by `dip` to the left, under its weight; with `factors` the strengths of
/// the joint are then reduced.
inline Model block_on_a_plane(double dip, double friction_angle,
                              std::optional<StrengthReduction> factors = std::nullopt, int steps = 1) {
    const auto turned = [&](double x, double y) {
        return Vec2(x * std::cos(dip) - y * std::sin(dip), x * std::sin(dip) + y * std::cos(dip));
    };
    GeometrySpec spec;
    spec.reference_spacing = 1.0;
    spec.blocks = {{"base", {turned(-3, -1), turned(5, -1), turned(5, 0), turned(-3, 0)}, 0, true},
                   {"block", {turned(0, 0), turned(2, 0), turned(2, 1), turned(0, 1)}, 0, false}};
    ModelInput input;
    input.materials = {stiff_rock()};
    input.interface_types = {joint(friction_angle)};
    input.gravity = {0.0, -gravity};
    Stage weight;
    weight.name = "weight";
    weight.steps = factors ? 1 : steps;
    input.loads.stages = {weight};
    if (factors) {
        Stage reduction;
        reduction.name = "reduction";
        reduction.strength_reduction = std::move(factors);
        reduction.steps = steps;
        input.loads.stages.push_back(reduction);
    }
    BlockSystem system = cut_blocks(spec).system;
    input.loads.supports.assign(system.boundaries.size(), Support::none);
    return build_model(std::move(system), input);
}

/// Keeps what a run tells.
struct Told : StepObserver {
    std::vector<StepRecord> equilibria, rows;
    std::vector<CrackRecord> cracks;
    std::vector<State> states;
    int n_solves = 0; ///< that were told in between
    Progress last;    ///< of them
    void equilibrium(const StepRecord& record) override { equilibria.push_back(record); }
    void crack(const CrackRecord& crack) override { cracks.push_back(crack); }
    void step(const StepRecord& record, const State& state, const std::function<FieldRecord()>&, bool) override {
        rows.push_back(record);
        states.push_back(state);
    }
    void progress(const Progress& progress) override {
        ++n_solves;
        last = progress;
    }
};

/// What the load steps of a model's stage work with.
class Workplace {
public:
    explicit Workplace(Model posed, SolverOptions solver = tight(), CrackOptions with_cracks = {})
        : model(std::move(posed)), options(solver), cracks(with_cracks), state(initial_state(model)),
          search(model, options), journal(model, state, told, number_of_steps(model), &search) {
        enter();
    }

    static SolverOptions tight() {
        SolverOptions solver;
        solver.tolerance = 1e-10;
        solver.balance = 1e-8;
        solver.repeatable = true;
        return solver;
    }

    /// The loads of the state's stage.
    void enter() { loads.emplace(enter_stage(model, state)); }
    /// Goes on to the next stage from the end of a load step.
    void leave(const Step& step) {
        leave_stage(model, *loads, step.in_place.at.loads, state);
        enter();
    }
    [[nodiscard]] StepBench bench() { return {model, cracks, options, *loads, search, last_detection, journal, stop}; }
    [[nodiscard]] Step take(double load_factor, bool checks_cracks = true) {
        begin_load_step(bench());
        return take_step(bench(), state, goal_at(bench(), load_factor, checks_cracks));
    }

    Model model;
    SolverOptions options;
    CrackOptions cracks;
    State state;
    Told told;
    EquilibriumSearch search;
    std::optional<LastDetection> last_detection;
    Journal journal;
    std::optional<StageLoads> loads;
    std::atomic<bool> stop{false};
};

/// Bit for bit, but for the costs.
inline bool same(const BodyState& a, const BodyState& b) {
    return a.displacement == b.displacement && a.interfaces == b.interfaces && a.bond_shear == b.bond_shear &&
           a.contacts == b.contacts;
}

} // namespace kluft::posed
