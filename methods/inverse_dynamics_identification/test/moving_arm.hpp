// SPDX-License-Identifier: Apache-2.0
/// @file
/// A Panda in motion, with a body at its tip and noise that remembers.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <inverse_dynamics_solver/conformance/allocation_guard.hpp>
#include <inverse_dynamics_solver/conformance/real_time_section.hpp>
#include <inverse_dynamics_solver/exceptions.hpp>
#include <inverse_dynamics_solver/inverse_dynamics_solver.hpp>
#include <inverse_dynamics_solver/payload.hpp>
#include <iterator>
#include <memory>
#include <random>
#include <rigid_body_inverse_dynamics_solver/rigid_body_inverse_dynamics_solver.hpp>
#include <string>

#include "inverse_dynamics_identification/payload_estimator.hpp"

namespace inverse_dynamics_identification {

using inverse_dynamics_solver::InverseDynamicsSolver;
using inverse_dynamics_solver::RigidBody;
using Solver = rigid_body_inverse_dynamics_solver::InverseDynamicsSolverRigidBody;

constexpr Eigen::Index kJoints = 7;

inline std::string pandaText() {
  std::ifstream file(INVERSE_DYNAMICS_ROBOTS_DIR "/urdf/panda.urdf");
  return {std::istreambuf_iterator<char>(file), {}};
}

inline std::shared_ptr<Solver> panda() {
  auto solver = std::make_shared<Solver>();
  solver->initialize({{"root", std::string("fer_link0")}, {"tip", std::string("fer_link8")}}, "",
                     pandaText());
  return solver;
}

/// A box about (3, -2, 8) cm, seen from the tip.
inline RigidBody box(double mass) {
  RigidBody body{mass};
  body.center_of_mass = {0.03, -0.02, 0.08};
  body.inertia = mass * Eigen::Vector3d(0.0025, 0.0017, 0.0013).asDiagonal().toDenseMatrix();
  return body;
}

/// Sines about a bent pose, each joint with a period of its own.
struct Motion {
  double speed = 1.0;
  Eigen::VectorXd q = Eigen::VectorXd(kJoints), qd = q, qdd = q;

  void at(double t) {
    for (Eigen::Index j = 0; j < kJoints; ++j) {
      const double w = speed * (0.9 + 0.23 * static_cast<double>(j)), a = 0.5;
      const double phase = w * t + 1.3 * static_cast<double>(j);
      const double mean = j == 3 ? -1.6 : (j == 5 ? 1.4 : 0.1 * static_cast<double>(j));
      q[j] = mean + a * std::sin(phase);
      qd[j] = a * w * std::cos(phase);
      qdd[j] = -a * w * w * std::sin(phase);
    }
  }
};

/// Noise of residual_noise.hpp, joint by joint.
struct Noise {
  ResidualNoise of;
  std::mt19937& random;
  Eigen::VectorXd memory = Eigen::VectorXd::Zero(kJoints);
  bool started = false;

  Eigen::VectorXd next(double period) {
    std::normal_distribution<double> normal;
    const double kept = started ? std::exp(-period / of.correlation_time) : 0.0;
    Eigen::VectorXd sample(kJoints);
    for (Eigen::Index j = 0; j < kJoints; ++j) {
      memory[j] = kept * memory[j] + of.correlated[j] * std::sqrt(1 - kept * kept) * normal(random);
      sample[j] = memory[j] + of.white[j] * normal(random);
    }
    started = true;
    return sample;
  }
};

inline ResidualNoise noiseOf(double white, double correlated) {
  ResidualNoise noise;
  noise.white = Eigen::VectorXd::Constant(kJoints, white);
  noise.correlated = Eigen::VectorXd::Constant(kJoints, correlated);
  return noise;
}

/// What is said of a parameter when something is made, or "none".
template <class Make>
std::string refusalOf(const Make& make) {
  try {
    make();
  } catch (const inverse_dynamics_solver::InvalidParameterValueException& e) {
    return e.what();
  }
  return "none";
}

/// In 40 s of motion, in which blocks are joined.
inline void expectNoAllocations(const PayloadOptions& options) {
  using namespace inverse_dynamics_solver::conformance;
  if (!kAllocationGuardWorks && !kRealtimeSanitizerWatches) {
    GTEST_SKIP() << "allocations can't be counted in this build";
  }
  PayloadEstimator estimator(panda(), options);
  PayloadEstimate found(kJoints, options.arm.factor.cols());
  Motion motion;
  const Eigen::VectorXd measured = Eigen::VectorXd::Ones(kJoints);
  int allocations = 0;
  for (int k = 0; k < 800; ++k) {
    const double time = 0.05 * k;
    motion.at(time);
    AllocationGuard guard;
    inRealTime([&] {
      estimator.update(time, motion.q, motion.qd, motion.qdd, measured);
      if (k % 400 == 399) estimator.estimate(found);
    });
    allocations += static_cast<int>(guard.count());
  }
  EXPECT_EQ(allocations, 0);
  EXPECT_GT(found.blocks, 16);
}

}  // namespace inverse_dynamics_identification
