// SPDX-License-Identifier: Apache-2.0
/// @file
/// A point mass at the end of a rod about the y axis that hangs down at q = 0, and carries bodies.
/// With the parameter `fault` it breaks one promise: what the conformance tests must find.
#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <string>

#include "inverse_dynamics_solver/changeable_robot.hpp"
#include "inverse_dynamics_solver/inverse_dynamics_solver.hpp"

namespace carrying_solver {

using namespace inverse_dynamics_solver;

/// All that hangs on the rod, about the joint: moment of inertia, first moments along the rod and
/// across it (a quarter turn on), and gravity.
struct Pendulum {
  double inertia, along, across;
  Eigen::Vector3d gravity;
};

/// The tip frame is at the end of the rod, and has the axes of the root at q = 0.
class CarryingSolver : public InverseDynamicsSolver, public ChangeableRobot<Pendulum> {
 protected:
  JointInfo configure(const Configuration& configuration) override;
  void computeInertiaMatrix(const ConstVectorRef& q, MatrixRef H) const override;
  void computeCoriolisVector(const ConstVectorRef& q, const ConstVectorRef& qd,
                             VectorRef c) const override;
  void computeGravityVector(const ConstVectorRef& q, VectorRef g) const override;
  void computeTorques(const ConstVectorRef& q, const ConstVectorRef& qd, const ConstVectorRef& qdd,
                      VectorRef tau) const override;
  void computeDynamicComponents(const ConstVectorRef& q, const ConstVectorRef& qd, MatrixRef H,
                                VectorRef c, VectorRef g) const override;
  void whileUnchanged(const std::function<void()>& compute) const override;
  bool inertiaIsPhysicalImpl() const override { return true; }

  const InverseDynamicsSolver& torqueSolver() const override { return *this; }
  std::unique_ptr<const Pendulum> robotUnder(const Conditions& conditions) const override;

 private:
  bool has(const char* fault) const { return fault_ == fault; }

  std::string fault_;
  mutable std::atomic<int> changes_{0};  // for faults that count them
  mutable std::atomic<int> calls_{0};    // likewise
};

}  // namespace carrying_solver
