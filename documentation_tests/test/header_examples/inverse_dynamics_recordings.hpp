// SPDX-License-Identifier: Apache-2.0
/// @file
/// What the examples of inverse_dynamics_evaluation and inverse_dynamics_recordings take for granted.
/// Compiled, never linked.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <inverse_dynamics_evaluation/evaluator.hpp>
#include <inverse_dynamics_recordings/recording.hpp>
#include <inverse_dynamics_solver/inverse_dynamics_solver.hpp>
#include <iostream>
#include <memory>
#include <string>
#include <vector>

using namespace inverse_dynamics_evaluation;
using namespace inverse_dynamics_recordings;
using namespace inverse_dynamics_solver;

namespace given {

// A solver, and what was recorded.
extern const std::shared_ptr<InverseDynamicsSolver> solver;
extern const std::string robot_description;
extern const Recording recording;
extern const JointLog log;
extern const Eigen::VectorXd time;
extern Eigen::MatrixXd q, qd, effort;
extern const Eigen::MatrixXd gravity, computed, measured;
extern const SampleReport samples;

// Samples of a recording, block after block.
extern JointStateBlock block;
extern JointLogBuilder builder;
extern JointStateSource& source;

// What a program does with results.
template <class... Results>
void use(const Results&...);

// What means something else in each header.
namespace effort_examples {
extern const EffortOptions options;
extern const EffortSums sums;
}  // namespace effort_examples
namespace effort_verdict_examples {
struct Block {
  Eigen::MatrixXd computed, gravity, effort;
};
extern const std::vector<Block> blocks;
extern const Eigen::Index count;
extern const std::vector<double> drive_gains;
}  // namespace effort_verdict_examples
namespace evaluator_examples {
struct Table {
  void append(const Eigen::VectorXd& time, const Eigen::MatrixXd& torques);
};
extern Table table;
extern const EvaluationOptions options;
}  // namespace evaluator_examples
namespace joint_log_examples {
extern const std::vector<JointSample> messages;
}
namespace joint_matching_examples {
struct Message {
  std::vector<std::string> name;
  std::vector<double> position;
};
extern const Message message;
extern Eigen::VectorXd q;
}  // namespace joint_matching_examples
namespace joint_state_writer_examples {
extern const std::vector<std::int64_t> stamps;
extern const Eigen::MatrixXd tau;
}  // namespace joint_state_writer_examples
namespace metrics_examples {
struct Block {
  Eigen::Index first;
  Eigen::MatrixXd computed, measured;
};
extern const std::vector<Block> blocks;
}  // namespace metrics_examples
namespace online_derivative_examples {
extern const std::int64_t stamp;
extern const Eigen::VectorXd qd;
}  // namespace online_derivative_examples

}  // namespace given
