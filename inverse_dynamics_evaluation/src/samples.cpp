// SPDX-License-Identifier: Apache-2.0

#include "inverse_dynamics_evaluation/samples.hpp"

#include "checks.hpp"
#include "sample_stream.hpp"
#include "timed_samples.hpp"

namespace inverse_dynamics_evaluation {
inline namespace v2 {

std::string name(TimeBase time_base) {
  switch (time_base) {
    case TimeBase::kStamps:
      return "stamps";
    case TimeBase::kRegular:
      return "regular";
    case TimeBase::kRegularFresh:
      return "regular_fresh";
  }
  return "unknown";
}

SampleReport examineSamples(const Eigen::Ref<const Eigen::VectorXd>& time,
                            const Eigen::Ref<const Eigen::MatrixXd>& q,
                            const Eigen::Ref<const Eigen::MatrixXd>& qd,
                            const Eigen::Ref<const Eigen::MatrixXd>& effort,
                            const SampleRules& rules) {
  checkSamples(time, q, qd, effort);
  const JointLogView view = withoutStamps(q, qd, effort);
  SamplesInMemory stream(view, time);
  Examination found = examine(stream, takeCensus(stream, rules), rules);
  SampleSeries series(time.size());
  TimedSamples samples(stream, found, rules);
  TimedBlock block;
  while (samples.next(block)) {
    series.add(block);
  }
  series.moveTo(found.report);
  return std::move(found.report);
}

}  // namespace v2
}  // namespace inverse_dynamics_evaluation
