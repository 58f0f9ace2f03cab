// SPDX-License-Identifier: Apache-2.0
#include "kdl_workspace.hpp"

#include <string>

#include "inverse_dynamics_solver/exceptions.hpp"

namespace kdl_inverse_dynamics_solver {
inline namespace v2 {
namespace {

/// KDL reports mistakes by number. None is possible with checked sizes; if one comes, it isn't
/// swallowed.
void check(int code, const KDL::SolverI& solver, const char* what) {
  if (code == KDL::SolverI::E_NOERROR) return;
  throw inverse_dynamics_solver::Exception(inverse_dynamics_solver::errorText(
      what, "KDL failed", "",
      std::string(solver.strError(code)) + " (" + std::to_string(code) + ")",
      "report this with the robot description and the joint state"));
}

}  // namespace

KdlWorkspace::KdlWorkspace(const KDL::Chain& chain, const KDL::Vector& gravity)
    : chain_(chain),
      components_(chain_, gravity),
      newton_euler_(chain_, gravity),
      q_(chain_.getNrOfJoints()),
      qd_(chain_.getNrOfJoints()),
      qdd_(chain_.getNrOfJoints()),
      result_(chain_.getNrOfJoints()),
      H_(chain_.getNrOfJoints()),
      no_forces_(chain_.getNrOfSegments(), KDL::Wrench::Zero()) {}

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

}  // namespace v2
}  // namespace kdl_inverse_dynamics_solver
