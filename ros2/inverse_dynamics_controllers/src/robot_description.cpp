// SPDX-License-Identifier: Apache-2.0
#include "robot_description.hpp"

#include <chrono>
#include <memory>
#include <mutex>
#include <std_msgs/msg/string.hpp>
#include <thread>
#include <utility>

namespace inverse_dynamics_controllers {

using std_msgs::msg::String;

namespace {

constexpr std::chrono::seconds kPatience(2);
constexpr std::chrono::milliseconds kPause(5);

}  // namespace

struct RobotDescriptionTopic::Inbox {
  void receive(const String& message) {
    const std::lock_guard<std::mutex> lock(mutex);
    newest = message.data;
  }

  std::string read() {
    const std::lock_guard<std::mutex> lock(mutex);
    return newest;
  }

  std::mutex mutex;
  std::string newest;
};

RobotDescriptionTopic::RobotDescriptionTopic(std::shared_ptr<rclcpp_lifecycle::LifecycleNode> node)
    : node_(std::move(node)),
      inbox_(std::make_shared<Inbox>()),
      subscription_(node_->create_subscription<String>(
          "robot_description", rclcpp::QoS(1).transient_local(),
          [inbox = inbox_](const String& message) { inbox->receive(message); })) {}

std::string RobotDescriptionTopic::find(const std::string& parameter,
                                        const std::string& managers) const {
  if (!parameter.empty()) return parameter;
  if (!managers.empty()) return managers;
  // The controller may be configured as soon as it is loaded, while the message is under way.
  const auto end = std::chrono::steady_clock::now() + kPatience;
  std::string newest = takeNewest();
  while (newest.empty() && subscription_->get_publisher_count() > 0 &&
         std::chrono::steady_clock::now() < end) {
    std::this_thread::sleep_for(kPause);
    newest = takeNewest();
  }
  if (newest.empty()) {
    RCLCPP_WARN(node_->get_logger(),
                "no robot description: nothing has come on %s so far; go on without, with what the "
                "solver itself knows; configure again once it is published, or set the parameter "
                "robot_description",
                subscription_->get_topic_name());
  }
  return newest;
}

std::string RobotDescriptionTopic::takeNewest() const {
  // Takes messages that have arrived, even if the node's executor hasn't handled them yet.
  String arrived;
  rclcpp::MessageInfo info;
  while (subscription_->take(arrived, info)) inbox_->receive(arrived);
  return inbox_->read();
}

}  // namespace inverse_dynamics_controllers
