// kluft validate [CASE...]
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <string>
#include <system_error>
#include <vector>

#include <fmt/format.h>
#include <unistd.h>

#include "commands.hpp"
#include "kluft/core/diagnostics.hpp"
#include "this_program.hpp"

namespace kluft {

namespace {

namespace fs = std::filesystem;

/// scripts/validate of the sources that the program was built in, or of the installed share directory.
fs::path validation_script(const fs::path& program) {
    const fs::path script = fs::path("scripts") / "validate";
    const fs::path prefix = program.parent_path().parent_path();
    std::vector<fs::path> places{prefix / "share" / "kluft"};
    for (fs::path place = program.parent_path(); place.has_relative_path(); place = place.parent_path())
        places.push_back(place);
    for (const auto& place : places) {
        std::error_code ignored;
        if (fs::is_regular_file(place / script, ignored)) return place / script;
    }
    throw InputError(
        fmt::format("kluft validate: expected the validation suite in {} or as scripts/validate in a directory "
                    "above {}, found neither; it comes with Kluft's sources",
                    places.front().string(), program.parent_path().string()));
}

} // namespace

std::vector<std::string> validation_cases() {
    std::vector<std::string> cases;
    try {
        const fs::path root = validation_script(this_program("validate")).parent_path().parent_path() / "validation";
        std::error_code error;
        for (fs::directory_iterator each(root, error), end; !error && each != end; each.increment(error))
            if (fs::exists(each->path() / "check.py", error)) cases.push_back(each->path().filename());
    } catch (const InputError&) {
        cases.clear();
    }
    return cases;
}

ExitCode validate(const ValidateArguments& arguments) {
    const fs::path program = this_program("validate");
    std::vector<std::string> words{validation_script(program), "--kluft", program};
    words.insert(words.end(), arguments.words.begin(), arguments.words.end());
    std::vector<char*> pointers;
    for (auto& word : words) pointers.push_back(word.data());
    pointers.push_back(nullptr);
    std::fflush(nullptr);
    execv(pointers.front(), pointers.data());
    throw InputError(fmt::format("{}: cannot be started: {}", words.front(), std::strerror(errno)));
}

} // namespace kluft
