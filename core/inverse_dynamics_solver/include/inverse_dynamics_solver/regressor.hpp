// SPDX-License-Identifier: Apache-2.0
/// @file
/// Capability: the torques as a linear function of the inertial parameters.
///
///     if (const auto* bodies = dynamic_cast<const Regressor*>(solver.get())) {
///       Eigen::MatrixXd Y = bodies->getRegressor(q, qd, qdd);   // tau = Y p, without friction
///     }
#pragma once

#include <Eigen/Core>

#include "inverse_dynamics_solver/capability.hpp"

namespace inverse_dynamics_solver {
inline namespace v2 {

/// `Y(q, qd, qdd)`, which depends on the robot's geometry and gravity alone: of rigid bodies,
/// whatever parameters and friction a model has.
class Regressor : public Capability {
 public:
  ~Regressor() override;

  /// Number of links l that joints move: n, of a tree also those whose joints mimic others.
  Eigen::Index linkCount() const { return linksFor("linkCount"); }

  /// `Y`, n x 10 l, with `tau = Y p` for any parameters p: ten columns per link, in the order of
  /// their joints, for `[m, mcx, mcy, mcz, Ixx, Ixy, Ixz, Iyy, Iyz, Izz]`, I about the origin of the
  /// link's frame [chain_dynamics/regressor.hpp]. Rotor inertia isn't among them: it adds
  /// `rotor_inertia qdd`, and where motors share joints with rotors also products of these motors.
  Eigen::MatrixXd getRegressor(const ConstVectorRef& q, const ConstVectorRef& qd,
                               const ConstVectorRef& qdd) const {
    Eigen::MatrixXd Y(jointsFor("getRegressor"), 10 * linksFor("getRegressor"));
    getRegressor(q, qd, qdd, Y);
    return Y;
  }
  void getRegressor(const ConstVectorRef& q, const ConstVectorRef& qd, const ConstVectorRef& qdd,
                    MatrixRef Y) const;

  /// Side by side, n x (10 l N). It allocates of a tree, and into memory whose rows don't
  /// stand side by side.
  Eigen::MatrixXd getRegressorBatch(const ConstStatesRef& q, const ConstStatesRef& qd,
                                    const ConstStatesRef& qdd) const {
    Eigen::MatrixXd Y(q.joints, 10 * linksFor("getRegressorBatch") * q.count);
    getRegressorBatch(q, qd, qdd, Y);
    return Y;
  }
  void getRegressorBatch(const ConstStatesRef& q, const ConstStatesRef& qd,
                         const ConstStatesRef& qdd, const StridedMatrices& Y) const;

 protected:
  /// @name What a solver implements
  /// As the compute... of InverseDynamicsSolver; a batch by default one state after the other.
  /// @{
  virtual Eigen::Index linkCountImpl() const { return jointsFor("linkCount"); }
  virtual void computeRegressor(const ConstVectorRef& q, const ConstVectorRef& qd,
                                const ConstVectorRef& qdd, MatrixRef Y) const = 0;
  virtual void computeRegressorBatch(const ConstStates& q, const ConstStates& qd,
                                     const ConstStates& qdd, const StridedMatrices& Y) const;
  /// @}

 private:
  Eigen::Index linksFor(const char* method) const {
    jointsFor(method);
    return linkCountImpl();
  }
};

}  // namespace v2
}  // namespace inverse_dynamics_solver
