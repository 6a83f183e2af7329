// Corners between mapped fractures that bear more than rock does: the cells of a net break apart, corners smaller than a cell
// do not.
#pragma once

#include <string>

#include "kluft/core/vector.hpp"
#include "kluft/simulation/model.hpp"
#include "kluft/simulation/state.hpp"
#include "kluft/simulation/step_record.hpp"

namespace kluft {

/// Pairs of blocks that touch along mapped fractures under a mean normal traction of more than twice the compressive
/// strength of the rock beside them, (36), which is that of the potential cracks of the two blocks.
struct OverloadedCorners {
    int n = 0;
    double share = 0.0; ///< of the normal forces across mapped fractures, 0 to 1
    int block_a = -1;   ///< of the pair with the largest force
    int block_b = -1;
    double traction = 0.0;     ///< of that pair: mean normal traction (Pa, positive in compression)
    double strength = 0.0;     ///< of that pair: compressive strength (Pa)
    Vec2 place = Vec2::Zero(); ///< of that pair, in the moved body, scene coordinates (m)
};

/// Of a committed state, with the strength that rock has under a confining stress (Pa, positive in compression). No corner is
/// overloaded in a body without potential cracks, whose rock has no strength.
[[nodiscard]] OverloadedCorners overloaded_corners(const Model& model, const State& state, double confining_stress);

/// Follows a run up to its largest axial stress (where no gauge measures one: up to its end), to say what it owes to
/// overloaded corners; the smaller of axial and lateral stress confines the rock. Stages of strength_reduction do not count. Costs nothing where the body has no mapped fracture or no
/// potential crack. `model` must outlive it.
class CornerWatch {
public:
    explicit CornerWatch(const Model& model);

    /// A committed load step.
    void step(const StepRecord& record, const State& state);

    /// What is to be said where overloaded corners carry more than a twentieth of what goes across mapped fractures; "" where
    /// they do not.
    [[nodiscard]] std::string warning() const;

private:
    const Model& model_;
    bool is_needed_ = false;
    double largest_stress_ = 0.0; ///< magnitude (Pa)
    double stress_before_ = 0.0;  ///< the largest one without corners that count (Pa)
    OverloadedCorners corners_;   ///< at the largest stress
};

} // namespace kluft
