#include "kluft/simulation/cohesion_share.hpp"

#include <algorithm>
#include <map>

#include <fmt/format.h>

#include "kluft/loading/loaded_body.hpp"
#include "kluft/simulation/state_fields.hpp"

namespace kluft {

namespace {

constexpr double much_lost = 0.1; ///< of the cohesion that the closed length of a law would have

/// Sums over the closed points of a law (N/m).
struct Cohesion {
    double full = 0.0;
    double counted = 0.0;
    double pressed = 0.0; ///< by what the points are pressed
    double length = 0.0;  ///< m
};

} // namespace

std::string cohesion_share_warning(const Model& model, const State& state) {
    std::map<int, Cohesion> by_law;
    with_body_of_state(model, state, [&](const LoadedBody& body) {
        for (const ContactPoint& point : body.placement->contacts) {
            const InterfaceLaw& law = (*body.laws)[point.law];
            if (law.cohesion <= 0.0 || law.cohesion_onset <= 0.0) continue;
            const double pressure = -contact_traction(*body.laws, point, state.body.displacement).normal;
            if (pressure <= 0.0) continue;
            Cohesion& sum = by_law[point.law];
            sum.length += point.weight;
            sum.pressed += point.weight * pressure;
            sum.full += point.weight * law.cohesion;
            sum.counted += point.weight * law.cohesion * std::min(1.0, pressure / law.cohesion_onset);
        }
    });
    std::string warning;
    double most = 0.0;
    for (const auto& [index, sum] : by_law) {
        const double lost = sum.full - sum.counted;
        if (lost <= much_lost * sum.full || lost <= most) continue;
        most = lost;
        const InterfaceLaw& law = model.laws[index];
        warning = fmt::format("of the cohesion of {:.3g} MPa (interfaces.<name>.cohesion) {:.0f} % counts where its "
                              "joints are closed, under {:.3g} kPa on "
                              "the average: it grows from nothing at their opening to its full value at {:.3g} kPa, "
                              "cohesion_onset (0.01 of the "
                              "cohesion by default); a smaller one gives it whole to joints that are hardly pressed",
                              1e-6 * law.cohesion, 100.0 * sum.counted / sum.full, 1e-3 * sum.pressed / sum.length,
                              1e-3 * law.cohesion_onset);
    }
    return warning;
}

} // namespace kluft
