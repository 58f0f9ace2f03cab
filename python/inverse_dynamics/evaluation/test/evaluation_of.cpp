// SPDX-License-Identifier: Apache-2.0

/// @file
/// The evaluation of a recording by the C++ libraries alone, with the calls that the ROS 2 node
/// evaluate_solver makes:
///
///     evaluation_of RECORDING ROBOT OUT    # metrics to stdout, torques to the recording OUT

#include <cstddef>
#include <cstdio>
#include <exception>
#include <fstream>
#include <inverse_dynamics_evaluation/accelerations.hpp>
#include <inverse_dynamics_evaluation/evaluator.hpp>
#include <inverse_dynamics_evaluation/joint_state_writer.hpp>
#include <inverse_dynamics_evaluation/metrics.hpp>
#include <inverse_dynamics_evaluation/recording.hpp>
#include <inverse_dynamics_evaluation/run_configuration.hpp>
#include <inverse_dynamics_evaluation/sample_table.hpp>
#include <inverse_dynamics_solver/inverse_dynamics_solver.hpp>
#include <inverse_dynamics_solver/parameters.hpp>
#include <inverse_dynamics_solver/solver_loader.hpp>
#include <iterator>
#include <memory>
#include <string>

namespace {

namespace evaluation = inverse_dynamics_evaluation;
namespace recordings = inverse_dynamics_evaluation;
namespace ids = inverse_dynamics_solver;
using evaluation::RunConfiguration;

std::string textOf(const std::string& file) {
  std::ifstream stream(file);
  return {std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
}

std::shared_ptr<ids::InverseDynamicsSolver> solverOf(const RunConfiguration& robot) {
  const auto solver = ids::SolverLoader().load(robot.plugin);
  solver->initialize(ids::Parameters(evaluation::solverParameters(robot)).strict(), "",
                     robot.urdf.empty() ? "" : textOf(robot.urdf));
  return solver;
}

void run(const std::string& path, const std::string& name, const std::string& out) {
  const RunConfiguration robot = evaluation::readRunConfiguration(name);
  const auto solver = solverOf(robot);
  const recordings::Recording recording(path);
  evaluation::RecordingOptions source;
  source.joints = evaluation::recordedNames(robot, solver->jointNames());
  evaluation::EvaluationOptions options;
  options.method = evaluation::accelerationMethod(robot.accelerations);
  options.cutoff = robot.cutoff.value_or(0.0);
  options.effort = evaluation::effortOptions(robot, *solver);
  const auto result = evaluation::evaluate(*recording.jointStates(), source, *solver, options);
  for (const evaluation::JointMetrics& joint : result.errors) {
    std::printf("%.17g %.17g %.17g %.17g %.17g %.17g\n", joint.mae, joint.rmse, joint.nrmse,
                joint.bias, joint.r2, joint.max_abs);
  }
  const evaluation::SampleTable& table = *result.table;
  recordings::writeTorques(
      out, recording.storage(), {"/torques", table.joint_names, table.frame_id},
      {static_cast<std::size_t>(table.size()), table.header_stamps.data(),
       table.receive_stamps.data(), table.q.data(), table.qd.data(), table.computed.data()},
      table.measured.data());
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 4) {
    std::fputs("usage: evaluation_of RECORDING ROBOT OUT\n", stderr);
    return 1;
  }
  try {
    run(argv[1], argv[2], argv[3]);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 2;
  }
  return 0;
}
