// kluft calibrate TARGET.yaml
#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <string>
#include <system_error>
#include <thread>
#include <vector>

#include <fmt/format.h>
#include <unistd.h>

#include "commands.hpp"
#include "failure.hpp"
#include "kluft/core/diagnostics.hpp"
#include "this_program.hpp"

namespace kluft {

namespace {

int number_of_processors() { return static_cast<int>(std::max(std::thread::hardware_concurrency(), 1U)); }

} // namespace

ExitCode calibrate(const CalibrateArguments& arguments) {
    require_possible_output(arguments.directory);
    namespace fs = std::filesystem;
    const fs::path program = this_program("calibrate");
    const fs::path calibrator = program.parent_path() / "kluft-calibrate";
    std::error_code ignored;
    if (!fs::is_regular_file(calibrator, ignored))
        throw InputError(fmt::format("kluft calibrate: expected the program kluft-calibrate beside {}, found none; it "
                                     "is built where Ipopt is found (Debian: coinor-libipopt-dev)",
                                     program.string()));
    const fs::path directory = arguments.directory.empty() ? fs::path("results") / fs::path(arguments.target).stem()
                                                           : fs::path(arguments.directory);
    const int jobs = arguments.jobs > 0 ? arguments.jobs : number_of_processors();
    std::vector<std::string> words{
        calibrator, program, arguments.target, directory, std::to_string(jobs), arguments.quiet ? "quiet" : "tell"};
    std::vector<char*> pointers;
    for (auto& word : words) pointers.push_back(word.data());
    pointers.push_back(nullptr);
    std::fflush(nullptr);
    execv(pointers.front(), pointers.data());
    throw InputError(fmt::format("{}: cannot be started: {}", words.front(), std::strerror(errno)));
}

} // namespace kluft
