// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <chrono>
#include <cmath>
#include <fstream>
#include <inverse_dynamics_control/inverse_dynamics_control.hpp>
#include <inverse_dynamics_control/joint_parameters.hpp>
#include <inverse_dynamics_solver/forward_dynamics.hpp>
#include <inverse_dynamics_solver/inverse_dynamics_solver.hpp>
#include <inverse_dynamics_solver/solver_loader.hpp>
#include <iostream>
#include <iterator>
#include <string>
#include <thread>

using namespace inverse_dynamics_control;
using inverse_dynamics_solver::ForwardDynamics;
using inverse_dynamics_solver::InverseDynamicsSolver;

// Stands in for your robot: rigid bodies that move as the torques say.
struct SimulatedRobot {
  const ForwardDynamics& dynamics;
  JointState state;
  Eigen::VectorXd qdd;

  void read(JointState& measured) const { measured = state; }
  void write(const Eigen::VectorXd& tau, double period) {
    dynamics.getAccelerations(state.q, state.qd, tau, qdd);
    state.qd += qdd * period;
    state.q += state.qd * period;
  }
};

// q = q_start + (1 - cos 2t) / 5, the same in all joints.
void referenceAt(double t, const Eigen::VectorXd& start, Reference& reference) {
  reference.q = start.array() + 0.2 * (1.0 - std::cos(2.0 * t));
  reference.qd.setConstant(0.4 * std::sin(2.0 * t));
  reference.qdd.setConstant(0.8 * std::cos(2.0 * t));
}

int main(int argc, char** argv) {
  if (argc != 2) {
    std::cerr << "usage: control_loop URDF\n";
    return 2;
  }
  std::ifstream file(argv[1]);
  if (!file) {
    std::cerr << argv[1] << ": can't be read; expected the file of a URDF\n";
    return 1;
  }
  const std::string urdf{std::istreambuf_iterator<char>(file), {}};

  // Before the loop: everything that can fail or allocates.
  auto solver = inverse_dynamics_solver::SolverLoader().load(
      "rigid_body_inverse_dynamics_solver/InverseDynamicsSolverRigidBody");
  solver->initialize({{"tip", "tool0"}}, "", urdf);
  const Eigen::Index n = solver->jointCount();
  const double period = 1e-3;                        // s
  const Gains gains = Gains::uniform(n, 20.0, 1.0);  // 20 rad/s, critically damped
  LawOptions options;
  options.limits.effort = describedLimits(urdf, solver->jointNames()).effort;  // N m
  options.damping_rate = 5.0;                                                  // 1/s
  ComputedTorque law(solver, gains, options);
  Eigen::VectorXd start(6), tau(n);
  start << 0.0, -1.2, 1.5, -0.5, 1.0, 0.0;  // rad
  JointState measured(n);
  Reference reference(n);
  SimulatedRobot robot{dynamic_cast<const ForwardDynamics&>(*solver), JointState(n),
                       Eigen::VectorXd::Zero(n)};
  robot.state.q = start;

  // The loop, for one second: 1000 cycles.
  double largest_error = 0.0;
  auto next = std::chrono::steady_clock::now();
  for (int k = 0; k < 1000; ++k) {
    robot.read(measured);
    referenceAt(k * period, start, reference);
    const Status status = law.update(measured, reference, period, tau);
    robot.write(tau, period);
    if (status != Status::kOk) std::cout << k << ": " << text(status) << "\n";
    largest_error = std::max(largest_error, (reference.q - measured.q).cwiseAbs().maxCoeff());
    std::this_thread::sleep_until(next += std::chrono::milliseconds(1));
  }
  std::cout << "1000 cycles, largest error " << std::round(1e5 * largest_error) / 100 << " mrad\n";
}
