// SPDX-License-Identifier: Apache-2.0
#include "inverse_dynamics_controllers/external_wrench_broadcaster.hpp"

#include <algorithm>
#include <inverse_dynamics_control/contact_sensing.hpp>
#include <inverse_dynamics_control/estimator_choice.hpp>
#include <inverse_dynamics_control/external_torque_estimator.hpp>
#include <inverse_dynamics_control/joint_parameters.hpp>
#include <inverse_dynamics_controllers/external_wrench_broadcaster_parameters.hpp>
#include <inverse_dynamics_solver/exceptions.hpp>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "arm.hpp"
#include "control_loop.hpp"
#include "wrench_publisher.hpp"
#include "wrench_report.hpp"

namespace inverse_dynamics_controllers {

using controller_interface::CallbackReturn;
using controller_interface::return_type;
using inverse_dynamics_control::ContactOptions;
using inverse_dynamics_control::EstimateStatus;
using inverse_dynamics_control::Estimator;
using inverse_dynamics_control::jointNumbers;
using inverse_dynamics_control::VelocitySource;
using inverse_dynamics_solver::InvalidParameterValueException;
using inverse_dynamics_solver::ParameterUninitializedException;
using Parameters = external_wrench_broadcaster::Params;

namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

Estimator estimatorOf(const std::string& name) {
  if (name == "momentum") return Estimator::kMomentum;
  return name == "automatic" ? Estimator::kAutomatic : Estimator::kAccelerationResidual;
}

void requireNoise(const std::vector<double>& noise) {
  if (!noise.empty()) return;
  throw ParameterUninitializedException(
      "parameter 'noise'", "not set",
      "the standard deviation of the external torque of each joint without contact [N m]",
      "nothing", "take it from contacts.json of `ids contact`, or from ~/external_torques at rest");
}

// Cycles that are all gaps would give no estimate ever.
void requireShortPeriod(double period, double longest) {
  if (period <= longest) return;
  throw InvalidParameterValueException(
      "parameter 'longest_period'", "shorter than the period of the control loop",
      "more than " + std::to_string(period) + " s", std::to_string(longest),
      "set it to a few periods, or raise 'update_rate'");
}

std::string frameOf(const Setup& setup, const Parameters& params) {
  std::string frame = params.frame_id.empty() ? setup.tip() : params.frame_id;
  if (!frame.empty()) return frame;
  throw ParameterUninitializedException(
      "parameter 'frame_id'", "not set", "the frame of the wrench, the arm's tip",
      "neither it nor 'ids.tip'", "set it to the name of the tip's link");
}

ContactOptions optionsOf(const Setup& setup, const Parameters& params) {
  const std::vector<std::string>& joints = setup.arm.joints;
  requireNoise(params.noise);
  requireShortPeriod(setup.period, params.longest_period);
  ContactOptions options;
  options.choice = estimatorOf(params.estimator);
  options.estimator.gain = jointNumbers("gain", params.gain, joints);
  options.estimator.velocity =
      params.velocity == "measured" ? VelocitySource::kMeasured : VelocitySource::kPositions;
  options.estimator.tracking = params.tracking;
  options.estimator.compensated = compensatedByRobot(setup);
  options.estimator.friction_band = jointNumbers("friction_band", params.friction_band, joints, {});
  options.estimator.longest_period = params.longest_period;
  options.wrench.noise = jointNumbers("noise", params.noise, joints);
  options.wrench.force = params.expected.force;
  options.wrench.torque = params.expected.torque;
  options.thresholds = jointNumbers("contact.thresholds", params.contact.thresholds, joints, {});
  options.release = {params.contact.release_share, params.contact.release_time};
  return options;
}

}  // namespace

/// All that a configuration makes, at once or not at all.
struct ExternalWrenchBroadcaster::Configured {
  Configured(const Setup& setup, const Parameters& params)
      : interfaces(setup.arm.joints),
        state(setup.arm.solver->jointCount()),
        effort(Eigen::VectorXd::Zero(state.q.size())),
        sensing(setup.arm.solver, optionsOf(setup, params)),
        tolerated(setup.parameters.tolerated_fault_time),
        tolerated_at_start(std::max(tolerated, params.start_time)),
        report(std::make_shared<WrenchReport>(state.q.size())),
        timer(logEverySecond(setup.node, report)),
        carried(setup),
        publisher(setup.node, setup.arm.joints, frameOf(setup, params),
                  setup.parameters.state_publish_rate, sensing.detector() != nullptr) {}

  void start(const StateInterfaces& states) {
    interfaces.bind(states, {});
    sensing.reset();
    faulty = 0.0;
    given_up = started = false;
  }

  /// Gives up once measurements or the solver have failed for too long; a gap in time is no fault.
  void noteFault(EstimateStatus status, double dt) noexcept {
    if (status == EstimateStatus::kOk) {
      faulty = 0.0;
      started = true;
    }
    const bool fault = status != EstimateStatus::kOk && status != EstimateStatus::kStarting &&
                       status != EstimateStatus::kGap;
    if (fault && dt > 0) faulty += dt;
    if (given_up || !(faulty > (started ? tolerated : tolerated_at_start))) return;
    given_up = true;
    report->noteGivenUp(status);
  }

  ArmInterfaces interfaces;
  inverse_dynamics_control::JointState state;
  Eigen::VectorXd effort;
  inverse_dynamics_control::ContactSensing sensing;
  double tolerated, tolerated_at_start, faulty = 0.0;  // s
  bool given_up = false, started = false;              // started: there has been an estimate
  std::shared_ptr<WrenchReport> report;
  rclcpp::TimerBase::SharedPtr timer;
  CarriedBody carried;
  WrenchPublisher publisher;
};

ExternalWrenchBroadcaster::ExternalWrenchBroadcaster() = default;
ExternalWrenchBroadcaster::~ExternalWrenchBroadcaster() = default;

controller_interface::InterfaceConfiguration
ExternalWrenchBroadcaster::command_interface_configuration() const {
  return nothing();
}

controller_interface::InterfaceConfiguration
ExternalWrenchBroadcaster::state_interface_configuration() const {
  return configured_ ? configured_->interfaces.states() : nothing();
}

CallbackReturn ExternalWrenchBroadcaster::on_init() {
  return transition(get_node()->get_logger(), [this] {
    arm_source_ = std::make_unique<ArmSource>(get_node(), ArmSource::Use::kMeasure);
    parameters_ = std::make_shared<external_wrench_broadcaster::ParamListener>(get_node());
  });
}

CallbackReturn ExternalWrenchBroadcaster::on_configure(const rclcpp_lifecycle::State&) {
  return transition(get_node()->get_logger(), [this] {
    const Setup setup = arm_source_->setup(robotDescriptionOf(*this), get_update_rate());
    configured_ = std::make_unique<Configured>(setup, parameters_->get_params());
    if (!kExportsStates) {
      RCLCPP_WARN(get_node()->get_logger(),
                  "this release of ros2_control has no state interfaces of controllers: the wrench "
                  "is on ~/wrench alone");
    }
  });
}

CallbackReturn ExternalWrenchBroadcaster::on_activate(const rclcpp_lifecycle::State&) {
  return transition(get_node()->get_logger(), [this] {
    requireConfigured(configured_ != nullptr);
    configured_->start(state_interfaces_);
    setStates({});
  });
}

CallbackReturn ExternalWrenchBroadcaster::on_deactivate(const rclcpp_lifecycle::State&) {
  setStates({kNan, kNan, kNan, kNan, kNan, kNan});
  return CallbackReturn::SUCCESS;
}

CallbackReturn ExternalWrenchBroadcaster::on_cleanup(const rclcpp_lifecycle::State&) {
  configured_.reset();
  return CallbackReturn::SUCCESS;
}

return_type ExternalWrenchBroadcaster::measure(const rclcpp::Time& time,
                                               const rclcpp::Duration& period) noexcept {
  if (!configured_ || configured_->given_up) return return_type::ERROR;
  Configured& c = *configured_;
  const double dt = static_cast<double>(period.nanoseconds()) * 1e-9;
  c.interfaces.read(state_interfaces_, c.state);
  c.interfaces.readEffort(state_interfaces_, c.effort);
  const EstimateStatus status = c.sensing.update(c.state, c.effort, dt);
  c.report->note(status, c.sensing.tip()->unseen());
  c.noteFault(status, dt);
  setStates(sensorWrench(c.sensing));
  if (status == EstimateStatus::kOk) c.publisher.note(time, c.sensing);
  return c.given_up ? return_type::ERROR : return_type::OK;
}

}  // namespace inverse_dynamics_controllers
