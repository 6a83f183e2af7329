// What a body holds as elastic energy.
#pragma once

#include <Eigen/Core>

#include "kluft/loading/loaded_body.hpp"

namespace kluft {

/// Elastic energy of a contact point at q (J/m).
[[nodiscard]] double contact_energy(const LoadedBody& body, const ContactPoint& point, const Eigen::VectorXd& q);
/// The same of a bond.
[[nodiscard]] double bond_energy(const LoadedBody& body, const Bond& bond, const Eigen::VectorXd& q);
/// Of bonds and contacts at q (J/m).
[[nodiscard]] double springs_energy(const LoadedBody& body, const Eigen::VectorXd& q);
/// Of blocks, bonds and contacts at q (J/m).
[[nodiscard]] double stored_energy(const LoadedBody& body, const Eigen::VectorXd& q);

} // namespace kluft
