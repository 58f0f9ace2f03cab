// SPDX-License-Identifier: Apache-2.0

/// @file
/// The evaluation of a recording by the C++ libraries alone, with the calls that the ROS 2 node
/// evaluate_solver makes:
///
///     evaluation_of RECORDING ROBOT OUT    # metrics to stdout, torques to the recording OUT

#include <cstdio>
#include <exception>
#include <fstream>
#include <inverse_dynamics_evaluation/evaluator.hpp>
#include <inverse_dynamics_evaluation/run_configuration.hpp>
#include <inverse_dynamics_recordings/joint_state_writer.hpp>
#include <inverse_dynamics_recordings/recording.hpp>
#include <inverse_dynamics_solver/solver_loader.hpp>
#include <iterator>
#include <memory>
#include <string>

namespace {

namespace evaluation = inverse_dynamics_evaluation;
namespace recordings = inverse_dynamics_recordings;
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

evaluation::JointLog logOf(const recordings::Recording& recording,
                           const std::vector<std::string>& joints) {
  const auto source = recording.jointStates();
  evaluation::JointLogBuilder builder(recording.path(), joints);
  evaluation::JointStateBlock block;
  while (source->next(block)) {
    builder.add(block);
  }
  return builder.finish();
}

void write(const std::string& path, recordings::Storage storage, const evaluation::JointLog& log,
           const Eigen::MatrixXd& computed, const Eigen::MatrixXd& measured) {
  recordings::JointStateWriter writer(path, storage,
                                      {{"/torques", log.joint_names, log.frame_id},
                                       {"/torques_gt", log.joint_names, log.frame_id}});
  const auto rows = [&log](const Eigen::MatrixXd& effort) {
    return recordings::JointStateRows{static_cast<std::size_t>(log.q.cols()),
                                      log.header_stamps.data(),
                                      log.receive_stamps.data(),
                                      log.q.data(),
                                      log.qd.data(),
                                      effort.data()};
  };
  writer.write({rows(computed), rows(measured)});
  writer.finish();
}

void run(const std::string& path, const std::string& name, const std::string& out) {
  const RunConfiguration robot = evaluation::readRunConfiguration(name);
  const auto solver = solverOf(robot);
  const recordings::Recording recording(path);
  const evaluation::JointLog log =
      logOf(recording, evaluation::recordedNames(robot, solver->jointNames()));
  evaluation::EvaluationOptions options;
  options.method = evaluation::accelerationMethod(robot.accelerations);
  options.cutoff = robot.cutoff.value_or(0.0);
  options.effort = evaluation::effortOptions(robot, *solver);
  Eigen::MatrixXd computed(log.q.rows(), log.q.cols());
  Eigen::MatrixXd measured = computed;
  const auto result =
      evaluation::evaluate(log, *solver, options, [&](const evaluation::EvaluatedSamples& next) {
        computed.middleCols(next.first, next.computed.cols()) = next.computed;
        measured.middleCols(next.first, next.measured.cols()) = next.measured;
      });
  for (const evaluation::JointMetrics& joint : result.errors) {
    std::printf("%.17g %.17g %.17g %.17g %.17g %.17g\n", joint.mae, joint.rmse, joint.nrmse,
                joint.bias, joint.r2, joint.max_abs);
  }
  write(out, recording.storage(), log, computed, measured);
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
