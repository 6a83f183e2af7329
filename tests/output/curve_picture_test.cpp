#include "kluft/output/curve_picture.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "kluft/core/diagnostics.hpp"
#include "kluft/output/atomic_file.hpp"
#include "output/temporary_directory.hpp"

namespace kluft {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;
using testing::TemporaryDirectory;

/// A curve that rises to `peak` (Pa, axial) at 1.2 % strain and falls to 70 % of it, at a lateral pressure of 0.2 MPa.
std::vector<StepRecord> synthetic_history(double peak, double peak_strain = 0.012) {
    constexpr double lateral = 0.2e6;
    std::vector<StepRecord> rows;
    for (int step = 0; step <= 110; ++step) {
        StepRecord row;
        row.step = step;
        row.stage = step <= 10 ? 0 : 1;
        row.axial_strain = step <= 10 ? 0.0 : 0.0002 * (step - 10);
        const double x = row.axial_strain / peak_strain;
        const double share =
            x < 1.0 ? 1.0 - (1.0 - x) * (1.0 - x) : 0.7 + 0.3 * std::exp(-12.0 * (x - 1.0) * (x - 1.0));
        row.lateral_stress = step <= 10 ? 0.1 * step * lateral : lateral;
        row.differential_stress = share * (peak - lateral);
        row.axial_stress = row.differential_stress + row.lateral_stress;
        row.lateral_strain = -0.25 * row.axial_strain;
        rows.push_back(row);
    }
    return rows;
}

TEST(CurvePicture, PlotsPercentAndMegapascalsFromTheStartOfThePlaten) {
    const auto plot = stress_strain_plot("t", {{"a", synthetic_history(1.4e6), {}, 1}});
    ASSERT_EQ(plot.curves.size(), 1U);
    ASSERT_EQ(plot.curves[0].points.size(), 101U); // the last state of the pressure stage and 100 steps
    EXPECT_NEAR(plot.curves[0].points.back().value.x(), 2.0, 1e-12);
    EXPECT_NEAR(plot.curves[0].peak->x(), 1.2, 1e-12);
    EXPECT_NEAR(plot.curves[0].peak->y(), 1.2, 1e-12);
    EXPECT_THAT(plot.curves[0].peak_text, ::testing::ElementsAre("differential 1.20 MPa at 1.20 %", "axial 1.40 MPa"));
}

TEST(CurvePicture, NeverCallsAnUnbalancedStepAPeak) {
    auto history = synthetic_history(1.4e6);
    history[90].axial_stress = 3.1e6;
    history[90].balanced = false;
    const auto plot = stress_strain_plot("t", {{"a", history, {}, 1}});
    EXPECT_NEAR(plot.curves[0].peak->y(), 1.2, 1e-12);
    EXPECT_FALSE(plot.curves[0].points[80].balanced);
}

TEST(CurvePicture, SaysThatACurveIsStillRising) {
    auto history = synthetic_history(1.4e6);
    history.resize(60); // before the peak
    const auto plot = stress_strain_plot("t", {{"a", history, {}, 1}});
    EXPECT_FALSE(plot.curves[0].peak_reached);
    EXPECT_EQ(plot.curves[0].peak_text.back(), "not yet falling");
}

TEST(CurvePicture, MarksThePeakBeforeTheNetLocked) {
    auto history = synthetic_history(1.4e6);
    const auto peak = std::ranges::max_element(history, {}, &StepRecord::axial_stress);
    for (auto row = peak; row != history.end(); ++row) row->net_broken = 1.0;
    history.back().axial_stress = 2.8e6;
    const auto plot = stress_strain_plot("t", {{"a", history, {}, 1}, {"b", history, {}, 1}});
    EXPECT_NEAR(plot.curves[0].peak->y(), 1.2, 1e-12);
    EXPECT_FALSE(plot.curves[0].peak_reached);
    EXPECT_EQ(plot.curves[1].label, "b: net locked");
    EXPECT_EQ(stress_strain_plot("t", {{"a", history, {}, 1}}).curves[0].peak_text.back(), "net locked");
}

TEST(CurvePicture, ListsThePeaksOfSeveralRunsInTheLegend) {
    auto rising = synthetic_history(1.4e6);
    rising.resize(60);
    auto unbalanced = synthetic_history(5.0e6);
    unbalanced.back().balanced = false;
    CurvePlot plot = stress_strain_plot(
        "t", {{"a", synthetic_history(1.4e6), {}, 1}, {"b", rising, {}, 1}, {"c", unbalanced, {}, 1}},
        {{"published peak", {}, 1.205, 0}, {"level", {}, 2.0}, {"point", 1.0, 1.0, 1}});
    EXPECT_EQ(plot.curves[0].label, "a: differential 1.20 MPa at 1.20 %");
    EXPECT_EQ(plot.curves[1].label, "b: not yet falling");
    EXPECT_TRUE(plot.curves[0].peak_text.empty());
    plot.y_limit = 3.0; // the third curve leaves the plot
    const std::string alone = draw_curves(stress_strain_plot("t", {{"a", rising, {}, 1}}), PictureFormat::svg);
    const std::string all = draw_curves(plot, PictureFormat::svg);
    EXPECT_THAT(alone, HasSubstr("height=\"350"));
    EXPECT_THAT(all, ::testing::Not(HasSubstr("height=\"350"))); // the legend stands below
}

TEST(CurvePicture, IsWrittenAsPngSvgAndPdf) {
    const TemporaryDirectory directory;
    auto history = synthetic_history(1.405e6);
    history[95].balanced = history[96].balanced = false;
    history[95].differential_stress *= 1.08;
    const auto plot = stress_strain_plot("Model (c), lateral pressure 0.2 MPa", {{"", history, {}, 1}},
                                         {{"published, 1.205 MPa", {}, 1.205}, {"tests", 1.3, 1.208}});
    write_curves(directory / "curve.png", plot);
    write_curves(directory / "curve.svg", plot);
    EXPECT_THAT(read_file(directory / "curve.png"), StartsWith("\x89PNG\r\n"));
    EXPECT_THAT(read_file(directory / "curve.svg"), HasSubstr("</svg>"));
    write_curves(directory / "curve.pdf", plot);
    EXPECT_THAT(read_file(directory / "curve.pdf"), StartsWith("%PDF"));
    EXPECT_THROW(write_curves(directory / "curve.gif", plot), InputError);
}

TEST(CurvePicture, IsDrawnWithATitleThatIsNotUtf8OrTooLong) {
    const auto history = synthetic_history(1e6);
    for (const std::string& title : {std::string("L\xf6\xdf \xff\n \xe2\x82"), std::string(400, 'x')})
        EXPECT_THAT(draw_curves(stress_strain_plot(title, {{title, history, {}, 1}}), PictureFormat::png),
                    StartsWith("\x89PNG"));
}

TEST(CurvePicture, IsDrawnWithoutRowsAndWithValuesThatAreNotNumbers) {
    EXPECT_THAT(draw_curves(stress_strain_plot("empty", {}), PictureFormat::png), StartsWith("\x89PNG"));
    auto history = synthetic_history(1e6);
    history[50].differential_stress = std::numeric_limits<double>::quiet_NaN();
    history[51].axial_stress = std::numeric_limits<double>::infinity();
    EXPECT_THAT(draw_curves(stress_strain_plot("", {{"a", history, {}, 1}}), PictureFormat::svg), HasSubstr("</svg>"));
}

} // namespace
} // namespace kluft
