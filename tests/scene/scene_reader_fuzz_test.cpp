// Whatever a scene's text says, the reader either reads it or explains what is wrong.
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "scene/scene_text.hpp"

namespace kluft {
namespace {

using Random = std::mt19937_64;

int below(Random& random, std::size_t n) {
    return static_cast<int>(std::uniform_int_distribution<std::size_t>(0, n - 1)(random));
}

std::vector<std::string> lines_of(const std::string& text) {
    std::vector<std::string> lines;
    std::istringstream stream(text);
    for (std::string line; std::getline(stream, line);) lines.push_back(line);
    return lines;
}

std::string joined(const std::vector<std::string>& lines) {
    std::string text;
    for (const auto& line : lines) text += line + "\n";
    return text;
}

/// Any byte, or one that means something in YAML.
char random_character(Random& random) {
    static const std::string special = "{}[]:,-#&*!|>'\"%@`\n\t ?~0.e";
    return below(random, 4) == 0 ? static_cast<char>(below(random, 256)) : special[below(random, special.size())];
}

std::string with_changed_characters(std::string text, Random& random) {
    const int n_changes = 1 + below(random, 5);
    for (int i = 0; i < n_changes; ++i) {
        const int at = below(random, text.size());
        switch (below(random, 3)) {
        case 0:
            text[at] = random_character(random);
            break;
        case 1:
            text.insert(text.begin() + at, random_character(random));
            break;
        default:
            text.erase(text.begin() + at);
        }
    }
    return text;
}

std::string with_changed_lines(const std::string& text, Random& random) {
    auto lines = lines_of(text);
    const int a = below(random, lines.size());
    const int b = below(random, lines.size());
    switch (below(random, 4)) {
    case 0:
        std::swap(lines[a], lines[b]);
        break;
    case 1:
        lines.erase(lines.begin() + a);
        break;
    case 2:
        lines.insert(lines.begin() + b, lines[a]);
        break;
    default:
        lines[a] = std::string(below(random, 12), ' ') + lines[a];
    }
    return joined(lines);
}

/// Replaces one word by another word of the text or by a troublesome value.
std::string with_changed_words(const std::string& text, Random& random) {
    static const std::vector<std::string> values{
        "null",      "~",         "[]",      "{}",     "-1",
        "0",         "1e308",     "1e-308",  ".nan",   "''",
        "true",      "[1, 2]",    "[[]]",    "{a: b}", "1e9 km",
        "0.5 %",     "*a",        "&a x",    "joint",  "bond",
        "seam",      "rectangle", "polygon", "file",   "[[0, 0], [1, 0], [1, 1]]",
        "2147483648"};
    const std::string breaks = " \n{}[],:";
    std::vector<std::pair<std::size_t, std::size_t>> words;
    for (std::size_t at = 0; at < text.size();) {
        const std::size_t start = text.find_first_not_of(breaks, at);
        if (start == std::string::npos) break;
        at = std::min(text.find_first_of(breaks, start), text.size());
        words.emplace_back(start, at - start);
    }
    const auto [to, n] = words[below(random, words.size())];
    const auto [from, n_from] = words[below(random, words.size())];
    std::string result = text;
    result.replace(to, n, below(random, 2) == 0 ? values[below(random, values.size())] : text.substr(from, n_from));
    return result;
}

void expect_read_or_explained(const std::string& text, const std::vector<std::string>& overrides = {}) {
    try {
        (void)read_scene_text(text, overrides);
    } catch (const InputError& error) {
        EXPECT_FALSE(error.messages().empty());
    } catch (const std::exception& error) {
        ADD_FAILURE() << error.what() << "\n" << text;
    }
}

int n_rounds() {
    const char* rounds = std::getenv("KLUFT_FUZZ_ROUNDS");
    return rounds == nullptr ? 1000 : std::atoi(rounds);
}

TEST(SceneReaderFuzz, RandomChangesOfASceneAreReadOrExplained) {
    Random random(20240229);
    for (int round = 0; round < n_rounds(); ++round) {
        std::string text = test::full_scene;
        const int n_changes = 1 + below(random, 3);
        for (int i = 0; i < n_changes; ++i) {
            const int kind = below(random, 3);
            text = kind == 0   ? with_changed_characters(text, random)
                   : kind == 1 ? with_changed_lines(text, random)
                               : with_changed_words(text, random);
        }
        expect_read_or_explained(text);
    }
}

TEST(SceneReaderFuzz, EveryBeginningOfASceneIsReadOrExplained) {
    for (std::size_t n = 0; n < test::full_scene.size(); n += 7)
        expect_read_or_explained(test::full_scene.substr(0, n));
}

TEST(SceneReaderFuzz, RandomOverridesAreReadOrExplained) {
    Random random(8128);
    const std::vector<std::string> paths{"stages",
                                         "stages.0",
                                         "stages.4",
                                         "stages.1.strain",
                                         "geometry",
                                         "geometry.domain",
                                         "geometry.fractures.1.trace.0",
                                         "materials",
                                         "materials.rock",
                                         "interfaces",
                                         "interfaces.bond.kind",
                                         "boundaries",
                                         "boundaries.left",
                                         "analysis.gravity",
                                         "geometry.tessellation",
                                         "geometry.regions",
                                         "solver.tolerance",
                                         "",
                                         ".",
                                         "a..b",
                                         "stages.-1",
                                         "stages.1.pressure"};
    for (int round = 0; round < n_rounds(); ++round) {
        const std::string value = with_changed_words("{a: [1, {b: 2}], c: [[0, 0], [1, 1]]}", random);
        std::vector<std::string> overrides{paths[below(random, paths.size())] + "=" + value};
        overrides.push_back(paths[below(random, paths.size())] + "=" + with_changed_words("null 3 text", random));
        expect_read_or_explained(test::full_scene, overrides);
    }
}

} // namespace
} // namespace kluft
