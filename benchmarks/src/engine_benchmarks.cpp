// SPDX-License-Identifier: Apache-2.0
#include "engine_benchmarks.hpp"

#include <benchmark/benchmark.h>

#include <chain_dynamics/chain.hpp>
#include <chain_dynamics/fast_model.hpp>
#include <chain_dynamics/model.hpp>
#include <chain_dynamics/regressor_gram.hpp>
#include <chain_dynamics/spatial.hpp>
#include <chain_dynamics/states.hpp>
#include <memory>
#include <string>

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
        Y(n, 10 * n),
        C(n, n),
        J(6, n),
        qdd_block(n, kBlock),
        dtau_dq_block(n, n * kBlock),
        dtau_dqd_block(n, n * kBlock),
        dtau_dqdd_block(n, n * kBlock),
        Y_block(n, 10 * n * kBlock),
        C_block(n, n * kBlock),
        J_block(6, n * kBlock),
        sums(n) {}

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
  void coriolisMatrix(Eigen::Index k) {
    fast.coriolisMatrix(&states.q(0, k), &states.qd(0, k), C.data(), n);
  }
  void tipPose(Eigen::Index k) { fast.tipPose(&states.q(0, k), tip.R.data(), tip.p.data()); }
  void tipJacobian(Eigen::Index k) { fast.tipJacobian(&states.q(0, k), J.data(), 6); }
  void tipJacobianDerivative(Eigen::Index k) {
    fast.tipJacobianDerivative(&states.q(0, k), &states.qd(0, k), J.data(), 6);
  }

  void forwardDynamicsBatch() {
    fast.forwardDynamicsBatch(q(), qd(), states.qdd.leftCols(kBlock), qdd_block);
  }
  void regressorBatch() { fast.regressorBatch(q(), qd(), states.qdd.leftCols(kBlock), Y_block); }
  void derivativesBatch() {
    fast.torqueDerivativesBatch(q(), qd(), states.qdd.leftCols(kBlock), dtau_dq_block,
                                dtau_dqd_block, dtau_dqdd_block);
  }
  void coriolisMatrixBatch() { fast.coriolisMatrixBatch(q(), qd(), C_block); }
  void tipPoseBatch() { fast.tipPoseBatch(q(), R_block, p_block); }
  void tipJacobianBatch() { fast.tipJacobianBatch(q(), J_block); }
  void tipJacobianDerivativeBatch() { fast.tipJacobianDerivativeBatch(q(), qd(), J_block); }
  void gram() {
    const Eigen::MatrixXd& tau = states.qdd;  // any numbers
    fast.addToGram({q(), qd(), states.qdd.leftCols(kBlock), tau.leftCols(kBlock)}, sums);
  }

  chain_dynamics::ConstStates q() const { return states.q.leftCols(kBlock); }
  chain_dynamics::ConstStates qd() const { return states.qd.leftCols(kBlock); }

  /// States of a batch whose results stay in the cache.
  static constexpr Eigen::Index kBlock = 64;

  chain_dynamics::FastModel fast;
  Eigen::Index n;
  States states;
  Eigen::VectorXd qdd;
  Eigen::MatrixXd dtau_dq, dtau_dqd, dtau_dqdd, Y, C, J;
  chain_dynamics::Transform<double> tip;
  Eigen::MatrixXd qdd_block, dtau_dq_block, dtau_dqd_block, dtau_dqdd_block, Y_block, C_block;
  Eigen::MatrixXd J_block, R_block{3, 3 * kBlock}, p_block{3, kBlock};
  chain_dynamics::RegressorGram sums;
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
  add("coriolis_matrix", &Engine::coriolisMatrix);
  add("tip_pose", &Engine::tipPose);
  add("tip_jacobian", &Engine::tipJacobian);
  add("tip_jacobian_derivative", &Engine::tipJacobianDerivative);

  const auto add_batch = [&](const char* quantity, void (Engine::*call)()) {
    registerBatch(robot + "/" + quantity + "/ours", Engine::kBlock, [engine, call] {
      (*engine.*call)();
      benchmark::ClobberMemory();
    });
  };
  add_batch("forward_dynamics_batch", &Engine::forwardDynamicsBatch);
  add_batch("regressor_batch", &Engine::regressorBatch);
  add_batch("derivatives_batch", &Engine::derivativesBatch);
  add_batch("coriolis_matrix_batch", &Engine::coriolisMatrixBatch);
  add_batch("tip_pose_batch", &Engine::tipPoseBatch);
  add_batch("tip_jacobian_batch", &Engine::tipJacobianBatch);
  add_batch("tip_jacobian_derivative_batch", &Engine::tipJacobianDerivativeBatch);
  add_batch("gram_batch", &Engine::gram);
}

}  // namespace inverse_dynamics_benchmarks
