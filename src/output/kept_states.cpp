#include "kluft/output/kept_states.hpp"

#include <algorithm>

#include "kluft/output/summary.hpp"

namespace kluft {

namespace {

int cracks_of(const StepRecord& row) { return row.cracks_tension + row.cracks_shear; }

bool is_higher(const StepRecord& row, const std::optional<StepRecord>& than, std::optional<int> platen_stage) {
    if (!platen_stage || row.stage < *platen_stage || !row.balanced) return false;
    if (!than) return true;
    const double sense = row.axial_strain < 0.0 ? -1.0 : 1.0; // of the platen
    return sense * row.axial_stress > sense * than->axial_stress && !(row.net_broken >= locking_share);
}

} // namespace

void KeptStates::add(const StepRecord& row) {
    if (last_ && row.stage != last_->stage) end_stage();
    const bool has_cracks = last_ && cracks_of(row) > cracks_of(*last_);
    last_ = row;
    if (is_higher(row, peak_, options_.platen_stage)) peak_ = row;
    if (has_cracks && options_.at_cracks > 0) add_crack_step(row.step);
}

void KeptStates::end_stage() {
    if (stage_ends_.empty() || stage_ends_.back() != last_->step) stage_ends_.push_back(last_->step);
}

void KeptStates::add_crack_step(int step) {
    if (n_crack_steps_++ % stride_ == 0) at_cracks_.push_back(step);
    if (static_cast<int>(at_cracks_.size()) <= options_.at_cracks) return;
    std::vector<int> rest;
    for (std::size_t i = 0; i < at_cracks_.size(); i += 2) rest.push_back(at_cracks_[i]);
    at_cracks_ = std::move(rest);
    stride_ *= 2;
}

bool KeptStates::is_fixed(int step) const {
    const bool is_due = options_.every > 0 && step % options_.every == 0;
    return step == 0 || is_due || std::ranges::binary_search(stage_ends_, step);
}

bool KeptStates::is_at_cracks(int step) const { return std::ranges::binary_search(at_cracks_, step); }

bool KeptStates::keeps(int step) const {
    return is_fixed(step) || is_at_cracks(step) || (peak_ && peak_->step == step);
}

std::optional<int> KeptStates::for_its_stress() const {
    if (!peak_ || is_fixed(peak_->step) || is_at_cracks(peak_->step)) return std::nullopt;
    return peak_->step;
}

std::optional<int> step_of_peak(const std::vector<StepRecord>& history, std::optional<int> platen_stage) {
    std::optional<StepRecord> peak;
    for (const StepRecord& row : history)
        if (is_higher(row, peak, platen_stage)) peak = row;
    return peak ? std::optional(peak->step) : std::nullopt;
}

} // namespace kluft
