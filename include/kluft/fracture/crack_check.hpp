// Which potential cracks fail: a pure function of stresses or tractions.
#pragma once

#include <vector>

#include "kluft/blocks/block_system.hpp"
#include "kluft/constitutive/strength_envelope.hpp"
#include "kluft/core/vector.hpp"

namespace kluft {

/// A potential crack and how near to failure it is.
struct CrackCandidate {
    int interface = 0;
    FailureIndex index;
    PrincipalStresses
        stress; ///< mean of the two adjacent blocks, of which fixed ones do not count; positive in compression (Pa)
};

/// Mean traction of an interface (Pa, normal positive in tension).
struct InterfaceTraction {
    double normal = 0.0;
    double shear = 0.0;
};

/// Failure index of every bonded interface by the mean Cauchy stress of its two blocks. `strengths` has one entry per
/// interface, `stresses` one per block (Pa, positive in tension).
[[nodiscard]] std::vector<CrackCandidate> crack_check(const BlockSystem& system, const std::vector<char>& bonded,
                                                      const std::vector<Strength>& strengths,
                                                      const std::vector<Mat2>& stresses);

/// The same by the interfaces' own tractions, one per interface.
[[nodiscard]] std::vector<CrackCandidate> crack_check(const BlockSystem& system, const std::vector<char>& bonded,
                                                      const std::vector<Strength>& strengths,
                                                      const std::vector<Mat2>& stresses,
                                                      const std::vector<InterfaceTraction>& tractions);

/// The largest f; 0 without candidates.
[[nodiscard]] double largest_index(const std::vector<CrackCandidate>& candidates);

/// Those with f >= threshold, largest first, ties by interface.
[[nodiscard]] std::vector<CrackCandidate> failing(const std::vector<CrackCandidate>& candidates, double threshold);

} // namespace kluft
