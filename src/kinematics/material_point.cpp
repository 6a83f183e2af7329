#include "kluft/kinematics/material_point.hpp"

#include <fmt/format.h>

#include "kluft/blocks/block_search.hpp"
#include "kluft/core/diagnostics.hpp"
#include "kluft/kinematics/affine.hpp"

namespace kluft {

MaterialPoint material_point(const BlockSystem& system, const std::string& block, const Vec2& point,
                             const std::string& what) {
    const int b = block.empty() ? block_containing(system, point) : block_called(system, block, what);
    if (b < 0 || !block_contains(system, b, point)) {
        throw InputError(fmt::format("{}: expected a point in {}, found ({:.10g}, {:.10g})", what,
                                     b < 0 ? "a block" : "block " + block_label(system, b), point.x(), point.y()));
    }
    return {b, block_coordinates(system.blocks[b], point - system.origin)};
}

} // namespace kluft
