// report.html: a run as one page that can be handed on.
#pragma once

#include <filesystem>
#include <string>

#include "kluft/blocks/block_cutter.hpp"
#include "kluft/report/run_answer.hpp"
#include "kluft/scene/scene.hpp"
#include "kluft/simulation/model.hpp"

namespace kluft {

struct RunPageOptions {
    std::size_t most_bytes_of_states = 16'500'000; ///< before compression; of more states some are left out
};

/// The page of a run: its answer with all that lies against it, the curve and the body at the states that are kept, histories,
/// cracks, the scene and the log. Of states that together are too large every second, third ... one is in it, and those of
/// the first, the peak and the last load step. Throws InputError where files of the directory are missing, damaged or of another
/// model.
[[nodiscard]] std::string run_page(const std::filesystem::path& directory, const Scene& scene, const Model& model,
                                   const CutReport& cut, const RunPageOptions& options = {});

/// Writes report.html into the directory. Throws InputError as run_page does, ResourceError.
void write_run_page(const std::filesystem::path& directory, const Scene& scene, const Model& model,
                    const CutReport& cut);

/// The page of a run of which there is its directory only, into a file: the scene is that saved with its last state.
void write_run_page(const std::filesystem::path& directory, const std::filesystem::path& file);

} // namespace kluft
