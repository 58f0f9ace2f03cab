// SPDX-License-Identifier: Apache-2.0

/// @file
/// Dynamics of a robot whose rows have parameters of their own: what identified models are.
///
///     const ParameterSets sets{row_parameters, gravity_parameters};
///     torques(chain, sets, q, qd, qdd, tau);   // row j with set j, gravity with its own
///
/// An identified robot need not be *one* system of rigid bodies. Where each joint was identified by
/// itself, row j of the torque has its own ten parameters per link; where gravity was identified
/// apart, gravity has. Every row is still that of some system of rigid bodies, and is computed as
/// such: kinematics depend on no parameter and are shared, then the recursion goes from the tip
/// down to joint j with parameter set j. O(n^2) for all rows.
///
/// Such an H need be neither symmetric nor positive definite: row j is that of the j-th system.
///
/// Real time (up to 64 joints): no allocation, lock, exception or system call. Threads: safe.

#pragma once

#include <Eigen/Core>
#include <vector>

#include "chain_dynamics/coriolis_matrix.hpp"
#include "chain_dynamics/gravity_vector.hpp"
#include "chain_dynamics/inertia_matrix.hpp"
#include "chain_dynamics/kinematics.hpp"
#include "chain_dynamics/torque_derivatives.hpp"
#include "chain_dynamics/torques.hpp"

namespace chain_dynamics {
inline namespace v2 {

/// Which inertial parameters each quantity is made of. A view: the vectors must outlive it.
struct ParameterSets {
  /// Empty: chain.links() for every row. Otherwise n sets of n links, and row j uses rows[j].
  const std::vector<std::vector<LinkParameters>>& rows;

  /// Empty: the row's own. Otherwise n links, whose masses and first moments are those of gravity,
  /// in every row.
  const std::vector<LinkParameters>& gravity;
};

/// Rejects sets that don't fit a chain: wrong number of sets or links, non-finite numbers.
///
/// Any finite parameters will do, negative masses too: in an identified set a single figure has no
/// physical meaning. Call it once, when reading; the functions below only assert the sizes.
///
/// @throws ModelError  naming set and joint.
void checkParameterSets(const Chain& chain, const ParameterSets& sets);

namespace internal {

inline bool haveSizesOf(const Chain& chain, const ParameterSets& sets) {
  const std::size_t n = chain.joints().size();
  return (sets.rows.empty() || sets.rows.size() == n) &&
         (sets.gravity.empty() || sets.gravity.size() == n);
}

// compute(links, first) gives rows first to n - 1 of a matrix or vector; row j is to be that of set j.
template <typename Compute>
void forEachSet(const Chain& chain, const ParameterSets& sets, const Compute& compute) {
  if (sets.rows.empty()) return compute(chain.links(), Eigen::Index{0});
  // set j gives rows j to n - 1, of which set j + 1 then overwrites all but row j
  for (Eigen::Index j = 0; j < chain.jointCount(); ++j) {
    compute(sets.rows[static_cast<std::size_t>(j)], j);
  }
}

// Torques of the links' motion, row j with set j.
template <typename Scalar, typename Tau>
void rowTorques(const Chain& chain, const ParameterSets& sets, const Scratch<Transform<Scalar>>& X,
                const Scratch<Motion<Scalar>>& V, const Scratch<Motion<Scalar>>& A, Tau& tau) {
  forEachSet(chain, sets, [&](const std::vector<LinkParameters>& links, Eigen::Index first) {
    torquesOfMotion(chain, links, X, V, A, first, tau);
  });
}

// Gravity torques, row j with set j or all with the set for gravity.
template <typename Scalar, typename G>
void rowGravity(const Chain& chain, const ParameterSets& sets, const Scratch<Transform<Scalar>>& X,
                const Scratch<Vector3<Scalar>>& a, G& g) {
  if (!sets.gravity.empty()) return gravityOfPoses(chain, sets.gravity, X, a, 0, g);
  forEachSet(chain, sets, [&](const std::vector<LinkParameters>& links, Eigen::Index first) {
    gravityOfPoses(chain, links, X, a, first, g);
  });
}

// Row j of the inertia matrix with one parameter set, O(n).
template <typename Scalar, typename MatrixH>
void inertiaRow(const Chain& chain, const std::vector<LinkParameters>& links,
                const Scratch<Transform<Scalar>>& X, Eigen::Index j, MatrixH& H) {
  const Eigen::Index n = chain.jointCount();

  // joint j moves by one unit, and carries along every link after it
  Scratch<Motion<Scalar>> S_j(n);
  S_j[j] = axisMotion<Scalar>(joint(chain, j));
  for (Eigen::Index i = j + 1; i < n; ++i) {
    S_j[i] = X[i].inverseTimes(S_j[i - 1]);
  }

  // the joints after it, H_ji = S_i' I_c S_j, where I_c is link i and all after it
  SpatialInertia<Scalar> I_c = SpatialInertia<Scalar>::zero();
  for (Eigen::Index i = n - 1; i >= j; --i) {
    I_c += link<Scalar>(links, i);
    H(j, i) = alongAxis(joint(chain, i), I_c * S_j[i]);
    if (i > j) {
      I_c = X[i] * I_c;
    }
  }
  H(j, j) += Scalar(joint(chain, j).rotor_inertia);

  // the joints before it hold against the force that joint j needs
  Force<Scalar> F = timesAxis(I_c, joint(chain, j));
  for (Eigen::Index i = j; i > 0; --i) {
    F = X[i] * F;
    H(j, i - 1) = alongAxis(joint(chain, i - 1), F);
  }
}

// The inertia matrix, row j with set j.
template <typename Scalar, typename MatrixH>
void rowInertia(const Chain& chain, const ParameterSets& sets, const Scratch<Transform<Scalar>>& X,
                MatrixH& H) {
  if (sets.rows.empty()) {
    inertiaOfPoses(chain, chain.links(), X, H);
    return;
  }
  for (Eigen::Index j = 0; j < chain.jointCount(); ++j) {
    inertiaRow(chain, sets.rows[static_cast<std::size_t>(j)], X, j, H);
  }
}

}  // namespace internal

/// Joint torques of a given motion, as torques(chain, q, qd, qdd, tau), with these parameters.
template <typename Q, typename Qd, typename Qdd, typename Tau>
void torques(const Chain& chain, const ParameterSets& sets, const Eigen::MatrixBase<Q>& q,
             const Eigen::MatrixBase<Qd>& qd, const Eigen::MatrixBase<Qdd>& qdd,
             const Eigen::MatrixBase<Tau>& tau) {
  using Scalar = typename Q::Scalar;
  const Eigen::Index n = chain.jointCount();
  assert(tau.size() == n && internal::haveSizesOf(chain, sets));
  Scratch<Transform<Scalar>> X(n);
  Scratch<Motion<Scalar>> V(n);
  Scratch<Motion<Scalar>> A(n);
  Scratch<Scalar> rotor(n);
  Tau& output = tau.const_cast_derived();

  // gravity is either a part of the motion, or comes on top with its own parameters
  const bool own_gravity = !sets.gravity.empty();
  const Eigen::Vector3d gravity = own_gravity ? Eigen::Vector3d::Zero().eval() : chain.gravity();
  internal::linkPoses(chain, q, X);
  internal::linkVelocities(chain, X, qd, V);
  internal::linkAccelerations(chain, X, V, qd, qdd, gravity, A);
  internal::rotorTorques(chain, qdd, rotor);

  internal::rowTorques(chain, sets, X, V, A, output);
  internal::addTo(output, rotor);
  if (own_gravity) {
    Scratch<Vector3<Scalar>> a(n);
    Scratch<Scalar> g(n);
    internal::gravityInLinks(chain, X, a);
    internal::rowGravity(chain, sets, X, a, g);
    internal::addTo(output, g);
  }
}

/// Joint-space inertia matrix, as inertiaMatrix(chain, q, H), with these parameters: row j with
/// set j, so in general not symmetric.
template <typename Q, typename MatrixH>
void inertiaMatrix(const Chain& chain, const ParameterSets& sets, const Eigen::MatrixBase<Q>& q,
                   const Eigen::MatrixBase<MatrixH>& H) {
  using Scalar = typename Q::Scalar;
  assert(H.rows() == chain.jointCount() && H.cols() == chain.jointCount());
  assert(internal::haveSizesOf(chain, sets));
  Scratch<Transform<Scalar>> X(chain.jointCount());
  internal::linkPoses(chain, q, X);
  internal::rowInertia(chain, sets, X, H.const_cast_derived());
}

/// Coriolis and centrifugal torques, as coriolisVector(chain, q, qd, c), with these parameters.
template <typename Q, typename Qd, typename C>
void coriolisVector(const Chain& chain, const ParameterSets& sets, const Eigen::MatrixBase<Q>& q,
                    const Eigen::MatrixBase<Qd>& qd, const Eigen::MatrixBase<C>& c) {
  using Scalar = typename Q::Scalar;
  const Eigen::Index n = chain.jointCount();
  assert(c.size() == n && internal::haveSizesOf(chain, sets));
  Scratch<Transform<Scalar>> X(n);
  Scratch<Motion<Scalar>> V(n);
  Scratch<Motion<Scalar>> A(n);
  internal::linkPoses(chain, q, X);
  internal::linkVelocities(chain, X, qd, V);
  internal::velocityAccelerations(chain, X, V, qd, A);
  internal::rowTorques(chain, sets, X, V, A, c.const_cast_derived());
}

/// Coriolis matrix, as coriolisMatrix(chain, q, qd, C), with these parameters: row j with set j, so
/// that `dH/dt = C + C'` holds for one set only.
template <typename Q, typename Qd, typename MatrixC>
void coriolisMatrix(const Chain& chain, const ParameterSets& sets, const Eigen::MatrixBase<Q>& q,
                    const Eigen::MatrixBase<Qd>& qd, const Eigen::MatrixBase<MatrixC>& C) {
  using Scalar = typename Q::Scalar;
  const Eigen::Index n = chain.jointCount();
  assert(C.rows() == n && C.cols() == n && internal::haveSizesOf(chain, sets));
  Scratch<Transform<Scalar>> X(n);
  Scratch<Motion<Scalar>> V(n);
  internal::linkPoses(chain, q, X);
  internal::linkVelocities(chain, X, qd, V);
  internal::forEachSet(
      chain, sets, [&](const std::vector<LinkParameters>& links, Eigen::Index first) {
        internal::coriolisOfMotion(chain, links, X, V, first, C.const_cast_derived());
      });
}

/// Gravity torques, as gravityVector(chain, q, g), with these parameters.
template <typename Q, typename G>
void gravityVector(const Chain& chain, const ParameterSets& sets, const Eigen::MatrixBase<Q>& q,
                   const Eigen::MatrixBase<G>& g) {
  using Scalar = typename Q::Scalar;
  const Eigen::Index n = chain.jointCount();
  assert(g.size() == n && internal::haveSizesOf(chain, sets));
  Scratch<Transform<Scalar>> X(n);
  Scratch<Vector3<Scalar>> a(n);
  internal::linkPoses(chain, q, X);
  internal::gravityInLinks(chain, X, a);
  internal::rowGravity(chain, sets, X, a, g.const_cast_derived());
}

/// Inertia matrix, Coriolis and gravity torques, as dynamicComponents(chain, q, qd, H, c, g), with
/// these parameters.
template <typename Q, typename Qd, typename MatrixH, typename C, typename G>
void dynamicComponents(const Chain& chain, const ParameterSets& sets, const Eigen::MatrixBase<Q>& q,
                       const Eigen::MatrixBase<Qd>& qd, const Eigen::MatrixBase<MatrixH>& H,
                       const Eigen::MatrixBase<C>& c, const Eigen::MatrixBase<G>& g) {
  using Scalar = typename Q::Scalar;
  const Eigen::Index n = chain.jointCount();
  assert(H.rows() == n && H.cols() == n && c.size() == n && g.size() == n);
  assert(internal::haveSizesOf(chain, sets));
  Scratch<Transform<Scalar>> X(n);
  Scratch<Motion<Scalar>> V(n);
  Scratch<Motion<Scalar>> A(n);
  Scratch<Vector3<Scalar>> a(n);
  internal::linkPoses(chain, q, X);
  internal::linkVelocities(chain, X, qd, V);
  internal::velocityAccelerations(chain, X, V, qd, A);
  internal::gravityInLinks(chain, X, a);

  internal::rowInertia(chain, sets, X, H.const_cast_derived());
  internal::rowTorques(chain, sets, X, V, A, c.const_cast_derived());
  internal::rowGravity(chain, sets, X, a, g.const_cast_derived());
}

/// Derivatives of the joint torques, as torqueDerivatives(chain, q, qd, qdd, dtau_dq, dtau_dqd,
/// dtau_dqdd), with these parameters.
template <typename Q, typename Qd, typename Qdd, typename MatrixQ, typename MatrixQd,
          typename MatrixH>
void torqueDerivatives(const Chain& chain, const ParameterSets& sets, const Eigen::MatrixBase<Q>& q,
                       const Eigen::MatrixBase<Qd>& qd, const Eigen::MatrixBase<Qdd>& qdd,
                       const Eigen::MatrixBase<MatrixQ>& dtau_dq,
                       const Eigen::MatrixBase<MatrixQd>& dtau_dqd,
                       const Eigen::MatrixBase<MatrixH>& dtau_dqdd) {
  using Scalar = typename Q::Scalar;
  const Eigen::Index n = chain.jointCount();
  assert(internal::haveSizesOf(chain, sets));
  Scratch<Transform<Scalar>> X(n);
  Scratch<Motion<Scalar>> V(n);
  Scratch<Motion<Scalar>> A(n);
  const auto out = internal::derivativeMatrices(chain, dtau_dq, dtau_dqd, dtau_dqdd);

  // gravity is either a part of the motion, or comes on top with its own parameters
  const bool own_gravity = !sets.gravity.empty();
  const Eigen::Vector3d gravity = own_gravity ? Eigen::Vector3d::Zero().eval() : chain.gravity();
  internal::linkPoses(chain, q, X);
  internal::linkVelocities(chain, X, qd, V);
  internal::linkAccelerations(chain, X, V, qd, qdd, gravity, A);
  internal::forEachSet(chain, sets,
                       [&](const std::vector<LinkParameters>& links, Eigen::Index first) {
                         internal::derivativesOfMotion(chain, links, X, V, A, first, out);
                       });
  if (own_gravity) internal::addGravityDerivatives(chain, sets.gravity, X, out.q);
}

}  // namespace v2
}  // namespace chain_dynamics
