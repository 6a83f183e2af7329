// Corners that hold blocks: short contacts that carry much.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "kluft/contact/detection.hpp"
#include "kluft/core/vector.hpp"
#include "kluft/simulation/model.hpp"
#include "kluft/simulation/state.hpp"
#include "kluft/simulation/step_record.hpp"

namespace kluft {

/// A contact, short beside its blocks, that carries more than a twentieth of what acts on one of them: its weight, or the sum of
/// the magnitudes of its contact forces where that is more.
struct CornerContact {
    int block_a = 0;
    int block_b = 0;
    int held = 0;              ///< the one of them
    double length = 0.0;       ///< m; none where a vertex lies on a face
    double force = 0.0;        ///< in compression (N/m)
    double share = 0.0;        ///< of what acts on the held block
    Vec2 place = Vec2::Zero(); ///< in the moved body, scene coordinates (m)
};

/// Of a committed state, the largest force first.
[[nodiscard]] std::vector<CornerContact> corner_contacts(const Model& model, const State& state);

/// Of a committed state of a stage that reduces strengths, the deepest one first.
[[nodiscard]] std::vector<UnheldTip> unheld_tips(const Model& model, const State& state);

/// In words, why it is not held.
[[nodiscard]] std::string description(const Model& model, const UnheldTip& tip);

/// In words, what holds a block there.
[[nodiscard]] std::string description(const Model& model, const CornerContact& corner);

/// What is to be said of the largest one of them on which a tip leans on the ground before it, or else of the largest one of blocks that cannot
/// break; "" where there is none, and in a stage that reduces strengths, which knows when a corner has caught.
[[nodiscard]] std::string corner_contact_warning(const Model& model, const State& state);

/// Follows the platen stages of a run, and remembers the largest axial stress and what tip leaned on the ground before it then. `model` must
/// outlive it.
class TipWatch {
public:
    explicit TipWatch(const Model& model) : model_(model) {}

    /// A committed load step.
    void step(const StepRecord& record, const State& state);

    /// What is to be said of that tip; "" where the body has borne as much without it.
    [[nodiscard]] std::string warning() const;

private:
    const Model& model_;
    std::optional<CornerContact> tip_; ///< at the largest axial stress
    int step_ = 0;
    double largest_stress_ = 0.0; ///< Pa
    double without_ = 0.0;        ///< the largest one of load steps in which none leaned (Pa)
};

} // namespace kluft
