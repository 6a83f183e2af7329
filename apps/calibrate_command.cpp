// kluft calibrate TARGET.yaml
#include <algorithm>
#include <filesystem>
#include <string>
#include <thread>

#include "calibrator.hpp"
#include "commands.hpp"
#include "failure.hpp"
#include "this_program.hpp"

namespace kluft {

namespace {

int number_of_processors() { return static_cast<int>(std::max(std::thread::hardware_concurrency(), 1U)); }

} // namespace

ExitCode calibrate(const CalibrateArguments& arguments) {
    require_possible_output(arguments.directory);
    namespace fs = std::filesystem;
    const fs::path directory = arguments.directory.empty() ? fs::path("results") / fs::path(arguments.target).stem()
                                                           : fs::path(arguments.directory);
    require_no_file(directory);
    const int jobs = arguments.jobs > 0 ? arguments.jobs : number_of_processors();
    become_calibrator({this_program("calibrate"), arguments.target, directory, std::to_string(jobs),
                       arguments.quiet ? "quiet" : "tell"});
}

} // namespace kluft
