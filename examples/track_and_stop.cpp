// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <inverse_dynamics_control/inverse_dynamics_control.hpp>
#include <inverse_dynamics_solver/solver_loader.hpp>
#include <iostream>

using namespace inverse_dynamics_control;

// A mass of 2 kg, 0.5 m from a horizontal axis.
const char* const kPendulum = R"(<robot name="pendulum">
  <link name="base"/>
  <link name="arm"><inertial><origin xyz="0.5 0 0"/><mass value="2"/>
    <inertia ixx="0" ixy="0" ixz="0" iyy="0" iyz="0" izz="0"/></inertial></link>
  <joint name="hinge" type="continuous"><parent link="base"/><child link="arm"/><axis xyz="0 -1 0"/></joint>
</robot>)";

int main() {
  auto solver = inverse_dynamics_solver::SolverLoader().load(
      "rigid_body_inverse_dynamics_solver/InverseDynamicsSolverRigidBody");
  solver->initialize({}, "", kPendulum);
  const Eigen::Index n = solver->jointCount();

  // Before the loop: everything that can fail or allocates.
  const double period = 1e-3;  // s
  LawOptions options;
  options.limits.effort = Eigen::VectorXd::Constant(n, 20.0);  // N m
  options.damping_rate = 5.0;                                  // 1/s
  ComputedTorque law(solver, Gains::uniform(n, 20.0, 1.0), options);
  SafeStop stop(Eigen::VectorXd::Constant(n, 4.0), solver->jointNames());  // rad/s^2
  JointState state(n);
  Reference reference(n);
  Eigen::VectorXd tau(n);

  // The loop; the pendulum itself stands in for the hardware.
  for (int k = 0; k < 2000; ++k) {
    const double t = k * period;
    if (t < 0.5) {  // track q = 1 - cos 2t
      reference.q[0] = 1.0 - std::cos(2.0 * t);
      reference.qd[0] = 2.0 * std::sin(2.0 * t);
      reference.qdd[0] = 4.0 * std::cos(2.0 * t);
    } else {  // then somebody presses stop
      if (k == 500) stop.begin(reference.q, reference.qd);
      stop.advance(period, reference);
    }
    const Status status = law.update(state, reference, period, tau);
    if (status != Status::kOk) std::cout << t << " s: " << text(status) << "\n";

    const double acceleration = (tau[0] - 9.81 * std::cos(state.q[0])) / 0.5;
    state.qd[0] += acceleration * period;
    state.q[0] += state.qd[0] * period;
  }
  std::cout << "stopped at " << state.q[0] << " rad, " << reference.q[0] << " desired\n";
}
