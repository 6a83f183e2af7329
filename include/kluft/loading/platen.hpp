// Platens: half-planes without compliance that the body touches, leaves and slides along (docs/theory.md, "Platens").
#pragma once

#include <vector>

#include <Eigen/Core>

#include "kluft/blocks/block_system.hpp"
#include "kluft/core/vector.hpp"
#include "kluft/loading/boundary_loads.hpp"

namespace kluft {

struct LoadedBody;
struct Loads;

/// A platen on a boundary of the body.
struct Platen {
    int boundary = 0;
    Vec2 normal = Vec2::Zero(); ///< outward of the boundary: from the body into the platen
    double face = 0.0;          ///< place of its face along the normal at the start of the stage, local coordinates (m)
    double tan_friction = 0.0;  ///< infinite: what touches it sticks
    bool glued = false;         ///< what touches it stays on it
    double velocity = 0.0;      ///< along the normal per unit of load factor (m)
    double rate = 0.0;          ///< along the normal per unit of a travel that is unknown
    double moved = 0.0;         ///< along the normal at the present load factor (m); without an unknown travel

    [[nodiscard]] Vec2 tangent() const { return {-normal.y(), normal.x()}; }
};

enum class PlatenContact {
    open,
    sliding,
    sticking,
    beyond ///< of a part of the body that the platen is not laid on and that nothing stops there
};
[[nodiscard]] inline bool touches(PlatenContact contact) {
    return contact == PlatenContact::sliding || contact == PlatenContact::sticking;
}

/// A vertex of a block that touches a platen or may.
struct PlatenPoint {
    int boundary = 0; ///< whose platen
    int block = 0;
    int vertex = 0;
    bool is_laid = false; ///< a vertex of the platen's boundary
    PlatenContact contact = PlatenContact::sticking;
    double reach = 0.0;    ///< displacement along the normal at which it touches, at the start of the stage (m)
    double along = 0.0;    ///< displacement along the face from which slip counts (m)
    double friction = 0.0; ///< force of the platen on a sliding point, along the tangent (N/m)

    bool operator==(const PlatenPoint&) const = default;
};

/// The vertices of the platen's boundary, each of a block once, which touch it as they lie at displacements q, however uneven;
/// and those of parts of the body in its plane or before it that it is not laid on.
[[nodiscard]] std::vector<PlatenPoint> laid_points(const BlockSystem& system, const Platen& platen,
                                                   const Eigen::VectorXd& q);

/// Place of the face along the normal: that of the outermost of these points when it touches (m).
[[nodiscard]] double face_of(const BlockSystem& system, const Platen& platen, const std::vector<PlatenPoint>& points);

/// Mean displacement along the normal at which the vertices of the platen's boundary touch it at the start of the stage (m).
[[nodiscard]] double mean_reach(const Platen& platen, const std::vector<PlatenPoint>& points);

/// Adds, without contact, the vertices that are within `distance` (m) of the face of a platen at q and no points yet, but not those that
/// lay beyond an end at which the body goes on in the plane of the face. Corners between faces that it is laid on are rounded: they touch a
/// little later.
void add_near_points(const BlockSystem& system, const Eigen::VectorXd& q, double distance, Loads& loads);

/// The prescribed displacements of a touching point: along the normal, and along the face where it sticks. `index`: of the
/// point.
void append_rows(const BlockSystem& system, const Platen& platen, const PlatenPoint& point, int index,
                 std::vector<PrescribedDisplacement>& rows);

/// Holds the body by its supports and the touching points, and lets the friction on sliding points act. Rows of rigid blocks
/// are linearised at q.
void hold_by_platens(const LoadedBody& body, const Eigen::VectorXd& q, Loads& loads);

/// Which points touch, slide and stick at displacements q, by the `forces` (internal - external, without the supports', N/m)
/// on those that are held and by the place of the others (docs/theory.md 28a). True if any has changed; the rows are then to
/// be made anew. Points leave their platen only where they `may_open`; the last one of a platen under a given force stays.
[[nodiscard]] bool update_platen_points(const BlockSystem& system, const Eigen::VectorXd& q,
                                        const Eigen::VectorXd& forces, bool may_open, Loads& loads);

/// The largest pull of platens that are not glued on a point, over the largest force on one. `forces` as above.
[[nodiscard]] double largest_pull(const Eigen::VectorXd& forces, const Loads& loads);

/// At the start of a stage at q: the points of a platen that is there already stick or slide as its friction is now, and one
/// under a given force that touches nothing comes to where it touches the body.
void meet_anew(const BlockSystem& system, const Platen& platen, const Eigen::VectorXd& q,
               std::vector<PlatenPoint>& points);

/// The slip of sliding points counts from q on.
void keep_slips(const BlockSystem& system, const Eigen::VectorXd& q, const std::vector<Platen>& platens,
                std::vector<PlatenPoint>& points);

/// The face of a platen along the boundary that it was laid on, for pictures.
struct PlatenFace {
    Vec2 start = Vec2::Zero(); ///< before loading, local coordinates (m)
    Vec2 end = Vec2::Zero();
    Vec2 outward = Vec2::Zero();
    Vec2 displacement = Vec2::Zero(); ///< m
};
[[nodiscard]] std::vector<PlatenFace> faces_of(const BlockSystem& system, const Loads& loads, const Eigen::VectorXd& q);

/// Travel of a platen under a given force at q, from the points on it (m).
[[nodiscard]] double platen_travel(const Loads& loads, const Eigen::VectorXd& q);

} // namespace kluft
