#include "kluft/output/directory_lock.hpp"

#include <optional>
#include <string>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "kluft/core/diagnostics.hpp"
#include "kluft/output/atomic_file.hpp"
#include "output/temporary_directory.hpp"

namespace kluft {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::HasSubstr;
using testing::TemporaryDirectory;
using ::testing::ThrowsMessage;

TEST(DirectoryLock, KeepsOthersOutForItsLifeAndNamesTheProcess) {
    const TemporaryDirectory directory;
    const fs::path place = directory / "results";
    EXPECT_FALSE(is_locked(place));
    {
        const DirectoryLock lock(place, "kluft run scene.yaml");
        EXPECT_TRUE(is_locked(place));
        EXPECT_THAT([&] { const DirectoryLock second(place, "kluft run s.yaml", "try elsewhere"); },
                    ThrowsMessage<InputError>(HasSubstr("(kluft run scene.yaml) in it; try elsewhere")));
        EXPECT_THAT([&] { const DirectoryLock second(place, "kluft study s.yaml"); },
                    ThrowsMessage<InputError>(AllOf(HasSubstr("results: expected a directory that no other process "),
                                                    HasSubstr("found process " + std::to_string(getpid())),
                                                    HasSubstr("(kluft run scene.yaml)"))));
    }
    EXPECT_FALSE(is_locked(place));
    EXPECT_NO_THROW(DirectoryLock(place, "kluft run scene.yaml"));
}

TEST(DirectoryLock, WaitsAMomentForAProcessThatEnds) {
    const TemporaryDirectory directory;
    std::optional<DirectoryLock> first(std::in_place, directory.path(), "kluft run first.yaml");
    std::jthread ending([&] {
        std::this_thread::sleep_for(std::chrono::milliseconds(20));
        first.reset();
    });
    EXPECT_NO_THROW(DirectoryLock(directory.path(), "kluft run second.yaml"));
}

TEST(DirectoryLock, LeavesTheFileAloneThatALinkOfItsNameLeadsTo) {
    const TemporaryDirectory directory;
    write_file(directory / "foreign", "mine");
    fs::create_symlink("foreign", directory / ".lock");
    EXPECT_THROW(DirectoryLock(directory.path(), "kluft run scene.yaml"), ResourceError);
    EXPECT_EQ(read_file(directory / "foreign"), "mine");
}

} // namespace
} // namespace kluft
