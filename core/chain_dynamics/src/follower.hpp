// SPDX-License-Identifier: Apache-2.0

/// @file
/// What a coordinate takes over from a joint that follows it.

#pragma once

#include <algorithm>
#include <cmath>
#include <string>

#include "chain_dynamics/chain.hpp"
#include "chain_dynamics/text.hpp"

namespace chain_dynamics {
inline namespace v2 {

/// A coordinate is continuous only where whole turns of it are whole turns of all that follow it.
inline void addTurns(Joint& coordinate, const Joint& joint, double factor) {
  const bool whole = joint.type == JointType::kContinuous && factor == std::round(factor);
  if (coordinate.type == JointType::kContinuous && !whole) coordinate.type = JointType::kRevolute;
}

/// Adds rotor inertia, damping, friction and limits (but effort) of a joint at `factor q + offset` to those
/// of the coordinate q.
///
/// @return a sentence, if no position is within the limits of both; else nothing.
inline std::string addFollower(Joint& coordinate, const Joint& joint, double factor,
                               double offset) {
  coordinate.rotor_inertia += factor * factor * joint.rotor_inertia;
  coordinate.damping += factor * factor * joint.damping;
  coordinate.friction += std::abs(factor) * joint.friction;
  if (factor == 0) return "";
  addTurns(coordinate, joint, factor);
  JointLimits& limits = coordinate.limits;
  for (double JointLimits::*const limit : {&JointLimits::velocity, &JointLimits::acceleration,
                                           &JointLimits::deceleration, &JointLimits::jerk}) {
    limits.*limit = std::min(limits.*limit, joint.limits.*limit / std::abs(factor));
  }
  const double ends[] = {(joint.limits.lower - offset) / factor,
                         (joint.limits.upper - offset) / factor};
  const double lower = std::max(limits.lower, std::min(ends[0], ends[1]));
  const double upper = std::min(limits.upper, std::max(ends[0], ends[1]));
  if (lower > upper) {
    return printable("joint " + coordinate.name + ": no position within its limits is one " +
                     "within those of joint " + joint.name +
                     ", which follows it: they aren't used");
  }
  limits.lower = lower;
  limits.upper = upper;
  return "";
}

}  // namespace v2
}  // namespace chain_dynamics
