// SPDX-License-Identifier: Apache-2.0
#include "inverse_dynamics_controllers/feed_forward_controller.hpp"

#include <inverse_dynamics_control/feed_forward.hpp>
#include <inverse_dynamics_controllers/feed_forward_controller_parameters.hpp>

#include "arm.hpp"
#include "follower.hpp"

namespace inverse_dynamics_controllers {

using controller_interface::CallbackReturn;
using inverse_dynamics_control::FeedForward;
using inverse_dynamics_control::FrictionSource;
using inverse_dynamics_control::JointState;
using inverse_dynamics_control::LawOptions;
using inverse_dynamics_control::ModelState;
using inverse_dynamics_control::Reference;
using inverse_dynamics_control::Status;

namespace {

// Without a motion among the references the model is asked at the measured state.
ModelState modelState(const feed_forward_controller::Params& params,
                      const ReferenceLayout& layout) {
  return params.model_state == "measured" || !layout.hasMotion() ? ModelState::kMeasured
                                                                 : ModelState::kReference;
}

void requireReferenceVelocity(const LawOptions& options, const ReferenceLayout& layout) {
  if (layout.hasMotion() || options.friction.source != FrictionSource::kReferenceVelocity) return;
  throw inverse_dynamics_solver::InvalidParameterValueException(inverse_dynamics_solver::errorText(
      "parameter 'friction.source'", "no such velocity",
      "none or measured_velocity, as reference_interfaces has no velocity", "reference_velocity",
      "set one of them"));
}

/// Own gains about a reference beside the model's torque: n; N m/rad, N m s/rad.
struct OwnGains {
  Eigen::VectorXd P, D;
};

class FeedForwardFollower : public Follower {
 public:
  FeedForwardFollower(ControlLoop loop, ReferenceInput input, FeedForward law, OwnGains gains)
      : Follower(std::move(loop), std::move(input)),
        law_(std::move(law)),
        gains_(std::move(gains)),
        effort_(Eigen::VectorXd::Zero(gains_.P.size())),
        at_state_(gains_.P.size()) {}

  inverse_dynamics_control::ControlLaw& law() noexcept override { return law_; }

  Status update(const JointState& state, const std::vector<double>& references, double dt,
                Eigen::VectorXd& tau) noexcept override {
    const auto& [P, D] = gains_;
    const bool motion = input().layout().hasMotion();
    // A stop needs feedback: own gains on a motion; else the safe torque brakes.
    const bool has_feedback = motion && (P.array() > 0).all() && (D.array() > 0).all();
    if (input().stopped() && !has_feedback) return law_.hold(state, dt, tau);
    input().effort(references, effort_);
    if (!motion) {
      at_state_.q = state.q;
      at_state_.qd = state.qd;
      return law_.update(state, at_state_, effort_, dt, tau);
    }
    const Reference& reference = input().motion();
    effort_ += P.cwiseProduct(reference.q - state.q) + D.cwiseProduct(reference.qd - state.qd);
    return law_.update(state, reference, effort_, dt, tau);
  }

 private:
  FeedForward law_;
  OwnGains gains_;
  Eigen::VectorXd effort_;  // scratch
  Reference at_state_;      // scratch: the measured state, going on as it is
};

}  // namespace

FeedForwardController::FeedForwardController() = default;
FeedForwardController::~FeedForwardController() = default;

CallbackReturn FeedForwardController::on_init() {
  return transition(get_node()->get_logger(), [this] {
    parameters_ = std::make_shared<feed_forward_controller::ParamListener>(get_node());
  });
}

std::unique_ptr<Follower> FeedForwardController::makeFollower() {
  const auto params = parameters_->get_params();
  const ArmParameters arm_parameters = armParameters(params);
  const Arm arm = makeArm(get_node(), arm_parameters, robotDescriptionOf(*this));
  const ReferenceLayout layout(params.reference_interfaces, arm.joints);
  const LawOptions options = lawOptions(arm, arm_parameters, get_update_rate());
  requireReferenceVelocity(options, layout);
  return std::make_unique<FeedForwardFollower>(
      ControlLoop(get_node(), arm.joints, params.tolerated_fault_time),
      referenceInput(get_node(), layout, arm, params),
      FeedForward(arm.solver, modelState(params, layout), options),
      OwnGains{jointNumbers("gains.p", params.gains.p, arm.joints),
               jointNumbers("gains.d", params.gains.d, arm.joints)});
}

}  // namespace inverse_dynamics_controllers
