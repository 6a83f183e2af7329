// What the program says on standard output and standard error.
#pragma once

#include <string>
#include <utility>

#include <fmt/format.h>

namespace kluft {

void say_text(const std::string& text);
void tell_text(const std::string& text);

/// To standard output. Whether it got there is seen by `lost_output`.
template <class... Values> void say(fmt::format_string<Values...> format, Values&&... values) {
    say_text(fmt::format(format, std::forward<Values>(values)...));
}

/// To standard error; nothing depends on its getting there.
template <class... Values> void tell(fmt::format_string<Values...> format, Values&&... values) {
    tell_text(fmt::format(format, std::forward<Values>(values)...));
}

/// Why something of what was said so far is lost, "standard output: cannot write: No space left on device". Empty where
/// all is written, and where it goes to a reader who has gone away.
[[nodiscard]] std::string lost_output();

/// A standard stream that whoever started the program has closed becomes one that leads nowhere, lest a file of the
/// results takes its place.
void open_standard_streams();

} // namespace kluft
