// SPDX-License-Identifier: Apache-2.0
/// @file
/// Torques of a few states, by a solver made as C++ users make it.
///
///     torques_of PLUGIN URDF_FILE PARAMETERS_YAML     # an empty URDF_FILE is no description
///
/// Prints a line `warning TEXT` per warning and `torque NUMBER` per state and joint. Exit code 2:
/// an error of the interface's family, its text on standard error.
#include <cmath>
#include <cstdio>
#include <fstream>
#include <inverse_dynamics_solver/exceptions.hpp>
#include <inverse_dynamics_solver/inverse_dynamics_solver.hpp>
#include <inverse_dynamics_solver/parameters.hpp>
#include <inverse_dynamics_solver/solver_loader.hpp>
#include <sstream>
#include <string>

namespace {

std::string textOf(const std::string& file) {
  std::ifstream stream(file, std::ios::binary);
  std::ostringstream text;
  text << stream.rdbuf();
  return text.str();
}

void printTorques(const inverse_dynamics_solver::InverseDynamicsSolver& solver) {
  const auto n = static_cast<Eigen::Index>(solver.jointNames().size());
  constexpr Eigen::Index kStates = 3;
  Eigen::VectorXd q(n), qd(n), qdd(n);
  for (Eigen::Index state = 0; state < kStates; ++state) {
    for (Eigen::Index joint = 0; joint < n; ++joint) {
      const auto k = static_cast<double>(state * n + joint);
      q[joint] = std::sin(1.0 + k);
      qd[joint] = std::cos(2.0 + k);
      qdd[joint] = std::sin(3.0 * k);
    }
    const Eigen::VectorXd tau = solver.getTorques(q, qd, qdd);
    for (Eigen::Index joint = 0; joint < n; ++joint) std::printf("torque %.17g\n", tau[joint]);
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 4) {
    std::fputs("usage: torques_of PLUGIN URDF_FILE PARAMETERS_YAML\n", stderr);
    return 1;
  }
  try {
    const auto solver = inverse_dynamics_solver::SolverLoader().load(argv[1]);
    const std::string file = argv[2];
    solver->initialize(inverse_dynamics_solver::Parameters::fromYaml(argv[3]), "",
                       file.empty() ? "" : textOf(file));
    for (const std::string& text : solver->warnings()) std::printf("warning %s\n", text.c_str());
    printTorques(*solver);
  } catch (const inverse_dynamics_solver::Exception& e) {
    std::fprintf(stderr, "%s\n", e.what());
    return 2;
  }
  return 0;
}
