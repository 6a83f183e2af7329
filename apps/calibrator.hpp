// kluft-calibrate, the program beside kluft that needs Ipopt.
#pragma once

#include <string>
#include <vector>

namespace kluft {

/// Becomes kluft-calibrate with these words on its command line. Throws InputError where it was not built.
[[noreturn]] void become_calibrator(std::vector<std::string> words);

} // namespace kluft
