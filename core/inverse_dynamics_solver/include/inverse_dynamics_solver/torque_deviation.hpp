// SPDX-License-Identifier: Apache-2.0
/// @file
/// Capability: how far measured torques are from the model's, as far as identification could tell.
///
///     const auto* band = dynamic_cast<const TorqueDeviation*>(solver.get());
///     if (band != nullptr && band->hasTorqueDeviation()) {
///       Eigen::VectorXd d = band->getTorqueDeviation();   // tau - d .. tau + d holds 95 %
///     }
#pragma once

#include <Eigen/Core>
#include <chain_dynamics/model.hpp>
#include <vector>

#include "inverse_dynamics_solver/capability.hpp"

namespace inverse_dynamics_solver {
inline namespace v2 {

/// An identified model's statement of its own errors: numbers of its model file
/// [docs/model_file.md].
///
/// They are of the robot as it was identified, without payload, within seenRanges(). Another day,
/// temperature or robot has other friction and offsets: there the band holds fewer of the torques.
class TorqueDeviation : public Capability {
 public:
  ~TorqueDeviation() override;

  /// Whether the model states it.
  bool hasTorqueDeviation() const;

  /// Half the width of the band that holds 95 % of the differences between measured and computed
  /// torques of data that weren't used to identify, for each joint; n numbers, N m (prismatic N).
  ///
  /// @throws Exception  hasTorqueDeviation() is false.
  Eigen::VectorXd getTorqueDeviation() const {
    Eigen::VectorXd deviation(jointsFor("getTorqueDeviation"));
    getTorqueDeviation(deviation);
    return deviation;
  }
  /// Into memory of the caller, without allocation.
  void getTorqueDeviation(VectorRef deviation) const;

  /// Ranges of q, qd, qdd of the data of identification, one per joint; empty: not known.
  const std::vector<chain_dynamics::SeenRange>& seenRanges() const;

 protected:
  using Deviations = Eigen::Map<const Eigen::VectorXd>;

  /// n numbers, or none: not known. Called after a successful initialize().
  virtual Deviations torqueDeviation() const = 0;

  /// n ranges, or none: not known. Called after a successful initialize().
  virtual const std::vector<chain_dynamics::SeenRange>& seenRangesImpl() const = 0;
};

}  // namespace v2
}  // namespace inverse_dynamics_solver
