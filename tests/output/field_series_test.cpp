#include "kluft/output/field_series.hpp"

#include <algorithm>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "kluft/output/atomic_file.hpp"
#include "output/hexagon_grid.hpp"
#include "output/temporary_directory.hpp"

namespace kluft {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using testing::TemporaryDirectory;

StepRecord row_of(int step, double load_factor, double axial_strain = 0.0, int stage = 0) {
    StepRecord record;
    record.step = step;
    record.stage = stage;
    record.load_factor = load_factor;
    record.axial_strain = axial_strain;
    return record;
}

std::vector<std::string> names_in(const fs::path& directory) {
    std::vector<std::string> names;
    for (const auto& entry : fs::directory_iterator(directory)) names.push_back(entry.path().filename());
    std::sort(names.begin(), names.end());
    return names;
}

TEST(FieldSeries, ListsTheFieldFilesOfEachStep) {
    const TemporaryDirectory directory;
    const BlockSystem system = testing::hexagon_grid(2, 1, 0.1);
    const auto fields = testing::affine_fields(system, Mat2::Zero(), Mat2::Zero());
    auto series = FieldSeries::create(directory.path(), {});
    StepRecord record;
    series.add(system, fields, record);
    record.step = 20;
    record.load_factor = 0.5;
    series.add(system, fields, record);
    EXPECT_THAT(names_in(directory / "fields"), ElementsAre("blocks_000000.vtu", "blocks_000020.vtu",
                                                            "interfaces_000000.vtu", "interfaces_000020.vtu"));
    EXPECT_THAT(names_in(directory / "contacts"), ElementsAre("000000.csv", "000020.csv"));
    EXPECT_THAT(names_in(directory / "supports"), ElementsAre("000000.csv", "000020.csv"));
    const std::string pvd = read_file(directory / "fields.pvd");
    EXPECT_THAT(pvd, HasSubstr(R"(timestep="0.5" group="" part="1" file="fields/interfaces_000020.vtu")"));
    EXPECT_THAT(read_file(directory / "fields/blocks_000020.vtu"), HasSubstr("Name=\"step\" NumberOfTuples=\"1\" "
                                                                             "format=\"ascii\">20<"));
}

TEST(FieldSeries, GoesOnFromASavedStepWithoutTheLaterFiles) {
    const TemporaryDirectory directory;
    const BlockSystem system = testing::hexagon_grid(2, 1, 0.1);
    const auto fields = testing::affine_fields(system, Mat2::Zero(), Mat2::Zero());
    auto first = FieldSeries::create(directory.path(), {});
    for (const int step : {0, 5, 10, 15}) first.add(system, fields, row_of(step, 0.01 * step));
    write_file(directory / "contacts/000012.csv.part", "killed");
    const auto series =
        FieldSeries::resume(directory.path(), {}, {row_of(0, 0.0), row_of(5, 0.05), row_of(7, 0.07), row_of(10, 0.1)});
    EXPECT_THAT(series.steps(), ElementsAre(0, 5, 10));
    EXPECT_EQ(names_in(directory / "fields").size(), 6U);
    EXPECT_THAT(names_in(directory / "contacts"), ElementsAre("000000.csv", "000005.csv", "000010.csv"));
    EXPECT_EQ(names_in(directory / "supports").size(), 3U);
    EXPECT_THAT(read_file(directory / "fields.pvd"), HasSubstr("timestep=\"0.05\""));
    EXPECT_THAT(read_file(directory / "fields.pvd"), ::testing::Not(HasSubstr("000015")));
}

TEST(FieldSeries, KeepsALinkToWhereThereIsMoreRoom) {
    const TemporaryDirectory directory;
    std::filesystem::create_directory(directory / "elsewhere");
    std::filesystem::create_symlink("elsewhere", directory / "fields");
    (void)FieldSeries::create(directory.path(), {});
    EXPECT_TRUE(std::filesystem::is_symlink(directory / "fields"));
}

TEST(FieldSeries, ReplacesAnEarlierRunButNotOtherPeoplesFiles) {
    const TemporaryDirectory directory;
    make_directory(directory / "fields");
    write_file(directory / "fields/blocks_000007.vtu", "old");
    write_file(directory / "fields/blocks_mine.vtu", "mine");
    make_directory(directory / "supports");
    write_file(directory / "supports/000007.csv", "old");
    write_file(directory / "supports/000007.csv.bak", "mine");
    const auto series = FieldSeries::create(directory.path(), {});
    EXPECT_TRUE(series.steps().empty());
    EXPECT_THAT(names_in(directory / "fields"), ElementsAre("blocks_mine.vtu"));
    EXPECT_THAT(names_in(directory / "supports"), ElementsAre("000007.csv.bak"));
}

/// fields.pvd of the rows, of a run with or without an axial strain.
std::string series_of(const std::vector<StepRecord>& rows, bool has_axial_strain) {
    const TemporaryDirectory directory;
    const BlockSystem system = testing::hexagon_grid(2, 1, 0.1);
    const auto fields = testing::affine_fields(system, Mat2::Zero(), Mat2::Zero());
    auto series =
        FieldSeries::create(directory.path(), {.fields = {}, .laws = {}, .has_axial_strain = has_axial_strain});
    for (const StepRecord& row : rows) series.add(system, fields, row);
    return read_file(directory / "fields.pvd");
}

TEST(FieldSeries, HasTheAxialStrainAsTimeWhereAPlatenMoves) {
    const std::vector<StepRecord> rows{row_of(0, 0.0), row_of(3, 1.0, 1e-5), row_of(9, 0.5, 0.002, 1)};
    EXPECT_THAT(series_of(rows, true), HasSubstr("<!-- timestep: axial strain -->"));
    EXPECT_THAT(series_of(rows, true), HasSubstr("timestep=\"0.002\" group=\"\" part=\"1\""));
    EXPECT_THAT(series_of(rows, false), HasSubstr("timestep=\"1.5\""));
}

// The strain falls in unloading, and at the end of a run that fails two states may have one load factor.
TEST(FieldSeries, HasATimeThatIncreasesFromStateToState) {
    EXPECT_THAT(series_of({row_of(0, 0.0), row_of(3, 1.0, 0.002), row_of(9, 1.0, 0.001, 1)}, true),
                HasSubstr("timestep=\"2\""));
    EXPECT_THAT(series_of({row_of(0, 0.0), row_of(3, 1.0, 0.002), row_of(4, 1.0, 0.001)}, true),
                HasSubstr("timestep=\"4\""));
}

} // namespace
} // namespace kluft
