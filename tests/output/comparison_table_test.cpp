#include "kluft/output/comparison_table.hpp"

#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace kluft {
namespace {

using ::testing::AllOf;
using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::Not;

ComparisonTable table() {
    ComparisonTable table;
    table.a = {"event", "results/event", "Triaxial", "done", "implicit", 255};
    table.b = {"all", "results/all", "", "", "", {}};
    table.tolerance = 0.05;
    table.quantities = {
        {"peak_stress", "peak axial stress", "MPa", 1e6, 1.5e6, 1.2e6, -0.2, Verdict::missed},
        {"peak_strain", "peak strain", "%", 0.01, 0.012, 0.0121, 0.1 / 12.0, Verdict::within},
        {"residual_stress", "residual stress", "MPa", 1e6, {}, std::numeric_limits<double>::quiet_NaN(), {}},
        {"cracks_tension", "cracks in tension", "", 1.0, 12345678.0, 0.0, -1.0},
        {"curve_mean", "curves, mean difference", "", 1.0, {}, {}, 0.031, Verdict::within}};
    return table;
}

TEST(ComparisonTable, ShowsUnitsSignedDifferencesAndMisses) {
    const std::string text = comparison_text(table());
    EXPECT_THAT(text, HasSubstr("A  results/event  (done, implicit, 255 blocks)\nB  results/all  (no summary)\n"));
    EXPECT_THAT(text, ::testing::ContainsRegex("peak axial stress \\(MPa\\) +1.5 +1.2 +-20.00 %  MISS\n"));
    EXPECT_THAT(text, ::testing::ContainsRegex("peak strain \\(%\\) +1.2 +1.21 +\\+0.83 %  within\n"));
    EXPECT_THAT(text, ::testing::ContainsRegex("residual stress \\(MPa\\) +- +- +-\n"));
    EXPECT_THAT(text, HasSubstr("12345678"));
    EXPECT_THAT(text, ::testing::ContainsRegex("mean difference +- +- +3.10 %  within\n"));
    EXPECT_THAT(text, EndsWith("The runs do not agree within 5 %: peak axial stress.\n"));
}

TEST(ComparisonTable, IsMarkdownWithMissesInBold) {
    ComparisonTable marked = table();
    marked.a.title = "one|two";
    marked.curve_end = 0.012;
    marked.matching_distance = 0.05;
    marked.notes = {"a_note"};
    marked.pictures = {"curves.png"};
    const std::string text = comparison_markdown(marked);
    EXPECT_THAT(text, HasSubstr("| **peak axial stress (MPa)** | **1.5** | **1.2** | **-20.00 %** | **MISS** |\n"));
    EXPECT_THAT(text, AllOf(HasSubstr("one\\|two"), HasSubstr("a\\_note"), HasSubstr("![curves](curves.png)")));
    EXPECT_THAT(text, AllOf(HasSubstr("up to 1.2 %"), HasSubstr("within 0.05 m"), Not(HasSubstr("nan"))));
}

TEST(ComparisonTable, IsJsonInSiWithNullForWhatIsNotKnown) {
    const auto json = nlohmann::json::parse(comparison_json(table()));
    EXPECT_EQ(json["quantities"]["peak_stress"]["a"], 1.5e6);
    EXPECT_EQ(json["quantities"]["peak_stress"]["within"], false);
    EXPECT_EQ(json["quantities"]["peak_strain"]["within"], true);
    EXPECT_TRUE(json["quantities"]["residual_stress"]["b"].is_null());
    EXPECT_TRUE(json["quantities"]["residual_stress"]["within"].is_null());
    EXPECT_TRUE(json["b"]["status"].is_null());
    EXPECT_TRUE(json["b"]["blocks"].is_null());
    EXPECT_TRUE(json["curve_end"].is_null());
    EXPECT_EQ(json["a"]["blocks"], 255);
}

TEST(ComparisonTable, SaysWhenNothingCouldBeJudged) {
    ComparisonTable empty = table();
    empty.quantities.clear();
    EXPECT_THAT(comparison_text(empty), EndsWith("Nothing that could be judged.\n"));
}

} // namespace
} // namespace kluft
