#include "kluft/equilibrium/local_iteration.hpp"

#include <algorithm>
#include <cstddef>
#include <utility>

#include "kluft/assembly/linear_solver.hpp"
#include "kluft/core/disjoint_sets.hpp"
#include "kluft/equilibrium/boundary_terms.hpp"

namespace kluft {

namespace {

constexpr double chosen_share = 0.9; ///< of the norm of all forces, on the blocks that are moved (measured)
constexpr double max_chosen = 500.0; ///< blocks: more are left to a solve of all
constexpr double local_goal = 0.05;  ///< of the forces at first
constexpr int max_local_iterations = 40;
constexpr double least_local_fall = 1e-3;    ///< of the norm, by an increment that is taken
constexpr double large_local_fall = 0.5;     ///< of the norm: Newton's increment is as good as exact
constexpr double first_local_damping = 1e-4; ///< of the mean stiffness over the mean mass (measured: 1e-6 to 1e-4)
constexpr double largest_local_damping = 1e3;
constexpr double least_local_damping = 1e-12;
constexpr double local_linear_residual = 1e-3; ///< of the forces
constexpr int max_local_refinements = 60;      ///< Krylov vectors
constexpr double local_growth = 6.0;           ///< of the damping, where the norm does not fall

/// Damped Newton on the free blocks of a part.
class DampedPart {
public:
    explicit DampedPart(const PartOfBody& part)
        : part_(part), pattern_(part.problem().body.system->n_blocks(), part.pairs()),
          free_pattern_(part.n_free(), pairs_of_free(part)), evaluator_(part.problem(), pattern_), q_(part.start()) {
        const EquilibriumProblem& problem = part.problem();
        for (int i = 0; i < part.n_free(); ++i) {
            masses_.push_back(mass_matrix(problem.body.system->blocks[i], problem.least_mass_area));
            mass_ += masses_.back().trace();
        }
        stiffness_.reset(free_pattern_);
        solver_.analyze(free_pattern_);
        forces_ = forces_at(q_);
    }

    /// Moves the blocks until the forces have fallen to the goal, or do not fall any more.
    void iterate(double negligible) {
        const double goal = std::max(local_goal * forces_.norm(), negligible);
        double damping = 0.0;
        double scale = 0.0;
        bool moved = true;
        for (int i = 0; i < max_local_iterations && forces_.norm() > goal; ++i) {
            if (moved) set_stiffness();
            if (i == 0) scale = stiffness_.trace() / mass_;
            if (i == 0) damping = first_local_damping * scale;
            double ratio = 1.0;
            Eigen::VectorXd trial, forces;
            if (find_increment(damping)) {
                trial = q_ + increment_;
                forces = forces_at(trial);
                ratio = forces.norm() / forces_.norm();
            }
            moved = ratio < 1.0 - least_local_fall;
            if (!moved && damping > largest_local_damping * scale) return;
            damping = moved ? std::max(least_local_damping * scale, (ratio < large_local_fall ? 0.1 : 0.3) * damping)
                            : local_growth * damping;
            if (!moved) continue;
            q_ = std::move(trial);
            forces_ = std::move(forces);
        }
    }

    [[nodiscard]] const Eigen::VectorXd& displacement() const { return q_; }

private:
    static std::vector<std::pair<int, int>> pairs_of_free(const PartOfBody& part) {
        std::vector<std::pair<int, int>> pairs = part.pairs();
        std::erase_if(pairs, [&](const auto& pair) { return std::max(pair.first, pair.second) >= part.n_free(); });
        return pairs;
    }
    Eigen::VectorXd forces_at(const Eigen::VectorXd& q) {
        evaluator_.residual(q, residual_);
        part_.problem().body.loads->constraints.project(residual_.forces);
        return residual_.forces.head(n_block_unknowns * static_cast<Eigen::Index>(part_.n_free()));
    }
    void set_stiffness() {
        evaluator_.tangent(q_, TangentKind::exact, tangent_);
        for (int row = 0; row < part_.n_free(); ++row)
            for (int e = free_pattern_.row_start(row); e < free_pattern_.row_start(row + 1); ++e)
                stiffness_.values[e] = tangent_.values[pattern_.find(row, free_pattern_.column(e))];
        project(part_.problem().body.loads->constraints, stiffness_,
                stiffness_.trace() / (n_block_unknowns * part_.n_free()));
    }
    [[nodiscard]] BlockMatrix damped(double damping) const {
        BlockMatrix sum = stiffness_;
        for (int i = 0; i < part_.n_free(); ++i) sum.values[free_pattern_.diagonal(i)] += damping * masses_[i]; // (29c)
        return sum;
    }
    /// Prescribed displacements hold in it to the bit.
    bool find_increment(double damping) {
        const BlockMatrix matrix = damped(damping);
        if (!solver_.factorize(matrix, Factorization::rounded_lu)) return false;
        const SolveGoal goal{.residual = local_linear_residual * forces_.norm()};
        Eigen::VectorXd of_free;
        if (!solver_.solve(matrix, -forces_, goal, max_local_refinements, of_free).accepted) return false;
        increment_.setZero(q_.size());
        increment_.head(of_free.size()) = of_free;
        part_.problem().body.loads->constraints.project(increment_);
        return true;
    }

    const PartOfBody& part_;
    BlockPattern pattern_, free_pattern_;
    EquilibriumEvaluator evaluator_;
    LinearSolver solver_;
    std::vector<Mat6> masses_;
    double mass_ = 0.0;
    BlockMatrix tangent_, stiffness_;
    Residual residual_;
    Eigen::VectorXd q_, increment_; ///< of all blocks of the part
    Eigen::VectorXd forces_;        ///< on the free ones
};

/// The few blocks that together have most of the forces; none where they are not few.
std::vector<int> loaded_blocks(const Eigen::VectorXd& free_forces, int n_blocks, double largest_part) {
    std::vector<std::pair<double, int>> squares;
    squares.reserve(n_blocks);
    for (int b = 0; b < n_blocks; ++b)
        squares.emplace_back(free_forces.segment<n_block_unknowns>(n_block_unknowns * b).squaredNorm(), b);
    const auto few = static_cast<std::size_t>(std::min(max_chosen, largest_part * n_blocks));
    const auto end = squares.begin() + static_cast<std::ptrdiff_t>(std::min(few, squares.size()));
    std::ranges::partial_sort(squares, end, std::greater());
    double missing = chosen_share * chosen_share * free_forces.head(n_block_unknowns * n_blocks).squaredNorm();
    std::vector<int> chosen;
    for (auto at = squares.begin(); at != end && missing > 0.0; ++at) {
        missing -= at->first;
        chosen.push_back(at->second);
    }
    if (missing > 0.0) chosen.clear();
    return chosen;
}

/// With the blocks that they touch, in ascending order.
std::vector<int> with_neighbours(std::vector<int> blocks, const Surroundings& surroundings) {
    for (std::size_t i = 0, n = blocks.size(); i < n; ++i) {
        const std::vector<int> neighbours = surroundings.neighbours(blocks[i]);
        blocks.insert(blocks.end(), neighbours.begin(), neighbours.end());
    }
    std::ranges::sort(blocks);
    blocks.erase(std::unique(blocks.begin(), blocks.end()), blocks.end());
    return blocks;
}

std::vector<std::vector<int>> connected_groups(const std::vector<int>& blocks, const Surroundings& surroundings) {
    std::vector<int> index(surroundings.problem().body.system->blocks.size(), -1);
    for (int i = 0; i < static_cast<int>(blocks.size()); ++i) index[blocks[i]] = i;
    DisjointSets sets(static_cast<int>(blocks.size()));
    for (int i = 0; i < static_cast<int>(blocks.size()); ++i)
        for (const int other : surroundings.neighbours(blocks[i]))
            if (index[other] >= 0) sets.join(i, index[other]);
    std::vector<std::vector<int>> groups(blocks.size());
    for (int i = 0; i < static_cast<int>(blocks.size()); ++i) groups[sets.root(i)].push_back(blocks[i]);
    std::erase_if(groups, [](const std::vector<int>& group) { return group.empty(); });
    return groups;
}

} // namespace

bool LocalIteration::improve(const Eigen::VectorXd& free_forces, double largest_part, double negligible,
                             Eigen::VectorXd& q) {
    const std::vector<int> loaded = loaded_blocks(free_forces, problem_.body.system->n_blocks(), largest_part);
    if (loaded.empty()) return false;
    improve(loaded, negligible, q);
    return true;
}

void LocalIteration::improve(const std::vector<int>& blocks, double negligible, Eigen::VectorXd& q) {
    if (!surroundings_) surroundings_.emplace(problem_);
    for (const std::vector<int>& group : connected_groups(with_neighbours(blocks, *surroundings_), *surroundings_)) {
        const PartOfBody part(*surroundings_, group, q);
        DampedPart damped(part);
        damped.iterate(negligible);
        part.copy_back(damped.displacement(), q);
    }
}

} // namespace kluft
