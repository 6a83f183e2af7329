#include "kluft/core/input_file.hpp"

#include <filesystem>
#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include "kluft/core/diagnostics.hpp"
#include "output/temporary_directory.hpp"

namespace kluft {
namespace {

using ::testing::HasSubstr;
using testing::TemporaryDirectory;

std::string refusal_of(const std::filesystem::path& file, std::size_t largest = 1'000'000) {
    try {
        (void)read_input_file(file, "a table", largest, "; cut it");
    } catch (const InputError& error) {
        return error.what();
    }
    return "accepted";
}

TEST(InputFile, HasAllBytesOfAFileUpToItsLimit) {
    const TemporaryDirectory directory;
    for (const std::size_t size : {0U, 1U, 65535U, 65536U, 65537U, 300000U}) {
        std::string bytes(size, 'a');
        for (std::size_t i = 0; i < size; i += 7) bytes[i] = static_cast<char>(i);
        std::ofstream(directory / "f", std::ios::binary) << bytes;
        EXPECT_EQ(read_input_file(directory / "f", "a table", size), bytes);
        if (size == 0) continue;
        EXPECT_THAT(refusal_of(directory / "f", size - 1), HasSubstr("found more; cut it"));
    }
}

TEST(InputFile, IsNoDirectoryNoPipeAndNoDevice) {
    const TemporaryDirectory directory;
    const std::filesystem::path pipe = directory / "pipe";
    ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
    EXPECT_EQ(refusal_of(directory.path()), directory.path().string() + ": expected a table, found a directory");
    EXPECT_EQ(refusal_of(pipe), pipe.string() + ": expected a table, found no regular file"); // without a writer
    EXPECT_THAT(refusal_of("/dev/zero"), HasSubstr("found no regular file"));
    EXPECT_THAT(refusal_of(directory / "absent"), HasSubstr("found no such file"));
    EXPECT_THAT(refusal_of(directory / std::string(300, 'a')), HasSubstr("File name too long"));
}

TEST(InputFile, IsNotReadWhenItIsTooLarge) {
    const TemporaryDirectory directory;
    std::ofstream(directory / "sparse") << "a";
    std::filesystem::resize_file(directory / "sparse", 10'000'000'000); // of holes, which take no room
    EXPECT_THAT(refusal_of(directory / "sparse", 8'000'000), HasSubstr("expected a table of at most 8 MB, found more"));
}

} // namespace
} // namespace kluft
