// SPDX-License-Identifier: Apache-2.0

// The promises at the end of every docstring: no allocation, and any number of threads.

#include <gtest/gtest.h>

#include <new>
#include <thread>
#include <vector>

#include "allocation_guard.hpp"
#include "chain_dynamics/coriolis_matrix.hpp"
#include "chain_dynamics/coriolis_vector.hpp"
#include "chain_dynamics/dual.hpp"
#include "chain_dynamics/dynamic_components.hpp"
#include "chain_dynamics/energy.hpp"
#include "chain_dynamics/forward_dynamics.hpp"
#include "chain_dynamics/parameter_sets.hpp"
#include "chain_dynamics/regressor.hpp"
#include "chain_dynamics/tip_kinematics.hpp"
#include "chain_dynamics/torque_derivatives.hpp"
#include "random_chains.hpp"

namespace chain_dynamics {
namespace {

using namespace test;  // NOLINT(google-build-using-namespace)

// Every algorithm once, into memory that is there.
template <typename Scalar>
struct Everything {
  explicit Everything(const Chain& chain)
      : state(randomState<double>(chain, 1).cast<Scalar>()),
        tau(chain.jointCount()),
        c(chain.jointCount()),
        g(chain.jointCount()),
        qdd(chain.jointCount()),
        H(chain.jointCount(), chain.jointCount()),
        dtau_dq(H),
        dtau_dqd(H),
        C(H),
        J(6, chain.jointCount()),
        dJ(J),
        Y(chain.jointCount(), 10 * chain.jointCount()) {}

  void compute(const Chain& chain, const ParameterSets& sets) {
    const auto& [q, qd, a] = state;
    torques(chain, q, qd, a, tau);
    inertiaMatrix(chain, q, H);
    coriolisVector(chain, q, qd, c);
    gravityVector(chain, q, g);
    dynamicComponents(chain, q, qd, H, c, g);
    forwardDynamics(chain, q, qd, tau, qdd);
    coriolisMatrix(chain, q, qd, C);
    tipJacobian(chain, q, J);
    tipJacobianDerivative(chain, q, qd, dJ);
    tip = tipPose(chain, q);
    regressor(chain, q, qd, a, Y);
    torqueDerivatives(chain, q, qd, a, dtau_dq, dtau_dqd, H);
    energy = kineticEnergy(chain, q, qd) + potentialEnergy(chain, q);
    torques(chain, sets, q, qd, a, tau);
    inertiaMatrix(chain, sets, q, H);
    coriolisVector(chain, sets, q, qd, c);
    coriolisMatrix(chain, sets, q, qd, C);
    gravityVector(chain, sets, q, g);
    dynamicComponents(chain, sets, q, qd, H, c, g);
    torqueDerivatives(chain, sets, q, qd, a, dtau_dq, dtau_dqd, H);
  }

  State<Scalar> state;
  VectorX<Scalar> tau, c, g, qdd;
  MatrixX<Scalar> H, dtau_dq, dtau_dqd, C, J, dJ, Y;
  Transform<Scalar> tip;
  Scalar energy;
};

// A chain's own parameters, a set for each row.
std::vector<std::vector<LinkParameters>> rowsOf(const Chain& chain) {
  return {static_cast<std::size_t>(chain.jointCount()), chain.links()};
}

template <typename Scalar>
class RealTime : public ::testing::Test {};
using Scalars = ::testing::Types<double, float, Dual<double, 3>>;
TYPED_TEST_SUITE(RealTime, Scalars, );

TYPED_TEST(RealTime, NoAlgorithmAllocatesUpToSixtyFourJoints) {
  if (!CHAIN_DYNAMICS_COUNTS_ALLOCATIONS) {
    GTEST_SKIP() << "allocations are counted with the GNU C library, without sanitizers";
  }
  for (const Eigen::Index n : {1, 6, 7, 64}) {
    const Chain chain = randomChain(n);
    const auto rows = rowsOf(chain);
    Everything<TypeParam> everything(chain);
    const AllocationGuard guard;
    everything.compute(chain, ParameterSets{rows, rows[0]});
    EXPECT_EQ(guard.count(), 0) << n << " joints";
  }
}

TEST(AllocationGuard, SeesTheAllocationsOfALongerChain) {
  if (!CHAIN_DYNAMICS_COUNTS_ALLOCATIONS) {
    GTEST_SKIP() << "allocations are counted with the GNU C library, without sanitizers";
  }
  const Chain chain = randomChain(65);
  const auto rows = rowsOf(chain);
  Everything<double> everything(chain);
  const AllocationGuard guard;
  everything.compute(chain, ParameterSets{rows, rows[0]});
  EXPECT_GT(guard.count(), 0);
}

TEST(AllocationGuard, SeesEigenAndNew) {
  if (!CHAIN_DYNAMICS_COUNTS_ALLOCATIONS) {
    GTEST_SKIP() << "allocations are counted with the GNU C library, without sanitizers";
  }
  const AllocationGuard eigen;
  const Eigen::VectorXd vector = Eigen::VectorXd::Ones(100);
  EXPECT_GE(eigen.count(), 1) << vector.sum();
  const AllocationGuard standard;
  ::operator delete(::operator new(1));  // by its name: Clang leaves out an unused new-expression
  EXPECT_GE(standard.count(), 1);
}

TEST(Threads, GiveTheSameNumbersAsOneAlone) {
  const Chain chain = randomChain(7);
  const auto rows = rowsOf(chain);
  const ParameterSets sets{rows, rows[0]};
  Everything<double> alone(chain);
  alone.compute(chain, sets);

  std::vector<Everything<double>> results(8, Everything<double>(chain));
  std::vector<std::thread> threads;
  for (Everything<double>& result : results) {
    threads.emplace_back([&chain, &sets, &result] {
      for (int k = 0; k < 200; ++k) {
        result.compute(chain, sets);
      }
    });
  }
  for (std::thread& thread : threads) {
    thread.join();
  }
  for (const Everything<double>& result : results) {
    EXPECT_EQ(result.tau, alone.tau);
    EXPECT_EQ(result.H, alone.H);
    EXPECT_EQ(result.dtau_dq, alone.dtau_dq);
    EXPECT_EQ(result.dtau_dqd, alone.dtau_dqd);
    EXPECT_EQ(result.C, alone.C);
    EXPECT_EQ(result.J, alone.J);
    EXPECT_EQ(result.dJ, alone.dJ);
    EXPECT_EQ(result.tip.p, alone.tip.p);
    EXPECT_EQ(result.c, alone.c);
    EXPECT_EQ(result.g, alone.g);
    EXPECT_EQ(result.qdd, alone.qdd);
    EXPECT_EQ(result.Y, alone.Y);
    EXPECT_EQ(result.energy, alone.energy);
  }
}

}  // namespace
}  // namespace chain_dynamics
