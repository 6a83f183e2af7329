#include "kluft/report/report_page.hpp"

#include <cmath>
#include <stdexcept>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "kluft/core/diagnostics.hpp"
#include "kluft/output/atomic_file.hpp"
#include "kluft/report/number_table.hpp"
#include "output/temporary_directory.hpp"

namespace kluft {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

TEST(ReportPage, FillsEachNameOnceAndNothingInTheTextsThemselves) {
    EXPECT_EQ(filled("<a>{{x}}</a>{{y}}{{x}}", {{"x", "{{y}}"}, {"y", "2"}}), "<a>{{y}}</a>2{{y}}");
    EXPECT_EQ(filled("plain", {}), "plain");
    EXPECT_THROW((void)filled("{{z}}", {{"x", "1"}}), std::logic_error);
}

TEST(ReportPage, HasNothingThatATextCouldEndItsElementWith) {
    EXPECT_EQ(html_text("a<b & \"c\">"), "a&lt;b &amp; &quot;c&quot;&gt;");
    EXPECT_THAT(escaped_json(R"(["</script>"])"), Not(HasSubstr("<")));
    EXPECT_EQ(escaped_json("[\"<\"]"), "[\"\\u003c\"]");
}

TEST(ReportPage, IsOneFileWithItsStyleAndItsProgram) {
    const std::string page = html_of({"A & B", "<p>text</p>", {}, {}, false});
    EXPECT_THAT(page, HasSubstr("<title>A &amp; B</title>"));
    EXPECT_THAT(page, HasSubstr("<p>text</p>"));
    EXPECT_THAT(page, HasSubstr("sortTable"));
    EXPECT_THAT(page, Not(HasSubstr("Chart.js")));
    EXPECT_THAT(html_of({"A", "", {}, {}, true}), HasSubstr("Chart.js"));
}

TEST(NumberTable, HasTheColumnsOfAFileWithoutItsLastLineWhereThatHasNoEnd) {
    const testing::TemporaryDirectory directory;
    write_file(directory / "t.csv", "step,name.x\n0,1.5e3\n1,nan?\n2,");
    const NumberTable table = read_number_table(directory / "t.csv");
    EXPECT_THAT(table.names, ElementsAre("step", "name.x"));
    EXPECT_THAT(table.columns[0], ElementsAre(0.0, 1.0));
    EXPECT_EQ(table.columns[1][0], 1500.0);
    EXPECT_TRUE(std::isnan(table.columns[1][1]));
    write_file(directory / "t.csv", "a,b\n1\n");
    EXPECT_THROW((void)read_number_table(directory / "t.csv"), InputError);
}

} // namespace
} // namespace kluft
