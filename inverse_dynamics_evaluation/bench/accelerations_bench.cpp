// SPDX-License-Identifier: Apache-2.0

/// @file
/// Seconds that each step takes for a million samples of seven joints; no test.
///
///     accelerations_bench [samples]

#include <chrono>
#include <cstdio>
#include <random>
#include <string>

#include "inverse_dynamics_evaluation/accelerations.hpp"
#include "inverse_dynamics_evaluation/metrics.hpp"

namespace {

// Runs a step and prints its time.
template <typename Step>
void report(const char* what, Step step) {
  const auto begin = std::chrono::steady_clock::now();
  step();
  const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - begin;
  std::printf("%-32s %6.2f s\n", what, seconds.count());
}

}  // namespace

int main(int argc, char** argv) {
  using namespace inverse_dynamics_evaluation;
  const Eigen::Index count = argc > 1 ? std::stol(argv[1]) : 1000000;
  const Eigen::Index joints = 7;

  // a slow motion at 1 kHz with a noisy velocity
  std::mt19937 generator(1);
  std::normal_distribution<double> noise(0.0, 0.005);
  const Eigen::VectorXd time =
      Eigen::VectorXd::LinSpaced(count, 0.0, 1e-3 * static_cast<double>(count - 1));
  Eigen::MatrixXd q(joints, count);
  Eigen::MatrixXd qd(joints, count);
  Eigen::MatrixXd effort(joints, count);
  for (Eigen::Index k = 0; k < count; ++k) {
    for (Eigen::Index j = 0; j < joints; ++j) {
      const double rate = 1.0 + static_cast<double>(j);
      q(j, k) = std::sin(rate * time[k]) / rate;
      qd(j, k) = std::cos(rate * time[k]) + noise(generator);
      effort(j, k) = 20.0 * noise(generator);
    }
  }

  Eigen::MatrixXd qdd;
  report("backward difference", [&] { qdd = backwardDifference(time, qd); });
  report("samples examined", [&] { examineSamples(time, q, qd, effort); });
  report("cut-off chosen", [&] { chooseCutoff({{q, qd}}, 1000.0); });
  report("low-pass", [&] { qdd = lowPass(qd, 1000.0, 5.0); });
  report("all of it, cut-off given", [&] {
    LowPassOptions options;
    options.cutoff = 5.0;
    qdd = lowPassAccelerations(time, q, qd, effort, options).qdd;
  });
  report("all of it, cut-off chosen", [&] { qdd = lowPassAccelerations(time, q, qd, effort).qdd; });
  report("metrics", [&] { metrics(qdd, effort); });
  return 0;
}
