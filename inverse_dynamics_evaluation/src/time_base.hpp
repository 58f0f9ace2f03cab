// SPDX-License-Identifier: Apache-2.0

/// @file
/// When samples were taken: rule 3 of samples.hpp, and what gaps are.

#pragma once

#include <Eigen/Core>
#include <vector>

#include "inverse_dynamics_evaluation/samples.hpp"

namespace inverse_dynamics_evaluation {
inline namespace v2 {

/// Some of the samples, and when they were taken.
struct TimedSamples {
  std::vector<Eigen::Index> sample;  ///< increasing
  std::vector<double> time;          ///< s; increasing
};

/// What is longer than this is a gap [s]: `longest_gap`, or 20 sampling periods if that is more.
double gapFrom(double longest_gap, double period);

/// Mean distance in time [s], gaps aside.
double meanPeriod(const std::vector<double>& time, double longest_gap);

/// The fresh samples under a time base; for the stamps, those that increase.
TimedSamples timedSamples(TimeBase base, const Eigen::Ref<const Eigen::VectorXd>& time,
                          const Mask& left_out, const Mask& non_increasing);

/// Which time base q and qd agree with; writes what they say.
///
/// @param bases  timedSamples() of each TimeBase, in its order.
TimeBase chooseTimeBase(const std::vector<TimedSamples>& bases,
                        const Eigen::Ref<const Eigen::MatrixXd>& q,
                        const Eigen::Ref<const Eigen::MatrixXd>& qd, double longest_gap,
                        SampleReport& report);

/// An instant for every sample [s]: a repeat has that of the sample it repeats; one left out for
/// its stamp lies between its neighbours in the recording.
Eigen::VectorXd timeOfAll(const TimedSamples& used, const Mask& repeated);

}  // namespace v2
}  // namespace inverse_dynamics_evaluation
