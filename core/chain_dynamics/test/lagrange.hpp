// SPDX-License-Identifier: Apache-2.0

/// @file
/// The equation of motion from energies alone: an oracle that shares no recursion of forces.
///
///     tau_i = d/dt (dT/dqd_i) - dT/dq_i + dU/dq_i        (Lagrange)
///
/// with all derivatives by dual numbers, exact to rounding.

#pragma once

#include <Eigen/Core>

#include "chain_dynamics/chain.hpp"
#include "chain_dynamics/dual.hpp"
#include "chain_dynamics/energy.hpp"
#include "random_chains.hpp"

namespace chain_dynamics::test {

/// A vector that moves: its derivative by time is rate.
template <typename Scalar>
VectorX<Dual<Scalar, 1>> moving(const VectorX<Scalar>& value, const VectorX<Scalar>& rate) {
  VectorX<Dual<Scalar, 1>> result = value.template cast<Dual<Scalar, 1>>();
  for (Eigen::Index i = 0; i < value.size(); ++i) {
    result[i].derivative[0] = rate[i];
  }
  return result;
}

/// A vector of which entry i is the variable to differentiate by.
template <typename Scalar>
VectorX<Dual<Scalar, 1>> variable(const VectorX<Scalar>& value, Eigen::Index i) {
  return moving<Scalar>(value, VectorX<Scalar>::Unit(value.size(), i));
}

/// `dU/dq`: gravity torques.
inline VectorX<double> gradientOfPotentialEnergy(const Chain& chain, const VectorX<double>& q) {
  VectorX<double> gradient(q.size());
  for (Eigen::Index i = 0; i < q.size(); ++i) {
    gradient[i] = potentialEnergy(chain, variable(q, i)).derivative[0];
  }
  return gradient;
}

/// `d/dt (dT/dqd) - dT/dq`: torques without gravity.
inline VectorX<double> lagrangeOfKineticEnergy(const Chain& chain, const State<double>& state) {
  using Rate = Dual<double, 1>;  // inner direction: time
  using Both = Dual<Rate, 1>;    // outer direction: qd_i
  const VectorX<Rate> q = moving<double>(state.q, state.qd);
  const VectorX<Rate> qd = moving<double>(state.qd, state.qdd);
  const VectorX<Rate> constant_qd = state.qd.cast<Rate>();

  VectorX<double> tau(state.q.size());
  for (Eigen::Index i = 0; i < tau.size(); ++i) {
    const Both T = kineticEnergy(chain, q.cast<Both>().eval(), variable(qd, i));
    const Rate dT_dq = kineticEnergy(chain, variable(state.q, i), constant_qd);
    tau[i] = T.derivative[0].derivative[0] - dT_dq.derivative[0];
  }
  return tau;
}

}  // namespace chain_dynamics::test
