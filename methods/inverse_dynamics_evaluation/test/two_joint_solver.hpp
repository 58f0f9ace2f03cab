// SPDX-License-Identifier: Apache-2.0

/// @file
/// A solver whose torques are known, for tests.

#pragma once

#include <cmath>
#include <inverse_dynamics_solver/configuration.hpp>
#include <inverse_dynamics_solver/inverse_dynamics_solver.hpp>

namespace inverse_dynamics_evaluation {

/// tau = (2 qdd_1 + 10 cos q_1, 3 qdd_2 + 20).
class TwoJointSolver : public inverse_dynamics_solver::InverseDynamicsSolver {
 public:
  TwoJointSolver() { initialize(); }

 protected:
  using ConstVector = inverse_dynamics_solver::ConstVectorRef;
  using Vector = inverse_dynamics_solver::VectorRef;

  JointInfo configure(const inverse_dynamics_solver::Configuration&) override {
    return {{"a", "b"}, {"the solver warns"}};
  }
  void computeInertiaMatrix(const ConstVector&,
                            inverse_dynamics_solver::MatrixRef H) const override {
    H << 2, 0, 0, 3;
  }
  void computeCoriolisVector(const ConstVector&, const ConstVector&, Vector c) const override {
    c.setZero();
  }
  void computeGravityVector(const ConstVector& q, Vector g) const override {
    g << 10 * std::cos(q[0]), 20;
  }
  bool inertiaIsPhysicalImpl() const override { return true; }
};

}  // namespace inverse_dynamics_evaluation
