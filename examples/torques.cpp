// SPDX-License-Identifier: Apache-2.0
#include <inverse_dynamics_solver/solver_loader.hpp>
#include <iostream>

int main() {
  auto solver = inverse_dynamics_solver::SolverLoader().load(
      "ur10_inverse_dynamics_solver/InverseDynamicsSolverUR10");
  solver->initialize();
  const Eigen::VectorXd q = Eigen::VectorXd::LinSpaced(6, -1.0, 1.0);   // rad
  const Eigen::VectorXd qd = Eigen::VectorXd::Constant(6, 0.5);         // rad/s
  const Eigen::VectorXd qdd = Eigen::VectorXd::Zero(6);                 // rad/s^2
  std::cout << solver->getTorques(q, qd, qdd).transpose() << " N m\n";  // H qdd + C qd + f + g
}
