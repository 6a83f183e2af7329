// kluft schema
#include <string>

#include "calibrator.hpp"
#include "commands.hpp"
#include "kluft/scene/json_schema.hpp"
#include "kluft/scene/scene_schema.hpp"
#include "kluft/studies/study_schema.hpp"
#include "standard_output.hpp"

namespace kluft {

ExitCode schema(const std::string& of) {
    if (of == "calibration") become_calibrator({"schema"});
    say_text(of == "study" ? json_schema(study_schema(), "Kluft study", Extending::never)
                           : json_schema(scene_schema(), "Kluft scene", Extending::possible));
    return ExitCode::done;
}

} // namespace kluft
