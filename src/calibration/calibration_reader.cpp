#include <algorithm>
#include <optional>
#include <set>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "kluft/calibration/calibration.hpp"
#include "kluft/core/diagnostics.hpp"
#include "kluft/core/nearest_name.hpp"
#include "kluft/output/history_table.hpp"
#include "kluft/scene/scene_check.hpp"
#include "kluft/scene/scene_reader.hpp"
#include "kluft/scene/scene_schema.hpp"
#include "kluft/scene/scene_text.hpp"
#include "kluft/scene/scene_writer.hpp"
#include "kluft/studies/comparison.hpp"

namespace kluft {

namespace {

namespace fs = std::filesystem;

constexpr int default_evaluations = 40;

const KeyRule& rule_at(const std::string& pattern) { return *calibration_schema().find(pattern); }

std::vector<std::string> parts_of(const std::string& path) {
    std::vector<std::string> parts;
    for (std::size_t from = 0;;) {
        const std::size_t dot = path.find('.', from);
        parts.push_back(path.substr(from, dot - from));
        if (dot == std::string::npos) return parts;
        from = dot + 1;
    }
}

/// The merged tree of a scene; nothing where it cannot be read, of which the scene's own reader tells.
std::optional<SceneNode> tree_of_scene(const fs::path& scene) {
    SceneSources sources;
    SceneErrors errors(sources);
    try {
        SceneNode tree = build_scene_tree(read_scene_bytes(scene), scene, {}, sources, errors);
        return errors.empty() ? std::optional(std::move(tree)) : std::nullopt;
    } catch (const InputError&) {
        return std::nullopt;
    }
}

/// How the scene's reader begins a message about an override.
std::string message_prefix(const StudySetting& setting) {
    SceneSources sources;
    const int source = sources.add_override(setting.assignment());
    return sources.place({source, 1, 1}) + ": ";
}

/// Reads the keys of a calibration one after the other; what is wrong goes to `errors`.
class CalibrationReader {
public:
    CalibrationReader(const SceneNode& root, const fs::path& file, SceneErrors& errors)
        : root_(root), file_(file), errors_(errors) {}

    Calibration read() {
        result_.name = file_.stem().string();
        result_.file = fs::absolute(file_).lexically_normal();
        if (!root_.is_mapping()) {
            errors_.add(root_.at, "",
                        "expected a mapping that begins with kluft_calibration: 1, found " + found_text(root_));
            return std::move(result_);
        }
        check_keys(root_, "", "");
        (void)checked(root_, "kluft_calibration", "", "");
        if (const SceneNode* title = checked(root_, "title", "", "")) result_.title = title->text;
        if (const SceneNode* scene = checked(root_, "scene", "", "")) result_.scene = file_named(*scene, "scene");
        if (!result_.scene.empty()) tree_ = tree_of_scene(result_.scene);
        read_parameters();
        read_targets();
        read_replicas();
        return std::move(result_);
    }

private:
    void check_keys(const SceneNode& node, const std::string& pattern, const std::string& path) {
        const auto known = calibration_schema().child_keys(pattern);
        for (const auto& key : node.keys) {
            if (std::ranges::find(known, key.text) != known.end()) continue;
            errors_.add(key.at, joined_path(path, key.text),
                        fmt::format("unknown key; expected one of {}, found {}{}", listed(known), in_quotes(key.text),
                                    suggestion(key.text, known)));
        }
    }

    /// The value of a key that takes a number, an integer or a text, if it is what the schema asks for.
    const SceneNode* checked(const SceneNode& node, const std::string& key, const std::string& pattern,
                             const std::string& path) {
        const KeyRule& rule = rule_at(joined_path(pattern, key));
        const SceneNode* value = node.find(key);
        const std::string place = joined_path(path, key);
        if (value == nullptr) {
            if (rule.required)
                errors_.add(node.at, place, "expected " + calibration_schema().expected_text(rule) + ", found nothing");
            return nullptr;
        }
        const std::string problem = scalar_problem(*value, rule);
        if (problem.empty()) return value;
        errors_.add(value->at, place, "expected " + calibration_schema().expected_text(rule) + ", found " + problem);
        return nullptr;
    }

    /// A number of the measure that another key's rule has.
    std::optional<double> number_of(const SceneNode& node, const std::string& key, const std::string& pattern,
                                    const std::string& path, Measure measure) {
        KeyRule rule = rule_at(joined_path(pattern, key));
        rule.measure = measure;
        const SceneNode* value = node.find(key);
        const std::string place = joined_path(path, key);
        const std::string problem = value == nullptr ? "nothing" : scalar_problem(*value, rule);
        if (problem.empty()) return read_quantity(value->text, measure).value;
        if (value != nullptr || rule.required)
            errors_.add(value == nullptr ? node.at : value->at, place,
                        "expected " + calibration_schema().expected_text(rule) + ", found " + problem);
        return std::nullopt;
    }

    fs::path file_named(const SceneNode& node, const std::string& path) {
        fs::path named = fs::absolute(file_.parent_path() / node.text).lexically_normal();
        std::error_code error;
        if (fs::is_regular_file(named, error)) return named;
        const bool is_directory = fs::is_directory(named, error);
        errors_.add(node.at, path,
                    fmt::format("expected a file, found {}, which is {}", in_quotes(node.text),
                                is_directory ? "a directory" : "no file" + nearest_file(named)));
        return {};
    }

    static std::string nearest_file(const fs::path& missing) {
        std::vector<std::string> names;
        std::error_code error;
        for (fs::directory_iterator entry(missing.parent_path(), error), end; !error && entry != end;
             entry.increment(error))
            names.push_back(entry->path().filename().string());
        std::ranges::sort(names);
        return suggestion(missing.filename().string(), names);
    }

    // ---- parameters --------------------------------------------------------------------------------------------

    void read_parameters() {
        const SceneNode* node = root_.find("parameters");
        if (node == nullptr || !node->is_mapping() || node->items.empty()) {
            errors_.add(node == nullptr ? root_.at : node->at, "parameters",
                        "expected names with {keys: [...], start: ..., from: ..., to: ...}, found " +
                            (node == nullptr ? "nothing" : found_text(*node)));
            return;
        }
        for (std::size_t i = 0; i < node->items.size(); ++i)
            read_parameter(node->items[i], node->keys[i].text, joined_path("parameters", node->keys[i].text));
    }

    void read_parameter(const SceneNode& node, const std::string& name, const std::string& path) {
        if (!node.is_mapping())
            return errors_.add(node.at, path,
                               "expected {keys: [...], start: ..., from: ..., to: ...}, found " + found_text(node));
        check_keys(node, "parameters.*", path);
        CalibrationParameter parameter;
        parameter.name = name;
        const auto measure = read_parameter_keys(node, path, parameter);
        if (!measure) return;
        parameter.measure = *measure;
        const auto start = number_of(node, "start", "parameters.*", path, *measure);
        const auto from = number_of(node, "from", "parameters.*", path, *measure);
        const auto to = number_of(node, "to", "parameters.*", path, *measure);
        if (!start || !from || !to) return;
        if (!(*from < *to)) return errors_.add(node.at, path, "expected from < to, found the contrary");
        if (*start < *from || *start > *to)
            return errors_.add(node.find("start")->at, joined_path(path, "start"),
                               fmt::format("expected a value from {} to {}, found {}", value_text(*from, *measure),
                                           value_text(*to, *measure), found_text(*node.find("start"))));
        require_reachable("from", *from, node, path, parameter);
        require_reachable("to", *to, node, path, parameter);
        parameter.start = *start;
        parameter.from = *from;
        parameter.to = *to;
        result_.parameters.push_back(std::move(parameter));
    }

    /// A bound that a key of the scene does not take could be where the search ends.
    void require_reachable(const std::string& bound, double value, const SceneNode& node, const std::string& path,
                           const CalibrationParameter& parameter) {
        const SceneNode& found = *node.find(bound);
        for (const ParameterKey& key : parameter.keys) {
            const KeyRule& rule = *known_rule(key, path);
            SceneNode of_key;
            of_key.kind = SceneNode::Kind::scalar;
            of_key.text = plain_text(key.times * value, parameter.measure);
            if (scalar_problem(of_key, rule).empty()) continue;
            return errors_.add(found.at, joined_path(path, bound),
                               fmt::format("expected {} for {}, found {}{}", scene_schema().expected_text(rule),
                                           in_quotes(key.key), found_text(found),
                                           key.times == 1.0 ? "" : fmt::format(", times {:g}", key.times)));
        }
    }

    /// What the keys measure; nothing if they are wrong.
    std::optional<Measure> read_parameter_keys(const SceneNode& node, const std::string& path,
                                               CalibrationParameter& parameter) {
        const SceneNode* list = node.find("keys");
        const std::string place = joined_path(path, "keys");
        if (list == nullptr || !list->is_list() || list->items.empty()) {
            errors_.add(list == nullptr ? node.at : list->at, place,
                        "expected a list of keys of the scene, found " +
                            (list == nullptr ? "nothing" : found_text(*list)));
            return std::nullopt;
        }
        std::optional<Measure> measure;
        bool is_sound = true;
        for (const SceneNode& item : list->items) {
            const auto found = read_parameter_key(item, place, parameter);
            is_sound = is_sound && found;
            if (measure && found && *found != *measure) {
                errors_.add(item.at, place, "expected keys of one measure, found others");
                is_sound = false;
            }
            if (!measure) measure = found;
        }
        return is_sound ? measure : std::nullopt;
    }

    std::optional<Measure> read_parameter_key(const SceneNode& item, const std::string& path,
                                              CalibrationParameter& parameter) {
        ParameterKey key{item.text, 1.0, item.at};
        if (item.is_mapping()) {
            const std::string pattern = "parameters.*.keys.#";
            check_keys(item, pattern, path);
            const SceneNode* name = checked(item, "key", pattern, path);
            if (name == nullptr) return std::nullopt;
            key.key = name->text;
            key.at = name->at;
            key.times = number_of(item, "times", pattern, path, Measure::fraction).value_or(1.0);
        } else if (!item.is_scalar()) {
            errors_.add(item.at, path,
                        "expected a key of the scene or {key: ..., times: ...}, found " + found_text(item));
            return std::nullopt;
        }
        if (!used_keys_.insert(key.key).second) {
            errors_.add(key.at, path, "expected each key of the scene once, found " + in_quotes(key.key) + " again");
            return std::nullopt;
        }
        const KeyRule* rule = known_rule(key, path);
        if (rule == nullptr) return std::nullopt;
        parameter.keys.push_back(key);
        return rule->measure;
    }

    /// The scene's rule of a key that takes a number; null (and an error) for another one.
    const KeyRule* known_rule(const ParameterKey& key, const std::string& path) {
        std::string pattern;
        const SceneNode* node = tree_ ? &*tree_ : nullptr;
        for (const std::string& part : parts_of(key.key)) {
            const std::string below = scene_schema().child_pattern(pattern, part);
            if (below.empty()) {
                const auto known = scene_schema().child_keys(pattern);
                errors_.add(key.at, path,
                            fmt::format("expected a key of the scene, found {}, in which {} is unknown; expected one "
                                        "of {}{}",
                                        in_quotes(key.key), in_quotes(part), listed(known), suggestion(part, known)));
                return nullptr;
            }
            if (below.ends_with("*") && node != nullptr && node->find(part) == nullptr) {
                std::vector<std::string> names;
                for (const auto& each : node->keys) names.push_back(each.text);
                errors_.add(key.at, path,
                            fmt::format("expected one of {} of the scene, found {} in {}{}", listed(names),
                                        in_quotes(part), in_quotes(key.key), suggestion(part, names)));
                return nullptr;
            }
            node = child_of(node, part);
            pattern = below;
        }
        const KeyRule* rule = scene_schema().find(pattern);
        if (rule != nullptr && rule->type == KeyType::number) return rule;
        errors_.add(key.at, path, "expected a key of the scene that takes a number, found " + in_quotes(key.key));
        return nullptr;
    }

    static const SceneNode* child_of(const SceneNode* node, const std::string& part) {
        if (node == nullptr || !node->is_list()) return node == nullptr ? nullptr : node->find(part);
        const auto index = read_integer(part);
        const bool is_there = index && *index >= 0 && *index < static_cast<long long>(node->items.size());
        return is_there ? &node->items[static_cast<std::size_t>(*index)] : nullptr;
    }

    // ---- targets -----------------------------------------------------------------------------------------------

    void read_targets() {
        const SceneNode* node = root_.find("targets");
        if (node == nullptr || !node->is_mapping() || node->items.empty()) {
            errors_.add(node == nullptr ? root_.at : node->at, "targets",
                        "expected a mapping of " + listed(calibration_schema().child_keys("targets")) + ", found " +
                            (node == nullptr ? "nothing" : found_text(*node)));
            return;
        }
        check_keys(*node, "targets", "targets");
        for (int q = 0; q <= static_cast<int>(TargetQuantity::curve); ++q)
            if (const SceneNode* of_name = node->find(quantity_name(static_cast<TargetQuantity>(q))))
                read_targets_of(static_cast<TargetQuantity>(q), *of_name);
    }

    void read_targets_of(TargetQuantity quantity, const SceneNode& node) {
        const std::string pattern = fmt::format("targets.{}", quantity_name(quantity));
        if (!node.is_list()) return read_target(quantity, node, pattern, pattern, std::string(quantity_name(quantity)));
        if (node.items.empty())
            errors_.add(node.at, pattern,
                        "expected {value: ..., tolerance: ...} or a list of such, found an empty list");
        for (std::size_t i = 0; i < node.items.size(); ++i)
            read_target(quantity, node.items[i], pattern, fmt::format("{}.{}", pattern, i),
                        fmt::format("{} {}", quantity_name(quantity), i + 1));
    }

    void read_target(TargetQuantity quantity, const SceneNode& node, const std::string& pattern,
                     const std::string& path, const std::string& name) {
        if (!node.is_mapping())
            return errors_.add(node.at, path, "expected {value: ..., tolerance: ...}, found " + found_text(node));
        check_keys(node, pattern, path);
        CalibrationTarget target;
        target.quantity = quantity;
        target.name = name;
        target.at = node.at;
        target.scene = result_.scene;
        if (quantity == TargetQuantity::curve)
            read_curve(node, pattern, path, target);
        else
            target.value = number_of(node, "value", pattern, path, measure_of(quantity)).value_or(1.0);
        target.tolerance = number_of(node, "tolerance", pattern, path, Measure::fraction).value_or(1.0);
        target.weight = number_of(node, "weight", pattern, path, Measure::fraction).value_or(1.0);
        if (const SceneNode* scene = checked(node, "scene", pattern, path))
            target.scene = file_named(*scene, joined_path(path, "scene"));
        if (const SceneNode* set = node.find("set")) read_settings(*set, joined_path(path, "set"), target);
        if (is_of_envelope(quantity)) read_pressures(node, path, target);
        result_.targets.push_back(std::move(target));
    }

    void read_settings(const SceneNode& set, const std::string& path, CalibrationTarget& target) {
        if (!set.is_mapping())
            return errors_.add(set.at, path, "expected a mapping of keys of the scene, found " + found_text(set));
        for (std::size_t i = 0; i < set.items.size(); ++i) {
            target.set.push_back({set.keys[i].text, write_scene_value(set.items[i]), set.items[i].at});
            const auto moved = std::ranges::find_if(
                used_keys_, [&](const std::string& key) { return sets_key(target.set.back(), key); });
            if (moved != used_keys_.end())
                errors_.add(set.keys[i].at, path, "expected keys that no parameter moves, found " + in_quotes(*moved));
        }
    }

    void read_pressures(const SceneNode& node, const std::string& path, CalibrationTarget& target) {
        const SceneNode* list = node.find("pressures");
        const std::string place = joined_path(path, "pressures");
        std::set<double> different;
        if (list != nullptr && list->is_list()) {
            const KeyRule rule{.path = "pressures", .type = KeyType::number, .measure = Measure::stress};
            for (const SceneNode& item : list->items) {
                const std::string problem = scalar_problem(item, rule);
                if (!problem.empty())
                    errors_.add(item.at, place,
                                "expected " + calibration_schema().expected_text(rule) + ", found " + problem);
                else if (*read_quantity(item.text, Measure::stress).value < 0.0)
                    errors_.add(item.at, place, "expected a lateral pressure >= 0, found " + in_quotes(item.text));
                else if (different.insert(*read_quantity(item.text, Measure::stress).value).second)
                    target.pressures.push_back(item.text);
            }
        }
        if (different.size() < 2)
            errors_.add(list == nullptr ? node.at : list->at, place,
                        "expected at least two different pressures, as [0 MPa, 1 MPa, 5 MPa], found " +
                            (list == nullptr ? "nothing" : found_text(*list)));
    }

    void read_curve(const SceneNode& node, const std::string& pattern, const std::string& path,
                    CalibrationTarget& target) {
        const SceneNode* name = checked(node, "file", pattern, path);
        if (name == nullptr) return;
        const fs::path file = file_named(*name, joined_path(path, "file"));
        if (file.empty()) return;
        try {
            target.curve = growing_curve(read_history(file, {"axial_strain", "differential_stress"}));
        } catch (const InputError& error) {
            return errors_.add(name->at, joined_path(path, "file"), error.what());
        }
        if (target.curve.size() < 2)
            return errors_.add(name->at, joined_path(path, "file"),
                               "expected a curve of at least two points with growing axial_strain, found fewer");
        if (std::ranges::none_of(target.curve, [](const Vec2& point) { return point.y() > 0.0; }))
            errors_.add(name->at, joined_path(path, "file"),
                        "expected a curve with a differential_stress above zero, positive in compression, found none");
    }

    void read_replicas() {
        result_.most_evaluations = default_evaluations;
        result_.replicas.offset = true;
        if (const SceneNode* count = checked(root_, "replicas", "", "")) {
            result_.replicas.count = static_cast<int>(*read_integer(count->text));
            result_.replicas.at = count->at;
        }
        if (const SceneNode* most = checked(root_, "evaluations", "", ""))
            result_.most_evaluations = static_cast<int>(*read_integer(most->text));
    }

    const SceneNode& root_;
    const fs::path& file_;
    SceneErrors& errors_;
    Calibration result_;
    std::optional<SceneNode> tree_; ///< of the scene
    std::set<std::string> used_keys_;
};

/// Reads the scene of each target with the starts and its own settings; what is wrong with those is told at their place in
/// the calibration, what is wrong with a scene as its own reader does.
class StartCheck {
public:
    StartCheck(const Calibration& calibration, SceneErrors& errors)
        : errors_(errors), at_start_(settings_at(calibration, start_of(calibration))) {
        for (const CalibrationTarget& target : calibration.targets) check(target);
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
    void check(const CalibrationTarget& target) {
        std::vector<StudySetting> settings = at_start_;
        settings.insert(settings.end(), target.set.begin(), target.set.end());
        try {
            const Scene scene = read_scene(target.scene, assignments(settings));
            const bool presses = !scene.loads.stages.empty() && !scene.loads.stages.front().pressure.empty();
            if (is_of_envelope(target.quantity) && !presses)
                errors_.add(target.at, "targets." + target.name,
                            "expected a scene whose stage 0 presses boundaries, which get the lateral pressures; found "
                            "no pressure there");
        } catch (const InputError& error) {
            for (const std::string& message : error.messages()) say(settings, message);
        }
    }

    void say(const std::vector<StudySetting>& settings, const std::string& message) {
        if (!said_.insert(message).second) return;
        for (const StudySetting& setting : settings) {
            const std::string prefix = message_prefix(setting);
            if (message.starts_with(prefix)) return errors_.add(setting.at, "", message.substr(prefix.size()));
        }
        own_.push_back(message);
    }

    SceneErrors& errors_;
    std::vector<StudySetting> at_start_;
    std::vector<std::string> own_; ///< messages about the scenes themselves
    std::set<std::string> said_;
};

} // namespace

Calibration read_calibration(const fs::path& file) {
    return read_calibration_text(read_scene_bytes(file, "a calibration file"), file);
}

Calibration read_calibration_text(std::string_view text, const fs::path& file) {
    SceneSources sources;
    SceneErrors errors(sources);
    const int source = sources.add_file(file, text);
    const SceneNode root = parse_scene_tree(text, source, {source, 1, 1}, errors);
    errors.throw_if_any();
    Calibration calibration = CalibrationReader(root, file, errors).read();
    errors.throw_if_any();
    StartCheck(calibration, errors).throw_if_any();
    return calibration;
}

} // namespace kluft
