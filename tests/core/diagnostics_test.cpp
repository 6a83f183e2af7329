#include "kluft/core/diagnostics.hpp"

#include <gtest/gtest.h>

namespace kluft {
namespace {

TEST(InputError, CarriesEveryMessageAndJoinsThemByLines) {
    const InputError error(std::vector<std::string>{"first", "second"});
    EXPECT_EQ(error.messages().size(), 2U);
    EXPECT_STREQ(error.what(), "first\nsecond");
}

TEST(InputError, HasAProblemForEachMessage) {
    const InputError error(std::vector<std::string>{"first", "second"});
    ASSERT_EQ(error.problems().size(), 2U);
    EXPECT_EQ(error.problems()[1].message, "second");
    EXPECT_EQ(error.problems()[1].line, 0);
}

} // namespace
} // namespace kluft
