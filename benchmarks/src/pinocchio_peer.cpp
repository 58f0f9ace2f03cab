// SPDX-License-Identifier: Apache-2.0
#include <chain_dynamics/chain.hpp>
#include <memory>
#include <pinocchio/algorithm/aba.hpp>
#include <pinocchio/algorithm/crba.hpp>
#include <pinocchio/algorithm/jacobian.hpp>
#include <pinocchio/algorithm/regressor.hpp>
#include <pinocchio/algorithm/rnea-derivatives.hpp>
#include <pinocchio/algorithm/rnea.hpp>
#include <string>

#include "described_tree.hpp"
#include "peers.hpp"
#include "pinocchio_model.hpp"
#include "robots.hpp"
#include "states.hpp"
#include "timing.hpp"

namespace inverse_dynamics_benchmarks {
namespace {

struct PinocchioPeer {
  explicit PinocchioPeer(const pinocchio_inverse_dynamics_solver::Model& of)
      : model(of), data(model), states(model.nv) {}

  auto torques(Eigen::Index k) {
    return pinocchio::rnea(model, data, states.q.col(k), states.qd.col(k), states.qdd.col(k))
        .data();
  }
  auto inertia(Eigen::Index k) {
    return pinocchio::crba(model, data, states.q.col(k), pinocchio::Convention::LOCAL).data();
  }
  auto coriolis(Eigen::Index k) {  // and gravity: there is no call without it
    return pinocchio::nonLinearEffects(model, data, states.q.col(k), states.qd.col(k)).data();
  }
  auto gravity(Eigen::Index k) {
    return pinocchio::computeGeneralizedGravity(model, data, states.q.col(k)).data();
  }
  auto forwardDynamics(Eigen::Index k) {  // LOCAL is the faster convention
    return pinocchio::aba(model, data, states.q.col(k), states.qd.col(k), states.qdd.col(k),
                          pinocchio::Convention::LOCAL)
        .data();
  }
  auto regressor(Eigen::Index k) {
    return pinocchio::computeJointTorqueRegressor(model, data, states.q.col(k), states.qd.col(k),
                                                  states.qdd.col(k))
        .data();
  }
  auto derivatives(Eigen::Index k) {
    pinocchio::computeRNEADerivatives(model, data, states.q.col(k), states.qd.col(k),
                                      states.qdd.col(k));
    return data.dtau_dq.data();
  }
  auto coriolisMatrix(Eigen::Index k) {
    return pinocchio::computeCoriolisMatrix(model, data, states.q.col(k), states.qd.col(k)).data();
  }
  auto jacobian(Eigen::Index k) {  // in the root's origin, not the tip's
    return pinocchio::computeJointJacobians(model, data, states.q.col(k)).data();
  }

  pinocchio_inverse_dynamics_solver::Model model;
  pinocchio_inverse_dynamics_solver::Data data;
  States states;
};

}  // namespace

void registerPinocchio(const PeerRobot& robot) {
  using pinocchio_inverse_dynamics_solver::toPinocchio;
  auto model = robot.tree ? toPinocchio(*robot.tree) : toPinocchio(robot.chain);
  model.gravity.linear() = robot.chain.gravity();
  const auto peer = std::make_shared<PinocchioPeer>(model);
  peer->torques(0);
  requireSameTorques(robot, "Pinocchio", peer->data.tau);
  const auto add = [&](const char* quantity, auto call) {
    registerOverStates(robot.name + "/" + quantity + "/pinocchio",
                       [peer, call](Eigen::Index k) { call(*peer, k); });
  };
  using benchmark::DoNotOptimize;
  add("torques", [](PinocchioPeer& p, Eigen::Index k) { DoNotOptimize(p.torques(k)); });
  add("inertia", [](PinocchioPeer& p, Eigen::Index k) { DoNotOptimize(p.inertia(k)); });
  add("coriolis", [](PinocchioPeer& p, Eigen::Index k) { DoNotOptimize(p.coriolis(k)); });
  add("gravity", [](PinocchioPeer& p, Eigen::Index k) { DoNotOptimize(p.gravity(k)); });
  if (!isArm(robot.chain.jointCount())) return;
  add("forward_dynamics",
      [](PinocchioPeer& p, Eigen::Index k) { DoNotOptimize(p.forwardDynamics(k)); });
  add("regressor", [](PinocchioPeer& p, Eigen::Index k) { DoNotOptimize(p.regressor(k)); });
  add("derivatives", [](PinocchioPeer& p, Eigen::Index k) { DoNotOptimize(p.derivatives(k)); });
  add("coriolis_matrix",
      [](PinocchioPeer& p, Eigen::Index k) { DoNotOptimize(p.coriolisMatrix(k)); });
  add("tip_jacobian", [](PinocchioPeer& p, Eigen::Index k) { DoNotOptimize(p.jacobian(k)); });
}

std::string pinocchioVersion() { return PINOCCHIO_VERSION; }

}  // namespace inverse_dynamics_benchmarks
