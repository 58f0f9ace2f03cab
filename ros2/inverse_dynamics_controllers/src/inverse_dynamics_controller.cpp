// SPDX-License-Identifier: Apache-2.0
#include "inverse_dynamics_controllers/inverse_dynamics_controller.hpp"

#include <cstddef>
#include <inverse_dynamics_control/computed_torque.hpp>
#include <inverse_dynamics_control/joint_parameters.hpp>
#include <inverse_dynamics_controllers/inverse_dynamics_controller_parameters.hpp>
#include <inverse_dynamics_solver/exceptions.hpp>
#include <memory>
#include <sstream>
#include <string>
#include <vector>

#include "follower.hpp"

namespace inverse_dynamics_controllers {

using inverse_dynamics_control::ComputedTorque;
using inverse_dynamics_control::Gains;
using inverse_dynamics_control::jointNumbers;
using inverse_dynamics_solver::InvalidParameterValueException;

namespace {

// Errors go through H: a negative diagonal entry would make that joint's feedback positive.
void requirePhysicalInertia(const Setup& setup) {
  if (setup.arm.solver->inertiaIsPhysical()) return;
  throw InvalidParameterValueException(
      "parameter 'plugin_name'", "not fit for computed torque",
      "a solver whose inertia matrix is symmetric and positive definite",
      setup.parameters.plugin_name + ", whose inertiaIsPhysical() is false",
      "use inverse_dynamics_controllers/FeedForwardController with it, or here a solver "
      "made from the robot's URDF");
}

// The feedback is that of a double integrator in steps of T: it is stable for Kp T < 2 Kd < 4 / T.
void requireStableLoop(const Gains& gains, double period, const std::vector<std::string>& joints) {
  for (Eigen::Index j = 0; j < gains.Kp.size(); ++j) {
    const double Kp = gains.Kp[j], Kd = gains.Kd[j];
    if (Kp * period <= 2.0 * Kd && Kd * period < 2.0) continue;
    std::ostringstream got;
    got << "Kp = " << Kp << "/s^2, Kd = " << Kd << "/s every " << period << " s";
    throw InvalidParameterValueException(
        "parameter 'gains': joint " + joints[static_cast<std::size_t>(j)],
        "unstable in the sampled loop", "Kp T <= 2 Kd and Kd T < 2", got.str(),
        "lower natural_frequency; a damping_ratio of 1 suits most arms");
  }
}

Gains gainsOf(const std::vector<double>& natural_frequency,
              const std::vector<double>& damping_ratio, double period,
              const std::vector<std::string>& joints) {
  if (natural_frequency.empty()) {
    throw inverse_dynamics_solver::ParameterUninitializedException(
        "parameter 'gains.natural_frequency'", "not set", "numbers above zero [rad/s]", "nothing",
        "start with 10 and double it while the arm is quiet");
  }
  const Gains gains = Gains::of(jointNumbers("gains.natural_frequency", natural_frequency, joints),
                                jointNumbers("gains.damping_ratio", damping_ratio, joints));
  requireStableLoop(gains, period, joints);
  return gains;
}

}  // namespace

FollowingController::MakeFollower InverseDynamicsController::declareParameters() {
  const auto parameters = std::make_shared<inverse_dynamics_controller::ParamListener>(get_node());
  return [parameters](const Setup& setup, const reference_parameters::Params& references) {
    const auto params = parameters->get_params();
    requirePhysicalInertia(setup);
    const ReferenceLayout layout(params.reference_interfaces, setup.arm.joints);
    const auto make = [T = setup.period, joints = setup.arm.joints](const ParameterValues& values) {
      using Numbers = std::vector<double>;
      return gainsOf(values.at("gains.natural_frequency").get<Numbers>(),
                     values.at("gains.damping_ratio").get<Numbers>(), T, joints);
    };
    return std::make_unique<FollowerWithGains<ComputedTorque, Gains>>(
        setup, referenceInput(setup, layout, references),
        ChangingGains<Gains>(setup.node, {"gains.natural_frequency", "gains.damping_ratio"}, make),
        lawOptions(setup, params.friction.source));
  };
}

}  // namespace inverse_dynamics_controllers
