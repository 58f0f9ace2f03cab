// SPDX-License-Identifier: Apache-2.0

/// @file
/// Which structures there are, and the recursions of each.
///
/// Included by kernels.cpp only [pack.hpp].

#pragma once

#include "gravity_vector.hpp"
#include "inertia_matrix.hpp"
#include "torque_derivatives.hpp"
#include "torques.hpp"

namespace chain_dynamics {
inline namespace v2 {
namespace fast {
namespace {

/// Joints 2, 3, 4 (the first is 1) are parallel, and right angles elsewhere: Universal Robots.
/// Their description's right angles have nine digits.
using ParallelWrist = Known<6, 0x020022, 0x001100, 0x010010>;

/// Six joints, 2 and 3 parallel, right angles elsewhere: most industrial robots.
using SphericalWrist = Known<6, 0x010111, 0x011100, 0x010110>;

/// Seven joints at right angles: Panda, FR3, iiwa, Gen3.
using RightAngles = Known<7, 0x0111111, 0x0001101, 0x0111110>;

/// Six or seven joints that turn about any axes.
using AnySix = Known<6, 0x033333, 0x011111, 0x011111>;
using AnySeven = Known<7, 0x0333333, 0x0111111, 0x0111111>;

/// Six or seven joints that turn or slide.
using MixedSix = Known<6, 0x033333, 0x011111, 0x011111, true>;
using MixedSeven = Known<7, 0x0333333, 0x0111111, 0x0111111, true>;

template <typename V>
struct Recursions {
  void (*torques)(const Robot&, const State<V>&, const double* root, V* tau);
  void (*gravity)(const Robot&, const State<V>&, V* g);
  void (*inertia)(const Robot&, const State<V>&, const Entries<V>& H);
};

template <typename V>
constexpr Recursions<V> kRecursions[] = {
    {torques<AnyStructure, V>, gravity<AnyStructure, V>, inertia<AnyStructure, V>},
    {torques<ParallelWrist, V>, gravity<ParallelWrist, V>, inertia<ParallelWrist, V>},
    {torques<SphericalWrist, V>, gravity<SphericalWrist, V>, inertia<SphericalWrist, V>},
    {torques<RightAngles, V>, gravity<RightAngles, V>, inertia<RightAngles, V>},
    {torques<AnySix, V>, gravity<AnySix, V>, inertia<AnySix, V>},
    {torques<AnySeven, V>, gravity<AnySeven, V>, inertia<AnySeven, V>},
    {torques<MixedSix, V>, gravity<MixedSix, V>, inertia<MixedSix, V>},
    {torques<MixedSeven, V>, gravity<MixedSeven, V>, inertia<MixedSeven, V>},
};

// Identified models with parameters for each row.
template <typename V>
constexpr Recursions<V> kRecursionsByRow[] = {
    {torquesByRow<AnyStructure, V>, gravityByRow<AnyStructure, V>, inertiaByRow<AnyStructure, V>},
    {torquesByRow<ParallelWrist, V>, gravityByRow<ParallelWrist, V>,
     inertiaByRow<ParallelWrist, V>},
};

// Of one state, with one set of parameters or one for each row.
using Derivatives = void (*)(const Robot&, const State<double>&, const double* root,
                             const DerivativeEntries&);
constexpr Derivatives kDerivatives[] = {
    torqueDerivatives<AnyStructure>,   torqueDerivatives<ParallelWrist>,
    torqueDerivatives<SphericalWrist>, torqueDerivatives<RightAngles>,
    torqueDerivatives<AnySix>,         torqueDerivatives<AnySeven>,
    torqueDerivatives<AnyStructure>,   torqueDerivatives<AnyStructure>};

int structureOf(const Robot& robot) {
  if (ParallelWrist::covers(robot)) return 1;
  if (robot.rows != nullptr) return 0;
  if (SphericalWrist::covers(robot)) return 2;
  if (RightAngles::covers(robot)) return 3;
  if (AnySix::covers(robot)) return 4;
  if (AnySeven::covers(robot)) return 5;
  return MixedSix::covers(robot) ? 6 : MixedSeven::covers(robot) ? 7 : 0;
}

template <typename V>
FAST_INLINE const Recursions<V>& recursionsOf(const Robot& robot, int structure) {
  return robot.rows != nullptr ? kRecursionsByRow<V>[structure] : kRecursions<V>[structure];
}

constexpr double kAtRest[kMaxJoints] = {};
constexpr double kNoGravity[3] = {};

template <typename V>
FAST_INLINE void gravityOf(const Robot& robot, int structure, const State<V>& state, V* g) {
  // parameters of gravity's own are those of all rows
  const bool by_row = robot.rows != nullptr && robot.gravity_bodies == nullptr;
  (by_row ? kRecursionsByRow<V> : kRecursions<V>)[structure].gravity(robot, state, g);
}

template <typename V>
FAST_INLINE void torquesOf(const Robot& robot, int structure, const State<V>& state, V* tau) {
  const Recursions<V>& recursions = recursionsOf<V>(robot, structure);
  if (robot.gravity_bodies == nullptr) {
    recursions.torques(robot, state, robot.root, tau);
    return;
  }
  V g[kMaxJoints];  // first: tau may stand where the state does
  gravityOf(robot, structure, state, g);
  recursions.torques(robot, state, kNoGravity, tau);
  for (int i = 0; i < robot.joints; ++i) tau[i] += g[i];
}

template <typename V>
FAST_INLINE void coriolisOf(const Robot& robot, int structure, const State<V>& state, V* c) {
  recursionsOf<V>(robot, structure).torques(robot, state, kNoGravity, c);
}

}  // namespace
}  // namespace fast
}  // namespace v2
}  // namespace chain_dynamics
