// SPDX-License-Identifier: Apache-2.0

#include "inverse_dynamics_evaluation/run_configuration.hpp"

#include <algorithm>
#include <chain_dynamics/text.hpp>
#include <set>
#include <utility>

#include "inverse_dynamics_evaluation/error.hpp"

namespace inverse_dynamics_evaluation {
inline namespace v2 {
namespace {

using chain_dynamics::joined;

template <class T>
void replace(T& field, const std::optional<T>& change) {
  if (change) {
    field = *change;
  }
}

/// What errors call the place of a field.
std::string placeOf(const RunConfiguration& robot, const std::string& field) {
  return robot.file.empty() ? "parameter '" + field + "'" : robot.file + ": " + field;
}

}  // namespace

RunConfiguration withChanges(RunConfiguration robot, const RunConfigurationChanges& changes) {
  if (changes.urdf) {
    robot.model.clear();
  }
  if (changes.accelerations || changes.cutoff) {
    robot.cutoff = changes.cutoff;
  }
  replace(robot.plugin, changes.plugin);
  replace(robot.urdf, changes.urdf);
  replace(robot.root, changes.root);
  replace(robot.tip, changes.tip);
  replace(robot.topic, changes.topic);
  replace(robot.effort, changes.effort);
  replace(robot.accelerations, changes.accelerations);
  replace(robot.friction, changes.friction);
  replace(robot.joints, changes.joints);
  replace(robot.drive_gains, changes.drive_gains);
  if (changes.gravity) {
    robot.gravity = changes.gravity;
  }
  for (const auto& [name, value] : changes.parameters) {
    robot.parameters[name] = value;
  }
  return robot;
}

SolverParameters solverParameters(const RunConfiguration& robot) {
  SolverParameters all = robot.parameters;
  all["friction"] = robot.friction;
  for (const auto& [name, text] : {std::pair("root", robot.root), std::pair("tip", robot.tip),
                                   std::pair("model", robot.model)}) {
    if (!text.empty()) {
      all[name] = text;
    }
  }
  if (robot.gravity) {
    all["gravity"] = std::vector<double>(robot.gravity->begin(), robot.gravity->end());
  }
  return all;
}

std::vector<std::string> recordedNames(const RunConfiguration& robot,
                                       const std::vector<std::string>& joint_names) {
  if (robot.joints.empty()) {
    return joint_names;
  }
  const std::string where = placeOf(robot, "joints") + ": expected ";
  if (robot.joints.size() != joint_names.size()) {
    throw ConfigurationError(where + std::to_string(joint_names.size()) +
                             " names, one per joint of the chain (" + joined(joint_names) +
                             "), got " + std::to_string(robot.joints.size()) + " (" +
                             joined(robot.joints) + ")");
  }
  const auto sorted = [](const std::vector<std::string>& names) {
    return std::set<std::string>(names.begin(), names.end());
  };
  if (robot.joints != joint_names && sorted(robot.joints) == sorted(joint_names)) {
    throw ConfigurationError(where + "the order of the chain, " + joined(joint_names) + ", got " +
                             joined(robot.joints) +
                             "; the recording's order doesn't matter, so leave joints out");
  }
  return robot.joints;
}

EffortOptions effortOptions(const RunConfiguration& robot,
                            const inverse_dynamics_solver::InverseDynamicsSolver& solver) {
  EffortOptions options;
  options.configuration = robot.effort;
  options.drive_gains = driveGains(robot.drive_gains, placeOf(robot, "drive_gains"), solver);
  options.plugin = robot.plugin;
  if (robot.file.empty()) {
    options.where = placeOf(robot, "effort");
    options.gains_from = placeOf(robot, "drive_gains");
    options.configured_by = "the node's configuration";
  } else {
    options.where = "robot " + robot.name;
    options.gains_from = robot.file;
    if (robot.file == robot.urdf) options.configured_by.clear();  // a description alone
  }
  return options;
}

}  // namespace v2
}  // namespace inverse_dynamics_evaluation
