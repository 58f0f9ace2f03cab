// SPDX-License-Identifier: Apache-2.0

/// @file
/// Run configurations: what a robot is, in one YAML file [docs/add_a_robot.md].
///
///     RunConfiguration robot = readRunConfiguration("ur10_real");      // one of the project's
///     RunConfiguration mine = readRunConfiguration("my_robot.yaml");   // one's own
///     solver->initialize(Parameters(solverParameters(robot)).strict(), "", robot_description);
///
/// Which solver, from which description or model, between which links, and what its recordings look
/// like. Strict: unknown or missing keys and wrong types are errors with file, line and key.

#pragma once

#include <array>
#include <chain_dynamics/located_yaml.hpp>
#include <inverse_dynamics_solver/inverse_dynamics_solver.hpp>
#include <inverse_dynamics_solver/parameters.hpp>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "inverse_dynamics_evaluation/effort.hpp"

namespace inverse_dynamics_evaluation {
inline namespace v2 {

/// Parameters of a solver: dotted name to value.
using SolverParameters = std::map<std::string, inverse_dynamics_solver::ParameterValue>;

/// One run configuration. An empty text: not stated, so the solver's own default.
struct RunConfiguration {
  std::string name;
  std::string description;                       ///< one line
  std::string file;                              ///< where it is from; empty: parameters of a node
  std::set<std::string> parameters_of_node;      ///< fields that don't come from the file
  std::string plugin;                            ///< `package/Class`
  std::string urdf;                              ///< path
  std::string model;                             ///< path
  std::string root, tip;                         ///< links; several tips with commas, or *
  std::optional<std::array<double, 3>> gravity;  ///< m/s^2, in the frame of the root link
  bool friction = true;                          ///< whether the solver's friction model counts
  std::string topic = "/joint_states";           ///< of recordings
  std::vector<std::string> joints;     ///< names in recordings, in the order of the chain; or none
  std::string effort = kTorque;        ///< what recorded efforts mean: a meaning, or kAutomatic
  std::vector<double> drive_gains;     ///< N m/A (prismatic N/A); none: the solver's, if it has any
  std::string accelerations = "auto";  ///< name() of an AccelerationMethod
  std::optional<double> cutoff;        ///< Hz; none: chosen from the data
  SolverParameters parameters;         ///< of the solver, beyond the fields above
  /// Format of a recorded table, where its column names don't tell: see columns.py, table_logs.py.
  std::string columns;             ///< `KEY=PATTERN, ...`
  std::vector<std::string> scale;  ///< `KEY=NUMBER`, or a unit, or one for each joint
  std::vector<double> sign;        ///< of each joint, 1 or -1; none: 1
  std::optional<double> rate;      ///< Hz; of samples in a table without time
  std::string source;              ///< where description and values come from
  /// G of `q_motor = G q`, where states of motors are recorded: n ratios, or n x n numbers row by row.
  std::vector<double> gears;
  /// For identification: places beside the joints where friction acts, each with its velocity as factors of
  /// those of joints; and what is fitted of the springs of joints, `linear` or `lever`.
  std::map<std::string, std::map<std::string, double>> friction_at;
  std::map<std::string, std::string> fit_springs;
};

/// Names of the run configurations that the sourced workspaces bring, sorted.
///
/// @throws PackageNotFoundError: no workspace has the package inverse_dynamics_robots.
std::vector<std::string> robotNames();

/// The run configuration by the name of one of robotNames(), or from a file.
///
/// @param name_or_file  what ends in .yaml or .yml, or has a directory, is a file; one that ends in .urdf
///   is the description of robotOfDescription().
/// @throws PackageNotFoundError. @throws ConfigurationError: no such robot; a file that isn't right.
RunConfiguration readRunConfiguration(const std::string& name_or_file);

/// A robot of which only the description is known: rigid bodies without friction. Its name is the file's;
/// what recorded efforts mean is found from the data.
RunConfiguration robotOfDescription(const std::string& urdf);

/// Gives a robot another description, by its path, which stands instead of a model file too.
void replaceDescription(RunConfiguration& robot, const std::string& urdf);

/// Gives a robot another method of accelerations, or another cut-off [Hz]: that of the configuration
/// belonged to its own method.
void replaceAccelerations(RunConfiguration& robot, const std::optional<std::string>& method,
                          const std::optional<double>& cutoff);

/// Parameters of a solver in YAML; names of nested maps are joined by dots.
///
/// @throws what the map throws: a key of the configuration's own; a list of several types.
SolverParameters readSolverParameters(const chain_dynamics::LocatedMap& map);

/// Parameters for the solver's initialize(), without those that aren't stated.
SolverParameters solverParameters(const RunConfiguration& robot);

/// Names in a recording of the solver's joints, in the order of the chain.
///
/// @throws ConfigurationError: another number of names; the chain's names in another order.
std::vector<std::string> recordedNames(const RunConfiguration& robot,
                                       const std::vector<std::string>& joint_names);

/// The run configuration's statements about efforts; drive gains default to the solver's.
///
/// @throws ConfigurationError: not one drive gain per joint; one that isn't above 0.
EffortOptions effortOptions(const RunConfiguration& robot,
                            const inverse_dynamics_solver::InverseDynamicsSolver& solver);

}  // namespace v2
}  // namespace inverse_dynamics_evaluation
