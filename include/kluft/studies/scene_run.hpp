// A run of a scene that leaves its results in a directory: what the program and the Python package share.
#pragma once

#include <atomic>
#include <filesystem>
#include <string>

#include "kluft/output/run_writer.hpp"
#include "kluft/output/summary.hpp"
#include "kluft/scene/scene.hpp"
#include "kluft/scene/scene_model.hpp"
#include "kluft/simulation/bond_bending.hpp"
#include "kluft/simulation/corner_contact.hpp"
#include "kluft/simulation/left_platen.hpp"
#include "kluft/simulation/model.hpp"
#include "kluft/simulation/overloaded_bonds.hpp"
#include "kluft/simulation/overloaded_corners.hpp"
#include "kluft/simulation/run_report.hpp"
#include "kluft/simulation/state.hpp"
#include "kluft/simulation/step_observer.hpp"

namespace kluft {

/// What the scene says of the files that its run writes.
[[nodiscard]] RunWriterOptions run_writer_options(const Scene& scene, const Model& model);

/// Content of the scene.yaml to be written; "" where the directory has one of the user's own, which stays. Throws InputError where the
/// directory has results of another scene, unless they may be replaced.
[[nodiscard]] std::string scene_file_for(const std::filesystem::path& directory, const Scene& scene, bool may_replace);

/// The last state in the directory, from which a run of the scene goes on. Throws InputError as read_state does; where the state
/// is of another scene, with the first key that differs and those that may.
[[nodiscard]] State state_to_resume(const std::filesystem::path& directory, const Scene& scene,
                                    const std::string& fingerprint);

/// What a resumed run takes over from those before it.
struct EarlierRuns {
    double cpu_s = 0.0; ///< their processor time (s), as far as they said it
    std::vector<std::string> warnings;
};

/// From the summary of the last one, without the warnings of its scene; one that was killed has left none, which is a warning of its own
/// (its state has the warnings of its load steps, but not those of a ContactWatch).
[[nodiscard]] EarlierRuns earlier_runs(const std::filesystem::path& directory);

/// The body of a scene, with what there is to warn of before it is run.
[[nodiscard]] SceneModel build_for_run(const Scene& scene);

/// Runs the stages from `state` on with the integrator of the scene, as run_simulation and run_explicit do.
RunReport run_stages(const Model& model, const Scene& scene, State& state, StepObserver& observer,
                     const std::atomic<bool>& stop);

/// What the warnings at the end of a run need to know of its load steps. The model must outlive it.
class ContactWatch {
public:
    ContactWatch(const Model& model, CrackCriterion criterion)
        : corners_(model), bonds_(model, criterion), bending_(model), platens_(model), tips_(model) {}

    /// A committed load step.
    void step(const StepRecord& record, const State& state);

    /// Measured on the boundaries (Pa).
    [[nodiscard]] double largest_stress() const { return largest_stress_; }
    [[nodiscard]] const CornerWatch& corners() const { return corners_; }
    [[nodiscard]] const BondWatch& bonds() const { return bonds_; }
    [[nodiscard]] const BendingWatch& bending() const { return bending_; }
    [[nodiscard]] const PlatenWatch& platens() const { return platens_; }
    [[nodiscard]] const TipWatch& tips() const { return tips_; }

private:
    CornerWatch corners_;
    BondWatch bonds_;
    BendingWatch bending_;
    PlatenWatch platens_;
    TipWatch tips_;
    double largest_stress_ = 0.0;
};

/// Adds warnings of contacts that are pressed far more than the loads apply or than rock bears, of bonds that carry more than
/// they bear, and of platens that have left the body; of a run that is to go on, those of what it has gone through, not those of the state that it ends with. Where memory has
/// run out, what was run is all that counts.
void warn_of_contacts(const Model& model, const State& state, const ContactWatch& watch, RunReport& report);

/// Puts the warnings of the scene, of its body and of the runs before it, each text once, before those of the run, as the summary has
/// them.
void add_earlier_warnings(const Scene& scene, const Model& model, const EarlierRuns& earlier, RunReport& report);

/// What a run has come to, in one line.
[[nodiscard]] std::string closing_line(const RunReport& report, const RunSummary& summary,
                                       const std::filesystem::path& directory);

} // namespace kluft
