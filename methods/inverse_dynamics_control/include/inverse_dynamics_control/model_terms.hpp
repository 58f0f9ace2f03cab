// SPDX-License-Identifier: Apache-2.0
/// @file
/// A solver's terms without those that the robot compensates by itself.
///
///     ModelTerms model(solver, compensated, "computed torque");
///     model.torques(q, qd, a, tau);   // H(q) a + C(q, qd) qd + g(q), or what is left of it
#pragma once

#include <chain_dynamics/chain.hpp>
#include <chain_dynamics/friction_state.hpp>
#include <chain_dynamics/owned.hpp>
#include <inverse_dynamics_solver/inverse_dynamics_solver.hpp>
#include <memory>
#include <string>
#include <vector>

#include "inverse_dynamics_control/compensated.hpp"
#include "inverse_dynamics_control/signals.hpp"

namespace inverse_dynamics_control {
inline namespace v2 {

using inverse_dynamics_solver::ConstVectorRef;
using inverse_dynamics_solver::InverseDynamicsSolver;
using inverse_dynamics_solver::VectorRef;

/// The model that the laws share, with its own scratch memory. Not thread-safe.
///
/// Real time: methods don't allocate, lock or call the system, and throw only what a faulty solver
/// throws.
class ModelTerms {
 public:
  /// @param solver  initialized; it is kept.
  /// @param law     who asks, for the text of errors.
  /// Throws inverse_dynamics_solver::InvalidParameterValueException: no solver; shares that aren't one or
  /// one of each joint, or not from 0 to 1.
  /// UninitializedException: the solver isn't initialized.
  ModelTerms(std::shared_ptr<const InverseDynamicsSolver> solver, const Compensated& compensated,
             const std::string& law);

  Eigen::Index jointCount() const noexcept { return H_.rows(); }
  const std::vector<std::string>& jointNames() const { return solver_->jointNames(); }
  const std::vector<chain_dynamics::JointType>& jointTypes() const { return solver_->jointTypes(); }
  bool inertiaIsPhysical() const { return solver_->inertiaIsPhysical(); }

  /// Adds whole turns to q where a joint is continuous, so that it is nearest to the reference.
  void unwrap(const ConstVectorRef& reference, VectorRef q) const noexcept {
    chain_dynamics::unwrap(jointTypes(), reference, q);
  }

  /// `H(q) a + C(q, qd) qd + g(q)`, without what is compensated.
  ///
  /// @param q,qd,a    n each; rad, rad/s, rad/s^2 (prismatic m, m/s, m/s^2).
  /// @param[out] tau  n; N m (prismatic N).
  void torques(const ConstVectorRef& q, const ConstVectorRef& qd, const ConstVectorRef& a,
               VectorRef tau);

  /// `H(q)`, n x n, and `C(q, qd) qd + g(q)`, n, without what is compensated.
  void components(const ConstVectorRef& q, const ConstVectorRef& qd,
                  inverse_dynamics_solver::MatrixRef H, VectorRef bias);

  /// `H(q)`, n x n; until the next call.
  const chain_dynamics::OwnedMatrix& inertia(const ConstVectorRef& q) {
    solver_->getInertiaMatrix(q, H_);
    return H_;
  }

  /// The part of `g(q)` that the robot doesn't compensate, n.
  void gravity(const ConstVectorRef& q, VectorRef g) const;

  /// Goes on to the position q, n, of the motion that friction remembers; one that isn't finite is left
  /// out.
  void moveFriction(const ConstVectorRef& q) noexcept { memory_.move(q); }

  /// Forgets that motion.
  void forgetFriction() noexcept { memory_.reset(); }

  /// The part of `f(q, v)`, after the motion so far, that the robot doesn't compensate, n.
  void friction(const ConstVectorRef& q, const ConstVectorRef& v, VectorRef f) const;

  /// What friction remembers at rest, without what the robot compensates, n: `C' fm z`
  /// [chain_dynamics/friction_state.hpp], constant while no joint of the motion moves, and zero before it
  /// begins. The part fs isn't in it: an arm that still moves doesn't have it, and would be pushed on.
  void rememberedFriction(VectorRef f) const noexcept;

  /// Of joint j: the torque of damping to the reference that the arm lacks beside the rest of its friction,
  /// as the robot compensates more of the viscous part than of the others; N m (prismatic N).
  double lostDamping(Eigen::Index j, const ConstVectorRef& qd,
                     const ConstVectorRef& qd_reference) const;

 private:
  std::shared_ptr<const InverseDynamicsSolver> solver_;
  chain_dynamics::OwnedMatrix H_;
  OwnedVector bias_, g_;
  OwnedVector forth_, back_;  // so fast that fs is zero; of opposite signs
  // n each: shares that the robot doesn't compensate; friction but for the viscous part
  OwnedVector gravity_, coriolis_, friction_, viscous_;
  chain_dynamics::FrictionState memory_;
  // n x n: torques of viscous friction by velocities; joints that share motors have them of each other
  chain_dynamics::OwnedMatrix V_;
};

}  // namespace v2
}  // namespace inverse_dynamics_control
