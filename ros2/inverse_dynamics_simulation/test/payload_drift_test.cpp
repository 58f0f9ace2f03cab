// SPDX-License-Identifier: Apache-2.0
/// @file
/// How far arms in MuJoCo drift under gravity compensation with a load that the controller knows.
#include <fstream>
#include <inverse_dynamics_controllers/gravity_compensation_controller.hpp>
#include <inverse_dynamics_controllers/testing/controller_fixture.hpp>
#include <inverse_dynamics_solver/installed_package.hpp>
#include <sstream>

#include "mujoco_arm.hpp"

namespace inverse_dynamics_simulation {
namespace {

using inverse_dynamics_controllers::ControllerFixture;
using inverse_dynamics_controllers::FakeHardware;
using inverse_dynamics_controllers::GravityCompensationController;
using inverse_dynamics_controllers::return_type;
using inverse_dynamics_controllers::ur10Joints;
using inverse_dynamics_controllers::vec;

constexpr double kLoad = 2.0;         // kg, at the tip
constexpr double kTime = 10.0;        // s
constexpr double kLoopPeriod = 2e-3;  // s, of 500 Hz

struct Posture {
  std::string name;
  std::string robot;  // of the file NAME.urdf
  std::string root, tip;
  std::vector<std::string> joints;
  Eigen::VectorXd q;  // rad
};

std::string descriptionOf(const std::string& robot) {
  std::ifstream file(inverse_dynamics_solver::installedPackageShare("inverse_dynamics_robots") +
                     "/urdf/" + robot + ".urdf");
  std::stringstream text;
  text << file.rdbuf();
  return text.str();
}

Posture ur10(const std::string& name, const Eigen::VectorXd& q) {
  return {"ur10_" + name, "ur10", "base_link", "tool0", ur10Joints(), q};
}

Posture panda(const std::string& name, const Eigen::VectorXd& q) {
  std::vector<std::string> joints;
  for (int j = 1; j <= 7; ++j) joints.push_back("fer_joint" + std::to_string(j));
  return {"panda_" + name, "panda", "fer_link0", "fer_link8", joints, q};
}

std::vector<Posture> postures() {
  return {ur10("home", vec({0.0, -1.6, 1.2, -1.0, -1.5, 0.3})),
          ur10("stretched", vec({0.4, -0.3, 0.2, -0.5, -1.2, 0.0})),
          ur10("low", vec({-1.0, -0.9, 1.9, -2.0, -1.7, 0.8})),
          panda("home", vec({0.0, -0.5, 0.2, -2.0, 0.1, 1.8, 0.6})),
          panda("stretched", vec({0.5, 1.0, -0.3, -0.7, 0.4, 1.6, -0.5})),
          panda("low", vec({-0.8, 0.8, 0.5, -2.2, -0.6, 2.4, 0.2}))};
}

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
  double drift(const Posture& start, double load, double known, double disturbance) {
    const std::string urdf = descriptionOf(start.robot);
    MujocoArm arm(urdf, start.joints, {start.tip, load});
    arm.setPosition(start.q);
    const Eigen::VectorXd push = disturbance * inertias(start, urdf);
    hardware = FakeHardware(start.joints);
    hardware.set(start.q, Eigen::VectorXd::Zero(start.q.size()));
    EXPECT_TRUE(configure(parameters(start, urdf, known)) && activate()) << log.text();
    for (double t = 0; t < kTime; t += kLoopPeriod) {
      hardware.set(arm.q(), arm.qd());
      EXPECT_EQ(update(), return_type::OK);
      arm.step(hardware.effort() + push, kLoopPeriod);
    }
    return (arm.q() - start.q).cwiseAbs().maxCoeff();
  }

 private:
  static Parameters parameters(const Posture& start, const std::string& urdf, double known) {
    Parameters parameters = good();
    parameters["robot_description"] = rclcpp::ParameterValue(urdf);
    parameters["ids.root"] = rclcpp::ParameterValue(start.root);
    parameters["ids.tip"] = rclcpp::ParameterValue(start.tip);
    parameters["payload.mass"] = rclcpp::ParameterValue(known);
    parameters.erase("damping.values");  // for 5 1/s
    parameters["update_rate"] = rclcpp::ParameterValue(500);
    return parameters;
  }

  /// Of each joint alone, at the start: kg m^2.
  static Eigen::VectorXd inertias(const Posture& start, const std::string& urdf) {
    const auto solver =
        inverse_dynamics_solver::SolverLoader().load(inverse_dynamics_controllers::kKdl);
    solver->initialize({{"root", start.root}, {"tip", start.tip}}, "", urdf);
    return solver->getInertiaMatrix(start.q).diagonal();
  }
};

class PayloadDrift : public ::testing::TestWithParam<Posture> {
 protected:
  static void SetUpTestSuite() { rclcpp::init(0, nullptr); }
  static void TearDownTestSuite() { rclcpp::shutdown(); }
};

TEST_P(PayloadDrift, AKnownLoadStaysWhereItIsPut) {
  EXPECT_LT(Guided().drift(GetParam(), kLoad, kLoad, 0.0), 1e-6);
  EXPECT_GT(Guided().drift(GetParam(), kLoad, 0.0, 0.0), 0.1);
}

TEST_P(PayloadDrift, AKnownLoadDriftsNoFartherThanTheArmAlone) {
  constexpr double kDisturbance = 0.05;  // rad/s^2
  const double without = Guided().drift(GetParam(), 0.0, 0.0, kDisturbance);
  const double with = Guided().drift(GetParam(), kLoad, kLoad, kDisturbance);
  RecordProperty("drift_without_load", std::to_string(without));
  RecordProperty("drift_with_load", std::to_string(with));
  EXPECT_GT(without, 1e-3);
  EXPECT_LT(with, 1.2 * without);
}

INSTANTIATE_TEST_SUITE_P(Arms, PayloadDrift, ::testing::ValuesIn(postures()),
                         [](const auto& posture) { return posture.param.name; });

}  // namespace
}  // namespace inverse_dynamics_simulation
