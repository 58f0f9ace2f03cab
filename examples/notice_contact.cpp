// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <inverse_dynamics_control/inverse_dynamics_control.hpp>
#include <inverse_dynamics_solver/solver_loader.hpp>
#include <iostream>
#include <random>

using namespace inverse_dynamics_control;

// A mass of 2 kg, 0.5 m from a horizontal axis.
const char* const kPendulum = R"(<robot name="pendulum">
  <link name="base"/>
  <link name="arm"><inertial><origin xyz="0.5 0 0"/><mass value="2"/>
    <inertia ixx="0" ixy="0" ixz="0" iyy="0" iyz="0" izz="0"/></inertial></link>
  <joint name="hinge" type="continuous"><parent link="base"/><child link="arm"/><axis xyz="0 -1 0"/></joint>
</robot>)";

// The hardware: it goes to and fro; from 30 s on somebody holds it with 3 N m. An encoder with 2^19
// steps a turn, a torque sensor with noise of 0.1 N m.
struct Hardware {
  double time = 0.0;
  std::mt19937 random{0};

  double position(double t) const { return std::sin(2.0 * t); }
  double torque(double t) {
    const double acceleration = -4.0 * std::sin(2.0 * t), held = t > 30.0 ? 3.0 : 0.0;
    return 0.5 * acceleration + 9.81 * std::cos(position(t)) + held +
           std::normal_distribution<double>(0.0, 0.1)(random);
  }
  void read(double period, JointState& state, Eigen::VectorXd& effort) {
    effort[0] = torque(time + 0.5 * period);
    time += period;
    const double step = 2.0 * M_PI / (1 << 19);
    state.q[0] = step * std::round(position(time) / step);
  }
};

int main() {
  auto solver = inverse_dynamics_solver::SolverLoader().load(
      "rigid_body_inverse_dynamics_solver/InverseDynamicsSolverRigidBody");
  solver->initialize({}, "", kPendulum);
  const Eigen::Index n = solver->jointCount();
  Hardware hardware;

  // Before the loop: an estimator, and thresholds from twenty seconds without contact.
  const double period = 1e-3;  // s
  EstimatorOptions options;
  options.gain = Eigen::VectorXd::Constant(n, 60.0);  // 1/s
  MomentumObserver observer(solver, options);
  JointState state(n);
  Eigen::VectorXd effort(n);
  Eigen::MatrixXd quiet(n, 20000);
  for (int k = 0; k < quiet.cols();) {
    hardware.read(period, state, effort);
    const EstimateStatus status = observer.update(state, effort, period);
    if (status == EstimateStatus::kOk) quiet.col(k++) = observer.torques();
  }
  const ContactThresholds thresholds =
      contactThresholds(quiet, period, 1.0, solver->jointNames());  // 1 false alarm per hour
  ContactDetector detector(thresholds.torques, {}, solver->jointNames());
  std::cout.precision(2);
  std::cout << "threshold " << thresholds.torques[0] << " N m\n";

  // The loop.
  for (bool before = false; hardware.time < 40.0;) {
    hardware.read(period, state, effort);
    if (observer.update(state, effort, period) != EstimateStatus::kOk) continue;  // not known
    const bool contact = detector.update(observer.torques(), period);
    if (contact && !before) {
      std::cout << "contact " << std::round(1e3 * (hardware.time - 30.0)) << " ms after it began\n";
    }
    before = contact;
  }
  std::cout << observer.torques()[0] << " N m at the end\n";
}
