// SPDX-License-Identifier: Apache-2.0

/// @file
/// Robots and states to test laws of physics on, the same in every run.
///
///     forEachState([](const Chain& chain, const State<double>& state) { ... });

#pragma once

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cstdint>
#include <limits>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "chain_dynamics/chain.hpp"

namespace chain_dynamics::test {

template <typename Scalar>
using VectorX = Eigen::Matrix<Scalar, Eigen::Dynamic, 1>;
template <typename Scalar>
using MatrixX = Eigen::Matrix<Scalar, Eigen::Dynamic, Eigen::Dynamic>;

/// Numbers between -1 and 1; the standard's distributions differ from library to library.
class Random {
 public:
  explicit Random(std::uint32_t seed) : engine_(seed) {}

  double operator()() { return 2.0 * engine_() / 4294967295.0 - 1.0; }
  Eigen::Vector3d vector3() { return {(*this)(), (*this)(), (*this)()}; }
  Eigen::VectorXd vector(Eigen::Index n);
  Eigen::Matrix3d rotation();

 private:
  std::mt19937 engine_;
};

/// A body that can exist: six points with mass, about 2 kg and 0.2 m.
LinkParameters randomLink(Random& random);

/// Parameters as of an identified model: ten numbers of either sign, no body has them.
LinkParameters randomIdentifiedLink(Random& random);

/// One for each joint of a chain; a Chain wants no negative mass.
std::vector<LinkParameters> randomIdentifiedLinks(Random& random, const Chain& chain);

/// A set for each row, as in ParameterSets.
std::vector<std::vector<LinkParameters>> randomIdentifiedRows(const Chain& chain);

/// Revolute, prismatic and continuous joints at any angle to one another, some with a rotor.
Chain randomChain(Eigen::Index n);

/// Positions of any angle, velocities and accelerations of usual size.
template <typename Scalar>
struct State {
  VectorX<Scalar> q, qd, qdd;

  /// The same numbers, as constants of another type.
  template <typename Other>
  State<Other> cast() const {
    return {q.template cast<Other>(), qd.template cast<Other>(), qdd.template cast<Other>()};
  }
};

State<double> randomState(const Chain& chain, std::uint32_t seed);

/// The state as it can be pasted into a test.
std::string paste(const Chain& chain, const State<double>& state);

/// Calls check(chain, state) for chains of 1 to 9 joints and one of 70 (beyond the stack).
template <typename Check>
void forEachState(const Check& check) {
  for (const Eigen::Index n : {1, 2, 3, 4, 5, 6, 7, 8, 9, 70}) {
    const Chain chain = randomChain(n);
    for (std::uint32_t seed = 0; seed < 5; ++seed) {
      const State<double> state = randomState(chain, seed);
      SCOPED_TRACE(paste(chain, state));
      check(chain, state);
      if (::testing::Test::HasFailure()) {
        return;  // one state is enough to look at
      }
    }
  }
}

/// Rounding that two ways to the same number may differ by, relative to the largest term in it.
///
/// Each of n joints adds some tens of operations, each off by at most half a unit in the last
/// place and most of them in either direction: 10 n units. (Measured: up to 3 n.)
template <typename Scalar = double>
Scalar rounding(const Chain& chain) {
  return Scalar(10) * static_cast<Scalar>(chain.jointCount()) *
         std::numeric_limits<Scalar>::epsilon();
}

/// Whether two vectors or matrices agree to a tolerance relative to scale, and if not, where.
template <typename A, typename B>
::testing::AssertionResult agree(const A& a, const B& b, double scale, double tolerance) {
  const double difference = static_cast<double>((a.eval() - b.eval()).cwiseAbs().maxCoeff());
  if (difference <= tolerance * scale) {  // a NaN isn't
    return ::testing::AssertionSuccess();
  }
  return ::testing::AssertionFailure()
         << "difference " << difference << ", allowed " << tolerance * scale << "\nfirst:\n"
         << a << "\nsecond:\n"
         << b;
}

/// The largest entry.
template <typename Derived>
double largest(const Eigen::MatrixBase<Derived>& matrix) {
  return static_cast<double>(matrix.cwiseAbs().maxCoeff());
}

}  // namespace chain_dynamics::test
