// SPDX-License-Identifier: Apache-2.0

/// @file
/// Arms and motions for tests: the truth, a description that is wrong, and samples.

#pragma once

#include <Eigen/Geometry>
#include <chain_dynamics/chain.hpp>
#include <chain_dynamics/fast_model.hpp>
#include <chain_dynamics/model.hpp>
#include <chain_dynamics/spatial.hpp>
#include <cstddef>
#include <random>
#include <string>
#include <utility>
#include <vector>

namespace inverse_dynamics_identification {

using chain_dynamics::Chain;
using chain_dynamics::Joint;
using chain_dynamics::LinkParameters;

inline Eigen::Matrix3d rotation(double x, double y, double z) {
  return (Eigen::AngleAxisd(z, Eigen::Vector3d::UnitZ()) *
          Eigen::AngleAxisd(y, Eigen::Vector3d::UnitY()) *
          Eigen::AngleAxisd(x, Eigen::Vector3d::UnitX()))
      .toRotationMatrix();
}

/// A rod of that mass along x, 0.1 m thick.
inline LinkParameters rod(double mass, double length) {
  const double across = mass * (length * length / 12 + 0.01 / 12);
  const Eigen::Matrix3d inertia = Eigen::Vector3d(mass * 0.01 / 6, across, across).asDiagonal();
  return LinkParameters::fromCenterOfMass(mass, {0.4 * length, 0.02, -0.01}, inertia);
}

/// Three crossed axes, rods of `scale` times 4, 2 and 1 kg.
inline Chain threeJointArm(double scale = 1) {
  std::vector<Joint> joints(3);
  joints[0].name = "pan";
  joints[1].name = "lift";
  joints[1].placement = {rotation(1.5, 0, 0), {0.1, 0, 0.2}};
  joints[2].name = "elbow";
  joints[2].placement = {rotation(0.3, 0.1, 0), {0.5, 0, 0}};
  return Chain("arm", joints, {rod(4 * scale, 0.3), rod(2 * scale, 0.5), rod(scale, 0.4)},
               {0, 0, -9.81});
}

/// The same robot with the frame of each link moved in it, along and about the joint's axis: a joint
/// turns about z of its frame.
inline Chain withFramesMoved(const Chain& chain) {
  std::vector<Joint> joints = chain.joints();
  std::vector<LinkParameters> links = chain.links();
  chain_dynamics::Transform<double> before = chain_dynamics::Transform<double>::identity();
  for (std::size_t i = 0; i < joints.size(); ++i) {
    const double turn = 0.7 + static_cast<double>(i);
    const chain_dynamics::Transform<double> X{rotation(0, 0, turn), {0, 0, 0.3 - turn}};
    joints[i].placement = before.inverse() * joints[i].placement * X;
    links[i] = X.inverse() * links[i];
    before = X;
  }
  return Chain(chain.name(), joints, links, chain.gravity());
}

/// States and torques, one sample per column.
struct Motion {
  Eigen::MatrixXd q, qd, qdd, tau;
};

inline Eigen::MatrixXd uniform(Eigen::Index rows, Eigen::Index cols, double most,
                               std::mt19937& random) {
  std::uniform_real_distribution<double> numbers(-most, most);
  return Eigen::MatrixXd::NullaryExpr(rows, cols, [&] { return numbers(random); });
}

/// Random states, and the torques of rigid bodies.
inline Motion randomMotion(const Chain& chain, Eigen::Index count, unsigned seed) {
  std::mt19937 random(seed);
  const Eigen::Index n = chain.jointCount();
  Motion motion{uniform(n, count, 3, random), uniform(n, count, 1.5, random),
                uniform(n, count, 4, random), Eigen::MatrixXd(n, count)};
  chain_dynamics::FastModel(chain_dynamics::Model(chain))
      .torquesBatch(motion.q, motion.qd, motion.qdd, motion.tau);
  return motion;
}

inline Eigen::MatrixXd noise(Eigen::Index rows, Eigen::Index cols, double deviation,
                             unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> numbers(0, deviation);
  return Eigen::MatrixXd::NullaryExpr(rows, cols, [&] { return numbers(random); });
}

}  // namespace inverse_dynamics_identification
