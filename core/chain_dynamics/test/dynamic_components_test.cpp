// SPDX-License-Identifier: Apache-2.0

#include "chain_dynamics/dynamic_components.hpp"

#include <gtest/gtest.h>

#include "chain_dynamics/coriolis_vector.hpp"
#include "random_chains.hpp"

namespace chain_dynamics {
namespace {

using namespace test;  // NOLINT(google-build-using-namespace)

// The same operations, which a compiler may still round differently in another place.
TEST(DynamicComponents, AreWhatTheirOwnFunctionsGive) {
  forEachState([](const Chain& chain, const State<double>& state) {
    const Eigen::Index n = chain.jointCount();
    MatrixX<double> H(n, n);
    VectorX<double> c(n);
    VectorX<double> g(n);
    dynamicComponents(chain, state.q, state.qd, H, c, g);

    MatrixX<double> own_H(n, n);
    VectorX<double> own_c(n);
    VectorX<double> own_g(n);
    inertiaMatrix(chain, state.q, own_H);
    coriolisVector(chain, state.q, state.qd, own_c);
    gravityVector(chain, state.q, own_g);
    EXPECT_TRUE(agree(H, own_H, largest(H), rounding(chain)));
    EXPECT_TRUE(agree(c, own_c, largest(c), rounding(chain)));
    EXPECT_TRUE(agree(g, own_g, largest(g), rounding(chain)));
  });
}

}  // namespace
}  // namespace chain_dynamics
