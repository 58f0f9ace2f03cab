// SPDX-License-Identifier: Apache-2.0

/// @file
/// Cosine and sine of all joints, of one state or of a pack of states.
///
/// Included by the kernels' two sources only [pack.hpp].

#pragma once

#include "elementary.hpp"
#include "robot.hpp"

namespace chain_dynamics {
inline namespace v2 {
namespace fast {
namespace {

template <typename V>
FAST_INLINE void addOffset(const V& offset_cos, const V& offset_sin, V& s, V& c) {
  const V sum = s * offset_cos + c * offset_sin;
  c = c * offset_cos - s * offset_sin;
  s = sum;
}

/// Memory for one number per joint, with room for a pack at the end.
struct JointNumbers {
  double values[kMaxJoints + kShortWidth];
};

// The pack at joint i: the last one overlaps the one before it, if there is one.
FAST_INLINE int firstOfPack(int i, int joints) {
  return i == 0 || i + kShortWidth <= joints ? i : joints - kShortWidth;
}

// Cosine and sine of all joints of one state, several joints at a time.
inline void turnsOfState(const Robot& robot, const double* q, double* c, double* s) {
  const int n = robot.joints;
  double padded[kShortWidth] = {};
  if (n < kShortWidth) {
    for (int i = 0; i < n; ++i) padded[i] = q[i];
    q = padded;
  }
  ShortBits beyond{};
  for (int i = 0; i < n; i += kShortWidth) {
    const int first = firstOfPack(i, n);
    Short sine;
    Short cosine;
    sineCosine<Scheme::kEstrin>(load<Short>(q + first), load<Short>(robot.quarter_turns + first),
                                sine, cosine, beyond);
    store(sine, s + first);
    store(cosine, c + first);
  }
  if (anyBeyond<Short>(beyond)) sineCosineBeyond(n, q, robot.quarter_turns, 1, s, c);
  if (robot.general_offsets) {
    for (int i = 0; i < n; ++i) {
      addOffset(robot.placements[i].offset_cos, robot.placements[i].offset_sin, s[i], c[i]);
    }
  }
  if (robot.mixed) {
    for (int i = 0; i < n; ++i) {
      if (!robot.placements[i].prismatic) continue;
      c[i] = robot.placements[i].offset_cos;
      s[i] = robot.placements[i].offset_sin;
    }
  }
}

/// Inertia and Coriolis' forces don't depend on the first joint's position; nor do they on its NaN.
template <typename V>
FAST_INLINE void leaveOutFirst(V* c, V* s) {
  c[0] = all<V>(1.0);
  s[0] = V{};
}

/// Whether gravity turns as the first joint does: not if that joint's axis is vertical.
FAST_INLINE bool gravityTurns(const Robot& robot) {
  return robot.root[0] != 0 || robot.root[1] != 0;
}

/// What the first joint's position matters for: nothing, gravity alone, or everything.
enum class FirstJoint { kUnused, kForGravity, kNeeded };

// Cosine and sine of all joints, a state in each lane. Those of the first joint only where something
// that turns with it is asked for; one and zero, or NaN, where that is gravity but it doesn't turn.
FAST_INLINE void turnsOfPack(const Robot& robot, const Pack* q, FirstJoint use, Pack* c, Pack* s) {
  const int n = robot.joints;
  const bool gravity = use == FirstJoint::kForGravity;
  const int first = use == FirstJoint::kNeeded || (gravity && gravityTurns(robot)) ? 0 : 1;
  BitsOf<Pack> beyond{};
  leaveOutFirst(c, s);
  for (int i = gravity ? 0 : 1; i < first && i < n; ++i) {
    s[i] = 0.0 * q[i];
    c[i] += s[i];
  }
  for (int i = first; i < n; ++i) {
    sineCosine<Scheme::kHorner>(q[i], all<Pack>(robot.quarter_turns[i]), s[i], c[i], beyond);
  }
  if (anyBeyond<Pack>(beyond)) {
    sineCosineBeyond((n - first) * kWidth, numbersOf(q + first), robot.quarter_turns + first,
                     kWidth, numbersOf(s + first), numbersOf(c + first));
  }
  if (!robot.general_offsets && !robot.mixed) return;
  for (int i = 0; i < n; ++i) {
    const Placement& X = robot.placements[i];
    const Pack offset_cos = all<Pack>(X.offset_cos);
    const Pack offset_sin = all<Pack>(X.offset_sin);
    if (X.prismatic) {
      c[i] = offset_cos;
      s[i] = offset_sin;
    } else {
      addOffset(offset_cos, offset_sin, s[i], c[i]);
    }
  }
}

}  // namespace
}  // namespace fast
}  // namespace v2
}  // namespace chain_dynamics
