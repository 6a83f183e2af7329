// What a run follows step by step, beside the curve of the whole body: blocks, fractures, pairs of blocks.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "kluft/kinematics/material_point.hpp"
#include "kluft/loading/loaded_body.hpp"

namespace kluft {

struct Model;

/// What a scene asks for: a block (`block`, `point` or both), else mapped fractures, else a pair of blocks. Blocks by
/// their name or that of a set of one.
struct HistoryRequest {
    std::string name;
    std::string block;
    std::optional<Vec2> point;  ///< in the body as cut, scene coordinates (m); the centroid without one
    std::vector<int> fractures; ///< indices of mapped fractures
    std::pair<std::string, std::string> pair;
};

/// The same with its place in the body.
struct HistoryGauge {
    std::string name;
    std::optional<MaterialPoint> point; ///< of a block
    std::vector<int> fractures;
    std::pair<int, int> pair{-1, -1}; ///< of blocks
};

/// Throws InputError for a name that is not of exactly one block and for a point that is in no block.
[[nodiscard]] std::vector<HistoryGauge> place_histories(const BlockSystem& system,
                                                        const std::vector<HistoryRequest>& requests);

/// Names of the columns, gauge after gauge: "<name>.displacement_x".
[[nodiscard]] std::vector<std::string> history_columns(const Model& model);

/// Their values at q, in the order of the columns. Of a block: displacement of the point (m), rotation of the polar
/// decomposition (radians, counter-clockwise), Cauchy stress (Pa, positive in compression). Of fractures and pairs, over
/// their bonds and contact points: normal and shear force (N/m), the same over the length (Pa), mean opening and slip
/// (m, weighted with length), since the body as cut. Normal forces are positive in compression; shear and slip are
/// positive where the block that the normal points to moves along the normal turned by +90 degrees. A contact point
/// counts for a fracture where both of its edges lie on it. Where nothing touches, opening and slip are those of the
/// middles of the interfaces.
[[nodiscard]] std::vector<double> measure_histories(const Model& model, const LoadedBody& body,
                                                    const Eigen::VectorXd& q);

} // namespace kluft
