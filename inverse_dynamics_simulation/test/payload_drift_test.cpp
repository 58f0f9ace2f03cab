// SPDX-License-Identifier: Apache-2.0
/// @file
/// How far an arm in MuJoCo drifts under gravity compensation with a load that the controller knows.
#include <inverse_dynamics_controllers/gravity_compensation_controller.hpp>
#include <inverse_dynamics_controllers/testing/controller_fixture.hpp>

#include "mujoco_arm.hpp"

namespace inverse_dynamics_simulation {
namespace {

using inverse_dynamics_controllers::ControllerFixture;
using inverse_dynamics_controllers::GravityCompensationController;
using inverse_dynamics_controllers::return_type;
using inverse_dynamics_controllers::ur10Description;
using inverse_dynamics_controllers::ur10Joints;
using inverse_dynamics_controllers::vec;

constexpr double kLoad = 2.0;         // kg, at the tip
constexpr double kTime = 10.0;        // s
constexpr double kLoopPeriod = 2e-3;  // s

/// A controller that guides a simulated arm.
class Guided : public ControllerFixture<GravityCompensationController> {
 public:
  void TestBody() override {}

  /// Greatest way of a joint in 10 s [rad].
  ///
  /// @param load         what hangs at the tip [kg].
  /// @param known        what the controller knows of it [kg].
  /// @param disturbance  of each joint [rad/s^2]: the torque that nobody knows, by the inertia of
  ///   the arm alone.
  double drift(double load, double known, double disturbance) {
    Parameters parameters = good();
    parameters["payload.mass"] = rclcpp::ParameterValue(known);
    parameters.erase("damping.values");  // for 5 1/s
    parameters["damping.posture"] =
        rclcpp::ParameterValue(std::vector<double>{0.0, -1.6, 1.2, -1.0, -1.5, 0.3});
    parameters["period"] = rclcpp::ParameterValue(kLoopPeriod);
    MujocoArm arm(ur10Description(), ur10Joints(), {"tool0", load});
    const Eigen::VectorXd start = vec({0.0, -1.6, 1.2, -1.0, -1.5, 0.3});
    arm.setPosition(start);
    const Eigen::VectorXd push = disturbance * solver()->getInertiaMatrix(start).diagonal();
    hardware.set(start, Eigen::VectorXd::Zero(6));
    EXPECT_TRUE(configure(parameters) && activate()) << log.text();
    for (double t = 0; t < kTime; t += kLoopPeriod) {
      hardware.set(arm.q(), arm.qd());
      EXPECT_EQ(update(), return_type::OK);
      arm.step(hardware.effort() + push, kLoopPeriod);
    }
    return (arm.q() - start).cwiseAbs().maxCoeff();
  }
};

class PayloadDrift : public ::testing::Test {
 protected:
  static void SetUpTestSuite() { rclcpp::init(0, nullptr); }
  static void TearDownTestSuite() { rclcpp::shutdown(); }
};

TEST_F(PayloadDrift, AKnownLoadStaysWhereItIsPut) {
  EXPECT_LT(Guided().drift(kLoad, kLoad, 0.0), 1e-6);
  EXPECT_GT(Guided().drift(kLoad, 0.0, 0.0), 0.1);
}

TEST_F(PayloadDrift, AKnownLoadDriftsNoFartherThanTheArmAlone) {
  constexpr double kDisturbance = 0.05;  // rad/s^2
  const double without = Guided().drift(0.0, 0.0, kDisturbance);
  const double with = Guided().drift(kLoad, kLoad, kDisturbance);
  RecordProperty("drift_without_load", std::to_string(without));
  RecordProperty("drift_with_load", std::to_string(with));
  EXPECT_GT(without, 1e-3);
  EXPECT_LT(with, 1.2 * without);
}

}  // namespace
}  // namespace inverse_dynamics_simulation
