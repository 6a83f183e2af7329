// Stages of loading. Pressures, strains, stresses and displacements are positive in compression (inward).
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "kluft/core/vector.hpp"

namespace kluft {

enum class PlatenControl { displacement, strain, stress };

/// What moves a boundary in a stage. The opposite boundary rests on a fixed platen of the same kind.
struct PlatenMotion {
    PlatenControl control = PlatenControl::strain;
    int boundary = 0;   ///< index into GeometrySpec::boundaries
    double value = 0.0; ///< m (displacement), fraction of the body's length (strain) or Pa (stress), reached at the end
                        ///< of the stage, counted from the stage's start for displacement and strain
    bool glued = false; ///< both platens hold the body in tension too
    std::string place;  ///< where the scene names the boundary, for messages; "" for a program made in code
    std::optional<int> against; ///< the boundary that rests on a fixed platen, -1 for none; not given: the opposite one
};

/// A dead load: a force of constant direction on a material point of a block.
struct PointForce {
    std::string name;
    std::string block;         ///< name of a block or of a set of one block; empty: the block that has the point in it
    Vec2 point = Vec2::Zero(); ///< in the body as cut, scene coordinates (m)
};

/// A stage without new loads in which strengths are divided by F, until no equilibrium is found: the largest F with one
/// is the factor of safety.
struct StrengthReduction {
    double from = 1.0;                ///< F at the start of the stage, and of the stages before it
    double to = 1.0;                  ///< F at its end, more than `from`
    double tolerance = 1e-4;          ///< of the factor of safety, relative
    std::vector<int> interface_types; ///< whose strengths are divided; empty: all
    std::vector<std::string> names;   ///< of these

    [[nodiscard]] double factor_at(double load_factor) const { return from + load_factor * (to - from); }
    [[nodiscard]] double load_factor_at(double factor) const { return (factor - from) / (to - from); }
};

struct Stage {
    std::string name;
    std::map<int, double> pressure; ///< boundary -> Pa at the end of the stage; others keep theirs
    std::map<int, Vec2> forces;  ///< index into LoadProgram::forces -> N/m at the end of the stage; others keep theirs
    std::optional<Vec2> gravity; ///< at the end of the stage (m/s2); without it as before, in the first stage that of
                                 ///< the model
    std::optional<PlatenMotion> motion;
    double platen_friction = 0.0; ///< tan of the friction angle of the platens; infinite: the body sticks to them
    std::optional<StrengthReduction> strength_reduction;
    int steps = 1;
    std::optional<double> stop_after_drop; ///< the run ends where the platen has lost this part of its largest stress
};

[[nodiscard]] inline bool is_platen_loaded_by_stress(const Stage& stage) {
    return stage.motion && stage.motion->control == PlatenControl::stress;
}
/// By pressures, weight or a platen under stress: past its strength the body has nothing to stop it.
[[nodiscard]] inline bool is_loaded_by_stress(const Stage& stage) {
    return !stage.motion || is_platen_loaded_by_stress(stage);
}
/// By a platen whose travel is given.
[[nodiscard]] inline bool prescribes_strain(const Stage& stage) {
    return stage.motion && stage.motion->control != PlatenControl::stress;
}

enum class Support {
    none,
    smooth, ///< no motion normal to the boundary
    pinned, ///< as smooth, and one vertex near the middle does not move along the boundary: the body cannot drift
    fixed   ///< no motion
};

struct LoadProgram {
    std::vector<Support> supports; ///< one per boundary, holding in every stage
    std::vector<PointForce> forces;
    std::vector<Stage> stages;
};

} // namespace kluft
