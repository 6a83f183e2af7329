#include "kluft/core/nearest_name.hpp"

#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace kluft {
namespace {

TEST(EditDistance, CountsInsertionsDeletionsSubstitutionsAndSwaps) {
    EXPECT_EQ(edit_distance("density", "density"), 0);
    EXPECT_EQ(edit_distance("densty", "density"), 1);
    EXPECT_EQ(edit_distance("densiity", "density"), 1);
    EXPECT_EQ(edit_distance("demsity", "density"), 1);
    EXPECT_EQ(edit_distance("desnity", "density"), 1);
    EXPECT_EQ(edit_distance("", "abc"), 3);
    // Levenshtein's textbook pair
    EXPECT_EQ(edit_distance("kitten", "sitting"), 3);
}

TEST(EditDistance, IgnoresCaseAndTheKindOfSeparator) {
    EXPECT_EQ(edit_distance("Friction-Angle", "friction_angle"), 0);
}

TEST(NearestName, IsTheClosestCandidateWithinAThirdOfTheLength) {
    const std::vector<std::string> names{"cohesion", "cohesion_onset", "density"};
    EXPECT_EQ(nearest_name("cohesoin", names), "cohesion");
    EXPECT_EQ(nearest_name("cohesion_onst", names), "cohesion_onset");
    EXPECT_EQ(nearest_name("velocity", names), "");
}

TEST(NearestName, FallsBackToACandidateThatBeginsWithTheName) {
    EXPECT_EQ(nearest_name("young", {"poissons_ratio", "youngs_modulus"}), "youngs_modulus");
    EXPECT_EQ(nearest_name("yo", {"youngs_modulus"}), "");
}

TEST(NearestName, IsNothingForNoNameNoCandidateAndOverlongNames) {
    EXPECT_EQ(nearest_name("", {"a"}), "");
    EXPECT_EQ(nearest_name("a", {}), "");
    EXPECT_EQ(nearest_name(std::string(100, 'a'), {std::string(100, 'a')}), "");
}

TEST(Suggestion, FollowsAMessageOrIsEmpty) {
    EXPECT_EQ(suggestion("lft", {"left", "right"}), "; did you mean 'left'?");
    EXPECT_EQ(suggestion("upper", {"left", "right"}), "");
}

TEST(Listed, OfManyNamesHasTheNearestFirst) {
    EXPECT_EQ(listed_near("x", {"b", "a", "b"}), "b, a");
    std::vector<std::string> names;
    for (int i = 1; i <= 30; ++i) names.push_back("trace " + std::to_string(i));
    EXPECT_EQ(listed_near("trac 25", names),
              "trace 25, trace 2, trace 5, trace 15, trace 20, trace 21, trace 22, trace 23 and 22 others");
    names.resize(9);
    EXPECT_THAT(listed_near("joint", names), ::testing::EndsWith("and 1 other"));
}

TEST(Listed, JoinsNamesWithCommas) {
    EXPECT_EQ(listed({"a", "b"}), "a, b");
    EXPECT_EQ(listed({}), "none");
}

} // namespace
} // namespace kluft
