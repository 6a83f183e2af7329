// kluft-calibrate, which `kluft calibrate` starts: what needs Ipopt.
#include <chrono>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <new>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "commands.hpp"
#include "kluft/calibration/calibrate.hpp"
#include "kluft/calibration/calibration_report.hpp"
#include "kluft/core/diagnostics.hpp"
#include "kluft/scene/quantity.hpp"
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
        fmt::print(stderr, "  {}\n", kluft::study_progress_text(progress));
    }

private:
    using Clock = std::chrono::steady_clock;
    Clock::time_point last_ = Clock::now();
};

kluft::ExitCode run(const std::vector<std::string>& words) {
    const auto jobs = words.size() == n_words ? kluft::read_integer(words[4]) : std::nullopt;
    if (!jobs || *jobs < 1)
        throw kluft::InputError(
            "kluft-calibrate is started by kluft calibrate TARGET.yaml; see kluft calibrate --help");
    const bool quiet = words[5] == "quiet";
    const fs::path directory = fs::absolute(words[3]).lexically_normal();
    const kluft::Calibration calibration = kluft::read_calibration(words[2]);
    const kluft::StudyLock lock(directory);
    kluft::listen_for_stop();
    kluft::CalibrationOptions options;
    options.place = {directory, words[1], static_cast<int>(*jobs), {}};
    RunProgress progress;
    if (!quiet) {
        options.say = [](const std::string& line) { fmt::print(stderr, "{}\n", line); };
        options.place.show = [&](const kluft::StudyProgress& runs) { progress.show(runs); };
    }
    const auto result = kluft::calibrate(calibration, options, kluft::stop_requested);
    if (result.stopped) {
        fmt::print(stderr, "stopped; the same command goes on from the runs in {}\n", directory.string());
        return ExitCode::interrupted;
    }
    kluft::write_calibration(calibration, result, directory);
    fmt::print("{}{} and report.html in {}\n", kluft::calibration_text(calibration, result), "calibrated.yaml",
               directory.string());
    return result.met ? ExitCode::done : ExitCode::missed;
}

int fails(const char* message, ExitCode code) {
    std::fprintf(stderr, "%s\n", message);
    return static_cast<int>(code);
}

} // namespace

int main(int argc, char** argv) {
    try {
        return static_cast<int>(run({argv, argv + argc}));
    } catch (const kluft::InputError& error) {
        return fails(error.what(), ExitCode::bad_input);
    } catch (const kluft::ResourceError& error) {
        return fails(error.what(), ExitCode::out_of_resources);
    } catch (const std::bad_alloc&) {
        return fails("out of memory", ExitCode::out_of_resources);
    }
}
