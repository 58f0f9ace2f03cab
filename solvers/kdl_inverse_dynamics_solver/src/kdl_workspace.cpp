// SPDX-License-Identifier: Apache-2.0
#include "kdl_workspace.hpp"

#include <cstddef>
#include <kdl/chain.hpp>
#include <kdl/frames.hpp>
#include <kdl/joint.hpp>
#include <kdl/solveri.hpp>
#include <string>

#include "chain_dynamics/spatial.hpp"
#include "inverse_dynamics_solver/exceptions.hpp"

namespace kdl_inverse_dynamics_solver {
inline namespace v2 {
namespace {

/// KDL reports mistakes by number. None is possible with checked sizes; if one comes, it isn't
/// swallowed.
void check(int code, const KDL::SolverI& solver, const char* what) {
  if (code == KDL::SolverI::E_NOERROR) return;
  throw inverse_dynamics_solver::Exception(
      what, "KDL failed", "",
      std::string(solver.strError(code)) + " (" + std::to_string(code) + ")",
      "report this with the robot description and the joint state");
}

KDL::Chain extended(KDL::Chain chain, const KDL::Frame& tip) {
  chain.addSegment(KDL::Segment("tip", KDL::Joint(KDL::Joint::Fixed), tip));
  return chain;
}

}  // namespace

KdlWorkspace::KdlWorkspace(const KDL::Chain& chain, const KDL::Vector& gravity,
                           const KDL::Frame& tip)
    : chain_(chain),
      components_(chain_, gravity),
      newton_euler_(chain_, gravity),
      forward_(chain_, gravity),
      q_(chain_.getNrOfJoints()),
      qd_(chain_.getNrOfJoints()),
      qdd_(chain_.getNrOfJoints()),
      tau_(chain_.getNrOfJoints()),
      result_(chain_.getNrOfJoints()),
      H_(chain_.getNrOfJoints()),
      no_forces_(chain_.getNrOfSegments(), KDL::Wrench::Zero()),
      to_tip_(extended(chain, tip)),
      positions_(to_tip_),
      jacobians_(to_tip_),
      derivatives_(to_tip_),
      jacobian_(chain_.getNrOfJoints()),
      motion_(chain_.getNrOfJoints()) {}

void KdlWorkspace::inertiaMatrix(const ConstVectorRef& q, MatrixRef H) {
  q_.data = q;
  check(components_.JntToMass(q_, H_), components_, "inertia matrix");
  H = H_.data;
}

void KdlWorkspace::coriolisVector(const ConstVectorRef& q, const ConstVectorRef& qd, VectorRef c) {
  q_.data = q;
  qd_.data = qd;
  check(components_.JntToCoriolis(q_, qd_, result_), components_, "Coriolis torques");
  c = result_.data;
}

void KdlWorkspace::gravityVector(const ConstVectorRef& q, VectorRef g) {
  q_.data = q;
  check(components_.JntToGravity(q_, result_), components_, "gravity torques");
  g = result_.data;
}

void KdlWorkspace::torques(const ConstVectorRef& q, const ConstVectorRef& qd,
                           const ConstVectorRef& qdd, VectorRef tau) {
  q_.data = q;
  qd_.data = qd;
  qdd_.data = qdd;
  check(newton_euler_.CartToJnt(q_, qd_, qdd_, no_forces_, result_), newton_euler_, "torques");
  tau = result_.data;
}

void KdlWorkspace::accelerations(const ConstVectorRef& q, const ConstVectorRef& qd,
                                 const ConstVectorRef& tau, VectorRef qdd) {
  q_.data = q;
  qd_.data = qd;
  tau_.data = tau;
  check(forward_.CartToJnt(q_, qd_, tau_, no_forces_, result_), forward_, "accelerations");
  qdd = result_.data;
}

// ---------------------------------------------------------------- tip

const KDL::Frame& KdlWorkspace::pose(const ConstVectorRef& q) {
  q_.data = q;
  check(positions_.JntToCart(q_, pose_), positions_, "pose of the tip");
  return pose_;
}

const KDL::Jacobian& KdlWorkspace::jacobian(const ConstVectorRef& q) {
  q_.data = q;
  check(jacobians_.JntToJac(q_, jacobian_), jacobians_, "Jacobian");
  return jacobian_;
}

void KdlWorkspace::tipPose(std::size_t /*tip*/, const ConstVectorRef& q,
                           chain_dynamics::Transform<double>& result) {
  const KDL::Frame& X = pose(q);
  result.R = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(X.M.data);
  result.p = Eigen::Map<const Eigen::Vector3d>(X.p.data);
}

void KdlWorkspace::tipJacobian(std::size_t /*tip*/, const ConstVectorRef& q, MatrixRef J) {
  J = jacobian(q).data;
}

void KdlWorkspace::tipJacobianDerivative(std::size_t /*tip*/, const ConstVectorRef& q,
                                         const ConstVectorRef& qd, MatrixRef dJ) {
  motion_.q.data = q;
  motion_.qdot.data = qd;
  check(derivatives_.JntToJacDot(motion_, jacobian_), derivatives_, "derivative of the Jacobian");
  dJ = jacobian_.data;
}

void KdlWorkspace::externalTorques(std::size_t /*tip*/, const ConstVectorRef& q, WrenchFrame frame,
                                   const ConstVectorRef& wrench, VectorRef tau) {
  KDL::Wrench w(KDL::Vector(wrench[0], wrench[1], wrench[2]),
                KDL::Vector(wrench[3], wrench[4], wrench[5]));
  if (frame == WrenchFrame::kTip) w = pose(q).M * w;

  // J^T w, column by column
  const KDL::Jacobian& J = jacobian(q);
  for (unsigned int j = 0; j < J.columns(); ++j) {
    const KDL::Twist velocity = J.getColumn(j);
    tau[j] = dot(velocity, w);
  }
}

}  // namespace v2
}  // namespace kdl_inverse_dynamics_solver
