// SPDX-License-Identifier: Apache-2.0
/// @file
/// Capability of solvers whose robot was identified at motor-current level.
///
///     if (auto* motors = dynamic_cast<const MotorCurrents*>(solver.get())) {
///       Eigen::VectorXd i = motors->getCurrents(q, qd, qdd);   // K i = getTorques(q, qd, qdd)
///     }
#pragma once

#include <Eigen/Core>

#include "inverse_dynamics_solver/capability.hpp"

namespace inverse_dynamics_solver {
inline namespace v2 {

/// The motor currents of each term of the dynamics: torque = K current, K the drive gains.
///
/// Arguments are those of the solver's method of the same term.
class MotorCurrents : public Capability {
 public:
  ~MotorCurrents() override;

  /// @name By value
  /// @{

  /// Currents of a motion [A], n: `K^-1 tau`. All terms, friction too unless it is switched off.
  Eigen::VectorXd getCurrents(const ConstVectorRef& q, const ConstVectorRef& qd,
                              const ConstVectorRef& qdd) const {
    Eigen::VectorXd i(gains("getCurrents").size());
    getCurrents(q, qd, qdd, i);
    return i;
  }

  /// Current per acceleration [A s^2/rad], n x n: `K^-1 H(q)`.
  Eigen::MatrixXd getInertiaCurrents(const ConstVectorRef& q) const {
    const Eigen::Index n = gains("getInertiaCurrents").size();
    Eigen::MatrixXd i(n, n);
    getInertiaCurrents(q, i);
    return i;
  }

  /// Coriolis and centrifugal currents [A], n: `K^-1 C(q, qd) qd`.
  Eigen::VectorXd getCoriolisCurrents(const ConstVectorRef& q, const ConstVectorRef& qd) const {
    Eigen::VectorXd i(gains("getCoriolisCurrents").size());
    getCoriolisCurrents(q, qd, i);
    return i;
  }

  /// Currents that hold the robot still [A], n: `K^-1 g(q)`.
  Eigen::VectorXd getGravityCurrents(const ConstVectorRef& q) const {
    Eigen::VectorXd i(gains("getGravityCurrents").size());
    getGravityCurrents(q, i);
    return i;
  }

  /// Currents against friction [A], n: `K^-1 f(qd)`. Throws as the solver's getFrictionVector(qd).
  Eigen::VectorXd getFrictionCurrents(const ConstVectorRef& qd) const {
    return getFrictionCurrents(Eigen::VectorXd(), qd);
  }

  /// The same of any solver: `K^-1 f(q, qd)`.
  [[nodiscard]] Eigen::VectorXd getFrictionCurrents(const ConstVectorRef& q,
                                                    const ConstVectorRef& qd) const {
    Eigen::VectorXd i(gains("getFrictionCurrents").size());
    getFrictionCurrents(q, qd, i);
    return i;
  }

  /// Drive gains K [N m/A; prismatic N/A], n x n, diagonal.
  Eigen::MatrixXd getDriveGainsMatrix() const { return gains("getDriveGainsMatrix").asDiagonal(); }
  /// @}

  /// @name Into memory of the caller, without allocation
  /// @{
  void getCurrents(const ConstVectorRef& q, const ConstVectorRef& qd, const ConstVectorRef& qdd,
                   VectorRef i) const;
  void getInertiaCurrents(const ConstVectorRef& q, MatrixRef i) const;
  void getCoriolisCurrents(const ConstVectorRef& q, const ConstVectorRef& qd, VectorRef i) const;
  void getGravityCurrents(const ConstVectorRef& q, VectorRef i) const;
  void getFrictionCurrents(const ConstVectorRef& q, const ConstVectorRef& qd, VectorRef i) const;
  /// @}

 protected:
  using Gains = Eigen::Map<const Eigen::VectorXd>;

  /// The diagonal of K, n numbers other than zero. Called after a successful initialize().
  virtual Gains driveGains() const = 0;

 private:
  Gains gains(const char* method) const;  // throws UninitializedException
};

}  // namespace v2
}  // namespace inverse_dynamics_solver
