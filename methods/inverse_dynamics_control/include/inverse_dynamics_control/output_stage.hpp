// SPDX-License-Identifier: Apache-2.0
/// @file
/// The last stage before the hardware: no torque beyond a limit, none that changes too fast.
///
///     OutputStage output(limits, solver->jointNames(), "computed torque");
///     output.start(measured_effort);              // when the controller is activated
///     output.apply(desired, period, tau);          // in each cycle
#pragma once

#include <Eigen/Core>
#include <chain_dynamics/owned.hpp>
#include <string>
#include <vector>

#include "inverse_dynamics_control/signals.hpp"
#include "inverse_dynamics_control/status.hpp"

namespace inverse_dynamics_control {
inline namespace v2 {

/// Limits of the actuators.
struct OutputLimits {
  /// Greatest torque of each joint, n, > 0; N m (prismatic N); infinity: no limit. Required.
  OwnedVector effort;

  /// Greatest change of torque, n, > 0; N m/s (prismatic N/s); empty or infinity: no limit.
  OwnedVector rate;
};

/// Limits torques, and says of which joint. Remembers the last output. Not thread-safe.
///
/// Real time: all methods but the constructor: no allocation, lock, exception or system call.
class OutputStage {
 public:
  using Joints = chain_dynamics::Owned<Eigen::Array<bool, Eigen::Dynamic, 1>>;

  /// @param joint_names  n of them.
  /// @param law          whose options these are, for the text of errors.
  /// Throws inverse_dynamics_solver::InvalidParameterValueException: wrong size or value, with the
  /// joint.
  OutputStage(const OutputLimits& limits, const std::vector<std::string>& joint_names,
              const std::string& law);

  /// The next output may be anything within the effort limits.
  void start() noexcept { started_ = false; }

  /// The next output begins at the effort that acts now, n; what isn't finite or of another size is
  /// as start().
  void start(const Eigen::Ref<const Eigen::VectorXd>& effort) noexcept;

  /// The torque nearest to the desired one that the limits allow.
  ///
  /// @param desired    n, finite; N m (prismatic N).
  /// @param period    s since the last call, for the rate limit; one that isn't above zero and up
  ///                  to 1 s (a clock that stands or jumps) allows no change.
  /// @param[out] tau  n; N m (prismatic N).
  /// @return kNoPeriod, kSaturated, kRateLimited or kOk, the first that is true.
  Status apply(const Eigen::Ref<const Eigen::VectorXd>& desired, double period,
               Eigen::Ref<Eigen::VectorXd> tau) noexcept;

  /// Whether the last output of each joint was cut to its effort limit.
  const Joints& saturated() const noexcept { return saturated_; }

  /// Whether the last output of each joint was held back by its rate limit.
  const Joints& rateLimited() const noexcept { return rate_limited_; }

 private:
  OutputLimits limits_;  // both n, infinity where there is none
  OwnedVector last_;
  bool started_ = false;  // whether last_ counts
  Joints saturated_, rate_limited_;
};

}  // namespace v2
}  // namespace inverse_dynamics_control
