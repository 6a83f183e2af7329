#include "kluft/fracture/crack_check.hpp"

#include <algorithm>

namespace kluft {

namespace {

/// Of the two blocks; a fixed one has none, and counts as its neighbour.
PrincipalStresses mean_principal_stresses(const BlockSystem& system, const Interface& interface,
                                          const std::vector<Mat2>& stresses) {
    const bool fixed_a = system.blocks[interface.block_a].fixed;
    const bool fixed_b = system.blocks[interface.block_b].fixed;
    const Mat2& a = stresses[fixed_a ? interface.block_b : interface.block_a];
    const Mat2& b = stresses[fixed_b ? interface.block_a : interface.block_b];
    return principal_stresses(0.5 * (a + b));
}

template <typename Index>
std::vector<CrackCandidate> check_bonds(const BlockSystem& system, const std::vector<char>& bonded,
                                        const std::vector<Mat2>& stresses, Index index) {
    std::vector<CrackCandidate> candidates;
    candidates.reserve(static_cast<std::size_t>(std::ranges::count(bonded, 1)));
    for (int i = 0; i < system.n_interfaces(); ++i) {
        if (!bonded[i]) continue;
        const auto stress = mean_principal_stresses(system, system.interfaces[i], stresses);
        candidates.push_back({i, index(i, stress), stress});
    }
    return candidates;
}

} // namespace

std::vector<CrackCandidate> crack_check(const BlockSystem& system, const std::vector<char>& bonded,
                                        const std::vector<Strength>& strengths, const std::vector<Mat2>& stresses) {
    return check_bonds(system, bonded, stresses, [&](int i, const PrincipalStresses& stress) {
        return failure_index(stress.p1, stress.p3, strengths[i]);
    });
}

std::vector<CrackCandidate> crack_check(const BlockSystem& system, const std::vector<char>& bonded,
                                        const std::vector<Strength>& strengths, const std::vector<Mat2>& stresses,
                                        const std::vector<InterfaceTraction>& tractions) {
    return check_bonds(system, bonded, stresses, [&](int i, const PrincipalStresses&) {
        return failure_index_traction(tractions[i].normal, tractions[i].shear, strengths[i]);
    });
}

double largest_index(const std::vector<CrackCandidate>& candidates) {
    double largest = 0.0;
    for (const auto& candidate : candidates) largest = std::max(largest, candidate.index.f);
    return largest;
}

std::vector<CrackCandidate> failing(const std::vector<CrackCandidate>& candidates, double threshold) {
    std::vector<CrackCandidate> result;
    std::ranges::copy_if(candidates, std::back_inserter(result),
                         [&](const CrackCandidate& candidate) { return candidate.index.f >= threshold; });
    std::ranges::sort(result, [](const CrackCandidate& a, const CrackCandidate& b) {
        return a.index.f != b.index.f ? a.index.f > b.index.f : a.interface < b.interface;
    });
    return result;
}

} // namespace kluft
