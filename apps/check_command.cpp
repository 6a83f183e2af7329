// kluft check SCENE
#include "commands.hpp"
#include "kluft/scene/scene_account.hpp"
#include "kluft/scene/scene_model.hpp"
#include "kluft/scene/scene_reader.hpp"
#include "standard_output.hpp"

namespace kluft {

ExitCode check(const CheckArguments& arguments) {
    const Scene scene = read_scene(arguments.scene, arguments.overrides);
    const SceneModel built = build_scene_model(scene);
    const SceneAccount account = account_of(scene, built);
    say_text(arguments.json ? json_of(account, scene, built) : text_of(account));
    return ExitCode::done;
}

} // namespace kluft
