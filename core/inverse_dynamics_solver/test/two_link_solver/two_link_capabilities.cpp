// SPDX-License-Identifier: Apache-2.0

// The capabilities of the two-link arm, in closed form but for the regressor.

#include <Eigen/LU>
#include <chain_dynamics/regressor.hpp>
#include <chain_dynamics/spatial.hpp>
#include <cmath>

#include "two_link_arm.hpp"
#include "two_link_solver.hpp"

namespace two_link_solver {
namespace {

using Vector3 = Eigen::Vector3d;

/// From a joint to the mass at the end of its link of length 1, at angle a; derivatives by a.
Vector3 along(double a) { return {-std::sin(a), 0.0, -std::cos(a)}; }
Vector3 across(double a) { return {-std::cos(a), 0.0, std::sin(a)}; }

Eigen::Matrix3d turnAboutY(double a) {
  Eigen::Matrix3d R;
  R << std::cos(a), 0.0, std::sin(a), 0.0, 1.0, 0.0, -std::sin(a), 0.0, std::cos(a);
  return R;
}

}  // namespace

void TwoLinkSolver::computeTipPose(const ConstVectorRef& q,
                                   chain_dynamics::Transform<double>& pose) const {
  pose.R = turnAboutY(q[0] + q[1]);
  pose.p = l1 * along(q[0]) + l2 * along(q[0] + q[1]);
  if (has("tip is that of the first link")) pose.p = l1 * along(q[0]);
}

void TwoLinkSolver::computeTipJacobian(const ConstVectorRef& q, MatrixRef J) const {
  const Vector3 second = l2 * across(q[0] + q[1]);
  J.topRows(3) << l1 * across(q[0]) + second, second;
  J.bottomRows(3) << Vector3::UnitY(), Vector3::UnitY();
  if (has("Jacobian has angular rows first")) J.topRows(3).swap(J.bottomRows(3));
}

void TwoLinkSolver::computeTipJacobianDerivative(const ConstVectorRef& q, const ConstVectorRef& qd,
                                                 MatrixRef dJ) const {
  const double turn = qd[0] + qd[1];
  const Vector3 second = -l2 * turn * along(q[0] + q[1]);
  dJ.setZero();
  dJ.topRows(3) << -l1 * qd[0] * along(q[0]) + second, second;
  if (has("derivative of the Jacobian for the first joint alone")) dJ.col(1).setZero();
}

void TwoLinkSolver::computeExternalTorques(const ConstVectorRef& q, WrenchFrame frame,
                                           const ConstVectorRef& wrench, VectorRef tau) const {
  Eigen::Matrix<double, 6, 2> J;
  computeTipJacobian(q, J);
  Eigen::Matrix<double, 6, 1> w = wrench;
  if (frame == WrenchFrame::kTip && !has("frame of a wrench is ignored")) {
    const Eigen::Matrix3d R = turnAboutY(q[0] + q[1]);
    w.head<3>() = R * wrench.head<3>();
    w.tail<3>() = R * wrench.tail<3>();
  }
  if (has("wrench acts on the tip")) w = -w;
  if (has("NaN in a wrench is swallowed")) w = w.array().isNaN().select(0.0, w);
  tau = J.transpose() * w;
}

void TwoLinkSolver::computeCoriolisMatrix(const ConstVectorRef& q, const ConstVectorRef& qd,
                                          MatrixRef C) const {
  const double k = m2 * l1 * l2 * std::sin(q[1]);
  C << -k * qd[1], -k * (qd[0] + qd[1]), k * qd[0], 0.0;
  if (has("Coriolis matrix is another one with the same product")) {
    C << 0.0, -k * (2.0 * qd[0] + qd[1]), k * qd[0], 0.0;
  }
  if (has("Coriolis matrix is transposed")) C.transposeInPlace();
  if (has("Coriolis matrix is doubled")) C *= 2.0;
}

double TwoLinkSolver::computeKineticEnergy(const ConstVectorRef& q,
                                           const ConstVectorRef& qd) const {
  Eigen::Matrix2d H;
  computeInertiaMatrix(q, H);
  return (has("kinetic energy is doubled") ? 1.0 : 0.5) * qd.dot(H * qd);
}

double TwoLinkSolver::computePotentialEnergy(const ConstVectorRef& q) const {
  const Vector3 first = l1 * along(q[0]), second = first + l2 * along(q[0] + q[1]);
  return (has("potential energy falls") ? 1.0 : -1.0) * gravity_.dot(m1 * first + m2 * second);
}

void TwoLinkSolver::computeTorqueDerivatives(const ConstVectorRef& q, const ConstVectorRef& qd,
                                             const ConstVectorRef& qdd, MatrixRef dtau_dq,
                                             MatrixRef dtau_dqd, MatrixRef dtau_dqdd) const {
  const auto fall = [this](double a) {
    return -gravity_.x() * std::sin(a) - gravity_.z() * std::cos(a);
  };
  const double s = m2 * l1 * l2 * std::sin(q[1]), c = m2 * l1 * l2 * std::cos(q[1]);
  const double g1 = (m1 + m2) * l1 * fall(q[0]), g2 = m2 * l2 * fall(q[0] + q[1]);

  // of H qdd, of C qd, of g
  dtau_dq << 0.0, -s * (2.0 * qdd[0] + qdd[1]), 0.0, -s * qdd[0];
  dtau_dq(0, 1) -= c * (2.0 * qd[0] * qd[1] + qd[1] * qd[1]);
  dtau_dq(1, 1) += c * qd[0] * qd[0];
  dtau_dq(0, 0) += g1;
  dtau_dq.array() += g2;
  if (has("derivatives lack gravity")) dtau_dq(1, 1) -= g2;

  dtau_dqd << -2.0 * s * qd[1], -2.0 * s * (qd[0] + qd[1]), 2.0 * s * qd[0], 0.0;
  if (friction_ && !has("derivatives lack friction")) {
    dtau_dqd.diagonal().array() += 1.3 - qd.array().tanh().square();
  }
  computeInertiaMatrix(q, dtau_dqdd);
}

void TwoLinkSolver::computeRegressor(const ConstVectorRef& q, const ConstVectorRef& qd,
                                     const ConstVectorRef& qdd, MatrixRef Y) const {
  chain_dynamics::regressor(*chain_, q, qd, qdd, Y);
  if (has("regressor has columns of another order")) Y.col(1).swap(Y.col(2));
}

void TwoLinkSolver::computeAccelerations(const ConstVectorRef& q, const ConstVectorRef& qd,
                                         const ConstVectorRef& tau, VectorRef qdd) const {
  Eigen::Matrix2d H;
  Eigen::Vector2d c, g, f;
  computeInertiaMatrix(q, H);
  computeCoriolisVector(q, qd, c);
  computeGravityVector(q, g);
  computeFriction(q, qd, f);
  if (has("accelerations without friction")) f.setZero();
  const Eigen::Vector2d rest = tau - c - g - f;
  // In memory of its own first: on processors that multiply and add in one step, Eigen rounds in
  // another way where the numbers of a result aren't side by side.
  const Eigen::Vector2d solution = H.inverse() * rest;
  qdd = solution;
}

}  // namespace two_link_solver
