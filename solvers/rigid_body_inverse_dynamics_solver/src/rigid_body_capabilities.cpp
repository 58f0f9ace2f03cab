// SPDX-License-Identifier: Apache-2.0

// What is more than a call of FastModel.

#include <Eigen/Core>
#include <algorithm>
#include <chain_dynamics/fast_model.hpp>
#include <chain_dynamics/mechanism.hpp>
#include <chain_dynamics/model.hpp>
#include <chain_dynamics/spatial.hpp>
#include <cstddef>
#include <inverse_dynamics_solver/external_wrench.hpp>
#include <inverse_dynamics_solver/kinematics.hpp>
#include <vector>

#include "rigid_body_inverse_dynamics_solver/rigid_body_inverse_dynamics_solver.hpp"

namespace rigid_body_inverse_dynamics_solver {
inline namespace v2 {
namespace {

using chain_dynamics::FastModel;
using chain_dynamics::Transform;
using Jacobian = Eigen::Matrix<double, 6, Eigen::Dynamic, 0, 6, FastModel::kMaxJoints>;

/// The six numbers of a wrench in the axes of the root frame.
Eigen::Matrix<double, 6, 1> inRootAxes(const Eigen::Matrix3d& R, const ConstVectorRef& wrench) {
  Eigen::Matrix<double, 6, 1> turned;
  turned << R * wrench.head<3>(), R * wrench.tail<3>();
  return turned;
}

void wrenchTorques(const FastModel& fast, const ConstVectorRef& q, WrenchFrame frame,
                   const ConstVectorRef& wrench, VectorRef tau) {
  Eigen::Matrix<double, 6, 1> w = wrench;
  if (frame == WrenchFrame::kTip) {
    Transform<double> pose;
    fast.tipPose(q.data(), pose.R.data(), pose.p.data());
    w = inRootAxes(pose.R, wrench);
  }
  Jacobian J(6, q.size());
  fast.tipJacobian(q.data(), J.data(), 6);
  tau.noalias() = J.transpose().lazyProduct(w);
}

}  // namespace

auto RigidBodyTip::kinematicsOfTip(std::size_t tip) const
    -> const inverse_dynamics_solver::Kinematics& {
  return dynamic_cast<const Kinematics&>(solver_).kinematicsOf(solver_.tipNames()[tip]);
}

auto RigidBodyTip::externalWrenchAtTip(std::size_t tip) const
    -> const inverse_dynamics_solver::ExternalWrench& {
  return dynamic_cast<const ExternalWrench&>(solver_).externalWrenchAt(solver_.tipNames()[tip]);
}

void RigidBodyTip::computeTipPose(const ConstVectorRef& q, Transform<double>& pose) const {
  fast_.tipPose(positionsOf(branch_, q).data(), pose.R.data(), pose.p.data());
}

void RigidBodyTip::computeTipJacobian(const ConstVectorRef& q, MatrixRef J) const {
  Jacobian of_branch(6, branch_.chain.jointCount());
  fast_.tipJacobian(positionsOf(branch_, q).data(), of_branch.data(), 6);
  J.setZero();
  addJacobian(branch_.S, of_branch, J);
}

void RigidBodyTip::computeTipJacobianDerivative(const ConstVectorRef& q, const ConstVectorRef& qd,
                                                MatrixRef dJ) const {
  Jacobian of_branch(6, branch_.chain.jointCount());
  fast_.tipJacobianDerivative(positionsOf(branch_, q).data(), motionOf(branch_, qd).data(),
                              of_branch.data(), 6);
  dJ.setZero();
  addJacobian(branch_.S, of_branch, dJ);
}

void RigidBodyTip::computeExternalTorques(const ConstVectorRef& q, WrenchFrame frame,
                                          const ConstVectorRef& wrench, VectorRef tau) const {
  chain_dynamics::BranchVector of_branch(branch_.chain.jointCount());
  wrenchTorques(fast_, positionsOf(branch_, q), frame, wrench, of_branch);
  tau.setZero();
  addTorques(branch_.S, of_branch, tau);
}

void InverseDynamicsSolverRigidBody::computeExternalTorques(const ConstVectorRef& q,
                                                            WrenchFrame frame,
                                                            const ConstVectorRef& wrench,
                                                            VectorRef tau) const {
  wrenchTorques(initialRobot().fast, q, frame, wrench, tau);
}

void InverseDynamicsSolverRigidBody::computeTorqueDerivatives(const ConstVectorRef& q,
                                                              const ConstVectorRef& qd,
                                                              const ConstVectorRef& qdd,
                                                              MatrixRef dtau_dq, MatrixRef dtau_dqd,
                                                              MatrixRef dtau_dqdd) const {
  const auto robot = currentRobot();
  const Eigen::Index step = dtau_dq.outerStride();
  const bool same_steps = dtau_dqd.outerStride() == step && dtau_dqdd.outerStride() == step;
  if (same_steps) {
    robot->fast.torqueDerivatives(q.data(), qd.data(), qdd.data(), dtau_dq.data(), dtau_dqd.data(),
                                  dtau_dqdd.data(), step);
    return;
  }
  chain_dynamics::torqueDerivatives(robot->model, q, qd, qdd, dtau_dq, dtau_dqd, dtau_dqdd);
  chain_dynamics::addFrictionDerivatives(robot->model, q, qd, dtau_dq, dtau_dqd);
}

void InverseDynamicsSolverRigidBody::computeExternalTorquesBatch(const ConstStates& q,
                                                                 WrenchFrame frame,
                                                                 const ConstStates& wrenches,
                                                                 const States& tau) const {
  const auto& fast = initialRobot().fast;
  constexpr Eigen::Index kBlock = 8;  // states: their Jacobians take 24 kB at most
  const Eigen::Index n = q.joints;
  double J[kBlock * 6 * FastModel::kMaxJoints], R[kBlock * 9], p[kBlock * 3];
  for (Eigen::Index first = 0; first < q.count; first += kBlock) {
    const Eigen::Index size = std::min(kBlock, q.count - first);
    fast.tipJacobianBatch(q.middle(first, size), {J, 6, n, size, 1, 6, 6 * n});
    if (frame == WrenchFrame::kTip) {
      fast.tipPoseBatch(q.middle(first, size), {R, 3, size, 1, 3, 9}, {p, 3, size, 1, 3});
    }
    for (Eigen::Index k = 0; k < size; ++k) {
      Eigen::Matrix<double, 6, 1> w;
      for (Eigen::Index i = 0; i < 6; ++i) w[i] = wrenches(i, first + k);
      if (frame == WrenchFrame::kTip)
        w = inRootAxes(Eigen::Map<const Eigen::Matrix3d>(R + 9 * k), w);
      for (Eigen::Index j = 0; j < n; ++j) {
        tau(j, first + k) =
            w.dot(Eigen::Map<const Eigen::Matrix<double, 6, 1>>(J + 6 * (n * k + j)));
      }
    }
  }
}

void InverseDynamicsSolverRigidBody::computeRegressorBatch(const ConstStates& q,
                                                           const ConstStates& qd,
                                                           const ConstStates& qdd,
                                                           const StridedMatrices& Y) const {
  const auto robot = currentRobot();
  if (Y.row_step == 1 && q.joints > 1) return robot->fast.regressorBatch(q, qd, qdd, Y);

  // The kernels round otherwise where rows don't stand side by side. A layout mustn't change the bits:
  // through memory where they do.
  const Eigen::Index n = q.joints, most = std::min<Eigen::Index>(q.count, 32);
  const Eigen::Index all = 10 * robot->fast.linkCount();
  std::vector<double> numbers(static_cast<std::size_t>(n * all * most));
  for (Eigen::Index first = 0; first < q.count; first += most) {
    const Eigen::Index size = std::min(most, q.count - first);
    const StridedMatrices columns(numbers.data(), n, all, size, 1, n, n * all);
    robot->fast.regressorBatch(q.middle(first, size), qd.middle(first, size),
                               qdd.middle(first, size), columns);
    for (Eigen::Index k = 0; k < size; ++k) {
      for (Eigen::Index i = 0; i < n; ++i) {
        for (Eigen::Index j = 0; j < all; ++j) Y(i, j, first + k) = columns(i, j, k);
      }
    }
  }
}

}  // namespace v2
}  // namespace rigid_body_inverse_dynamics_solver
