// Which states of a run are kept, as a function of the rows of its history alone.
#pragma once

#include <optional>
#include <vector>

#include "kluft/simulation/step_record.hpp"

namespace kluft {

struct KeptStatesOptions {
    int every = 0;     ///< load steps between two kept states; 0: none for that reason
    int at_cracks = 0; ///< the most states that are kept because potential cracks failed in their load step
    std::optional<int> platen_stage; ///< the first stage that moves a platen; without one there is no peak
};

/// Keeps the first state, the last one of each stage, every n-th, that of the load step with the largest axial stress at its
/// end, and those of load steps in which potential cracks failed: of these every one, and where they become too many every
/// second, fourth ... one from the first on. Told the rows of a run up to a load step, one keeps what the run kept then: a run
/// that goes on from there keeps what it would have kept without the break.
class KeptStates {
public:
    explicit KeptStates(const KeptStatesOptions& options) : options_(options) {}

    /// Takes the row of the next load step. What was kept before may not be any more.
    void add(const StepRecord& row);
    /// The state of the last row is the last one of its stage.
    void end_stage();

    [[nodiscard]] bool keeps(int step) const;
    /// The load step that is kept for no other reason than that its stress is the largest so far; none where there is no such.
    [[nodiscard]] std::optional<int> for_its_stress() const;

private:
    [[nodiscard]] bool is_fixed(int step) const;
    [[nodiscard]] bool is_at_cracks(int step) const;
    void add_crack_step(int step);

    KeptStatesOptions options_;
    std::optional<StepRecord> last_;
    std::vector<int> stage_ends_; ///< load steps, ascending
    std::vector<int> at_cracks_;  ///< load steps that are kept for their cracks, ascending
    int n_crack_steps_ = 0;       ///< load steps so far in which cracks failed
    int stride_ = 1;              ///< of these the first, and every so many after it, is kept
    std::optional<StepRecord> peak_;
};

/// The load step with the largest axial stress in the sense of the platen, of the rows from the platen's stage on that are balanced; of a net
/// 70 % of whose bonds have failed no row counts, since it may have locked. None without such a row.
[[nodiscard]] std::optional<int> step_of_peak(const std::vector<StepRecord>& history, std::optional<int> platen_stage);

} // namespace kluft
