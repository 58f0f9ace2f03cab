// SPDX-License-Identifier: Apache-2.0
/// @file
/// What the broadcaster takes for a wrench while an arm in MuJoCo holds a load that it doesn't know.
#include <geometry_msgs/msg/wrench_stamped.hpp>
#include <inverse_dynamics_controllers/external_wrench_broadcaster.hpp>
#include <inverse_dynamics_controllers/gravity_compensation_controller.hpp>
#include <inverse_dynamics_controllers/testing/controller_fixture.hpp>
#include <inverse_dynamics_solver/kinematics.hpp>

#include "mujoco_arm.hpp"

namespace inverse_dynamics_simulation {
namespace {

using inverse_dynamics_controllers::ControllerFixture;
using inverse_dynamics_controllers::ExternalWrenchBroadcaster;
using inverse_dynamics_controllers::GravityCompensationController;
using inverse_dynamics_controllers::return_type;
using inverse_dynamics_controllers::ur10Description;
using inverse_dynamics_controllers::ur10Joints;
using inverse_dynamics_controllers::vec;

constexpr double kLoad = 2.0;  // kg, at the tip
constexpr double kTime = 1.0;  // s

/// Holds the arm, and knows the load.
class Holder : public ControllerFixture<GravityCompensationController> {
 public:
  using ControllerFixture::log;
  void TestBody() override {}

  bool start(const MujocoArm& arm) {
    Parameters parameters = good();
    parameters["payload.mass"] = rclcpp::ParameterValue(kLoad);
    parameters.erase("damping.values");  // for 5 1/s
    hardware.set(arm.q(), arm.qd());
    return configure(parameters) && activate();
  }

  Eigen::VectorXd efforts(const MujocoArm& arm) {
    hardware.set(arm.q(), arm.qd());
    EXPECT_EQ(update(), return_type::OK);
    return hardware.effort();
  }
};

/// Measures, and doesn't know the load.
class Sensor : public ControllerFixture<ExternalWrenchBroadcaster> {
 public:
  using ControllerFixture::log;
  using ControllerFixture::solver;
  void TestBody() override {}

  bool start() {
    Parameters parameters = good();
    parameters.erase("damping.values");  // a controller's
    parameters["noise"] = rclcpp::ParameterValue(std::vector<double>{1e-3});
    if (!configure(parameters)) return false;
    listener_ = std::make_shared<rclcpp::Node>("listener");
    subscription_ = listener_->create_subscription<geometry_msgs::msg::WrenchStamped>(
        "under_test/wrench", 10,
        [this](const geometry_msgs::msg::WrenchStamped& message) { wrench_ = message.wrench; });
    executor.add_node(listener_);
    return activate();
  }

  void measure(const MujocoArm& arm, const Eigen::VectorXd& effort) {
    hardware.set(arm.q(), arm.qd());
    hardware.setEffort(effort);
    EXPECT_EQ(update(), return_type::OK);
  }

  /// The force of the newest message, in tip axes.
  Eigen::Vector3d force() {
    EXPECT_TRUE(spinUntil([this] { return wrench_.force.x != 0; })) << log.text();
    return {wrench_.force.x, wrench_.force.y, wrench_.force.z};
  }

 private:
  std::shared_ptr<rclcpp::Node> listener_;
  rclcpp::Subscription<geometry_msgs::msg::WrenchStamped>::SharedPtr subscription_;
  geometry_msgs::msg::Wrench wrench_;
};

TEST(ExternalWrench, AnUnknownLoadPullsTheTipDownByItsWeight) {
  rclcpp::init(0, nullptr);
  {
    MujocoArm arm(ur10Description(), ur10Joints(), {"tool0", kLoad});
    const Eigen::VectorXd q = vec({0.4, -1.2, 1.2, -1.0, -1.5, 0.3});
    arm.setPosition(q);
    Holder holder;
    Sensor sensor;
    ASSERT_TRUE(holder.start(arm)) << holder.log.text();
    ASSERT_TRUE(sensor.start()) << sensor.log.text();
    for (double t = 0; t < kTime; t += inverse_dynamics_controllers::kPeriod) {
      const Eigen::VectorXd effort = holder.efforts(arm);
      arm.step(effort, inverse_dynamics_controllers::kPeriod);
      sensor.measure(arm, effort);
    }
    ASSERT_LT((arm.q() - q).cwiseAbs().maxCoeff(), 1e-6);  // it rests
    const auto solver = Sensor::solver();
    const auto& kinematics = dynamic_cast<const inverse_dynamics_solver::Kinematics&>(*solver);
    const Eigen::Vector3d in_root = kinematics.getTipPose(q).R * sensor.force();
    EXPECT_LT((in_root - Eigen::Vector3d(0, 0, -kLoad * 9.81)).norm(), 1e-3) << in_root.transpose();
  }
  rclcpp::shutdown();
}

}  // namespace
}  // namespace inverse_dynamics_simulation
