// SPDX-License-Identifier: Apache-2.0

/// @file
/// Which structures there are, and the recursions of each.
///
/// Included by the kernels' two sources only [pack.hpp].

#pragma once

#include <cstddef>
#include <type_traits>

#include "coriolis_matrix.hpp"
#include "gravity_vector.hpp"
#include "inertia_matrix.hpp"
#include "tip_kinematics.hpp"
#include "torque_derivatives.hpp"
#include "torques.hpp"

namespace chain_dynamics {
inline namespace v2 {
namespace fast {
namespace {

constexpr Twist kNone = Twist::kNone, kRight = Twist::kRight, kAlmost = Twist::kAlmostRight,
                kAny = Twist::kAny;

// NOLINTBEGIN(modernize-use-bool-literals): 0 and 1 keep the tables readable
/// Joints 2, 3, 4 (the first is 1) are parallel, and right angles elsewhere: Universal Robots.
/// Their description's right angles have nine digits. Identified models have rows of their own.
constexpr Geometry<6> kParallelWrist = {
    {kNone, kAlmost, kNone, kNone, kAlmost, kAlmost}, {0, 0, 1, 1, 0, 0}, {0, 1, 0, 0, 1, 0}};

/// Six joints, 2 and 3 parallel, right angles elsewhere: most industrial robots.
constexpr Geometry<6> kSphericalWrist = {
    {kNone, kRight, kNone, kRight, kRight, kRight}, {0, 1, 1, 1, 0, 0}, {0, 1, 0, 1, 1, 0}};

/// Seven joints at right angles: Panda, FR3, iiwa, Gen3.
constexpr Geometry<7> kRightAngles = {{kNone, kRight, kRight, kRight, kRight, kRight, kRight},
                                      {0, 0, 0, 1, 1, 0, 1},
                                      {0, 1, 1, 1, 1, 1, 0}};

/// Six or seven joints about any axes.
constexpr Geometry<6> kAnySix = {
    {kNone, kAny, kAny, kAny, kAny, kAny}, {0, 1, 1, 1, 1, 1}, {0, 1, 1, 1, 1, 1}};
constexpr Geometry<7> kAnySeven = {
    {kNone, kAny, kAny, kAny, kAny, kAny, kAny}, {0, 1, 1, 1, 1, 1, 1}, {0, 1, 1, 1, 1, 1, 1}};
// NOLINTEND(modernize-use-bool-literals)

template <typename V>
struct Recursions {
  void (*torques)(const Robot&, const State<V>&, const double* root, V* tau);
  void (*gravity)(const Robot&, const State<V>&, V* g);
  void (*inertia)(const Robot&, const State<V>&, const Entries<V>& H);
};

template <typename V>
using Derivatives = void (*)(const Robot&, const State<V>&, const double* root,
                             const DerivativeEntries<V>&);

template <typename V>
using Coriolis = void (*)(const Robot&, const State<V>&, V* C, std::ptrdiff_t outer_step);

template <typename V>
struct TipKinematics {
  void (*pose)(const Robot&, const State<V>&, V* R, V* p);
  void (*jacobian)(const Robot&, const State<V>&, const JacobianEntries<V>& J);
  void (*jacobian_derivative)(const Robot&, const State<V>&, const JacobianEntries<V>& dJ);
};

template <typename V>
using AnyWithMatrices = AnyOf<sizeof(V) == sizeof(double) ? kMaxJoints : kPackedMatrixJoints>;

/// Derivatives and Coriolis matrices are unrolled for one state of joints that turn, and for packs of
/// states where right angles save most: they take long to compile.
template <typename S, typename V>
using ForDerivatives = std::conditional_t<S::kMixed || (sizeof(V) > sizeof(double) && !S::kAligned),
                                          AnyWithMatrices<V>, S>;

/// Kinematics are unrolled where right angles save most.
template <typename S>
using ForKinematics = std::conditional_t<S::kAligned, S, AnyStructure>;

/// The recursions of each structure, in the order in which a robot's is looked for.
template <typename... S>
struct Tables {
  template <typename V>
  static constexpr Recursions<V> kRecursions[] = {
      {torques<S, V>(), gravity<S, V>, inertia<S, V>}...};

  template <typename V>
  static constexpr Derivatives<V> kDerivatives[] = {torqueDerivatives<ForDerivatives<S, V>, V>...};

  template <typename V>
  static constexpr Coriolis<V> kCoriolis[] = {coriolisMatrix<ForDerivatives<S, V>, V>...};

  template <typename V>
  static constexpr TipKinematics<V> kTipKinematics[] = {
      {tipPose<ForKinematics<S>, V>, tipJacobian<ForKinematics<S>, V>,
       tipJacobianDerivative<ForKinematics<S>, V>}...};

  /// Index of the first that has the robot's structure, or one with less zeros.
  static int indexOf(const Robot& robot) {
    int index = 0;
    (void)((S::covers(robot) || (++index, false)) || ...);
    return index;
  }
};
using Structures =
    Tables<Known<6, kParallelWrist, Has::kRows>, Known<6, kSphericalWrist>, Known<7, kRightAngles>,
           Known<6, kAnySix>, Known<7, kAnySeven>, Known<6, kAnySix, Has::kSlides>,
           Known<7, kAnySeven, Has::kSlides>, AnyStructure>;

template <typename V>
FAST_INLINE const Recursions<V>& recursionsOf(int structure) {
  return Structures::kRecursions<V>[structure];
}

/// In loops where each row has a set of parameters: unrolled, it would take long to compile.
template <typename V>
FAST_INLINE Coriolis<V> coriolisMatrixOf(const Robot& robot, int structure) {
  if (robot.rows != nullptr) return coriolisMatrixByRow<AnyWithMatrices<V>, V>;
  return Structures::kCoriolis<V>[structure];
}
template <typename V>
FAST_INLINE const TipKinematics<V>& tipKinematicsOf(int structure) {
  return Structures::kTipKinematics<V>[structure];
}

constexpr double kAtRest[kMaxJoints] = {};
constexpr double kNoGravity[3] = {};

template <typename V>
FAST_INLINE void torquesOf(const Robot& robot, int structure, const State<V>& state, V* tau) {
  const Recursions<V>& recursions = recursionsOf<V>(structure);
  if (robot.gravity_bodies == nullptr) {
    recursions.torques(robot, state, robot.root, tau);
    return;
  }
  V g[kMaxJoints];  // first: tau may stand where the state does
  recursions.gravity(robot, state, g);
  recursions.torques(robot, state, kNoGravity, tau);
  for (int i = 0; i < robot.joints; ++i) tau[i] += g[i];
}

template <typename V>
FAST_INLINE void derivativesOf(const Robot& robot, int structure, const State<V>& state,
                               const DerivativeEntries<V>& to) {
  const bool own_gravity = robot.gravity_bodies != nullptr;
  Structures::kDerivatives<V>[structure](robot, state, own_gravity ? kNoGravity : robot.root, to);
  if (own_gravity) addGravityDerivatives<AnyWithMatrices<V>>(robot, state, to.by_q, to.outer_step);
}

}  // namespace
}  // namespace fast
}  // namespace v2
}  // namespace chain_dynamics
