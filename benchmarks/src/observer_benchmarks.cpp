// SPDX-License-Identifier: Apache-2.0
#include "observer_benchmarks.hpp"

#include <benchmark/benchmark.h>

#include <cmath>
#include <cstddef>
#include <inverse_dynamics_control/acceleration_residual.hpp>
#include <inverse_dynamics_control/external_torque_estimator.hpp>
#include <inverse_dynamics_control/momentum_observer.hpp>
#include <inverse_dynamics_control/signals.hpp>
#include <inverse_dynamics_solver/inverse_dynamics_solver.hpp>
#include <memory>
#include <string>
#include <vector>

#include "states.hpp"
#include "timing.hpp"

namespace inverse_dynamics_benchmarks {
namespace {

using inverse_dynamics_control::EstimatorOptions;
using inverse_dynamics_control::JointState;

constexpr double kPeriod = 1e-3;  // s

/// An estimator, and a motion that returns to where it began: each joint at a frequency of its own.
template <class Estimator>
struct Observed {
  explicit Observed(
      const std::shared_ptr<const inverse_dynamics_solver::InverseDynamicsSolver>& solver)
      : estimator(solver, options(solver->jointCount())), effort(solver->jointCount(), kStates) {
    const Eigen::Index n = solver->jointCount();
    JointState state(n);
    state.qd.setZero();  // not looked at
    for (Eigen::Index k = 0; k < kStates; ++k) {
      const double phase = 2.0 * M_PI * static_cast<double>(k) / static_cast<double>(kStates);
      for (Eigen::Index j = 0; j < n; ++j) {
        state.q[j] =
            0.8 * std::sin(static_cast<double>(j % 3 + 1) * phase + static_cast<double>(j));
      }
      states.push_back(state);
      effort.col(k) = solver->getGravityVector(state.q);
    }
  }

  static EstimatorOptions options(Eigen::Index n) {
    EstimatorOptions result;
    result.gain.setConstant(n, 60.0);
    return result;
  }

  Estimator estimator;
  std::vector<JointState> states;
  Eigen::MatrixXd effort;
};

template <class Estimator>
void registerObserver(
    const std::string& name,
    const std::shared_ptr<const inverse_dynamics_solver::InverseDynamicsSolver>& solver) {
  const auto observed = std::make_shared<Observed<Estimator>>(solver);
  registerOverStates(name, [observed](Eigen::Index k) {
    observed->estimator.update(observed->states[static_cast<std::size_t>(k)],
                               observed->effort.col(k), kPeriod);
    benchmark::ClobberMemory();
  });
}

}  // namespace

void registerObservers(
    const std::string& robot,
    const std::shared_ptr<const inverse_dynamics_solver::InverseDynamicsSolver>& solver) {
  using inverse_dynamics_control::AccelerationResidual;
  using inverse_dynamics_control::MomentumObserver;
  registerObserver<AccelerationResidual>(robot + "/acceleration_residual/ours", solver);
  if (!solver->inertiaIsPhysical()) return;
  registerObserver<MomentumObserver>(robot + "/momentum_observer/ours", solver);
}

}  // namespace inverse_dynamics_benchmarks
