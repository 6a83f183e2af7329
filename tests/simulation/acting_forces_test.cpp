#include "kluft/loading/acting_forces.hpp"

#include <cmath>
#include <map>

#include <gtest/gtest.h>

#include "support/scene_run.hpp"

namespace kluft {
namespace {

const char* const two_beds = R"(
kluft: 1
analysis: {plane: stress, gravity: [0, -10]}
materials: {rock: {density: 2000, youngs_modulus: 20 GPa, poissons_ratio: 0.2}}
interfaces: {joint: {kind: fracture, normal_stiffness: 1e11, shear_stiffness: 1e11, friction_angle: 30}}
geometry:
  domain: {rectangle: {width: 2, height: 3}}
  fractures: [{trace: [[-1, 1], [3, 1]], interface: joint}]
  reference_spacing: 1.0
boundaries: {bottom: {support: fixed}}
stages: [{name: weight, pressure: {top: 5 kPa}, steps: 1}]
)";

Vec2 force_on_a(const ContactForce& at) {
    const Vec2 tangent(-at.normal.y(), at.normal.x());
    return at.length * (at.normal_traction * at.normal + at.shear_traction * tangent);
}

/// Sum of the contact forces on a block.
Vec2 contact_force_on(int block, const FieldRecord& fields) {
    Vec2 sum = Vec2::Zero();
    for (const ContactForce& at : fields.contacts) {
        if (at.block_a == block) sum += force_on_a(at);
        if (at.block_b == block) sum -= force_on_a(at);
    }
    return sum;
}

/// Sum of the forces from outside of each kind.
std::map<SupportKind, Vec2> sums_by_kind(const FieldRecord& fields) {
    std::map<SupportKind, Vec2> sums;
    for (const SupportForce& each : fields.supports)
        sums.try_emplace(each.kind, Vec2::Zero()).first->second += each.force;
    return sums;
}

// Weights are 2000 kg/m3 times 10 m/s2 times the areas, 4 m2 above and 2 m2 below; the pressure acts on 2 m.
TEST(ActingForces, CarryAStackToItsSupport) {
    const SceneRun run = run_scene(two_beds);
    const FieldRecord& fields = run.fields.back();
    const std::vector<Block>& blocks = run.model.system.blocks;
    const int upper = blocks[0].centroid.y() > blocks[1].centroid.y() ? 0 : 1;
    EXPECT_NEAR(contact_force_on(upper, fields).y(), 80e3 + 10e3, 1.0);
    EXPECT_NEAR(contact_force_on(1 - upper, fields).y(), -90e3, 1.0);
    const auto sums = sums_by_kind(fields);
    EXPECT_NEAR(sums.at(SupportKind::weight).y(), -120e3, 1e-6);
    EXPECT_NEAR(sums.at(SupportKind::pressure).y(), -10e3, 10.0); // follows the surface, which strain changes by 1e-6
    EXPECT_NEAR(sums.at(SupportKind::support).y(), 130e3, 1.0);
    EXPECT_EQ(sums.size(), 3U);
    for (const ContactForce& at : fields.contacts) {
        EXPECT_EQ(at.state, MeetingState::locked);
        EXPECT_NEAR((at.place_a - at.place_b).norm(), 0.0, 1e-5);
    }
}

TEST(ActingForces, AreNoneBeforeAnyLoad) {
    const SceneRun run = run_scene(two_beds);
    EXPECT_TRUE(run.fields.front().supports.empty());
    EXPECT_TRUE(contact_force_on(0, run.fields.front()).isZero());
}

// Platens with friction press a bonded body: what they exert is the axial stress on the width, and the friction of both
// sides of the body cancels.
TEST(ActingForces, ArePlatensForcesWithTheirFriction) {
    const SceneRun run = run_scene(R"(
kluft: 1
analysis: {plane: stress}
materials: {rock: {density: 2000, youngs_modulus: 10 GPa, poissons_ratio: 0.3, cohesion: 50 MPa, friction_angle: 40, tensile_strength: 20 MPa}}
interfaces: {bond: {kind: potential_crack, fails_to: crack}, crack: {kind: fracture, friction_angle: 35}}
geometry: {domain: {rectangle: {width: 0.5, height: 1}}, tessellation: {triangles: {spacing: 0.2}, interface: bond}}
stages: [{name: platen, strain: {boundary: top, value: 0.1 %}, platens: {friction_angle: 5}, steps: 2}]
)");
    ASSERT_TRUE(stands(run));
    Vec2 on_top = Vec2::Zero();
    double along = 0.0;
    for (const SupportForce& each : run.fields.back().supports) {
        EXPECT_EQ(each.kind, SupportKind::platen);
        if (run.model.system.boundaries[each.boundary].name != "top") continue;
        on_top += each.force;
        along += std::abs(each.force.x());
    }
    const double width = 0.5 * (1.0 - run.history.back().lateral_strain);
    EXPECT_NEAR(-on_top.y(), run.history.back().axial_stress * width, 1e-6 * on_top.norm());
    EXPECT_GT(along, 0.02 * on_top.norm());
    EXPECT_LT(std::abs(on_top.x()), 0.02 * on_top.norm());
    for (const ContactForce& at : run.fields.back().contacts) EXPECT_EQ(at.state, MeetingState::bonded);
}

// sigma_zz = nu (sigma_xx + sigma_yy) keeps the strain across the plane at zero.
TEST(StateFields, HaveTheStressAcrossThePlane) {
    const SceneRun in_stress = run_scene(two_beds);
    const SceneRun in_strain = run_scene(two_beds, {"analysis.plane=strain"});
    for (std::size_t b = 0; b < 2; ++b) {
        EXPECT_EQ(in_stress.fields.back().stress_zz[b], 0.0);
        const Mat2& stress = in_strain.fields.back().stress[b];
        EXPECT_NEAR(in_strain.fields.back().stress_zz[b], 0.2 * stress.trace(), 1e-9 * stress.norm());
    }
}

// An interface's force on side a is that of its points in contacts/.
TEST(StateFields, HaveTheForceOfEachInterface) {
    const SceneRun run = run_scene(two_beds);
    const FieldRecord& fields = run.fields.back();
    ASSERT_EQ(fields.interfaces.size(), 1U);
    const int a = run.model.system.interfaces[0].block_a;
    EXPECT_NEAR((fields.interfaces[0].force - contact_force_on(a, fields)).norm(), 0.0, 1e-6);
    EXPECT_GT(fields.interfaces[0].force.norm(), 80e3);
}

} // namespace
} // namespace kluft
