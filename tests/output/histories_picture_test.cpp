#include "kluft/output/histories_picture.hpp"

#include <fstream>
#include <numbers>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "kluft/core/diagnostics.hpp"
#include "temporary_directory.hpp"

namespace kluft {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

std::filesystem::path written(const testing::TemporaryDirectory& directory, const std::string& text) {
    const auto path = directory.path() / "histories.csv";
    std::ofstream(path) << text;
    return path;
}

std::vector<StepRecord> two_steps() {
    StepRecord first, second;
    second.step = 1;
    second.stage = 1;
    second.load_factor = 0.5;
    second.axial_strain = 0.002;
    return {first, second};
}

TEST(HistoriesPicture, HasAPlotForEachQuantityInItsUnit) {
    const testing::TemporaryDirectory directory;
    const auto table = read_histories(written(directory, "step,stage,load_factor,roof.displacement_x,roof.rotation,"
                                                         "joint.normal_force,joint.slip\n"
                                                         "0,0,0,0,0,0,0\n1,1,0.5,0.25,3.14159265358979,2000,0.001\n"));
    EXPECT_THAT(table.columns, ElementsAre("roof.displacement_x", "roof.rotation", "joint.normal_force", "joint.slip"));
    const auto plots = histories_plots("title", table, two_steps(), std::nullopt);
    ASSERT_EQ(plots.size(), 4U);
    const auto last = [&](std::size_t plot) { return plots[plot].curves.front().points.back().value; };
    EXPECT_EQ(last(0), Vec2(1.5, 250.0)); // stage 1, load factor 0.5; mm
    EXPECT_EQ(last(1), Vec2(1.5, 1.0));   // slip, mm
    EXPECT_NEAR(last(2).y(), 180.0, 1e-9);
    EXPECT_EQ(last(3).y(), 2.0); // kN/m
    EXPECT_EQ(plots.front().title, "title");
}

TEST(HistoriesPicture, IsOverTheStrainWhereAPlatenMoves) {
    const testing::TemporaryDirectory directory;
    const auto table =
        read_histories(written(directory, "step,stage,load_factor,roof.displacement_x\n0,0,0,0\n1,1,0.5,1\n"));
    const auto plots = histories_plots("", table, two_steps(), 1);
    EXPECT_EQ(plots.front().x_name, "axial strain (%)");
    EXPECT_EQ(plots.front().curves.front().points.back().value, Vec2(0.2, 1000.0));
}

TEST(HistoriesTable, SaysWhereItIsWrong) {
    const testing::TemporaryDirectory directory;
    const auto message_of = [&](const std::string& text) {
        try {
            (void)read_histories(written(directory, text));
        } catch (const InputError& error) {
            return std::string(error.what());
        }
        return std::string();
    };
    EXPECT_THAT(message_of("step,load_factor,a\n"), HasSubstr(":1: expected the columns step,stage,load_factor"));
    EXPECT_THAT(message_of("step,stage,load_factor,a\n0,0,0\n"), HasSubstr(":2: expected 4 columns, found 3"));
    EXPECT_THAT(message_of("step,stage,load_factor,a\n0,0,0,1\n1,0,0,x\n"),
                HasSubstr(":3: a: expected a finite number, found 'x'"));
    EXPECT_EQ(message_of("step,stage,load_factor,a\n0,0,0,1\n1,0,0"), ""); // a killed run leaves a part of a line
}

} // namespace
} // namespace kluft
