#include "kluft/output/summary.hpp"

#include <limits>
#include <regex>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "kluft/core/diagnostics.hpp"
#include "kluft/output/atomic_file.hpp"
#include "output/temporary_directory.hpp"

namespace kluft {
namespace {

using ::testing::AllOf;
using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::StartsWith;
using testing::TemporaryDirectory;
using ::testing::ThrowsMessage;
using Rows = std::vector<StepRecord>;

StepRecord row(int step, int stage, double strain, double differential, double lateral_strain = 0.0,
               double lateral = 0.2e6) {
    StepRecord record;
    record.step = step;
    record.stage = stage;
    record.axial_strain = strain;
    record.differential_stress = differential;
    record.lateral_strain = lateral_strain;
    record.lateral_stress = lateral;
    record.axial_stress = differential + lateral;
    record.open_close_iterations = 5;
    return record;
}

/// Pressure in two steps, then differential stress = modulus x strain up to 1 % strain and, after that, a fall in a
/// straight line to 60 % at 2 % strain; lateral strain = -ratio x axial strain. 100 steps.
Rows triangle(double modulus, double ratio) {
    Rows rows{row(0, 0, 0, 0, 0, 0), row(1, 0, 0, 0, 0, 0.1e6), row(2, 0, 0, 0)};
    for (int i = 1; i <= 100; ++i) {
        const double strain = 2e-4 * i;
        const double share = strain <= 0.01 ? strain / 0.01 : 1.0 - 0.4 * (strain - 0.01) / 0.01;
        rows.push_back(row(2 + i, 1, strain, share * 0.01 * modulus, -ratio * strain));
    }
    return rows;
}

TEST(Summary, FindsPeakResidualAndConstantsOfATriangle) {
    const Rows rows = triangle(100e6, 0.3);
    const auto numbers = curve_numbers(rows, rows, 1, Plane::stress);
    EXPECT_DOUBLE_EQ(*numbers.peak_stress, 1.2e6);
    EXPECT_DOUBLE_EQ(*numbers.peak_strain, 0.01);
    EXPECT_TRUE(numbers.peak_reached);
    EXPECT_NEAR(*numbers.youngs_modulus, 100e6, 1e-3);
    EXPECT_NEAR(*numbers.poissons_ratio, 0.3, 1e-12);
    // The last tenth of the strain, 1.8 to 2 %: 11 rows on a line whose middle is at 1.9 %.
    EXPECT_NEAR(*numbers.residual_stress, 0.2e6 + (1.0 - 0.4 * 0.9) * 1e6, 1e-3);
    EXPECT_EQ(numbers.steps, 102);
    EXPECT_EQ(numbers.unbalanced_steps, 0);
}

// Rock of E = 100 MPa and nu = 0.3, whose slopes in plane strain are E/(1 - nu^2) and nu/(1 - nu), has these constants also when it is read with
// its own c = nu^2/E (docs/theory.md, (41a)). A ratio of 0.7 is none of a rock, and leaves E.
TEST(Summary, ReadsRockItselfWithAndWithoutFractures) {
    const Rows rows = triangle(100e6 / 0.91, 0.3 / 0.7);
    for (const std::optional<double> across : {std::optional<double>(), std::optional(0.09 / 100e6)}) {
        const auto numbers = curve_numbers(rows, rows, 1, Plane::strain, across);
        EXPECT_NEAR(*numbers.youngs_modulus, 100e6, 1e-3);
        EXPECT_NEAR(*numbers.poissons_ratio, 0.3, 1e-12);
    }
    const Rows wide = triangle(100e6, 0.7);
    const auto alone = curve_numbers(wide, wide, 1, Plane::stress);
    EXPECT_FALSE(alone.youngs_modulus || alone.poissons_ratio);
    const auto sliding = curve_numbers(wide, wide, 1, Plane::stress, 0.0);
    EXPECT_NEAR(sliding.youngs_modulus.value_or(0.0), 100e6, 1e-3);
    EXPECT_FALSE(sliding.poissons_ratio);
}

// Pressed by pressures alone: the stress is one that is given, and strains follow from it (docs/files.md).
TEST(Summary, HasNoPeakWithoutAPlaten) {
    const Rows pulled{row(0, 0, 0, 0, 0, 0), row(1, 0, -1e-4, -0.5e6, 0, 0), row(2, 0, -5e-4, -2.4e6, 0, 0)};
    const auto of_pull = curve_numbers(pulled, pulled, std::nullopt, Plane::strain);
    EXPECT_FALSE(of_pull.peak_stress || of_pull.peak_strain);
    EXPECT_EQ(of_pull.steps, 2);
}

// 1.2 MPa at 1 % beside E = 100 MPa is a stress, 1e-4 Pa is what is left over in the balance of a body without any.
TEST(Summary, TakesRoundOffForZero) {
    const auto cleared = [](double share) {
        Rows rows = triangle(100e6, 0.3);
        for (StepRecord& each : rows) each.axial_stress *= share;
        auto numbers = curve_numbers(rows, rows, 1, Plane::stress);
        clear_round_off(100e6, numbers);
        return numbers;
    };
    EXPECT_DOUBLE_EQ(*cleared(1.0).peak_stress, 1.2e6);
    EXPECT_DOUBLE_EQ(*cleared(1e-6).peak_stress, 1.2);
    EXPECT_EQ(*cleared(1e-10).peak_stress, 0.0);
    EXPECT_EQ(*cleared(1e-10).residual_stress, 0.0);
}

/// A body under 1 MPa from which a platen goes back by 2.1 % in 100 steps: the stress falls by 100 MPa times the strain until it is gone.
Rows relieved() {
    Rows rows{row(0, 0, 0, 0, 0, 0), row(1, 0, 0.01, 1e6, 0, 0)};
    for (int i = 1; i <= 100; ++i) {
        const double strain = 2.1e-4 * i; // 0.987 % under load, 1.008 % without
        rows.push_back(row(1 + i, 1, -strain, std::max(0.0, 1e6 - 100e6 * strain), 0.25 * strain, 0));
    }
    return rows;
}

TEST(Summary, FitsTheModulusUntilThePlatenHasLeft) {
    const Rows rows = relieved();
    EXPECT_NEAR(curve_numbers(rows, rows, 1, Plane::stress).youngs_modulus.value_or(0.0), 100e6, 1e-3);
}

// One of two joints opens at a strain of 0.5 %, from where on the body is half as stiff.
TEST(Summary, FitsTheModulusUntilAJointOpens) {
    Rows rows = relieved();
    for (StepRecord& each : rows) each.locked = 2;
    for (std::size_t i = 25; i < rows.size(); ++i) { // from 0.504 % on
        rows[i].axial_stress = rows[i].differential_stress = 0.5e6 + 50e6 * (rows[i].axial_strain + 0.005);
        rows[i].open = rows[i].locked = 1;
    }
    EXPECT_NEAR(curve_numbers(rows, rows, 1, Plane::stress).youngs_modulus.value_or(0.0), 100e6, 1e-3);
    for (StepRecord& each : rows) each.open = 1; // open from the start: the body is what it is
    EXPECT_LT(curve_numbers(rows, rows, 1, Plane::stress).youngs_modulus.value_or(0.0), 80e6);
}

TEST(Summary, HasNoConstantsOfRoundOff) {
    Rows rows{row(0, 0, 0, 0, 0, 0)};
    for (int i = 1; i <= 20; ++i) rows.push_back(row(i, 0, 1e-5 * i, 4e-7 * i, -2.5e-6 * i, 0));
    auto numbers = curve_numbers(rows, rows, 0, Plane::stress);
    ASSERT_NEAR(*numbers.youngs_modulus, 0.04, 1e-12);
    clear_round_off(10e9, numbers); // 4e-12 of it
    EXPECT_FALSE(numbers.youngs_modulus || numbers.poissons_ratio || numbers.axial_modulus || numbers.lateral_ratio);
}

// E' = E/(1 - nu^2) and nu' = nu/(1 - nu) with E = 80 MPa and nu = 0.25.
TEST(Summary, TurnsTheSlopesOfPlaneStrainIntoTheRocksConstants) {
    const Rows rows = triangle(80e6 / (1.0 - 0.0625), 0.25 / 0.75);
    const auto numbers = curve_numbers(rows, rows, 1, Plane::strain);
    EXPECT_NEAR(*numbers.youngs_modulus, 80e6, 1e-3);
    EXPECT_NEAR(*numbers.poissons_ratio, 0.25, 1e-12);
    EXPECT_NEAR(*numbers.axial_modulus, 80e6 / 0.9375, 1e-3);
    EXPECT_NEAR(*numbers.lateral_ratio, 1.0 / 3.0, 1e-12);
}

TEST(Summary, TakesThePeakFromEquilibriaBetweenTheSteps) {
    const Rows history = triangle(100e6, 0.3);
    Rows equilibria = history;
    equilibria.insert(equilibria.begin() + 53, row(53, 1, 0.0101, 1.05e6)); // just before an event
    const auto numbers = curve_numbers(equilibria, history, 1, Plane::stress);
    EXPECT_DOUBLE_EQ(*numbers.peak_stress, 1.25e6);
    EXPECT_DOUBLE_EQ(*numbers.peak_strain, 0.0101);
}

TEST(Summary, NeverTakesAnUnbalancedEquilibriumForAPeak) {
    Rows rows = triangle(100e6, 0.3);
    rows[80].axial_stress = 3.1e6;
    rows[80].balanced = false;
    const auto numbers = curve_numbers(rows, rows, 1, Plane::stress);
    EXPECT_DOUBLE_EQ(*numbers.peak_stress, 1.2e6);
    EXPECT_EQ(numbers.unbalanced_steps, 1);
}

// The stress has fallen by more than 1 %, but what it settles to is not known.
TEST(Summary, HasNoResidualStressWhereTheRunEndsWithTheDropBehindItsPeak) {
    Rows rows = triangle(100e6, 0.3);
    rows.resize(3 + 60); // to 1.2 % of strain, the peak at 1 %
    const auto numbers = curve_numbers(rows, rows, 1, Plane::stress);
    EXPECT_TRUE(numbers.peak_reached);
    EXPECT_FALSE(numbers.residual_stress.has_value());
}

// A pressure that was there before the platen moved, and was taken away, is no strength.
TEST(Summary, LooksForThePeakFromThePlatensStageOn) {
    Rows rows = triangle(100e6, 0.3);
    rows[1].axial_stress = 30e6;
    const auto numbers = curve_numbers(rows, rows, 1, Plane::stress);
    EXPECT_DOUBLE_EQ(*numbers.peak_stress, 1.2e6);
    EXPECT_DOUBLE_EQ(*numbers.peak_strain, 0.01);
}

TEST(Summary, HasNoPeakWhereTheRunEndsBeforeThePlatenMoves) {
    Rows rows = triangle(100e6, 0.3);
    rows.resize(1);
    const auto at_rest = curve_numbers(rows, rows, 0, Plane::stress);
    EXPECT_FALSE(at_rest.peak_stress || at_rest.peak_reached);
    const Rows pressed = {row(0, 0, 0, 0, 0, 0), row(1, 0, 0, 0, 0, 20e6)};
    const auto numbers = curve_numbers(pressed, pressed, 1, Plane::stress);
    EXPECT_FALSE(numbers.peak_stress || numbers.peak_reached);
}

// A stress that falls while the platen goes back says nothing of a strength.
TEST(Summary, IsNotAtItsPeakWhereThePlatenTurnsBack) {
    Rows rows = triangle(100e6, 0.3);
    rows.resize(3 + 30);
    for (int i = 1; i <= 10; ++i) {
        StepRecord back = rows[static_cast<std::size_t>(32 - i)];
        back.step = 32 + i;
        rows.push_back(back);
    }
    const auto numbers = curve_numbers(rows, rows, 1, Plane::stress);
    EXPECT_FALSE(numbers.peak_reached);
    EXPECT_FALSE(numbers.residual_stress.has_value());
}

// A seating load, then a pull to failure: the strength is that of the pull. And a little unloading before the body is crushed.
TEST(Summary, PeakIsWhereTheBodyFailsWhateverThePlatenDidFirst) {
    Rows pulled{row(0, 0, 0, 0, 0, 0), row(1, 0, 1e-4, 1e6, 0, 0)};
    for (int i = 1; i <= 8; ++i) pulled.push_back(row(1 + i, 1, 1e-4 - 2e-5 * i, 1e6 - 2e5 * i, 0, 0));
    for (int i = 9; i <= 20; ++i) pulled.push_back(row(1 + i, 1, 1e-4 - 2e-5 * i, -0.1e6, 0, 0));
    const auto of_pull = curve_numbers(pulled, pulled, 0, Plane::stress);
    EXPECT_DOUBLE_EQ(*of_pull.peak_stress, -0.6e6);
    EXPECT_TRUE(of_pull.peak_reached);

    Rows crushed = triangle(100e6, 0.3);
    crushed.insert(crushed.begin() + 3, row(3, 1, -1e-5, -1e3));
    for (std::size_t i = 4; i < crushed.size(); ++i) crushed[i].stage = 2;
    const auto of_crush = curve_numbers(crushed, crushed, 1, Plane::stress);
    EXPECT_DOUBLE_EQ(*of_crush.peak_stress, 1.2e6);
    EXPECT_TRUE(of_crush.peak_reached);
}

// An intact body between platens that stay loses nu' times what its sides are relieved of.
TEST(Summary, IsNotAtItsPeakWhereTheSidesAreRelieved) {
    Rows rows = triangle(100e6, 0.3);
    rows.resize(3 + 30);
    for (int i = 1; i <= 10; ++i) {
        StepRecord relieved = rows[32];
        relieved.step = 32 + i;
        relieved.stage = 2;
        relieved.lateral_stress -= 0.02e6 * i;
        relieved.axial_stress -= 0.3 * 0.02e6 * i;
        relieved.differential_stress = relieved.axial_stress - relieved.lateral_stress;
        relieved.lateral_strain -= 1e-4 * i;
        rows.push_back(relieved);
    }
    const auto numbers = curve_numbers(rows, rows, 1, Plane::stress);
    EXPECT_FALSE(numbers.peak_reached);
    EXPECT_NEAR(*numbers.youngs_modulus, 100e6, 1e-3); // of the rows before
    EXPECT_NEAR(*numbers.poissons_ratio, 0.3, 1e-12);
    rows.back().axial_stress -= 0.3e6; // it has failed by that: more than the sides were relieved of
    EXPECT_TRUE(curve_numbers(rows, rows, 1, Plane::stress).peak_reached);
}

// The platen leaves an elastic body and comes back: rows without a touch have no slope.
TEST(Summary, ElasticConstantsEndWhereThePlatenTurnsBack) {
    Rows rows = triangle(100e6, 0.3);
    rows.resize(3 + 10);
    const double farthest = rows.back().axial_strain;
    for (int i = 1; i <= 10; ++i)
        rows.push_back(row(12 + i, 2, farthest * (1.0 - 0.2 * i), std::max(0.0, 1.0 - 0.2 * i) * 100e6 * farthest));
    const auto numbers = curve_numbers(rows, rows, 1, Plane::stress);
    EXPECT_NEAR(*numbers.youngs_modulus, 100e6, 1e-3);
    EXPECT_NEAR(*numbers.poissons_ratio, 0.3, 1e-12);
}

TEST(Summary, RunWithoutAPlatenReachesNoPeak) {
    Rows rows = triangle(100e6, 0.3);
    EXPECT_FALSE(curve_numbers(rows, rows, std::nullopt, Plane::stress).peak_reached);
}

TEST(Summary, HasNoPoissonsRatioWithoutSidesToMeasureItOn) {
    const Rows rows = triangle(100e6, 0.0);
    const auto numbers = curve_numbers(rows, rows, 1, Plane::strain);
    EXPECT_TRUE(numbers.axial_modulus.has_value());
    EXPECT_FALSE(numbers.lateral_ratio || numbers.youngs_modulus || numbers.poissons_ratio);
}

TEST(Summary, HasNoPeakReachedAndNoResidualWhileTheStressRises) {
    Rows rows = triangle(100e6, 0.3);
    rows.resize(53); // to 1 % strain
    auto numbers = curve_numbers(rows, rows, 1, Plane::stress);
    EXPECT_FALSE(numbers.peak_reached);
    EXPECT_FALSE(numbers.residual_stress.has_value());
    EXPECT_DOUBLE_EQ(*numbers.peak_stress, 1.2e6);
    rows.push_back(row(60, 1, 0.0105, 0.9881e6)); // axial stress 0.99 % lower
    EXPECT_FALSE(curve_numbers(rows, rows, 1, Plane::stress).peak_reached);
    rows.push_back(row(61, 1, 0.0106, 0.9879e6)); // 1.01 % lower
    EXPECT_TRUE(curve_numbers(rows, rows, 1, Plane::stress).peak_reached);
}

// An unconfined body that had carried 33 MPa, and 0.6 MPa and less with a splinter out of balance, was said to be still rising.
TEST(Summary, StateOutOfBalanceIsBehindThePeakWhereItCarriesLessThanHalf) {
    Rows rows = triangle(100e6, 0.3);
    rows.resize(53);                            // to 1 % strain
    rows.push_back(row(60, 1, 0.0105, 0.41e6)); // axial stress 49 % lower
    rows.back().balanced = false;
    EXPECT_FALSE(curve_numbers(rows, rows, 1, Plane::stress).peak_reached);
    rows.push_back(row(61, 1, 0.0106, 0.39e6)); // 51 % lower
    rows.back().balanced = false;
    const auto numbers = curve_numbers(rows, rows, 1, Plane::stress);
    EXPECT_TRUE(numbers.peak_reached);
    EXPECT_DOUBLE_EQ(*numbers.peak_stress, 1.2e6);
    EXPECT_FALSE(numbers.residual_stress.has_value()); // of balanced states only
}

TEST(Summary, ElasticConstantsEndWhereMoreThanAHundredthOfWhatIsClosedSlides) {
    Rows rows = triangle(100e6, 0.3);
    for (auto& each : rows) {
        each.locked = 990;
        each.sliding = each.axial_strain > 0.005 ? 11 : 9;
        if (each.axial_strain > 0.005) each.lateral_strain = -7.0 * each.axial_strain;
    }
    EXPECT_NEAR(*curve_numbers(rows, rows, 1, Plane::stress).poissons_ratio, 0.3, 1e-12);
}

// Loose cells behind the first crack: a body that presses its sides out by more than it is pressed together.
TEST(Summary, ElasticConstantsEndWhereTheFirstBondFails) {
    Rows rows = triangle(100e6, 0.3);
    for (auto& each : rows) {
        each.cracks_tension = 2; // from before the platen moved
        if (each.axial_strain <= 0.005) continue;
        each.cracks_shear = 1;
        each.lateral_strain = -1.5 * each.axial_strain;
    }
    const auto numbers = curve_numbers(rows, rows, 1, Plane::stress);
    EXPECT_NEAR(*numbers.poissons_ratio, 0.3, 1e-12);
    EXPECT_NEAR(*numbers.youngs_modulus, 100e6, 1e-3);
}

/// Elastic up to a differential stress of 2 MPa at 0.2 % strain, then with the hardening modulus to 1 %; 50 load steps at a lateral stress.
Rows yielding(double hardening, double lateral) {
    Rows rows{row(0, 0, 0, 0, 0, lateral)};
    for (int i = 1; i <= 50; ++i) {
        const double strain = 2e-4 * i;
        rows.push_back(row(i, 1, strain, std::min(strain * 1e9, 2e6 + (strain - 2e-3) * hardening), 0, lateral));
    }
    return rows;
}

bool has_levelled_off(const Rows& rows) { return curve_numbers(rows, rows, 1, Plane::strain).levelled_off; }

// A joint that slides by Coulomb's law keeps its stress; over the last third of the strain, 0.33 %, a hardening of 5 MPa adds 0.8 % of
// the stress and one of 10 MPa 1.6 %.
TEST(Summary, AStressThatLevelsOffIsAStrength) {
    const Rows level = yielding(0.0, 0.2e6);
    const auto numbers = curve_numbers(level, level, 1, Plane::strain);
    EXPECT_TRUE(numbers.levelled_off && is_strength(numbers));
    EXPECT_FALSE(numbers.peak_reached || numbers.residual_stress);
    EXPECT_EQ(peak_remark(numbers), "levelled off");
    EXPECT_TRUE(has_levelled_off(yielding(5e6, 0.2e6)));
    EXPECT_TRUE(has_levelled_off(yielding(-2e6, 0.2e6)));
    EXPECT_FALSE(has_levelled_off(yielding(10e6, 0.2e6)));
    EXPECT_FALSE(has_levelled_off(yielding(1e9, 0.2e6)));
    EXPECT_FALSE(
        has_levelled_off(yielding(1e9, 1e9))); // elastic: its stress grows by 1 % only, since the sides bear 1 GPa
    EXPECT_FALSE(has_levelled_off(triangle(100e6, 0.3))); // falls
    Rows held{row(0, 0, 0, 0), row(1, 1, 1e-3, 20e6)};    // a platen under a stress that hardly grows any more
    for (int i = 2; i <= 6; ++i) held.push_back(row(i, 1, 1e-3 + 2e-7 * i, 20e6 + 4e3 * i));
    EXPECT_FALSE(has_levelled_off(held));
    EXPECT_FALSE(has_levelled_off({held.begin() + 1, held.end()})); // as in equilibria.csv
}

// Pressed to 20 MPa under 5 MPa and held there while its sides go down to 3.3 MPa, where it breaks.
TEST(Summary, SaysThatTheSidesWereUnloadedBeforeTheStressFell) {
    Rows rows{row(0, 0, 0, 0, 0, 5e6), row(1, 1, 1e-3, 15e6, 0, 5e6), row(2, 1, 1e-3, 15.999e6, 0, 4e6),
              row(3, 1, 1e-3, 16.698e6, 0, 3.3e6), row(4, 1, 1.1e-3, 6.8e6, 0, 3.2e6)};
    const auto unloaded = curve_numbers(rows, rows, 1, Plane::strain);
    EXPECT_TRUE(unloaded.peak_reached && unloaded.sides_unloaded);
    EXPECT_EQ(peak_remark(unloaded), "sides unloaded");
    rows.pop_back(); // not broken yet
    EXPECT_EQ(peak_remark(curve_numbers(rows, rows, 1, Plane::strain)), "not yet falling");
    EXPECT_FALSE(curve_numbers(triangle(100e6, 0.3), triangle(100e6, 0.3), 1, Plane::strain).sides_unloaded);
}

TEST(Summary, HasNotLevelledOffOutOfBalanceOrWhereLoadsTurn) {
    const auto with = [](auto change) {
        Rows rows = yielding(0.0, 0.2e6);
        change(rows[40]);
        return has_levelled_off(rows);
    };
    EXPECT_TRUE(with([](StepRecord&) {}));
    EXPECT_FALSE(with([](StepRecord& row) { row.balanced = false; }));
    EXPECT_FALSE(with([](StepRecord& row) { row.axial_strain = 0.0; }));
    EXPECT_FALSE(with([](StepRecord& row) { row.lateral_stress = 0.3e6; }));
}

// The block of a shear box under 1 MPa, which carries 1.155 MPa and slides out from under its load by a hundred-thousandth of its length
// per load step; and sides that are pressed by 1 % more meanwhile.
TEST(Summary, AStressIsLevelThoughWhatSlidesIsPressedOnEverLess) {
    const auto with_drift = [](double per_step) {
        Rows rows{row(0, 0, 0, 0, 0, 1e6)};
        for (int i = 1; i <= 20; ++i) {
            const double lateral = 1e6 * (1.0 + per_step * i);
            rows.push_back(row(i, 1, 2.5e-5 * i, std::min(0.1e6 * i, 1.155e6) - lateral, 0.0, lateral));
        }
        return has_levelled_off(rows);
    };
    EXPECT_TRUE(with_drift(0.0));
    EXPECT_TRUE(with_drift(1e-5));
    EXPECT_TRUE(with_drift(-1e-5));
    EXPECT_FALSE(with_drift(1e-2 / 6));
}

// A joint that slides from the first load step on: what is left over in balance makes the curve rise by 1e-8 of itself.
TEST(Summary, HasNoModulusWhereTheStressDoesNotRise) {
    Rows rows{row(0, 0, 0, 2e6)};
    for (int i = 1; i <= 50; ++i) rows.push_back(row(i, 1, 2e-4 * i, 2e6 + 4e-4 * i, -6e-5 * i));
    const auto numbers = curve_numbers(rows, rows, 1, Plane::stress);
    EXPECT_FALSE(numbers.axial_modulus || numbers.youngs_modulus || numbers.poissons_ratio);
}

TEST(Summary, HasNoYoungsModulusWherePoissonsRatioIsImpossible) {
    const Rows rows = triangle(100e6, 0.7);
    const auto numbers = curve_numbers(rows, rows, 1, Plane::stress);
    EXPECT_FALSE(numbers.youngs_modulus || numbers.poissons_ratio);
    EXPECT_NEAR(*numbers.axial_modulus, 100e6, 1e-3);
    EXPECT_NEAR(*numbers.lateral_ratio, 0.7, 1e-12);
}

// The triangle pulled instead of pressed, without lateral pressure.
TEST(Summary, PeakOfATensionTestIsTheLargestTension) {
    Rows rows = triangle(100e6, 0.3);
    for (StepRecord& each : rows) {
        each.axial_strain = -each.axial_strain;
        each.lateral_strain = -each.lateral_strain;
        each.differential_stress = each.axial_stress = -each.differential_stress;
        each.lateral_stress = 0.0;
    }
    const auto numbers = curve_numbers(rows, rows, 1, Plane::stress);
    EXPECT_DOUBLE_EQ(*numbers.peak_stress, -1e6);
    EXPECT_DOUBLE_EQ(*numbers.peak_strain, -0.01);
    EXPECT_TRUE(numbers.peak_reached);
    EXPECT_NEAR(*numbers.youngs_modulus, 100e6, 1e-3);
    EXPECT_NEAR(*numbers.poissons_ratio, 0.3, 1e-12);
    EXPECT_NEAR(*numbers.residual_stress, -(1.0 - 0.4 * 0.9) * 1e6, 1e-3);
}

TEST(Summary, UsesTheRangeToThirtyPercentOfThePeakWhereAllSlidesFromTheStart) {
    Rows rows = triangle(100e6, 0.3);
    for (auto& each : rows) {
        each.sliding = each.locked = 50;
        if (each.differential_stress > 0.31e6) each.lateral_strain = -7.0 * each.axial_strain;
    }
    EXPECT_NEAR(*curve_numbers(rows, rows, 1, Plane::stress).poissons_ratio, 0.3, 1e-12);
}

// Two steps to the peak: the first is beyond 30 %, so that only the start lies in the range.
TEST(Summary, InterpolatesTheRangeWhenStepsAreCoarse) {
    Rows rows{row(0, 0, 0, 0), row(1, 1, 0.005, 0.5e6, -0.001), row(2, 1, 0.01, 1e6, -0.004)};
    rows[1].sliding = 1;
    const auto numbers = curve_numbers(rows, rows, 1, Plane::stress);
    EXPECT_NEAR(*numbers.youngs_modulus, 100e6, 1e-3);
    EXPECT_NEAR(*numbers.poissons_ratio, 0.2, 1e-12);
}

/// Axial stresses (MPa) of the platen stage, each with the share of the net's bonds that have failed.
Rows rows_of_net(const std::vector<std::pair<double, double>>& stresses, double sense = 1.0) {
    Rows rows{row(0, 0, 0, 0, 0, 0)};
    for (const auto& [stress, broken] : stresses) {
        rows.push_back(row(static_cast<int>(rows.size()), 1, sense * 1e-3 * static_cast<double>(rows.size()),
                           sense * 1e6 * stress, 0.0, 0.0));
        rows.back().net_broken = broken;
    }
    return rows;
}

TEST(Summary, LockedNetHasThePeakFromBeforeAndNoneReached) {
    const Rows rows = rows_of_net({{10, 0}, {39, 0.6}, {37, 0.7}, {38, 1}, {40.96, 1}, {30, 1}});
    const auto locked = curve_numbers(rows, rows, 1, Plane::stress);
    EXPECT_TRUE(locked.net_locked);
    EXPECT_FALSE(locked.peak_reached);
    EXPECT_EQ(peak_remark(locked), "net locked");
    EXPECT_DOUBLE_EQ(*locked.peak_stress, 39e6);
    EXPECT_DOUBLE_EQ(*locked.peak_strain, 0.002);
    EXPECT_FALSE(locked.residual_stress.has_value());
    const Rows pulled = rows_of_net({{10, 0}, {39, 0.6}, {37, 0.7}, {38, 1}, {40.96, 1}, {30, 1}}, -1.0);
    EXPECT_TRUE(is_net_locked(pulled, 1));
    EXPECT_DOUBLE_EQ(peak_row(pulled, 1)->axial_stress, -39e6);
}

TEST(Summary, NetIsNotLockedByLessThanItTakes) {
    const auto locked = [](const std::vector<std::pair<double, double>>& stresses) {
        const Rows rows = rows_of_net(stresses);
        return is_net_locked(rows, 1);
    };
    EXPECT_TRUE(locked({{39, 0.6}, {37, 0.7}, {40.96, 1}}));
    EXPECT_FALSE(locked({{39, 0.6}, {37, 0.7}, {40.94, 1}}));           // 4.97 % above
    EXPECT_FALSE(locked({{39, 0.6}, {37, 0.69}, {80, 0.69}, {70, 1}})); // bonds carry
    EXPECT_FALSE(locked({{39, 0.6}, {20, 0.7}, {36, 1}}));              // rises again, but not to what the rock had
    EXPECT_FALSE(locked({{39, 0}, {80, 0}}));                           // no net
    EXPECT_FALSE(locked({}));
}

TEST(Summary, UnbalancedEquilibriumDoesNotLockTheNet) {
    Rows rows = rows_of_net({{39, 0.9}, {37, 1}, {60, 1}, {36, 1}});
    rows[3].balanced = false;
    const auto numbers = curve_numbers(rows, rows, 1, Plane::stress);
    EXPECT_FALSE(numbers.net_locked);
    EXPECT_TRUE(numbers.peak_reached);
    EXPECT_DOUBLE_EQ(*numbers.peak_stress, 39e6);
}

TEST(Summary, HasNoNumbersWithoutRowsOrPlaten) {
    const auto empty = curve_numbers({}, {}, 1, Plane::strain);
    EXPECT_FALSE(empty.peak_stress || empty.residual_stress || empty.youngs_modulus || empty.peak_reached);
    const Rows still{row(0, 0, 0, 0), row(1, 0, 0, 0)};
    EXPECT_FALSE(curve_numbers(still, still, std::nullopt, Plane::strain).youngs_modulus.has_value());
    EXPECT_FALSE(curve_numbers(still, still, 0, Plane::strain).youngs_modulus.has_value());
}

TEST(Summary, HasTheKeysOfTheContractAndNullForWhatIsUnknown) {
    RunSummary summary;
    summary.costs.elapsed_s = std::numeric_limits<double>::quiet_NaN();
    summary.numbers.peak_strain = std::numeric_limits<double>::infinity();
    summary.costs.seconds.assembly = 1.5;
    const std::string text = summary_json(summary);
    EXPECT_THAT(text, ::testing::Not(::testing::HasSubstr("nan")));
    const auto json = nlohmann::json::parse(text);
    for (const char* key : {"status",
                            "peak_stress",
                            "peak_strain",
                            "peak_reached",
                            "net_locked",
                            "sides_unloaded",
                            "residual_stress",
                            "youngs_modulus",
                            "poissons_ratio",
                            "cracks_tension",
                            "cracks_shear",
                            "jumps",
                            "blocks",
                            "interfaces",
                            "unknowns",
                            "steps",
                            "unbalanced_steps",
                            "open_close_iterations",
                            "factorizations",
                            "analyses",
                            "elapsed_s",
                            "loading_cpu_s",
                            "cpu_s",
                            "peak_memory_bytes",
                            "version",
                            "seconds"})
        EXPECT_TRUE(json.contains(key)) << key;
    EXPECT_EQ(json["status"], "done");
    EXPECT_TRUE(json["peak_stress"].is_null());
    EXPECT_TRUE(json["peak_strain"].is_null());
    EXPECT_TRUE(json["elapsed_s"].is_null());
    EXPECT_EQ(json["peak_reached"], false);
    EXPECT_EQ(json["seconds"]["assembly"], 1.5);
}

TEST(Summary, IsReadBack) {
    const TemporaryDirectory directory;
    RunSummary summary;
    summary.status = RunStatus::collapsed;
    summary.title = "slope \"A\"";
    summary.numbers.peak_stress = 1.0 / 3.0;
    summary.numbers.cracks_shear = 4;
    summary.numbers.net_locked = true;
    summary.numbers.sides_unloaded = true;
    summary.blocks = 255;
    summary.platen_stage = 1;
    summary.peak_memory_bytes = 5'000'000'000;
    summary.costs.seconds.solution = 2.0;
    summary.costs.rejected_steps = 3;
    summary.results.factor_of_safety = 1.25;
    write_summary(directory / "summary.json", summary);
    EXPECT_EQ(summary_json(read_summary(directory / "summary.json")), summary_json(summary));
    summary.platen_stage.reset(); // an earlier version wrote the stress of a load
    write_summary(directory / "summary.json", summary);
    EXPECT_FALSE(read_summary(directory / "summary.json").numbers.peak_stress);
    write_file(directory / "summary.json", "{\"status\": \"done\"}");
    EXPECT_THROW((void)read_summary(directory / "summary.json"), InputError);
    const std::string damaged =
        std::regex_replace(summary_json(summary), std::regex("\"peak_stress\": [^,]*"), "\"peak_stress\": \"high\"");
    write_file(directory / "summary.json", damaged);
    EXPECT_THAT([&] { (void)read_summary(directory / "summary.json"); },
                ThrowsMessage<InputError>(HasSubstr("peak_stress: expected a number or null, found \"high\"")));
    const auto message_of = [&](const std::string& text) {
        write_file(directory / "summary.json", text);
        try {
            (void)read_summary(directory / "summary.json");
        } catch (const InputError& error) {
            return std::string(error.what());
        }
        return std::string();
    };
    const std::string expected = (directory / "summary.json").string() + ": expected the summary of a run, found ";
    EXPECT_EQ(message_of("{"), expected + "no JSON from byte 2 on");
    EXPECT_EQ(message_of("[1]"), expected + "JSON without all its keys or with other values");
    const std::string whole = summary_json(summary);
    for (const std::string key :
         {"residual_stress", "peak_reached", "steps", "blocks", "unknowns", "title", "warnings"}) {
        const std::string place = (directory / "summary.json").string() + ": " + key + ": expected ";
        EXPECT_THAT(
            message_of(std::regex_replace(whole, std::regex("\"" + key + "\": [^,]*,"), "\"" + key + "\": {},")),
            AllOf(StartsWith(place), EndsWith("found {}")));
        if (key == "warnings") continue; // earlier versions wrote none
        EXPECT_THAT(message_of(std::regex_replace(whole, std::regex("\"" + key + "\": [^,]*,"), "")),
                    AllOf(StartsWith(place), EndsWith("found nothing")));
    }
}

TEST(Summary, CountsAtLeastTheMemoryThatIsHeld) {
    const std::vector<char> held(50'000'000, 'x');
    EXPECT_GT(peak_memory_bytes(), static_cast<std::int64_t>(held.size()));
}

} // namespace
} // namespace kluft
