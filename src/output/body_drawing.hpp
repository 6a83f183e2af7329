// Drawing of one body into a part of the page: the parts that the pictures of blocks share.
#pragma once

#include <functional>
#include <utility>
#include <vector>

#include "kluft/blocks/block_system.hpp"
#include "kluft/geometry/polygon.hpp"
#include "kluft/output/canvas.hpp"
#include "kluft/simulation/step_record.hpp"

namespace kluft {

/// A rectangle of the page that shows a box of the body, y up.
struct Panel {
    Vec2 corner = Vec2::Zero(); ///< upper left, points
    Box box;                    ///< of the body, local coordinates (m)
    double scale = 1.0;         ///< points per metre

    [[nodiscard]] Vec2 size() const { return scale * (box.upper - box.lower); }
    [[nodiscard]] Vec2 place(const Vec2& x) const {
        return {corner.x() + scale * (x.x() - box.lower.x()), corner.y() + scale * (box.upper.y() - x.y())};
    }
};

namespace ink {
inline constexpr Colour fracture = colour(0x1A1A1A);
inline constexpr Colour body = colour(0x333333);
inline constexpr Colour block = colour(0x000000, 0.22);
inline constexpr Colour tension = colour(0xD7191C);
inline constexpr Colour shear = colour(0x1F4FD8);
inline constexpr Colour sliding = colour(0xF5A800);
inline constexpr Colour platen = colour(0x7A7A7A);
inline constexpr Colour open = colour(0xFFFFFF);
} // namespace ink

/// How an interface is drawn.
enum class InterfaceLook {
    bond,        ///< potential crack on the tessellation
    mapped_bond, ///< potential crack on a mapped fracture
    joint,       ///< fracture on the tessellation
    mapped_fracture,
    tension_crack,
    shear_crack
};

/// What a fracture does now; none for bonds and cracks.
enum class Motion { none, sliding, open };

/// A body in one configuration: the current place of every block's vertices, and how its interfaces look.
struct DrawnBody {
    const BlockSystem& system;
    std::vector<std::size_t> first;    ///< from first_vertices
    std::vector<Vec2> displacement;    ///< as in FieldRecord, magnified (m)
    std::vector<InterfaceLook> looks;  ///< one per interface
    std::vector<double> movement;      ///< opening and slip of each interface, 0 where bonded (m)
    std::vector<Motion> motions;       ///< one per interface
    std::function<Colour(int)> colour; ///< of a block
    std::vector<PlatenFace> platens;   ///< displacements magnified
};

/// The body before loading. `potential`: whether each interface is a potential crack.
[[nodiscard]] DrawnBody body_before(const BlockSystem& system, const std::vector<bool>& potential);
/// The deformed body; colours are the caller's.
[[nodiscard]] DrawnBody body_after(const BlockSystem& system, const FieldRecord& fields, double magnification);

/// The box of the body; a deformed one reaches beyond the box before loading by at most a fifth.
[[nodiscard]] Box box_of(const DrawnBody& body);

/// Blocks of which no part lies in the box, by the boxes around them.
[[nodiscard]] int count_outside(const Box& box, const DrawnBody& body);

/// The movements that get the thickest lines: exceeded by one crack in twenty, by one sliding fracture in twenty (m).
struct LargestMovements {
    double cracks = 0.0;
    double sliding = 0.0;
};
[[nodiscard]] LargestMovements largest_movements(const DrawnBody& body);

/// Mean size of a block on the page (points).
[[nodiscard]] double block_size_on_page(const BlockSystem& system, double scale);

void draw_body(Canvas& canvas, const Panel& panel, const DrawnBody& body);

/// Line of an interface of the given look on a page where blocks have `block_size` points; `share` of the largest
/// movement, 0 to 1.
[[nodiscard]] Stroke stroke_of(InterfaceLook look, double block_size, double share);
/// The band under a moving fracture.
[[nodiscard]] Stroke stroke_of(Motion motion, double block_size, double share);

} // namespace kluft
