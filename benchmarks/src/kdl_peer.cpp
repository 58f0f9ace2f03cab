// SPDX-License-Identifier: Apache-2.0
#include <benchmark/benchmark.h>
#include <kdl/config.h>

#include <chain_dynamics/chain.hpp>
#include <cstddef>
#include <kdl/chaindynparam.hpp>
#include <kdl/chainidsolver_recursive_newton_euler.hpp>
#include <kdl/chainjnttojacsolver.hpp>
#include <kdl/frames.hpp>
#include <kdl/jntarray.hpp>
#include <memory>
#include <string>
#include <vector>

#include "kdl_chain.hpp"
#include "peers.hpp"
#include "robots.hpp"
#include "states.hpp"
#include "timing.hpp"

namespace inverse_dynamics_benchmarks {
namespace {

std::vector<KDL::JntArray> columns(const Eigen::MatrixXd& matrix) {
  std::vector<KDL::JntArray> arrays;
  for (Eigen::Index k = 0; k < matrix.cols(); ++k) {
    arrays.emplace_back(static_cast<unsigned>(matrix.rows()));
    arrays.back().data = matrix.col(k);
  }
  return arrays;
}

struct KdlPeer {
  explicit KdlPeer(const chain_dynamics::Chain& robot)
      : chain(kdl_inverse_dynamics_solver::toKdl(robot)),
        rne(chain, kdl_inverse_dynamics_solver::toKdl(robot.gravity())),
        components(chain, kdl_inverse_dynamics_solver::toKdl(robot.gravity())),
        jacobian(chain),
        forces(chain.getNrOfSegments(), KDL::Wrench::Zero()),
        H(chain.getNrOfJoints()),
        c(chain.getNrOfJoints()),
        g(chain.getNrOfJoints()),
        tau(chain.getNrOfJoints()),
        J(chain.getNrOfJoints()) {
    const States states(robot.jointCount());
    q = columns(states.q);
    qd = columns(states.qd);
    qdd = columns(states.qdd);
  }

  KDL::Chain chain;  // before the solvers that keep a reference to it
  KDL::ChainIdSolver_RNE rne;
  KDL::ChainDynParam components;
  KDL::ChainJntToJacSolver jacobian;
  KDL::Wrenches forces;
  std::vector<KDL::JntArray> q, qd, qdd;
  KDL::JntSpaceInertiaMatrix H;
  KDL::JntArray c, g, tau;
  KDL::Jacobian J;
};

}  // namespace

void registerKdl(const PeerRobot& robot) {
  const auto peer = std::make_shared<KdlPeer>(robot.chain);
  peer->rne.CartToJnt(peer->q[0], peer->qd[0], peer->qdd[0], peer->forces, peer->tau);
  requireSameTorques(robot, "KDL", peer->tau.data);
  const auto add = [&](const char* quantity, auto call) {
    registerOverStates(robot.name + "/" + quantity + "/kdl", [peer, call](Eigen::Index k) {
      call(*peer, static_cast<std::size_t>(k));
      benchmark::ClobberMemory();
    });
  };
  add("torques", [](KdlPeer& p, std::size_t k) {
    p.rne.CartToJnt(p.q[k], p.qd[k], p.qdd[k], p.forces, p.tau);
  });
  add("inertia", [](KdlPeer& p, std::size_t k) { p.components.JntToMass(p.q[k], p.H); });
  add("coriolis",
      [](KdlPeer& p, std::size_t k) { p.components.JntToCoriolis(p.q[k], p.qd[k], p.c); });
  add("gravity", [](KdlPeer& p, std::size_t k) { p.components.JntToGravity(p.q[k], p.g); });
  add("components", [](KdlPeer& p, std::size_t k) {
    p.components.JntToMass(p.q[k], p.H);
    p.components.JntToCoriolis(p.q[k], p.qd[k], p.c);
    p.components.JntToGravity(p.q[k], p.g);
  });
  if (!isArm(robot.chain.jointCount())) return;
  add("tip_jacobian", [](KdlPeer& p, std::size_t k) { p.jacobian.JntToJac(p.q[k], p.J); });
}

std::string kdlVersion() { return KDL_VERSION_STRING; }

}  // namespace inverse_dynamics_benchmarks
