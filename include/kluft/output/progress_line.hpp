// One line that says where a run stands.
#pragma once

#include <deque>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "kluft/simulation/step_observer.hpp"

namespace kluft {

/// A time as people read it: `8 s`, `3 min 20 s`, `2 h 05 min`, `3.4 years`.
[[nodiscard]] std::string readable_time(double seconds);

/// `stage 2/2  step 57/200 (28 %)  strain 0.570 %  stress 1.213 MPa  cracks 43  iterations 412  left 31 s`.
[[nodiscard]] std::string progress_text(const Progress& progress, std::optional<double> seconds_left);

/// Shows progress: on a terminal as one line that is rewritten, elsewhere as a plain line every 5 % of the load steps
/// and, in longer runs, every 10 s.
class ProgressLine {
public:
    /// `write` gets the bytes to show, `seconds` says the time; `columns` is the terminal's width, to which a line is
    /// cut (0: not cut).
    ProgressLine(std::function<void(std::string_view)> write, bool terminal, int columns,
                 std::function<double()> seconds);

    /// On standard error, with what it is found to be.
    [[nodiscard]] static ProgressLine on_standard_error();

    void update(const Progress& progress);

    /// Takes the line off the terminal, so that something else can be printed; the next update brings it back.
    void clear();

private:
    [[nodiscard]] std::optional<double> seconds_left_at_pace(double fraction) const;
    [[nodiscard]] std::optional<double> seconds_left(const Progress& progress) const;
    void show(const Progress& progress);

    std::function<void(std::string_view)> write_;
    bool terminal_;
    int columns_;
    std::function<double()> seconds_;
    std::deque<std::pair<double, double>> steps_; ///< time and fraction at each finished load step
    double last_shown_ = 0.0;
    int last_part_ = 0; ///< twentieths of the load steps
    bool shown_ = false;
    bool visible_ = false;
};

} // namespace kluft
