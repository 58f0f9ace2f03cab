// SPDX-License-Identifier: Apache-2.0
/// @file
/// Capability of solvers whose robot was identified at motor-current level.
///
///     if (auto* motors = dynamic_cast<const MotorCurrents*>(solver.get())) {
///       Eigen::VectorXd i = motors->getCurrents(q, qd, qdd);   // K i = getTorques(q, qd, qdd)
///     }
#pragma once

#include <Eigen/Core>

namespace inverse_dynamics_solver {
inline namespace v2 {

/// The motor currents of each term of the dynamics: torque = K current, K the drive gains.
///
/// Not a base of InverseDynamicsSolver: a solver that has it derives from both, and overrides
/// `compute...`. Arguments, order, real-time and thread promises, and errors (uninitialized, wrong
/// size) are those of the solver's method of the same term.
class MotorCurrents {
 public:
  virtual ~MotorCurrents();

  /// @name By value
  /// @{

  /// Currents of a motion [A], n: `K^-1 tau`. All terms, friction too unless it is switched off.
  Eigen::VectorXd getCurrents(const Eigen::Ref<const Eigen::VectorXd>& q,
                              const Eigen::Ref<const Eigen::VectorXd>& qd,
                              const Eigen::Ref<const Eigen::VectorXd>& qdd) const {
    Eigen::VectorXd currents(motorCount());
    computeCurrents(q, qd, qdd, currents);
    return currents;
  }

  /// Current per acceleration [A s^2/rad], n x n: `K^-1 H(q)`.
  Eigen::MatrixXd getInertiaCurrents(const Eigen::Ref<const Eigen::VectorXd>& q) const {
    Eigen::MatrixXd currents(motorCount(), motorCount());
    computeInertiaCurrents(q, currents);
    return currents;
  }

  /// Coriolis and centrifugal currents [A], n: `K^-1 C(q, qd) qd`.
  Eigen::VectorXd getCoriolisCurrents(const Eigen::Ref<const Eigen::VectorXd>& q,
                                      const Eigen::Ref<const Eigen::VectorXd>& qd) const {
    Eigen::VectorXd currents(motorCount());
    computeCoriolisCurrents(q, qd, currents);
    return currents;
  }

  /// Currents that hold the robot still [A], n: `K^-1 g(q)`.
  Eigen::VectorXd getGravityCurrents(const Eigen::Ref<const Eigen::VectorXd>& q) const {
    Eigen::VectorXd currents(motorCount());
    computeGravityCurrents(q, currents);
    return currents;
  }

  /// Currents against friction [A], n: `K^-1 f(qd)`.
  Eigen::VectorXd getFrictionCurrents(const Eigen::Ref<const Eigen::VectorXd>& qd) const {
    Eigen::VectorXd currents(motorCount());
    computeFrictionCurrents(qd, currents);
    return currents;
  }

  /// Drive gains K [N m/A; prismatic N/A], n x n, diagonal.
  Eigen::MatrixXd getDriveGainsMatrix() const {
    Eigen::VectorXd gains(motorCount());
    computeDriveGains(gains);
    return gains.asDiagonal();
  }
  /// @}

 protected:
  using ConstVectorRef = Eigen::Ref<const Eigen::VectorXd>;
  using VectorRef = Eigen::Ref<Eigen::VectorXd>;
  using MatrixRef = Eigen::Ref<Eigen::MatrixXd>;

  MotorCurrents() = default;
  MotorCurrents(const MotorCurrents&) = default;
  MotorCurrents& operator=(const MotorCurrents&) = default;

  /// @name What a solver computes
  /// The method of the same name without `compute`. Outputs have motorCount() rows; sizes of inputs
  /// are the solver's to check.
  /// @{

  /// n; throws UninitializedException.
  virtual Eigen::Index motorCount() const = 0;
  virtual void computeCurrents(const ConstVectorRef& q, const ConstVectorRef& qd,
                               const ConstVectorRef& qdd, VectorRef currents) const = 0;
  virtual void computeInertiaCurrents(const ConstVectorRef& q, MatrixRef currents) const = 0;
  virtual void computeCoriolisCurrents(const ConstVectorRef& q, const ConstVectorRef& qd,
                                       VectorRef currents) const = 0;
  virtual void computeGravityCurrents(const ConstVectorRef& q, VectorRef currents) const = 0;
  virtual void computeFrictionCurrents(const ConstVectorRef& qd, VectorRef currents) const = 0;
  /// The diagonal of K.
  virtual void computeDriveGains(VectorRef gains) const = 0;
  /// @}
};

}  // namespace v2
}  // namespace inverse_dynamics_solver
