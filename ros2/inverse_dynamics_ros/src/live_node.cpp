// SPDX-License-Identifier: Apache-2.0

#include "inverse_dynamics_ros/live_node.hpp"

#include <chrono>
#include <cstdint>
#include <exception>
#include <inverse_dynamics_evaluation/online_derivative.hpp>
#include <inverse_dynamics_ros/live_node_parameters.hpp>
#include <inverse_dynamics_solver/strict_initialization.hpp>
#include <rclcpp/rclcpp.hpp>
#include <rclcpp_components/register_node_macro.hpp>
#include <sensor_msgs/msg/joint_state.hpp>
#include <std_msgs/msg/string.hpp>
#include <string>
#include <utility>
#include <vector>

#include "live_contact_topics.hpp"
#include "live_diagnostics.hpp"
#include "live_load.hpp"
#include "live_payload_action.hpp"
#include "live_torques.hpp"
#include "overridable.hpp"
#include "robot_parameters.hpp"
#include "user_error.hpp"

namespace inverse_dynamics_ros {
namespace {

using inverse_dynamics_evaluation::OnlineDerivative;
using sensor_msgs::msg::JointState;
using std_msgs::msg::String;

std::vector<double>& assign(std::vector<double>& numbers, const Eigen::VectorXd& vector) {
  numbers.assign(vector.data(), vector.data() + vector.size());
  return numbers;
}

}  // namespace

class LiveNode::Implementation {
 public:
  using Status = diagnostic_updater::DiagnosticStatusWrapper;

  explicit Implementation(LiveNode& node)
      : node_(node),
        listener_((declareRobotParameters(node), node.get_node_parameters_interface()),
                  node.get_logger()),
        params_(listener_.get_params()),
        robot_(givenParameters(node)),
        diagnostics_(node, node.get_node_topics_interface()->resolve_topic_name("joint_states"),
                     {params_.max_age, params_.min_rate}),
        load_(node, params_),
        payload_(node, params_, [this] { return load_.body(); }) {
    auto& parameters = *node.get_node_parameters_interface();
    inverse_dynamics_solver::rejectUndeclared(parameters);
    suggesting_ =
        inverse_dynamics_solver::suggestDeclared<rclcpp::exceptions::ParameterNotDeclaredException>(
            parameters);
    diagnostics_.add("load", [this](Status& status) { load_.report(status); });
    if (params_.external_torques.enabled) {
      contact_ = std::make_unique<LiveContactTopics>(node, params_.external_torques,
                                                     givenParameters(node));
      diagnostics_.add("external torques", [this](Status& status) { contact_->report(status); });
    }
    torques_publisher_ = node.create_publisher<JointState>("~/torques", rclcpp::QoS(10),
                                                           overridable<rclcpp::PublisherOptions>());
    residual_publisher_ = node.create_publisher<JointState>(
        "~/residual", rclcpp::QoS(10), overridable<rclcpp::PublisherOptions>());
    openSolver();
    joint_states_ = node.create_subscription<JointState>(
        "joint_states", rclcpp::SensorDataQoS().keep_last(10),
        [this](const JointState& message) { take(message); },
        overridable<rclcpp::SubscriptionOptions>());
    reminder_ = node.create_wall_timer(std::chrono::milliseconds(kReminder), [this] { remind(); });
  }

 private:
  rclcpp::Logger logger() const { return node_.get_logger(); }

  // The live node can't compare meanings: that needs a recording.
  static void requireMeaning(const inverse_dynamics_evaluation::Effort& effort) {
    if (effort.meaning == inverse_dynamics_evaluation::kAutomatic) {
      throw UserError("parameter 'effort'",
                      "what efforts mean: torque, current or "
                      "torque_without_gravity",
                      "auto, by the run configuration", "set it: only a recording can tell");
    }
  }

  // Opens the solver with the description of the parameters, else its own model; else waits for a
  // description.
  void openSolver() {
    const std::string description = robot_.description();
    try {
      useSolver(description);
    } catch (const inverse_dynamics_solver::ParameterUninitializedException& error) {
      if (!description.empty()) throw;
      description_ = node_.create_subscription<String>(
          "robot_description", rclcpp::QoS(1).transient_local(),
          [this](const String& message) { takeDescription(message.data); });
      waiting_for_ = description_->get_topic_name();
      diagnostics_.setSolver(false, "waiting for a robot description on " + waiting_for_);
      RCLCPP_INFO(logger(), "waiting for a robot description on %s (%s)", waiting_for_.c_str(),
                  error.what());
    }
  }

  void takeDescription(const std::string& text) {
    try {
      useSolver(text);
      waiting_for_.clear();
    } catch (const std::exception& error) {
      RCLCPP_ERROR(logger(), "the robot description on %s can't be used: %s",
                   description_->get_topic_name(), error.what());
      if (live_ == nullptr) {
        diagnostics_.setSolver(false, std::string("unusable robot description: ") + error.what());
      }
    }
  }

  // Replaces the solver; if it throws, nothing changes.
  void useSolver(const std::string& robot_description) {
    const auto solver = robot_.makeSolver(robot_description);
    const auto& robot = robot_.configuration();
    LiveOptions options;
    options.joints = inverse_dynamics_evaluation::recordedNames(robot, solver->jointNames());
    options.effort = inverse_dynamics_evaluation::statedEffort(
        inverse_dynamics_evaluation::effortOptions(robot, *solver));
    requireMeaning(options.effort);
    options.cutoff = params_.cutoff;
    options.longest_gap = params_.longest_gap;
    auto live = std::make_unique<LiveTorques>(solver, options);
    useRobot({solver, options.joints, robot.plugin, robot_.rootLink(robot_description),
              robot_.tipLink(robot_description, solver->tipNames()),
              options.effort.meaning == inverse_dynamics_evaluation::kTorqueWithoutGravity});
    live_ = std::move(live);
    torques_.name = residual_.name = options.joints;
    for (const std::string& warning : solver->warnings()) {
      RCLCPP_WARN(logger(), "%s", warning.c_str());
    }
    const std::string text = robot.plugin + ", " + std::to_string(solver->jointCount()) +
                             " joints: " + inverse_dynamics_evaluation::listed(options.joints);
    diagnostics_.setSolver(true, text);
    const std::string name = robot_.name(robot_description);
    diagnostics_.setRobot(name.empty() ? robot.plugin : name);
    RCLCPP_INFO(logger(), "solver: %s; accelerations late by %.0f ms", text.c_str(),
                1e3 * live_->delay());
  }

  // Gives the robot to all parts, or to none.
  void useRobot(const LiveRobot& robot) {
    auto contact = contact_ == nullptr ? nullptr : contact_->make(robot);
    load_.use(load_.make(robot), robot);
    payload_.use(robot);
    if (contact_ != nullptr) contact_->use(std::move(contact), robot);
  }

  void take(const JointState& message) {
    if (live_ == nullptr) return;
    const rclcpp::Time now = node_.now();
    std::int64_t stamp = rclcpp::Time(message.header.stamp).nanoseconds();
    if (stamp == 0) {
      stamp = now.nanoseconds();
      RCLCPP_WARN_ONCE(logger(), "joint states have no stamp: the time of reception is used");
    }
    const LiveTorques::Outcome outcome = live_->process(message, stamp);
    if (outcome == LiveTorques::Outcome::kOtherJoints) {
      ++diagnostics_.counts().other_joints;
      return;
    }
    diagnostics_.arrived(1e-9 * static_cast<double>(now.nanoseconds() - stamp));
    if (outcome != LiveTorques::Outcome::kMissing) diagnostics_.setMissing("");
    if (outcome == LiveTorques::Outcome::kComputed) publish(message);
    if (outcome != LiveTorques::Outcome::kMissing &&
        outcome != LiveTorques::Outcome::kNoVelocities) {
      payload_.take(stamp, *live_);
      if (contact_ != nullptr) contact_->take(message.header, stamp, *live_);
    }
    report(outcome);
    previous_stamp_ = stamp;
  }

  void publish(const JointState& message) {
    torques_.header = residual_.header = message.header;
    assign(torques_.position, live_->position());
    assign(torques_.velocity, live_->velocity());
    assign(torques_.effort, live_->computed());
    torques_publisher_->publish(torques_);
    ++diagnostics_.counts().computed;
    if (live_->hasResidual()) {
      assign(residual_.effort, live_->residual());
      residual_publisher_->publish(residual_);
    } else {
      ++diagnostics_.counts().no_efforts;
    }
  }

  // Counts and logs unusual outcomes.
  void report(LiveTorques::Outcome outcome) {
    LiveCounts& counts = diagnostics_.counts();
    switch (outcome) {
      case LiveTorques::Outcome::kMissing: {
        ++counts.missing;
        const std::string joints = inverse_dynamics_evaluation::listed(live_->culprits());
        diagnostics_.setMissing(joints);
        RCLCPP_ERROR_THROTTLE(logger(), steady_, kReminder,
                              "joint states lack (or repeat) joints: %s; the parameter 'joints' "
                              "gives the robot's names",
                              joints.c_str());
        return;
      }
      case LiveTorques::Outcome::kNoVelocities:
        ++counts.no_velocities;
        RCLCPP_ERROR_THROTTLE(logger(), steady_, kReminder,
                              "joint states lack positions or velocities: one per name is needed");
        return;
      case LiveTorques::Outcome::kNotFinite:
        ++counts.not_finite;
        RCLCPP_WARN_THROTTLE(
            logger(), steady_, kReminder,
            "a joint state has a position or velocity that isn't finite: left out");
        return;
      case LiveTorques::Outcome::kRepeated:
        ++counts.repeated;
        return;
      default:
        reportStep();
    }
  }

  void reportStep() {
    if (live_->step() == OnlineDerivative::Step::kWentBack) {
      ++diagnostics_.counts().clock_jumps;
      RCLCPP_WARN(
          logger(),
          "the clock jumped back to before %.9f s: the filter of the accelerations restarts",
          1e-9 * static_cast<double>(previous_stamp_));
    } else if (live_->step() == OnlineDerivative::Step::kGap) {
      ++diagnostics_.counts().gaps;
      RCLCPP_WARN_THROTTLE(logger(), steady_, kReminder,
                           "no joint states for more than %g s: the filter of the accelerations "
                           "restarts",
                           params_.longest_gap);
    }
  }

  // Logs from time to time what the node waits for.
  void remind() {
    if (!waiting_for_.empty()) {
      RCLCPP_WARN(logger(), "still waiting for a robot description on %s: %zu publisher(s)",
                  waiting_for_.c_str(), description_->get_publisher_count());
    } else if (live_ != nullptr && diagnostics_.counts().received == received_) {
      RCLCPP_WARN(
          logger(),
          "no joint states on %s: %zu publisher(s); with publishers, compare the quality of "
          "service (`ros2 topic info -v`) and the joint names",
          joint_states_->get_topic_name(), joint_states_->get_publisher_count());
    }
    received_ = diagnostics_.counts().received;
  }

  LiveNode& node_;
  std::shared_ptr<void> suggesting_;  // suggests names for misspelt parameters
  live_node::ParamListener listener_;
  live_node::Params params_;
  NodeRobot robot_;
  LiveDiagnostics diagnostics_;
  LiveLoad load_;
  LivePayloadAction payload_;
  std::unique_ptr<LiveContactTopics> contact_;  // null: not enabled
  std::unique_ptr<LiveTorques> live_;           // null until there is a description
  JointState torques_, residual_;               // reused, so that nothing is allocated per message
  std::int64_t previous_stamp_ = 0;             // ns
  std::int64_t received_ = 0;                   // at the last reminder
  std::string waiting_for_;                     // topic of the description
  rclcpp::Clock steady_{RCL_STEADY_TIME};       // of throttled log lines: never jumps
  rclcpp::Publisher<JointState>::SharedPtr torques_publisher_, residual_publisher_;
  rclcpp::Subscription<JointState>::SharedPtr joint_states_;
  rclcpp::Subscription<String>::SharedPtr description_;
  rclcpp::TimerBase::SharedPtr reminder_;
};

LiveNode::LiveNode(const rclcpp::NodeOptions& options)
    : rclcpp::Node("live", options), implementation_(std::make_unique<Implementation>(*this)) {}

LiveNode::~LiveNode() = default;

}  // namespace inverse_dynamics_ros

RCLCPP_COMPONENTS_REGISTER_NODE(inverse_dynamics_ros::LiveNode)
