// SPDX-License-Identifier: Apache-2.0

/// @file
/// Torques of live joint states: the computations of the live node, without topics.

#pragma once

#include <Eigen/Core>
#include <chain_dynamics/friction_state.hpp>
#include <cstddef>
#include <cstdint>
#include <inverse_dynamics_evaluation/effort.hpp>
#include <inverse_dynamics_evaluation/joint_matching.hpp>
#include <inverse_dynamics_evaluation/online_derivative.hpp>
#include <inverse_dynamics_solver/inverse_dynamics_solver.hpp>
#include <memory>
#include <sensor_msgs/msg/joint_state.hpp>
#include <string>
#include <vector>

namespace inverse_dynamics_ros {

/// Joint names, meaning of efforts and filter of LiveTorques.
struct LiveOptions {
  std::vector<std::string> joints;             ///< names in messages, in the order of the chain
  inverse_dynamics_evaluation::Effort effort;  ///< what they mean; not `auto`
  double cutoff = 5.0;                         ///< Hz; see online_derivative.hpp
  double longest_gap = 0.5;                    ///< s
};

/// From one joint state after the other to computed torques and residuals.
///
/// Real time: process() allocates nothing, takes no lock, throws nothing, if the names in the
/// messages stay the same and the solver keeps its promise.
class LiveTorques {
 public:
  /// Outcome of a message.
  enum class Outcome {
    kComputed,      ///< computed() is new; residual(), too, if hasResidual()
    kSettling,      ///< the filter hasn't settled yet: accelerations would be wrong
    kOtherJoints,   ///< none of the joints: a gripper's, for one
    kMissing,       ///< some joints aren't there, or more than once: see culprits()
    kNoVelocities,  ///< positions or velocities are absent, or not one per name
    kNotFinite,     ///< a position or velocity isn't a finite number: left out
    kRepeated,      ///< the stamp is that of the message before: left out
  };

  LiveTorques(std::shared_ptr<const inverse_dynamics_solver::InverseDynamicsSolver> solver,
              LiveOptions options);

  /// Takes a message. @param stamp  ns; the time of its sample.
  Outcome process(const sensor_msgs::msg::JointState& message, std::int64_t stamp);

  const inverse_dynamics_solver::InverseDynamicsSolver& solver() const { return *solver_; }

  /// n; N m (prismatic N), in the order of the chain, with what friction remembers. Without gravity where
  /// the efforts are.
  const Eigen::VectorXd& computed() const { return computed_; }

  /// n; measured - computed torques; N m (prismatic N).
  const Eigen::VectorXd& residual() const { return residual_; }

  /// Whether the message had finite efforts, one per name.
  bool hasResidual() const { return has_residual_; }

  /// n; measured torques of the message; N m (prismatic N). NaN where there is no effort per name.
  const Eigen::VectorXd& measured() const { return measured_; }

  /// n; rad, rad/s (prismatic m, m/s): the state of the message, unless it was one of kOtherJoints,
  /// kMissing or kNoVelocities. That of computed(), after kComputed.
  const Eigen::VectorXd& position() const { return q_; }
  const Eigen::VectorXd& velocity() const { return qd_; }

  /// Joints that were missing or repeated, after kMissing.
  const std::vector<std::string>& culprits() const { return matching_.culprits(); }

  /// What the latest sample did to the filter.
  inverse_dynamics_evaluation::OnlineDerivative::Step step() const { return step_; }

  /// By how much accelerations come late [s].
  double delay() const { return accelerations_.delay(); }

 private:
  bool pick(const std::vector<double>& numbers, std::size_t names, Eigen::VectorXd& picked) const;
  void pickMeasured(const sensor_msgs::msg::JointState& message);

  std::shared_ptr<const inverse_dynamics_solver::InverseDynamicsSolver> solver_;
  bool without_gravity_;         // efforts
  Eigen::VectorXd drive_gains_;  // n; N m/A (prismatic N/A); ones where efforts aren't currents
  inverse_dynamics_evaluation::JointMatching matching_;
  inverse_dynamics_evaluation::OnlineDerivative accelerations_;
  inverse_dynamics_evaluation::OnlineDerivative::Step step_ =
      inverse_dynamics_evaluation::OnlineDerivative::Step::kStarted;
  chain_dynamics::FrictionState friction_;  // of the motion since the filter last restarted
  Eigen::VectorXd q_, qd_, measured_, gravity_, computed_, residual_;
  bool has_residual_ = false;
};

}  // namespace inverse_dynamics_ros
