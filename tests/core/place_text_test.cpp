#include "kluft/core/place_text.hpp"

#include <limits>

#include <gtest/gtest.h>

namespace kluft {
namespace {

TEST(PlaceText, HasSixDigitsAndMillimetresOnMaps) {
    EXPECT_EQ(place_text({0.125, 1.0 / 30.0}), "(0.125, 0.0333333)");
    EXPECT_EQ(place_text({-3.0, 999.1234567}), "(-3, 999.123)");
    EXPECT_EQ(place_text({466013.25, 6692131.05312}), "(466013.25, 6692131.053)");
    EXPECT_EQ(place_text({1e9, -4999.9999}), "(1000000000, -5000)");
    EXPECT_EQ(place_text({std::numeric_limits<double>::quiet_NaN(), 0.0}), "(nan, 0)");
}

} // namespace
} // namespace kluft
