// SPDX-License-Identifier: Apache-2.0
//
// What docs/payload.md shows of C++: a load is estimated in a control loop.

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cmath>
#include <inverse_dynamics_identification/payload_estimator.hpp>
#include <inverse_dynamics_solver/payload.hpp>
#include <inverse_dynamics_solver/solver_loader.hpp>
#include <memory>

namespace inverse_dynamics_documentation_tests::payload_test {

using inverse_dynamics_identification::PayloadEstimate;
using inverse_dynamics_identification::PayloadEstimator;
using inverse_dynamics_identification::PayloadOptions;
using inverse_dynamics_identification::PayloadStatus;
using inverse_dynamics_solver::InverseDynamicsSolver;
using inverse_dynamics_solver::Payload;
using inverse_dynamics_solver::RigidBody;
using inverse_dynamics_solver::SolverLoader;

std::shared_ptr<InverseDynamicsSolver> ur10() {
  auto solver = SolverLoader().load("ur10_inverse_dynamics_solver/InverseDynamicsSolverUR10");
  solver->initialize();
  return solver;
}

/// A UR10 in motion that carries 2 kg, 10 cm in front of its flange.
struct Arm {
  std::shared_ptr<InverseDynamicsSolver> loaded = ur10();
  double time = 0.0;
  Eigen::VectorXd q = Eigen::VectorXd(6), qd = q, qdd = q, effort = q;

  Arm() {
    RigidBody load{2.0};
    load.center_of_mass = {0.0, 0.0, 0.1};
    dynamic_cast<Payload&>(*loaded).setPayload("load", load);
  }

  /// The next cycle, for 6 s.
  bool moves() {
    time += 0.01;
    for (Eigen::Index j = 0; j < 6; ++j) {
      const double w = 0.9 + 0.23 * static_cast<double>(j);
      const double phase = w * time + 1.3 * static_cast<double>(j);
      q[j] = 0.4 * static_cast<double>(j) - 1.0 + 0.5 * std::sin(phase);
      qd[j] = 0.5 * w * std::cos(phase);
      qdd[j] = -0.5 * w * w * std::sin(phase);
    }
    effort = loaded->getTorques(q, qd, qdd);
    return time < 6.0;
  }
};

TEST(Payload, IsEstimatedInAControlLoop) {
  const auto solver = ur10();
  const Eigen::Index n = solver->jointCount();
  Arm arm;

  // <inverse_dynamics_identification/payload_estimator.hpp>, <inverse_dynamics_solver/payload.hpp>
  PayloadOptions options;
  options.noise.white = Eigen::VectorXd::Constant(n, 0.3);       // N m; payload.json has both
  options.noise.correlated = Eigen::VectorXd::Constant(n, 0.5);  // of each joint
  PayloadEstimator estimator(solver, options);

  while (arm.moves()) {  // each cycle; no allocation, lock or exception
    estimator.update(arm.time, arm.q, arm.qd, arm.qdd, arm.effort);
  }
  PayloadEstimate found(n);
  if (estimator.estimate(found) == PayloadStatus::kOk) {
    dynamic_cast<Payload&>(*solver).setPayload("load", found.body());
  }

  EXPECT_NEAR(found.mass, 2.0, 0.01);
  EXPECT_NEAR(found.center_of_mass[2], 0.1, 0.005);
  const Eigen::VectorXd g = arm.loaded->getGravityVector(arm.q);
  EXPECT_LT((solver->getGravityVector(arm.q) - g).norm(), 0.01 * g.norm());
}

}  // namespace inverse_dynamics_documentation_tests::payload_test
