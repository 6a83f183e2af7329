#include "kluft/simulation/overloaded_corners.hpp"

#include <atomic>
#include <cmath>
#include <functional>
#include <numbers>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "kluft/scene/scene_model.hpp"
#include "kluft/scene/scene_reader.hpp"
#include "kluft/simulation/simulation.hpp"

namespace kluft {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr double one_degree = std::numbers::pi / 180.0;

/// A specimen of 10 cm by 24 cm under 1 MPa with two fractures of 60 degrees, one each way, that cross in its middle; rock of so
/// much cohesion, and so much friction along the second fracture.
Scene crossing_fractures(const std::string& cohesion, double friction_of_second,
                         const std::vector<std::string>& overrides = {}) {
    const double rise = 0.05 * std::tan(60.0 * one_degree);
    return read_scene_text(fmt::format(R"(kluft: 1
materials:
  rock: {{density: 2300, youngs_modulus: 5 GPa, poissons_ratio: 0.25, cohesion: {0}, friction_angle: 40, tensile_strength: 2 MPa}}
interfaces:
  first: {{kind: fracture, normal_stiffness: 500 GPa/m, shear_stiffness: 250 GPa/m, friction_angle: 30}}
  second: {{kind: fracture, normal_stiffness: 500 GPa/m, shear_stiffness: 250 GPa/m, friction_angle: {1}}}
  bond: {{kind: potential_crack, fails_to: crack}}
  crack: {{kind: fracture, friction_angle: 35}}
geometry:
  domain: {{rectangle: {{width: 0.1, height: 0.24}}}}
  fractures:
    - {{name: up, trace: [[0, {2:.12g}], [0.1, {3:.12g}]], interface: first}}
    - {{name: down, trace: [[0, {3:.12g}], [0.1, {2:.12g}]], interface: second}}
  tessellation: {{triangles: {{spacing: 2 cm}}, interface: bond}}
boundaries: {{bottom: {{support: smooth}}}}
stages:
  - {{pressure: {{left: 1 MPa, right: 1 MPa, top: 1 MPa}}}}
  - {{strain: {{boundary: top, value: 0.5 %}}, steps: 25}}
)",
                                       cohesion, friction_of_second, 0.12 - rise, 0.12 + rise),
                           overrides, "crossing.yaml");
}

/// The same specimen with the first fracture stepped by 3 mm in its middle, so that it closes on its step as it slides; the second one,
/// which crosses it there, does not slide.
Scene stepped_fracture(const std::string& cohesion, const std::vector<std::string>& overrides = {}) {
    const double rise = 0.05 * std::tan(60.0 * one_degree);
    const Vec2 middle(0.05, 0.12);
    const Vec2 after = middle + 0.003 * Vec2(std::cos(60.0 * one_degree), -std::sin(60.0 * one_degree));
    const auto point = [](const Vec2& at) { return fmt::format("[{:.12g}, {:.12g}]", at.x(), at.y()); };
    const Vec2 along = Vec2(0.06, 0.06 * std::tan(60.0 * one_degree));
    std::vector<std::string> changes{fmt::format(
        "geometry.fractures=[{{trace: [{}, {}, {}, {}], interface: first}}, {{trace: [{}, {}], interface: second}}, "
        "{{trace: [{}, {}], interface: second}}]",
        point(middle - along), point(middle), point(after), point(after + along), point(Vec2(0, middle.y() + rise)),
        point(middle), point(after), point(Vec2(0.1, middle.y() - rise)))};
    changes.insert(changes.end(), overrides.begin(), overrides.end());
    return crossing_fractures(cohesion, 60.0, changes);
}

struct Specimen {
    Model model;
    State state;
    StepRecord last;
    std::string warning;
};

class WatchingObserver : public StepObserver {
public:
    explicit WatchingObserver(Specimen& specimen) : specimen_(specimen), watch_(specimen.model) {}
    void step(const StepRecord& record, const State& state, const std::function<FieldRecord()>& /*fields*/,
              bool /*last_of_stage*/) override {
        specimen_.last = record;
        watch_.step(record, state);
    }
    [[nodiscard]] std::string warning() const { return watch_.warning(); }

private:
    Specimen& specimen_;
    CornerWatch watch_;
};

Specimen pressed_specimen(const Scene& scene) {
    Specimen specimen;
    specimen.model = build_scene_model(scene).model;
    specimen.state = initial_state(specimen.model);
    WatchingObserver observer(specimen);
    const std::atomic<bool> stop{false};
    const RunReport report = run_simulation(specimen.model, scene.cracks, scene.solver, specimen.state, observer, stop);
    EXPECT_EQ(report.status, RunStatus::done);
    specimen.warning = observer.warning();
    return specimen;
}

/// What the warning says of the largest stress before (Pa).
double stress_before(const std::string& warning) {
    const std::string words = "a twentieth, it was ";
    const std::size_t place = warning.find(words);
    return place == std::string::npos ? 0.0 : 1e6 * std::stod(warning.substr(place + words.size()));
}

// Jaeger's plane of weakness has 1 MPa tan 60/tan(60 - 30) = 3 MPa: whatever crosses the joint, the body slides along it, and the tip
// of one wedge goes past that of the other.
TEST(OverloadedCorners, FracturesThatCrossExactlyBearWhatOneDoes) {
    const Specimen specimen = pressed_specimen(crossing_fractures("5 MPa", 30.0));
    EXPECT_NEAR(specimen.last.axial_stress, 3e6, 0.02e6);
    EXPECT_THAT(specimen.warning, IsEmpty());
}

TEST(OverloadedCorners, OfASteppedFractureAreWarnedOf) {
    const Specimen specimen = pressed_specimen(stepped_fracture("5 MPa"));
    EXPECT_GT(specimen.last.axial_stress, 1.5 * 3e6);
    const OverloadedCorners corners =
        overloaded_corners(specimen.model, make_gauges(specimen.model), specimen.last, specimen.state);
    EXPECT_GT(corners.n, 0);
    EXPECT_GT(corners.share, 0.05);
    EXPECT_GT(corners.traction, 2.0 * corners.strength);
    const double tangent = std::tan(65.0 * one_degree); // 45 + phi/2
    EXPECT_NEAR(corners.strength, 2.0 * 5e6 * tangent + 1e6 * tangent * tangent, 1.0);
    EXPECT_NEAR(corners.place.x(), 0.05, 0.003);
    EXPECT_NEAR(corners.place.y(), 0.12, 0.004);
    EXPECT_THAT(specimen.warning, AllOf(HasSubstr("under more than 2 times the rock's compressive strength"),
                                        HasSubstr("rock of 26 MPa")));
    EXPECT_GT(stress_before(specimen.warning), 3e6);
    EXPECT_LT(stress_before(specimen.warning), specimen.last.axial_stress);
}

// Slip along the weaker one carries its tip away from that of the other wedge: 1 MPa tan 60/tan(60 - 27) = 2.667 MPa.
TEST(OverloadedCorners, OfFracturesOfDifferentFrictionDoNotMeet) {
    const Specimen specimen = pressed_specimen(crossing_fractures("5 MPa", 27.0));
    EXPECT_NEAR(specimen.last.axial_stress, 1e6 * std::tan(60.0 * one_degree) / std::tan(33.0 * one_degree), 0.02e6);
    EXPECT_THAT(specimen.warning, IsEmpty());
}

// What the body carried before the platen moved is no strength.
TEST(SlowOverloadedCorners, AreFoundAfterALargerPressure) {
    const Specimen specimen = pressed_specimen(stepped_fracture(
        "5 MPa",
        {"stages=[{pressure: {left: 10 MPa, right: 10 MPa, top: 10 MPa}}, {pressure: {left: 1 MPa, right: 1 MPa, top: "
         "1 MPa}}, {strain: {boundary: top, value: 0.5 %}, steps: 25}]"}));
    EXPECT_THAT(specimen.warning, HasSubstr("carry"));
    EXPECT_LT(stress_before(specimen.warning), 8e6); // and not 10 MPa
}

// Outside the region of the net blocks break even less: the rock has the strength of the net's.
TEST(OverloadedCorners, AreFoundOutsideTheNet) {
    const Specimen specimen = pressed_specimen(
        stepped_fracture("5 MPa", {"geometry.tessellation.region=[[0, 0], [0.1, 0], [0.1, 0.06], [0, 0.06]]"}));
    EXPECT_GT(specimen.last.axial_stress, 1.5 * 3e6);
    EXPECT_THAT(specimen.warning, HasSubstr("carry"));
}

// Deep rock is pressed by more than its uniaxial strength, and no platen asks for a strength.
TEST(OverloadedCorners, AreNotSoughtWithoutAPlaten) {
    const Specimen specimen = pressed_specimen(
        crossing_fractures("1 kPa", 30.0, {"stages=[{pressure: {left: 1 MPa, right: 1 MPa, top: 1 MPa}}]"}));
    EXPECT_THAT(specimen.warning, IsEmpty());
}

TEST(OverloadedCorners, StrongRockBearsThem) {
    const Specimen specimen = pressed_specimen(stepped_fracture("100 MPa"));
    EXPECT_GT(specimen.last.axial_stress, 1.5 * 3e6);
    EXPECT_EQ(overloaded_corners(specimen.model, make_gauges(specimen.model), specimen.last, specimen.state).n, 0);
    EXPECT_THAT(specimen.warning, IsEmpty());
}

} // namespace
} // namespace kluft
