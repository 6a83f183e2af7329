#include "kluft/fracture/crack_check.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "kluft/blocks/block_cutter.hpp"
#include "support/units.hpp"

namespace kluft {
namespace {

Mat2 stress(double xx, double yy, double xy) {
    Mat2 s;
    s << xx, xy, xy, yy;
    return s;
}

/// Four blocks in a row with three interfaces between them.
BlockSystem four_blocks() {
    GeometrySpec spec;
    spec.domain = {{0, 0}, {4, 0}, {4, 1}, {0, 1}};
    for (const double x : {1.0, 2.0, 3.0}) spec.fractures.push_back({{{x, -1}, {x, 2}}, 0, ""});
    return cut_blocks(spec).system;
}

const Strength rock{.cohesion = 1e6, .friction_angle = 30 * degree, .tensile_strength = 0.5e6};

// The mean of both stresses: uniaxial compressions of 2 and 4 MPa give p1 = 3 MPa and, with Coulomb's uniaxial strength
// of 2 c cos(phi)/(1 - sin(phi)) = 3.4641 MPa, f = 0.8660.
TEST(CrackCheck, TakesTheMeanStressOfTheTwoBlocksOfAnInterface) {
    const BlockSystem system = four_blocks();
    const std::vector<Mat2> stresses{stress(0, -2e6, 0), stress(0, -4e6, 0), stress(0, -4e6, 0), stress(0, -4e6, 0)};
    const auto candidates = crack_check(system, {1, 1, 1}, {rock, rock, rock}, stresses);
    ASSERT_EQ(candidates.size(), 3U);
    EXPECT_EQ(candidates[0].interface, 0);
    EXPECT_NEAR(candidates[0].stress.p1, 3e6, 1e-6);
    EXPECT_NEAR(candidates[0].stress.p3, 0.0, 1e-6);
    EXPECT_NEAR(candidates[0].index.f, 3.0 / (2 * std::cos(30 * degree) / (1 - std::sin(30 * degree))), 1e-12);
    EXPECT_NEAR(candidates[1].stress.p1, 4e6, 1e-6);
    EXPECT_GT(candidates[1].index.f, 1.0);
    EXPECT_FALSE(candidates[1].index.tension_governs);
}

// The mean is taken of the tensors, not of their principal stresses: opposite shears cancel.
TEST(CrackCheck, OppositeShearsOfTwoBlocksCancel) {
    const BlockSystem system = four_blocks();
    const std::vector<Mat2> stresses{stress(-1e6, -1e6, 5e6), stress(-1e6, -1e6, -5e6), Mat2::Zero(), Mat2::Zero()};
    const auto candidates = crack_check(system, {1, 0, 0}, {rock, rock, rock}, stresses);
    EXPECT_NEAR(candidates.front().stress.p1, 1e6, 1e-6);
    EXPECT_NEAR(candidates.front().stress.p3, 1e6, 1e-6);
}

TEST(CrackCheck, LooksAtBondedInterfacesOnlyEachWithItsOwnStrength) {
    const BlockSystem system = four_blocks();
    Strength weak = rock;
    weak.tensile_strength = 0.1e6;
    const std::vector<Mat2> stresses(4, stress(0.2e6, 0, 0));
    const auto candidates = crack_check(system, {1, 0, 1}, {rock, weak, weak}, stresses);
    ASSERT_EQ(candidates.size(), 2U);
    EXPECT_EQ(candidates[0].interface, 0);
    EXPECT_NEAR(candidates[0].index.f, 0.4, 1e-12);
    EXPECT_EQ(candidates[1].interface, 2);
    EXPECT_NEAR(candidates[1].index.f, 2.0, 1e-12);
    EXPECT_TRUE(candidates[1].index.tension_governs);
}

// (|t_s| + t_n tan(phi))/c with t_n positive in tension: (1.2 - tan(30))/1 = 0.6226.
TEST(CrackCheck, OfTractionsJudgesTheInterfaceAndReportsTheStressOfItsBlocks) {
    const BlockSystem system = four_blocks();
    const std::vector<Mat2> stresses(4, stress(0, -3e6, 0));
    const auto candidates =
        crack_check(system, {1, 0, 0}, {rock, rock, rock}, stresses, {{-1e6, -1.2e6}, {0, 0}, {0, 0}});
    ASSERT_EQ(candidates.size(), 1U);
    EXPECT_NEAR(candidates.front().index.f, 1.2 - std::tan(30 * degree), 1e-12);
    EXPECT_NEAR(candidates.front().stress.p1, 3e6, 1e-6);
}

TEST(CrackCheck, FailingOnesComeLargestFirstAndTiesByInterface) {
    std::vector<CrackCandidate> candidates;
    for (const auto& [interface, f] : {std::pair(0, 0.9), std::pair(1, 1.1), std::pair(2, 1.3), std::pair(3, 1.1)}) {
        candidates.push_back({interface, {f, 0.0, false, f}, {}});
    }
    EXPECT_EQ(largest_index(candidates), 1.3);
    const auto at_one = failing(candidates, 1.1);
    ASSERT_EQ(at_one.size(), 3U);
    EXPECT_EQ(at_one[0].interface, 2);
    EXPECT_EQ(at_one[1].interface, 1);
    EXPECT_EQ(at_one[2].interface, 3);
    EXPECT_TRUE(failing(candidates, 1.31).empty());
    EXPECT_EQ(largest_index({}), 0.0);
}

} // namespace
} // namespace kluft
