// Corners between mapped fractures that bear more than rock does: the cells of a net break apart, corners smaller than a cell
// do not.
#pragma once

#include <string>

#include "kluft/core/vector.hpp"
#include "kluft/simulation/measurements.hpp"
#include "kluft/simulation/model.hpp"
#include "kluft/simulation/state.hpp"
#include "kluft/simulation/step_record.hpp"

namespace kluft {

/// Pairs of blocks whose corners touch along mapped fractures, on less than half of a cell of the smaller block's size, under a mean
/// normal traction of more than twice the compressive strength of the rock beside them, (36). That is the strength of the
/// potential cracks around the two blocks, of all in the body where there are none, under the smaller of axial and lateral stress.
struct OverloadedCorners {
    int n = 0;
    double share = 0.0; ///< of the axial force, in that tenth of the body's length where they carry most
    int block_a = -1;   ///< of the pair with the largest axial force
    int block_b = -1;
    double traction = 0.0;     ///< of that pair: mean normal traction (Pa, positive in compression)
    double strength = 0.0;     ///< of that pair: compressive strength (Pa)
    Vec2 place = Vec2::Zero(); ///< of that pair, in the moved body, scene coordinates (m)
};

/// Of a committed state and what was measured in it. No corner is overloaded in a body without potential cracks, whose rock has no
/// strength.
[[nodiscard]] OverloadedCorners overloaded_corners(const Model& model, const Gauges& gauges, const StepRecord& record,
                                                   const State& state);

/// Follows a run from the first platen that moves to the largest axial stress, to say what that owes to overloaded corners. Stages
/// of strength_reduction do not count. Costs nothing where no platen moves or the body has no mapped fracture or no potential
/// crack. `model` must outlive it.
class CornerWatch {
public:
    explicit CornerWatch(const Model& model);

    /// A committed load step.
    void step(const StepRecord& record, const State& state);

    /// What is to be said where overloaded corners carry more than a twentieth of the axial force; "" where they do not.
    [[nodiscard]] std::string warning() const;

private:
    const Model& model_;
    Gauges gauges_;
    bool is_needed_ = false;
    double largest_stress_ = 0.0; ///< magnitude (Pa)
    double stress_before_ = 0.0;  ///< the largest one without corners that count (Pa)
    OverloadedCorners corners_;   ///< at the largest stress
};

} // namespace kluft
