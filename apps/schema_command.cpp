// kluft schema
#include "commands.hpp"
#include "kluft/scene/scene_reference.hpp"
#include "standard_output.hpp"

namespace kluft {

ExitCode schema() {
    say_text(scene_json_schema());
    return ExitCode::done;
}

} // namespace kluft
