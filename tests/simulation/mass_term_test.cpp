#include "kluft/simulation/mass_term.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "kluft/kinematics/affine.hpp"
#include "support/posed_run.hpp"

namespace kluft {
namespace {

const Vec2 along_x(1.0, 0.0);
const Vec2 along_y(0.0, 1.0);

bool holds(const BlockSystem& system, char bonded, std::vector<PrescribedDisplacement> rows) {
    return is_held(system, std::vector<char>(system.interfaces.size(), bonded), Constraints(std::move(rows)));
}

// A body in the plane has three rigid motions; each group of bonded blocks needs rows against all of them.
TEST(IsHeld, NeedsThreeIndependentRowsForEachGroupOfBondedBlocks) {
    const BlockSystem system = posed::two_bonded_blocks(1.0).system;
    const PrescribedDisplacement x{0, {0, 0}, along_x}, y{0, {0, 0}, along_y}, turn{0, {0, 1}, along_x};
    EXPECT_TRUE(holds(system, 1, {x, y, turn}));
    EXPECT_FALSE(holds(system, 1, {x, y}));
    EXPECT_FALSE(holds(system, 1, {x, x, y}));    // the same row twice holds no more
    EXPECT_FALSE(holds(system, 0, {x, y, turn})); // the other block is loose
    PrescribedDisplacement travels = y;
    travels.rate = 1.0;
    EXPECT_FALSE(holds(system, 1, {x, travels, turn}));
}

// eta = v E/H^2, theory.
TEST(MassTerm, CoefficientFollowsFromModulusAndHeight) {
    const Model model = posed::two_bonded_blocks(1.0);
    EXPECT_DOUBLE_EQ(mass_coefficient(model, 0.05), 0.05 * model.effective_modulus / 4.0);
}

TEST(MassTerm, BlockCountsWithAtLeastTheAreaOfACellOfTheNet) {
    BlockSystem system = posed::two_bonded_blocks(1.0).system;
    system.spacing = 2.0;
    EXPECT_NEAR(least_mass_area(system), 0.5 * std::sqrt(3.0) * 4.0, 1e-12); // a hexagon of 2 m across flats
}

} // namespace
} // namespace kluft
