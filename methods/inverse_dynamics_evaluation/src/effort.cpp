// SPDX-License-Identifier: Apache-2.0

#include "inverse_dynamics_evaluation/effort.hpp"

#include <algorithm>
#include <cmath>
#include <inverse_dynamics_solver/inverse_dynamics_solver.hpp>
#include <inverse_dynamics_solver/motor_currents.hpp>
#include <string>
#include <utility>
#include <vector>

#include "figures.hpp"
#include "inverse_dynamics_evaluation/error.hpp"
#include "inverse_dynamics_evaluation/joint_matching.hpp"

namespace inverse_dynamics_evaluation {
inline namespace v2 {
namespace {

using inverse_dynamics_solver::InverseDynamicsSolver;

// Sources of a meaning, in words.
constexpr const char* kOption = "as given";
constexpr const char* kFormat = "as the recording's format says";
constexpr const char* kFromData = "found from the data";
constexpr const char* kNothingStated = "as nothing is stated";

bool isMeaning(const std::string& word) {
  return word == kTorque || word == kCurrent || word == kTorqueWithoutGravity;
}

std::string asConfigured(const EffortOptions& options) {
  return options.configured_by.empty() ? "by default" : "as " + options.configured_by + " says";
}

Effort withGains(Effort effort, const EffortOptions& options) {
  if (effort.meaning != kCurrent) return effort;
  if (options.drive_gains.empty()) {
    throw ConfigurationError(
        options.where + ": effort means current, " + effort.stated_by +
        ": expected drive gains [N m/A], got none from " + options.gains_from + " nor from " +
        options.plugin +
        "; give drive_gains (ids: --drive-gains), one per joint, or put them into " +
        (options.configured_by.empty() ? "a run configuration" : options.configured_by));
  }
  effort.drive_gains = options.drive_gains;
  return effort;
}

}  // namespace

std::string Effort::summary() const {
  std::string text = meaning;
  std::replace(text.begin(), text.end(), '_', ' ');
  text += ", " + stated_by;
  if (!drive_gains.empty()) {
    text += ", with drive gains " + figures("%.4g", drive_gains, " ") + " N m/A";
  }
  if (verdict) {
    text += verdict->sure ? "; sure" : "; not sure";
    text += verdict->summary.empty() ? "" : ": " + verdict->summary;
  }
  return text;
}

OwnedMatrix Effort::torques(const Eigen::Ref<const Eigen::MatrixXd>& effort) const {
  if (meaning != kCurrent) return effort;
  const auto gains = static_cast<Eigen::Index>(drive_gains.size());
  if (gains != effort.rows()) {
    throw EvaluationError("torques of recorded efforts", "drive gains",
                          std::to_string(effort.rows()) + " numbers, one per joint",
                          std::to_string(gains), "take those of the same robot");
  }
  return Eigen::Map<const Eigen::VectorXd>(drive_gains.data(), gains).asDiagonal() * effort;
}

std::vector<double> driveGainsOf(const InverseDynamicsSolver& solver) {
  const auto* motors = dynamic_cast<const inverse_dynamics_solver::MotorCurrents*>(&solver);
  if (motors == nullptr) return {};
  const Eigen::VectorXd gains = motors->getDriveGainsMatrix().diagonal();
  return {gains.data(), gains.data() + gains.size()};
}

std::vector<double> driveGains(const std::vector<double>& configured, const std::string& where,
                               const InverseDynamicsSolver& solver) {
  if (configured.empty()) return driveGainsOf(solver);
  const std::vector<std::string>& names = solver.jointNames();
  if (configured.size() != names.size()) {
    throw ConfigurationError(where + ": expected " + std::to_string(names.size()) +
                             " numbers, one per joint of the chain (" + listed(names) + "), got " +
                             std::to_string(configured.size()));
  }
  if (!std::all_of(configured.begin(), configured.end(),
                   [](double gain) { return std::isfinite(gain) && gain > 0; })) {
    throw ConfigurationError(where + ": expected numbers above zero [N m/A], got " +
                             figures("%.4g", configured, " "));
  }
  return configured;
}

Effort statedEffort(const EffortOptions& options) {
  Effort effort;
  effort.meaning = options.configuration;
  effort.stated_by = asConfigured(options);
  if (!options.format.empty()) {
    effort.meaning = options.format;
    effort.stated_by = kFormat;
  }
  if (options.option) {
    effort.meaning = *options.option;
    effort.stated_by = kOption;
  }
  if (!isMeaning(effort.meaning) && effort.meaning != kAutomatic) {
    throw EvaluationError("effort, " + effort.stated_by + ": expected one of " + kTorque + ", " +
                          kCurrent + ", " + kTorqueWithoutGravity + ", " + kAutomatic + ", got '" +
                          effort.meaning + "'");
  }
  return withGains(std::move(effort), options);
}

Effort effortOfData(EffortVerdict verdict, const EffortOptions& options) {
  Effort effort;
  if (verdict.sure) {
    effort.meaning = verdict.best;
    effort.stated_by = kFromData;
  } else if (!options.format.empty()) {
    effort.meaning = options.format;
    effort.stated_by = kFormat;
  } else if (isMeaning(options.configuration)) {
    effort.meaning = options.configuration;
    effort.stated_by = asConfigured(options);
  } else {
    effort.stated_by = kNothingStated;
  }
  effort.verdict = std::move(verdict);
  return withGains(std::move(effort), options);
}

std::vector<std::string> effortNotes(const Effort& effort, const EffortOptions& options,
                                     bool all_zero, const std::vector<double>& own_gains) {
  std::vector<std::string> notes;
  if (all_zero) {
    notes.emplace_back(
        "all recorded efforts are zero: does the robot's driver measure them? Some publish zeros");
  }
  if (effort.verdict && !effort.verdict->sure) {
    const std::string& summary = effort.verdict->summary;
    notes.push_back("the data don't determine what effort means: " + effort.verdict->reason +
                    "; taken as " + effort.meaning + ", " + effort.stated_by +
                    (summary.empty() ? "" : " (" + summary + ")"));
  }
  const auto contradicted = [&](const std::string& other, const std::string& who) {
    if (isMeaning(other) && other != effort.meaning) {
      notes.push_back("effort is taken as " + effort.meaning + ", " + effort.stated_by +
                      ", where " + who + " says " + other);
    }
  };
  contradicted(options.format, "the recording's format");
  if (effort.stated_by != kOption && !options.configured_by.empty()) {
    contradicted(options.configuration, options.configured_by);
  }
  if (!own_gains.empty() && !effort.drive_gains.empty() && effort.drive_gains != own_gains) {
    notes.push_back("drive gains are those of " +
                    (options.configured_by.empty() ? options.gains_from : options.configured_by) +
                    "; the solver's own are " + figures("%.4g", own_gains, " ") + " N m/A");
  }
  if (effort.meaning == kTorqueWithoutGravity) {
    notes.emplace_back("computed torques are shown without gravity, as efforts were recorded");
  }
  return notes;
}

}  // namespace v2
}  // namespace inverse_dynamics_evaluation
