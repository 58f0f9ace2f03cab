// SPDX-License-Identifier: Apache-2.0

/// @file
/// Robots and states to test laws of physics on, the same in every run.
///
///     forEachState([](const Chain& chain, const State<double>& state) { ... });

#pragma once

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>
#include <sstream>
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
  Eigen::VectorXd vector(Eigen::Index n) {
    return Eigen::VectorXd::NullaryExpr(n, [this] { return (*this)(); });
  }
  Eigen::Matrix3d rotation() {
    return Eigen::Quaterniond(Eigen::Vector4d(vector(4))).normalized().toRotationMatrix();
  }

 private:
  std::mt19937 engine_;
};

/// A body that can exist: six points with mass, about 2 kg and 0.2 m.
inline LinkParameters randomLink(Random& random) {
  LinkParameters link = LinkParameters::zero();
  const Eigen::Vector3d middle = 0.2 * random.vector3();
  for (int k = 0; k < 6; ++k) {
    const double mass = 0.35 + 0.2 * random();
    link += LinkParameters::fromCenterOfMass(mass, middle + 0.2 * random.vector3(),
                                             Eigen::Matrix3d::Zero());
  }
  return link;
}

/// Parameters as of an identified model: ten numbers of either sign, no body has them.
inline LinkParameters randomIdentifiedLink(Random& random) {
  return LinkParameters::fromVector(random.vector(10));
}

/// One for each joint of a chain; a Chain wants no negative mass.
inline std::vector<LinkParameters> randomIdentifiedLinks(Random& random, const Chain& chain) {
  std::vector<LinkParameters> links;
  for (Eigen::Index i = 0; i < chain.jointCount(); ++i) {
    links.push_back(randomIdentifiedLink(random));
    links.back().mass = std::abs(links.back().mass);
  }
  return links;
}

/// A set for each row, as in ParameterSets.
inline std::vector<std::vector<LinkParameters>> randomIdentifiedRows(const Chain& chain) {
  Random random(7);
  std::vector<std::vector<LinkParameters>> rows;
  for (Eigen::Index j = 0; j < chain.jointCount(); ++j) {
    rows.push_back(randomIdentifiedLinks(random, chain));
  }
  return rows;
}

/// Revolute, prismatic and continuous joints at any angle to one another, some with a rotor.
inline Chain randomChain(Eigen::Index n) {
  Random random(1000 + static_cast<std::uint32_t>(n));
  std::vector<Joint> joints;
  std::vector<LinkParameters> links;
  for (Eigen::Index i = 0; i < n; ++i) {
    Joint joint;
    joint.name = "joint" + std::to_string(i + 1);
    const double which = random();
    joint.type = which > 0.4    ? JointType::kPrismatic
                 : which > -0.6 ? JointType::kRevolute
                                : JointType::kContinuous;
    joint.placement = {random.rotation(), 0.4 * random.vector3()};
    joint.rotor_inertia = i % 2 == 0 ? 0.0 : 0.3 + 0.2 * random();
    joints.push_back(joint);
    links.push_back(randomLink(random));
  }
  return Chain("random" + std::to_string(n), joints, links, {1.0, -2.0, -9.0});
}

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

inline State<double> randomState(const Chain& chain, std::uint32_t seed) {
  Random random(seed);
  const Eigen::Index n = chain.jointCount();
  return {3.0 * random.vector(n), 2.0 * random.vector(n), 5.0 * random.vector(n)};
}

/// The state as it can be pasted into a test.
inline std::string paste(const Chain& chain, const State<double>& state) {
  const Eigen::IOFormat list(Eigen::FullPrecision, 0, ", ", ", ", "", "", "", ";");
  std::ostringstream text;
  text << "const Chain chain = randomChain(" << chain.jointCount() << ");\n"
       << "q << " << state.q.transpose().format(list) << "\n"
       << "qd << " << state.qd.transpose().format(list) << "\n"
       << "qdd << " << state.qdd.transpose().format(list);
  return text.str();
}

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
