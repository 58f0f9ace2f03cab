// SPDX-License-Identifier: Apache-2.0

#include "effort_meaning.hpp"

#include <algorithm>
#include <cmath>
#include <inverse_dynamics_evaluation/joint_matching.hpp>
#include <inverse_dynamics_solver/motor_currents.hpp>
#include <sstream>

#include "user_error.hpp"

namespace inverse_dynamics_ros {
namespace {

using inverse_dynamics_solver::InverseDynamicsSolver;

std::string figures(const Eigen::VectorXd& numbers) {
  std::ostringstream text;
  text.precision(4);
  for (Eigen::Index j = 0; j < numbers.size(); ++j) {
    text << (j == 0 ? "" : " ") << numbers[j];
  }
  return text.str();
}

// The gains that are given, else the solver's.
Eigen::VectorXd gainsOf(const std::vector<double>& given, const InverseDynamicsSolver& solver) {
  const std::string where = "parameter 'drive_gains'";
  const std::string expected = std::to_string(solver.jointCount()) +
                               " figures above 0 [N m/A], one per joint of the chain (" +
                               inverse_dynamics_evaluation::listed(solver.jointNames()) + ")";
  if (given.empty()) {
    const auto* currents = dynamic_cast<const inverse_dynamics_solver::MotorCurrents*>(&solver);
    if (currents == nullptr) {
      throw UserError(where, expected + ", as effort means current",
                      "none, and the solver has none of its own", "set it");
    }
    return currents->getDriveGainsMatrix().diagonal();
  }
  Eigen::VectorXd gains =
      Eigen::Map<const Eigen::VectorXd>(given.data(), static_cast<Eigen::Index>(given.size()));
  const bool positive = std::all_of(given.begin(), given.end(),
                                    [](double gain) { return gain > 0 && std::isfinite(gain); });
  if (gains.size() != solver.jointCount() || !positive) {
    throw UserError(
        where, expected, std::to_string(given.size()) + " (" + figures(gains) + ")",
        "correct it; for a joint that turns the other way, turn the sign of its efforts");
  }
  return gains;
}

}  // namespace

EffortMeaning effortMeaning(const std::string& effort, const std::vector<double>& drive_gains,
                            const InverseDynamicsSolver& solver) {
  EffortMeaning meaning;
  meaning.drive_gains = Eigen::VectorXd::Ones(solver.jointCount());
  meaning.summary = "torque";
  if (effort == "current") {
    meaning.drive_gains = gainsOf(drive_gains, solver);
    meaning.summary = "current, with drive gains " + figures(meaning.drive_gains) + " N m/A";
  } else if (effort == "torque_without_gravity") {
    meaning.without_gravity = true;
    meaning.summary = "torque without gravity: computed torques are without gravity, too";
  } else if (effort != "torque") {
    throw UserError(
        "parameter 'effort'", "one of torque, current, torque_without_gravity", "'" + effort + "'",
        effort == "auto" ? "`ids evaluate` finds it from the data, then state it" : "correct it");
  }
  return meaning;
}

}  // namespace inverse_dynamics_ros
