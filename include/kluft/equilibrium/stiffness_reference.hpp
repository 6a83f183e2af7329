// What the factor in use was made of, and the low-rank changes since: contacts that closed, opened, began or ceased to
// slide, bonds that broke, and blocks whose mass-like term has changed.
#pragma once

#include <array>
#include <map>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "kluft/assembly/block_matrix.hpp"
#include "kluft/assembly/low_rank_update.hpp"
#include "kluft/equilibrium/equilibrium_problem.hpp"

namespace kluft {

/// Keeps, for every contact, the stiffness that went into the factor. The points of an overlap are one patch:
/// gap and slip at its two ends, between which both are linear, so that three points have rank four.
class StiffnessReference {
public:
    /// The factor is that of the tangent of this kind of the problem at q, with the prescribed motions taken out.
    void take(const EquilibriumProblem& problem, const Eigen::VectorXd& q, TangentKind kind,
              const BlockMatrix& tangent);
    /// There is no factor.
    void forget() { taken_ = false; }
    [[nodiscard]] bool taken() const { return taken_; }

    /// Changes of the tangent at q, of the kind of the factor's, against that. Small ones are left out: those of rotations, of the
    /// elastic tangent and of sliding along a contact are for the refinement.
    const std::vector<StiffnessChange>& changes(const EquilibriumProblem& problem, const Eigen::VectorXd& q);

    /// How many blocks prescribed displacements hold in another way than in the factor: no change of low rank that is put on top of it.
    [[nodiscard]] int n_held_otherwise(const EquilibriumProblem& problem) const;

private:
    using Key = std::array<int, 5>; ///< block_a, edge_a, block_b, edge_b, 1 for a vertex on an edge
    struct Patch {
        Key key{};
        double scale = 0.0; ///< largest stiffness it can have
        StiffnessChange change;
    };

    static Key key_of(const ContactKey& k);
    static void collect(const EquilibriumProblem& problem, const Eigen::VectorXd& q, TangentKind kind,
                        std::vector<Patch>& patches);
    void add_broken_bonds(const EquilibriumProblem& problem);
    void add_masses(const EquilibriumProblem& problem, const Eigen::VectorXd& q);
    void add_mass(const EquilibriumProblem& problem, int b, const Mat6& mass);
    long number_of(const Key& key) {
        return numbers_.try_emplace(key, static_cast<long>(numbers_.size())).first->second;
    }

    bool taken_ = false;
    TangentKind kind_ = TangentKind::symmetric;
    std::vector<Patch> reference_; ///< sorted by key
    std::vector<int> bonded_;      ///< interfaces that were bonds, ascending
    std::vector<double> eta_;      ///< per block, or empty
    std::vector<std::pair<int, Mat6>>
        held_;                    ///< blocks with prescribed displacements, ascending, and what these leave free
    Eigen::VectorXd diagonal_;    ///< of the tangent
    std::map<Key, long> numbers_; ///< of patches that have changed
    std::vector<Patch> now_;
    std::vector<StiffnessChange> changes_;
};

} // namespace kluft
