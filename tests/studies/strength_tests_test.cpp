#include "kluft/studies/strength_tests.hpp"

#include <numbers>
#include <optional>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "kluft/core/diagnostics.hpp"
#include "kluft/output/atomic_file.hpp"
#include "kluft/output/envelope.hpp"
#include "kluft/output/history_table.hpp"
#include "kluft/output/summary.hpp"
#include "output/temporary_directory.hpp"
#include "support/units.hpp"

namespace kluft {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using testing::TemporaryDirectory;

class StrengthTable : public ::testing::Test {
protected:
    std::vector<PeakPoint> read(const std::string& content) {
        write_file(directory_ / "tests.csv", content);
        return read_strength_table(directory_ / "tests.csv");
    }
    /// The messages from the line number on: "1:5: ...".
    std::vector<std::string> flaws_of(const std::string& content) {
        try {
            (void)read(content);
        } catch (const InputError& error) {
            std::vector<std::string> flaws;
            for (const std::string& message : error.messages()) {
                EXPECT_THAT(message, ::testing::StartsWith((directory_ / "tests.csv").string()));
                flaws.push_back(message.substr((directory_ / "tests.csv").string().size() + 1));
            }
            return flaws;
        }
        return {};
    }
    TemporaryDirectory directory_;
};

TEST_F(StrengthTable, IsReadInAnyOrderOfColumns) {
    const auto points = read("depth,sigma_1,run,sigma_3\n12,1.5e6,A,0.2e6\n\n13,\"3e6\",\"B, \"\"wet\"\"\",0.55e6\n");
    ASSERT_EQ(points.size(), 2U);
    EXPECT_EQ(points[0].run, "A");
    EXPECT_EQ(points[0].sigma_3, 0.2e6);
    EXPECT_EQ(points[0].sigma_1, 1.5e6);
    EXPECT_TRUE(points[0].peak_reached);
    EXPECT_EQ(points[1].run, "B, \"wet\"");
    EXPECT_EQ(points[1].sigma_1, 3e6);
}

TEST_F(StrengthTable, ConvertsTheUnitsOfItsHeader) {
    const auto points =
        read("\xEF\xBB\xBFsigma_3 (kPa),sigma_1 [MPa],peak_reached\r\n200,1.5,1\r\n550,3,false\r\n-100,0,\r\n");
    ASSERT_EQ(points.size(), 3U);
    EXPECT_DOUBLE_EQ(points[0].sigma_3, 0.2e6);
    EXPECT_DOUBLE_EQ(points[0].sigma_1, 1.5e6);
    EXPECT_EQ(points[0].run, "tests 1");
    EXPECT_EQ(use_of(points[1]), PeakUse::bound);
    EXPECT_EQ(use_of(points[2]), PeakUse::tension);
}

TEST_F(StrengthTable, IsAlsoTheOneThatAnEnvelopeWrites) {
    const std::vector<PeakPoint> points{{"a, \"b\"", 0.0, 1.0 / 3.0 * 1e6},
                                        {"c", 1e6, 5e6},
                                        {"d", 0.5e6, 4e6, false},
                                        {"e", 0.5e6, 4e6, true, false},
                                        {"f", 0.5e6, 4e6, true, true, true},
                                        {.run = "sides", .sigma_3 = 2e6, .sigma_1 = 6e6, .unloaded = true},
                                        {.run = "slope", .sigma_1 = 4e6, .moves_platen = false},
                                        {"g", -0.1e6, 0.0}};
    const auto again = read(envelope_csv(points, fit_strength(points)));
    ASSERT_EQ(again.size(), points.size());
    for (std::size_t i = 0; i < points.size(); ++i) {
        EXPECT_EQ(again[i].run, points[i].run);
        EXPECT_EQ(again[i].sigma_3, points[i].sigma_3);
        EXPECT_EQ(again[i].sigma_1, points[i].sigma_1);
        EXPECT_EQ(again[i].peak_reached, points[i].peak_reached);
        EXPECT_EQ(again[i].balanced, points[i].balanced);
        EXPECT_EQ(bound_reason(again[i]), bound_reason(points[i]));
    }
}

// The table as it was before it had further columns than peak_reached.
TEST_F(StrengthTable, IsAlsoTheOneOfEarlierVersions) {
    const auto points =
        read("run,sigma_3,sigma_1,fitted_sigma_1,peak_reached\nc0,0,500000,510000,1\nc1,1e6,5e6,5e6,0\n");
    ASSERT_EQ(points.size(), 2U);
    EXPECT_EQ(use_of(points[0]), PeakUse::strength);
    EXPECT_EQ(use_of(points[1]), PeakUse::bound);
}

TEST_F(StrengthTable, NamesMissingAndMistypedColumns) {
    EXPECT_THAT(flaws_of("sigma_3;sigma_1\n0;1\n"), ::testing::Contains(HasSubstr("1:1: expected a column 'sigma_1'")));
    EXPECT_THAT(flaws_of("sigma_3,sigma_1,peak_reched\n0,1,1\n"),
                ElementsAre("1:17: unknown column 'peak_reched'; did you mean 'peak_reached'?"));
    EXPECT_THAT(flaws_of("sigma_3,simga_1\n0,1\n"),
                ElementsAre("1:9: unknown column 'simga_1'; did you mean 'sigma_1'?",
                            HasSubstr("1:1: expected a column 'sigma_1', found 'sigma_3,simga_1'")));
    EXPECT_THAT(flaws_of("sigma_3,sigma_1,sigma_1\n0,1,1\n"), ElementsAre("1:17: a second column 'sigma_1'"));
    EXPECT_THAT(flaws_of("sigma_3 (mm),sigma_1\n0,1\n"),
                ElementsAre(AllOf(HasSubstr("1:1: sigma_3: expected a unit of stress"), HasSubstr("found 'mm'"))));
    EXPECT_THAT(flaws_of(""), ::testing::SizeIs(2));
    // A middle principal stress is nobody's misspelling where both others are there.
    EXPECT_EQ(read("sigma_1,sigma_2,sigma_3\n3,2,1\n").size(), 1U);
}

TEST_F(StrengthTable, NamesEveryBadCellByLineAndColumn) {
    EXPECT_THAT(
        flaws_of("run,sigma_3,sigma_1,peak_reached\na,x,1e6,1\nb,0,nan,1\nc,2e6,1e6,1\nd,0,1e6,yes\ne,0\nf,0,1e20,1\n"),
        ElementsAre("2:3: sigma_3: expected a number, found 'x'",
                    "3:5: sigma_1: expected a number, found 'nan', which is not finite",
                    HasSubstr("4:7: sigma_1: expected at least sigma_3 = 2e+06 Pa, found 1e+06 Pa"),
                    "5:9: peak_reached: expected 0 or 1, found 'yes'", "6:1: expected 4 columns, found 2",
                    HasSubstr("7:5: sigma_1: expected a stress within 1e+15 Pa")));
}

TEST_F(StrengthTable, NeedsARow) {
    EXPECT_THROW((void)read("sigma_3,sigma_1\n\n"), InputError);
    EXPECT_THROW((void)read_strength_table(directory_ / "absent.csv"), InputError);
}

// ---- runs ----------------------------------------------------------------------------------------------------------

class PeakOfRun : public ::testing::Test {
protected:
    /// Rows of stage 1 that press (sense 1) or pull (-1) up to `peak` and end at `last`.
    void write_run(double sense, double peak, double last, RunStatus status) {
        std::vector<StepRecord> rows(3);
        for (int i = 0; i < 3; ++i) {
            StepRecord& row = rows[static_cast<std::size_t>(i)];
            row.step = i;
            row.stage = i == 0 ? 0 : 1;
            row.axial_strain = sense * 0.001 * i;
            row.lateral_stress = lateral_;
        }
        rows[0].axial_stress = lateral_;
        rows[1].axial_stress = peak;
        rows[2].axial_stress = last;
        rows[2].lateral_stress = lateral_at_end_.value_or(lateral_);
        std::string table = history_header() + '\n';
        for (const StepRecord& row : rows) table += table_row(row) + '\n';
        write_file(directory_ / "history.csv", table);
        RunSummary summary;
        summary.status = status;
        summary.platen_stage = 1;
        write_summary(directory_ / "summary.json", summary);
    }
    void set_net_locked(const std::string& value) {
        std::string text = read_file(directory_ / "summary.json");
        const std::string key = "\"net_locked\": ";
        const std::size_t at = text.find(key) + key.size();
        text.replace(at, text.find(',', at) - at, value);
        write_file(directory_ / "summary.json", text);
    }
    double lateral_ = 0.2e6;
    std::optional<double> lateral_at_end_; ///< where the sides are unloaded
    TemporaryDirectory directory_;
};

TEST_F(PeakOfRun, OfACompressionTestIsTheLargestAxialStress) {
    write_run(1.0, 1.4e6, 1.0e6, RunStatus::done);
    const PeakPoint point = read_peak(directory_.path(), "c");
    EXPECT_EQ(point.sigma_1, 1.4e6);
    EXPECT_EQ(point.sigma_3, 0.2e6);
    EXPECT_EQ(use_of(point), PeakUse::strength);
}

// A joint of 1 MPa and 30 degrees fails at sigma_1 = 2 c cos(phi)/(1 - sin(phi)) + 3 sigma_3 = 2 sqrt(3) MPa + 3 sigma_3. The third
// test stands at 20 MPa under 8 MPa until its sides have 1 MPa.
TEST_F(PeakOfRun, AndItsRowInATableGiveTheSameEnvelope) {
    std::vector<PeakPoint> points;
    for (const double sigma_3 : {2e6, 8e6}) {
        lateral_ = sigma_3;
        write_run(1.0, 2e6 * std::numbers::sqrt3 + 3.0 * sigma_3, sigma_3, RunStatus::done);
        points.push_back(read_peak(directory_.path(), "strength"));
    }
    lateral_at_end_ = 1e6;
    write_run(1.0, 20e6, 19.9e6, RunStatus::done);
    points.push_back(read_peak(directory_.path(), "unloaded"));
    ASSERT_EQ(bound_reason(points.back()), "sides unloaded");
    write_file(directory_ / "tests.csv", envelope_csv(points, fit_strength(points)));
    const Envelope again = fit_strength(read_strength_table(directory_ / "tests.csv")).envelope;
    EXPECT_NEAR(again.cohesion, 1e6, 1.0);
    EXPECT_NEAR(again.friction_angle, 30.0 * degree, 1e-6);
}

TEST_F(PeakOfRun, OfARunWithoutAPlatenIsNone) {
    write_run(1.0, 1.4e6, 1.0e6, RunStatus::done);
    RunSummary summary = read_summary(directory_ / "summary.json");
    summary.platen_stage.reset();
    write_summary(directory_ / "summary.json", summary);
    const PeakPoint point = read_peak(directory_.path(), "slope");
    EXPECT_EQ(use_of(point), PeakUse::bound);
    EXPECT_EQ(bound_reason(point), "moves no platen");
    EXPECT_FALSE(contradicts(point, fit_strength({{"a", 0.0, 0.1e6}, {"b", 1e6, 3.1e6}}))); // 0.7 MPa at 0.2 MPa
}

// Pulled with glued platens, without lateral pressure: sigma_3 is the axial stress, negative.
TEST_F(PeakOfRun, OfAPulledRunIsATensileStrength) {
    lateral_ = 0.0;
    write_run(-1.0, -0.1e6, -0.01e6, RunStatus::done);
    const PeakPoint point = read_peak(directory_.path(), "pulled");
    EXPECT_EQ(point.sigma_3, -0.1e6);
    EXPECT_EQ(point.sigma_1, 0.0);
    EXPECT_EQ(use_of(point), PeakUse::tension);
    write_run(-1.0, -0.1e6, -0.1e6, RunStatus::done);
    EXPECT_EQ(bound_reason(read_peak(directory_.path(), "pulled")), "not yet falling");
}

TEST_F(PeakOfRun, IsABoundWhereTheSummarySaysUnbalancedOrLocked) {
    write_run(1.0, 1.4e6, 1.0e6, RunStatus::unbalanced);
    EXPECT_EQ(bound_reason(read_peak(directory_.path(), "c")), "unbalanced");
    write_run(1.0, 1.4e6, 1.0e6, RunStatus::done);
    set_net_locked("false");
    EXPECT_EQ(bound_reason(read_peak(directory_.path(), "c")), "");
    write_run(1.0, 1.4e6, 1.0e6, RunStatus::done);
    set_net_locked("true");
    EXPECT_EQ(bound_reason(read_peak(directory_.path(), "c")), "net locked");
    write_run(1.0, 1.4e6, 1.0e6, RunStatus::done);
    set_net_locked("3");
    EXPECT_THROW((void)read_peak(directory_.path(), "c"), InputError);
}

} // namespace
} // namespace kluft
