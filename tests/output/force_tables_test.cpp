#include "kluft/output/force_tables.hpp"

#include <string>
#include <string_view>
#include <vector>

#include <gtest/gtest.h>

namespace kluft {
namespace {

std::string contacts_csv(const BlockSystem& system, const std::vector<ContactForce>& contacts,
                         const std::vector<std::string>& law_names) {
    std::string text;
    put_contacts_csv(system, contacts, law_names, [&](std::string_view part) { text += part; });
    return text;
}

// A table larger than what is put at a time is the same, row by row.
TEST(ForceTables, OfManyContactsComeInParts) {
    const ContactForce contact{3, 4, {1.0, 2.0}, {1.0, 1.5}, 0.25, {0.0, -1.0}, -2e6, 5e5, MeetingState::sliding, 1};
    const std::vector<std::string> names{"rock", "joint"};
    const std::string head = contacts_csv({}, {}, names);
    const std::string row = contacts_csv({}, {contact}, names).substr(head.size());
    constexpr int n = 50'000;
    std::string expected = head;
    for (int i = 0; i < n; ++i) expected += row;
    std::string text;
    int n_parts = 0;
    put_contacts_csv({}, std::vector<ContactForce>(n, contact), names, [&](std::string_view part) {
        text += part;
        ++n_parts;
    });
    EXPECT_GT(n_parts, 1);
    EXPECT_TRUE(text == expected);
}

TEST(ForceTables, HaveCompressionPositiveAndPlacesInTheScene) {
    BlockSystem system;
    system.origin = {100.0, 50.0};
    const ContactForce contact{3, 4, {1.0, 2.0}, {1.0, 1.5}, 0.25, {0.0, -1.0}, -2e6, 5e5, MeetingState::sliding, 1};
    EXPECT_EQ(contacts_csv(system, {contact}, {"rock", "joint, filled"}),
              "block_a,block_b,x,y,length,normal_x,normal_y,normal_traction,shear_traction,state,law,x_b,y_b\n"
              "3,4,101,52,0.25,0,-1,2000000,500000,sliding,\"joint, filled\",101,51.5\n");
}

TEST(ForceTables, NameTheBoundaryWhereAForceHasOne) {
    BlockSystem system;
    system.boundaries = {{"left", {}}, {"top", {}}};
    EXPECT_EQ(supports_csv(system, {{0, 1, SupportKind::platen, {0.5, -8.0}, {1.0, 2.0}},
                                    {2, -1, SupportKind::weight, {0.0, -3.0}, {0.5, 0.5}}}),
              "block,boundary,fx,fy,x,y,kind\n0,top,0.5,-8,1,2,platen\n2,,0,-3,0.5,0.5,weight\n");
}

} // namespace
} // namespace kluft
