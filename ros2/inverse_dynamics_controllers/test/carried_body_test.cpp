// SPDX-License-Identifier: Apache-2.0
#include "carried_body.hpp"

#include <algorithm>

#include "inverse_dynamics_controllers/gravity_compensation_controller.hpp"
#include "inverse_dynamics_controllers/testing/controller_fixture.hpp"

namespace inverse_dynamics_controllers {
namespace {

using geometry_msgs::msg::InertiaStamped;
using inverse_dynamics_solver::Payload;
using inverse_dynamics_solver::RigidBody;
using Numbers = std::vector<double>;

constexpr double kRounding = 1e-9;

RigidBody tool() {
  RigidBody body;
  body.mass = 2.0;
  body.center_of_mass << 0.01, -0.02, 0.1;
  body.inertia = Eigen::Vector3d(0.02, 0.03, 0.04).asDiagonal();
  return body;
}

class CarriedBodyTest : public ControllerFixture<GravityCompensationController> {
 protected:
  void SetUp() override { hardware.set(q, Eigen::VectorXd::Zero(6)); }

  // Gravity of the arm with a body.
  Eigen::VectorXd gravity(const RigidBody& body) const {
    const auto carrier = solver();
    dynamic_cast<Payload&>(*carrier).setPayload("tool", body);
    return carrier->getGravityVector(q);
  }

  // Cycles until the effort is the one of a body; the greatest step between two cycles [N m].
  double greatestStepTo(const RigidBody& body) {
    const Eigen::VectorXd end = gravity(body);
    double greatest = 0.0;
    EXPECT_TRUE(spinUntil([&] {
      const Eigen::VectorXd before = hardware.effort();
      EXPECT_EQ(update(), return_type::OK);
      greatest = std::max(greatest, (hardware.effort() - before).norm());
      return (hardware.effort() - end).norm() < kRounding;
    })) << log.text();
    return greatest;
  }

  const Eigen::VectorXd q = vec({0.3, -1.2, 0.9, -0.4, 0.7, 0.2});
};

TEST_F(CarriedBodyTest, ABodyOfTheParametersIsCarriedFromTheFirstCycleOn) {
  Parameters parameters = good();
  parameters["payload.mass"] = rclcpp::ParameterValue(2.0);
  parameters["payload.center_of_mass"] = rclcpp::ParameterValue(Numbers{0.01, -0.02, 0.1});
  ASSERT_TRUE(configure(parameters) && activate()) << log.text();
  EXPECT_EQ(update(), return_type::OK);
  EXPECT_LT((hardware.effort() - gravity(tool())).norm(), kRounding);
}

TEST_F(CarriedBodyTest, AChangeTakesTheTimeOfTheRamp) {
  Parameters parameters = good();
  parameters["payload.ramp_time"] = rclcpp::ParameterValue(0.5);
  ASSERT_TRUE(configure(parameters) && activate()) << log.text();
  EXPECT_EQ(update(), return_type::OK);
  RigidBody point;
  point.mass = 2.0;
  const double change = (gravity(point) - hardware.effort()).norm();
  ASSERT_GT(change, 5.0);
  EXPECT_EQ(set("payload.mass", rclcpp::ParameterValue(2.0)), "");
  // 50 steps; a busy computer may do some of them at once.
  EXPECT_LT(greatestStepTo(point), 0.2 * change);
  EXPECT_EQ(set("payload.mass", rclcpp::ParameterValue(0.0)), "");
  EXPECT_LT(greatestStepTo(RigidBody()), 0.2 * change);
  EXPECT_EQ(log.text(), "");
}

TEST_F(CarriedBodyTest, ABodyOfTheTopicIsCarried) {
  Parameters parameters = good();
  parameters["payload.ramp_time"] = rclcpp::ParameterValue(0.1);
  ASSERT_TRUE(configure(parameters) && activate()) << log.text();
  EXPECT_EQ(update(), return_type::OK);
  const auto sender = std::make_shared<rclcpp::Node>("sender");
  const auto publisher = sender->create_publisher<InertiaStamped>("under_test/payload", 1);
  ASSERT_TRUE(spinUntil([&] { return publisher->get_subscription_count() == 1; }));
  InertiaStamped message;
  message.header.frame_id = "tool0";
  message.inertia.m = 2.0;
  message.inertia.com.x = 0.01;
  message.inertia.com.y = -0.02;
  message.inertia.com.z = 0.1;
  publisher->publish(message);
  greatestStepTo(tool());

  message.inertia.m = -1.0;
  publisher->publish(message);
  EXPECT_TRUE(spinUntil([this] { return log.has("ERROR: ~/payload: ignored: inertia.mass: "); }))
      << log.text();
  message.inertia.m = 1.0;
  message.header.frame_id = "flange";
  publisher->publish(message);
  EXPECT_TRUE(spinUntil([this] {
    return log.has(
        "ERROR: ~/payload: ignored: header.frame_id: another frame: expected the tip "
        "tool0, got flange; give it in the tip frame, or leave frame_id empty");
  })) << log.text();
  EXPECT_EQ(update(), return_type::OK);
  EXPECT_LT((hardware.effort() - gravity(tool())).norm(), kRounding);
}

TEST_F(CarriedBodyTest, ParametersOfNoPossibleBodyAreRefused) {
  ASSERT_TRUE(configure(good()) && activate()) << log.text();
  EXPECT_NE(set("payload.mass", rclcpp::ParameterValue(-1.0)), "");
  EXPECT_NE(set("payload.mass", rclcpp::ParameterValue(kNan)), "");
  EXPECT_NE(set("payload.center_of_mass", rclcpp::ParameterValue(Numbers{1.0})), "");
  EXPECT_EQ(set("payload.mass", rclcpp::ParameterValue(1.0)), "");
  const std::string reason =
      set("payload.inertia", rclcpp::ParameterValue(Numbers{0.1, 0.0, 0.0, 0.1, 0.0, 0.3}));
  EXPECT_NE(reason.find("parameter payload.inertia: no possible body: expected "),
            std::string::npos)
      << reason;
}

TEST_F(CarriedBodyTest, ConfiguringRefusesThemToo) {
  Parameters parameters = good();
  parameters["payload.mass"] = rclcpp::ParameterValue(1.0);
  parameters["payload.inertia"] = rclcpp::ParameterValue(Numbers{0.1, 0.0, 0.0, 0.1, 0.0, 0.3});
  EXPECT_FALSE(configure(parameters));
  EXPECT_TRUE(log.has("ERROR: parameter payload.inertia: no possible body: expected "))
      << log.text();
}

}  // namespace
}  // namespace inverse_dynamics_controllers
