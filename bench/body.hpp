// The body of a scene under the loads of its last stage, ready to be assembled and solved as a run does.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "kluft/assembly/block_matrix.hpp"
#include "kluft/equilibrium/equilibrium_problem.hpp"
#include "kluft/simulation/model.hpp"
#include "kluft/simulation/stage_loads.hpp"

namespace kluft::bench {

/// What the interfaces of the tessellation are.
enum class Joining {
    bonded,   ///< as in the scene
    fractured ///< all failed: every interface is found by contact detection, closed and locked
};

/// The equilibrium problem of a model at displacements that close every interface: each block is a little larger than
/// it was cut. Refers to the model.
class Body {
public:
    Body(const Model& model, Joining joining);
    Body(const Body&) = delete;
    Body& operator=(const Body&) = delete;
    ~Body() = default;

    [[nodiscard]] const Model& model() const { return *model_; }
    [[nodiscard]] const EquilibriumProblem& problem() const { return problem_; }
    [[nodiscard]] const BlockPattern& pattern() const { return pattern_; }
    [[nodiscard]] const Eigen::VectorXd& displacement() const { return displacement_; }

    /// The symmetric stiffness with its supports and platens, as a solver factorizes it.
    void stiffness(EquilibriumEvaluator& evaluator, BlockMatrix& matrix) const;
    /// Forces on the free unknowns that a smooth and a rough load make, size 6 n_blocks (N/m).
    [[nodiscard]] Eigen::VectorXd load() const;

private:
    const Model* model_;
    Placement placement_;
    LoadsAt at_;
    EquilibriumProblem problem_;
    BlockPattern pattern_;
    Eigen::VectorXd displacement_;
};

/// Reads the scene and cuts the body. Throws InputError.
[[nodiscard]] Model read_model(const std::filesystem::path& scene, const std::vector<std::string>& overrides);

} // namespace kluft::bench
