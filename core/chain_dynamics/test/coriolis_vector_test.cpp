// SPDX-License-Identifier: Apache-2.0

#include "chain_dynamics/coriolis_vector.hpp"

#include <gtest/gtest.h>

#include "chain_dynamics/dual.hpp"
#include "chain_dynamics/inertia_matrix.hpp"
#include "lagrange.hpp"
#include "random_chains.hpp"

namespace chain_dynamics {
namespace {

using namespace test;  // NOLINT(google-build-using-namespace)

VectorX<double> coriolisOf(const Chain& chain, const VectorX<double>& q,
                           const VectorX<double>& qd) {
  VectorX<double> c(chain.jointCount());
  coriolisVector(chain, q, qd, c);
  return c;
}

// dH/dt along the motion.
MatrixX<double> rateOfInertia(const Chain& chain, const State<double>& state) {
  MatrixX<Dual<double, 1>> H(chain.jointCount(), chain.jointCount());
  inertiaMatrix(chain, moving<double>(state.q, state.qd), H);
  return H.unaryExpr([](const Dual<double, 1>& x) { return x.derivative[0]; });
}

// The size of the terms that the Coriolis torques are the sum of, cancelling or not.
double coriolisTermsOf(const Chain& chain, const State<double>& state) {
  const MatrixX<double> rate = rateOfInertia(chain, state);
  return largest(rate.cwiseAbs() * state.qd.cwiseAbs()) +
         largest(coriolisOf(chain, state.q, state.qd));
}

TEST(CoriolisVector, IsThatOfLagrangesEquation) {
  forEachState([](const Chain& chain, const State<double>& state) {
    State<double> unaccelerated = state;
    unaccelerated.qdd.setZero();
    EXPECT_TRUE(agree(coriolisOf(chain, state.q, state.qd),
                      lagrangeOfKineticEnergy(chain, unaccelerated), coriolisTermsOf(chain, state),
                      rounding(chain)));
  });
}

}  // namespace
}  // namespace chain_dynamics
