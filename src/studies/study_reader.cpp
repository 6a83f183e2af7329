#include <algorithm>
#include <cmath>
#include <set>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "kluft/core/diagnostics.hpp"
#include "kluft/core/digest.hpp"
#include "kluft/core/nearest_name.hpp"
#include "kluft/maps/map_file.hpp"
#include "kluft/output/atomic_file.hpp"
#include "kluft/scene/quantity.hpp"
#include "kluft/scene/scene_check.hpp"
#include "kluft/scene/scene_reader.hpp"
#include "kluft/scene/scene_schema.hpp"
#include "kluft/scene/scene_text.hpp"
#include "kluft/scene/scene_writer.hpp"
#include "kluft/studies/study.hpp"
#include "kluft/studies/study_analysis.hpp"
#include "kluft/studies/study_schema.hpp"

namespace kluft {

namespace {

namespace fs = std::filesystem;

std::string expected_one_of(const std::string& found, const std::vector<std::string>& names) {
    if (names.empty()) return "expected nothing, since there is none to choose from, found " + in_quotes(found);
    return fmt::format("expected one of {}, found {}{}", listed(names), in_quotes(found), suggestion(found, names));
}

std::vector<std::string> keys_of(const Study& study) {
    std::vector<std::string> keys;
    for (const auto& parameter : study.parameters) keys.push_back(parameter.key);
    return keys;
}

bool same_value(const std::string& a, const std::string& b) {
    const auto number_a = read_number(a);
    const auto number_b = read_number(b);
    return number_a && number_b ? *number_a == *number_b : a == b;
}

/// Reads the keys of a study one after the other; what is wrong goes to `errors`.
class StudyReader {
public:
    StudyReader(const SceneNode& root, const fs::path& file, SceneErrors& errors)
        : root_(root), file_(file), errors_(errors) {}

    Study read() {
        study_.name = file_.stem().string();
        if (!root_.is_mapping()) {
            fail(root_, "", "expected a mapping with the keys scene and vary, found " + found_text(root_));
            return std::move(study_);
        }
        check_keys(root_, "", study_schema().child_keys(""));
        if (const auto title = text("title")) study_.title = *title;
        read_scene_name();
        if (const SceneNode* set = root_.find("set")) study_.set = settings(*set, "set");
        if (const SceneNode* vary = root_.find("vary")) common_ = parameters(*vary, "vary");
        read_variants();
        gather_parameters();
        read_combination();
        read_replicas();
        read_quantities();
        study_.curve = choice("curve", {"true", "false"}) == "true";
        study_.pictures = choice("pictures", {"false", "true"}) == "true";
        read_along();
        read_reference();
        read_time_limit();
        return std::move(study_);
    }

private:
    void fail(const SceneNode& node, const std::string& path, const std::string& what) {
        errors_.add(node.at, path, what);
    }

    void check_keys(const SceneNode& node, const std::string& path, const std::vector<std::string>& known) {
        for (const auto& key : node.keys) {
            if (std::ranges::find(known, key.text) != known.end()) continue;
            errors_.add(key.at, joined_path(path, key.text), "unknown key; " + expected_one_of(key.text, known));
        }
    }

    std::optional<std::string> text(const char* key) {
        const SceneNode* node = root_.find(key);
        if (node == nullptr) return std::nullopt;
        if (node->is_scalar() && !node->text.empty()) return node->text;
        fail(*node, key, "expected a text, found " + found_text(*node));
        return std::nullopt;
    }

    static const KeyRule& rule(const std::string& pattern) { return *study_schema().find(pattern); }

    /// A key of the study itself; its default where it says nothing.
    std::string choice(const char* key, const std::vector<std::string>& choices) {
        const SceneNode* node = root_.find(key);
        if (node == nullptr) return std::string(rule(key).fallback);
        if (node->is_scalar() && std::ranges::find(choices, node->text) != choices.end()) return node->text;
        fail(*node, key,
             node->is_scalar() ? expected_one_of(node->text, choices)
                               : fmt::format("expected one of {}, found {}", listed(choices), found_text(*node)));
        return std::string(rule(key).fallback);
    }

    /// A number of a mapping within the bounds of its rule.
    std::optional<double> number(const SceneNode& mapping, const std::string& path, const char* key) {
        const SceneNode* node = mapping.find(key);
        if (node == nullptr) return std::nullopt;
        const KeyRule& of_key = rule(joined_path(path, key));
        const auto [least, most] = std::pair(of_key.range.least, of_key.range.most);
        const auto value = node->is_scalar() ? read_quantity(node->text, of_key.measure).value : std::nullopt;
        if (value && *value >= to_si(least, of_key.measure) && *value <= to_si(most, of_key.measure)) return value;
        fail(*node, joined_path(path, key),
             fmt::format("expected a number from {:g} to {:g}, found {}", least, most, found_text(*node)));
        return std::nullopt;
    }

    std::optional<long long> integer(const SceneNode& node, const std::string& path, const Range& range) {
        const auto least = static_cast<long long>(range.least);
        const auto most = static_cast<long long>(range.most);
        const auto value = node.is_scalar() ? read_integer(node.text) : std::nullopt;
        if (value && *value >= least && *value <= most) return value;
        fail(node, path, fmt::format("expected an integer from {} to {}, found {}", least, most, found_text(node)));
        return std::nullopt;
    }

    void read_scene_name() {
        const auto name = text("scene");
        if (!name) {
            if (root_.find("scene") == nullptr) fail(root_, "scene", "expected the file of a scene, found nothing");
            return;
        }
        study_.scene = fs::absolute(file_.parent_path() / *name).lexically_normal();
        std::error_code error;
        if (!fs::is_regular_file(study_.scene, error))
            fail(*root_.find("scene"), "scene",
                 fmt::format("expected the file of a scene, found {}, which is {}", in_quotes(*name),
                             fs::is_directory(study_.scene, error) ? "a directory" : "no file"));
    }

    std::vector<StudySetting> settings(const SceneNode& node, const std::string& path) {
        std::vector<StudySetting> result;
        if (!node.is_mapping()) {
            fail(node, path,
                 "expected a mapping of keys of the scene, as {solver.tolerance: 1e-6}, found " + found_text(node));
            return result;
        }
        for (std::size_t i = 0; i < node.items.size(); ++i)
            result.push_back({node.keys[i].text, write_scene_value(node.items[i]), node.items[i].at});
        return result;
    }

    // ---- what varies -------------------------------------------------------------------------------------------

    std::vector<StudyParameter> parameters(const SceneNode& vary, const std::string& path) {
        std::vector<StudyParameter> all;
        if (!vary.is_mapping())
            fail(vary, path, "expected a mapping of keys of the scene to values, found " + found_text(vary));
        for (std::size_t i = 0; i < vary.keys.size(); ++i) {
            StudyParameter parameter{vary.keys[i].text, {}};
            const std::string below = joined_path(path, parameter.key);
            const SceneNode& values = vary.items[i];
            if (values.is_list())
                read_list(values, below, parameter);
            else
                read_range(values, below, parameter);
            if (!parameter.values.empty()) all.push_back(std::move(parameter));
        }
        return all;
    }

    void read_list(const SceneNode& list, const std::string& path, StudyParameter& parameter) {
        if (list.items.empty()) return fail(list, path, "expected at least one value, found an empty list");
        for (const auto& item : list.items) add_value(item, write_scene_value(item), path, parameter);
    }

    void add_value(const SceneNode& node, const std::string& value, const std::string& path,
                   StudyParameter& parameter) {
        for (const auto& other : parameter.values)
            if (same_value(other.value, value))
                return fail(node, path, "expected different values, found " + in_quotes(value) + " twice");
        parameter.values.push_back({parameter.key, value, node.at});
    }

    void read_range(const SceneNode& range, const std::string& path, StudyParameter& parameter) {
        const std::string form = "expected a list of values, {from: 0, to: 30, count: 4} or {from: 1e-3, to: 1e-7, "
                                 "factor: 0.1}, found ";
        if (!range.is_mapping()) return fail(range, path, form + found_text(range));
        check_keys(range, path, study_schema().child_keys("vary.*"));
        const auto from = plain_number(range, path, "from");
        const auto to = plain_number(range, path, "to");
        const bool counted = range.find("count") != nullptr;
        if (!from || !to) return;
        if (counted == (range.find("factor") != nullptr))
            return fail(range, path, form + (counted ? "both count and factor" : "neither count nor factor"));
        for (const double value : counted ? arithmetic(range, path, *from, *to) : geometric(range, path, *from, *to))
            add_value(range, fmt::format("{:.12g}", value), path, parameter);
    }

    std::optional<double> plain_number(const SceneNode& range, const std::string& path, const char* key) {
        const SceneNode* node = range.find(key);
        if (node == nullptr) {
            fail(range, joined_path(path, key), "expected a number, found nothing");
            return std::nullopt;
        }
        const auto value = node->is_scalar() ? read_number(node->text) : std::nullopt;
        if (!value) fail(*node, joined_path(path, key), "expected a number without a unit, found " + found_text(*node));
        return value;
    }

    std::vector<double> arithmetic(const SceneNode& range, const std::string& path, double from, double to) {
        const auto count = integer(*range.find("count"), joined_path(path, "count"), rule("vary.*.count").range);
        std::vector<double> values;
        for (long long i = 0; count && i < *count; ++i)
            values.push_back(std::lerp(from, to, static_cast<double>(i) / static_cast<double>(*count - 1)));
        return values;
    }

    std::vector<double> geometric(const SceneNode& range, const std::string& path, double from, double to) {
        const SceneNode& node = *range.find("factor");
        const auto factor = plain_number(range, path, "factor");
        if (!factor) return {};
        const bool leads = from * to > 0.0 && *factor > 0.0 && *factor != 1.0 &&
                           (from == to || (std::abs(to) > std::abs(from)) == (*factor > 1.0));
        const double last = leads ? std::floor(std::log(to / from) / std::log(*factor) + 1e-9) : -1.0;
        if (!leads || last >= static_cast<double>(most_cases)) {
            fail(node, joined_path(path, "factor"),
                 fmt::format("expected a positive factor that leads from {:g} to {:g} in fewer than {} steps, found {}",
                             from, to, most_cases, found_text(node)));
            return {};
        }
        std::vector<double> values;
        for (int i = 0; i <= static_cast<int>(last); ++i) values.push_back(from * std::pow(*factor, i));
        return values;
    }

    void read_combination() {
        study_.together = choice("combine", rule("combine").choices) == "together";
        if (!study_.together) return;
        for (const auto& variant : study_.variants) {
            for (const auto& parameter : variant.vary) {
                const auto& first = variant.vary.front();
                if (parameter.values.size() == first.values.size()) continue;
                errors_.add(parameter.values.front().at, joined_path("vary", parameter.key),
                            fmt::format("expected {} values as of {} because of combine: together, found {}",
                                        first.values.size(), first.key, parameter.values.size()));
            }
        }
    }

    /// All parameters with all their values; those of the whole study vary in each variant.
    void gather_parameters() {
        if (study_.variants.empty()) study_.variants.push_back({});
        for (auto& variant : study_.variants) {
            variant.vary.insert(variant.vary.begin(), common_.begin(), common_.end());
            for (const auto& parameter : variant.vary) gather(parameter);
        }
    }

    void gather(const StudyParameter& parameter) {
        auto known = std::ranges::find(study_.parameters, parameter.key, &StudyParameter::key);
        if (known == study_.parameters.end()) {
            study_.parameters.push_back(parameter);
            return;
        }
        for (const auto& value : parameter.values)
            if (std::ranges::find(known->values, value.value, &StudySetting::value) == known->values.end())
                known->values.push_back(value);
    }

    void read_variants() {
        const SceneNode* list = root_.find("variants");
        if (list == nullptr) return;
        if (!list->is_list())
            return fail(*list, "variants",
                        "expected a list of {name: ..., set: {...}, vary: {...}}, found " + found_text(*list));
        for (std::size_t i = 0; i < list->items.size(); ++i)
            read_variant(list->items[i], fmt::format("variants.{}", i));
    }

    void read_variant(const SceneNode& node, const std::string& path) {
        if (!node.is_mapping())
            return fail(node, path, "expected {name: ..., set: {...}, vary: {...}}, found " + found_text(node));
        check_keys(node, path, study_schema().child_keys("variants.#"));
        const SceneNode* name = node.find("name");
        if (name == nullptr || !name->is_scalar() || name->text.empty())
            return fail(name == nullptr ? node : *name, joined_path(path, "name"), "expected a name");
        for (const auto& other : study_.variants)
            if (other.name == name->text)
                return fail(*name, joined_path(path, "name"),
                            "expected a name of its own, found " + in_quotes(name->text) + " twice");
        StudyVariant variant{name->text, {}, {}};
        if (const SceneNode* set = node.find("set")) variant.set = settings(*set, joined_path(path, "set"));
        if (const SceneNode* vary = node.find("vary")) variant.vary = parameters(*vary, joined_path(path, "vary"));
        study_.variants.push_back(std::move(variant));
    }

    void read_replicas() {
        const SceneNode* node = root_.find("replicas");
        if (node == nullptr) return;
        ReplicaPlan& plan = study_.replicas;
        plan.at = node->at;
        if (!node->is_mapping()) {
            plan.count = static_cast<int>(integer(*node, "replicas", rule("replicas").range).value_or(1));
            return;
        }
        check_keys(*node, "replicas", study_schema().child_keys("replicas"));
        const SceneNode* count = node->find("count");
        if (count == nullptr) return fail(*node, "replicas.count", "expected a number of copies, found nothing");
        plan.count = static_cast<int>(integer(*count, "replicas.count", rule("replicas.count").range).value_or(1));
        if (const SceneNode* seed = node->find("seed"))
            plan.seed = integer(*seed, "replicas.seed", rule("replicas.seed").range).value_or(1);
        plan.strength_noise = number(*node, "replicas", "strength_noise").value_or(plan.strength_noise);
        if (const SceneNode* offset = node->find("offset")) {
            plan.offset = offset->text == "true";
            if (!offset->is_scalar() || (offset->text != "true" && offset->text != "false"))
                fail(*offset, "replicas.offset", "expected true or false, found " + found_text(*offset));
        }
        if (const auto rotation = number(*node, "replicas", "rotation"))
            plan.rotation = *rotation / to_si(1.0, Measure::angle);
    }

    // ---- what is looked at -------------------------------------------------------------------------------------

    void read_quantities() {
        study_.quantities = {"peak_stress", "peak_strain"};
        const SceneNode* list = root_.find("quantities");
        if (list == nullptr) return;
        if (!list->is_list() || list->items.empty())
            return fail(*list, "quantities", "expected a list of numbers of summary.json, found " + found_text(*list));
        const auto known = summary_quantities();
        study_.quantities.clear();
        for (const auto& item : list->items) {
            const bool is_new = std::ranges::find(study_.quantities, item.text) == study_.quantities.end();
            if (!item.is_scalar() || std::ranges::find(known, item.text) == known.end())
                fail(item, "quantities", expected_one_of(item.text, known));
            else if (!is_new)
                fail(item, "quantities", "expected different quantities, found " + in_quotes(item.text) + " twice");
            else
                study_.quantities.push_back(item.text);
        }
    }

    static bool is_numeric(const StudyParameter& parameter) {
        return std::ranges::all_of(parameter.values,
                                   [](const StudySetting& s) { return read_number(s.value).has_value(); });
    }

    static bool refines_solution(const std::string& key) { return parameter_kind(key) == ParameterKind::refinement; }

    /// Other values of a strength, a stiffness or a load make another problem, of which no value is the finest.
    static bool may_refine_solution(const std::string& key) {
        return parameter_kind(key) == ParameterKind::method || key.starts_with("geometry.tessellation.");
    }

    void read_along() {
        const auto& parameters = study_.parameters;
        if (const auto key = text("along")) {
            const auto found = std::ranges::find(parameters, *key, &StudyParameter::key);
            if (found == parameters.end())
                return fail(*root_.find("along"), "along", expected_one_of(*key, keys_of(study_)));
            if (!is_numeric(*found))
                return fail(*root_.find("along"), "along",
                            "expected a parameter whose values are numbers without a unit, found " + in_quotes(*key));
            study_.along = found - parameters.begin();
            return;
        }
        for (const auto& leads : {refines_solution, may_refine_solution}) {
            const auto first = std::ranges::find_if(parameters, [&](const StudyParameter& parameter) {
                return is_numeric(parameter) && leads(parameter.key);
            });
            if (first != parameters.end()) study_.along = first - parameters.begin();
            if (study_.along) return;
        }
    }

    void read_reference() {
        const SceneNode* node = root_.find("reference");
        if (node == nullptr || (node->is_scalar() && node->text == "finest")) return;
        StudyReference& reference = study_.reference;
        if (node->is_scalar() && node->text == "none") {
            reference.kind = StudyReference::Kind::none;
            return;
        }
        const std::string form = "expected finest, none, {case: {key: value}}, {values: {quantity: number}} or "
                                 "{directory: DIR}, found ";
        if (!node->is_mapping() || node->keys.size() != 1) return fail(*node, "reference", form + found_text(*node));
        check_keys(*node, "reference", study_schema().child_keys("reference"));
        if (const SceneNode* chosen = node->find("case")) read_chosen_case(*chosen);
        if (const SceneNode* values = node->find("values")) read_values(*values);
        if (const SceneNode* directory = node->find("directory")) read_directory(*directory);
    }

    void read_chosen_case(const SceneNode& node) {
        if (!node.is_mapping()) return fail(node, "reference.case", "expected {key: value}, found " + found_text(node));
        for (std::size_t i = 0; i < node.items.size(); ++i) {
            const std::string& key = node.keys[i].text;
            const std::string path = joined_path("reference.case", key);
            const std::string value = write_scene_value(node.items[i]);
            const auto parameter = std::ranges::find(study_.parameters, key, &StudyParameter::key);
            if (parameter != study_.parameters.end()) {
                choose_value(node.items[i], path, value, *parameter);
            } else if (key == "variant") {
                choose_variant(node.items[i], path);
            } else {
                auto known = keys_of(study_);
                known.emplace_back("variant");
                errors_.add(node.keys[i].at, path, expected_one_of(key, known));
            }
        }
    }

    void choose_value(const SceneNode& node, const std::string& path, const std::string& value,
                      const StudyParameter& parameter) {
        // Written the same before what is equal as a number only.
        if (const auto same = std::ranges::find(parameter.values, value, &StudySetting::value);
            same != parameter.values.end()) {
            study_.reference.set.push_back(*same);
            return;
        }
        std::vector<std::string> known;
        for (const auto& each : parameter.values) {
            known.push_back(each.value);
            if (!same_value(each.value, value)) continue;
            study_.reference.set.push_back(each);
            return;
        }
        fail(node, path, fmt::format("expected one of {}, found {}", listed(known), in_quotes(value)));
    }

    void choose_variant(const SceneNode& node, const std::string& path) {
        std::vector<std::string> names;
        for (const auto& variant : study_.variants) names.push_back(variant.name);
        if (std::ranges::find(names, node.text) == names.end())
            return fail(node, path, expected_one_of(node.text, names));
        study_.reference.variant = node.text;
    }

    void read_values(const SceneNode& node) {
        study_.reference.kind = StudyReference::Kind::values;
        if (!node.is_mapping() || node.items.empty())
            return fail(node, "reference.values", "expected {quantity: number}, found " + found_text(node));
        check_keys(node, "reference.values", study_.quantities);
        for (std::size_t i = 0; i < node.items.size(); ++i) {
            const auto value = node.items[i].is_scalar() ? read_number(node.items[i].text) : std::nullopt;
            if (value)
                study_.reference.values[node.keys[i].text] = *value;
            else
                fail(node.items[i], joined_path("reference.values", node.keys[i].text),
                     "expected a number without a unit, found " + found_text(node.items[i]));
        }
    }

    void read_directory(const SceneNode& node) {
        study_.reference.kind = StudyReference::Kind::directory;
        study_.reference.directory = fs::absolute(file_.parent_path() / node.text).lexically_normal();
        std::error_code error;
        if (!node.is_scalar() || !fs::is_regular_file(study_.reference.directory / "summary.json", error))
            fail(node, "reference.directory",
                 fmt::format("expected the directory of a finished run, found {}, which has no summary.json",
                             found_text(node)));
    }

    void read_time_limit() { study_.time_limit = number(root_, "", "time_limit").value_or(study_.time_limit); }

    const SceneNode& root_;
    const fs::path& file_;
    SceneErrors& errors_;
    std::vector<StudyParameter> common_; ///< that vary in the whole study
    Study study_;
};

// ---- the cases against the scene -----------------------------------------------------------------------------------

/// Names of files in the merged text of a scene: its geometry.
void collect_files(const SceneNode& node, std::set<std::string>& files) {
    for (std::size_t i = 0; i < node.items.size(); ++i) {
        const SceneNode& item = node.items[i];
        if (node.is_mapping() && node.keys[i].text == "file" && item.is_scalar()) files.insert(item.text);
        collect_files(item, files);
    }
}

/// The merged text of a scene as a tree.
SceneNode tree_of(const Scene& scene) {
    SceneSources sources;
    SceneErrors errors(sources);
    const int source = sources.add_file("scene", scene.text);
    return parse_scene_tree(scene.text, source, {source, 1, 1}, errors);
}

std::string digest_of(const Scene& scene) {
    Digest digest;
    digest.add(scene.text);
    if (scene.text.find("file:") == std::string::npos) return digest.text();
    std::set<std::string> files;
    collect_files(tree_of(scene), files);
    for (const auto& file : std::set<std::string>(files))
        for (const fs::path& other : companions(file)) files.insert(other.string());
    std::error_code error;
    for (const auto& file : files)
        if (fs::is_regular_file(file, error)) digest.add(read_file(file));
    return digest.text();
}

const SceneNode* child_of(const SceneNode& node, std::string_view key) {
    if (node.is_mapping()) return node.find(key);
    const auto index = node.is_list() ? read_number(key) : std::nullopt;
    if (!index || *index < 0.0 || *index >= static_cast<double>(node.items.size())) return nullptr;
    return &node.items[static_cast<std::size_t>(*index)];
}

/// What a scene says at a path such as stages.1.steps, or its default; no default below a mapping that is not there.
std::string setting_at(const SceneNode& tree, std::string_view path) {
    const SceneNode* node = &tree;
    const SceneNode* parent = nullptr;
    std::string pattern;
    for (std::size_t begin = 0; begin <= path.size();) {
        const std::size_t end = std::min(path.find('.', begin), path.size());
        const std::string_view key = path.substr(begin, end - begin);
        const bool is_index = !key.empty() && key.find_first_not_of("0123456789") == std::string_view::npos;
        pattern = scene_schema().child_pattern(pattern, is_index ? "#" : key);
        parent = node;
        if (node != nullptr) node = child_of(*node, key);
        begin = end + 1;
    }
    if (node != nullptr && node->is_scalar()) return node->text;
    if (node != nullptr && node->is_list()) return "[...]";
    if (node != nullptr && node->is_mapping()) return "{...}";
    const bool in_section = std::ranges::count(path, '.') <= 1;
    const KeyRule* const rule = parent != nullptr || in_section ? scene_schema().find(pattern) : nullptr;
    return rule != nullptr ? std::string(rule->fallback) : std::string{};
}

std::vector<std::string> own_settings(const Study& study) {
    std::vector<std::string> own;
    try {
        const SceneNode tree = tree_of(read_scene(study.scene, assignments(study.set)));
        for (const auto& parameter : study.parameters) own.push_back(setting_at(tree, parameter.key));
    } catch (const InputError&) {
        return {}; // the cases may be sound all the same
    }
    return own;
}

/// What a scene's schema says against the settings of a case, in the words of the scene's reader.
std::vector<std::string> schema_messages(const std::string& text, const fs::path& scene,
                                         const std::vector<std::string>& overrides) {
    SceneSources sources;
    SceneErrors errors(sources);
    try {
        const SceneNode tree = build_scene_tree(text, scene, overrides, sources, errors);
        if (tree.kind != SceneNode::Kind::nothing) check_against_schema(tree, errors);
        errors.throw_if_any();
    } catch (const InputError& error) {
        return error.messages();
    }
    return {};
}

/// How the scene's reader begins a message about an override.
std::string prefix_of(const std::string& assignment) {
    SceneSources sources;
    const int source = sources.add_override(assignment);
    return sources.place({source, 1, 1}) + ": ";
}

/// Checks and completes the cases of a study; says what is wrong at the study's own lines.
class CaseCheck {
public:
    CaseCheck(const Study& study, std::string scene_text, SceneErrors& errors)
        : study_(study), errors_(errors), text_(std::move(scene_text)) {}

    void complete(PlannedCase& one) {
        if (study_.replicas.count > 0 && !add_replica(one)) return;
        try {
            const Scene scene = read_scene_text(text_, assignments(one.set), study_.scene);
            one.digest = digest_of(scene);
            one.resumable = scene.integrator == Integrator::implicit;
            one.steps = 0;
            for (const auto& stage : scene.loads.stages) one.steps += stage.steps;
        } catch (const InputError& error) {
            if (!agrees_with_schema(one)) return;
            one.refusal = error.messages().empty() ? error.what() : error.messages().front();
            one.digest = Digest().add(one.refusal).text();
        }
    }

    void throw_if_any() const {
        std::vector<std::string> messages = own_;
        try {
            errors_.throw_if_any();
        } catch (const InputError& error) {
            messages.insert(messages.begin(), error.messages().begin(), error.messages().end());
        }
        if (!messages.empty()) throw InputError(messages);
    }

private:
    bool agrees_with_schema(const PlannedCase& one) {
        const auto messages = schema_messages(text_, study_.scene, assignments(one.set));
        for (const auto& message : messages) say(one, message);
        return messages.empty();
    }

    void say(const PlannedCase& one, const std::string& message) {
        for (const auto& setting : one.set) {
            const std::string prefix = prefix_of(setting.assignment());
            if (!message.starts_with(prefix)) continue;
            const std::string what = message.substr(prefix.size());
            if (said_.insert(fmt::format("{} {} {}: {}", setting.at.source, setting.at.line, setting.at.column, what))
                    .second)
                errors_.add(setting.at, "", what);
            return;
        }
        if (said_.insert(message).second) own_.push_back(message);
    }

    bool add_replica(PlannedCase& one) {
        ReplicaNet net;
        try {
            net = net_of(read_scene_text(text_, assignments(one.set), study_.scene));
        } catch (const InputError&) {
            return true; // judged when it is read as a whole
        }
        const ReplicaPlan& plan = study_.replicas;
        if ((plan.offset || plan.rotation > 0.0) && !net.hexagons && !net.voronoi && !net.triangles) {
            if (said_.insert("no net").second)
                errors_.add(plan.at, "replicas",
                            "expected a scene with a tessellation for offset and rotation, found "
                            "none in case " +
                                one.name);
            return false;
        }
        const auto added = replica_settings(plan, one.replica, net);
        one.set.insert(one.set.end(), added.begin(), added.end());
        return true;
    }

    static ReplicaNet net_of(const Scene& scene) {
        ReplicaNet net;
        if (scene.geometry.tessellation) net.hexagons = scene.geometry.tessellation->hexagons;
        const SceneNode tree = tree_of(scene);
        const SceneNode* const geometry = tree.find("geometry");
        const SceneNode* const tessellation = geometry == nullptr ? nullptr : geometry->find("tessellation");
        net.voronoi = tessellation != nullptr && tessellation->find("voronoi") != nullptr;
        net.triangles = tessellation != nullptr && tessellation->find("triangles") != nullptr;
        return net;
    }

    const Study& study_;
    SceneErrors& errors_;
    std::string text_;
    std::vector<std::string> own_; ///< messages about the scene itself
    std::set<std::string> said_;
};

/// The parameter of the variant that sets the key after it was set; nullptr if none does.
const StudyParameter* parameter_that_sets(const StudyVariant& variant, const std::string& key, std::size_t from = 0) {
    for (std::size_t p = from; p < variant.vary.size(); ++p)
        for (const auto& value : variant.vary[p].values)
            if (sets_key(value, key)) return &variant.vary[p];
    return nullptr;
}

/// Several settings of one key hide each other.
void refuse_hidden(const Study& study, SceneErrors& errors) {
    const auto by = [](const StudyParameter& parameter, const std::string& key) {
        return parameter.key == key ? std::string{} : ", which " + in_quotes(parameter.key) + " sets too";
    };
    for (const auto& variant : study.variants) {
        const std::string place = variant.name.empty() ? "vary" : "variant " + variant.name;
        for (std::size_t p = 0; p < variant.vary.size(); ++p) {
            const std::string& key = variant.vary[p].key;
            const StudyParameter* const other = parameter_that_sets(variant, key, p + 1);
            if (other == nullptr) continue;
            errors.add(other->values.front().at, place,
                       other->key == key ? "expected keys that do not vary in the whole study, found " + in_quotes(key)
                                         : "expected keys that do not set each other's values, found " +
                                               in_quotes(key) + by(*other, key));
        }
        for (const auto& setting : variant.set)
            if (const auto* const parameter = parameter_that_sets(variant, setting.key))
                errors.add(setting.at, place,
                           "expected keys that do not vary, found " + in_quotes(setting.key) +
                               by(*parameter, setting.key));
    }
    // A value for those variants in which a key does not vary.
    for (const auto& setting : study.set)
        if (std::ranges::all_of(study.variants, [&](const auto& variant) {
                const auto* const parameter = parameter_that_sets(variant, setting.key);
                return parameter != nullptr && parameter->values.size() > 1;
            }))
            errors.add(setting.at, setting.at.source == 0 ? "set" : "",
                       "expected a key that does not vary, found " + in_quotes(setting.key));
}

double n_cases(const Study& study) {
    double n = 0.0;
    for (const auto& variant : study.variants) {
        double n_settings = 1.0;
        for (const auto& parameter : variant.vary) {
            n_settings *= static_cast<double>(parameter.values.size());
            if (study.together) break;
        }
        n += n_settings * std::max(study.replicas.count, 1);
    }
    return n;
}

void add_overrides(const std::vector<std::string>& overrides, SceneSources& sources, SceneErrors& errors,
                   Study& study) {
    for (const auto& assignment : overrides) {
        const TextPosition at{sources.add_override(assignment), 1, 1};
        const auto equals = assignment.find('=');
        if (equals == std::string::npos || equals == 0)
            errors.add(at, "", "expected key.path=value");
        else
            study.set.push_back({assignment.substr(0, equals), assignment.substr(equals + 1), at});
    }
}

/// What is wrong with the scene's file is said where the study names it.
std::string bytes_of_scene(const Study& study, const SceneNode& named, SceneErrors& errors) {
    try {
        return read_scene_bytes(study.scene);
    } catch (const InputError& error) {
        errors.add(named.at, "scene", error.what());
        errors.throw_if_any();
        throw;
    }
}

} // namespace

std::vector<std::string> assignments(const std::vector<StudySetting>& settings) {
    std::vector<std::string> all;
    for (const StudySetting& setting : settings) all.push_back(setting.assignment());
    return all;
}

bool sets_key(const StudySetting& setting, std::string_view key) {
    if (setting.key == key) return true;
    if (!key.starts_with(setting.key + '.')) return false;
    SceneSources sources;
    SceneErrors errors(sources); // what is wrong with the value is said where the scene is read
    const SceneNode value = parse_scene_tree(setting.value, 0, {0, 1, 1}, errors);
    const SceneNode* node = &value;
    std::string_view rest = key.substr(setting.key.size() + 1);
    while (!rest.empty()) {
        const SceneNode* const child = child_of(*node, rest.substr(0, rest.find('.')));
        if (child == nullptr) return !node->is_mapping(); // mappings merge, everything else takes the place of what was
        node = child;
        rest = rest.find('.') == std::string_view::npos ? "" : rest.substr(rest.find('.') + 1);
    }
    return true;
}

std::string scene_digest(const fs::path& scene, const std::vector<std::string>& overrides) {
    return digest_of(read_scene(scene, overrides));
}

ReadStudy read_study(const fs::path& file, const std::vector<std::string>& overrides) {
    return read_study_text(read_scene_bytes(file, "a study file"), overrides, file);
}

ReadStudy read_study_text(std::string_view text, const std::vector<std::string>& overrides, const fs::path& file) {
    SceneSources sources;
    SceneErrors errors(sources);
    const int source = sources.add_file(file, text);
    const SceneNode root = parse_scene_tree(text, source, {source, 1, 1}, errors);
    errors.throw_if_any();
    ReadStudy result;
    result.study = StudyReader(root, file, errors).read();
    Study& study = result.study;
    add_overrides(overrides, sources, errors, study);
    refuse_hidden(study, errors);
    if (n_cases(study) > static_cast<double>(most_cases))
        errors.add(root.at, "", fmt::format("expected at most {} cases, found {:g}", most_cases, n_cases(study)));
    errors.throw_if_any();
    result.cases = planned_cases(study);
    study.own_settings = own_settings(study);
    CaseCheck check(study, bytes_of_scene(study, *root.find("scene"), errors), errors);
    for (auto& one : result.cases) check.complete(one);
    check.throw_if_any();
    if (std::ranges::none_of(result.cases, [](const PlannedCase& one) { return one.refusal.empty(); }))
        throw InputError("no case can be run; the first one: " + result.cases.front().refusal);
    return result;
}

} // namespace kluft
