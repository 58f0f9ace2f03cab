// SPDX-License-Identifier: Apache-2.0
#include "state_publisher.hpp"

#include <chain_dynamics/chain.hpp>
#include <control_msgs/msg/joint_trajectory_controller_state.hpp>
#include <cstdint>
#include <inverse_dynamics_control/signals.hpp>
#include <memory>
#include <rclcpp/create_timer.hpp>
#include <string>
#include <utility>
#include <vector>

#include "latest_value.hpp"

namespace inverse_dynamics_controllers {

using control_msgs::msg::JointTrajectoryControllerState;
using inverse_dynamics_control::JointState;
using inverse_dynamics_control::Reference;

// Content of a message.
struct Cycle {
  explicit Cycle(Eigen::Index joints)
      : state(joints), reference(joints), tau(Eigen::VectorXd::Zero(joints)) {}

  std::int64_t nanoseconds = 0;
  JointState state;
  Reference reference;
  bool has_reference = false;
  Eigen::VectorXd tau;
};

namespace {

std::vector<double> numbers(const Eigen::VectorXd& values) {
  return {values.data(), values.data() + values.size()};
}

void write(const Cycle& cycle, const std::vector<chain_dynamics::JointType>& types,
           JointTrajectoryControllerState& message) {
  message.header.stamp = rclcpp::Time(cycle.nanoseconds);
  message.feedback.positions = numbers(cycle.state.q);
  message.feedback.velocities = numbers(cycle.state.qd);
  message.output.effort = numbers(cycle.tau);
  if (!cycle.has_reference) return;
  message.reference.positions = numbers(cycle.reference.q);
  message.reference.velocities = numbers(cycle.reference.qd);
  message.reference.accelerations = numbers(cycle.reference.qdd);
  Eigen::VectorXd nearest = cycle.reference.q;
  chain_dynamics::unwrap(types, cycle.state.q, nearest);
  message.error.positions = numbers(nearest - cycle.state.q);
  message.error.velocities = numbers(cycle.reference.qd - cycle.state.qd);
}

}  // namespace

struct StatePublisher::Outbox {
  LatestValue<Cycle> newest;
  std::vector<chain_dynamics::JointType> types;
  JointTrajectoryControllerState message;
  rclcpp::Publisher<JointTrajectoryControllerState>::SharedPtr publisher;

  void publish() {
    const Cycle* const cycle = newest.take();
    if (cycle == nullptr || publisher->get_subscription_count() == 0) return;
    write(*cycle, types, message);
    publisher->publish(message);
  }
};

StatePublisher::StatePublisher(const std::shared_ptr<rclcpp_lifecycle::LifecycleNode>& node,
                               const std::vector<std::string>& joints,
                               const std::vector<chain_dynamics::JointType>& types, double rate) {
  if (!(rate > 0)) return;
  JointTrajectoryControllerState message;
  message.joint_names = joints;
  // NOLINTNEXTLINE(modernize-make-shared): an aggregate that can't be moved
  outbox_.reset(new Outbox{LatestValue<Cycle>(Cycle(static_cast<Eigen::Index>(joints.size()))),
                           types, std::move(message),
                           node->create_publisher<JointTrajectoryControllerState>(
                               "~/controller_state", rclcpp::SystemDefaultsQoS())});
  timer_ = rclcpp::create_timer(node, node->get_clock(), rclcpp::Duration::from_seconds(1.0 / rate),
                                [outbox = outbox_] { outbox->publish(); });
}

void StatePublisher::note(const rclcpp::Time& time, const JointState& state,
                          const Reference* reference, const Eigen::VectorXd& tau) noexcept {
  if (outbox_ == nullptr) return;
  Cycle& cycle = outbox_->newest.back();
  cycle.nanoseconds = time.nanoseconds();
  cycle.state.q = state.q;
  cycle.state.qd = state.qd;
  cycle.tau = tau;
  cycle.has_reference = reference != nullptr;
  if (reference != nullptr) {
    cycle.reference.q = reference->q;
    cycle.reference.qd = reference->qd;
    cycle.reference.qdd = reference->qdd;
  }
  outbox_->newest.publish();
}

}  // namespace inverse_dynamics_controllers
