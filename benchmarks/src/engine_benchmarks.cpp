// SPDX-License-Identifier: Apache-2.0
#include "engine_benchmarks.hpp"

#include <chain_dynamics/fast_model.hpp>
#include <memory>

#include "states.hpp"
#include "timing.hpp"

namespace inverse_dynamics_benchmarks {
namespace {

struct Engine {
  explicit Engine(const chain_dynamics::Chain& chain)
      : fast(chain_dynamics::Model(chain)),
        n(chain.jointCount()),
        states(n),
        qdd(n),
        dtau_dq(n, n),
        dtau_dqd(n, n),
        dtau_dqdd(n, n),
        Y(n, 10 * n) {}

  void forwardDynamics(Eigen::Index k) {
    fast.forwardDynamics(&states.q(0, k), &states.qd(0, k), &states.qdd(0, k), qdd.data());
  }
  void regressor(Eigen::Index k) {
    fast.regressor(&states.q(0, k), &states.qd(0, k), &states.qdd(0, k), Y.data(), n);
  }
  void derivatives(Eigen::Index k) {
    fast.torqueDerivatives(&states.q(0, k), &states.qd(0, k), &states.qdd(0, k), dtau_dq.data(),
                           dtau_dqd.data(), dtau_dqdd.data(), n);
  }

  chain_dynamics::FastModel fast;
  Eigen::Index n;
  States states;
  Eigen::VectorXd qdd;
  Eigen::MatrixXd dtau_dq, dtau_dqd, dtau_dqdd, Y;
};

}  // namespace

void registerEngine(const std::string& robot, const chain_dynamics::Chain& chain) {
  const auto engine = std::make_shared<Engine>(chain);
  const auto add = [&](const char* quantity, void (Engine::*call)(Eigen::Index)) {
    registerOverStates(robot + "/" + quantity + "/ours", [engine, call](Eigen::Index k) {
      (*engine.*call)(k);
      benchmark::ClobberMemory();
    });
  };
  add("forward_dynamics", &Engine::forwardDynamics);
  add("regressor", &Engine::regressor);
  add("derivatives", &Engine::derivatives);
}

}  // namespace inverse_dynamics_benchmarks
