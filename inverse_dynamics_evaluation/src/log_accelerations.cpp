// SPDX-License-Identifier: Apache-2.0

#include "inverse_dynamics_evaluation/log_accelerations.hpp"

#include <utility>

#include "figures.hpp"
#include "inverse_dynamics_evaluation/accelerations.hpp"
#include "inverse_dynamics_evaluation/error.hpp"

namespace inverse_dynamics_evaluation {
inline namespace v2 {
namespace {

using Eigen::Index;

constexpr double kMostlyAtRest = 0.5;  // share of motion below which the rest is reported

std::string seconds(std::int64_t stamp) {
  return formatted("%.9f", static_cast<double>(stamp) * 1e-9) + " s";
}

// The first of the samples whose stamps don't increase, and the latest stamp before it.
std::string firstBackwardStamp(const JointLogView::StampsBlock& stamps,
                               const SampleReport& samples) {
  Index first = 0;
  while (!samples.non_increasing[first]) {
    ++first;
  }
  return "sample " + std::to_string(first + 1) + " at " + seconds(stamps[first]) + " after " +
         seconds(stamps.head(first).maxCoeff());
}

// How many gaps there are, and the longest.
std::string gapFinding(const JointLogView::StampsBlock& stamps, const SampleReport& samples,
                       bool filtered) {
  Index behind = samples.gaps.front();
  const auto length = [&](Index k) { return samples.time[k] - samples.time[k - 1]; };
  for (const Index k : samples.gaps) {
    behind = length(k) > length(behind) ? k : behind;
  }
  const std::string count = std::to_string(samples.gaps.size());
  return count + (samples.gaps.size() == 1 ? " gap" : " gaps") +
         " in the recording: no sample for " + formatted("%.3g", length(behind)) +
         " s after sample " + std::to_string(behind) + " at " + seconds(stamps[behind - 1]) +
         (samples.gaps.size() == 1 ? "" : " (the longest)") +
         (filtered ? "; each side is filtered by itself" : "");
}

// What the data couldn't tell about the cut-off.
void addFilterFindings(const FilterChoice& filter, std::vector<std::string>& found) {
  if (!filter.chosen) {
    return;
  }
  const CutoffChoice& choice = filter.choice;
  if (choice.moving < kMostlyAtRest) {
    found.push_back("the arm rests for " + formatted("%.3g", 100.0 * (1.0 - choice.moving)) +
                    " % of the time: the cut-off was chosen from the motion alone");
  }
  if (choice.cutoff <= choice.lowest) {
    found.push_back("the chosen cut-off, " + formatted("%.3g", choice.cutoff) +
                    " Hz, is the lowest possible: the data don't tell motion from noise");
  } else if (choice.cutoff >= choice.highest) {
    found.push_back("the chosen cut-off, " + formatted("%.3g", choice.cutoff) +
                    " Hz, is the highest possible: the data don't tell noise from motion");
  }
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
       {AccelerationMethod::kAuto, AccelerationMethod::kLowPass, AccelerationMethod::kGiven,
        AccelerationMethod::kBackwardDifference}) {
    if (name(method) == text) {
      return method;
    }
    names.push_back(name(method));
  }
  throw EvaluationError("accelerations: expected one of " + listed(names) + ", got '" + text + "'");
}

std::vector<std::string> sampleFindings(const JointLogView::StampsBlock& stamps,
                                        const std::string& clock, const SampleReport& samples,
                                        const FilterChoice* filter) {
  const std::string of_all = " of " + std::to_string(stamps.size()) + " samples ";
  const std::string left_out = filter != nullptr ? " (left out of the differentiation)" : "";
  std::vector<std::string> found;
  if (const Index count = samples.repeated.count(); count > 0) {
    found.push_back(std::to_string(count) + of_all + "repeat the one before" + left_out);
  }
  if (const Index count = samples.non_increasing.count(); count > 0) {
    found.push_back(std::to_string(count) + of_all + "have an equal or backward " + clock +
                    " stamp" + left_out + ": the first is " + firstBackwardStamp(stamps, samples));
  }
  if (filter != nullptr && samples.time_base != TimeBase::kStamps) {
    found.emplace_back(
        "positions and velocities contradict the stamps: samples taken at equal distances "
        "fit them better");
  }
  if (!samples.gaps.empty()) {
    found.push_back(gapFinding(stamps, samples, filter != nullptr));
  }
  if (const Index count = samples.isolated.count(); count > 0) {
    found.push_back(std::to_string(count) + of_all +
                    "lie between gaps, in pieces too short to be filtered");
  }
  if (const Index count = samples.start_transient.count(); count > 0) {
    found.push_back("the first " + std::to_string(count) + of_all +
                    "are a start transient: efforts jump");
  }
  if (filter != nullptr) {
    addFilterFindings(*filter, found);
  }
  return found;
}

std::string accelerationSummary(AccelerationMethod method, double cutoff, bool chosen) {
  if (method == AccelerationMethod::kGiven) {
    return "given by the recording";
  }
  if (method != AccelerationMethod::kLowPass) {
    return name(method) + ", no filter";
  }
  return "zero-phase low-pass, cut-off " + formatted("%.3g", cutoff) + " Hz (" +
         (chosen ? "chosen from the data" : "given") + "), then derivative";
}

LogAccelerations logAccelerations(const JointLogView& log, AccelerationMethod method, double cutoff,
                                  const SampleRules& rules) {
  LogAccelerations result;
  result.method = method;
  if (method == AccelerationMethod::kAuto) {
    result.method = log.qdd.size() > 0 && cutoff == 0 ? AccelerationMethod::kGiven
                                                      : AccelerationMethod::kLowPass;
  }
  const bool filtered = result.method == AccelerationMethod::kLowPass;
  if (!filtered && cutoff != 0) {
    throw EvaluationError("accelerations: " + name(result.method) + " has no cut-off, got " +
                          formatted("%g", cutoff) + " Hz; use low-pass");
  }
  const Eigen::VectorXd time = log.time();
  if (filtered) {
    AccelerationEstimate estimate = lowPassAccelerations(time, log.q, log.qd, log.effort,
                                                         {cutoff, LowPassOptions().order, rules});
    result.qdd = std::move(estimate.qdd);
    result.samples = std::move(estimate.samples);
    result.filter = std::move(estimate.filter);
  } else if (result.method == AccelerationMethod::kGiven && log.qdd.size() == 0) {
    throw EvaluationError(
        "accelerations: the recording gives none; expected another method, such as auto");
  } else {
    result.samples = examineSamples(time, log.q, log.qd, log.effort, rules);
    if (result.method == AccelerationMethod::kGiven) {
      result.qdd = log.qdd;
    } else {
      result.qdd = backwardDifference(time, log.qd);
    }
  }
  result.summary = accelerationSummary(result.method, result.filter.cutoff, result.filter.chosen);
  result.findings = sampleFindings(log.stamps, name(log.clock), result.samples,
                                   filtered ? &result.filter : nullptr);
  return result;
}

}  // namespace v2
}  // namespace inverse_dynamics_evaluation
