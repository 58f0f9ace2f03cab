// SPDX-License-Identifier: Apache-2.0
/// @file
/// What the examples of inverse_dynamics_evaluation take for granted.
/// Compiled, never linked.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <inverse_dynamics_evaluation/evaluator.hpp>
#include <inverse_dynamics_evaluation/recording.hpp>
#include <inverse_dynamics_solver/inverse_dynamics_solver.hpp>
#include <iostream>
#include <memory>
#include <string>
#include <vector>

using namespace inverse_dynamics_evaluation;
using namespace inverse_dynamics_solver;

namespace given {

// A solver, and what was recorded.
extern const std::shared_ptr<InverseDynamicsSolver> solver;
extern const std::string robot_description;
extern const Recording recording;
extern const RecordedColumns log;
extern const Eigen::VectorXd time;
extern Eigen::MatrixXd q, qd, effort;
extern const Eigen::MatrixXd gravity, computed, measured;
extern SampleTable table;

// Samples of a recording.
extern JointStateSource& source;

// What a program does with results.
template <class... Results>
void use(const Results&...);

// What means something else in each header.
namespace effort_examples {
extern const EffortOptions options;
extern const EffortVerdict verdict;
}  // namespace effort_examples
namespace evaluator_examples {
extern const EvaluationOptions options;
}  // namespace evaluator_examples
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
namespace online_derivative_examples {
extern const std::int64_t stamp;
extern const Eigen::VectorXd qd;
}  // namespace online_derivative_examples
namespace sample_table_examples {
extern const std::vector<std::string> joints;
extern const Eigen::Index k;
}  // namespace sample_table_examples

}  // namespace given
