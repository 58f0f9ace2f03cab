// SPDX-License-Identifier: Apache-2.0
#include "pinocchio_peer.hpp"

#include <benchmark/benchmark.h>

#include <memory>
#include <pinocchio/algorithm/crba.hpp>
#include <pinocchio/algorithm/rnea.hpp>
#include <pinocchio/multibody/data.hpp>
#include <pinocchio/multibody/model.hpp>
#include <pinocchio/parsers/urdf.hpp>

#include "states.hpp"
#include "timing.hpp"

namespace inverse_dynamics_benchmarks {
namespace {

struct Peer {
  explicit Peer(const std::string& urdf) {
    pinocchio::urdf::buildModelFromXML(urdf, model);
    data = std::make_unique<pinocchio::Data>(model);
    states = std::make_unique<States>(model.nv);
  }

  pinocchio::Model model;
  std::unique_ptr<pinocchio::Data> data;
  std::unique_ptr<States> states;
};

}  // namespace

void registerPinocchio(const std::string& robot, const std::string& urdf) {
  const auto peer = std::make_shared<Peer>(urdf);
  const auto add = [&](const char* quantity, auto call) {
    registerOverStates(robot + "/" + quantity + "/pinocchio",
                       [peer, call](Eigen::Index k) { call(*peer, k); });
  };
  add("torques", [](Peer& p, Eigen::Index k) {
    benchmark::DoNotOptimize(pinocchio::rnea(p.model, *p.data, p.states->q.col(k),
                                             p.states->qd.col(k), p.states->qdd.col(k))
                                 .data());
  });
  add("inertia", [](Peer& p, Eigen::Index k) {
    benchmark::DoNotOptimize(
        pinocchio::crba(p.model, *p.data, p.states->q.col(k), pinocchio::Convention::LOCAL).data());
  });
  add("coriolis", [](Peer& p, Eigen::Index k) {
    benchmark::DoNotOptimize(
        pinocchio::nonLinearEffects(p.model, *p.data, p.states->q.col(k), p.states->qd.col(k))
            .data());
  });
  add("gravity", [](Peer& p, Eigen::Index k) {
    benchmark::DoNotOptimize(
        pinocchio::computeGeneralizedGravity(p.model, *p.data, p.states->q.col(k)).data());
  });
}

}  // namespace inverse_dynamics_benchmarks
