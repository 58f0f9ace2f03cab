// SPDX-License-Identifier: Apache-2.0
//
// A body at the tip that comes and goes, and where it comes from.
#include "inverse_dynamics_control/payload_ramp.hpp"

#include <gtest/gtest.h>

#include <inverse_dynamics_solver/payload.hpp>
#include <memory>
#include <string>
#include <ur10_inverse_dynamics_solver/ur10_inverse_dynamics_solver.hpp>
#include <vector>

#include "arms.hpp"

namespace inverse_dynamics_control::payload_ramp_test {

using Solver = ur10_inverse_dynamics_solver::InverseDynamicsSolverUR10;

// Of a UR10's gravity torques, rounding of sums around 100 N m.
constexpr double kRoundingOfTorques = 1e-11;

RigidBody tool() {
  RigidBody body;
  body.mass = 2.0;
  body.center_of_mass << 0.01, -0.02, 0.1;
  body.inertia = Eigen::Vector3d(0.02, 0.03, 0.04).asDiagonal();
  return body;
}

// About the origin of the tip frame.
Eigen::Matrix3d inertiaAboutTip(const RigidBody& body) {
  const Eigen::Vector3d& c = body.center_of_mass;
  return body.inertia +
         body.mass * (c.squaredNorm() * Eigen::Matrix3d::Identity() - c * c.transpose());
}

TEST(Between, AllInertialParametersChangeLinearly) {
  RigidBody other;
  other.mass = 0.5;
  other.center_of_mass << -0.2, 0.1, 0.3;
  for (const RigidBody& from : {RigidBody(), other}) {
    const RigidBody part = between(from, tool(), 0.3);
    EXPECT_FALSE(inverse_dynamics_solver::defectOf(part));
    EXPECT_NEAR(part.mass, 0.7 * from.mass + 0.3 * 2.0, 1e-15);
    const Eigen::Vector3d moment =
        0.7 * from.mass * from.center_of_mass + 0.3 * tool().mass * tool().center_of_mass;
    EXPECT_LT((part.mass * part.center_of_mass - moment).norm(), 1e-15);
    const Eigen::Matrix3d inertia = 0.7 * inertiaAboutTip(from) + 0.3 * inertiaAboutTip(tool());
    EXPECT_LT((inertiaAboutTip(part) - inertia).norm(), 1e-15);
  }
  EXPECT_EQ(between(tool(), RigidBody(), 1.0).mass, 0.0);
}

class PayloadRampTest : public testing::Test {
 protected:
  void SetUp() override {
    solver->initialize();
    empty = solver->getGravityVector(q);
    full = [this] {
      Solver loaded;
      loaded.initialize();
      loaded.setPayload("tool", tool());
      return loaded.getGravityVector(q);
    }();
  }

  // Greatest difference from the torques between those without and with the tool.
  double differenceAt(double part) const {
    const Eigen::VectorXd expected = (1.0 - part) * empty + part * full;
    return (solver->getGravityVector(q) - expected).cwiseAbs().maxCoeff();
  }

  const std::shared_ptr<Solver> solver = std::make_shared<Solver>();
  const Eigen::VectorXd q = vec({0.3, -1.2, 0.9, -0.4, 0.7, 0.2});
  Eigen::VectorXd empty, full;
};

TEST_F(PayloadRampTest, AChangeTakesItsTime) {
  PayloadRamp carried(solver, RigidBody(), 0.5);
  ASSERT_GT((full - empty).norm(), 5.0);
  carried.aimAt(tool());
  EXPECT_TRUE(carried.target() == tool());
  for (int k = 0; k <= 50; ++k) {
    EXPECT_LT(differenceAt(k / 50.0), kRoundingOfTorques) << k;
    carried.advance(0.01);
  }
  carried.aimAt(RigidBody());
  carried.advance(0.25);
  EXPECT_LT(differenceAt(0.5), kRoundingOfTorques);
  carried.aimAt(tool());  // from where it is
  EXPECT_LT(differenceAt(0.5), kRoundingOfTorques);
  carried.advance(0.25);
  EXPECT_LT(differenceAt(0.75), kRoundingOfTorques);
  carried.aimAt(RigidBody());
  carried.advance(9.0);
  EXPECT_TRUE(solver->payloads().empty());
}

TEST_F(PayloadRampTest, TheFirstBodyIsThereAtOnce) {
  const PayloadRamp carried(solver, tool(), 0.5);
  EXPECT_LT(differenceAt(1.0), kRoundingOfTorques);
}

TEST_F(PayloadRampTest, WithoutATimeAChangeIsOneStep) {
  PayloadRamp carried(solver, RigidBody(), 0.0);
  carried.aimAt(tool());
  carried.advance(0.01);
  EXPECT_LT(differenceAt(1.0), kRoundingOfTorques);
}

TEST_F(PayloadRampTest, OtherBodiesOfTheSolverStay) {
  solver->setPayload("gripper", tool());
  PayloadRamp carried(solver, RigidBody(), 0.0);
  carried.aimAt(tool());
  carried.advance(0.01);
  carried.aimAt(RigidBody());
  carried.advance(0.01);
  EXPECT_LT(differenceAt(1.0), kRoundingOfTorques);
}

TEST(PayloadRamp, ASolverThatCannotCarryIsRefusedABody) {
  PayloadRamp nothing(Pendulum::make(), RigidBody(), 0.5);
  nothing.aimAt(RigidBody());
  nothing.advance(1.0);
  const std::string refusal =
      "payload: the solver can't carry any: expected a solver with the capability Payload, got "
      "none "
      "of it; use another solver, or leave the mass at 0";
  EXPECT_EQ(thrownBy([&] { nothing.aimAt(tool()); }), refusal);
  EXPECT_EQ(nothing.target().mass, 0.0);
  EXPECT_EQ(thrownBy([&] { PayloadRamp(Pendulum::make(), tool(), 0.5); }), refusal);
}

TEST(BodyOf, NumbersOfNoPossibleBodyAreRefused) {
  const std::vector<double> center{0.01, -0.02, 0.1}, inertia{0.02, 0, 0, 0.03, 0, 0.04};
  EXPECT_TRUE(bodyOf(2.0, center, inertia, "parameter payload.") == tool());
  EXPECT_EQ(
      thrownBy([&] { bodyOf(2.0, {1.0}, inertia, "parameter payload."); }),
      "parameter payload.*: wrong size: expected 3 numbers of center_of_mass, 6 of inertia, got "
      "1 and 6; correct them");
  EXPECT_NE(thrownBy([&] {
              bodyOf(-1.0, center, inertia, "inertia.");
            }).find("inertia.mass: no possible body: expected a finite number >= 0 [kg], got -1"),
            std::string::npos);
  EXPECT_NE(thrownBy([&] {
              bodyOf(1.0, center, {0.1, 0, 0, 0.1, 0, 0.3}, "inertia.");
            }).find("inertia.inertia: no possible body: expected "),
            std::string::npos);
}

// As geometry_msgs/msg/InertiaStamped is laid out.
struct Message {
  struct {
    std::string frame_id;
  } header;
  struct {
    double m = 2.0;
    struct {
      double x = 0.01, y = -0.02, z = 0.1;
    } com;
    double ixx = 0.02, ixy = 0.001, ixz = 0.002, iyy = 0.03, iyz = 0.003, izz = 0.04;
  } inertia;
};

TEST(BodyOf, AMessageIsInTheTipFrame) {
  Message message;
  RigidBody body = tool();
  body.inertia(0, 1) = body.inertia(1, 0) = 0.001;
  body.inertia(0, 2) = body.inertia(2, 0) = 0.002;
  body.inertia(1, 2) = body.inertia(2, 1) = 0.003;
  EXPECT_TRUE(bodyOf(message, "tool0") == body);
  message.header.frame_id = "tool0";
  EXPECT_TRUE(bodyOf(message, "tool0") == body);
  message.header.frame_id = "flange";
  EXPECT_EQ(
      thrownBy([&] { bodyOf(message, "tool0"); }),
      "header.frame_id: another frame: expected the tip tool0, got flange; give it in the tip "
      "frame, or leave frame_id empty");
  EXPECT_EQ(
      thrownBy([&] { bodyOf(message, ""); }),
      "header.frame_id: another frame: expected the tip, got flange; give it in the tip frame, "
      "or leave frame_id empty");
}

}  // namespace inverse_dynamics_control::payload_ramp_test
