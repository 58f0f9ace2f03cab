// SPDX-License-Identifier: Apache-2.0

/// @file
/// Recorded samples that tests change.
///
///     JointLog log;
///     log.q = log.qd = log.effort = Eigen::MatrixXd::Ones(2, 100);
///     log.header_stamps = log.receive_stamps = Stamps::LinSpaced(100, 0, 99);
///     evaluate(log, solver, options);

#pragma once

#include <cstdint>
#include <memory>

#include "filtering.hpp"
#include "inverse_dynamics_evaluation/sample_table.hpp"

namespace inverse_dynamics_evaluation {

using Stamps = Eigen::Matrix<std::int64_t, Eigen::Dynamic, 1>;

struct JointLog {
  Stamps header_stamps, receive_stamps;  ///< N; ns
  Eigen::MatrixXd q, qd, effort, qdd;    ///< n x N, or empty
  Clock clock = Clock::kHeader;

  operator RecordedColumns() const {  // NOLINT(google-explicit-constructor)
    return {header_stamps, receive_stamps, clock, q, qd, effort, qdd};
  }
  /// N; s since the first sample.
  Eigen::VectorXd time() const {
    return 1e-9 * (header_stamps.array() - header_stamps[0]).cast<double>();
  }
};

/// Accelerations, and how they came about.
struct LogAccelerations : AccelerationReport {
  Eigen::MatrixXd qdd;
};

inline LogAccelerations accelerationsOf(SampleTable& table, AccelerationMethod method,
                                        const LowPassOptions& options) {
  LogAccelerations found{findAccelerations(table, method, options), {}};
  found.qdd = table.qdd;
  return found;
}

inline LogAccelerations logAccelerations(const JointLog& log,
                                         AccelerationMethod method = AccelerationMethod::kAuto,
                                         double cutoff = 0) {
  LowPassOptions options;
  options.cutoff = cutoff;
  return accelerationsOf(*tableOf(log), method, options);
}

}  // namespace inverse_dynamics_evaluation
