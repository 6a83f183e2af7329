#include "kluft/output/history_table.hpp"

#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "kluft/core/diagnostics.hpp"
#include "kluft/output/atomic_file.hpp"
#include "output/temporary_directory.hpp"

namespace kluft {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using testing::TemporaryDirectory;
using ::testing::ThrowsMessage;

StepRecord awkward_record() {
    StepRecord record;
    record.step = 17;
    record.stage = 1;
    record.load_factor = 0.1;
    record.axial_strain = 1.0 / 3.0;
    record.axial_stress = 1.4078123456789e6;
    record.lateral_strain = -std::numeric_limits<double>::denorm_min();
    record.lateral_stress = std::numeric_limits<double>::max();
    record.differential_stress = -0.0;
    record.volumetric_strain = std::nextafter(1.0, 2.0);
    record.cracks_tension = 3;
    record.cracks_shear = 4;
    record.open = 5;
    record.sliding = 6;
    record.locked = 7;
    record.open_close_iterations = 8;
    record.crack_passes = 9;
    record.unbalanced_ratio = 1e-300;
    record.balance_error = 0.1;
    record.jumps = 10;
    record.net_broken = 2.0 / 3.0;
    record.balanced = false;
    record.elapsed_s = 12.25;
    return record;
}

// The contract with readers of the results.
TEST(HistoryTable, HasTheColumnsOfTheContract) {
    EXPECT_EQ(history_header(),
              "step,stage,load_factor,axial_strain,axial_stress,lateral_strain,lateral_stress,differential_stress,"
              "volumetric_strain,cracks_tension,cracks_shear,open,sliding,locked,open_close_iterations,crack_passes,"
              "unbalanced_ratio,balance_error,jumps,net_broken,balanced,elapsed_s");
    EXPECT_EQ(cracks_header(), "step,pass,interface,x,y,mode,p1,p3,axial_strain");
    EXPECT_EQ(jumps_header(), "step,load_factor,released_energy,largest_slip,blocks");
}

TEST(HistoryTable, WritesBooleansAsZeroAndOne) {
    StepRecord record;
    EXPECT_EQ(table_row(record), "0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,1,0");
    record.balanced = false;
    record.load_factor = 0.1;
    EXPECT_EQ(table_row(record), "0,0,0.10000000000000001,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0");
}

TEST(HistoryTable, ReadsBackEveryBit) {
    const TemporaryDirectory directory;
    const StepRecord record = awkward_record();
    write_file(directory / "h.csv",
               history_header() + '\n' + table_row(StepRecord{}) + '\n' + table_row(record) + '\n');
    const auto rows = read_history(directory / "h.csv");
    ASSERT_EQ(rows.size(), 2U);
    EXPECT_EQ(table_row(rows[1]), table_row(record));
    EXPECT_EQ(rows[1].axial_strain, record.axial_strain);
    EXPECT_EQ(rows[1].lateral_strain, record.lateral_strain);
    EXPECT_EQ(rows[1].volumetric_strain, record.volumetric_strain);
    EXPECT_TRUE(std::signbit(rows[1].differential_stress));
    EXPECT_FALSE(rows[1].balanced);
}

TEST(HistoryTable, ReadsBackTheStrengthFactorOfRunsThatHaveIt) {
    const TemporaryDirectory directory;
    StepRecord record = awkward_record();
    record.strength_factor = 4.0 / 3.0;
    record.motion.emplace();
    write_file(directory / "h.csv",
               history_header() + ",strength_factor," + motion_header() + '\n' + table_row(record) + '\n');
    EXPECT_EQ(read_history(directory / "h.csv").at(0).strength_factor, 4.0 / 3.0);
    EXPECT_EQ(read_history(directory / "h.csv", {"step"}).at(0).strength_factor, 4.0 / 3.0);
    record.strength_factor.reset();
    record.motion.reset();
    write_file(directory / "h.csv", history_header() + '\n' + table_row(record) + '\n');
    EXPECT_EQ(read_history(directory / "h.csv").at(0).strength_factor, std::nullopt);
}

TEST(HistoryTable, ReadsBackCracks) {
    const TemporaryDirectory directory;
    const CrackRecord crack{3, 2, 41, 0.1, 0.7, CrackMode::shear, 1.5e6, -2e4, 0.011};
    write_file(directory / "c.csv", cracks_header() + '\n' + table_row(crack) + '\n');
    EXPECT_THAT(table_row(crack), ::testing::StartsWith("3,2,41,0.1"));
    const auto cracks = read_cracks(directory / "c.csv");
    ASSERT_EQ(cracks.size(), 1U);
    EXPECT_EQ(table_row(cracks[0]), table_row(crack));
    EXPECT_EQ(cracks[0].mode, CrackMode::shear);
}

TEST(HistoryTable, IgnoresFurtherColumnsTheirOrderAMarkOfTheEncodingAndAnUnfinishedLine) {
    const TemporaryDirectory directory;
    write_file(directory / "c.csv", "\xEF\xBB\xBFnote,mode,step,pass,interface,x,y,p1,p3,axial_strain\r\n"
                                    "hello,tension,1,2,3,4,5,6,7,8\r\n"
                                    "hello,tension,1,2,3,4");
    const auto cracks = read_cracks(directory / "c.csv");
    ASSERT_EQ(cracks.size(), 1U);
    EXPECT_EQ(cracks[0].axial_strain, 8.0);
    EXPECT_EQ(cracks[0].mode, CrackMode::tension);
}

TEST(HistoryTable, SaysWhereWhatWasExpectedAndFound) {
    const TemporaryDirectory directory;
    const auto path = directory / "c.csv";
    const auto read = [&] { (void)read_cracks(path); };
    write_file(path, cracks_header() + "\n1,2,3,4,5,shear,6,7,8\n1,2,3,4,5,bending,6,7,8\n");
    EXPECT_THAT(read,
                ThrowsMessage<InputError>(HasSubstr("c.csv:3: mode: expected tension or shear, found 'bending'")));
    write_file(path, cracks_header() + "\n1,2,3,4x,5,shear,6,7,8\n");
    EXPECT_THAT(read, ThrowsMessage<InputError>(HasSubstr("c.csv:2: x: expected a finite number, found '4x'")));
    write_file(path, cracks_header() + "\n1,2,3,nan,5,shear,6,7,8\n"); // the program writes none
    EXPECT_THAT(read, ThrowsMessage<InputError>(HasSubstr("c.csv:2: x: expected a finite number, found 'nan'")));
    write_file(path, cracks_header() + "\n1,2,3,-inf,5,shear,6,7,8\n");
    EXPECT_THAT(read, ThrowsMessage<InputError>(HasSubstr("c.csv:2: x: expected a finite number, found '-inf'")));
    write_file(path, cracks_header() + "\n1,2,3\n");
    EXPECT_THAT(read, ThrowsMessage<InputError>(HasSubstr("c.csv:2: expected 9 columns, found 3")));
    write_file(path, "step,pass\n1,2\n");
    EXPECT_THAT(read, ThrowsMessage<InputError>(
                          HasSubstr("c.csv:1: no columns 'interface', 'x', 'y', 'mode', 'p1', 'p3', 'axial_strain'")));
    write_file(path, "");
    EXPECT_THAT(read, ThrowsMessage<InputError>(HasSubstr("expected a line of column names")));
}

} // namespace
} // namespace kluft
