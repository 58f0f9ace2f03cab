// SPDX-License-Identifier: Apache-2.0
/// @file
/// Pinocchio as the judge of the engine: what no solver offers, and chains that no file describes.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <chain_dynamics/chain.hpp>
#include <chain_dynamics/fast_model.hpp>
#include <chain_dynamics/inertia_matrix.hpp>
#include <chain_dynamics/model.hpp>
#include <chain_dynamics/regressor.hpp>
#include <chain_dynamics/torque_derivatives.hpp>
#include <chain_dynamics/torques.hpp>
#include <cstdlib>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "pinocchio_model.hpp"
#include "pinocchio_workspace.hpp"

namespace {

using chain_dynamics::Chain;
using Eigen::Matrix3d, Eigen::MatrixXd, Eigen::Vector3d, Eigen::VectorXd;
using pinocchio_inverse_dynamics_solver::Models, pinocchio_inverse_dynamics_solver::toPinocchio;

/// Relative to the greatest entry: two programs do the same operations in another order, and
/// forward dynamics divides by inertia that a random chain makes small.
constexpr double kRounding = 1e-11;
constexpr double kForwardRounding = 1e-8;

/// A chain of n links with any placement, any second or third joint prismatic, and rotors.
Chain randomChain(int n) {
  std::vector<chain_dynamics::Joint> joints;
  std::vector<chain_dynamics::LinkParameters> links;
  for (int i = 0; i < n; ++i) {
    chain_dynamics::Joint joint;
    joint.name = "joint_" + std::to_string(i);
    const bool slides = i % 3 == 1;
    joint.type =
        slides ? chain_dynamics::JointType::kPrismatic : chain_dynamics::JointType::kContinuous;
    joint.placement = {Eigen::Quaterniond::UnitRandom().toRotationMatrix(), Vector3d::Random()};
    joint.rotor_inertia = 0.1 * i;
    joints.push_back(joint);
    const Matrix3d root = Matrix3d::Random();
    links.push_back(chain_dynamics::LinkParameters::fromCenterOfMass(
        1.0 + i, 0.3 * Vector3d::Random(), root * root.transpose() + 0.1 * Matrix3d::Identity()));
  }
  return Chain("random", joints, links, Vector3d::Random() * 10);
}

void expectEqual(const MatrixXd& ours, const MatrixXd& theirs, double tolerance, const char* what) {
  const double scale = 1.0 + theirs.cwiseAbs().maxCoeff();
  EXPECT_LE((ours - theirs).cwiseAbs().maxCoeff(), tolerance * scale) << what;
}

class Engine : public ::testing::TestWithParam<int> {};

TEST_P(Engine, AgreesWithPinocchio) {
  std::srand(1);  // Eigen's random numbers
  const int n = GetParam();
  for (int k = 0; k < 5; ++k) {
    const Chain chain = randomChain(n);
    const VectorXd q = 3 * VectorXd::Random(n), qd = 2 * VectorXd::Random(n);
    const VectorXd qdd = 5 * VectorXd::Random(n);

    VectorXd tau(n), forward(n);
    MatrixXd H(n, n), Y(n, 10 * n), dtau_dq(n, n), dtau_dqd(n, n), dtau_dqdd(n, n);
    chain_dynamics::torques(chain, q, qd, qdd, tau);
    chain_dynamics::inertiaMatrix(chain, q, H);
    chain_dynamics::regressor(chain, q, qd, qdd, Y);
    chain_dynamics::FastModel(chain_dynamics::Model(chain))
        .forwardDynamics(q.data(), qd.data(), tau.data(), forward.data());
    chain_dynamics::torqueDerivatives(chain, q, qd, qdd, dtau_dq, dtau_dqd, dtau_dqdd);

    const auto models = std::make_shared<const Models>(
        Models{toPinocchio(chain), toPinocchio(chain.withGravity(Vector3d::Zero()))});
    ASSERT_EQ(models->with_gravity.nq, n);
    pinocchio_inverse_dynamics_solver::PinocchioWorkspace pinocchio(models);
    VectorXd their_tau(n), their_forward(n);
    MatrixXd their_H(n, n), their_Y(n, 10 * n);
    MatrixXd their_dtau_dq(n, n), their_dtau_dqd(n, n), their_dtau_dqdd(n, n);
    pinocchio.torques(q, qd, qdd, their_tau);
    pinocchio.inertiaMatrix(q, their_H);
    pinocchio.regressor(q, qd, qdd, their_Y);
    pinocchio.accelerations(q, qd, tau, their_forward);
    pinocchio.torqueDerivatives(q, qd, qdd, their_dtau_dq, their_dtau_dqd, their_dtau_dqdd);

    expectEqual(tau, their_tau, kRounding, "torques");
    expectEqual(H, their_H, kRounding, "inertia matrix");
    expectEqual(Y, their_Y, kRounding, "regressor");
    expectEqual(forward, their_forward, kForwardRounding, "forward dynamics");
    expectEqual(dtau_dq, their_dtau_dq, kRounding, "derivatives by position");
    expectEqual(dtau_dqd, their_dtau_dqd, kRounding, "derivatives by velocity");
    expectEqual(dtau_dqdd, their_dtau_dqdd, kRounding, "derivatives by acceleration");
  }
}

INSTANTIATE_TEST_SUITE_P(Joints, Engine, ::testing::Values(1, 2, 6, 7, 12, 30));

}  // namespace
