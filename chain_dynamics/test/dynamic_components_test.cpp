// SPDX-License-Identifier: Apache-2.0

#include "chain_dynamics/dynamic_components.hpp"

#include <gtest/gtest.h>

#include "chain_dynamics/coriolis_vector.hpp"
#include "random_chains.hpp"

namespace chain_dynamics {
namespace {

using namespace test;  // NOLINT(google-build-using-namespace)

template <typename Scalar>
class DynamicComponentsOf : public ::testing::Test {};
using Scalars = ::testing::Types<double, float>;
TYPED_TEST_SUITE(DynamicComponentsOf, Scalars, );

// The same operations, which a compiler may still round differently in another place.
TYPED_TEST(DynamicComponentsOf, AnyRobotAreWhatTheirOwnFunctionsGive) {
  using Scalar = TypeParam;
  forEachState<Scalar>([](const Chain& chain, const State<Scalar>& state) {
    const Eigen::Index n = chain.jointCount();
    MatrixX<Scalar> H(n, n);
    VectorX<Scalar> c(n);
    VectorX<Scalar> g(n);
    dynamicComponents(chain, state.q, state.qd, H, c, g);

    MatrixX<Scalar> own_H(n, n);
    VectorX<Scalar> own_c(n);
    VectorX<Scalar> own_g(n);
    inertiaMatrix(chain, state.q, own_H);
    coriolisVector(chain, state.q, state.qd, own_c);
    gravityVector(chain, state.q, own_g);
    EXPECT_TRUE(agree(H, own_H, largest(H), rounding<Scalar>(chain)));
    EXPECT_TRUE(agree(c, own_c, largest(c), rounding<Scalar>(chain)));
    EXPECT_TRUE(agree(g, own_g, largest(g), rounding<Scalar>(chain)));
  });
}

}  // namespace
}  // namespace chain_dynamics
