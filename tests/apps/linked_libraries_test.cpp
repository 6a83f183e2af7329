// Ipopt's licence and the stand-ins for MPI under it have no place in the program and the library.
#include <array>
#include <cstdio>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace kluft {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

std::string output_of(const std::string& command) {
    std::FILE* const pipe = popen(command.c_str(), "r");
    std::string text;
    std::array<char, 4096> part{};
    while (pipe != nullptr && std::fgets(part.data(), part.size(), pipe) != nullptr) text += part.data();
    EXPECT_EQ(pipe == nullptr ? -1 : pclose(pipe), 0) << command;
    return text;
}

TEST(LinkedLibraries, ProgramLoadsNothingOfIpoptNotEvenThroughOthers) {
    const std::string loaded = output_of("ldd \"" KLUFT_PROGRAM "\"");
    EXPECT_THAT(loaded, HasSubstr("libcholmod")); // the question is answered at all
    EXPECT_THAT(loaded, AllOf(Not(HasSubstr("ipopt")), Not(HasSubstr("mumps"))));
}

TEST(LinkedLibraries, LibraryHasNothingOfCalibrationAndIpopt) {
    const std::string symbols = output_of("nm --demangle \"" KLUFT_LIBRARY "\" 2>&1 | grep -E "
                                          "'Ipopt|read_calibration|minimise_squares|kluft::read_study\\(' | sort -u");
    EXPECT_THAT(symbols, HasSubstr("kluft::read_study("));
    EXPECT_THAT(symbols,
                AllOf(Not(HasSubstr("Ipopt")), Not(HasSubstr("read_calibration")), Not(HasSubstr("minimise_squares"))));
}

} // namespace
} // namespace kluft
