// report.html: a run as one page that can be handed on.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "kluft/blocks/block_cutter.hpp"
#include "kluft/report/run_answer.hpp"
#include "kluft/scene/scene.hpp"
#include "kluft/simulation/model.hpp"

namespace kluft {

struct RunPageOptions {
    std::size_t most_bytes_of_states = 16'500'000; ///< before compression; of more states some are left out
    bool leaves_out_damaged_states = false;        ///< and warns of them, in place of an error
};

struct RunPage {
    std::string html;
    std::vector<std::string> warnings; ///< of states that are left out, with what is wrong with their files
};

/// The page of a run: its answer with all that lies against it, the curve and the body at the states that are kept, histories,
/// cracks, the scene and the log. Of states that together are too large every second, third ... one is in it, and those of
/// the first, the peak and the last load step. Throws InputError where files of the directory are missing, damaged or of another
/// model.
[[nodiscard]] RunPage run_page(const std::filesystem::path& directory, const Scene& scene, const Model& model,
                               const CutReport& cut, const RunPageOptions& options = {});

/// Writes report.html of a run that has just ended into its directory, whatever an earlier part of it has left there: returns warnings
/// of damaged states, which are left out. Throws InputError as run_page does, ResourceError.
[[nodiscard]] std::vector<std::string> write_run_page(const std::filesystem::path& directory, const Scene& scene,
                                                      const Model& model, const CutReport& cut);

/// The page of a run of which there is its directory only, into a file: the scene is that saved with its last state.
void write_run_page(const std::filesystem::path& directory, const std::filesystem::path& file);

} // namespace kluft
