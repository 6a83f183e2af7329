#include "kluft/studies/study_schema.hpp"

#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "kluft/output/atomic_file.hpp"

namespace kluft {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Not;

TEST(StudySchema, HasEveryKeyOnceAndParentsFirst) {
    std::vector<std::string> seen;
    for (const KeyRule& rule : study_schema()) {
        const std::string path(rule.path);
        EXPECT_THAT(seen, Not(Contains(path)));
        const auto dot = path.rfind('.');
        if (dot != std::string::npos) {
            EXPECT_THAT(seen, Contains(path.substr(0, dot)));
        }
        EXPECT_FALSE(rule.doc.empty()) << path;
        seen.push_back(path);
    }
}

TEST(StudySchema, PageOnStudiesNamesItsKeys) {
    const std::string page = read_file(KLUFT_SOURCE_DIR "/docs/studies.md");
    for (const std::string& key : study_schema().child_keys("")) EXPECT_THAT(page, HasSubstr("| `" + key + "` |"));
    for (const std::string& key : study_schema().child_keys("replicas")) EXPECT_THAT(page, HasSubstr(key));
}

} // namespace
} // namespace kluft
