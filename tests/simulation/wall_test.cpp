// Walls of loose bricks under their own weight, from rest.
#include <cmath>
#include <string>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "support/scene_run.hpp"

namespace kluft {
namespace {

constexpr double density = 2500.0;
constexpr double standard_gravity = 9.81;

/// Running bond of bricks of 2 m by 1 m on a fixed base, with half bricks at the ends of every other course; k_n = k_s =
/// `stiffness` E/m.
std::string wall(int columns, int courses, double stiffness, int steps, double angle = 0.0) {
    const double width = 2.0 * columns;
    const auto corner = [&](double x, double y) {
        return fmt::format("[{:.17g}, {:.17g}]", x * std::cos(angle) - y * std::sin(angle),
                           x * std::sin(angle) + y * std::cos(angle));
    };
    const auto brick = [&](double left, double right, double bottom, const std::string& support) {
        return fmt::format("    - {{polygon: [{}, {}, {}, {}]{}}}\n", corner(left, bottom), corner(right, bottom),
                           corner(right, bottom + 1.0), corner(left, bottom + 1.0), support);
    };
    std::string blocks = brick(0.0, width, -1.0, ", support: fixed");
    for (int course = 0; course < courses; ++course) {
        double left = 0.0;
        double right = course % 2 == 0 ? 2.0 : 1.0;
        for (; left < width; left = right, right = std::min(right + 2.0, width))
            blocks += brick(left, right, course, "");
    }
    return fmt::format(R"(
kluft: 1
analysis: {{plane: strain}}
materials: {{rock: {{density: {}, youngs_modulus: 1 GPa, poissons_ratio: 0.25}}}}
interfaces: {{joint: {{kind: fracture, normal_stiffness: {:.17g}, shear_stiffness: {:.17g}, friction_angle: 35, cohesion: 0}}}}
geometry:
  blocks:
{}stages: [{{name: weight, gravity: [{:.17g}, {:.17g}], steps: {}}}]
)",
                       density, stiffness * 1e9, stiffness * 1e9, blocks, standard_gravity * std::sin(angle),
                       -standard_gravity * std::cos(angle), steps);
}

// An equilibrium lies near by, and is found without following a motion, for joints soft and stiff, a turned wall, and
// whatever the number of load steps.
TEST(SlowWall, ComesToRestWithoutAMotion) {
    for (const double stiffness : {10.0, 50.0}) {
        for (const int steps : {1, 10}) {
            for (const double angle : {0.0, 0.4}) {
                const SceneRun run = run_scene(wall(8, 12, stiffness, steps, angle));
                EXPECT_TRUE(stands(run)) << stiffness << " " << steps << " " << angle;
                EXPECT_EQ(run.report.costs.relaxations, 0) << stiffness << " " << steps << " " << angle;
                EXPECT_TRUE(run.jumps.empty()) << stiffness << " " << steps << " " << angle;
            }
        }
    }
}

// What tells that a load step may end, contacts detected where it stands, is what the next one begins with.
TEST(SlowWall, EachLoadStepDetectsItsContactsOnce) {
    const SceneRun run = run_scene(wall(4, 5, 50.0, 10));
    EXPECT_TRUE(stands(run));
    EXPECT_EQ(run.report.detections, 10 + 2); // the body at rest, and where the first load step begins
}

// Rounding decides which way a search goes: stiffnesses that differ by a millionth stand for it.
TEST(SlowWall, OfAThousandBricksComesToRestWithoutAMotionWhateverTheLastDigits) {
    for (const double stiffness : {50.0, 50.00005, 50.00015}) {
        const SceneRun run = run_scene(wall(25, 40, stiffness, 1));
        EXPECT_TRUE(stands(run)) << stiffness;
        EXPECT_EQ(run.report.costs.relaxations, 0) << stiffness;
    }
}

} // namespace
} // namespace kluft
