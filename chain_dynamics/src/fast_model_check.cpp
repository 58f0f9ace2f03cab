// SPDX-License-Identifier: Apache-2.0

#include "fast_model_check.hpp"

#include "chain_dynamics/regressor.hpp"

namespace chain_dynamics {
inline namespace v2 {
namespace {

// Entry by entry: the largest of numbers of which one is NaN may be any of them.
bool near(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
  return ((a - b).array().abs() <= 1e-9 * (1 + b.cwiseAbs().maxCoeff())).all();
}

// One state.
bool torquesEqual(const FastModel& fast, const Model& model, const Eigen::VectorXd& q) {
  const Eigen::Index n = q.size();
  Eigen::MatrixXd H(n, n), fast_H(n, n);
  Eigen::VectorXd c(n), g(n), f(n), fast_tau(n);
  dynamicComponents(model, q, q, H, c, g);
  frictionVector(model, q, f);
  fast.inertiaMatrix(q.data(), fast_H.data(), n);
  fast.torques(q.data(), q.data(), q.data(), fast_tau.data());
  return near(fast_H, H) && near(fast_tau, H * q + c + g + f);
}

// More states than the widest pack has lanes, each another one: none may get a neighbour's numbers.
bool batchesEqual(const FastModel& fast, const Model& model, const Eigen::VectorXd& q) {
  constexpr Eigen::Index kStates = 11;
  const Eigen::Index n = q.size();
  Eigen::MatrixXd states = q.replicate(1, kStates);
  states.rowwise() += Eigen::RowVectorXd::LinSpaced(kStates, 0.0, 1.0);
  Eigen::MatrixXd fast_H(n, n * kStates);
  Eigen::MatrixXd fast_tau(n, kStates), fast_c(n, kStates), fast_g(n, kStates);
  fast.torquesBatch(states, states, states, fast_tau);
  fast.dynamicComponentsBatch(states, states, fast_H, fast_c, fast_g);

  Eigen::MatrixXd H(n, n);
  Eigen::VectorXd c(n), g(n), f(n);
  for (Eigen::Index k = 0; k < kStates; ++k) {
    const Eigen::VectorXd state = states.col(k);
    dynamicComponents(model, state, state, H, c, g);
    frictionVector(model, state, f);
    if (!near(fast_tau.col(k), H * state + c + g + f) || !near(fast_c.col(k), c) ||
        !near(fast_g.col(k), g) || !near(fast_H.middleCols(k * n, n), H)) {
      return false;
    }
  }
  return true;
}

bool derivativesEqual(const FastModel& fast, const Model& model, const Eigen::VectorXd& q) {
  const Eigen::Index n = q.size();
  Eigen::MatrixXd by_q(n, n), by_qd(n, n), by_qdd(n, n);
  Eigen::VectorXd slope(n);
  torqueDerivatives(model, q, q, q, by_q, by_qd, by_qdd);
  frictionSlopes(model, q, slope);
  by_qd.diagonal() += slope;

  Eigen::MatrixXd fast_by_q(n, n), fast_by_qd(n, n), fast_by_qdd(n, n);
  fast.torqueDerivatives(q.data(), q.data(), q.data(), fast_by_q.data(), fast_by_qd.data(),
                         fast_by_qdd.data(), n);
  return near(fast_by_q, by_q) && near(fast_by_qd, by_qd) && near(fast_by_qdd, by_qdd);
}

bool regressorsEqual(const FastModel& fast, const Chain& chain, const Eigen::VectorXd& q) {
  const Eigen::Index n = q.size();
  Eigen::MatrixXd Y(n, 10 * n), fast_Y(n, 10 * n);
  regressor(chain, q, q, q, Y);
  fast.regressor(q.data(), q.data(), q.data(), fast_Y.data(), n);
  return near(fast_Y, Y);
}

}  // namespace

bool equalsPlain(const FastModel& fast, const Model& model) {
  const Eigen::VectorXd q = Eigen::VectorXd::LinSpaced(model.chain.jointCount(), 0.3, 2.9);
  return torquesEqual(fast, model, q) && batchesEqual(fast, model, q) &&
         derivativesEqual(fast, model, q) && regressorsEqual(fast, model.chain, q);
}

}  // namespace v2
}  // namespace chain_dynamics
