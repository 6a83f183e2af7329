#include "calibrator.hpp"

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <system_error>
#include <utility>

#include <fmt/format.h>
#include <unistd.h>

#include "kluft/core/diagnostics.hpp"
#include "this_program.hpp"

namespace kluft {

void become_calibrator(std::vector<std::string> words) {
    const std::filesystem::path program = this_program("calibrate");
    const std::filesystem::path calibrator = program.parent_path() / "kluft-calibrate";
    std::error_code ignored;
    if (!std::filesystem::is_regular_file(calibrator, ignored))
        throw InputError(fmt::format("kluft calibrate: expected the program kluft-calibrate beside {}, found none; "
                                     "scripts/build release kluft_calibrate makes it where Ipopt is found (Debian: "
                                     "coinor-libipopt-dev)",
                                     program.string()));
    words.insert(words.begin(), calibrator);
    std::vector<char*> pointers;
    for (auto& word : words) pointers.push_back(word.data());
    pointers.push_back(nullptr);
    std::fflush(nullptr);
    execv(pointers.front(), pointers.data());
    throw InputError(fmt::format("{}: cannot be started: {}", words.front(), std::strerror(errno)));
}

} // namespace kluft
