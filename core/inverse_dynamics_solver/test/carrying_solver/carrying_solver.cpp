// SPDX-License-Identifier: Apache-2.0
#include "carrying_solver.hpp"

#include <chrono>
#include <cmath>
#include <functional>
#include <memory>
#include <pluginlib/class_list_macros.hpp>
#include <string>
#include <thread>
#include <utility>

namespace carrying_solver {
namespace {

constexpr double kMass = 2.0, kLength = 0.5;  // kg, m

double gravityTorque(const Pendulum& pendulum, double q) {
  const double s = std::sin(q), c = std::cos(q);
  const Eigen::Vector3d& g = pendulum.gravity;
  return pendulum.along * (g.x() * c - g.z() * s) - pendulum.across * (g.x() * s + g.z() * c);
}

}  // namespace

auto CarryingSolver::configure(const Configuration& configuration) -> JointInfo {
  fault_ = configuration.get<std::string>("fault").value_or("");
  auto conditions = readConditions(configuration, configuration.gravity);
  if (has("parameters state no body")) {
    conditions = std::make_shared<const Conditions>(Conditions{{}, conditions->base});
  }
  auto pendulum = robotUnder(*conditions);
  JointInfo info;
  info.joint_names = {"pivot"};
  configuration.rejectOthers();

  // Keep; nothing below can throw.
  beginWith(std::move(pendulum), std::move(conditions));
  return info;
}

auto CarryingSolver::robotUnder(const Conditions& conditions) const
    -> std::unique_ptr<const Pendulum> {
  const int change = ++changes_;
  auto body = conditions.payload();
  Eigen::Vector3d gravity = conditions.base.apparentGravity();
  if (has("bodies interact")) body.mass *= body.mass;
  if (has("bodies leave a trace")) body.mass += 1e-9 * change;
  if (has("inertia of a body is negative")) body.inertia(1, 1) -= 100.0 * body.mass;
  if (has("the base accelerates backwards")) gravity += 2.0 * conditions.base.acceleration;

  // At q = 0 the rod points to -z, and the direction across it to -x.
  const double z = body.first_moment.z();
  const double inertia =
      body.inertia(1, 1) - 2.0 * kLength * z + (kMass + body.mass) * kLength * kLength;
  return std::make_unique<const Pendulum>(
      Pendulum{inertia, (kMass + body.mass) * kLength - z, -body.first_moment.x(), gravity});
}

void CarryingSolver::computeInertiaMatrix(const ConstVectorRef&, MatrixRef H) const {
  H(0, 0) = currentRobot()->inertia;
}

void CarryingSolver::computeCoriolisVector(const ConstVectorRef&, const ConstVectorRef& qd,
                                           VectorRef c) const {
  c = 0.0 * qd;
}

void CarryingSolver::computeGravityVector(const ConstVectorRef& q, VectorRef g) const {
  const auto pendulum = currentRobot();
  g[0] = gravityTorque(*pendulum, q[0]);
  if ((has("allocates with a body") && pendulum->along != kMass * kLength) ||
      (has("allocates while the robot changes") && changes_ > 20)) {
    g = Eigen::VectorXd(g + g) / 2.0;
  }
}

void CarryingSolver::computeTorques(const ConstVectorRef& q, const ConstVectorRef& qd,
                                    const ConstVectorRef& qdd, VectorRef tau) const {
  if (has("a call mixes two robots")) {
    tau[0] = currentRobot()->inertia * qdd[0];
    std::this_thread::yield();
    tau[0] += gravityTorque(*currentRobot(), q[0]);
    return;
  }
  // Others get a chance to change the robot; of a large batch now and then.
  if (has("states of a batch mix two robots")) std::this_thread::yield();
  if (has("threads of a batch mix two robots") && ++calls_ % 1024 == 0) {
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  const auto pendulum = currentRobot();
  tau[0] = pendulum->inertia * qdd[0] + 0.0 * qd[0] + gravityTorque(*pendulum, q[0]);
}

void CarryingSolver::computeDynamicComponents(const ConstVectorRef& q, const ConstVectorRef& qd,
                                              MatrixRef H, VectorRef c, VectorRef g) const {
  const auto pendulum = currentRobot();
  H(0, 0) = pendulum->inertia;
  c = 0.0 * qd;
  g[0] = gravityTorque(*pendulum, q[0]);
}

void CarryingSolver::whileUnchanged(const std::function<void()>& compute) const {
  if (has("states of a batch mix two robots") || has("threads of a batch mix two robots")) {
    return compute();
  }
  ChangeableRobot::whileUnchanged(compute);
}

}  // namespace carrying_solver

PLUGINLIB_EXPORT_CLASS(carrying_solver::CarryingSolver,
                       inverse_dynamics_solver::InverseDynamicsSolver)
