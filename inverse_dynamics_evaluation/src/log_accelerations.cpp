// SPDX-License-Identifier: Apache-2.0

#include "inverse_dynamics_evaluation/log_accelerations.hpp"

#include <cstdio>
#include <utility>

#include "inverse_dynamics_evaluation/accelerations.hpp"
#include "inverse_dynamics_evaluation/error.hpp"

namespace inverse_dynamics_evaluation {
inline namespace v2 {
namespace {

using Eigen::Index;

// A number as `format` writes it.
std::string formatted(const char* format, double number) {
  char text[64];
  std::snprintf(text, sizeof text, format, number);
  return text;
}

std::string summaryOf(const FilterChoice& filter) {
  return "zero-phase low-pass, cut-off " + formatted("%.3g", filter.cutoff) + " Hz (" +
         (filter.chosen ? "chosen from the data" : "given") + "), then derivative";
}

// The first of the samples whose stamps don't increase, and the latest stamp before it.
std::string firstBackwardStamp(const JointLog& log, const SampleReport& samples) {
  Index first = 0;
  while (!samples.non_increasing[first]) {
    ++first;
  }
  const Stamps& stamps = log.stamps();
  const auto seconds = [](std::int64_t stamp) {
    return formatted("%.9f", static_cast<double>(stamp) * 1e-9) + " s";
  };
  return "sample " + std::to_string(first + 1) + " at " + seconds(stamps[first]) + " after " +
         seconds(stamps.head(first).maxCoeff());
}

std::vector<std::string> findingsOf(const JointLog& log, const SampleReport& samples,
                                    bool filtered) {
  const std::string of_all = " of " + std::to_string(log.q.cols()) + " samples ";
  const std::string left_out = filtered ? " (left out of the differentiation)" : "";
  std::vector<std::string> said;
  if (const Index count = samples.repeated.count(); count > 0) {
    said.push_back(std::to_string(count) + of_all + "repeat the one before" + left_out);
  }
  if (const Index count = samples.non_increasing.count(); count > 0) {
    said.push_back(std::to_string(count) + of_all + "have an equal or backward " + name(log.clock) +
                   " stamp" + left_out + ": the first is " + firstBackwardStamp(log, samples));
  }
  if (filtered && samples.time_base != TimeBase::kStamps) {
    said.emplace_back(
        "positions and velocities contradict the stamps: samples taken at equal distances "
        "fit them better");
  }
  if (const Index count = samples.isolated.count(); count > 0) {
    said.push_back(std::to_string(count) + of_all +
                   "lie between gaps, in pieces too short to be filtered");
  }
  if (const Index count = samples.start_transient.count(); count > 0) {
    said.push_back("the first " + std::to_string(count) + of_all +
                   "are a start transient: efforts jump");
  }
  return said;
}

}  // namespace

std::string name(AccelerationMethod method) {
  switch (method) {
    case AccelerationMethod::kAuto:
      return "auto";
    case AccelerationMethod::kLowPass:
      return "low-pass";
    case AccelerationMethod::kBackwardDifference:
      return "backward-difference";
    case AccelerationMethod::kGiven:
      return "given";
  }
  return "unknown";
}

AccelerationMethod accelerationMethod(const std::string& text) {
  std::vector<std::string> names;
  for (const AccelerationMethod method :
       {AccelerationMethod::kAuto, AccelerationMethod::kLowPass,
        AccelerationMethod::kBackwardDifference, AccelerationMethod::kGiven}) {
    if (name(method) == text) {
      return method;
    }
    names.push_back(name(method));
  }
  throw EvaluationError("accelerations", "method", "one of " + listed(names), "'" + text + "'",
                        "auto is right for most recordings");
}

LogAccelerations logAccelerations(const JointLog& log, AccelerationMethod method, double cutoff,
                                  const SampleRules& rules) {
  if (method == AccelerationMethod::kAuto) {
    method = log.qdd.size() > 0 && cutoff == 0 ? AccelerationMethod::kGiven
                                               : AccelerationMethod::kLowPass;
  }
  const bool filtered = method == AccelerationMethod::kLowPass;
  if (!filtered && cutoff != 0) {
    throw EvaluationError("accelerations", "cut-off", "none, as " + name(method) + " has none",
                          formatted("%g", cutoff) + " Hz", "use low-pass");
  }
  const Eigen::VectorXd time = log.time();
  LogAccelerations result;
  if (filtered) {
    AccelerationEstimate estimate = lowPassAccelerations(time, log.q, log.qd, log.effort,
                                                         {cutoff, LowPassOptions().order, rules});
    result.qdd = std::move(estimate.qdd);
    result.samples = std::move(estimate.samples);
    result.summary = summaryOf(estimate.filter);
  } else if (method == AccelerationMethod::kGiven) {
    if (log.qdd.size() == 0) {
      throw EvaluationError("accelerations", "recorded ones", "some", "none",
                            "use another method, such as auto");
    }
    result.samples = examineSamples(time, log.q, log.qd, log.effort, rules);
    result.qdd = log.qdd;
    result.summary = "given by the recording";
  } else {
    result.samples = examineSamples(time, log.q, log.qd, log.effort, rules);
    result.qdd = backwardDifference(time, log.qd);
    result.summary = name(method) + ", no filter";
  }
  result.findings = findingsOf(log, result.samples, filtered);
  return result;
}

}  // namespace v2
}  // namespace inverse_dynamics_evaluation
