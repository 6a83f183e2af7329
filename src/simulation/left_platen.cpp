#include "kluft/simulation/left_platen.hpp"

#include <algorithm>

#include <fmt/format.h>

namespace kluft {

void PlatenWatch::step(const StepRecord& record, const State& state) {
    const auto& motion = model_.loads.stages[record.stage].motion;
    if (stage_ >= 0 || record.step == 0 || !motion || motion->glued || motion->value >= 0.0 ||
        motion->control == PlatenControl::stress)
        return;
    const bool is_touched = std::ranges::any_of(state.body.platen_points, [&](const PlatenPoint& point) {
        return point.boundary == motion->boundary && touches(point.contact);
    });
    if (is_touched) return;
    stage_ = record.stage;
    step_ = record.step;
}

std::string PlatenWatch::warning() const {
    if (stage_ < 0) return {};
    const PlatenMotion& motion = *model_.loads.stages[stage_].motion;
    const char* const key = motion.control == PlatenControl::strain ? "strain" : "displacement";
    return fmt::format(
        "load step {}: the platen on '{}', which stage {} moves outward, has left the body: it holds it in "
        "tension only if it is glued (stages.{}.{}.glued: true)",
        step_, model_.system.boundaries[motion.boundary].name, stage_, stage_, key);
}

} // namespace kluft
