// Everything that a run leaves in its directory.
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "kluft/blocks/block_system.hpp"
#include "kluft/constitutive/material.hpp"
#include "kluft/output/kept_states.hpp"
#include "kluft/output/summary.hpp"
#include "kluft/simulation/run_report.hpp"
#include "kluft/simulation/step_observer.hpp"

namespace kluft {

struct RunWriterOptions {
    bool fields = true;              ///< fields.pvd, fields/*.vtu, contacts/*.csv and supports/*.csv
    int fields_every = 0;            ///< load steps between two of them (kept_states.hpp); 0: none for that reason
    int fields_at_cracks = 10;       ///< the most of them for cracks that failed
    bool pictures = true;            ///< curve, blocks and histories, each .png and .svg
    int checkpoint_every = 0;        ///< load steps between two state.h5; 0: at the end of each stage and of the run
    double checkpoint_seconds = 0.0; ///< after so much time by the clock a state is saved too; 0: not for that reason
    std::string title;
    std::string fingerprint;         ///< of the scene, kept in state.h5
    std::string scene_text;          ///< kept in state.h5 too, so that the run can be drawn again
    std::string scene_file;          ///< content of scene.yaml; empty: that file stays as it is
    std::optional<int> resumed_step; ///< load step of the saved state that the run goes on from; none: a new run
    std::optional<int> platen_stage; ///< the first stage that moves a platen
    Plane plane = Plane::strain;
    std::optional<double> compliance_across; ///< of the model
    double modulus = 0.0;                    ///< Young's, of the stiffest material (Pa)
    bool has_elastic_constants = true;       ///< else the summary has none
    std::string elastic_constants_warning;   ///< of the summary, where they could be computed
    std::vector<std::string> material_names;
    std::vector<std::string> interface_type_names;
    std::vector<std::string> fracture_names;  ///< mapped ones
    std::vector<std::string> law_names;       ///< the interface of each law of the model
    bool strength_factor = false;             ///< the rows have that column
    bool motion = false;                      ///< the rows have the columns of an explicit run
    std::vector<std::string> history_columns; ///< of StepRecord::histories; without any there is no histories.csv
};

/// How a run ended and what it cost.
struct RunOutcome {
    RunReport report;
    int unknowns = 0;
    double cpu_s = 0.0; ///< processor time, also of the runs that it goes on from
    std::string version;
    std::string blas_core; ///< as in the summary
};

/// Writes history.csv, equilibria.csv, cracks.csv, jumps.csv and histories.csv load step by load step, field files, state.h5
/// at checkpoints, and at the end summary.json and the pictures. The tables hold whole rows at any moment, every other file
/// appears whole. No state is saved before all rows of its load step are on the disk.
///
/// A new run first removes what an earlier one left in the directory (run.log and scene.yaml excepted), so that results
/// never mix; foreign files stay. Then it writes scene.yaml, before its tables: results without it are of earlier versions.
/// A resumed run keeps the rows and field files up to the saved step and goes on from there.
class RunWriter : public StepObserver {
public:
    /// `system` must outlive the writer. Throws ResourceError; InputError when the tables of a run to resume are
    /// missing, or are not up to the saved step what they were when it was saved.
    RunWriter(std::filesystem::path directory, const BlockSystem& system, RunWriterOptions options);
    ~RunWriter() override;

    /// These rows wait for the load step that they belong to.
    void equilibrium(const StepRecord& record) override;
    void crack(const CrackRecord& crack) override;
    void jump(const JumpRecord& jump) override;
    /// Throws ResourceError; what could not be written then is written by `checkpoint`, if there is room.
    void step(const StepRecord& record, const State& state, const std::function<FieldRecord()>& fields,
              bool last_of_stage) override;

    /// Saves a committed state, after the rows that belong to it. Throws ResourceError.
    void checkpoint(const State& state);

    /// Ends the run, however it ended: last state, field files of the last step, summary, pictures. `fields` computes
    /// the fields of `state` for pictures where no load step was told: contacts that are detected anew are not those that
    /// balanced it. Tries everything, also after a part failed; then gives up and throws the first ResourceError.
    RunSummary finish(const RunOutcome& outcome, const State& state, const std::function<FieldRecord()>& fields);

    /// Makes the summary say that disk or memory ran out at the end, and why.
    void give_up(RunSummary summary, const std::string& why) const;

private:
    struct Tables;
    struct HeldState {
        StepRecord record;
        FieldRecord fields;
    };
    using Clock = std::chrono::steady_clock;

    /// Whether the tables of a resumed run have the row already.
    [[nodiscard]] bool is_known(const StepRecord& record) const;
    void write_scene_file() const;
    void write_pictures(const RunSummary& summary, const std::vector<StepRecord>& history,
                        const std::vector<StepRecord>& equilibria, const FieldRecord& fields) const;
    void write_fields(const StepRecord& record, const FieldRecord& fields);
    void keep_state(const StepRecord& record, const std::function<FieldRecord()>& fields, bool last_of_stage);
    void write_held_state();
    [[nodiscard]] RunSummary summary_of(const RunOutcome& outcome, const std::vector<StepRecord>& history,
                                        const std::vector<StepRecord>& equilibria) const;

    std::filesystem::path directory_;
    const BlockSystem& system_;
    RunWriterOptions options_;
    std::unique_ptr<Tables> tables_;
    KeptStates kept_states_;
    std::optional<HeldState> held_;            ///< of the load step with the largest stress so far; not on the disk yet
    std::optional<StepRecord> last_row_;       ///< of history.csv; the others are on the disk only
    std::function<FieldRecord()> last_fields_; ///< of the same load step
    Clock::time_point saved_ = Clock::now();   ///< when the last state was
};

/// The files of a run's directory that remove_results removes there, folders and what is in them excepted.
[[nodiscard]] std::vector<std::string> result_names();

/// The first file in the directory that a run of another scene would take the place of, scene.yaml excepted; "" if there is none.
[[nodiscard]] std::string first_result_in(const std::filesystem::path& directory);

/// Removes every file that a run writes, except run.log and scene.yaml. Throws ResourceError.
void remove_results(const std::filesystem::path& directory);

} // namespace kluft
