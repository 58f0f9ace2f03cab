// SPDX-License-Identifier: Apache-2.0

#include "live_contact_topics.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <diagnostic_msgs/msg/diagnostic_status.hpp>
#include <geometry_msgs/msg/vector3.hpp>
#include <inverse_dynamics_control/joint_parameters.hpp>
#include <inverse_dynamics_solver/external_wrench.hpp>
#include <inverse_dynamics_solver/parameters.hpp>
#include <sstream>
#include <std_msgs/msg/header.hpp>
#include <string>
#include <utility>

#include "contact_file.hpp"
#include "overridable.hpp"
#include "user_error.hpp"

namespace inverse_dynamics_ros {
namespace {

using diagnostic_msgs::msg::DiagnosticStatus;
using diagnostic_updater::DiagnosticStatusWrapper;
using inverse_dynamics_control::EstimatorOptions;
using inverse_dynamics_control::VelocitySource;
using inverse_dynamics_solver::Parameters;
using inverse_dynamics_solver::WrenchFrame;

const std::string kNamespace = "external_torques.";

// Names of LiveContact::counts().
constexpr std::array<const char*, std::tuple_size_v<LiveContact::Counts>> kCounted{
    "estimates",          "samples of a start", "gaps",          "states not finite",
    "efforts not finite", "model not finite",   "solver failed", "wrong sizes"};

// Numbers in words: `(0.1 0.2 0.3)`.
template <class Vector>
std::string inWords(const Vector& vector) {
  std::ostringstream text;
  text.precision(3);
  text << "(" << vector.transpose() << ")";
  return text.str();
}

// The numbers of the file, unless the user has set the parameter.
void readFile(const ContactFile& file, const Parameters& given,
              live_node::Params::ExternalTorques& parameters) {
  const auto set = [&given](const char* name, auto& parameter, const auto& of_file) {
    if (!given.find(kNamespace + name)) parameter = of_file;
  };
  const auto numbers = [](const Eigen::VectorXd& vector) {
    return std::vector<double>(vector.data(), vector.data() + vector.size());
  };
  set("gain", parameters.gain, file.gain);
  set("tracking", parameters.tracking, file.tracking.value_or(parameters.tracking));
  set("velocities", parameters.velocities, file.measured_velocities ? "measured" : "positions");
  set("friction_band", parameters.friction_band, file.friction_band);
  set("thresholds", parameters.thresholds, numbers(file.thresholds));
  set("noise", parameters.noise, numbers(file.noise));
}

}  // namespace

LiveContactTopics::LiveContactTopics(rclcpp::Node& node,
                                     const live_node::Params::ExternalTorques& parameters,
                                     Parameters given)
    : logger_(node.get_logger()), parameters_(parameters), given_(std::move(given)) {
  using Options = rclcpp::PublisherOptions;
  torques_publisher_ = node.create_publisher<sensor_msgs::msg::JointState>(
      "~/external_torques", rclcpp::QoS(10), overridable<Options>());
  wrench_publisher_ = node.create_publisher<geometry_msgs::msg::WrenchStamped>(
      "~/wrench", rclcpp::QoS(10), overridable<Options>());
  contact_publisher_ = node.create_publisher<inverse_dynamics_msgs::msg::Contact>(
      "~/contact", rclcpp::QoS(10), overridable<Options>());
}

LiveContactOptions LiveContactTopics::options(const LiveRobot& robot) const {
  live_node::Params::ExternalTorques p = parameters_;
  if (!p.contacts_file.empty()) {
    readFile(readContactFile(p.contacts_file, robot.solver->jointNames()), given_, p);
  }
  LiveContactOptions options;
  EstimatorOptions& estimator = options.estimator;
  const auto numbers = [&](const std::string& name, const std::vector<double>& given) {
    return inverse_dynamics_control::jointNumbers(kNamespace + name, given,
                                                  robot.solver->jointNames(), {});
  };
  estimator.gain = numbers("gain", {p.gain});
  estimator.velocity =
      p.velocities == "measured" ? VelocitySource::kMeasured : VelocitySource::kPositions;
  estimator.tracking = p.tracking;
  estimator.compensated.gravity = robot.efforts_without_gravity;
  estimator.friction_band = numbers("friction_band", p.friction_band);
  estimator.longest_period = p.longest_period;
  options.thresholds = numbers("thresholds", p.thresholds);
  options.wrench.noise = numbers("noise", p.noise);
  options.wrench.force = p.expected_force;
  options.wrench.torque = p.expected_torque;
  options.wrench_frame = p.wrench_frame == "root" ? WrenchFrame::kRoot : WrenchFrame::kTip;
  return options;
}

std::unique_ptr<LiveContact> LiveContactTopics::make(const LiveRobot& robot) const {
  auto contact = std::make_unique<LiveContact>(robot.solver, options(robot));
  if (contact->tip() != nullptr && frame(robot).empty()) {
    throw UserError("parameter 'ids." + parameters_.wrench_frame + "'",
                    "the name of the link in whose frame the wrench is", "nothing", "set it");
  }
  return contact;
}

const std::string& LiveContactTopics::frame(const LiveRobot& robot) const {
  return parameters_.wrench_frame == "root" ? robot.root : robot.tip;
}

void LiveContactTopics::use(std::unique_ptr<LiveContact> contact, const LiveRobot& robot) {
  contact_ = std::move(contact);
  torques_.name = joints_ = robot.joints;
  wrench_.header.frame_id = frame(robot);
  estimator_ = robot.solver->inertiaIsPhysical() ? "momentum observer" : "acceleration residual";
  reported_ = 0;
  const std::string in_frame = "in " + wrench_.header.frame_id;
  RCLCPP_INFO(logger_, "external torques: %s; wrench: %s; contacts: %s", estimator_.c_str(),
              contact_->tip() != nullptr ? in_frame.c_str()
                                         : "none, without external_torques.noise or .contacts_file",
              contact_->detector() != nullptr
                  ? "flagged"
                  : "none, without external_torques.thresholds or .contacts_file");
}

void LiveContactTopics::take(const std_msgs::msg::Header& header, std::int64_t stamp,
                             const LiveTorques& live) {
  const bool estimated = contact_->status() == LiveContact::Status::kOk;
  if (contact_->update(stamp, live.position(), live.velocity(), live.measured())) {
    torques_.header = found_contact_.header = header;
    wrench_.header.stamp = header.stamp;
    publish();
  } else if (estimated && contact_->status() != LiveContact::Status::kOk) {
    RCLCPP_WARN_THROTTLE(logger_, steady_, kReminder, "external torques: %s",
                         text(contact_->status()));
  }
}

void LiveContactTopics::publish() {
  const auto& torques = contact_->torques();
  torques_.effort.assign(torques.data(), torques.data() + torques.size());
  torques_publisher_->publish(torques_);
  if (contact_->hasWrench()) {
    const auto assign = [](const Eigen::Vector3d& from, geometry_msgs::msg::Vector3& to) {
      to.x = from.x();
      to.y = from.y();
      to.z = from.z();
    };
    assign(contact_->force(), wrench_.wrench.force);
    assign(contact_->torque(), wrench_.wrench.torque);
    wrench_publisher_->publish(wrench_);
  }
  if (const auto* const detector = contact_->detector()) {
    found_contact_.contact = detector->contact();
    found_contact_.joint = found_contact_.contact ? contactJoint() : "";
    found_contact_.excess = detector->excess();
    contact_publisher_->publish(found_contact_);
  }
}

const std::string& LiveContactTopics::contactJoint() const {
  return joints_[static_cast<std::size_t>(
      std::max<Eigen::Index>(0, contact_->detector()->joint()))];
}

void LiveContactTopics::report(DiagnosticStatusWrapper& status) {
  if (contact_ == nullptr) {
    status.summary(DiagnosticStatus::WARN, "no solver yet");
    return;
  }
  const LiveContact::Counts& counts = contact_->counts();
  const std::int64_t estimates = counts[static_cast<std::size_t>(LiveContact::Status::kOk)];
  status.summary(DiagnosticStatus::OK, "external torques are estimated");
  if (estimates == reported_) {
    status.summary(DiagnosticStatus::WARN, "no estimate since the last report");
  }
  if (contact_->status() != LiveContact::Status::kOk) {
    status.mergeSummary(DiagnosticStatus::WARN, text(contact_->status()));
  }
  status.add("estimator", estimator_);
  for (std::size_t k = 0; k < counts.size(); ++k) status.add(kCounted[k], counts[k]);
  reportWrench(status);
  reportContact(status);
  reported_ = estimates;
}

void LiveContactTopics::reportWrench(DiagnosticStatusWrapper& status) const {
  if (contact_->tip() == nullptr || !contact_->hasWrench()) return;
  const inverse_dynamics_control::TipWrench& tip = *contact_->tip();
  const Eigen::Index unseen = tip.unseen();
  if (unseen > std::max<Eigen::Index>(0, 6 - tip.jointCount())) {
    status.mergeSummary(DiagnosticStatus::WARN,
                        std::to_string(unseen) + " directions of a wrench can't be seen");
  }
  status.add("unseen directions", unseen);
  for (Eigen::Index i = 6 - unseen; i < 6; ++i) {
    status.add("unseen direction " + std::to_string(i - 5 + unseen),
               "force " + inWords(tip.directions().col(i).head(3)) + " N, torque " +
                   inWords(tip.directions().col(i).tail(3)) + " N m, axes of the root");
  }
  status.add("least signal to noise", tip.signalToNoise()[5]);
}

void LiveContactTopics::reportContact(DiagnosticStatusWrapper& status) const {
  if (contact_->detector() == nullptr) return;
  const inverse_dynamics_control::ContactDetector& detector = *contact_->detector();
  if (detector.contact()) status.mergeSummary(DiagnosticStatus::OK, "contact");
  status.add("contact", detector.contact() ? contactJoint() : "none");
  status.add("greatest torque by threshold", detector.excess());
}

}  // namespace inverse_dynamics_ros
