// SPDX-License-Identifier: Apache-2.0
/// @file
/// Capability: where the tip of the chain is, and how it moves with the joints.
///
///     if (const auto* kinematics = dynamic_cast<const Kinematics*>(solver.get())) {
///       Eigen::VectorXd V = kinematics->getTipJacobian(q) * qd;   // linear, then angular velocity
///     }
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <string>
#include <utility>

#include "chain_dynamics/spatial.hpp"
#include "inverse_dynamics_solver/capability.hpp"

namespace inverse_dynamics_solver {
inline namespace v2 {

/// Pose, Jacobian and its time derivative of the tip: the link `tip` of a robot description, of a tree the
/// first; of a model file the frame `tip`, else that of the last link.
///
/// Velocities are those of the tip's origin, in the axes of the root frame: the linear velocity in
/// rows 0 to 2 [m/s], the angular one in rows 3 to 5 [rad/s], as KDL, Pinocchio
/// (LOCAL_WORLD_ALIGNED) and ROS have them.
class Kinematics : public Capability {
 public:
  ~Kinematics() override;

  /// That of one of tipNames(); until the next initialize().
  ///
  /// @throws UninitializedException; InvalidParameterValueException  none of tipNames().
  const Kinematics& kinematicsOf(const std::string& tip) const {
    return kinematicsOfTip(tipIndex("kinematicsOf", tip));
  }

  /// @name By value
  /// @{

  /// Pose `X_0t` of the tip in the root frame: rotation R and position p [m].
  chain_dynamics::Transform<double> getTipPose(const ConstVectorRef& q) const {
    chain_dynamics::Transform<double> pose;
    getTipPose(q, pose);
    return pose;
  }
  /// `J(q)`, 6 x n: the velocity of the tip is `[v; w] = J(q) qd`.
  Eigen::MatrixXd getTipJacobian(const ConstVectorRef& q) const {
    Eigen::MatrixXd J(6, jointsFor("getTipJacobian"));
    getTipJacobian(q, J);
    return J;
  }
  /// `dJ/dt` where q moves with qd, 6 x n: the acceleration is `[a; dw/dt] = J qdd + dJ/dt qd`.
  Eigen::MatrixXd getTipJacobianDerivative(const ConstVectorRef& q,
                                           const ConstVectorRef& qd) const {
    Eigen::MatrixXd dJ(6, jointsFor("getTipJacobianDerivative"));
    getTipJacobianDerivative(q, qd, dJ);
    return dJ;
  }
  /// @}

  /// @name Into memory of the caller
  /// @{
  void getTipPose(const ConstVectorRef& q, chain_dynamics::Transform<double>& pose) const;
  void getTipJacobian(const ConstVectorRef& q, MatrixRef J) const;
  void getTipJacobianDerivative(const ConstVectorRef& q, const ConstVectorRef& qd,
                                MatrixRef dJ) const;
  /// @}

  /// @name Many states at once
  /// R side by side, 3 x (3 N), p 3 x N; J and dJ side by side, 6 x (n N).
  /// @{
  void getTipPoseBatch(const ConstStatesRef& q, const StridedMatrices& R, const States& p) const;
  void getTipJacobianBatch(const ConstStatesRef& q, const StridedMatrices& J) const;
  void getTipJacobianDerivativeBatch(const ConstStatesRef& q, const ConstStatesRef& qd,
                                     const StridedMatrices& dJ) const;

  std::pair<Eigen::MatrixXd, Eigen::MatrixXd> getTipPoseBatch(const ConstStatesRef& q) const {
    Eigen::MatrixXd R(3, 3 * q.count), p(3, q.count);
    getTipPoseBatch(q, R, p);
    return {std::move(R), std::move(p)};
  }
  Eigen::MatrixXd getTipJacobianBatch(const ConstStatesRef& q) const {
    Eigen::MatrixXd J(6, q.joints * q.count);
    getTipJacobianBatch(q, J);
    return J;
  }
  Eigen::MatrixXd getTipJacobianDerivativeBatch(const ConstStatesRef& q,
                                                const ConstStatesRef& qd) const {
    Eigen::MatrixXd dJ(6, q.joints * q.count);
    getTipJacobianDerivativeBatch(q, qd, dJ);
    return dJ;
  }
  /// @}

 protected:
  /// @name What a solver implements
  /// As the compute... of InverseDynamicsSolver.
  /// @{
  virtual const Kinematics& kinematicsOfTip(std::size_t /*tip*/) const { return *this; }

  virtual void computeTipPose(const ConstVectorRef& q,
                              chain_dynamics::Transform<double>& pose) const = 0;
  virtual void computeTipJacobian(const ConstVectorRef& q, MatrixRef J) const = 0;
  virtual void computeTipJacobianDerivative(const ConstVectorRef& q, const ConstVectorRef& qd,
                                            MatrixRef dJ) const = 0;

  /// By default one state after the other.
  virtual void computeTipPoseBatch(const ConstStates& q, const StridedMatrices& R,
                                   const States& p) const;
  virtual void computeTipJacobianBatch(const ConstStates& q, const StridedMatrices& J) const;
  virtual void computeTipJacobianDerivativeBatch(const ConstStates& q, const ConstStates& qd,
                                                 const StridedMatrices& dJ) const;
  /// @}
};

}  // namespace v2
}  // namespace inverse_dynamics_solver
