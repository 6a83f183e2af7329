#include "kluft/output/append_table.hpp"

#include <csignal>
#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>

#include "kluft/core/diagnostics.hpp"
#include "kluft/output/atomic_file.hpp"
#include "output/temporary_directory.hpp"

namespace kluft {
namespace {

using ::testing::HasSubstr;
using testing::TemporaryDirectory;
using ::testing::ThrowsMessage;

TEST(AppendTable, ShowsEachRowAsSoonAsItIsAdded) {
    const TemporaryDirectory directory;
    auto table = AppendTable::create(directory / "t.csv", "step,x");
    EXPECT_EQ(read_file(directory / "t.csv"), "step,x\n");
    table.append("0,1.5");
    EXPECT_EQ(read_file(directory / "t.csv"), "step,x\n0,1.5\n");
    table.append("1,2.5");
    table.sync();
    EXPECT_EQ(read_file(directory / "t.csv"), "step,x\n0,1.5\n1,2.5\n");
}

TEST(AppendTable, LosesTheRowsAfterTheSavedStepWhenARunIsResumed) {
    const TemporaryDirectory directory;
    write_file(directory / "t.csv", "step,x\n0,a\n1,b\n2,c\n2,d\n3,e\n10,f\n11,unfinish");
    auto table = AppendTable::resume(directory / "t.csv", "step,x", 2);
    table.append("3,again");
    EXPECT_EQ(read_file(directory / "t.csv"), "step,x\n0,a\n1,b\n2,c\n2,d\n3,again\n");
}

TEST(AppendTable, LosesAnUnfinishedLastLineWhenARunIsResumed) {
    const TemporaryDirectory directory;
    write_file(directory / "t.csv", "step,x\n0,a\n1,bb");
    cut_table(directory / "t.csv", "step,x", 5);
    EXPECT_EQ(read_file(directory / "t.csv"), "step,x\n0,a\n");
}

TEST(AppendTable, IsNotResumedWithOtherColumnsOrWithoutAFile) {
    const TemporaryDirectory directory;
    write_file(directory / "t.csv", "step,y\n0,a\n");
    EXPECT_THAT([&] { (void)AppendTable::resume(directory / "t.csv", "step,x", 2); },
                ThrowsMessage<InputError>(HasSubstr("found 'step,y'")));
    EXPECT_THROW((void)AppendTable::resume(directory / "absent.csv", "step,x", 2), InputError);
    write_file(directory / "bad.csv", "step,x\nzero,a\n");
    EXPECT_THROW((void)AppendTable::resume(directory / "bad.csv", "step,x", 2), InputError);
}

TEST(AppendTable, TakesBackARowThatDoesNotFitOnTheDisk) {
    const TemporaryDirectory directory;
    auto table = AppendTable::create(directory / "t.csv", "step,x");
    table.append("0,a");
    rlimit before{};
    getrlimit(RLIMIT_FSIZE, &before);
    const rlimit limit{16, before.rlim_max}; // 11 bytes are there; the next row is written in part
    const auto signal = std::signal(SIGXFSZ, SIG_IGN);
    setrlimit(RLIMIT_FSIZE, &limit);
    EXPECT_THAT([&] { table.append("1,bbbbbbbbbbbbbbbbbbbb"); }, ThrowsMessage<ResourceError>(HasSubstr("t.csv")));
    setrlimit(RLIMIT_FSIZE, &before);
    std::signal(SIGXFSZ, signal);
    EXPECT_EQ(read_file(directory / "t.csv"), "step,x\n0,a\n");
    table.append("1,c");
    EXPECT_EQ(read_file(directory / "t.csv"), "step,x\n0,a\n1,c\n");
}

} // namespace
} // namespace kluft
