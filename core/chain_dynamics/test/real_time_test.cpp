// SPDX-License-Identifier: Apache-2.0

// The promises of every docstring: any scalar, no allocation, any number of threads; NaN stays NaN.

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <new>
#include <thread>
#include <vector>

#include "allocation_guard.hpp"
#include "chain_dynamics/coriolis_matrix.hpp"
#include "chain_dynamics/coriolis_vector.hpp"
#include "chain_dynamics/dual.hpp"
#include "chain_dynamics/dynamic_components.hpp"
#include "chain_dynamics/energy.hpp"
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
  explicit Everything(const State<Scalar>& x)
      : state(x),
        tau(x.q.size()),
        c(tau),
        g(tau),
        c_of_all(tau),
        g_of_all(tau),
        H(tau.size(), tau.size()),
        dtau_dq(H),
        dtau_dqd(H),
        dtau_dqdd(H),
        H_of_all(H),
        C(H),
        J(6, tau.size()),
        dJ(J),
        Y(tau.size(), 10 * tau.size()) {}

  void compute(const Chain& chain) {
    const auto& [q, qd, a] = state;
    torques(chain, q, qd, a, tau);
    inertiaMatrix(chain, q, H);
    coriolisVector(chain, q, qd, c);
    gravityVector(chain, q, g);
    dynamicComponents(chain, q, qd, H_of_all, c_of_all, g_of_all);
    coriolisMatrix(chain, q, qd, C);
    tipJacobian(chain, q, J);
    tipJacobianDerivative(chain, q, qd, dJ);
    tip = tipPose(chain, q);
    regressor(chain, q, qd, a, Y);
    torqueDerivatives(chain, q, qd, a, dtau_dq, dtau_dqd, dtau_dqdd);
    kinetic = kineticEnergy(chain, q, qd);
    potential = potentialEnergy(chain, q);
  }

  // What takes parameter sets, with them.
  void compute(const Chain& chain, const ParameterSets& sets) {
    const auto& [q, qd, a] = state;
    torques(chain, sets, q, qd, a, tau);
    inertiaMatrix(chain, sets, q, H);
    coriolisVector(chain, sets, q, qd, c);
    coriolisMatrix(chain, sets, q, qd, C);
    gravityVector(chain, sets, q, g);
    dynamicComponents(chain, sets, q, qd, H_of_all, c_of_all, g_of_all);
    torqueDerivatives(chain, sets, q, qd, a, dtau_dq, dtau_dqd, dtau_dqdd);
  }

  // All results, each as a matrix.
  std::vector<MatrixX<Scalar>> results() const {
    return {tau,
            c,
            g,
            c_of_all,
            g_of_all,
            H,
            dtau_dq,
            dtau_dqd,
            dtau_dqdd,
            H_of_all,
            C,
            J,
            dJ,
            Y,
            tip.R,
            tip.p,
            MatrixX<Scalar>::Constant(1, 1, kinetic),
            MatrixX<Scalar>::Constant(1, 1, potential)};
  }

  State<Scalar> state;
  VectorX<Scalar> tau, c, g, c_of_all, g_of_all;
  MatrixX<Scalar> H, dtau_dq, dtau_dqd, dtau_dqdd, H_of_all, C, J, dJ, Y;
  Transform<Scalar> tip;
  Scalar kinetic, potential;
};

// Whether numbers in float are those of the same state in double.
void expectSame(const Chain& chain, const Everything<float>& a, const Everything<double>& b) {
  const double tolerance = rounding<float>(chain);
  const auto close = [&](const auto& x, const auto& y, double scale) {
    return agree(x.template cast<double>(), y, scale, tolerance);
  };
  const double terms = largest(b.H.cwiseAbs() * b.state.qdd.cwiseAbs() +
                               b.C.cwiseAbs() * b.state.qd.cwiseAbs() + b.g.cwiseAbs());
  EXPECT_TRUE(close(a.tau, b.tau, terms)) << "tau";
  EXPECT_TRUE(close(a.c, b.c, terms)) << "c";
  EXPECT_TRUE(close(a.g, b.g, terms)) << "g";
  EXPECT_TRUE(close(a.H, b.H, largest(b.H))) << "H";
  EXPECT_TRUE(close(a.c_of_all, b.c, terms)) << "c of all components";
  EXPECT_TRUE(close(a.g_of_all, b.g, terms)) << "g of all components";
  EXPECT_TRUE(close(a.H_of_all, b.H, largest(b.H))) << "H of all components";
  EXPECT_TRUE(close(a.dtau_dqdd, b.H, largest(b.H))) << "dtau/dqdd";
  EXPECT_TRUE(close(a.C, b.C, 3 * largest(b.C))) << "C";
  EXPECT_TRUE(close(a.dtau_dq, b.dtau_dq, largest(b.dtau_dq))) << "dtau/dq";
  EXPECT_TRUE(close(a.dtau_dqd, b.dtau_dqd, largest(b.dtau_dqd))) << "dtau/dqd";
}

TEST(Scalars, FloatGivesWhatDoubleGives) {
  forEachState([](const Chain& chain, const State<double>& state) {
    const double tolerance = rounding<float>(chain);
    Everything<float> a(state.cast<float>());
    Everything<double> b(a.state.cast<double>());
    a.compute(chain);
    b.compute(chain);
    expectSame(chain, a, b);
    EXPECT_TRUE(agree(a.Y.cast<double>(), b.Y, largest(b.Y), tolerance));
    EXPECT_TRUE(agree(a.J.cast<double>(), b.J, largest(b.J), tolerance));
    EXPECT_TRUE(agree(a.dJ.cast<double>(), b.dJ, largest(b.dJ) + 1, tolerance));
    EXPECT_TRUE(agree(a.tip.p.cast<double>(), b.tip.p, largest(b.J) + 1, tolerance));
    EXPECT_TRUE(agree(a.tip.R.cast<double>(), b.tip.R, 1, tolerance));
    EXPECT_NEAR(a.kinetic, b.kinetic, tolerance * b.kinetic);
    EXPECT_NEAR(a.potential, b.potential,
                tolerance * (b.g.cwiseAbs().sum() + std::abs(b.potential)));

    const auto rows = randomIdentifiedRows(chain);
    a.compute(chain, ParameterSets{rows, rows[0]});
    b.compute(chain, ParameterSets{rows, rows[0]});
    expectSame(chain, a, b);
  });
}

template <typename Scalar>
class RealTime : public ::testing::Test {};
using AllScalars = ::testing::Types<double, float, Dual<double, 3>>;
TYPED_TEST_SUITE(RealTime, AllScalars, );

TYPED_TEST(RealTime, NoAlgorithmAllocatesUpToSixtyFourJoints) {
  if (!kAllocationGuardWorks) {
    GTEST_SKIP() << "allocations are counted with the GNU C library, without sanitizers";
  }
  for (const Eigen::Index n : {1, 6, 7, 64}) {
    const Chain chain = randomChain(n);
    const auto rows = randomIdentifiedRows(chain);
    Everything<TypeParam> everything(randomState(chain, 1).cast<TypeParam>());
    const AllocationGuard guard;
    everything.compute(chain);
    everything.compute(chain, ParameterSets{rows, rows[0]});
    EXPECT_EQ(guard.count(), 0) << n << " joints";
  }
}

TEST(AllocationGuard, SeesTheAllocationsOfALongerChain) {
  if (!kAllocationGuardWorks) {
    GTEST_SKIP() << "allocations are counted with the GNU C library, without sanitizers";
  }
  const Chain chain = randomChain(65);
  const auto rows = randomIdentifiedRows(chain);
  Everything<double> everything(randomState(chain, 1));
  const AllocationGuard guard;
  everything.compute(chain);
  EXPECT_GT(guard.count(), 0);
}

TEST(AllocationGuard, SeesEigenAndNew) {
  if (!kAllocationGuardWorks) {
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
  const auto rows = randomIdentifiedRows(chain);
  const ParameterSets sets{rows, rows[0]};
  Everything<double> alone(randomState(chain, 1));
  alone.compute(chain);
  alone.compute(chain, sets);

  std::vector<Everything<double>> results(8, Everything<double>(alone.state));
  std::vector<std::thread> threads;
  threads.reserve(results.size());
  for (Everything<double>& result : results) {
    threads.emplace_back([&chain, &sets, &result] {
      for (int k = 0; k < 200; ++k) {
        result.compute(chain);
        result.compute(chain, sets);
      }
    });
  }
  for (std::thread& thread : threads) {
    thread.join();
  }
  for (const Everything<double>& result : results) EXPECT_EQ(result.results(), alone.results());
}

TEST(NotANumber, GoesToEveryEntryThatDependsOnIt) {
  constexpr double kRounding = 1e-12;  // a derivative may be that, instead of zero
  const Chain chain = randomChain(6);
  const State<double> x = randomState(chain, 0);
  for (const int input : {0, 1, 2}) {
    for (Eigen::Index i = 0; i < chain.jointCount(); ++i) {
      Everything<Dual<double, 1>> varied(x.cast<Dual<double, 1>>());
      Everything<double> spoilt(x);
      auto& [q, qd, qdd] = varied.state;
      (input == 0 ? q : input == 1 ? qd : qdd)[i].derivative[0] = 1;
      auto& [nan_q, nan_qd, nan_qdd] = spoilt.state;
      (input == 0 ? nan_q : input == 1 ? nan_qd : nan_qdd)[i] = std::nan("");
      varied.compute(chain);
      spoilt.compute(chain);
      const auto derivatives = varied.results();
      const auto values = spoilt.results();
      for (std::size_t k = 0; k < values.size(); ++k) {
        for (Eigen::Index entry = 0; entry < values[k].size(); ++entry) {
          const double derivative = derivatives[k](entry).derivative[0];
          EXPECT_TRUE(std::abs(derivative) < kRounding || std::isnan(values[k](entry)))
              << "entry " << entry << " of result " << k << " by input " << input << " of " << i;
        }
      }
    }
  }
}

}  // namespace
}  // namespace chain_dynamics
