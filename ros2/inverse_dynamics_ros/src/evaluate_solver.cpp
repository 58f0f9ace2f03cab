// SPDX-License-Identifier: Apache-2.0

/// @file
/// Program: torques of a recorded motion by a solver, as a recording and as a table of errors.
///
///     ros2 run inverse_dynamics_ros evaluate_solver --ros-args -p input_bag:=recording
///         -p output_bag:=result -p robot:=ur10_real
///
/// Exit code 0: done; 2: something the user can repair (the last line says what); 130: interrupted.

#include <cstddef>
#include <cstdio>
#include <inverse_dynamics_evaluation/accelerations.hpp>
#include <inverse_dynamics_evaluation/effort.hpp>
#include <inverse_dynamics_evaluation/evaluator.hpp>
#include <inverse_dynamics_evaluation/recording.hpp>
#include <inverse_dynamics_evaluation/run_configuration.hpp>
#include <inverse_dynamics_evaluation/sample_table.hpp>
#include <inverse_dynamics_ros/evaluate_solver_parameters.hpp>
#include <inverse_dynamics_solver/inverse_dynamics_solver.hpp>
#include <inverse_dynamics_solver/strict_initialization.hpp>
#include <rclcpp/rclcpp.hpp>
#include <string>
#include <vector>

#include "output_bag.hpp"
#include "robot_parameters.hpp"
#include "run_program.hpp"
#include "torque_bag.hpp"
#include "user_error.hpp"

namespace inverse_dynamics_ros {
namespace {

using inverse_dynamics_evaluation::Clock;
using inverse_dynamics_evaluation::RunConfiguration;
using inverse_dynamics_evaluation::Storage;

Clock clockOf(const std::string& name) {
  return name == "header" ? Clock::kHeader : name == "receive" ? Clock::kReceive : Clock::kAuto;
}

Storage storageOf(const evaluate_solver::Params& params, Storage input) {
  if (params.storage.empty()) return input;
  return params.storage == "mcap" ? Storage::kMcap : Storage::kSqlite3;
}

// Checks parameters before any work.
void check(const evaluate_solver::Params& params) {
  if (params.input_bag.empty()) {
    throw UserError("parameter 'input_bag'", "the recording to evaluate", "nothing", "set it");
  }
  OutputBag::requireFree(params.output_bag);
  if (params.topic.empty()) {
    throw UserError("parameter 'topic'", "a name for the computed torques", "nothing",
                    "leave it out to take /torques");
  }
}

EvaluationOptions optionsOf(const evaluate_solver::Params& params, const RunConfiguration& robot,
                            const inverse_dynamics_solver::InverseDynamicsSolver& solver) {
  EvaluationOptions options;
  options.method = inverse_dynamics_evaluation::accelerationMethod(robot.accelerations);
  options.cutoff = robot.cutoff.value_or(0.0);
  options.rules = inverse_dynamics_evaluation::rulesWithout(params.without_rules);
  options.effort = inverse_dynamics_evaluation::effortOptions(robot, solver);
  // Currents without drive gains are refused before the recording is read.
  inverse_dynamics_evaluation::statedEffort(options.effort);
  options.recording = params.input_bag;
  return options;
}

void say(const rclcpp::Logger& logger, const std::string& line) {
  RCLCPP_INFO(logger, "%s", line.c_str());
}

void sayAll(const rclcpp::Logger& logger, const std::vector<std::string>& notes,
            std::size_t first = 0) {
  for (std::size_t k = first; k < notes.size(); ++k) RCLCPP_WARN(logger, "%s", notes[k].c_str());
}

// Logs the run configuration, if any, and the source of its description.
void sayRobot(const rclcpp::Logger& logger, const RunConfiguration& robot) {
  if (!robot.file.empty()) {
    say(logger, "robot: " + robot.name + ", " + robot.description + "; robot description: " +
                    (robot.urdf.empty() ? "none of its own" : robot.urdf));
  }
}

void run(rclcpp::Node& node) {
  declareRobotParameters(node);
  const evaluate_solver::ParamListener listener(node.get_node_parameters_interface(),
                                                node.get_logger());
  inverse_dynamics_solver::rejectUndeclared(*node.get_node_parameters_interface());
  const evaluate_solver::Params params = listener.get_params();
  check(params);
  const rclcpp::Logger logger = node.get_logger();

  const NodeRobot made(givenParameters(node));
  const RunConfiguration& robot = made.configuration();
  sayRobot(logger, robot);
  const auto solver = made.makeSolver(made.description());
  const std::vector<std::string> warnings = solver->warnings();
  sayAll(logger, warnings);
  EvaluationOptions options = optionsOf(params, robot, *solver);
  options.units = torqueUnits(*solver);
  say(logger, "solver: " + robot.plugin);

  const std::vector<std::string> joints =
      inverse_dynamics_evaluation::recordedNames(robot, solver->jointNames());
  const auto motion = openMotion(
      params.input_bag,
      {params.input_topic, robot.file.empty() ? "" : robot.topic, joints, clockOf(params.clock)});
  options.topic = motion->topic;
  options.progress = [](double) { requireNoInterrupt(); };
  const Evaluation evaluation = evaluate(*motion->source, motion->options, *solver, options);
  say(logger, "recording: " + params.input_bag + ", " + motion->topic + ": " +
                  std::to_string(evaluation.table->size()) + " samples");
  say(logger, "accelerations: " + evaluation.accelerations.summary);
  say(logger, "effort means: " + evaluation.effort.summary());
  sayAll(logger, evaluation.notes, warnings.size());  // the solver's come first

  writeTorques(params.output_bag, storageOf(params, motion->storage), params.topic, *motion,
               evaluation);
  say(logger,
      "written: " + params.output_bag + ": " + params.topic + " (computed)" +
          (evaluation.table->measured.size() > 0 ? ", " + params.topic + "_gt (measured)" : ""));
  std::fputs(errorTable(evaluation, options.units).c_str(), stdout);
}

}  // namespace
}  // namespace inverse_dynamics_ros

int main(int argc, char** argv) {
  return inverse_dynamics_ros::runProgram(argc, argv, "evaluate_solver", [] {
    rclcpp::Node node("evaluate_solver");
    inverse_dynamics_ros::run(node);
  });
}
