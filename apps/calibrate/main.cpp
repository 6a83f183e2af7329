// kluft-calibrate, which `kluft calibrate` starts: what needs Ipopt.
#include <chrono>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "blas_threads.hpp"
#include "commands.hpp"
#include "failure.hpp"
#include "kluft/assembly/blas.hpp"
#include "kluft/calibration/calibrate.hpp"
#include "kluft/calibration/calibration_report.hpp"
#include "kluft/core/diagnostics.hpp"
#include "kluft/output/directory_lock.hpp"
#include "kluft/scene/json_schema.hpp"
#include "kluft/scene/quantity.hpp"
#include "standard_output.hpp"
#include "stop_request.hpp"

namespace {

namespace fs = std::filesystem;
using kluft::ExitCode;

constexpr std::size_t n_words = 6; ///< of the command line

/// Says how the runs go on, from time to time.
class RunProgress {
public:
    void show(const kluft::StudyProgress& progress) {
        const auto now = Clock::now();
        constexpr std::chrono::seconds pause{10};
        if (now - last_ < pause) return;
        last_ = now;
        kluft::tell("  {}\n", kluft::study_progress_text(progress));
    }

private:
    using Clock = std::chrono::steady_clock;
    Clock::time_point last_ = Clock::now();
};

kluft::ExitCode run(const std::vector<std::string>& words) {
    if (words.size() == 2 && words[1] == "schema") {
        kluft::say_text(kluft::json_schema(kluft::calibration_schema(), "Kluft calibration", kluft::Extending::never));
        return ExitCode::done;
    }
    const auto jobs = words.size() == n_words ? kluft::read_integer(words[4]) : std::nullopt;
    if (!jobs || *jobs < 1)
        throw kluft::InputError(
            "kluft-calibrate is started by kluft calibrate TARGET.yaml; see kluft calibrate --help");
    const bool quiet = words[5] == "quiet";
    const fs::path directory = fs::absolute(words[3]).lexically_normal();
    const kluft::Calibration calibration = kluft::read_calibration(words[2]);
    const kluft::DirectoryLock lock(directory, "kluft calibrate " + words[2]);
    kluft::require_no_other_calibration(calibration, directory);
    kluft::listen_for_stop();
    kluft::CalibrationOptions options;
    options.place = {directory, words[1], static_cast<int>(*jobs), {}};
    RunProgress progress;
    if (!quiet) {
        options.say = [](const std::string& line) { kluft::tell("{}\n", line); };
        options.place.show = [&](const kluft::StudyProgress& runs) { progress.show(runs); };
    }
    const auto result = kluft::calibrate(calibration, options, kluft::stop_requested);
    if (result.stopped) {
        kluft::tell("stopped; the same command goes on from the runs in {}\n", directory.string());
        return kluft::exit_code_of_stop();
    }
    kluft::write_calibration(calibration, result, directory);
    kluft::say("{}{} and report.html in {}\n", kluft::calibration_text(calibration, result), "calibrated.yaml",
               directory.string());
    return result.met ? ExitCode::done : ExitCode::missed;
}

} // namespace

int main(int argc, char** argv) {
    const auto exit_with = [](ExitCode code) {
        if (code == ExitCode::out_of_resources) kluft::leave_without_handlers(code);
        return static_cast<int>(code);
    };
    try {
        kluft::take_signals();
        kluft::open_standard_streams();
        kluft::leave_writing_to_its_result();
        kluft::do_without_blas_threads(argv);
        const ExitCode code = run({argv, argv + argc});
        const std::string lost = kluft::lost_output();
        if (lost.empty()) return exit_with(code);
        throw kluft::ResourceError(lost);
    } catch (...) {
        return exit_with(kluft::tell_failure());
    }
}
