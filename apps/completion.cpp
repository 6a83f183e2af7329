#include "completion.hpp"

#include <algorithm>
#include <filesystem>
#include <map>
#include <optional>
#include <system_error>

#include "commands.hpp"
#include "kluft/core/diagnostics.hpp"
#include "kluft/output/blocks_picture.hpp"
#include "kluft/scene/scene_schema.hpp"
#include "kluft/scene/scene_text.hpp"

namespace kluft {

namespace {

namespace fs = std::filesystem;
using Texts = std::vector<std::string>;

/// What the arguments of a command are.
struct ArgumentKind {
    Texts endings; ///< of files
    Texts words;   ///< that may stand there too
};

const std::map<std::string, ArgumentKind>& argument_kinds() {
    static const Texts scenes{".yaml", ".yml", ".json"};
    static const std::map<std::string, ArgumentKind> kinds{
        {"run", {scenes, {}}},
        {"check", {scenes, {}}},
        {"draw", {scenes, {}}},
        {"study", {scenes, {"step-size", "trade"}}},
        {"calibrate", {scenes, {}}},
        {"envelope", {{".csv"}, {}}},
        {"schema", {{}, {"scene", "study", "calibration"}}},
        {"completion", {{}, {"bash", "zsh", "fish"}}},
    };
    return kinds;
}

/// Commands whose arguments are neither files nor directories.
bool takes_words_only(const std::string& command) { return command == "schema" || command == "completion"; }

/// Files with one of the endings, all where there is none, and directories.
Texts paths(const std::string& typed, const Texts& endings) {
    const auto slash = typed.rfind('/');
    const std::string folder = slash == std::string::npos ? "" : typed.substr(0, slash + 1);
    const std::string beginning = typed.substr(folder.size());
    Texts found;
    std::error_code error;
    for (fs::directory_iterator file(folder.empty() ? "." : folder, error), end; !error && file != end;
         file.increment(error)) {
        const std::string name = file->path().filename();
        if (!name.starts_with(beginning) || (name.starts_with('.') && beginning.empty())) continue;
        std::error_code ignored;
        if (file->is_directory(ignored))
            found.push_back(folder + name + '/');
        else if (endings.empty() || std::ranges::find(endings, file->path().extension().string()) != endings.end())
            found.push_back(folder + name);
    }
    return found;
}

/// The scene among the words, as far as it can be read.
std::optional<SceneNode> scene_among(const Texts& words) {
    for (const std::string& word : words) {
        std::error_code error;
        if (!fs::is_regular_file(word, error)) continue;
        try {
            SceneSources sources;
            SceneErrors errors(sources);
            return build_scene_tree(read_scene_bytes(word), word, {}, sources, errors);
        } catch (const InputError&) {
            continue;
        }
    }
    return std::nullopt;
}

const SceneNode* child_of(const SceneNode* node, const std::string& key) {
    if (node == nullptr) return nullptr;
    if (node->is_mapping()) return node->find(key);
    const bool is_index =
        !key.empty() && key.size() < 9 && std::ranges::all_of(key, [](char c) { return c >= '0' && c <= '9'; });
    if (!node->is_list() || !is_index) return nullptr;
    const auto index = static_cast<std::size_t>(std::stoi(key));
    return index < node->items.size() ? &node->items[index] : nullptr;
}

/// The names or indices that a scene has there.
Texts names_in(const SceneNode* node) {
    Texts names;
    if (node == nullptr) return names;
    for (const SceneKey& key : node->keys) names.push_back(key.text);
    if (node->is_list())
        for (std::size_t i = 0; i < node->items.size(); ++i) names.push_back(std::to_string(i));
    return names;
}

/// Where a path of --set leads in the table of keys and in the scene.
struct KeyPlace {
    std::string pattern;
    const SceneNode* node = nullptr;
    bool is_known = true;
};

KeyPlace place_of(const std::string& path, const SceneNode* scene) {
    KeyPlace place{{}, scene, true};
    for (std::size_t from = 0; from < path.size();) {
        const std::size_t dot = std::min(path.find('.', from), path.size());
        const std::string key = path.substr(from, dot - from);
        place.pattern = scene_schema().child_pattern(place.pattern, key);
        place.node = child_of(place.node, key);
        place.is_known = place.is_known && !place.pattern.empty();
        from = dot + 1;
    }
    return place;
}

/// "key." where keys stand below it, "key=" where a value does, both where either may.
Texts with_endings(const std::string& path, const std::string& pattern) {
    const KeyRule* rule = scene_schema().find(pattern);
    const bool has_children = !scene_schema().child_keys(pattern).empty();
    const bool is_mapping = rule != nullptr && (rule->type == KeyType::mapping || rule->type == KeyType::named ||
                                                rule->type == KeyType::list);
    Texts all;
    if (has_children) all.push_back(path + '.');
    if (!has_children || !is_mapping) all.push_back(path + '=');
    return all;
}

Texts values_of(const std::string& path) {
    const KeyRule* rule = scene_schema().find(place_of(path, nullptr).pattern);
    if (rule == nullptr) return {};
    Texts values = rule->choices;
    if (rule->type == KeyType::boolean) values = {"true", "false"};
    if (values.empty() && !rule->fallback.empty()) values.emplace_back(rule->fallback);
    for (std::string& value : values) value.insert(0, path + '=');
    return values;
}

/// What --set may be given: keys of a scene, with the names that this one has, and their values.
Texts set_words(const std::string& typed, const Texts& words) {
    if (const auto equals = typed.find('='); equals != std::string::npos) return values_of(typed.substr(0, equals));
    const auto dot = typed.rfind('.');
    const std::string above = dot == std::string::npos ? "" : typed.substr(0, dot);
    const auto scene = scene_among(words);
    const KeyPlace place = place_of(above, scene ? &*scene : nullptr);
    if (!place.is_known) return {};
    Texts all;
    for (const std::string& key : scene_schema().child_keys(place.pattern)) {
        const Texts names = key == "*" || key == "#" ? names_in(place.node) : Texts{key};
        for (const std::string& name : names) {
            const std::string path = joined_path(above, name);
            for (std::string& word : with_endings(path, joined_path(place.pattern, key)))
                all.push_back(std::move(word));
        }
    }
    return all;
}

/// The option whose value the last word is; null where it is none's.
const CLI::Option* option_before(const CLI::App& command, const Texts& words) {
    if (words.size() < 2) return nullptr;
    const std::string& name = words[words.size() - 2];
    if (name.size() < 2 || !name.starts_with('-')) return nullptr;
    const CLI::Option* option = command.get_option_no_throw(name);
    return option != nullptr && option->get_items_expected_max() > 0 ? option : nullptr;
}

Texts option_values(const CLI::Option& option, const Texts& words) {
    const auto has = [&](const char* each) { return option.check_lname(each); };
    if (has("set")) return set_words(words.back(), words);
    if (has("output")) return paths(words.back(), {});
    if (has("step")) return {"peak", "last"};
    if (has("field")) return block_field_names();
    if (has("emit")) return {"slurm", "make"};
    return {};
}

Texts option_names(const CLI::App& command) {
    Texts names{"--help"};
    for (const CLI::Option* option : command.get_options())
        for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
    return names;
}

Texts words_of_command(const CLI::App& command, const Texts& words) {
    const std::string& typed = words.back();
    if (command.get_name() == "validate") {
        Texts all = validation_cases();
        all.insert(all.end(), {"--help", "--jobs", "--list", "--output"});
        return all;
    }
    if (const CLI::Option* option = option_before(command, words)) return option_values(*option, words);
    if (typed.starts_with('-')) return option_names(command);
    const auto found = argument_kinds().find(command.get_name());
    const ArgumentKind kind = found == argument_kinds().end() ? ArgumentKind{{"/"}, {}} : found->second;
    Texts all = kind.words;
    if (takes_words_only(command.get_name())) return all;
    for (std::string& path : paths(typed, kind.endings)) all.push_back(std::move(path));
    return all;
}

Texts words_of_program(const CLI::App& app) {
    Texts all{"--help", "--version"};
    for (const CLI::App* sub : app.get_subcommands({}))
        if (!sub->get_group().empty()) all.push_back(sub->get_name());
    return all;
}

constexpr std::string_view bash_script = R"shell(# Completion of kluft for bash: made by kluft completion bash.
_kluft() {
    local line=${COMP_LINE:0:COMP_POINT} typed head
    local -a words
    read -ra words <<<"$line"
    [[ $line == *[[:space:]] ]] && words+=("")
    typed=${words[-1]}
    mapfile -t COMPREPLY < <("${words[0]}" complete "${words[@]:1}" 2>/dev/null)
    # Readline replaces only what follows the last character that breaks words.
    if [[ $typed == *[=:]* ]]; then
        head=${typed%"${typed##*[=:]}"}
        COMPREPLY=("${COMPREPLY[@]#"$head"}")
    fi
    [[ ${#COMPREPLY[@]} == 1 && ${COMPREPLY[0]} == *[/=.] ]] && compopt -o nospace
    return 0
}
complete -F _kluft kluft
)shell";

constexpr std::string_view zsh_script = R"shell(#compdef kluft
# Completion of kluft for zsh: made by kluft completion zsh.
_kluft() {
    local -a candidates
    candidates=(${(f)"$(${words[1]} complete "${(@)words[2,CURRENT]}" 2>/dev/null)"})
    compadd -S '' -- ${(M)candidates:#*[/=.]}
    compadd -- ${candidates:#*[/=.]}
}
if [[ $funcstack[1] == _kluft ]]; then
    _kluft "$@"
else
    compdef _kluft kluft
fi
)shell";

constexpr std::string_view fish_script = R"shell(# Completion of kluft for fish: made by kluft completion fish.
function __kluft_complete
    set -l words (commandline -opc) (commandline -ct)
    $words[1] complete $words[2..-1] 2>/dev/null
end
complete -c kluft -f -a '(__kluft_complete)'
)shell";

} // namespace

std::vector<std::string> completions(const CLI::App& app, const std::vector<std::string>& words) {
    if (words.empty()) return words_of_program(app);
    Texts all;
    if (words.size() == 1) {
        all = words_of_program(app);
    } else {
        for (const CLI::App* sub : app.get_subcommands({}))
            if (sub->get_name() == words.front()) all = words_of_command(*sub, {words.begin() + 1, words.end()});
    }
    std::erase_if(all, [&](const std::string& each) { return !each.starts_with(words.back()); });
    std::ranges::sort(all);
    all.erase(std::unique(all.begin(), all.end()), all.end());
    return all;
}

std::string completion_script(const std::string& shell) {
    return std::string(shell == "zsh" ? zsh_script : shell == "fish" ? fish_script : bash_script);
}

} // namespace kluft
