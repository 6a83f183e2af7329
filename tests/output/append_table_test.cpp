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

using ::testing::AllOf;
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

/// "step,x\n0,a\n1,b\n", its mark, and a row and a part of one behind it.
TableMark table_with_more(const std::filesystem::path& path) {
    auto table = AppendTable::create(path, "step,x");
    table.append("0,a");
    table.append("1,b");
    const TableMark mark = table.mark();
    table.append("2,c");
    std::ofstream(path, std::ios::app) << "3,unfinish";
    return mark;
}

TEST(AppendTable, LosesTheRowsAfterTheSavedOnesWhenARunIsResumed) {
    const TemporaryDirectory directory;
    const TableMark mark = table_with_more(directory / "t.csv");
    EXPECT_EQ(mark.bytes, std::string("step,x\n0,a\n1,b\n").size());
    auto table = AppendTable::resume(directory / "t.csv", "step,x", mark);
    EXPECT_EQ(table.mark(), mark);
    table.append("2,again");
    EXPECT_EQ(read_file(directory / "t.csv"), "step,x\n0,a\n1,b\n2,again\n");
    EXPECT_NO_THROW((void)AppendTable::resume(directory / "t.csv", "step,x", table.mark()));
}

TEST(AppendTable, IsNotResumedWhereSavedRowsAreMissingOrOtherOnes) {
    const TemporaryDirectory directory;
    const auto path = directory / "t.csv";
    const TableMark mark = table_with_more(path);
    const auto is_refused = [&](const std::string& why) {
        EXPECT_THAT([&] { (void)AppendTable::resume(path, "step,x", mark); },
                    ThrowsMessage<InputError>(AllOf(HasSubstr("t.csv: expected the 15 bytes"), HasSubstr(why))));
    };
    for (const char* cut : {"step,x\n", "step,x\n0,a\n", "step,x\n0,a\n1,b"}) {
        write_file(path, cut);
        is_refused("rows are missing");
        EXPECT_EQ(read_file(path), cut); // nothing is touched
    }
    for (const char* other : {"step,x\n0,a\n1,c\n", "step,x\n0,a\n2,c\n3,d\n", "step,x\n0,a\n0,a\n1,b\n"}) {
        write_file(path, other);
        is_refused("other ones");
        EXPECT_EQ(read_file(path), other);
    }
}

TEST(AppendTable, IsNotResumedWithOtherColumnsOrWithoutAFile) {
    const TemporaryDirectory directory;
    const TableMark mark = table_with_more(directory / "t.csv");
    write_file(directory / "t.csv", "step,y\n0,a\n");
    EXPECT_THAT([&] { (void)AppendTable::resume(directory / "t.csv", "step,x", mark); },
                ThrowsMessage<InputError>(HasSubstr("found 'step,y'")));
    EXPECT_THROW((void)AppendTable::resume(directory / "absent.csv", "step,x", mark), InputError);
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
