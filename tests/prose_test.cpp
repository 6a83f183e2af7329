// Text that leaves the project: no path of somebody's machine, nothing marked as unfinished.
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <regex>
#include <set>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace kluft {
namespace {

namespace fs = std::filesystem;

const fs::path root = KLUFT_SOURCE_DIR;
const std::set<std::string> text_endings{".cpp", ".hpp", ".in", ".cmake", ".txt",     ".json", ".yaml", ".yml", ".md",
                                         ".csv", ".sh",  ".py", ".bash",  ".geojson", ".svg",  ".toml", ""};

bool is_foreign_folder(const fs::path& path) {
    static const std::set<std::string> names{".git", "build", "results", ".cache", "__pycache__"};
    return names.contains(path.filename().string());
}

std::vector<fs::path> text_files() {
    std::vector<fs::path> files;
    for (auto entry = fs::recursive_directory_iterator(root); entry != fs::recursive_directory_iterator(); ++entry) {
        if (is_foreign_folder(entry->path()) && entry->is_directory()) entry.disable_recursion_pending();
        if (entry->is_regular_file() && text_endings.contains(entry->path().extension().string()) &&
            entry->path().filename() != ".git")
            files.push_back(entry->path());
    }
    std::sort(files.begin(), files.end());
    return files;
}

std::vector<std::string> lines_with(const std::regex& pattern) {
    std::vector<std::string> found;
    for (const fs::path& file : text_files()) {
        std::ifstream stream(file);
        std::string line;
        for (int number = 1; std::getline(stream, line); ++number)
            if (line.size() < 10000 && std::regex_search(line, pattern))
                found.push_back(file.lexically_relative(root).string() + ":" + std::to_string(number) + ": " + line);
    }
    return found;
}

TEST(Prose, NamesNoPathOfOneMachine) {
    EXPECT_THAT(lines_with(std::regex("(^|[^A-Za-z0-9_.}])/(home|root|tmp|work|Users)/")), testing::IsEmpty());
}

TEST(Prose, LeavesNothingMarkedAsUnfinished) {
    EXPECT_THAT(lines_with(std::regex(std::string("\\b(TO") + "DO|FIX" + "ME|XX" + "X)\\b")), testing::IsEmpty());
}

} // namespace
} // namespace kluft
