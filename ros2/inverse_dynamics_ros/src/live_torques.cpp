// SPDX-License-Identifier: Apache-2.0

#include "live_torques.hpp"

#include <cstddef>
#include <cstdint>
#include <inverse_dynamics_evaluation/effort.hpp>
#include <inverse_dynamics_evaluation/joint_matching.hpp>
#include <inverse_dynamics_evaluation/online_derivative.hpp>
#include <inverse_dynamics_solver/friction_memory.hpp>
#include <inverse_dynamics_solver/inverse_dynamics_solver.hpp>
#include <limits>
#include <memory>
#include <sensor_msgs/msg/joint_state.hpp>
#include <utility>
#include <vector>

namespace inverse_dynamics_ros {

using inverse_dynamics_evaluation::JointMatching;
using inverse_dynamics_evaluation::OnlineDerivative;

LiveTorques::LiveTorques(
    std::shared_ptr<const inverse_dynamics_solver::InverseDynamicsSolver> solver,
    LiveOptions options)
    : solver_(std::move(solver)),
      without_gravity_(options.effort.meaning ==
                       inverse_dynamics_evaluation::kTorqueWithoutGravity),
      drive_gains_(Eigen::VectorXd::Ones(solver_->jointCount())),
      matching_(std::move(options.joints)),
      accelerations_(solver_->jointCount(), options.cutoff, options.longest_gap),
      friction_(inverse_dynamics_solver::frictionState(*solver_)) {
  for (Eigen::VectorXd* vector : {&q_, &qd_, &measured_, &gravity_, &computed_, &residual_}) {
    vector->setZero(solver_->jointCount());
  }
  const std::vector<double>& gains = options.effort.drive_gains;
  if (!gains.empty()) {
    drive_gains_ =
        Eigen::Map<const Eigen::VectorXd>(gains.data(), static_cast<Eigen::Index>(gains.size()));
  }
}

LiveTorques::Outcome LiveTorques::process(const sensor_msgs::msg::JointState& message,
                                          std::int64_t stamp) {
  has_residual_ = false;
  const JointMatching::Found found = matching_.match(message.name);
  if (found == JointMatching::Found::kNone) return Outcome::kOtherJoints;
  if (found != JointMatching::Found::kAll) return Outcome::kMissing;
  if (!pick(message.position, message.name.size(), q_) ||
      !pick(message.velocity, message.name.size(), qd_)) {
    return Outcome::kNoVelocities;
  }
  pickMeasured(message);
  if (!q_.allFinite() || !qd_.allFinite()) return Outcome::kNotFinite;
  step_ = accelerations_.update(stamp, qd_);
  if (step_ == OnlineDerivative::Step::kRepeated) return Outcome::kRepeated;
  if (step_ != OnlineDerivative::Step::kContinued) friction_.reset();
  friction_.move(q_);
  if (!accelerations_.settled()) return Outcome::kSettling;
  solver_->getTorques(q_, qd_, accelerations_.derivative(), computed_);
  friction_.addTo(qd_, computed_);
  if (without_gravity_) {
    solver_->getGravityVector(q_, gravity_);
    computed_ -= gravity_;
  }
  has_residual_ = measured_.allFinite();
  if (has_residual_) residual_ = measured_ - computed_;
  return Outcome::kComputed;
}

// Torques of the efforts; NaN if there isn't one per name.
void LiveTorques::pickMeasured(const sensor_msgs::msg::JointState& message) {
  if (pick(message.effort, message.name.size(), measured_)) {
    measured_.array() *= drive_gains_.array();
  } else {
    measured_.setConstant(std::numeric_limits<double>::quiet_NaN());
  }
}

// The numbers of the joints; false if there isn't one per name.
bool LiveTorques::pick(const std::vector<double>& numbers, std::size_t names,
                       Eigen::VectorXd& picked) const {
  if (numbers.size() != names) return false;
  for (std::size_t j = 0; j < matching_.columns().size(); ++j) {
    picked[static_cast<Eigen::Index>(j)] = numbers[matching_.columns()[j]];
  }
  return true;
}

}  // namespace inverse_dynamics_ros
