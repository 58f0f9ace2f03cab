// SPDX-License-Identifier: Apache-2.0

/// @file
/// Pseudo-inertia: the matrix that says whether ten numbers are a rigid body's.
///
///     Eigen::Matrix4d P = pseudoInertia(link);
///     bool is_a_body = P.llt().info() == Eigen::Success;
///
/// The second moments of a body's mass about the origin of its frame, with its first moment and
/// its mass [Wensing, Kim, Slotine 2018, doi 10.1109/LRA.2017.2729659]:
///
///         | Sigma  mc |
///     P = | mc'    m  |,    Sigma = integral of x x' dm = 1/2 tr(I) 1 - I
///
/// P is linear in the ten parameters [regressor.hpp]. It is positive definite for every body that
/// isn't flat, and every positive definite P is that of some distribution of mass: masses are
/// positive, moments of inertia are too, and obey the triangle inequality. In another frame, with
/// the homogeneous matrix X_AB, it is P_A = X_AB P_B X_AB'.

#pragma once

#include <Eigen/Core>
#include <chain_dynamics/chain.hpp>
#include <string>

namespace inverse_dynamics_identification {
inline namespace v2 {

using chain_dynamics::LinkParameters;

/// P of the ten parameters.
Eigen::Matrix4d pseudoInertia(const LinkParameters& link);

/// The ten parameters of a symmetric P.
LinkParameters fromPseudoInertia(const Eigen::Matrix4d& P);

/// `tr(M dP/dp_k)` for k = 1 .. 10 and a symmetric M: the gradient by the ten parameters, in the
/// order of LinkParameters::toVector(), of a function of P whose gradient is M.
Eigen::Matrix<double, 10, 1> parameterGradient(const Eigen::Matrix4d& M);

/// `log det P` of a symmetric P; minus infinity where it isn't positive definite.
double logDeterminant(const Eigen::Matrix4d& P);

/// Second derivatives of `-log det P` by the ten parameters, `tr(P^-1 E_k P^-1 E_l)`, of P^-1.
Eigen::Matrix<double, 10, 10> logDeterminantHessian(const Eigen::Matrix4d& inverse);

/// Least mass and inertia of a prior.
struct LinkFloor {
  double mass = 0.05;    ///< kg
  double radius = 0.01;  ///< m; root mean square distance of the mass from each principal plane
};

/// A link that can be a prior, and what was changed about it.
struct LinkPrior {
  LinkParameters link;
  std::string changes;  ///< in words; empty: nothing
};

/// The link with a mass and, about its center of mass, second moments that are no less than those
/// of a floor, in principal axes: what the description can't mean is replaced, the rest stays.
///
/// Independent of the frame, but for a link without mass, whose center of mass is then the origin.
/// @throws chain_dynamics::ModelError  numbers that aren't finite.
LinkPrior linkPrior(const LinkParameters& described, const LinkFloor& floor = {});

}  // namespace v2
}  // namespace inverse_dynamics_identification
