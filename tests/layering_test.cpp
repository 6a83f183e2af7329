// Reads the #include lines of the sources: a file includes its own layer and lower ones, and every library of others
// stays in the one layer that hides it.
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <set>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/source_folder.hpp"

namespace kluft {
namespace {

namespace fs = std::filesystem;

/// Low to high; layers of one rank are siblings and do not include each other.
const std::map<std::string, int> rank_of_layer{
    {"core", 0},         {"geometry", 1},    {"maps", 2},         {"blocks", 2},   {"kinematics", 3},
    {"constitutive", 4}, {"contact", 5},     {"loading", 6},      {"assembly", 7}, {"equilibrium", 8},
    {"fracture", 9},     {"simulation", 10}, {"scene", 11},       {"output", 11},  {"reference", 11},
    {"report", 12},      {"studies", 13},    {"calibration", 14}, {"apps", 15},    {"python", 15},
};

/// Which layers may include a header of another project, by the start of its name. What is not listed is free.
const std::map<std::string, std::set<std::string>> layers_of_library{
    {"cholmod", {"assembly"}},
    {"umfpack", {"assembly"}},
    {"SuiteSparse", {"assembly"}},
    {"suitesparse/", {"assembly"}},
    {"metis", {"assembly"}},
    {"cblas", {"assembly"}},
    {"openblas", {"assembly"}},
    {"yaml-cpp/", {"scene"}},
    {"gdal", {"maps"}},
    {"ogr_", {"maps"}},
    {"cpl_", {"maps"}},
    {"CGAL/", {"blocks"}},
    {"boost/polygon/", {"blocks"}},
    {"boost/math/", {"constitutive", "studies"}},
    {"hdf5", {"output"}},
    {"H5", {"output"}},
    {"cairo", {"output"}},
    {"CLI/", {"apps"}},
    {"pybind11/", {"python"}},
    {"coin", {"calibration"}},
    {"Ip", {"calibration"}},
};

/// Heavy headers have no place in what everyone includes.
const std::vector<std::string> never_in_public_headers{
    "cholmod", "umfpack", "SuiteSparse", "suitesparse/", "metis", "cblas", "openblas", "yaml-cpp/",
    "CGAL/",   "hdf5",    "H5",          "cairo",        "CLI/",  "coin",  "Ip",       "nlohmann/",
    "spdlog/", "fmt/",    "boost/",      "pybind11/",    "gdal",  "ogr_",  "cpl_"};

struct Include {
    std::string name;
    int line = 0;
};

bool is_source(const fs::path& path) { return path.extension() == ".cpp" || path.extension() == ".hpp"; }

std::vector<fs::path> sources_under(const fs::path& folder) {
    std::vector<fs::path> files;
    if (!fs::exists(folder)) return files;
    for (const auto& entry : fs::recursive_directory_iterator(folder))
        if (entry.is_regular_file() && is_source(entry.path())) files.push_back(entry.path());
    std::sort(files.begin(), files.end());
    return files;
}

/// The name in `#include <name>` or `#include "name"`; "" on any other line.
std::string included_name(const std::string& line) {
    const std::string directive = "#include";
    if (!line.starts_with(directive)) return "";
    const std::size_t open = line.find_first_of("<\"", directive.size());
    if (open == std::string::npos) return "";
    const std::size_t close = line.find_first_of(">\"", open + 1);
    return line.substr(open + 1, close - open - 1);
}

std::vector<Include> includes_of(const fs::path& file) {
    std::vector<Include> includes;
    std::ifstream stream(file);
    std::string line;
    for (int number = 1; std::getline(stream, line); ++number)
        if (const std::string name = included_name(line); !name.empty())
            includes.push_back({.name = name, .line = number});
    return includes;
}

/// First folder of a path: the layer of "blocks/block_system.hpp".
std::string first_folder(const fs::path& path) { return path.begin()->string(); }

std::string layer_of_file(const fs::path& file) {
    const fs::path relative = file.lexically_relative(source_folder);
    if (const std::string first = first_folder(relative); first == "apps" || first == "python") return first;
    const fs::path base =
        first_folder(relative) == "include" ? source_folder / "include" / "kluft" : source_folder / "src";
    return first_folder(file.lexically_relative(base));
}

std::string complaint(const fs::path& file, const Include& include, const std::string& reason) {
    return file.lexically_relative(source_folder).string() + ":" + std::to_string(include.line) + " includes " +
           include.name + ": " + reason;
}

std::vector<fs::path> all_sources() {
    std::vector<fs::path> files;
    for (const char* const folder : {"include", "src", "apps", "python"})
        for (const fs::path& file : sources_under(source_folder / folder)) files.push_back(file);
    return files;
}

/// "" where the include is allowed.
std::string reason_against_layer(const std::string& layer, const std::string& other) {
    if (!rank_of_layer.contains(other)) return "no such layer";
    if (other == layer) return "";
    if (rank_of_layer.at(other) >= rank_of_layer.at(layer)) return other + " is not below " + layer;
    if (layer == "reference" && (other == "assembly" || other == "equilibrium"))
        return "the explicit reference shares nothing with the implicit solver";
    return "";
}

TEST(Layering, KnowsEveryFolder) {
    std::vector<std::string> unknown;
    for (const fs::path& file : all_sources())
        if (!rank_of_layer.contains(layer_of_file(file))) unknown.push_back(file.string());
    EXPECT_THAT(unknown, testing::IsEmpty());
    EXPECT_THAT(all_sources(), testing::Not(testing::IsEmpty()));
}

TEST(Layering, HasNoUpwardInclude) {
    std::vector<std::string> upward;
    for (const fs::path& file : all_sources())
        for (const Include& include : includes_of(file)) {
            if (!include.name.starts_with("kluft/")) continue;
            const std::string other = first_folder(fs::path(include.name).lexically_relative("kluft"));
            const std::string reason = reason_against_layer(layer_of_file(file), other);
            if (!reason.empty()) upward.push_back(complaint(file, include, reason));
        }
    EXPECT_THAT(upward, testing::IsEmpty());
}

/// All headers of the project that a file includes, directly or through others.
std::set<std::string> reached_from(const fs::path& file) {
    std::set<std::string> reached;
    std::vector<fs::path> waiting{file};
    while (!waiting.empty()) {
        const fs::path next = waiting.back();
        waiting.pop_back();
        for (const Include& include : includes_of(next))
            if (include.name.starts_with("kluft/") && reached.insert(include.name).second)
                waiting.push_back(source_folder / "include" / include.name);
    }
    return reached;
}

// An agreement of both integrators means something only if they share nothing but the body, its laws and its loads.
TEST(Layering, ExplicitReferenceSeesNothingOfAssemblyAndEquilibriumNotEvenThroughOthers) {
    std::vector<std::string> seen;
    int n_files = 0;
    for (const fs::path& file : all_sources()) {
        if (layer_of_file(file) != "reference") continue;
        ++n_files;
        for (const std::string& name : reached_from(file))
            if (name.starts_with("kluft/assembly/") || name.starts_with("kluft/equilibrium/"))
                seen.push_back(file.filename().string() + " reaches " + name);
    }
    EXPECT_THAT(seen, testing::IsEmpty());
    EXPECT_GT(n_files, 0);
}

TEST(Layering, KeepsEveryLibraryInTheLayerThatHidesIt) {
    std::vector<std::string> leaks;
    for (const fs::path& file : all_sources())
        for (const Include& include : includes_of(file))
            for (const auto& [library, layers] : layers_of_library)
                if (include.name.starts_with(library) && !layers.contains(layer_of_file(file)))
                    leaks.push_back(complaint(file, include, "belongs in " + *layers.begin()));
    EXPECT_THAT(leaks, testing::IsEmpty());
}

TEST(Layering, KeepsHeavyHeadersOutOfPublicOnes) {
    std::vector<std::string> leaks;
    for (const fs::path& file : sources_under(source_folder / "include"))
        for (const Include& include : includes_of(file))
            for (const std::string& library : never_in_public_headers)
                if (include.name.starts_with(library))
                    leaks.push_back(complaint(file, include, "include it in a source file"));
    EXPECT_THAT(leaks, testing::IsEmpty());
}

// CGAL takes 15 s and 1 GB to compile, and CMakeLists.txt gives its flags to this file only.
TEST(Layering, IncludesCgalWhereItIsHidden) {
    std::vector<std::string> files;
    for (const fs::path& file : all_sources())
        for (const Include& include : includes_of(file))
            if (include.name.starts_with("CGAL/")) files.push_back(file.lexically_relative(source_folder).string());
    EXPECT_THAT(files, testing::Each(testing::AnyOf("src/blocks/arrangement.cpp", "src/blocks/triangle_net.cpp")));
}

TEST(Layering, ReadsNamesInBothKindsOfBrackets) {
    EXPECT_EQ(included_name("#include <CGAL/Arrangement_2.h> // exact"), "CGAL/Arrangement_2.h");
    EXPECT_EQ(included_name("#include \"kluft/core/vector.hpp\""), "kluft/core/vector.hpp");
    EXPECT_EQ(included_name("// #include <map>"), "");
}

TEST(Layering, JudgesByTheOrderOfTheLayers) {
    EXPECT_EQ(reason_against_layer("contact", "blocks"), "");
    EXPECT_EQ(reason_against_layer("contact", "contact"), "");
    EXPECT_NE(reason_against_layer("blocks", "contact"), "");
    EXPECT_NE(reason_against_layer("scene", "output"), "");
    EXPECT_NE(reason_against_layer("reference", "assembly"), "");
    EXPECT_NE(reason_against_layer("contact", "utilities"), "");
}

} // namespace
} // namespace kluft
