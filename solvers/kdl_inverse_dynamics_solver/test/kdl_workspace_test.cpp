// SPDX-License-Identifier: Apache-2.0
#include "kdl_workspace.hpp"

#include <gtest/gtest.h>

#include <chain_dynamics/chain.hpp>
#include <cmath>

#include "kdl_chain.hpp"

namespace kdl_inverse_dynamics_solver::kdl_workspace_test {

/// A rod that turns about y, 2 kg at 0.5 m, with a rotor of 0.3 kg m^2; then a slide along its x.
chain_dynamics::Chain arm() {
  using namespace chain_dynamics;
  Joint turn{"turn", JointType::kRevolute};
  turn.placement.R << 1, 0, 0, 0, 0, 1, 0, -1, 0;  // z of the joint is y of the root
  turn.rotor_inertia = 0.3;
  Joint slide{"slide", JointType::kPrismatic};
  slide.placement.R << 0, 0, 1, 0, 1, 0, -1, 0, 0;  // z of the slide is x of the rod
  const Eigen::Matrix3d none = Eigen::Matrix3d::Zero();
  return Chain("arm", {turn, slide},
               {LinkParameters::fromCenterOfMass(2.0, Eigen::Vector3d(0.5, 0, 0), none),
                LinkParameters::fromCenterOfMass(1.0, Eigen::Vector3d::Zero(), none)},
               Eigen::Vector3d(0, 0, -10));
}

TEST(KdlWorkspace, CountsRotorInertiaAndSlides) {
  KdlWorkspace workspace(toKdl(arm()), toKdl(arm().gravity()));
  const Eigen::Vector2d q(0, 0.7), qd(2, 3), qdd(1, 4);

  // H = diag(2 * 0.5^2 + 0.3 + 1 * 0.7^2, 1); g = (-(2 * 0.5 + 0.7) 10, 0); C qd = (2 * 0.7 * 2 *
  // 3, -0.7 * 2^2)
  Eigen::MatrixXd H(2, 2);
  Eigen::VectorXd c(2), g(2), tau(2);
  workspace.inertiaMatrix(q, H);
  workspace.coriolisVector(q, qd, c);
  workspace.gravityVector(q, g);
  workspace.torques(q, qd, qdd, tau);
  EXPECT_TRUE(H.isApprox(Eigen::Vector2d(1.29, 1).asDiagonal().toDenseMatrix(), 1e-14)) << H;
  EXPECT_TRUE(c.isApprox(Eigen::Vector2d(8.4, -2.8), 1e-14)) << c;
  EXPECT_TRUE(g.isApprox(Eigen::Vector2d(-17, 0), 1e-14)) << g;
  EXPECT_TRUE(tau.isApprox(Eigen::Vector2d(1.29 + 8.4 - 17, 4 - 2.8), 1e-14)) << tau;

  Eigen::VectorXd accelerations(2);
  workspace.accelerations(q, qd, tau, accelerations);
  EXPECT_TRUE(accelerations.isApprox(qdd, 1e-14)) << accelerations;
}

TEST(KdlWorkspace, IsNotSpoiltByNan) {
  KdlWorkspace workspace(toKdl(arm()), toKdl(arm().gravity()));
  const Eigen::Vector2d q(0.3, 0.7), nan = Eigen::Vector2d::Constant(std::nan(""));
  Eigen::VectorXd before(2), after(2);
  workspace.torques(q, q, q, before);
  workspace.torques(nan, q, q, after);
  EXPECT_TRUE(after.array().isNaN().all());
  workspace.torques(q, q, q, after);
  EXPECT_EQ(before, after);

  workspace.accelerations(q, q, q, before);
  workspace.accelerations(nan, q, q, after);
  EXPECT_TRUE(after.array().isNaN().all());
  workspace.accelerations(q, q, q, after);
  EXPECT_EQ(before, after);
}

}  // namespace kdl_inverse_dynamics_solver::kdl_workspace_test
