// SPDX-License-Identifier: Apache-2.0

#include "fast_model_check.hpp"

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "chain_dynamics/error.hpp"
#include "chain_dynamics/regressor.hpp"
#include "chain_dynamics/tip_kinematics.hpp"

namespace chain_dynamics {
inline namespace v2 {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr Index kStates = 11;  // more than the widest pack has lanes
constexpr double kDifference =
    1e-8;  // of the largest entry: far above rounding, far below a mistake

/// All quantities of several states q = qd = qdd, those of each state beside those of the last one.
struct Quantities {
  Quantities(Index n, Index count)
      : tau(n, count),
        c(tau),
        g(tau),
        p(3, count),
        H(n, n * count),
        C(H),
        by_q(H),
        by_qd(H),
        by_qdd(H),
        Y(n, 10 * n * count),
        R(3, 3 * count),
        J(6, n * count),
        dJ(J) {}

  MatrixXd tau, c, g, p;
  MatrixXd H, C, by_q, by_qd, by_qdd;
  MatrixXd Y, R, J, dJ;
};

Quantities ofPlainFunctions(const Model& model, const MatrixXd& states) {
  const Index n = states.rows();
  const Chain& chain = model.chain;
  Quantities all(n, states.cols());
  VectorXd f(n);
  for (Index k = 0; k < states.cols(); ++k) {
    const VectorXd x = states.col(k);
    const auto of_state = [k](MatrixXd& all_states, Index columns) {
      return all_states.middleCols(k * columns, columns);
    };
    dynamicComponents(model, x, x, of_state(all.H, n), all.c.col(k), all.g.col(k));
    frictionVector(model, x, x, f);
    all.tau.col(k) = of_state(all.H, n) * x + all.c.col(k) + all.g.col(k) + f;
    coriolisMatrix(model, x, x, of_state(all.C, n));
    torqueDerivatives(model, x, x, x, of_state(all.by_q, n), of_state(all.by_qd, n),
                      of_state(all.by_qdd, n));
    addFrictionDerivatives(model, x, x, of_state(all.by_q, n), of_state(all.by_qd, n));
    regressor(chain, x, x, x, of_state(all.Y, 10 * n));
    const Transform<double> tip = tipPose(chain, x);
    of_state(all.R, 3) = tip.R;
    all.p.col(k) = tip.p;
    tipJacobian(chain, x, of_state(all.J, n));
    tipJacobianDerivative(chain, x, x, of_state(all.dJ, n));
  }
  return all;
}

Quantities ofSingleStates(const FastModel& fast, const MatrixXd& states) {
  const Index n = states.rows();
  Quantities all(n, states.cols());
  for (Index k = 0; k < states.cols(); ++k) {
    const double* const x = states.col(k).data();
    const auto of_state = [k](MatrixXd& all_states, Index columns) {
      return all_states.col(k * columns).data();
    };
    fast.torques(x, x, x, all.tau.col(k).data());
    fast.dynamicComponents(x, x, of_state(all.H, n), n, all.c.col(k).data(), all.g.col(k).data());
    fast.coriolisMatrix(x, x, of_state(all.C, n), n);
    fast.torqueDerivatives(x, x, x, of_state(all.by_q, n), of_state(all.by_qd, n),
                           of_state(all.by_qdd, n), n);
    fast.regressor(x, x, x, of_state(all.Y, 10 * n), n);
    fast.tipPose(x, of_state(all.R, 3), all.p.col(k).data());
    fast.tipJacobian(x, of_state(all.J, n), 6);
    fast.tipJacobianDerivative(x, x, of_state(all.dJ, n), 6);
  }
  return all;
}

Quantities ofBatch(const FastModel& fast, const MatrixXd& x) {
  Quantities all(x.rows(), x.cols());
  fast.torquesBatch(x, x, x, all.tau);
  fast.dynamicComponentsBatch(x, x, all.H, all.c, all.g);
  fast.coriolisMatrixBatch(x, x, all.C);
  fast.torqueDerivativesBatch(x, x, x, all.by_q, all.by_qd, all.by_qdd);
  fast.regressorBatch(x, x, x, all.Y);
  fast.tipPoseBatch(x, all.R, all.p);
  fast.tipJacobianBatch(x, all.J);
  fast.tipJacobianDerivativeBatch(x, x, all.dJ);
  return all;
}

/// Entry by entry, by the largest of `plain` of these members: entries may cancel. False for NaN.
template <class... Members>
bool near(const Quantities& fast, const Quantities& plain, Members... members) {
  double largest = 0;
  ((largest += (plain.*members).cwiseAbs().maxCoeff()), ...);
  return (((fast.*members - plain.*members).array().abs() <= kDifference * largest).all() && ...);
}

bool near(const Quantities& fast, const Quantities& plain) {
  using Q = Quantities;
  return near(fast, plain, &Q::tau, &Q::c, &Q::g, &Q::H, &Q::C, &Q::by_q, &Q::by_qd, &Q::by_qdd) &&
         near(fast, plain, &Q::Y) && near(fast, plain, &Q::R, &Q::p, &Q::J, &Q::dJ);
}

}  // namespace

bool equalsPlain(const FastModel& fast, const Model& model) {
  const VectorXd q = VectorXd::LinSpaced(model.chain.jointCount(), 0.3, 2.9);
  MatrixXd states = q.replicate(1, kStates);
  states.rowwise() += Eigen::RowVectorXd::LinSpaced(kStates, 0.0, 1.0);
  const Quantities plain = ofPlainFunctions(model, states);
  return near(ofSingleStates(fast, states), plain) && near(ofBatch(fast, states), plain);
}

Choice bestEqual(const std::string& model, const std::vector<std::string>& sets,
                 const std::function<bool(std::size_t)>& equals) {
  Choice choice{sets.size(), {}};
  while (choice.index-- > 0) {
    if (equals(choice.index)) return choice;
    choice.warnings.push_back("fast model of " + model + ": instruction set " + sets[choice.index] +
                              " isn't used: its numbers differ from those of the plain functions");
  }
  throw ModelError("fast model of " + model, "numbers",
                   "finite ones, equal to those of the plain functions",
                   "others, or none, on each of " + joined(sets),
                   "look for lengths, masses and gains that are too large");
}

}  // namespace v2
}  // namespace chain_dynamics
