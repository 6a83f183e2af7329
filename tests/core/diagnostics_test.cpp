#include "kluft/core/diagnostics.hpp"

#include <gtest/gtest.h>

namespace kluft {
namespace {

TEST(InputError, CarriesEveryMessageAndJoinsThemByLines) {
    const InputError error(std::vector<std::string>{"first", "second"});
    EXPECT_EQ(error.messages().size(), 2U);
    EXPECT_STREQ(error.what(), "first\nsecond");
}

} // namespace
} // namespace kluft
