#include "kluft/scene/key_places.hpp"

#include <algorithm>
#include <string_view>

#include <fmt/format.h>

namespace kluft {

namespace {

void add_key(const SceneNode& value, const std::string& path, const SceneSources& sources,
             std::vector<KeyPlace>& places);

void add_items(const SceneNode& node, const std::string& path, const SceneSources& sources,
               std::vector<KeyPlace>& places) {
    if (node.is_mapping()) {
        for (std::size_t i = 0; i < node.items.size(); ++i)
            add_key(node.items[i], joined_path(path, node.keys[i].text), sources, places);
    } else if (node.is_list() && path == "stages") {
        for (std::size_t i = 0; i < node.items.size(); ++i)
            add_key(node.items[i], joined_path(path, std::to_string(i)), sources, places);
    }
}

void add_key(const SceneNode& value, const std::string& path, const SceneSources& sources,
             std::vector<KeyPlace>& places) {
    KeyPlace place{path, sources.place(value.at), sources.line(value.at), sources.file(value.at)};
    if (!place.file.empty()) {
        place.line = value.at.line;
        place.column = value.at.column;
    }
    places.push_back(std::move(place));
    add_items(value, path, sources, places);
}

/// The place of a key, or of the nearest one that it is a key of.
const KeyPlace* find_place(const std::vector<KeyPlace>& places, std::string_view path) {
    for (;;) {
        const auto found = std::ranges::find(places, path, &KeyPlace::path);
        if (found != places.end()) return &*found;
        const std::size_t dot = path.rfind('.');
        if (dot == std::string_view::npos) return nullptr;
        path = path.substr(0, dot);
    }
}

InputProblem located(InputProblem problem, const std::vector<KeyPlace>& places) {
    const std::size_t end = problem.message.find(": ");
    if (!problem.file.empty() || end == std::string::npos) return problem;
    const std::string path = problem.message.substr(0, end);
    const KeyPlace* at = find_place(places, path);
    if (at == nullptr) return problem;
    problem.path = path;
    problem.what = problem.message.substr(end + 2);
    problem.message = fmt::format("{}: {}{}{}", at->place, problem.message, at->text.empty() ? "" : "\n  ", at->text);
    problem.file = at->file;
    problem.line = at->line;
    problem.column = at->column;
    return problem;
}

} // namespace

std::vector<KeyPlace> key_places(const SceneNode& root, const SceneSources& sources) {
    std::vector<KeyPlace> places;
    add_items(root, {}, sources, places);
    return places;
}

InputError located(const InputError& error, const std::vector<KeyPlace>& places) {
    std::vector<InputProblem> problems;
    for (const InputProblem& problem : error.problems()) problems.push_back(located(problem, places));
    return InputError(std::move(problems));
}

std::string located(const std::string& warning, const std::vector<KeyPlace>& places) {
    const std::size_t end = warning.find(": ");
    const KeyPlace* at = end == std::string::npos ? nullptr : find_place(places, warning.substr(0, end));
    return at == nullptr ? warning : fmt::format("{}: {}", at->place, warning);
}

} // namespace kluft
