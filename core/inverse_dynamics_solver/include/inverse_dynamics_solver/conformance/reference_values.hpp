// SPDX-License-Identifier: Apache-2.0
/// @file
/// Comparison of a solver with values that other programs computed: the files reference/*.json of
/// the package inverse_dynamics_robots.
///
///     expectReferenceValues(*solver, "ur10.json", 1e-10);
///
/// For test programs only: it needs GoogleTest and yaml-cpp.
#pragma once

#include <gtest/gtest.h>
#include <yaml-cpp/yaml.h>

#include <Eigen/Core>
#include <cstddef>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "inverse_dynamics_solver/installed_package.hpp"
#include "inverse_dynamics_solver/inverse_dynamics_solver.hpp"

namespace inverse_dynamics_solver::conformance {

/// Path of a file of the installed package inverse_dynamics_robots.
inline std::string robotsFile(const std::string& path) {
  return installedPackageShare("inverse_dynamics_robots") + "/" + path;
}

/// Text of a file; throws if it can't be read.
inline std::string textOf(const std::string& path) {
  std::ifstream file(path);
  if (!file) throw std::runtime_error(path + ": can't be read");
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

/// Numbers of a JSON list; a list of lists is a matrix, row by row.
inline Eigen::MatrixXd numbersOf(const YAML::Node& list) {
  const bool is_matrix = list[0].IsSequence();
  const std::size_t cols = is_matrix ? list[0].size() : 1;
  Eigen::MatrixXd numbers(static_cast<Eigen::Index>(list.size()), static_cast<Eigen::Index>(cols));
  for (std::size_t i = 0; i < list.size(); ++i) {
    for (std::size_t j = 0; j < cols; ++j) {
      const YAML::Node& number = is_matrix ? list[i][j] : list[i];
      numbers(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) = number.as<double>();
    }
  }
  return numbers;
}

/// The states of a reference file, each with q, qd, qdd and what was computed there. (JSON is
/// YAML.)
inline std::vector<YAML::Node> referenceStates(const std::string& file) {
  const YAML::Node states = YAML::LoadFile(robotsFile("reference/" + file))["states"];
  return {states.begin(), states.end()};
}

/// Expects every entry of a result to be that of the reference file.
///
/// @param name   key in the reference state; absent there: a failure.
/// @param where  says which state it is.
inline void expectEntry(const YAML::Node& state, const std::string& name,
                        const Eigen::MatrixXd& result, double tolerance, const std::string& where) {
  ASSERT_TRUE(state[name].IsDefined()) << where << " has no " << name;
  const Eigen::MatrixXd expected = numbersOf(state[name]);
  ASSERT_EQ(result.rows(), expected.rows()) << where << ", " << name;
  ASSERT_EQ(result.cols(), expected.cols()) << where << ", " << name;
  const double difference = (result - expected).cwiseAbs().maxCoeff();
  EXPECT_TRUE(difference <= tolerance)  // false for NaN
      << where << ", " << name << ": greatest difference " << difference << ", allowed "
      << tolerance;
}

/// Expects inertia, Coriolis, gravity and total torques of the reference file, and friction where
/// it has friction; by the single methods and by the one that gives all components.
inline void expectReferenceValues(const InverseDynamicsSolver& solver, const std::string& file,
                                  double tolerance) {
  const std::vector<YAML::Node> states = referenceStates(file);
  ASSERT_FALSE(states.empty()) << file;
  for (std::size_t k = 0; k < states.size(); ++k) {
    const YAML::Node& state = states[k];
    const std::string where = file + " state " + std::to_string(k);
    const Eigen::VectorXd q = numbersOf(state["q"]);
    const Eigen::VectorXd qd = numbersOf(state["qd"]);
    const Eigen::VectorXd qdd = numbersOf(state["qdd"]);
    expectEntry(state, "inertia", solver.getInertiaMatrix(q), tolerance, where);
    expectEntry(state, "coriolis", solver.getCoriolisVector(q, qd), tolerance, where);
    expectEntry(state, "gravity", solver.getGravityVector(q), tolerance, where);
    expectEntry(state, "torques", solver.getTorques(q, qd, qdd), tolerance, where);
    if (state["friction"]) {
      expectEntry(state, "friction", solver.getFrictionVector(q, qd), tolerance, where);
    }
    const auto [H, c, g] = solver.getDynamicComponents(q, qd);
    expectEntry(state, "inertia", H, tolerance, where + ", components");
    expectEntry(state, "coriolis", c, tolerance, where + ", components");
    expectEntry(state, "gravity", g, tolerance, where + ", components");
  }
}

}  // namespace inverse_dynamics_solver::conformance
