// kluft report DIR...
#include <filesystem>
#include <string>
#include <vector>

#include "commands.hpp"
#include "kluft/report/run_page.hpp"
#include "kluft/studies/finished_run.hpp"
#include "standard_output.hpp"

namespace kluft {

ExitCode report(const std::vector<std::string>& directories) {
    for (const std::string& directory : directories) require_results(directory);
    for (const std::string& directory : directories) say("{}\n", write_run_page(directory).string());
    return ExitCode::done;
}

} // namespace kluft
