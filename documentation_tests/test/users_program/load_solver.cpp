// SPDX-License-Identifier: Apache-2.0
//
// Loads the solver of that name, or says why it can't.

#include <inverse_dynamics_solver/solver_loader.hpp>
#include <iostream>

int main(int, char** arguments) {
  try {
    inverse_dynamics_solver::SolverLoader().load(arguments[1]);
  } catch (const inverse_dynamics_solver::PluginNotFoundException& e) {
    std::cout << e.what() << "\n";
  }
}
