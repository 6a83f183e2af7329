// An equilibrium problem that owns its placement and its loads, for tests that pose bodies in code.
#pragma once

#include <vector>

#include "kluft/equilibrium/equilibrium_problem.hpp"

namespace kluft {

struct OwnedProblem : EquilibriumProblem {
    Placement placement;
    Loads loads;

    OwnedProblem() { refer_to_own_parts(); }
    OwnedProblem(const OwnedProblem& other)
        : EquilibriumProblem(other), placement(other.placement), loads(other.loads), densities_(other.densities_) {
        refer_to_own_parts();
    }
    OwnedProblem& operator=(const OwnedProblem&) = delete;
    ~OwnedProblem() = default;

    /// kg/m3, of all materials.
    void set_density(double density) {
        densities_ = {density};
        refer_to_own_parts();
    }

private:
    void refer_to_own_parts() {
        body.placement = &placement;
        body.loads = &loads;
        body.densities = densities_.empty() ? nullptr : &densities_;
    }

    std::vector<double> densities_;
};

} // namespace kluft
