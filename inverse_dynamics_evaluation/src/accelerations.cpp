// SPDX-License-Identifier: Apache-2.0

#include "inverse_dynamics_evaluation/accelerations.hpp"

#include <algorithm>
#include <utility>

#include "accelerated_samples.hpp"
#include "checks.hpp"
#include "low_pass_differentiator.hpp"

namespace inverse_dynamics_evaluation {
inline namespace v2 {

using Eigen::Index;

OwnedMatrix backwardDifference(const Eigen::Ref<const Eigen::VectorXd>& time,
                               const Eigen::Ref<const Eigen::MatrixXd>& qd) {
  requireSamples("backward difference", "qd", qd, 1);
  requireStampPerSample("backward difference", time, qd);
  requireFiniteStamps("backward difference", time);
  requireFinite("backward difference", "qd", qd);
  Eigen::MatrixXd qdd = Eigen::MatrixXd::Zero(qd.rows(), qd.cols());
  for (Index k = 1; k < qd.cols(); ++k) {
    const double dt = time[k] - time[k - 1];
    if (dt > 0.0) {
      qdd.col(k) = (qd.col(k) - qd.col(k - 1)) / dt;
    }
  }
  return qdd;
}

OwnedMatrix lowPassDerivative(const Eigen::Ref<const Eigen::MatrixXd>& samples,
                              double sampling_frequency, double cutoff, int order) {
  requireSamples("low-pass derivative", "samples", samples, 3 * (order + 1) + 1);
  requireFinite("low-pass derivative", "samples", samples);
  requireFilter(sampling_frequency, cutoff, order);
  OwnedMatrix result(samples.rows(), samples.cols());
  Index given = 0;
  LowPassDifferentiator differentiator(samples.rows(), samples.cols(), sampling_frequency, cutoff,
                                       order, [&](const auto& derivatives) {
                                         result.middleCols(given, derivatives.cols()) = derivatives;
                                         given += derivatives.cols();
                                       });
  differentiator.push(samples);
  differentiator.finish();
  return result;
}

AccelerationEstimate lowPassAccelerations(const Eigen::Ref<const Eigen::VectorXd>& time,
                                          const Eigen::Ref<const Eigen::MatrixXd>& q,
                                          const Eigen::Ref<const Eigen::MatrixXd>& qd,
                                          const Eigen::Ref<const Eigen::MatrixXd>& effort,
                                          const LowPassOptions& options) {
  checkSamples(time, q, qd, effort);
  const JointLogView view = withoutStamps(q, qd, effort);
  SamplesInMemory stream(view, time);
  AccelerationPlan plan = planAccelerations(
      stream, {AccelerationMethod::kLowPass, options.cutoff, options.order, options.rules});
  AccelerationEstimate estimate;
  estimate.qdd = gatherAccelerations(stream, plan);
  estimate.filter = std::move(plan.filter);
  estimate.samples = std::move(plan.found.report);
  return estimate;
}

}  // namespace v2
}  // namespace inverse_dynamics_evaluation
