// SPDX-License-Identifier: Apache-2.0

/// @file
/// Motions with known accelerations, and the faults of recordings, for tests.
///
///     Motion motion = sines(1000.0, 10.0, {0.3, 1.1});   // 1 kHz, 10 s, two joints
///     addVelocityNoise(motion, 0.005, 1);                // rad/s, seed

#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <random>
#include <vector>

namespace inverse_dynamics_evaluation {

constexpr double kPi = 3.14159265358979323846;

/// Samples of a motion as a robot would report them, and its true accelerations.
struct Motion {
  Eigen::VectorXd time;
  Eigen::MatrixXd q, qd, qdd, effort;

  Eigen::Index count() const { return time.size(); }
};

/// A sum of two sines per joint, of the given frequency [Hz] and 0.37 of it, with noisy efforts.
inline Motion sines(double sampling_frequency, double duration,
                    const std::vector<double>& frequencies) {
  const auto joints = static_cast<Eigen::Index>(frequencies.size());
  const auto count = static_cast<Eigen::Index>(std::lround(duration * sampling_frequency)) + 1;
  Motion motion;
  motion.time =
      Eigen::VectorXd::LinSpaced(count, 0.0, static_cast<double>(count - 1) / sampling_frequency);
  motion.q = motion.qd = motion.qdd = motion.effort = Eigen::MatrixXd::Zero(joints, count);
  for (Eigen::Index j = 0; j < joints; ++j) {
    for (const double share : {1.0, 0.37}) {
      const double w = 2.0 * kPi * share * frequencies[static_cast<std::size_t>(j)];
      const Eigen::ArrayXd phase = w * motion.time.array() + 0.4 + share;
      motion.q.row(j) += (0.5 / w * phase.sin()).matrix().transpose();
      motion.qd.row(j) += (0.5 * phase.cos()).matrix().transpose();
      motion.qdd.row(j) -= (0.5 * w * phase.sin()).matrix().transpose();
    }
  }
  std::mt19937 generator(11);
  std::normal_distribution<double> noise(0.0, 0.1);
  motion.effort = (3.0 * motion.qdd).unaryExpr([&](double x) { return x + noise(generator); });
  return motion;
}

/// One quintic motion of all joints from rest to rest, within a longer time of rest [s]; its
/// velocities peak at up to 0.5 rad/s.
inline Motion restingBut(double sampling_frequency, double duration, double begin, double length) {
  const auto count = static_cast<Eigen::Index>(std::lround(duration * sampling_frequency)) + 1;
  Motion motion;
  motion.time =
      Eigen::VectorXd::LinSpaced(count, 0.0, static_cast<double>(count - 1) / sampling_frequency);
  motion.q = motion.qd = motion.qdd = motion.effort = Eigen::MatrixXd::Zero(3, count);
  const Eigen::ArrayXd x = ((motion.time.array() - begin) / length).max(0.0).min(1.0);
  for (Eigen::Index j = 0; j < 3; ++j) {
    const double way = 0.25 * length * (j == 1 ? -1.0 : 1.0) / static_cast<double>(j + 1);
    motion.q.row(j) = way * (x.cube() * (10.0 - 15.0 * x + 6.0 * x.square())).matrix().transpose();
    motion.qd.row(j) = way / length * (30.0 * x.square() * (1.0 - x).square()).matrix().transpose();
    motion.qdd.row(j) =
        way / (length * length) * (60.0 * x * (1.0 - x) * (1.0 - 2.0 * x)).matrix().transpose();
  }
  return motion;
}

/// White noise of a standard deviation [rad/s] on the velocities.
inline void addVelocityNoise(Motion& motion, double deviation, std::uint32_t seed) {
  std::mt19937 generator(seed);
  std::normal_distribution<double> noise(0.0, deviation);
  motion.qd = motion.qd.unaryExpr([&](double x) { return x + noise(generator); }).eval();
}

/// Stamps that are late by up to `share` of a period, in turn more and less.
inline void jitterStamps(Motion& motion, double share, std::uint32_t seed) {
  std::mt19937 generator(seed);
  std::uniform_real_distribution<double> late(0.0, share * (motion.time[1] - motion.time[0]));
  motion.time = motion.time.unaryExpr([&](double t) { return t + late(generator); }).eval();
}

/// Those samples, in that order, under new stamps.
inline Motion pick(const Motion& motion, const std::vector<Eigen::Index>& samples,
                   const Eigen::VectorXd& time) {
  const auto count = static_cast<Eigen::Index>(samples.size());
  const Eigen::Index joints = motion.q.rows();
  Motion result{time, Eigen::MatrixXd(joints, count), Eigen::MatrixXd(joints, count),
                Eigen::MatrixXd(joints, count), Eigen::MatrixXd(joints, count)};
  for (Eigen::Index k = 0; k < count; ++k) {
    const Eigen::Index from = samples[static_cast<std::size_t>(k)];
    result.q.col(k) = motion.q.col(from);
    result.qd.col(k) = motion.qd.col(from);
    result.qdd.col(k) = motion.qdd.col(from);
    result.effort.col(k) = motion.effort.col(from);
  }
  return result;
}

/// The same states, each `step`-th replaced by the one before it: a state that came too late.
inline Motion withRepeats(const Motion& motion, Eigen::Index step) {
  std::vector<Eigen::Index> samples;
  for (Eigen::Index k = 0; k < motion.count(); ++k) {
    samples.push_back(k % step == step - 1 ? k - 1 : k);
  }
  return pick(motion, samples, motion.time);
}

/// Root mean square of the difference.
inline double rms(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
  return std::sqrt((a - b).squaredNorm() / static_cast<double>(a.size()));
}

/// Derivative of equidistant samples, one sample per column: central differences of fourth order; of
/// second order beside the ends, one-sided at the ends.
inline Eigen::MatrixXd derivative(const Eigen::MatrixXd& x, double period) {
  const Eigen::Index last = x.cols() - 1;
  Eigen::MatrixXd result(x.rows(), x.cols());
  for (Eigen::Index k = 0; k <= last; ++k) {
    const Eigen::Index before = std::max<Eigen::Index>(k - 1, 0), after = std::min(k + 1, last);
    result.col(k) = (x.col(after) - x.col(before)) / (static_cast<double>(after - before) * period);
    if (k >= 2 && k + 2 <= last) {
      result.col(k) =
          (8.0 * (x.col(k + 1) - x.col(k - 1)) - (x.col(k + 2) - x.col(k - 2))) / (12.0 * period);
    }
  }
  return result;
}

}  // namespace inverse_dynamics_evaluation
