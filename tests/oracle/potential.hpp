// The potential energy of a body and the conditions on its unknowns, as sums of simple terms with exact derivatives:
// numbered formulas in validation/oracle/README.md. Nothing here knows equilibrium or assembly.
#pragma once

#include <vector>

#include <Eigen/Core>
#include <Eigen/SparseCore>

namespace kluft::oracle {

/// constant + sum of factor * unknown.
struct LinearForm {
    struct Term {
        int unknown = 0;
        double factor = 0.0;
    };
    std::vector<Term> terms;
    double constant = 0.0;

    void add(int unknown, double factor) { terms.push_back({unknown, factor}); }
    [[nodiscard]] double at(const Eigen::VectorXd& x) const;
};

/// Energy force * stretch + stiffness/2 * stretch^2.
struct Spring {
    LinearForm stretch;     ///< m
    double stiffness = 0.0; ///< Pa
    double force = 0.0;     ///< where the stretch is zero (N/m)
};

/// The strain energy of a block of side h = sqrt(area) whose displacement gradient is D/h, eqs. (2) to (4). The change of
/// D = (D11, D21, D12, D22) since the start are four successive unknowns.
struct ElasticBlock {
    int first_unknown = 0;
    double size = 0.0; ///< h (m)
    double mu = 0.0;   ///< Pa
    double lambda = 0.0;
    Eigen::Vector4d start = Eigen::Vector4d::Zero(); ///< D at the start (m)
};

/// Sum of terms, to be minimised.
struct Potential {
    int n_unknowns = 0;
    std::vector<ElasticBlock> blocks;
    std::vector<Spring> springs;
    Eigen::VectorXd linear;               ///< of the unknowns: minus the dead loads (N/m)
    std::vector<LinearForm> equalities;   ///< = 0 (m)
    std::vector<LinearForm> inequalities; ///< >= 0 (m)
    std::vector<int> nonnegative;         ///< unknowns that are >= 0

    /// Energy per metre of thickness (J/m).
    [[nodiscard]] double energy(const Eigen::VectorXd& x) const;
    [[nodiscard]] Eigen::VectorXd gradient(const Eigen::VectorXd& x) const;
    /// The lower triangle.
    [[nodiscard]] Eigen::SparseMatrix<double> hessian(const Eigen::VectorXd& x) const;
};

} // namespace kluft::oracle
