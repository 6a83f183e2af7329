#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "blocks/cut_scenes.hpp"
#include "kluft/constitutive/lattice_stiffness.hpp"
#include "kluft/reference/block_inertia.hpp"
#include "kluft/reference/explicit_motion.hpp"
#include "support/lattice_body.hpp"

namespace kluft {
namespace {

/// A block of 1 m x 1 m on a fixed one of the same size, with a bond of k_n = 1e8 Pa/m between them. The blocks are so
/// stiff that the bond is the only spring that counts: omega^2 = k_n width/(rho area).
class BlockOnASpring {
public:
    static constexpr double kn = 1e8, density = 2500.0, youngs_modulus = 1e12;

    explicit BlockOnASpring(double damping)
        : motion_(loaded_body(), {bonds_at(system_, {1}, at_rest(system_)), {}}, loads(), masses(), damping,
                  at_rest(system_)) {}

    ExplicitMotion& motion() { return motion_; }
    [[nodiscard]] double height() const { return displacement_at(motion_.displacement(), upper(), Vec2::Zero()).y(); }
    [[nodiscard]] static double frequency() { return std::sqrt(kn / density); }
    void set_gravity(double g) { motion_.loads().gravity = {0.0, -g}; }

private:
    static BlockSystem two_blocks() {
        GeometrySpec spec = cut_scenes::rectangle(1.0, 2.0);
        FractureTrace trace;
        trace.points = {{-1.0, 1.0}, {2.0, 1.0}};
        spec.fractures = {trace};
        return cut_blocks(spec).system;
    }
    [[nodiscard]] int upper() const { return system_.blocks[0].centroid.y() > 1.0 ? 0 : 1; }

    LoadedBody loaded_body() {
        LoadedBody body;
        body.system = &system_;
        body.moduli = &moduli_;
        body.laws = &laws_;
        body.densities = &densities_;
        return body;
    }
    [[nodiscard]] Loads loads() const {
        std::vector<PrescribedDisplacement> rows;
        for (const Vec2& xi : {Vec2(0, 0), Vec2(1, 0), Vec2(0, 1)})
            for (const Vec2& direction : {Vec2(1, 0), Vec2(0, 1)}) rows.push_back({1 - upper(), xi, direction});
        Loads loads;
        loads.constraints = Constraints(rows);
        return loads;
    }
    [[nodiscard]] std::vector<Mat6> masses() const {
        std::vector<Mat6> result;
        for (const Block& block : system_.blocks) result.push_back(density * area_matrix(block, 1.0));
        return result;
    }

    std::vector<InterfaceLaw> laws_{{.normal_stiffness = kn, .shear_stiffness = kn}};
    std::vector<double> densities_{density};
    std::vector<ElasticModuli> moduli_{plane_moduli(youngs_modulus, 0.0, Plane::strain)};
    BlockSystem system_ = two_blocks();
    ExplicitMotion motion_;
};

// Weight switched on at once: u = -(g/omega^2)(1 - cos omega t), a motion between 0 and twice the static settlement.
// The elasticity of the block lowers omega^2 by k_n height/(3 E) = 3e-5 of it.
TEST(ExplicitMotion, UndampedBlockOnASpringOscillatesWithItsNaturalFrequency) {
    BlockOnASpring block(0.0);
    block.set_gravity(10.0);
    const double omega = BlockOnASpring::frequency();
    const double settlement = 10.0 / (omega * omega);
    double time = 0.0;
    for (const double periods : {0.25, 0.5, 1.0, 2.75, 5.0}) {
        while (time < periods * 2 * std::numbers::pi / omega) {
            block.motion().advance();
            time += block.motion().time_step();
        }
        EXPECT_NEAR(block.height(), -settlement * (1 - std::cos(omega * time)), 4e-3 * settlement) << periods;
    }
}

TEST(ExplicitMotion, UndampedMotionConservesEnergy) {
    BlockOnASpring block(0.0);
    block.set_gravity(10.0);
    double largest_kinetic = 0.0;
    for (int i = 0; i < 20000; ++i) {
        block.motion().advance();
        if (i % 100 != 0) continue;
        const EnergyBalance energy = block.motion().energies();
        largest_kinetic = std::max(largest_kinetic, energy.kinetic_energy);
        // Against m g^2/(2 omega^2), the kinetic energy at its largest.
        const double scale = 0.5 * 2500.0 * 100.0 / (BlockOnASpring::kn / 2500.0);
        EXPECT_NEAR(energy.external_work, energy.strain_energy() + energy.kinetic_energy, 1e-3 * scale) << i;
        EXPECT_EQ(energy.damping_energy, 0.0);
    }
    EXPECT_NEAR(largest_kinetic, 0.5 * 2500.0 * 100.0 / (BlockOnASpring::kn / 2500.0), 0.02 * largest_kinetic);
}

// u = -m g/(k_n width); the load does twice the work that stays in the spring, damping takes the other half.
TEST(ExplicitMotion, DampedBlockOnASpringComesToRestAtItsStaticSettlement) {
    BlockOnASpring block(0.8);
    block.set_gravity(10.0);
    for (int i = 0; i < 30000; ++i) block.motion().advance();
    const double settlement = 10.0 * BlockOnASpring::density / BlockOnASpring::kn;
    EXPECT_NEAR(block.height(), -settlement, 1e-4 * settlement);
    const EnergyBalance energy = block.motion().energies();
    EXPECT_NEAR(energy.damping_energy, 0.5 * energy.external_work, 1e-3 * energy.external_work);
    EXPECT_LT(energy.kinetic_energy, 1e-6 * energy.external_work);
    EXPECT_LT(std::abs(energy.error()), 1e-6);
}

// The support carries the weight of both blocks: what is held does not move.
TEST(ExplicitMotion, PrescribedDisplacementsHoldExactly) {
    BlockOnASpring block(0.8);
    block.set_gravity(10.0);
    for (int i = 0; i < 100; ++i) block.motion().advance();
    const auto& q = block.motion().displacement();
    EXPECT_LT(std::min(q.head<6>().norm(), q.tail<6>().norm()), 1e-18);
}

} // namespace
} // namespace kluft
