// SPDX-License-Identifier: Apache-2.0
#include "wrench_publisher.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <geometry_msgs/msg/wrench.hpp>
#include <geometry_msgs/msg/wrench_stamped.hpp>
#include <inverse_dynamics_control/contact_sensing.hpp>
#include <inverse_dynamics_msgs/msg/contact.hpp>
#include <memory>
#include <rclcpp/create_timer.hpp>
#include <sensor_msgs/msg/joint_state.hpp>
#include <string>
#include <utility>
#include <vector>

#include "latest_value.hpp"

namespace inverse_dynamics_controllers {

using geometry_msgs::msg::WrenchStamped;
using inverse_dynamics_control::ContactSensing;
using inverse_dynamics_msgs::msg::Contact;
using sensor_msgs::msg::JointState;

// Estimates of one cycle.
struct Estimate {
  std::int64_t nanoseconds = 0;
  Eigen::VectorXd torques;
  std::array<double, 6> wrench{};
  bool contact = false;
  Eigen::Index joint = -1;  // of the contact
  double excess = 0.0;
};

namespace {

void write(const std::array<double, 6>& values, geometry_msgs::msg::Wrench& wrench) {
  wrench.force.x = values[0];
  wrench.force.y = values[1];
  wrench.force.z = values[2];
  wrench.torque.x = values[3];
  wrench.torque.y = values[4];
  wrench.torque.z = values[5];
}

}  // namespace

std::array<double, 6> sensorWrench(const ContactSensing& sensing) noexcept {
  const auto& [force, torque] = sensing.wrenchInTip();
  return {-force.x(), -force.y(), -force.z(), -torque.x(), -torque.y(), -torque.z()};
}

struct WrenchPublisher::Outbox {
  LatestValue<Estimate> newest;
  WrenchStamped wrench;
  JointState torques;
  rclcpp::Publisher<WrenchStamped>::SharedPtr wrench_publisher;
  rclcpp::Publisher<JointState>::SharedPtr torques_publisher;
  rclcpp::Publisher<Contact>::SharedPtr contact_publisher;  // null: no contacts

  void publish() {
    const Estimate* const estimate = newest.take();
    if (estimate == nullptr) return;
    wrench.header.stamp = rclcpp::Time(estimate->nanoseconds);
    write(estimate->wrench, wrench.wrench);
    wrench_publisher->publish(wrench);
    torques.header.stamp = wrench.header.stamp;
    torques.effort.assign(estimate->torques.begin(), estimate->torques.end());
    torques_publisher->publish(torques);
    if (contact_publisher == nullptr) return;
    Contact contact;
    contact.header.stamp = wrench.header.stamp;
    contact.contact = estimate->contact;
    if (estimate->contact && estimate->joint >= 0) {
      contact.joint = torques.name[static_cast<std::size_t>(estimate->joint)];
    }
    contact.excess = estimate->excess;
    contact_publisher->publish(contact);
  }
};

WrenchPublisher::WrenchPublisher(const std::shared_ptr<rclcpp_lifecycle::LifecycleNode>& node,
                                 const std::vector<std::string>& joints, const std::string& frame,
                                 double rate, bool contacts) {
  if (!(rate > 0)) return;
  Estimate first;
  first.torques.setZero(static_cast<Eigen::Index>(joints.size()));
  WrenchStamped wrench;
  wrench.header.frame_id = frame;
  JointState torques;
  torques.name = joints;
  const rclcpp::SystemDefaultsQoS qos;
  // NOLINTNEXTLINE(modernize-make-shared): an aggregate that can't be moved
  outbox_.reset(new Outbox{LatestValue<Estimate>(first), std::move(wrench), std::move(torques),
                           node->create_publisher<WrenchStamped>("~/wrench", qos),
                           node->create_publisher<JointState>("~/external_torques", qos),
                           contacts ? node->create_publisher<Contact>("~/contact", qos) : nullptr});
  timer_ = rclcpp::create_timer(node, node->get_clock(), rclcpp::Duration::from_seconds(1.0 / rate),
                                [outbox = outbox_] { outbox->publish(); });
}

void WrenchPublisher::note(const rclcpp::Time& time, const ContactSensing& sensing) noexcept {
  if (outbox_ == nullptr) return;
  Estimate& estimate = outbox_->newest.back();
  estimate.nanoseconds = time.nanoseconds();
  estimate.torques = sensing.torques();
  estimate.wrench = sensorWrench(sensing);
  if (const auto* const detector = sensing.detector()) {
    estimate.contact = detector->contact();
    estimate.joint = detector->joint();
    estimate.excess = detector->excess();
  }
  outbox_->newest.publish();
}

}  // namespace inverse_dynamics_controllers
