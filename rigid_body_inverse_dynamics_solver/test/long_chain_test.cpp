// SPDX-License-Identifier: Apache-2.0
/// @file
/// Chains that are too long for the fast kernels have every capability all the same.
#include <gtest/gtest.h>

#include <string>

#include "chain_dynamics/regressor.hpp"
#include "chain_dynamics/urdf.hpp"
#include "rigid_body_inverse_dynamics_solver/rigid_body_inverse_dynamics_solver.hpp"

namespace rigid_body_inverse_dynamics_solver::long_chain_test {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using inverse_dynamics_solver::WrenchesInTip;
using inverse_dynamics_solver::WrenchInRoot;
using inverse_dynamics_solver::WrenchInTip;
using rigid_body_inverse_dynamics_solver::InverseDynamicsSolverRigidBody;

constexpr int kJoints = chain_dynamics::FastModel::kMaxJoints + 2;

/// Sums of some thousand terms.
constexpr double kRounding = 1e-11;

/// Divided by inertias that differ by a factor of some thousand.
constexpr double kSolved = 1e-9;

/// Rods of 0.1 m, about x, y and along z in turn, with viscous friction.
std::string snake() {
  const char* const kAxes[] = {"1 0 0", "0 1 0", "0 0 1"};
  std::string urdf = "<robot name='snake'><link name='l0'/>";
  for (int i = 1; i <= kJoints; ++i) {
    const std::string own = std::to_string(i), parent = std::to_string(i - 1);
    urdf += "<link name='l" + own +
            "'><inertial><origin xyz='0.01 0 0.05'/><mass value='0.3'/>"
            "<inertia ixx='0.01' iyy='0.01' izz='0.01' ixy='0' ixz='0' iyz='0'/></inertial></link>"
            "<joint name='j" +
            own + "' type='" + (i % 3 == 0 ? "prismatic" : "revolute") + "'><parent link='l" +
            parent + "'/><child link='l" + own + "'/><origin xyz='0 0 0.1'/><axis xyz='" +
            kAxes[(i - 1) % 3] +
            "'/><limit lower='-1' upper='1' effort='1' velocity='1'/>"
            "<dynamics damping='0.2' friction='0'/></joint>";
  }
  return urdf + "</robot>";
}

class LongChain : public ::testing::Test {
 protected:
  void SetUp() override {
    solver_.initialize({{"urdf_friction", true}}, "", snake());
    ASSERT_EQ(solver_.jointCount(), kJoints);
  }

  InverseDynamicsSolverRigidBody solver_;
  const VectorXd q_ = VectorXd::LinSpaced(kJoints, -0.3, 0.4);
  const VectorXd qd_ = VectorXd::LinSpaced(kJoints, 0.5, -0.2);
  const VectorXd qdd_ = VectorXd::LinSpaced(kJoints, -1.0, 2.0);
};

double largest(const MatrixXd& values) { return values.cwiseAbs().maxCoeff(); }

TEST_F(LongChain, ExertsWrenches) {
  const MatrixXd J = solver_.getTipJacobian(q_);
  Eigen::Matrix<double, 6, 1> w;
  w << 1, -2, 3, 0.4, 0.5, -0.6;
  const VectorXd expected = J.transpose() * w;
  const WrenchInRoot in_root{w.head<3>(), w.tail<3>()};
  EXPECT_LT(largest(solver_.getExternalTorques(q_, in_root) - expected), kRounding);
  const Eigen::Matrix3d R = solver_.getTipPose(q_).R;
  const WrenchInTip in_tip{R.transpose() * in_root.force, R.transpose() * in_root.torque};
  EXPECT_LT(largest(solver_.getExternalTorques(q_, in_tip) - expected), kRounding);
  Eigen::Matrix<double, 6, 1> turned;
  turned << in_tip.force, in_tip.torque;
  const MatrixXd batch =
      solver_.getExternalTorquesBatch(q_.replicate(1, 3), WrenchesInTip(turned.replicate(1, 3)));
  EXPECT_LT(largest(batch.col(2) - expected), kRounding);

  const VectorXd tau = solver_.getTorques(q_, qd_, qdd_);
  EXPECT_LT(largest(solver_.getTorques(q_, qd_, qdd_, in_root) - tau - expected), kRounding);
  const double step = 1e-4;
  const MatrixXd later = solver_.getTipJacobian(q_ + step * qd_);
  const MatrixXd before = solver_.getTipJacobian(q_ - step * qd_);
  EXPECT_LT(largest(solver_.getTipJacobianDerivative(q_, qd_) - (later - before) / (2 * step)),
            1e-4);
}

TEST_F(LongChain, HasDynamicsOfRigidBodies) {
  const VectorXd tau = solver_.getTorques(q_, qd_, qdd_), f = solver_.getFrictionVector(q_, qd_);
  EXPECT_GT(largest(f), 0.01);
  const double size = largest(tau);
  const VectorXd difference = solver_.getAccelerations(q_, qd_, tau) - qdd_;
  EXPECT_LT(largest(solver_.getInertiaMatrix(q_) * difference), kSolved * size);
  const VectorXd p = chain_dynamics::parameters(chain_dynamics::chainFromUrdf(snake(), {}));
  EXPECT_LT(largest(solver_.getRegressor(q_, qd_, qdd_) * p + f - tau), kRounding * size);
  const MatrixXd C = solver_.getCoriolisMatrix(q_, qd_);
  EXPECT_LT(largest(C * qd_ - solver_.getCoriolisVector(q_, qd_)), kRounding * size);
  const auto [by_q, by_qd, H] = solver_.getTorqueDerivatives(q_, qd_, qdd_);
  EXPECT_LT(largest(H - solver_.getInertiaMatrix(q_)), kRounding * largest(H));
  EXPECT_LT(largest(by_qd - 2 * C - MatrixXd(0.2 * MatrixXd::Identity(kJoints, kJoints))),
            kRounding * largest(by_qd));
  EXPECT_NEAR(solver_.getKineticEnergy(q_, qd_), 0.5 * qd_.dot(H * qd_), kRounding * size);
  EXPECT_EQ(solver_.getKineticEnergyBatch(q_, qd_)[0], solver_.getKineticEnergy(q_, qd_));
  EXPECT_EQ(solver_.getPotentialEnergyBatch(q_)[0], solver_.getPotentialEnergy(q_));
}

}  // namespace rigid_body_inverse_dynamics_solver::long_chain_test
