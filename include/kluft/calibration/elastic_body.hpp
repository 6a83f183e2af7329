// Young's modulus and Poisson's ratio of a whole body as an elastic specimen, with their exact derivatives
// (docs/theory.md, section 12).
#pragma once

#include <memory>

#include <Eigen/Core>

#include "kluft/simulation/model.hpp"

namespace kluft {

/// What the elasticity of a body depends on, one after the other: k_n and k_s (Pa/m) of each law, then lambda and mu (Pa) of
/// each material, and what Model::compliance_across is (1/Pa), 0 without it. Size 2 n_laws + 2 n_materials + 1.
[[nodiscard]] Eigen::VectorXd elastic_properties(const Model& model);

/// The rock's constants that a specimen in uniaxial compression shows, and their derivatives by the elastic properties.
struct ElasticResponse {
    double youngs_modulus = 0.0;      ///< Pa
    double poissons_ratio = 0.0;      ///< dimensionless
    Eigen::VectorXd modulus_gradient; ///< Pa per unit of each property
    Eigen::VectorXd ratio_gradient;   ///< 1 per unit of each property
};

/// A body between two smooth platens, on the boundary of the first platen that the scene moves (the upper one without any)
/// and on the opposite one, free on all others; every bond whole, every mapped fracture closed and locked, small strains.
/// The slopes of stress and lateral strain become the rock's E and nu as in summary.hpp.
class ElasticBody {
public:
    /// Throws InputError for a body without a boundary opposite to the platen's, or without two lateral ones.
    explicit ElasticBody(const Model& model);
    ElasticBody(ElasticBody&&) noexcept;
    ElasticBody& operator=(ElasticBody&&) noexcept;
    ~ElasticBody();

    /// One factorization and two solutions: the body's equilibrium and its adjoint. `properties` as elastic_properties
    /// orders them. Throws InputError where no equilibrium exists, as with a stiffness of zero.
    [[nodiscard]] ElasticResponse response(const Eigen::VectorXd& properties);

private:
    struct Specimen;
    std::unique_ptr<Specimen> specimen_;
};

} // namespace kluft
