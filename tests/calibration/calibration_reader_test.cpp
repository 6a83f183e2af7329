// What a calibration file may say, and what is answered to one that is wrong.
#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "calibration/calibration_scenes.hpp"
#include "kluft/calibration/calibration.hpp"
#include "kluft/core/diagnostics.hpp"
#include "output/temporary_directory.hpp"

namespace kluft {
namespace {

using namespace kluft::testing;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

constexpr double degree = 3.14159265358979323846 / 180.0;

const std::string parameters =
    "parameters:\n"
    "  kn: {keys: [interfaces.bond.normal_stiffness, {key: interfaces.joint.normal_stiffness, "
    "times: 0.5}], start: 30 GPa/m, from: 1 GPa/m, to: 3 TPa/m}\n"
    "  phi: {keys: [materials.rock.friction_angle], start: 30 deg, from: 10 deg, to: 60}\n";
const std::string head = "kluft_calibration: 1\nscene: scene.yaml\n";

class CalibrationFiles : public ::testing::Test {
protected:
    CalibrationFiles() { write_text(directory_ / "scene.yaml", specimen(hexagons)); }

    [[nodiscard]] Calibration read(const std::string& text) const {
        return read_calibration_text(text, directory_ / "target.yaml");
    }
    [[nodiscard]] std::string refusal(const std::string& text) const {
        try {
            (void)read(text);
        } catch (const InputError& error) {
            return error.what();
        }
        return "accepted";
    }

    TemporaryDirectory directory_;
};

TEST_F(CalibrationFiles, AllThatIsWrittenIsRead) {
    write_text(directory_ / "curve.csv", "axial_strain,differential_stress\n0,0\n0.001,1e7\n0.002,1.5e7\n");
    write_text(directory_ / "other.yaml", specimen(voronoi));
    const Calibration read = this->read(
        head + parameters +
        "targets:\n"
        "  youngs_modulus: {value: 10 GPa, tolerance: 0.1 %, weight: 3}\n"
        "  peak_stress:\n"
        "    - {value: 40 MPa, tolerance: 5 %, set: {stages.0.pressure.left: 1 MPa, stages.0.pressure.right: 1 MPa}}\n"
        "    - {value: 30 MPa, tolerance: 4 %, scene: other.yaml}\n"
        "  friction_angle: {value: 35 deg, tolerance: 2 %, pressures: [0, 1 MPa, 5 MPa]}\n"
        "  curve: {file: curve.csv, tolerance: 0.1}\n"
        "replicas: 3\nevaluations: 12\n");
    ASSERT_EQ(read.parameters.size(), 2U);
    EXPECT_EQ(read.parameters[0].start, 30e9);
    EXPECT_EQ(read.parameters[0].to, 3e12);
    EXPECT_EQ(read.parameters[0].keys[1].times, 0.5);
    EXPECT_NEAR(read.parameters[1].to, 60.0 * degree, 1e-15);
    ASSERT_EQ(read.targets.size(), 5U);
    EXPECT_EQ(read.targets[0].weight, 3.0);
    EXPECT_EQ(read.targets[1].name, "peak_stress 1");
    EXPECT_EQ(read.targets[1].set.size(), 2U);
    EXPECT_EQ(read.targets[2].scene.filename(), "other.yaml");
    EXPECT_NEAR(read.targets[3].value, 35.0 * degree, 1e-15);
    EXPECT_THAT(read.targets[3].pressures, ElementsAre("0", "1 MPa", "5 MPa"));
    EXPECT_EQ(read.targets[4].curve.size(), 3U);
    EXPECT_EQ(read.replicas.count, 3);
    EXPECT_EQ(read.most_evaluations, 12);
}

TEST_F(CalibrationFiles, KeysOfTheSceneFollowTheParameters) {
    const Calibration read = this->read(head + parameters + "targets: {peak_stress: {value: 1 MPa, tolerance: 1 %}}\n");
    const auto settings = assignments(settings_at(read, start_of(read)));
    ASSERT_EQ(settings.size(), 3U);
    const auto number = [&](std::size_t i) { return std::stod(settings[i].substr(settings[i].find('=') + 1)); };
    EXPECT_THAT(settings[0], HasSubstr("interfaces.bond.normal_stiffness="));
    EXPECT_NEAR(number(0), 30e9, 1e-3);
    EXPECT_NEAR(number(1), 15e9, 1e-3);
    EXPECT_NEAR(number(2), 30.0, 1e-12); // degrees
}

// An isotropic body has a Poisson's ratio below 0.5, and no rock a friction angle of 90 degrees.
TEST_F(CalibrationFiles, ATargetThatNoBodyReachesIsRefused) {
    EXPECT_THAT(
        refusal(head + parameters + "targets: {poissons_ratio: {value: 0.7, tolerance: 1 %}}\n"),
        HasSubstr("target.yaml:6:35: targets.poissons_ratio.value: expected a number > 0 and < 0.5, found '0.7'"));
    EXPECT_THAT(
        refusal(head + parameters +
                "targets: {friction_angle: {value: 95 deg, tolerance: 1 %, pressures: [0, 1 MPa]}}\n"),
        AllOf(HasSubstr("target.yaml:6:35: targets.friction_angle.value: expected "), HasSubstr("found '95 deg'")));
}

TEST_F(CalibrationFiles, ABoundThatTheSceneRefusesIsRefused) {
    const auto refused = [&](const std::string& parameter) {
        return refusal(head + "parameters:\n  p: " + parameter +
                       "\ntargets: {youngs_modulus: {value: 1 GPa, tolerance: 1 %}}\n");
    };
    EXPECT_THAT(refused("{keys: [materials.rock.poissons_ratio], start: 0.2, from: 0.1, to: 0.7}"),
                HasSubstr("target.yaml:4:73: parameters.p.to: expected a number >= 0 and < 0.5 for "
                          "'materials.rock.poissons_ratio', found '0.7'"));
    EXPECT_THAT(refused("{keys: [{key: materials.rock.poissons_ratio, times: 2}], start: 0.2, from: 0.1, to: 0.3}"),
                HasSubstr("found '0.3', times 2"));
    EXPECT_THAT(refused("{keys: [materials.rock.friction_angle], start: 30, from: 10, to: 100 deg}"),
                AllOf(HasSubstr("parameters.p.to: expected "), HasSubstr("found '100 deg'")));
    EXPECT_EQ(refused("{keys: [materials.rock.poissons_ratio], start: 0.2, from: 0.1, to: 0.49}"), "accepted");
}

TEST_F(CalibrationFiles, MistakesAreAnsweredWithPlaceAndNearestKey) {
    const std::string target = "targets: {peak_stress: {value: 1 MPa, tolerance: 1 %}}\n";
    EXPECT_THAT(refusal("kluft_calibration: 1\nscen: scene.yaml\n"),
                AllOf(HasSubstr("target.yaml:2:1: scen: unknown key"), HasSubstr("did you mean 'scene'?")));
    EXPECT_THAT(refusal("kluft_calibration: 1\nscene: scne.yaml\n" + parameters + target),
                AllOf(HasSubstr("target.yaml:2:8"), HasSubstr("did you mean 'scene.yaml'?")));
    EXPECT_THAT(
        refusal(head + "parameters: {c: {keys: [materials.rock.cohesio], start: 1, from: 1, to: 2}}\n" + target),
        AllOf(HasSubstr("target.yaml:3:25: parameters.c.keys"), HasSubstr("did you mean 'cohesion'?")));
    EXPECT_THAT(
        refusal(head + "parameters: {c: {keys: [materials.rok.cohesion], start: 1, from: 1, to: 2}}\n" + target),
        HasSubstr("did you mean 'rock'?"));
    EXPECT_THAT(refusal(head + "parameters: {c: {keys: [analysis.plane], start: 1, from: 1, to: 2}}\n" + target),
                HasSubstr("expected a key of the scene that takes a number"));
    EXPECT_THAT(refusal(head +
                        "parameters: {c: {keys: [materials.rock.cohesion], start: 3 MPa, from: 1 MPa, to: 2 "
                        "MPa}}\n" +
                        target),
                AllOf(HasSubstr("parameters.c.start"), HasSubstr("from 1 MPa to 2 MPa")));
    EXPECT_THAT(
        refusal(head + "parameters: {c: {keys: [materials.rock.cohesion], start: 1 m, from: 1, to: 2}}\n" + target),
        HasSubstr("which is in m"));
    EXPECT_THAT(refusal(head + parameters + "targets: {peak_stres: {value: 1, tolerance: 1}}\n"),
                HasSubstr("did you mean 'peak_stress'?"));
    EXPECT_THAT(refusal(head + parameters + "targets: {peak_stress: {value: 1 MPa}}\n"),
                HasSubstr("targets.peak_stress.tolerance: expected a number > 0, found nothing"));
    EXPECT_THAT(refusal(head + parameters + "targets: {peak_stress: {value: -1 MPa, tolerance: 1 %}}\n"),
                HasSubstr("expected a number > 0 in Pa, found '-1 MPa'"));
    EXPECT_THAT(refusal(head + parameters + "targets: {cohesion: {value: 1 MPa, tolerance: 1 %, pressures: [1, 1]}}\n"),
                HasSubstr("at least two different pressures"));
    EXPECT_THAT(
        refusal(head + parameters + "targets: {cohesion: {value: 1 MPa, tolerance: 1 %, pressures: [1, -1]}}\n"),
        HasSubstr("expected a lateral pressure >= 0, found '-1'"));
    EXPECT_THAT(refusal(head + parameters + "targets: {peak_stress: []}\n"), HasSubstr("found an empty list"));
    for (const char* const stresses : {"0,0\n0.01,0\n", "0,0\n0.01,-1e6\n"}) {
        write_text(directory_ / "flat.csv", std::string("axial_strain,differential_stress\n") + stresses);
        EXPECT_THAT(refusal(head + parameters + "targets: {curve: {file: flat.csv, tolerance: 5 %}}\n"),
                    HasSubstr("expected a curve with a differential_stress above zero"));
    }
    EXPECT_THAT(refusal(head + parameters + target + "replicas: 0\n"), HasSubstr("replicas"));
    std::filesystem::create_directory(directory_ / "folder");
    EXPECT_THAT(refusal("kluft_calibration: 1\nscene: folder\n" + parameters + target),
                HasSubstr("expected a file, found 'folder', which is a directory"));
    for (const char* const set : {"materials.rock.cohesion: 3 MPa", "materials.rock: {cohesion: 3 MPa}"})
        EXPECT_THAT(
            refusal(head +
                    "parameters: {c: {keys: [materials.rock.cohesion], start: 1 MPa, from: 1 MPa, to: 2 MPa}}\n" +
                    "targets: {peak_stress: {value: 1 MPa, tolerance: 1 %, set: {" + set + "}}}\n"),
            HasSubstr("expected keys that no parameter moves, found 'materials.rock.cohesion'"));
    EXPECT_THAT(refusal("[1, 2]\n"), HasSubstr("kluft_calibration: 1"));
}

// The scene's own reader judges the starts; its message stands at the parameter.
TEST_F(CalibrationFiles, StartThatTheSceneRefusesIsToldAtTheParameter) {
    EXPECT_THAT(refusal(head + "parameters: {r: {keys: [interfaces.bond.stiffness_ratio], start: 5, from: 1, to: 9}}\n"
                               "targets: {youngs_modulus: {value: 1 GPa, tolerance: 1 %}}\n"),
                AllOf(HasSubstr("target.yaml:3:25"), HasSubstr("one way to give the stiffness")));
}

TEST(CalibrationSchema, HasEveryKeyOnceAndParentsFirst) {
    std::vector<std::string> seen;
    for (const KeyRule& rule : calibration_schema()) {
        const std::string path(rule.path);
        EXPECT_THAT(seen, ::testing::Not(::testing::Contains(path)));
        const auto dot = path.rfind('.');
        if (dot != std::string::npos) {
            EXPECT_THAT(seen, ::testing::Contains(path.substr(0, dot)));
        }
        EXPECT_FALSE(rule.doc.empty()) << path;
        seen.push_back(path);
    }
}

} // namespace
} // namespace kluft
