// SPDX-License-Identifier: Apache-2.0

// Accelerations in words.

#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "figures.hpp"
#include "filtering.hpp"
#include "inverse_dynamics_evaluation/error.hpp"
#include "inverse_dynamics_evaluation/joint_matching.hpp"

namespace inverse_dynamics_evaluation {
inline namespace v2 {
namespace {

constexpr double kMostlyAtRest = 0.5;  // share of motion below which the rest is reported

std::string seconds(std::int64_t stamp) {
  return formatted("%.9f", static_cast<double>(stamp) * 1e-9) + " s";
}

// How many gaps there are, and the longest.
std::string gapFinding(const SampleReport& samples, bool filtered) {
  const LongestGap& longest = samples.longest_gap;
  const std::string place = "no sample for " + formatted("%.3g", longest.length) +
                            " s after sample " + std::to_string(longest.behind) + " at " +
                            seconds(longest.stamp_before);
  if (samples.gaps.empty()) {
    return place + ", the longest gap" + (filtered ? ": samples around it bridge it" : "");
  }
  const std::string count = std::to_string(samples.gaps.size());
  return count + (samples.gaps.size() == 1 ? " gap" : " gaps") + " in the recording: " + place +
         (samples.gaps.size() == 1 ? "" : " (the longest)") +
         (filtered ? "; each side is filtered by itself" : "");
}

// Where the clock was set, and what follows.
std::string clockFinding(const std::vector<ClockStep>& steps) {
  const ClockStep& first = steps.front();
  const std::string more =
      steps.size() == 1 ? "" : ", the first of " + std::to_string(steps.size()) + " such steps";
  return "the clock steps " + std::string(first.by < 0 ? "back" : "forward") + " by " +
         formatted("%.3g", std::abs(first.by)) + " s before sample " +
         std::to_string(first.sample + 1) + more +
         ": times behind it are shifted, as if the clock had gone on";
}

// Limits of the choice of the cut-off.
void addFilterFindings(const FilterChoice& filter, std::vector<std::string>& found) {
  if (!filter.chosen) return;
  const CutoffChoice& choice = filter.choice;
  if (choice.moving < kMostlyAtRest) {
    found.push_back("the arm rests for " + formatted("%.3g", 100.0 * (1.0 - choice.moving)) +
                    " % of the time: the cut-off was chosen from the motion alone");
  }
  if (choice.gain > 0) {
    found.push_back("the cut-off, " + formatted("%.3g", choice.cutoff) +
                    " Hz, was chosen by the efforts: computed torques explain them " +
                    formatted("%.2g", 100.0 * choice.gain) + " % better than with " +
                    formatted("%.3g", choice.by_motion) +
                    " Hz, which positions and velocities alone suggest");
  } else if (choice.cutoff <= choice.lowest) {
    found.push_back("the chosen cut-off, " + formatted("%.3g", choice.cutoff) +
                    " Hz, is the lowest possible: the data don't distinguish motion from noise");
  } else if (choice.cutoff >= choice.highest) {
    found.push_back("the chosen cut-off, " + formatted("%.3g", choice.cutoff) +
                    " Hz, is the highest possible: the data don't distinguish noise from motion");
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
    if (name(method) == text) return method;
    names.push_back(name(method));
  }
  throw EvaluationError("accelerations: expected one of " + listed(names) + ", got '" + text + "'");
}

std::vector<std::string> sampleFindings(const std::string& clock, const SampleReport& samples,
                                        const FilterChoice* filter) {
  const SampleCounts& counts = samples.counts;
  const std::string of_all = " of " + std::to_string(counts.all) + " samples ";
  const std::string left_out = filter != nullptr ? " (left out of the differentiation)" : "";
  std::vector<std::string> found;
  const SecondSource& other = samples.second_source;
  if (counts.repeated > other.count) {
    found.push_back(std::to_string(counts.repeated - other.count) + of_all +
                    "repeat an earlier one" + left_out);
  }
  if (other.count > 0) {
    found.push_back(std::to_string(other.count) + of_all +
                    "don't belong to the motion around them, but to a second publisher or an empty "
                    "message, and are left out: the first is sample " +
                    std::to_string(other.first + 1));
  }
  if (!samples.clock_steps.empty()) found.push_back(clockFinding(samples.clock_steps));
  if (counts.non_increasing > 0) {
    const BackwardStamp& first = samples.backward;
    found.push_back(std::to_string(counts.non_increasing) + of_all + "have an equal or backward " +
                    clock + " stamp" + left_out + ": the first is sample " +
                    std::to_string(first.sample + 1) + " at " + seconds(first.stamp) + " after " +
                    seconds(first.latest));
  }
  if (filter != nullptr && samples.time_base != TimeBase::kStamps) {
    found.emplace_back(
        "positions and velocities contradict the stamps: samples taken at equal distances "
        "fit them better");
  }
  if (samples.longest_gap.behind > 0) found.push_back(gapFinding(samples, filter != nullptr));
  if (counts.isolated > 0) {
    found.push_back(std::to_string(counts.isolated) + of_all +
                    "lie between gaps, in pieces too short to be filtered");
  }
  if (counts.start_transient > 0) {
    found.push_back("the first " + std::to_string(counts.start_transient) + of_all +
                    "are a start transient: efforts jump");
  }
  if (const LoneSample& lone = samples.lone; lone.sample > 0) {
    found.push_back(
        "sample " + std::to_string(lone.sample + 1) + " at " + seconds(lone.stamp) +
        ": position or velocity of joint " + std::to_string(lone.joint + 1) +
        " of the chain jumps and returns, further than all other samples together: if it "
        "is wrong, leave it out, or give a cut-off");
  }
  if (filter != nullptr) addFilterFindings(*filter, found);
  return found;
}

std::string accelerationSummary(AccelerationMethod method, double cutoff, bool chosen) {
  if (method == AccelerationMethod::kGiven) return "given by the recording";
  if (method != AccelerationMethod::kLowPass) return name(method) + ", no filter";
  return "zero-phase low-pass, cut-off " + formatted("%.3g", cutoff) + " Hz (" +
         (chosen ? "chosen from the data" : "given") + "), then derivative";
}

}  // namespace v2
}  // namespace inverse_dynamics_evaluation
