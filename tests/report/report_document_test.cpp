#include "kluft/report/report_document.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace kluft {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

// The test vectors of RFC 4648, section 10.
TEST(ReportDocument, Base64IsThatOfTheStandard) {
    EXPECT_EQ(base64(""), "");
    EXPECT_EQ(base64("f"), "Zg==");
    EXPECT_EQ(base64("fo"), "Zm8=");
    EXPECT_EQ(base64("foo"), "Zm9v");
    EXPECT_EQ(base64("foobar"), "Zm9vYmFy");
    EXPECT_EQ(base64("\xff\xfe"), "//4=");
}

TEST(ReportDocument, TextKeepsNoMeaningOfMarkdownOrHtml) {
    const ReportDocument document{ReportHeading{1, "a_b & <c>"}, ReportParagraph{"x | y"}};
    EXPECT_EQ(report_markdown(document), "# a\\_b & \\<c>\n\nx \\| y\n");
    EXPECT_THAT(report_html(document), HasSubstr("<title>a_b &amp; &lt;c&gt;</title>"));
    EXPECT_THAT(report_html(document), Not(HasSubstr("<c>")));
}

TEST(ReportDocument, TablesSetNumbersToTheRightAndMarkRows) {
    const ReportDocument document{ReportTable{{"case", "value"}, {{"a", "1"}, {"b", "-"}}, {1}, 1}};
    EXPECT_EQ(report_markdown(document), "| case | value |\n|---|---:|\n| a | 1 |\n| b | - |\n");
    EXPECT_THAT(report_html(document), HasSubstr("<tr><td>a</td><td class=number>1</td></tr>"));
    EXPECT_THAT(report_html(document), HasSubstr("<tr class=marked><td>b</td>"));
}

TEST(ReportDocument, AnswerComesWithTheLineToCopy) {
    const ReportDocument document{ReportHeading{1, "T"},
                                  ReportAnswer{"Strength", "2 < 3", "So.", "kluft run --set a=1"},
                                  ReportHeading{2, "A"}, ReportHeading{2, "B"}};
    EXPECT_EQ(report_markdown(document),
              "# T\n\n**Strength: 2 \\< 3**\n\nSo.\n\n    kluft run --set a=1\n\n## A\n\n## B\n");
    const std::string page = report_html(document);
    EXPECT_THAT(page, HasSubstr("<p class=\"value\">2 &lt; 3</p>"));
    EXPECT_THAT(page, HasSubstr(">kluft run --set a=1</code><button class=\"act\" data-copy=\"command-1\">"));
    EXPECT_THAT(page, HasSubstr("<h2>A</h2>\n</section>\n<section class=\"long\">\n<h2>B</h2>\n</section>\n"));
}

TEST(ReportDocument, PicturesStandBesideTheMarkdownAndInsideTheHtml) {
    const ReportDocument document{ReportPicture{"work.png", "Error", "<svg/>"}, ReportList{{"one", "two"}}};
    EXPECT_EQ(report_markdown(document), "![Error](work.png)\n\n- one\n- two\n");
    EXPECT_THAT(report_html(document), HasSubstr("<img src=\"data:image/svg+xml;base64,PHN2Zy8+\" alt=\"Error\">"));
}

} // namespace
} // namespace kluft
