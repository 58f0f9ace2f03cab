// SPDX-License-Identifier: Apache-2.0
/// @file
/// Whether something touches the robot.
///
///     ContactDetector detector(thresholds.torques, {}, solver->jointNames());
///     if (detector.update(observer.torques(), period)) stop.begin(reference.q, reference.qd);
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "inverse_dynamics_control/signals.hpp"

namespace inverse_dynamics_control {
inline namespace v2 {

/// When a contact is over.
struct ReleaseOptions {
  double share = 0.5;  ///< torques below this share of their greatest ones, > 0, <= 1 ...
  double time = 0.1;   ///< ... for so long; finite, >= 0; s
};

/// Compares external torques with thresholds. Not thread-safe.
///
/// A contact begins at once, and is over when all torques that were beyond their thresholds have been
/// well below the greatest that they had in it for a while. What they are then, friction of a joint at
/// rest or a load, is held: torques between zero and it are no contact, and others count by what lies
/// beyond. What is held falls with the torque, `share` of a threshold behind, so that noise doesn't
/// take it down.
///
/// Real time: all methods but the constructor: no allocation, lock, exception or system call.
class ContactDetector {
 public:
  /// @param thresholds   n, > 0, infinity for a joint that is ignored; N m (prismatic N);
  ///                     ContactThresholds::torques.
  /// @param joint_names  n, for the text of errors.
  /// Throws inverse_dynamics_solver::InvalidParameterValueException: wrong size or value.
  ContactDetector(const Eigen::Ref<const Eigen::VectorXd>& thresholds,
                  const ReleaseOptions& release, const std::vector<std::string>& joint_names);

  /// Takes external torques.
  ///
  /// @param torques  n; N m (prismatic N). What isn't finite or of another size counts as contact.
  /// @param period   s since the last call; a non-positive one doesn't count as time.
  /// @return contact().
  bool update(const Eigen::Ref<const Eigen::VectorXd>& torques, double period) noexcept;

  /// Whether something touches the robot.
  bool contact() const noexcept { return contact_; }

  /// The joint whose torque was the greatest of its threshold when the contact began; -1: none yet,
  /// or a wrong size.
  Eigen::Index joint() const noexcept { return joint_; }

  /// Greatest torque by threshold of the last update.
  double excess() const noexcept { return excess_; }

  /// No contact.
  void reset() noexcept;

 private:
  double stillHeld(double held, double part) const noexcept;

  OwnedVector thresholds_;
  ReleaseOptions release_;
  bool contact_ = false;
  Eigen::Index joint_ = -1;
  double excess_ = 0.0, below_ = 0.0;  // time below the share [s]
  OwnedVector held_, greatest_;        // in thresholds; left by contacts; most in the present one
};

}  // namespace v2
}  // namespace inverse_dynamics_control
