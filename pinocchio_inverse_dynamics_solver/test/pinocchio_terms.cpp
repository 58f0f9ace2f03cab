// SPDX-License-Identifier: Apache-2.0
#include "pinocchio_terms.hpp"

#include <pinocchio/algorithm/aba.hpp>
#include <pinocchio/algorithm/crba.hpp>
#include <pinocchio/algorithm/regressor.hpp>
#include <pinocchio/algorithm/rnea-derivatives.hpp>
#include <pinocchio/algorithm/rnea.hpp>

#include "pinocchio_model.hpp"

namespace pinocchio_inverse_dynamics_solver {

PinocchioTerms pinocchioTerms(const chain_dynamics::Chain& chain, const Eigen::VectorXd& q,
                              const Eigen::VectorXd& qd, const Eigen::VectorXd& qdd,
                              const Eigen::VectorXd& tau) {
  const Model model = toPinocchio(chain);
  Data data(model);
  PinocchioTerms terms;
  terms.nq = model.nq;
  terms.torques = pinocchio::rnea(model, data, q, qd, qdd);
  terms.inertia = pinocchio::crba(model, data, q).triangularView<Eigen::Upper>();
  terms.regressor = pinocchio::computeJointTorqueRegressor(model, data, q, qd, qdd);
  terms.qdd = pinocchio::aba(model, data, q, qd, tau, pinocchio::Convention::LOCAL);
  pinocchio::computeRNEADerivatives(model, data, q, qd, qdd);
  terms.dtau_dq = data.dtau_dq;
  terms.dtau_dqd = data.dtau_dv;
  return terms;
}

}  // namespace pinocchio_inverse_dynamics_solver
