// Identity and memory of contact points.
#pragma once

#include <compare>

namespace kluft {

/// Who touches whom: an edge of block a against an edge of block b (point 0, 1, 2 of the overlap), or a vertex of
/// block a (the start of edge_a) against an edge of block b (point -1).
struct ContactKey {
    int block_a = 0;
    int edge_a = 0;
    int block_b = 0;
    int edge_b = 0;
    int point = 0;

    auto operator<=>(const ContactKey&) const = default;
};

enum class ContactState { open, sliding, locked };

/// What a fracture point remembers from one equilibrium to the next.
struct PointHistory {
    double shear_trial = 0.0; ///< shear traction before rounding, clipped at the limit of the rounding (Pa)
    double dilation = 0.0;    ///< opening that plastic slip has forced so far (m)
};

struct ContactMemory {
    ContactKey key;
    PointHistory history;
};

} // namespace kluft
