// SPDX-License-Identifier: Apache-2.0
#include "inverse_dynamics_controllers/inverse_dynamics_controller.hpp"

#include <inverse_dynamics_control/computed_torque.hpp>
#include <inverse_dynamics_controllers/inverse_dynamics_controller_parameters.hpp>

#include "arm.hpp"
#include "follower.hpp"

namespace inverse_dynamics_controllers {

using controller_interface::CallbackReturn;
using inverse_dynamics_control::ComputedTorque;
using inverse_dynamics_control::Gains;
using inverse_dynamics_control::JointState;
using inverse_dynamics_control::Status;
using inverse_dynamics_solver::errorText;
using inverse_dynamics_solver::InvalidParameterValueException;

namespace {

// Errors go through H: a negative diagonal entry would make that joint's feedback positive.
void requirePhysicalInertia(const Arm& arm, const std::string& plugin_name) {
  if (arm.solver->inertiaIsPhysical()) return;
  throw InvalidParameterValueException(
      errorText("parameter 'plugin_name'", "not fit for computed torque",
                "a solver whose inertia matrix is symmetric and positive definite",
                plugin_name + ", whose inertiaIsPhysical() is false",
                "use inverse_dynamics_controllers/FeedForwardController with it, or here a solver "
                "made from the robot's URDF"));
}

Gains gainsOf(const inverse_dynamics_controller::Params& params, const Arm& arm) {
  if (params.gains.natural_frequency.empty()) {
    throw inverse_dynamics_solver::ParameterUninitializedException(
        errorText("parameter 'gains.natural_frequency'", "not set", "numbers above zero [rad/s]",
                  "nothing", "start with 10 and double it while the arm is quiet"));
  }
  return Gains::of(
      jointNumbers("gains.natural_frequency", params.gains.natural_frequency, arm.joints),
      jointNumbers("gains.damping_ratio", params.gains.damping_ratio, arm.joints));
}

class ComputedTorqueFollower : public Follower {
 public:
  ComputedTorqueFollower(ControlLoop loop, ReferenceInput input, ComputedTorque law)
      : Follower(std::move(loop), std::move(input)), law_(std::move(law)) {}

  inverse_dynamics_control::ControlLaw& law() noexcept override { return law_; }

  Status update(const JointState& state, const std::vector<double>&, double dt,
                Eigen::VectorXd& tau) noexcept override {
    return law_.update(state, input().motion(), dt, tau);
  }

 private:
  ComputedTorque law_;
};

}  // namespace

InverseDynamicsController::InverseDynamicsController() = default;
InverseDynamicsController::~InverseDynamicsController() = default;

CallbackReturn InverseDynamicsController::on_init() {
  return transition(get_node()->get_logger(), [this] {
    parameters_ = std::make_shared<inverse_dynamics_controller::ParamListener>(get_node());
  });
}

std::unique_ptr<Follower> InverseDynamicsController::makeFollower() {
  const auto params = parameters_->get_params();
  const ArmParameters arm_parameters = armParameters(params);
  const Arm arm = makeArm(get_node(), arm_parameters, robotDescriptionOf(*this));
  requirePhysicalInertia(arm, params.plugin_name);
  const ReferenceLayout layout(params.reference_interfaces, arm.joints);
  return std::make_unique<ComputedTorqueFollower>(
      ControlLoop(get_node(), arm.joints, params.tolerated_fault_time),
      referenceInput(get_node(), layout, arm, params),
      ComputedTorque(arm.solver, gainsOf(params, arm),
                     lawOptions(arm, arm_parameters, get_update_rate())));
}

}  // namespace inverse_dynamics_controllers
