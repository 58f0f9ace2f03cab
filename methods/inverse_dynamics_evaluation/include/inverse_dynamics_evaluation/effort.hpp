// SPDX-License-Identifier: Apache-2.0

/// @file
/// What recorded efforts mean, and so what is compared with what.
///
///     Effort effort = statedEffort(options);
///     if (effort.meaning == kAutomatic) effort = effortOfData(verdict, options);
///     std::cout << effort.summary() << "\n";   // current, as given, with drive gains 13 14 N m/A
///
/// The meaning is stated by the user, else by the recording's format, else by the run configuration;
/// `auto` asks the data. The comparison of causes in Python answers: diagnosis/compare.py.

#pragma once

#include <inverse_dynamics_solver/inverse_dynamics_solver.hpp>
#include <optional>
#include <string>
#include <vector>

#include "inverse_dynamics_evaluation/metrics.hpp"

namespace inverse_dynamics_evaluation {
inline namespace v2 {

/// Possible meanings of recorded efforts.
inline constexpr const char* kTorque = "torque";
inline constexpr const char* kCurrent = "current";
inline constexpr const char* kTorqueWithoutGravity = "torque_without_gravity";

/// Stated meaning that leaves the choice to the data.
inline constexpr const char* kAutomatic = "auto";

/// Stated meanings of efforts, or `auto`, and how texts name their sources.
struct EffortOptions {
  std::optional<std::string> option;    ///< by the user; none: nothing
  std::string format;                   ///< by the recording's format; empty: nothing
  std::string configuration = kTorque;  ///< by the run configuration
  std::vector<double> drive_gains;      ///< n; N m/A (prismatic N/A); driveGains(); or none
  std::string where;                    ///< source of the statement: `robot NAME`, a parameter
  std::string gains_from;               ///< where drive gains can be given: a file, a parameter
  std::string plugin;                   ///< of the solver
  /// Source of `configuration` and `drive_gains`, in words; empty: there is only a description.
  std::string configured_by = "the run configuration";
};

/// The meaning of efforts that fits the data.
struct EffortVerdict {
  std::string best = kTorque;  ///< the meaning that fits best
  bool sure = false;           ///< whether no other meaning or mistake fits as well
  std::string summary;         ///< errors of the meanings, in words; may be empty
  std::string reason = "evaluate() in C++ doesn't ask them, `ids evaluate` does";  ///< why not sure
};

/// What recorded efforts mean, and how that is known.
struct Effort {
  std::string meaning = kTorque;
  std::string stated_by;                 ///< in words
  std::vector<double> drive_gains;       ///< n; N m/A (prismatic N/A), of currents
  std::optional<EffortVerdict> verdict;  ///< of the data, if they were asked

  /// In words, as tables show it.
  std::string summary() const;

  /// Measured torques n x N [N m] of recorded efforts; without gravity if these are.
  OwnedMatrix torques(const Eigen::Ref<const Eigen::MatrixXd>& effort) const;
};

/// Drive gains of a model identified in motor currents; none of any other.
std::vector<double> driveGainsOf(const inverse_dynamics_solver::InverseDynamicsSolver& solver);

/// The run configuration's drive gains if it has any, else the solver's, if there are any.
///
/// @param where  where they are configured, for texts.
/// @throws ConfigurationError: not one per joint; one that isn't above 0.
std::vector<double> driveGains(const std::vector<double>& configured, const std::string& where,
                               const inverse_dynamics_solver::InverseDynamicsSolver& solver);

/// The stated meaning; `auto` leaves the choice to the data.
///
/// @throws EvaluationError: another word. @throws ConfigurationError: currents without drive gains.
Effort statedEffort(const EffortOptions& options);

/// The verdict of the data if it is sure, else the stated meaning.
///
/// @throws ConfigurationError: currents without drive gains.
Effort effortOfData(EffortVerdict verdict, const EffortOptions& options);

/// Notes for readers of the results, one sentence each.
///
/// @param all_zero    whether all recorded efforts are.
/// @param own_gains   driveGainsOf() the solver.
std::vector<std::string> effortNotes(const Effort& effort, const EffortOptions& options,
                                     bool all_zero, const std::vector<double>& own_gains);

}  // namespace v2
}  // namespace inverse_dynamics_evaluation
