// SPDX-License-Identifier: Apache-2.0

/// @file
/// Checks of arguments that several functions share; each throws EvaluationError.
///
///     requireSameSize("metrics", "measured", measured, "computed", computed);
///     requireFinite("metrics", "measured", measured);

#pragma once

#include <Eigen/Core>
#include <cmath>
#include <string>

#include "inverse_dynamics_evaluation/error.hpp"

namespace inverse_dynamics_evaluation {
inline namespace v2 {

/// "6 joints x 100 samples".
inline std::string sizeText(Eigen::Index joints, Eigen::Index samples) {
  return std::to_string(joints) + " joints x " + std::to_string(samples) + " samples";
}

/// Both n x N.
inline void requireSameSize(const std::string& where, const std::string& what,
                            const Eigen::Ref<const Eigen::MatrixXd>& matrix,
                            const std::string& other_name,
                            const Eigen::Ref<const Eigen::MatrixXd>& other) {
  if (matrix.rows() == other.rows() && matrix.cols() == other.cols()) return;
  throw EvaluationError(where, what, sizeText(other.rows(), other.cols()) + " as in " + other_name,
                        sizeText(matrix.rows(), matrix.cols()), "a sample is a column");
}

/// One stamp per column.
inline void requireStampPerSample(const std::string& where,
                                  const Eigen::Ref<const Eigen::VectorXd>& time,
                                  const Eigen::Ref<const Eigen::MatrixXd>& samples) {
  if (time.size() != samples.cols()) {
    throw EvaluationError(where, "time",
                          std::to_string(samples.cols()) + " stamps, one per column of the samples",
                          std::to_string(time.size()), "a sample is a column");
  }
}

/// At least `least` columns and one row.
inline void requireSamples(const std::string& where, const std::string& what,
                           const Eigen::Ref<const Eigen::MatrixXd>& samples, Eigen::Index least) {
  if (samples.cols() < least || samples.rows() < 1) {
    throw EvaluationError(where, what,
                          std::to_string(least) + " samples or more of 1 joint or more",
                          sizeText(samples.rows(), samples.cols()), "record for longer");
  }
}

/// No NaN, no infinity; joint (row) and sample (column) are named, counted from 1.
inline void requireFinite(const std::string& where, const std::string& what,
                          const Eigen::Ref<const Eigen::MatrixXd>& samples) {
  if (samples.allFinite()) return;
  for (Eigen::Index k = 0; k < samples.cols(); ++k) {
    for (Eigen::Index j = 0; j < samples.rows(); ++j) {
      if (!std::isfinite(samples(j, k))) {
        throw EvaluationError(where, what, "finite numbers",
                              std::to_string(samples(j, k)) + " for joint " +
                                  std::to_string(j + 1) + " in sample " + std::to_string(k + 1) +
                                  " (both counted from 1)",
                              "leave such samples out");
      }
    }
  }
}

/// No NaN, no infinity among the stamps.
inline void requireFiniteStamps(const std::string& where,
                                const Eigen::Ref<const Eigen::VectorXd>& time) {
  for (Eigen::Index k = 0; k < time.size(); ++k) {
    if (!std::isfinite(time[k])) {
      throw EvaluationError(
          where, "time", "finite stamps",
          std::to_string(time[k]) + " in sample " + std::to_string(k + 1) + " (counted from 1)",
          "leave such samples out");
    }
  }
}

/// Samples of some joints: n x N, finite; efforts may be missing.
inline void checkSamples(const Eigen::Ref<const Eigen::VectorXd>& time,
                         const Eigen::Ref<const Eigen::MatrixXd>& q,
                         const Eigen::Ref<const Eigen::MatrixXd>& qd,
                         const Eigen::Ref<const Eigen::MatrixXd>& effort) {
  requireSamples("samples", "qd", qd, 2);
  requireSameSize("samples", "q", q, "qd", qd);
  requireStampPerSample("samples", time, qd);
  requireFiniteStamps("samples", time);
  requireFinite("samples", "q", q);
  requireFinite("samples", "qd", qd);
  if (effort.size() > 0) {
    requireSameSize("samples", "effort", effort, "qd", qd);
    requireFinite("samples", "effort", effort);
  }
}

}  // namespace v2
}  // namespace inverse_dynamics_evaluation
