#include "this_program.hpp"

#include <system_error>

#include "kluft/core/diagnostics.hpp"

namespace kluft {

std::filesystem::path this_program(const std::string& command) {
    std::error_code error;
    auto program = std::filesystem::read_symlink("/proc/self/exe", error);
    if (error) throw InputError("kluft " + command + ": cannot find the path of this program: " + error.message());
    return program;
}

} // namespace kluft
