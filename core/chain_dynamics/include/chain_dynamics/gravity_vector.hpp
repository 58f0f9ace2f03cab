// SPDX-License-Identifier: Apache-2.0

/// @file
/// Gravity torques: what holds the robot still.
///
///     Eigen::VectorXd g(chain.jointCount());
///     gravityVector(chain, q, g);

#pragma once

#include <Eigen/Core>
#include <cassert>
#include <cstddef>
#include <vector>

#include "chain_dynamics/kinematics.hpp"
#include "chain_dynamics/parameter_sets.hpp"

namespace chain_dynamics {
inline namespace v2 {
namespace internal {

// A heavy point: all that gravity sees of a body, stated in a frame.
template <typename Scalar>
struct HeavyPoint {
  Scalar mass;
  Vector3<Scalar> first_moment;

  static HeavyPoint zero() { return {Scalar(0), Vector3<Scalar>::Zero()}; }

  void add(const LinkParameters& link) {
    mass += Scalar(link.mass);
    first_moment += link.first_moment.template cast<Scalar>();
  }

  // mc_A = R mc_B + m p
  friend HeavyPoint operator*(const Transform<Scalar>& X_AB, const HeavyPoint& point) {
    return {point.mass, X_AB.R * point.first_moment + X_AB.p * point.mass};
  }

  // The force that gives it the acceleration a: (mc x a, m a).
  Force<Scalar> forceFor(const Vector3<Scalar>& a) const {
    return {first_moment.cross(a), a * mass};
  }
};

// Rows first..n-1 of the gravity torques with one parameter set.
// Link i and all links after it hang on joint i as one heavy point.
template <typename Scalar, typename G>
void gravityOfPoses(const Chain& chain, const std::vector<LinkParameters>& links,
                    const Scratch<Transform<Scalar>>& X, const Scratch<Vector3<Scalar>>& a,
                    Eigen::Index first, G& g) {
  HeavyPoint<Scalar> point = HeavyPoint<Scalar>::zero();
  for (Eigen::Index i = chain.jointCount() - 1; i >= first; --i) {
    point.add(links[static_cast<std::size_t>(i)]);

    // g = S' (mc x a, m a)
    g[i] = alongAxis(joint(chain, i), point.forceFor(a[i]));

    // on to the parent link
    if (i > first) point = X[i] * point;
  }
}

// The gravity torques, row j with set j, or all with the set for gravity.
template <typename Sets, typename Scalar, typename G>
void gravityOfPoses(const Chain& chain, const Sets& sets, const Scratch<Transform<Scalar>>& X,
                    const Scratch<Vector3<Scalar>>& a, G& g) {
  if (const auto* own = gravitySet(sets)) return gravityOfPoses(chain, *own, X, a, 0, g);
  forEachSet(chain, sets, [&](const std::vector<LinkParameters>& links, Eigen::Index first) {
    gravityOfPoses(chain, links, X, a, first, g);
  });
}

}  // namespace internal

/// Gravity torques: `g(q)`, the gradient of the potential energy.
///
/// The recursion of torques.hpp at rest, where it needs no more than mass and first moment of what
/// hangs on each joint, O(n).
///
/// @tparam Scalar  (of q, g) float, double or a dual number.
/// @param sets     ParameterSets [parameter_sets.hpp]; left out: chain.links().
/// @param q        n; rad (prismatic m); order of chain.jointNames().
/// @param[out] g   n; N m (prismatic N).
/// Real time (up to 64 joints): no allocation, lock, exception or system call. Threads: safe.
template <typename Sets, typename Q, typename G>
void gravityVector(const Chain& chain, const Sets& sets, const Eigen::MatrixBase<Q>& q,
                   const Eigen::MatrixBase<G>& g) {
  using Scalar = typename Q::Scalar;
  const Eigen::Index n = chain.jointCount();
  assert(g.size() == n && internal::haveSizesOf(chain, sets));
  Scratch<Transform<Scalar>> X(n);
  Scratch<Vector3<Scalar>> a(n);

  internal::linkPoses(chain, q, X);
  internal::gravityInLinks(chain, X, a);
  internal::gravityOfPoses(chain, sets, X, a, g.const_cast_derived());
}
template <typename Q, typename G>
void gravityVector(const Chain& chain, const Eigen::MatrixBase<Q>& q,
                   const Eigen::MatrixBase<G>& g) {
  gravityVector(chain, internal::OwnParameters(), q, g);
}

}  // namespace v2
}  // namespace chain_dynamics
