#include "kluft/output/progress_line.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

namespace kluft {

namespace {

constexpr double rewrite_seconds = 0.1;
constexpr double plain_seconds = 10.0;
constexpr double shortest_pace = 0.1; // seconds of a load step that tell how long it takes
constexpr int parts = 20;             // a plain line for each

/// Whether it is known how many load steps there will be: a search for a strength takes more than its stage says.
bool counts_steps(const Progress& progress) { return progress.n_steps > 0 && progress.step <= progress.n_steps; }

double fraction_of(const Progress& progress) {
    if (counts_steps(progress)) return static_cast<double>(progress.step) / progress.n_steps;
    return progress.n_stages > 0 ? (progress.stage + progress.load_factor) / progress.n_stages : 0.0;
}

/// What is rounded to 0.000 has no sign.
double without_sign_of_zero(double stress) { return std::abs(stress) < 5e-4 ? 0.0 : stress; }

int terminal_columns() {
    winsize size{};
    return ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 ? size.ws_col : 0;
}

} // namespace

std::string readable_time(double seconds) {
    constexpr double year = 365.25 * 24.0 * 3600.0;
    if (seconds >= year) return fmt::format("{:.2g} years", seconds / year);
    const auto whole = static_cast<long>(std::lround(std::max(seconds, 0.0)));
    if (whole < 60) return fmt::format("{} s", whole);
    if (whole < 3600) return fmt::format("{} min {:02} s", whole / 60, whole % 60);
    return fmt::format("{} h {:02} min", whole / 3600, whole % 3600 / 60);
}

std::string progress_text(const Progress& progress, std::optional<double> seconds_left) {
    const std::string step = counts_steps(progress) ? fmt::format("{}/{}", progress.step, progress.n_steps)
                                                    : fmt::format("{}", progress.step);
    const std::string left = seconds_left ? fmt::format(", {} left", readable_time(*seconds_left)) : "";
    const std::string answer = progress.strength_factor
                                   ? fmt::format("strengths divided by {:.4f}", *progress.strength_factor)
                                   : fmt::format("strain {:.3f} %  axial {:.3f} MPa", 100.0 * progress.axial_strain,
                                                 without_sign_of_zero(progress.axial_stress / 1e6));
    return fmt::format("stage {}  step {} ({:.0f} %{})  {}  cracks {}  iterations {}", progress.stage, step,
                       std::floor(100.0 * fraction_of(progress)), left, answer, progress.cracks,
                       progress.open_close_iterations);
}

ProgressLine::ProgressLine(std::function<void(std::string_view)> write, bool terminal, int columns,
                           std::function<double()> seconds)
    : write_(std::move(write)), terminal_(terminal), columns_(columns), seconds_(std::move(seconds)) {}

ProgressLine ProgressLine::on_standard_error() {
    const auto write = [](std::string_view text) {
        std::fwrite(text.data(), 1, text.size(), stderr);
        std::fflush(stderr);
    };
    const auto seconds = [] {
        return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
    };
    return {write, isatty(STDERR_FILENO) == 1, terminal_columns(), seconds};
}

/// From the pace of the later half of the time so far: steps after the peak cost more than those before it.
std::optional<double> ProgressLine::seconds_left_at_pace(double fraction) const {
    if (steps_.size() < 2) return std::nullopt;
    const double now = steps_.back().first;
    const double done = steps_.back().second;
    const double middle = 0.5 * (steps_.front().first + now);
    const auto from = std::find_if(steps_.rbegin(), steps_.rend(),
                                   [&](const auto& step) { return step.first <= middle || step.second < done - 0.5; });
    const auto [then, before] = from == steps_.rend() ? steps_.front() : *from;
    if (!(done > before) || !(now > then)) return std::nullopt;
    return (1.0 - fraction) * (now - then) / (done - before);
}

/// Not less than where the load steps to come take as long as the one in progress.
std::optional<double> ProgressLine::seconds_left(const Progress& progress) const {
    const std::optional<double> left = seconds_left_at_pace(fraction_of(progress));
    const double share = progress.share_of_step.value_or(0.0);
    if (!(share > 0.0) || !counts_steps(progress) || steps_.empty()) return left;
    const double passed = seconds_() - steps_.back().first;
    if (passed < shortest_pace) return left;
    return std::max(left.value_or(0.0), (progress.n_steps - progress.step - share) * passed / share);
}

void ProgressLine::show(const Progress& progress) {
    std::string text = progress_text(progress, seconds_left(progress));
    if (terminal_) {
        if (columns_ > 0) text.resize(std::min(text.size(), static_cast<std::size_t>(columns_) - 1));
        write_("\r" + text + "\033[K");
        visible_ = true;
    } else {
        write_(text + '\n');
    }
    last_shown_ = seconds_();
    shown_ = true;
}

void ProgressLine::update(const Progress& progress) {
    const double now = seconds_();
    const double fraction = fraction_of(progress);
    if (steps_.empty() || fraction > steps_.back().second) steps_.emplace_back(now, fraction);
    const int part = static_cast<int>(std::floor(parts * fraction + 1e-9));
    const double pause = terminal_ ? rewrite_seconds : plain_seconds;
    if (shown_ && part == last_part_ && now - last_shown_ < pause) return;
    last_part_ = part;
    show(progress);
}

void ProgressLine::clear() {
    if (!visible_) return;
    write_("\r\033[K");
    visible_ = false;
}

} // namespace kluft
