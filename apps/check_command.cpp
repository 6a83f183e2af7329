// kluft check SCENE
#include "commands.hpp"
#include "kluft/scene/scene_account.hpp"
#include "kluft/scene/scene_model.hpp"
#include "kluft/scene/scene_reader.hpp"
#include "standard_output.hpp"

namespace kluft {

ExitCode check(const CheckArguments& arguments) {
    const Scene scene = read_scene(arguments.scene, arguments.overrides);
    say_text(text_of(account_of(scene, build_scene_model(scene))));
    return ExitCode::done;
}

} // namespace kluft
