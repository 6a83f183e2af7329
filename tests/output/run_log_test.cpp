#include "kluft/output/run_log.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include "kluft/core/diagnostics.hpp"
#include "kluft/output/atomic_file.hpp"
#include "output/temporary_directory.hpp"

namespace kluft {
namespace {

using ::testing::ContainsRegex;
using ::testing::HasSubstr;
using testing::TemporaryDirectory;

TEST(RunLog, HoldsEachLineAtOnceWithItsTimeAndLevel) {
    const TemporaryDirectory directory;
    RunLog log(directory / "run/run.log");
    log.info("255 blocks {not a format}");
    EXPECT_THAT(read_file(directory / "run/run.log"),
                ContainsRegex("[0-9]{4}-[0-9]{2}-[0-9]{2} [0-9:.]{12} info +255 blocks \\{not a format\\}"));
    log.warning("sliver merged");
    log.error("no equilibrium");
    EXPECT_THAT(read_file(directory / "run/run.log"), HasSubstr("warning sliver merged"));
}

TEST(RunLog, GoesOnBehindTheOldLinesWhenARunIsResumed) {
    const TemporaryDirectory directory;
    RunLog(directory / "run.log").info("first");
    RunLog(directory / "run.log", true).info("second");
    EXPECT_THAT(read_file(directory / "run.log"), HasSubstr("first"));
    RunLog(directory / "run.log").info("third");
    EXPECT_THAT(read_file(directory / "run.log"), ::testing::Not(HasSubstr("first")));
}

TEST(RunLog, DoesNotWriteToTheFileThatALinkLeadsTo) {
    const TemporaryDirectory directory;
    write_file(directory / "foreign", "mine\n");
    for (const bool resume : {false, true}) {
        std::filesystem::create_symlink("foreign", directory / "run.log");
        RunLog(directory / "run.log", resume).info("a line");
        EXPECT_EQ(read_file(directory / "foreign"), "mine\n");
        EXPECT_THAT(read_file(directory / "run.log"), HasSubstr("a line"));
        std::filesystem::remove(directory / "run.log");
    }
}

// A pipe of that name, at whose other end nobody reads, would stop the run for ever.
TEST(RunLog, TakesThePlaceOfAPipe) {
    const TemporaryDirectory directory;
    for (const bool resume : {false, true}) {
        ASSERT_EQ(mkfifo((directory / "run.log").c_str(), 0600), 0);
        RunLog(directory / "run.log", resume).info("a line");
        EXPECT_THAT(read_file(directory / "run.log"), HasSubstr("a line"));
        std::filesystem::remove(directory / "run.log");
    }
}

TEST(RunLog, SaysWhenItCannotBeOpened) {
    const TemporaryDirectory directory;
    write_file(directory / "f", "");
    EXPECT_THROW(RunLog(directory / "f/run.log"), ResourceError);
}

TEST(RunLog, DoesNotEndARunWhenTheDiskIsFull) {
    RunLog log("/dev/full", true);
    EXPECT_NO_THROW(log.info("lost"));
}

} // namespace
} // namespace kluft
