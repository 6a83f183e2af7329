// A body put together from blocks that are given as polygons.
#pragma once

#include "kluft/blocks/block_cutter.hpp"
#include "kluft/blocks/geometry_spec.hpp"

namespace kluft {

/// The blocks of `spec.blocks` in their order, with interfaces of the type `spec.blocks_interface` wherever two of them
/// share a part of an edge: edges are split at the ends of that part, so that the two sides of an interface match.
/// Coordinates that agree within 1e-9 of the diagonal of the body's box are the same, and a corner that is so near to a
/// side lies on it. Gaps between blocks are allowed; a corner that only touches a side makes no interface.
/// The boundaries get the free parts of their sides; those of no block's name that carry something get none of an open joint
/// (open_joint.hpp), and the report tells which.
/// Throws InputError for what is no simple counter-clockwise polygon, for blocks that overlap (naming both), and for a
/// boundary of one block without a free part, and for a set without a block.
[[nodiscard]] CutBody assemble_blocks(const GeometrySpec& spec);

} // namespace kluft
