// SPDX-License-Identifier: Apache-2.0

/// @file
/// The body at the tip, estimated from live joint states, without topics.

#pragma once

#include <Eigen/Core>
#include <chain_dynamics/chain.hpp>
#include <cstdint>
#include <inverse_dynamics_evaluation/online_derivative.hpp>
#include <inverse_dynamics_identification/payload_estimator.hpp>
#include <inverse_dynamics_solver/inverse_dynamics_solver.hpp>
#include <memory>
#include <vector>

namespace inverse_dynamics_ros {

/// Options of LivePayload.
struct LivePayloadOptions {
  double cutoff = 5.0;                         ///< Hz; see online_derivative.hpp
  double longest_gap = 0.5;                    ///< s
  Eigen::VectorXd noise;                       ///< n; N m: of efforts and the arm's model
  inverse_dynamics_solver::RigidBody carried;  ///< what the solver carries of the estimate already
  bool without_gravity = false;                ///< efforts lack what the solver takes for gravity
};

/// Estimates the body at the tip. Positions, velocities and efforts all pass through the filter of
/// the accelerations, so that each is as late as the others.
///
/// Real time: update() allocates nothing, takes no lock, throws nothing, if the solver keeps its
/// promise.
class LivePayload {
 public:
  /// @throws inverse_dynamics_solver::Exception: a solver without kinematics, options out of range.
  LivePayload(const std::shared_ptr<const inverse_dynamics_solver::InverseDynamicsSolver>& solver,
              const LivePayloadOptions& options);

  /// Takes a sample; what isn't finite is left out. A clock that goes back begins again.
  ///
  /// @param stamp   ns. @param effort  n; N m (prismatic N).
  void update(std::int64_t stamp, const Eigen::VectorXd& q, const Eigen::VectorXd& qd,
              const Eigen::VectorXd& effort);

  /// The body of all samples so far.
  inverse_dynamics_identification::PayloadStatus estimate(
      inverse_dynamics_identification::PayloadEstimate& found) {
    return estimator_.estimate(found);
  }

 private:
  std::shared_ptr<const inverse_dynamics_solver::InverseDynamicsSolver> solver_;
  Eigen::Index n_;
  std::vector<chain_dynamics::JointType> types_;
  bool without_gravity_;
  inverse_dynamics_identification::PayloadEstimator estimator_;
  inverse_dynamics_evaluation::OnlineDerivative filter_;  // of q, qd, effort
  Eigen::VectorXd samples_;                               // 3 n
  Eigen::VectorXd gravity_;                               // n
};

}  // namespace inverse_dynamics_ros
