// SPDX-License-Identifier: Apache-2.0

/// @file
/// The states that every library is timed on.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <random>

namespace inverse_dynamics_benchmarks {

/// Enough for branches and tables not to learn them, few enough to stay in the cache.
constexpr Eigen::Index kStates = 1024;

/// States as columns, the same numbers with every standard library.
class States {
 public:
  explicit States(Eigen::Index joints, Eigen::Index count = kStates)
      : q(random(joints, count, 3.1)),
        qd(random(joints, count, 2.0)),
        qdd(random(joints, count, 4.0)) {}

 private:
  std::mt19937 engine_{2008};  // before the members that it fills

 public:
  Eigen::MatrixXd q, qd, qdd;

 private:
  Eigen::MatrixXd random(Eigen::Index joints, Eigen::Index count, double range) {
    return Eigen::MatrixXd::NullaryExpr(
        joints, count, [&] { return range * (2.0 * engine_() / 4294967295.0 - 1.0); });
  }
};

}  // namespace inverse_dynamics_benchmarks
