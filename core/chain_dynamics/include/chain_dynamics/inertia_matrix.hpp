// SPDX-License-Identifier: Apache-2.0

/// @file
/// The joint-space inertia matrix.
///
///     Eigen::MatrixXd H(chain.jointCount(), chain.jointCount());
///     inertiaMatrix(chain, q, H);

#pragma once

#include <Eigen/Core>
#include <cassert>
#include <vector>

#include "chain_dynamics/kinematics.hpp"
#include "chain_dynamics/parameter_sets.hpp"

namespace chain_dynamics {
inline namespace v2 {
namespace internal {

// Row i up to the diagonal if it is the first one; else row and column i from `first` to the
// diagonal. I_c is the inertia of link i and all links after it.
// F = I_c S accelerates joint i by one unit; every joint before it must hold against F.
template <typename Scalar, typename MatrixH>
void inertiaUpToDiagonal(const Chain& chain, const SpatialInertia<Scalar>& I_c,
                         const Scratch<Transform<Scalar>>& X, Eigen::Index i, Eigen::Index first,
                         MatrixH& H) {
  Force<Scalar> F = timesAxis(I_c, joint(chain, i));
  H(i, i) = alongAxis(joint(chain, i), F) + Scalar(joint(chain, i).rotor_inertia);
  for (Eigen::Index j = i; j > (i > first ? first : 0); --j) {
    F = X[j] * F;
    H(i, j - 1) = alongAxis(joint(chain, j - 1), F);
    if (i > first) H(j - 1, i) = H(i, j - 1);
  }
}

// Row `first` and what is right of and below its diagonal entry, with one parameter set, from the
// links' poses: all of H if that is the first row.
template <typename Scalar, typename MatrixH>
void inertiaOfPoses(const Chain& chain, const std::vector<LinkParameters>& links,
                    const Scratch<Transform<Scalar>>& X, Eigen::Index first, MatrixH& H) {
  SpatialInertia<Scalar> I_c = SpatialInertia<Scalar>::zero();
  for (Eigen::Index i = chain.jointCount() - 1; i >= first; --i) {
    I_c += link<Scalar>(links, i);
    inertiaUpToDiagonal(chain, I_c, X, i, first, H);

    // on to the parent link
    if (i > first) I_c = X[i] * I_c;
  }
}

// H, row j with set j.
template <typename Sets, typename Scalar, typename MatrixH>
void inertiaOfPoses(const Chain& chain, const Sets& sets, const Scratch<Transform<Scalar>>& X,
                    MatrixH& H) {
  forEachSet(chain, sets, [&](const std::vector<LinkParameters>& links, Eigen::Index first) {
    inertiaOfPoses(chain, links, X, first, H);
  });
}

}  // namespace internal

/// Joint-space inertia matrix: `H(q)`, with `1/2 qd' H qd` the kinetic energy.
///
/// Composite rigid body algorithm in link frames [Featherstone 2008, sec. 6.2, table 6.2], O(n^2).
/// Rotor inertia is on the diagonal. Symmetric exactly; positive definite where the links are
/// bodies with mass (Chain::warnings() is empty). Neither with different sets for the rows.
///
/// @tparam Scalar  (of q, H) float, double or a dual number.
/// @param sets     ParameterSets [parameter_sets.hpp]; left out: chain.links().
/// @param q        n; rad (prismatic m); order of chain.jointNames().
/// @param[out] H   n x n; kg m^2 (prismatic kg, mixed kg m).
/// Real time (up to 64 joints): no allocation, lock, exception or system call. Threads: safe.
template <typename Sets, typename Q, typename MatrixH>
void inertiaMatrix(const Chain& chain, const Sets& sets, const Eigen::MatrixBase<Q>& q,
                   const Eigen::MatrixBase<MatrixH>& H) {
  using Scalar = typename Q::Scalar;
  const Eigen::Index n = chain.jointCount();
  assert(H.rows() == n && H.cols() == n && internal::haveSizesOf(chain, sets));
  Scratch<Transform<Scalar>> X(n);

  internal::linkPoses(chain, q, X);
  internal::inertiaOfPoses(chain, sets, X, H.const_cast_derived());
}
template <typename Q, typename MatrixH>
void inertiaMatrix(const Chain& chain, const Eigen::MatrixBase<Q>& q,
                   const Eigen::MatrixBase<MatrixH>& H) {
  inertiaMatrix(chain, internal::OwnParameters(), q, H);
}

}  // namespace v2
}  // namespace chain_dynamics
