#include "kluft/reference/explicit_motion.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <Eigen/LU>

#include "kluft/core/dense_decompositions.hpp"
#include "kluft/loading/stored_energy.hpp"
#include "kluft/reference/block_inertia.hpp"

namespace kluft {

namespace {

/// Pseudo-inverse of P M P, whose eigenvalues in free directions are no less than the smallest of M.
Mat6 free_mobility(const Mat6& projector, const Mat6& mass) {
    const Mat6 reduced = projector * mass * projector;
    const SymmetricEigen eigen = symmetric_eigen(0.5 * (reduced + reduced.transpose()));
    const double least = 0.5 * symmetric_eigenvalues(mass).minCoeff();
    Mat6 mobility = Mat6::Zero();
    for (int i = 0; i < 6; ++i) {
        const double inertia = eigen.values[i];
        if (inertia <= least) continue;
        mobility += eigen.vectors.col(i) * eigen.vectors.col(i).transpose() / inertia;
    }
    return mobility;
}

/// -1, 0 or 1.
double sign_of(double x) { return static_cast<double>((x > 0.0) - (x < 0.0)); }

/// -alpha |f| sign(v), component by component.
Vec6 local_damping(double alpha, const Vec6& force, const Vec6& velocity) {
    Vec6 damping;
    for (int i = 0; i < 6; ++i) {
        damping[i] = -alpha * std::abs(force[i]) * sign_of(velocity[i]);
    }
    return damping;
}

auto of_block(Eigen::VectorXd& v, int block) { return v.segment<n_block_unknowns>(n_block_unknowns * block); }
auto of_block(const Eigen::VectorXd& v, int block) { return v.segment<n_block_unknowns>(n_block_unknowns * block); }

} // namespace

double EnergyBalance::error() const {
    double become = 0.0;
    double largest = std::abs(external_work);
    for (const double term : {block_energy, spring_energy, kinetic_energy, friction_energy, damping_energy,
                              crack_energy, detection_energy}) {
        become += term;
        largest = std::max(largest, std::abs(term));
    }
    return largest > 0.0 ? (external_work - become) / largest : 0.0;
}

ExplicitMotion::ExplicitMotion(const LoadedBody& body, Placement placement, Loads loads, std::vector<Mat6> masses,
                               double damping, Eigen::VectorXd q)
    : placement_(std::move(placement)), loads_(std::move(loads)), body_(body), masses_(std::move(masses)),
      damping_(damping), q_(std::move(q)) {
    body_.placement = &placement_;
    body_.loads = &loads_;
    velocity_.setZero(q_.size());
    external_.setZero(q_.size());
    damping_force_.setZero(q_.size());
    increment_.setZero(q_.size());
    for (const Mat6& mass : masses_) inverse_masses_.push_back(mass.inverse());
    restart();
    last_time_step_ = time_step_;
}

void ExplicitMotion::restart() {
    time_step_ = stable_time_step(largest_frequency(stiffness_bounds(body_), masses_), damping_);
    hold_blocks();
    kept_.clear();
    for (const ContactPoint& point : placement_.contacts) {
        const auto traction = contact_traction(*body_.laws, point, q_);
        kept_.push_back({traction.normal, traction.shear, traction.history.dilation});
    }
}

void ExplicitMotion::hold_blocks() {
    holds_.clear();
    held_.assign(masses_.size(), 0);
    travel_mass_ = 0.0;
    const Eigen::VectorXd travel = loads_.constraints.travel_motion(q_.size());
    for (const ConstrainedBlock& constrained : loads_.constraints.blocks()) {
        const int b = constrained.block;
        HeldBlock hold;
        hold.block = b;
        hold.projector = constrained.projector;
        hold.mobility = free_mobility(constrained.projector, masses_[b]);
        hold.free_part = hold.mobility * masses_[b];
        hold.travel = of_block(travel, b) - hold.free_part * of_block(travel, b);
        travel_mass_ += hold.travel.dot(masses_[b] * hold.travel);
        held_[b] = 1;
        holds_.push_back(hold);
    }
    if (travel_mass_ == 0.0) travel_velocity_ = 0.0;
}

void ExplicitMotion::update_platens() {
    if (!update_platen_points(*body_.system, q_, forces_.forces, true, loads_)) return;
    hold_by_platens(body_, q_, loads_);
    hold_blocks();
}

/// What slid since the last time step is history now; its work was lost.
void ExplicitMotion::keep_histories() {
    for (std::size_t i = 0; i < placement_.contacts.size(); ++i) {
        ContactPoint& point = placement_.contacts[i];
        const PointTraction& traction = tractions_[i];
        Kept& kept = kept_[i];
        const double slip = gap_and_slip(point, q_).slip;
        const InterfaceLaw& law = (*body_.laws)[point.law];
        if (traction.shear != 0.0 || kept.shear != 0.0) {
            const double elastic = (traction.shear - kept.shear) / law.shear_stiffness;
            const double dilation = traction.history.dilation - kept.dilation;
            spent_.friction_energy += point.weight * (0.5 * (traction.shear + kept.shear) * (slip - elastic) +
                                                      0.5 * (traction.normal + kept.normal) * dilation);
        }
        kept = {traction.normal, traction.shear, traction.history.dilation};
        point.history = traction.history;
        point.slip_start += slip;
    }
}

void ExplicitMotion::accelerate_free_blocks(double interval) {
    for (int b = 0; b < static_cast<int>(masses_.size()); ++b) {
        if (held_[b]) continue;
        const Vec6 force = -of_block(forces_.forces, b);
        const Vec6 damping = local_damping(damping_, force, of_block(velocity_, b));
        of_block(damping_force_, b) = damping;
        unbalanced_ += force.squaredNorm();
        of_block(increment_, b) = interval * (inverse_masses_[b] * (force + damping));
    }
}

/// The free motion of the held blocks, and the travel of a platen that is loaded by stress. Both are without inertia
/// for each other.
void ExplicitMotion::accelerate_held_blocks(double interval) {
    double on_travel = travel_mass_ > 0.0 && loads_.platen_force ? loads_.platen_force->at(q_) : 0.0;
    for (const HeldBlock& hold : holds_) {
        const Vec6 force = -of_block(forces_.forces, hold.block);
        const Vec6 free_force = hold.projector * force;
        const Vec6 free_velocity = hold.free_part * of_block(velocity_, hold.block);
        const Vec6 damping = hold.projector * local_damping(damping_, free_force, free_velocity);
        of_block(damping_force_, hold.block) = damping;
        unbalanced_ += free_force.squaredNorm();
        on_travel += hold.travel.dot(force);
        // The prescribed part is found anew from where the supports and platens are.
        of_block(increment_, hold.block) =
            free_velocity + interval * (hold.mobility * (free_force + damping)) - of_block(velocity_, hold.block);
    }
    if (travel_mass_ == 0.0) return;
    unbalanced_ += on_travel * on_travel;
    const double damping = damping_ * std::abs(on_travel) * sign_of(travel_velocity_);
    travel_velocity_ += interval * (on_travel - damping) / travel_mass_;
    for (const HeldBlock& hold : holds_) of_block(increment_, hold.block) += travel_velocity_ * hold.travel;
}

void ExplicitMotion::advance() {
    body_forces(body_, q_, forces_, tractions_);
    keep_histories();
    external_forces(body_, q_, external_);
    const double interval = 0.5 * (last_time_step_ + time_step_);
    unbalanced_ = 0.0;
    accelerate_free_blocks(interval);
    accelerate_held_blocks(interval);
    unbalanced_ = std::sqrt(unbalanced_);

    const Eigen::VectorXd before = velocity_;
    velocity_ += increment_;
    q_ += time_step_ * velocity_;
    loads_.constraints.correction(q_, correction_);
    for (const HeldBlock& hold : holds_) {
        const Vec6 missing = of_block(correction_, hold.block);
        const Vec6 prescribed = missing - hold.free_part * missing;
        of_block(q_, hold.block) += prescribed;
        of_block(velocity_, hold.block) += prescribed / time_step_;
    }

    const double damped = 0.5 * interval * damping_force_.dot(before + velocity_);
    spent_.damping_energy -= damped;
    spent_.external_work += 0.5 * interval * external_.dot(before + velocity_);
    for (const HeldBlock& hold : holds_) {
        const int b = hold.block;
        const Vec6 old_velocity = of_block(before, b);
        const Vec6 new_velocity = of_block(velocity_, b);
        const Vec6 reaction = masses_[b] * (new_velocity - old_velocity) / interval + of_block(forces_.forces, b) -
                              of_block(damping_force_, b);
        spent_.external_work += 0.5 * interval * reaction.dot(old_velocity + new_velocity);
    }
    last_time_step_ = time_step_;
}

const BodyForces& ExplicitMotion::evaluate() {
    body_forces(body_, q_, forces_, tractions_);
    keep_histories();
    body_forces(body_, q_, magnitudes_);
    return magnitudes_;
}

double ExplicitMotion::springs_energy() const {
    double energy = 0.0;
    for (const Bond& bond : placement_.bonds) energy += bond_energy(body_, bond, q_);
    for (const ContactPoint& point : placement_.contacts) energy += contact_energy(body_, point, q_);
    return energy;
}

/// Work and velocity are half a time step behind the displacements; what is missing is added here.
EnergyBalance ExplicitMotion::energies() {
    evaluate();
    external_forces(body_, q_, external_);
    EnergyBalance energy = spent_;
    energy.spring_energy = springs_energy();
    for (int b = 0; b < static_cast<int>(masses_.size()); ++b) {
        const Block& block = body_.system->blocks[b];
        energy.block_energy += block.area * strain_energy_density(deformation_gradient(q_, b, block.size),
                                                                  (*body_.moduli)[block.material]);
        const Vec6 v = of_block(velocity_, b);
        const Vec6 force = -of_block(forces_.forces, b);
        const double half = 0.5 * last_time_step_;
        energy.kinetic_energy += 0.5 * v.dot(masses_[b] * v);
        energy.external_work += half * v.dot(of_block(external_, b));
        if (held_[b]) {
            // As if the supports and platens kept their velocity: their force balances what does not move freely.
            const auto hold = std::ranges::lower_bound(holds_, b, {}, &HeldBlock::block);
            const Vec6 damping =
                hold->projector * local_damping(damping_, hold->projector * force, hold->free_part * v);
            const Vec6 total = force + damping;
            const Vec6 reaction = masses_[b] * (hold->mobility * total) - total;
            energy.damping_energy -= half * v.dot(damping);
            energy.external_work += half * v.dot(reaction);
            energy.kinetic_energy += half * v.dot(total + reaction);
        } else {
            const Vec6 damping = local_damping(damping_, force, v);
            energy.damping_energy -= half * v.dot(damping);
            energy.kinetic_energy += half * v.dot(force + damping);
        }
    }
    return energy;
}

} // namespace kluft
