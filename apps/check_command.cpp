// kluft check SCENE
#include <string>

#include <nlohmann/json.hpp>

#include "commands.hpp"
#include "kluft/core/diagnostics.hpp"
#include "kluft/scene/scene_account.hpp"
#include "kluft/scene/scene_model.hpp"
#include "kluft/scene/scene_reader.hpp"
#include "kluft/studies/scene_run.hpp"
#include "standard_output.hpp"

namespace kluft {

namespace {

/// {"problems": [{"message", "path", "file", "line", "column"}]}; what is not known is null.
std::string json_of(const InputError& error) {
    nlohmann::ordered_json json{{"problems", nlohmann::ordered_json::array()}};
    for (const InputProblem& each : error.problems()) {
        const auto known = [](const auto& value, bool is_known) {
            return is_known ? nlohmann::ordered_json(value) : nlohmann::ordered_json(nullptr);
        };
        json["problems"].push_back({{"message", each.message},
                                    {"path", known(each.path, !each.path.empty())},
                                    {"file", known(each.file, !each.file.empty())},
                                    {"line", known(each.line, each.line > 0)},
                                    {"column", known(each.column, each.column > 0)}});
    }
    return json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
}

void check_scene(const CheckArguments& arguments) {
    const Scene scene = read_scene(arguments.scene, arguments.overrides);
    const SceneModel built = build_for_run(scene);
    const SceneAccount account = account_of(scene, built);
    say_text(arguments.json ? json_of(account, scene, built) : text_of(account));
}

} // namespace

ExitCode check(const CheckArguments& arguments) {
    try {
        check_scene(arguments);
    } catch (const InputError& error) {
        if (arguments.json) say_text(json_of(error));
        throw;
    }
    return ExitCode::done;
}

} // namespace kluft
