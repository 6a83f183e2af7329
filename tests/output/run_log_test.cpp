#include "kluft/output/run_log.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

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
