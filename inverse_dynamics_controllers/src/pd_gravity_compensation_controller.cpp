// SPDX-License-Identifier: Apache-2.0
#include "inverse_dynamics_controllers/pd_gravity_compensation_controller.hpp"

#include <inverse_dynamics_control/pd_gravity_compensation.hpp>
#include <inverse_dynamics_controllers/pd_gravity_compensation_controller_parameters.hpp>
#include <utility>

#include "follower.hpp"
#include "pd_gains.hpp"

namespace inverse_dynamics_controllers {

using inverse_dynamics_control::JointState;
using inverse_dynamics_control::LawOptions;
using inverse_dynamics_control::PdGains;
using inverse_dynamics_control::PdGravityCompensation;
using inverse_dynamics_control::Status;

namespace {

class PdFollower : public Follower {
 public:
  PdFollower(const Setup& setup, ReferenceInput input, ChangingGains<PdGains> gains,
             const LawOptions& options)
      : Follower(ControlLoop(setup), std::move(input)),
        gains_(std::move(gains)),
        law_(setup.arm.solver, gains_.initial(), options) {}

  inverse_dynamics_control::ControlLaw& law() noexcept override { return law_; }

  Status update(const JointState& state, const std::vector<double>&, double dt,
                Eigen::VectorXd& tau) noexcept override {
    if (const PdGains* const changed = gains_.changed()) law_.setGains(*changed);
    return law_.update(state, *input().motion(), dt, tau);
  }

 private:
  ChangingGains<PdGains> gains_;
  PdGravityCompensation law_;
};

}  // namespace

PdGravityCompensationController::PdGravityCompensationController() = default;
PdGravityCompensationController::~PdGravityCompensationController() = default;

void PdGravityCompensationController::declareParameters() {
  parameters_ = std::make_shared<pd_gravity_compensation_controller::ParamListener>(get_node());
}

std::unique_ptr<Follower> PdGravityCompensationController::makeFollower(
    const Setup& setup, const reference_parameters::Params& references) {
  const auto params = parameters_->get_params();
  const ReferenceLayout layout(params.reference_interfaces, setup.arm.joints);
  return std::make_unique<PdFollower>(setup, referenceInput(setup, layout, references),
                                      pdGains(setup), lawOptions(setup, params.friction.source));
}

}  // namespace inverse_dynamics_controllers
