// Blocks by name and by place.
#pragma once

#include <string>
#include <vector>

#include "kluft/blocks/block_system.hpp"
#include "kluft/blocks/geometry_spec.hpp"

namespace kluft {

/// "'arch 3'" for a block with a name, "7" for one without: what a message calls it.
[[nodiscard]] std::string block_label(const BlockSystem& system, int block);

/// The blocks of the set of that name, or the one block of that name; none where nothing is called so.
[[nodiscard]] std::vector<int> blocks_called(const BlockSystem& system, const std::string& name);

/// The one block that is called so, by its own name or as a set of one. Throws InputError, which begins with `what`.
[[nodiscard]] int block_called(const BlockSystem& system, const std::string& name, const std::string& what);

/// Whether a block has a point in it or on its outline, before loading. `point` in scene coordinates (m).
[[nodiscard]] bool block_contains(const BlockSystem& system, int block, const Vec2& point);

/// The blocks that have the point (scene coordinates, m) in them or on their outline, before loading, those that are not fixed first;
/// and the first of them, -1 without one.
[[nodiscard]] std::vector<int> blocks_containing(const BlockSystem& system, const Vec2& point);
[[nodiscard]] int block_containing(const BlockSystem& system, const Vec2& point);

/// Fills the sets of a body from their specification and fixes the blocks of the fixed ones.
/// Throws InputError for a set without a block.
void form_sets(const GeometrySpec& spec, BlockSystem& system);

/// A hundred-thousandth of the mean block (m2): a smaller one is a sliver, a piece between traces that nearly meet in one point.
[[nodiscard]] double sliver_area(const BlockSystem& system);

} // namespace kluft
