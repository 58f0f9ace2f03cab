// SPDX-License-Identifier: Apache-2.0

/// @file
/// The robots that every library is timed on.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace inverse_dynamics_benchmarks {

/// A robot by its URDF.
struct Robot {
  std::string name;  ///< `ur10`, `panda`, `mixed7` (turning and sliding joints), `turning6`
  std::string urdf;
};

/// Whether a chain has as many joints as most arms: these are measured more closely.
inline bool isArm(std::ptrdiff_t joints) { return joints == 6 || joints == 7; }

/// UR10 and Panda.
std::vector<Robot> realRobots();

/// A Panda whose parameters were identified as those of bodies that can exist, with friction: the
/// path of its model file.
std::string feasiblePandaFile();

/// Two Pandas on a torso that turns: a tree of 15 joints, named `two_pandas`.
Robot twoPandas();

/// These, chains of 1 to 30 joints that turn and slide, and of 6 and 7 that turn.
std::vector<Robot> robots();

}  // namespace inverse_dynamics_benchmarks
