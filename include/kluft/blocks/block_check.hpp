// Whether a block system is a sound partition of the body.
#pragma once

#include <limits>
#include <string>
#include <vector>

#include "kluft/blocks/block_system.hpp"

namespace kluft {

/// What a block system is expected to be; what is NaN or 0 is not checked.
struct PartitionExpectation {
    double domain_area = std::numeric_limits<double>::quiet_NaN(); ///< m2; the blocks' sum may differ by 1e-12 of it
    double minimum_area = 0.0;                                     ///< m2
};

/// Verifies that loops close, are simple and oriented and lie in their outline; that every edge either is on the
/// outline or is a side of exactly one interface whose two edges run between the same vertices in opposite
/// directions; that the boundaries list exactly the edges that name them; that areas, centroids and sizes are those of
/// the edges; and the expectation. Matched edges, simple blocks and the right sum of areas make a partition.
/// Returns a sentence for each violation (at most 50), empty for a sound system.
[[nodiscard]] std::vector<std::string> check_block_system(const BlockSystem& system,
                                                          const PartitionExpectation& expected = {});

} // namespace kluft
