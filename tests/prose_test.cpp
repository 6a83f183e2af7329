// Text that leaves the project: no path of somebody's machine, nothing marked as unfinished.
#include <algorithm>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <set>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/source_folder.hpp"

namespace kluft {
namespace {

namespace fs = std::filesystem;

const std::set<std::string> text_endings{".cpp", ".hpp", ".in", ".cmake", ".txt",     ".json", ".yaml", ".yml", ".md",
                                         ".csv", ".sh",  ".py", ".bash",  ".geojson", ".svg",  ".toml", ""};

bool is_foreign_folder(const fs::path& path) {
    static const std::set<std::string> names{".git", "build", "results", ".cache", "__pycache__"};
    return names.contains(path.filename().string());
}

std::vector<fs::path> text_files() {
    std::vector<fs::path> files;
    for (auto entry = fs::recursive_directory_iterator(source_folder); entry != fs::recursive_directory_iterator();
         ++entry) {
        if (is_foreign_folder(entry->path()) && entry->is_directory()) entry.disable_recursion_pending();
        if (entry->is_regular_file() && text_endings.contains(entry->path().extension().string()) &&
            entry->path().filename() != ".git")
            files.push_back(entry->path());
    }
    std::sort(files.begin(), files.end());
    return files;
}

/// True where `word` stands in the line and the character before it is none of a name or a path.
bool has_word(const std::string& line, const std::string& word) {
    for (std::size_t at = line.find(word); at != std::string::npos; at = line.find(word, at + 1)) {
        const char before = at == 0 ? ' ' : line[at - 1];
        if (std::isalnum(static_cast<unsigned char>(before)) == 0 &&
            std::string("_.}/").find(before) == std::string::npos)
            return true;
    }
    return false;
}

std::vector<std::string> lines_with(const std::vector<std::string>& words) {
    std::vector<std::string> found;
    for (const fs::path& file : text_files()) {
        std::ifstream stream(file);
        std::string line;
        for (int number = 1; std::getline(stream, line); ++number)
            for (const std::string& word : words)
                if (has_word(line, word))
                    found.push_back(file.lexically_relative(source_folder).string() + ":" + std::to_string(number) +
                                    ": " + line);
    }
    return found;
}

// The words are put together here so that this file does not hold them itself.
std::string slashed(const std::string& name) { return "/" + name + "/"; }

TEST(Prose, NamesNoPathOfOneMachine) {
    EXPECT_THAT(lines_with({slashed("home"), slashed("root"), slashed("tmp"), slashed("work"), slashed("Users")}),
                testing::IsEmpty());
}

TEST(Prose, LeavesNothingMarkedAsUnfinished) {
    EXPECT_THAT(lines_with({std::string("TO") + "DO", std::string("FIX") + "ME"}), testing::IsEmpty());
}

} // namespace
} // namespace kluft
