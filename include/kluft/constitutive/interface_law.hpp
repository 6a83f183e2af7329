// Traction of interfaces from their relative displacement: bonds and fractures (docs/theory.md).
#pragma once

#include <optional>

#include "kluft/core/vector.hpp"

namespace kluft {

enum class ContactState { open, sliding, locked };

/// All constants of one interface type. Pa/m, Pa, tangents of angles.
struct InterfaceLaw {
    double normal_stiffness = 0.0;
    double shear_stiffness = 0.0;
    double tan_friction = 0.0;
    double cohesion = 0.0;
    double tan_dilation = 0.0;
    double cohesion_onset = 0.0;    ///< t_r: the cohesion is c min(1, p/t_r)
    double contact_rounding = 0.0;  ///< g_0 k_n: the pressure is rounded for -2 g_0 < gap < 0
    int overlap_points = 0;         ///< of an overlap of two blocks; 0: as many as its cohesion needs (overlap_points)
    double friction_rounding = 0.0; ///< s: Coulomb's limit is rounded for |trial|/limit in 1 - s .. 1 + s
};

/// What a fracture point remembers from one equilibrium to the next.
struct PointHistory {
    double shear_trial = 0.0; ///< shear traction before rounding, clipped at the limit of the rounding (Pa)
    double dilation = 0.0;    ///< opening that plastic slip has forced so far (m)

    bool operator==(const PointHistory&) const = default;
};

/// The piece of an overlap whose cohesion a point carries: [from, to] from the point, over the overlap's length. Along it
/// the gap is linear; without a piece the cohesion is that of the point itself.
struct ContactPiece {
    double from = 0.0;
    double to = 0.0;
    double tilt = 0.0; ///< by how much the gap grows over the whole overlap (m)
};

/// Traction at a point and its derivatives with respect to (gap, slip), and to the tilt of the overlap.
struct PointTraction {
    double normal = 0.0;         ///< Pa, positive in tension
    double shear = 0.0;          ///< Pa
    Mat2 tangent = Mat2::Zero(); ///< d(normal, shear)/d(gap, slip), Pa/m
    Vec2 by_tilt = Vec2::Zero(); ///< d(normal, shear)/d tilt, Pa/m: of the cohesion of a sliding point
    ContactState state = ContactState::locked;
    PointHistory history; ///< to keep if this becomes the equilibrium
};

/// Contact pressure p(gap) >= 0 of the rounded law and its derivative (<= 0). With g_0 = contact_rounding/k_n:
/// p = k_n g^2/(4 g_0) for -2 g_0 < g < 0, -k_n (g + g_0) below, 0 for an open point: the body as it was cut is free of
/// stress, and a point is open exactly where its gap is positive.
struct ContactPressure {
    double value = 0.0;
    double slope = 0.0;
};
[[nodiscard]] ContactPressure contact_pressure(const InterfaceLaw& law, double gap);

/// Elastic energy of the contact pressure at a gap: the integral of p from there to zero (J/m2).
[[nodiscard]] double contact_energy(const InterfaceLaw& law, double gap);

/// Coulomb's limit p tan(phi) + the mean of c min(1, p/t_r) over the piece, at a gap less dilation (docs/theory.md 15), and its
/// derivatives.
struct ShearLimit {
    double value = 0.0; ///< Pa
    double by_gap = 0.0;
    double by_tilt = 0.0;
};
[[nodiscard]] ShearLimit shear_limit(const InterfaceLaw& law, double elastic_gap, const ContactPiece& piece = {});

/// A bonded point: elastic in tension and shear. `start_shear` is the shear traction where slip = 0.
[[nodiscard]] inline PointTraction bond_traction(const InterfaceLaw& law, double start_shear, double gap, double slip) {
    PointTraction result;
    result.normal = law.normal_stiffness * gap;
    result.shear = start_shear + law.shear_stiffness * slip;
    result.tangent << law.normal_stiffness, 0.0, 0.0, law.shear_stiffness;
    result.history.shear_trial = result.shear;
    return result;
}

/// A point of a fracture: no tension, Coulomb friction with rounding, dilation by plastic slip. `gap` is total,
/// `slip` counts from where `start` was kept. A point without pressure is open unless a part of its piece is closed and
/// has cohesion. With a `held_limit` (Pa) Coulomb's limit is that, whatever the pressure, also where the gap is open: no law of a
/// contact, but one with an energy, from which an equilibrium is searched (docs/theory.md, (29d)).
[[nodiscard]] PointTraction fracture_traction(const InterfaceLaw& law, const PointHistory& start, double gap,
                                              double slip, const ContactPiece& piece = {},
                                              const std::optional<double>& held_limit = {});

} // namespace kluft
