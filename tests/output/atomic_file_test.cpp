#include "kluft/output/atomic_file.hpp"

#include <atomic>
#include <csignal>
#include <fstream>
#include <string>
#include <thread>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>

#include "kluft/core/diagnostics.hpp"
#include "output/temporary_directory.hpp"

namespace kluft {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::HasSubstr;
using testing::TemporaryDirectory;
using ::testing::ThrowsMessage;

/// While it lives, files cannot grow beyond `bytes`: a write fails with EFBIG as it would with ENOSPC.
class FileSizeLimit {
public:
    explicit FileSizeLimit(rlim_t bytes) {
        getrlimit(RLIMIT_FSIZE, &before_);
        signal_ = std::signal(SIGXFSZ, SIG_IGN);
        const rlimit limit{bytes, before_.rlim_max};
        setrlimit(RLIMIT_FSIZE, &limit);
    }
    FileSizeLimit(const FileSizeLimit&) = delete;
    FileSizeLimit& operator=(const FileSizeLimit&) = delete;
    ~FileSizeLimit() {
        setrlimit(RLIMIT_FSIZE, &before_);
        std::signal(SIGXFSZ, signal_);
    }

private:
    rlimit before_{};
    void (*signal_)(int) = SIG_DFL;
};

TEST(AtomicFile, HoldsWhatWasWrittenAndLeavesNothingElse) {
    const TemporaryDirectory directory;
    const std::string content("a\0b\n", 4);
    write_file(directory / "f", "old");
    write_file(directory / "f", content);
    EXPECT_EQ(read_file(directory / "f"), content);
    EXPECT_EQ(std::distance(fs::directory_iterator(directory.path()), fs::directory_iterator()), 1);
}

TEST(AtomicFile, IsThatOfOneOfItsWritersWhereSeveralWriteIt) {
    const TemporaryDirectory directory;
    write_file(directory / "f.part", "of a process that was killed");
    const auto content_of = [](int writer) { return std::string(100000, static_cast<char>('a' + writer)); };
    std::atomic<int> n_failures{0};
    std::vector<std::jthread> writers;
    for (int writer = 0; writer < 4; ++writer) {
        writers.emplace_back([&, writer] {
            for (int i = 0; i < 25; ++i) {
                try {
                    write_file(directory / "f", content_of(writer));
                } catch (const ResourceError&) {
                    ++n_failures;
                }
            }
        });
    }
    writers.clear();
    EXPECT_EQ(n_failures, 0);
    const std::string content = read_file(directory / "f");
    EXPECT_EQ(content, content_of(content.front() - 'a'));
    EXPECT_FALSE(fs::exists(directory / "f.part"));
}

TEST(AtomicFile, KeepsTheOldFileWhenTheDiskIsFull) {
    const TemporaryDirectory directory;
    write_file(directory / "f", "old");
    {
        const FileSizeLimit limit(1000);
        EXPECT_THROW(write_file(directory / "f", std::string(5000, 'x')), ResourceError);
    }
    EXPECT_EQ(read_file(directory / "f"), "old");
    EXPECT_FALSE(fs::exists(directory / "f.part"));
}

TEST(AtomicFile, NamesFileAndReasonWhenADeviceIsFull) {
    EXPECT_THAT([] { write_file("/dev/full", "x"); },
                ThrowsMessage<ResourceError>(AllOf(HasSubstr("/dev/full"), HasSubstr("No space left"))));
    EXPECT_FALSE(fs::is_regular_file("/dev/full"));
}

TEST(AtomicFile, NamesFileAndReasonWhenTheParentIsAFile) {
    const TemporaryDirectory directory;
    write_file(directory / "f", "");
    EXPECT_THAT([&] { write_file(directory / "f/g", "x"); },
                ThrowsMessage<ResourceError>(AllOf(HasSubstr("f/g"), HasSubstr("Not a directory"))));
    EXPECT_THROW(make_directory(directory / "f/g"), ResourceError);
    EXPECT_THROW(make_directory(directory / "f"), ResourceError);
}

TEST(AtomicFile, DoesNotReplaceADirectory) {
    const TemporaryDirectory directory;
    make_directory(directory / "d/e");
    EXPECT_THROW(write_file(directory / "d", "x"), ResourceError);
    EXPECT_TRUE(fs::is_directory(directory / "d/e"));
}

TEST(AtomicFile, FollowsASymbolicLink) {
    const TemporaryDirectory directory;
    write_file(directory / "target", "old");
    fs::create_symlink("target", directory / "link");
    write_file(directory / "link", "new");
    EXPECT_EQ(read_file(directory / "target"), "new");
    EXPECT_TRUE(fs::is_symlink(directory / "link"));
}

TEST(AtomicFile, IsRemovedTogetherWithAnUnfinishedOne) {
    const TemporaryDirectory directory;
    write_file(directory / "f", "whole");
    write_file(directory / "f.part", "half");
    remove_file(directory / "f");
    EXPECT_TRUE(fs::is_empty(directory.path()));
    EXPECT_NO_THROW(remove_file(directory / "f"));
}

TEST(AtomicFile, CannotBeReadWhenMissing) {
    const TemporaryDirectory directory;
    EXPECT_THAT([&] { (void)read_file(directory / "absent"); },
                ThrowsMessage<InputError>(AllOf(HasSubstr("absent"), HasSubstr("no such file"))));
    EXPECT_THROW((void)read_file(directory.path()), InputError);
}

} // namespace
} // namespace kluft
