// SPDX-License-Identifier: Apache-2.0

#include "inverse_dynamics_evaluation/accelerations.hpp"

#include <utility>

#include "checks.hpp"
#include "examination.hpp"
#include "table_accelerations.hpp"
#include "zero_phase.hpp"

namespace inverse_dynamics_evaluation {
inline namespace v2 {

OwnedMatrix backwardDifference(const Eigen::Ref<const Eigen::VectorXd>& time,
                               const Eigen::Ref<const Eigen::MatrixXd>& qd) {
  requireSamples("backward difference", "qd", qd, 1);
  requireStampPerSample("backward difference", time, qd);
  requireFiniteStamps("backward difference", time);
  requireFinite("backward difference", "qd", qd);
  OwnedMatrix qdd(qd.rows(), qd.cols());
  backwardDifference(time, qd, qdd);
  return qdd;
}

OwnedMatrix lowPassDerivative(const Eigen::Ref<const Eigen::MatrixXd>& samples,
                              double sampling_frequency, double cutoff, int order) {
  requireSamples("low-pass derivative", "samples", samples, 3 * (order + 1) + 1);
  requireFinite("low-pass derivative", "samples", samples);
  requireFilter(sampling_frequency, cutoff, order);
  const DerivativeRoom room(samples.cols(), sampling_frequency, cutoff, order);
  Eigen::MatrixXd columns(samples.rows(), room.size());
  columns.middleCols(room.begin(), samples.cols()) = samples;
  return room.differentiate(columns);
}

AccelerationEstimate lowPassAccelerations(const Eigen::Ref<const Eigen::VectorXd>& time,
                                          const Eigen::Ref<const Eigen::MatrixXd>& q,
                                          const Eigen::Ref<const Eigen::MatrixXd>& qd,
                                          const Eigen::Ref<const Eigen::MatrixXd>& effort,
                                          const LowPassOptions& options) {
  checkSamples(time, q, qd, effort);
  const auto table = tableOf(time, q, qd, effort);
  LogAccelerations found = findAccelerations(
      *table, {AccelerationMethod::kLowPass, options.cutoff, options.order, options.rules});
  addSeries(*table, found.samples);
  return {table->qdd, std::move(found.filter), std::move(found.samples)};
}

}  // namespace v2
}  // namespace inverse_dynamics_evaluation
