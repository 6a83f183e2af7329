// Contact points between blocks that are not bonded to each other: overlaps of facing edges and vertices against
// edges (the narrow phase), with the history of the points that persist.
#pragma once

#include <utility>
#include <vector>

#include "kluft/blocks/block_system.hpp"
#include "kluft/contact/contact.hpp"

namespace kluft {

/// Of the rectangle with the block's area and largest second moment (m).
[[nodiscard]] double thickness(const Block& block);

/// Whether a block of a body that is cut is smaller than a quarter of a cell of its net: what fractures leave of cells is
/// crushed where the net has failed.
[[nodiscard]] bool is_fragment(const BlockSystem& system, int block);

/// Largest overlap of two blocks in contact (m). The two faces of an interface (`own`) face each other down to the size of
/// the smaller block, of a fragment down to a quarter of it. Other edges do so down to a quarter of it, and to half the
/// thickness of the thinner one: what is deeper are opposite sides of a block.
[[nodiscard]] double deepest_contact(const BlockSystem& system, int a, int b, bool own);

/// What detection needs to know of the interfaces.
struct ContactSurfaces {
    std::vector<char> bonded;     ///< per interface: 1 while it is a bond
    std::vector<int> law;         ///< per interface: its law as a fracture (index into the interface laws)
    std::vector<int> n_points;    ///< per interface: points of an overlap along it (overlap_points)
    std::vector<double> friction; ///< per law: tan(phi), to choose between the laws of two surfaces
    int outline_points = 3;       ///< of an overlap of two surfaces of the outline
    int default_law = 0;          ///< of two surfaces of the domain's outline that meet
    bool outlines_meet = false;   ///< also those of two blocks that have no fracture inside the body
    /// Whether what rises before a tip holds it where the tip leans away from it: rigid blocks do, rock at the toe of a slope does not.
    bool ground_holds_tips = true;
};

/// A tip that has sunk into the ground before it, which does not hold it.
struct UnheldTip {
    int block = 0;
    int ground = 0;            ///< a block
    int ground_edge = 0;       ///< of it
    double depth = 0.0;        ///< m
    Vec2 place = Vec2::Zero(); ///< local coordinates, as it lies (m)
};

struct DetectedContacts {
    std::vector<ContactPoint> points;            ///< sorted by key
    std::vector<std::pair<int, int>> near_pairs; ///< blocks that are near enough to touch soon, sorted
    std::vector<UnheldTip> unheld_tips;          ///< where the ground holds none
};

/// Two fixed blocks have no contact. `reach`: largest opening at which a point is kept (m). Points whose key
/// is in `memory` (sorted) inherit its history, new ones between two faces of one mapped fracture the dilation of these.
[[nodiscard]] DetectedContacts detect_contacts(const BlockSystem& system, const ContactSurfaces& surfaces,
                                               const Eigen::VectorXd& q, double reach,
                                               const std::vector<ContactMemory>& memory);

} // namespace kluft
