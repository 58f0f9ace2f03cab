// SPDX-License-Identifier: Apache-2.0

#include "inverse_dynamics_evaluation/run_configuration.hpp"

#include <chain_dynamics/text.hpp>
#include <inverse_dynamics_solver/inverse_dynamics_solver.hpp>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "inverse_dynamics_evaluation/error.hpp"

namespace inverse_dynamics_evaluation {
inline namespace v2 {
namespace {

using chain_dynamics::joined;

/// Whether a field comes from a parameter of a node, not from the file.
bool isParameter(const RunConfiguration& robot, const std::string& field) {
  return robot.file.empty() || robot.parameters_of_node.count(field) > 0;
}

/// What errors call the place of a field.
std::string placeOf(const RunConfiguration& robot, const std::string& field) {
  return isParameter(robot, field) ? "parameter '" + field + "'" : robot.file + ": " + field;
}

}  // namespace

void replaceDescription(RunConfiguration& robot, const std::string& urdf) {
  robot.urdf = urdf;
  robot.model.clear();
}

void replaceAccelerations(RunConfiguration& robot, const std::optional<std::string>& method,
                          const std::optional<double>& cutoff) {
  if (!method && !cutoff) return;
  robot.accelerations = method.value_or(robot.accelerations);
  robot.cutoff = cutoff;
}

SolverParameters solverParameters(const RunConfiguration& robot) {
  SolverParameters all = robot.parameters;
  all["friction"] = robot.friction;
  for (const auto& [name, text] : {std::pair("root", robot.root), std::pair("tip", robot.tip),
                                   std::pair("model", robot.model)}) {
    if (!text.empty()) all[name] = text;
  }
  if (robot.gravity) {
    all["gravity"] = std::vector<double>(robot.gravity->begin(), robot.gravity->end());
  }
  return all;
}

std::vector<std::string> recordedNames(const RunConfiguration& robot,
                                       const std::vector<std::string>& joint_names) {
  if (robot.joints.empty()) return joint_names;
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
  if (isParameter(robot, "effort")) {
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
