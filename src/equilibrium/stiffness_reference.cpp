#include "kluft/equilibrium/stiffness_reference.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "kluft/kinematics/affine.hpp"

namespace kluft {

namespace {

constexpr double least_change = 0.02;     ///< of the largest stiffness of the patch
constexpr double least_mass_change = 0.2; ///< of the block's stiffness
constexpr double same_projector = 0.1;    ///< a platen turns with the body that it is laid on

/// A row over the unknowns of a block, in the free motions; that of a rigid block in the first three places.
void make_free(const EquilibriumProblem& problem, const Eigen::VectorXd& q, int block, Vec6& row) {
    if (problem.body.kinematics == Kinematics::rigid) {
        const Vec3 reduced = rigid_motion(q, block, problem.body.system->blocks[block].size).transpose() * row;
        row << reduced, 0.0, 0.0, 0.0;
    }
    problem.body.loads->constraints.project(block, row);
}

void set_rows(const EquilibriumProblem& problem, const Eigen::VectorXd& q, const ContactPoint& point, int first,
              StiffnessChange& change) {
    const std::array<Vec2, 2> directions{point.normal, point.tangent};
    for (int i = 0; i < 2; ++i) {
        Vec6 on_a = -displacement_row(directions[i], point.xi_a);
        Vec6 on_b = displacement_row(directions[i], point.xi_b);
        make_free(problem, q, point.block_a, on_a);
        make_free(problem, q, point.block_b, on_b);
        change.rows_a.row(first + i) = on_a;
        change.rows_b.row(first + i) = on_b;
    }
}

/// Without what a tilt of the faces changes, which is left to the refinement.
Mat2 stiffness_of(const PointTraction& traction, TangentKind kind) {
    if (kind == TangentKind::symmetric) return symmetric_tangent(traction);
    return traction.state == ContactState::open ? Mat2::Zero() : traction.tangent;
}

/// Adds a stiffness at the place s of an overlap to that of its ends.
void add_at(double s, const Mat2& stiffness, Eigen::Matrix4d& ends) {
    const std::array<double, 2> share{1.0 - s, s};
    for (int i = 0; i < 2; ++i) {
        for (int j = 0; j < 2; ++j) ends.block<2, 2>(2 * i, 2 * j) += share[i] * share[j] * stiffness;
    }
}

/// eta M of a block for a change of its eta; that of a rigid block in the first three places.
Mat6 mass_on_unknowns(const EquilibriumProblem& problem, const Eigen::VectorXd& q, int b, double eta) {
    const Block& block = problem.body.system->blocks[b];
    Mat6 mass = eta * mass_matrix(block, problem.least_mass_area);
    if (problem.body.kinematics == Kinematics::rigid) {
        const Mat63 motion = rigid_motion(q, b, block.size);
        mass.topLeftCorner<n_rigid_unknowns, n_rigid_unknowns>() = (motion.transpose() * mass * motion).eval();
    }
    return mass;
}

std::vector<std::pair<int, Mat6>> held_projectors(const EquilibriumProblem& problem) {
    std::vector<std::pair<int, Mat6>> held;
    for (const ConstrainedBlock& each : problem.body.loads->constraints.blocks())
        held.emplace_back(each.block, each.projector);
    std::ranges::sort(held, {}, [](const auto& each) { return each.first; });
    return held;
}

} // namespace

StiffnessReference::Key StiffnessReference::key_of(const ContactKey& k) {
    return {k.block_a, k.edge_a, k.block_b, k.edge_b, k.point < 0 ? 1 : 0};
}

/// The patches of the contacts, which are sorted, with their stiffness at q.
void StiffnessReference::collect(const EquilibriumProblem& problem, const Eigen::VectorXd& q, TangentKind kind,
                                 std::vector<Patch>& patches) {
    patches.clear();
    for (int i = 0; i < static_cast<int>(problem.body.placement->contacts.size()); ++i) {
        const ContactPoint& point = problem.body.placement->contacts[i];
        const Key key = key_of(point.key);
        if (patches.empty() || patches.back().key != key) {
            Patch patch;
            patch.key = key;
            patch.change.block_a = point.block_a;
            patch.change.block_b = point.block_b;
            patch.change.n_rows = point.key.point < 0 ? 2 : 4;
            patches.push_back(patch);
        }
        Patch& patch = patches.back();
        patch.scale += point.weight * (*problem.body.laws)[point.law].normal_stiffness;
        const Mat2 stiffness = point.weight * stiffness_of(contact_traction(problem.body, i, q), kind);
        if (point.key.point < 0) {
            set_rows(problem, q, point, 0, patch.change);
            patch.change.stiffness.topLeftCorner<2, 2>() += stiffness;
            continue;
        }
        if (point.along == 0.0) set_rows(problem, q, point, 0, patch.change);
        if (point.along == 1.0) set_rows(problem, q, point, 2, patch.change);
        add_at(point.along, stiffness, patch.change.stiffness);
    }
}

void StiffnessReference::take(const EquilibriumProblem& problem, const Eigen::VectorXd& q, TangentKind kind,
                              const BlockMatrix& tangent) {
    taken_ = true;
    kind_ = kind;
    eta_ = problem.eta;
    const int nu = tangent.pattern->block_unknowns();
    diagonal_.resize(nu * tangent.pattern->n_blocks());
    for (int b = 0; b < tangent.pattern->n_blocks(); ++b) {
        const int entry = tangent.pattern->diagonal(b);
        if (tangent.is_rigid()) {
            diagonal_.segment(nu * b, nu) = tangent.rigid_values[entry].diagonal();
        } else {
            diagonal_.segment(nu * b, nu) = tangent.values[entry].diagonal();
        }
    }
    collect(problem, q, kind, reference_);
    bonded_.clear();
    for (const Bond& bond : problem.body.placement->bonds) bonded_.push_back(bond.interface);
    numbers_.clear();
    held_ = held_projectors(problem);
}

int StiffnessReference::n_held_otherwise(const EquilibriumProblem& problem) const {
    const auto held = held_projectors(problem);
    int n = 0;
    auto before = held_.begin();
    auto now = held.begin();
    while (before != held_.end() || now != held.end()) {
        const bool is_new = before == held_.end() || (now != held.end() && now->first < before->first);
        const bool is_gone = now == held.end() || (before != held_.end() && before->first < now->first);
        if (is_new || is_gone || (before->second - now->second).norm() > same_projector) ++n;
        if (!is_new) ++before;
        if (!is_gone) ++now;
    }
    return n;
}

/// A broken bond was a patch of the reference, along its whole edge.
void StiffnessReference::add_broken_bonds(const EquilibriumProblem& problem) {
    std::vector<int> bonded;
    for (const Bond& bond : problem.body.placement->bonds) bonded.push_back(bond.interface);
    if (bonded.size() == bonded_.size()) return;
    std::vector<int> broken;
    std::ranges::set_difference(bonded_, bonded, std::back_inserter(broken));
    for (const int i : broken) {
        const Interface& interface = problem.body.system->interfaces[i];
        const InterfaceLaw& law = (*problem.body.laws)[law_of(interface)];
        const Edge& edge = problem.body.system->blocks[interface.block_a].edges[interface.edge_a];
        const double length = (edge_end(*problem.body.system, edge) - edge_start(*problem.body.system, edge)).norm();
        Patch patch;
        patch.key = key_of(key_of_own_edges(interface, 0));
        patch.scale = length * law.normal_stiffness;
        const Mat2 stiffness = length * bond_traction(law, 0.0, 0.0, 0.0).tangent;
        for (const double s : gauss_positions) add_at(s, stiffness / n_bond_points, patch.change.stiffness);
        reference_.push_back(patch);
    }
    bonded_ = std::move(bonded);
    std::ranges::stable_sort(reference_, {}, &Patch::key);
}

const std::vector<StiffnessChange>& StiffnessReference::changes(const EquilibriumProblem& problem,
                                                                const Eigen::VectorXd& q) {
    add_broken_bonds(problem);
    collect(problem, q, kind_, now_);
    changes_.clear();
    const auto keep = [&](const Patch& patch, const Eigen::Matrix4d& change, double scale) {
        if (patch.change.rows_a.isZero(0.0)) return; // a broken bond that is not near any more
        if (change.cwiseAbs().maxCoeff() <= least_change * scale) return;
        changes_.push_back(patch.change);
        changes_.back().stiffness = change;
        changes_.back().patch = number_of(patch.key);
    };
    auto before = reference_.begin();
    for (const Patch& patch : now_) {
        for (; before != reference_.end() && before->key < patch.key; ++before) {
            keep(*before, -before->change.stiffness, before->scale); // separated
        }
        if (before != reference_.end() && before->key == patch.key) {
            keep(patch, patch.change.stiffness - before->change.stiffness, std::max(patch.scale, before->scale));
            ++before;
        } else {
            keep(patch, patch.change.stiffness, patch.scale);
        }
    }
    for (; before != reference_.end(); ++before) keep(*before, -before->change.stiffness, before->scale);
    add_masses(problem, q);
    return changes_;
}

/// Relaxation changes eta by powers of four on single blocks. A loose block has no other stiffness.
void StiffnessReference::add_masses(const EquilibriumProblem& problem, const Eigen::VectorXd& q) {
    const auto eta_at = [](const std::vector<double>& eta, int b) { return eta.empty() ? 0.0 : eta[b]; };
    for (int b = 0; b < problem.body.system->n_blocks(); ++b) {
        const double change = eta_at(problem.eta, b) - eta_at(eta_, b);
        if (change != 0.0) add_mass(problem, b, mass_on_unknowns(problem, q, b, change));
    }
}

/// Adds a change of the mass-like stiffness of a block, as far as it counts beside the others; that of a rigid block
/// stands in the first three places.
void StiffnessReference::add_mass(const EquilibriumProblem& problem, int b, const Mat6& mass) {
    const int nu = unknowns_per_block(problem.body.kinematics);
    const auto diagonal = diagonal_.segment(nu * b, nu);
    for (const auto& [first, n] : {std::pair{0, 2}, std::pair{2, nu - 2}}) { // u, and D or w
        const auto stiffness = mass.block(first, first, n, n);
        const auto share = stiffness.diagonal().cwiseQuotient(diagonal.segment(first, n)).cwiseAbs();
        if (share.maxCoeff() <= least_mass_change) continue;
        StiffnessChange& added = changes_.emplace_back();
        added.patch = number_of({b, -1, b, -1, first});
        added.block_a = added.block_b = b;
        added.n_rows = n;
        for (int i = 0; i < n; ++i) {
            Vec6 row = Vec6::Unit(first + i);
            problem.body.loads->constraints.project(b, row);
            added.rows_a.row(i) = row;
        }
        added.stiffness.topLeftCorner(n, n) = stiffness;
    }
}

} // namespace kluft
