// SPDX-License-Identifier: Apache-2.0

/// @file
/// Contacts of the robot from live joint states: the computations of the live node, without topics.

#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <inverse_dynamics_control/contact_sensing.hpp>
#include <inverse_dynamics_solver/external_wrench.hpp>
#include <inverse_dynamics_solver/inverse_dynamics_solver.hpp>
#include <memory>

namespace inverse_dynamics_ros {

/// Options of LiveContact.
struct LiveContactOptions : inverse_dynamics_control::ContactOptions {
  inverse_dynamics_solver::WrenchFrame wrench_frame = inverse_dynamics_solver::WrenchFrame::kTip;
};

/// From one sample after the other to external torques, which the robot exerts on its surroundings
/// [docs/contact.md], the wrench at the tip, which the surroundings exert on it, and contacts.
///
/// Without an estimate (see EstimateStatus) nothing is known: a contact neither begins nor ends.
/// Real time: update() allocates nothing, takes no lock, throws nothing, if the solver keeps its
/// promise.
class LiveContact {
 public:
  using Status = inverse_dynamics_control::EstimateStatus;
  using Counts = std::array<std::int64_t, 8>;  ///< by Status

  /// @throws inverse_dynamics_solver::Exception: options that ContactSensing refuses.
  LiveContact(const std::shared_ptr<const inverse_dynamics_solver::InverseDynamicsSolver>& solver,
              const LiveContactOptions& options);

  /// Takes a sample; one with the stamp of the last one is left out.
  ///
  /// @param stamp   ns. One that is earlier than the last begins again, without a contact.
  /// @param effort  n; N m (prismatic N); what isn't finite is a reset.
  /// @return whether there is a new estimate.
  bool update(std::int64_t stamp, const Eigen::VectorXd& q, const Eigen::VectorXd& qd,
              const Eigen::VectorXd& effort);

  /// Of the last sample.
  Status status() const { return status_; }

  /// How often each happened.
  const Counts& counts() const { return counts_; }

  /// n; N m (prismatic N).
  const chain_dynamics::OwnedVector& torques() const { return sensing_.torques(); }

  /// Whether there is a wrench of the last estimate.
  bool hasWrench() const { return tip() != nullptr && status_ == Status::kOk; }

  /// N, N m about the origin of LiveContactOptions::wrench_frame, in its axes: what the surroundings exert,
  /// as a force-torque sensor's.
  const Eigen::Vector3d& force() const { return force_; }
  const Eigen::Vector3d& torque() const { return torque_; }

  /// Null: no wrench.
  const inverse_dynamics_control::TipWrench* tip() const { return sensing_.tip(); }

  /// Null: no contact flag.
  const inverse_dynamics_control::ContactDetector* detector() const { return sensing_.detector(); }

 private:
  double periodOf(std::int64_t distance);
  void updateWrench();

  inverse_dynamics_control::ContactSensing sensing_;
  // Null: the wrench is in the frame of the tip.
  std::shared_ptr<const inverse_dynamics_solver::InverseDynamicsSolver> in_root_;
  Eigen::Vector3d force_, torque_;
  inverse_dynamics_control::JointState state_;
  Eigen::VectorXd effort_, mean_effort_;  // of the last sample; over the period before it
  bool started_ = false;
  std::int64_t stamp_ = 0;                    // ns; of the last sample
  std::array<std::int64_t, 16> distances_{};  // ns; the latest ones between stamps
  std::size_t distance_count_ = 0;            // of all
  Status status_ = Status::kStarting;
  Counts counts_{};
};

}  // namespace inverse_dynamics_ros
