// SPDX-License-Identifier: Apache-2.0
#include "inverse_dynamics_controllers/feed_forward_controller.hpp"

#include <inverse_dynamics_control/control_law.hpp>
#include <inverse_dynamics_control/feed_forward.hpp>
#include <inverse_dynamics_control/pd_gravity_compensation.hpp>
#include <inverse_dynamics_control/signals.hpp>
#include <inverse_dynamics_control/status.hpp>
#include <inverse_dynamics_controllers/feed_forward_controller_parameters.hpp>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "follower.hpp"

namespace inverse_dynamics_controllers {

using inverse_dynamics_control::FeedForward;
using inverse_dynamics_control::JointState;
using inverse_dynamics_control::LawOptions;
using inverse_dynamics_control::ModelState;
using inverse_dynamics_control::Reference;
using inverse_dynamics_control::Status;

namespace {

// Without a motion among the references, the model is evaluated at the measured state.
ModelState modelState(const feed_forward_controller::Params& params,
                      const ReferenceLayout& layout) {
  return params.model_state == "measured" || !layout.hasMotion() ? ModelState::kMeasured
                                                                 : ModelState::kReference;
}

std::string frictionSource(const feed_forward_controller::Params& params,
                           const ReferenceLayout& layout) {
  const std::string& source = params.friction.source;
  if (source == "automatic") return layout.hasMotion() ? "reference_velocity" : "none";
  if (layout.hasMotion() || source != "reference_velocity") return source;
  throw inverse_dynamics_solver::InvalidParameterValueException(
      "parameter 'friction.source'", "no such velocity",
      "none or measured_velocity, as reference_interfaces has no velocity", "reference_velocity",
      "set one of them");
}

// Own gains about a reference in addition to the model's torque.
using inverse_dynamics_control::PdGains;

class FeedForwardFollower : public Follower {
 public:
  FeedForwardFollower(const Setup& setup, ReferenceInput input, ChangingGains<PdGains> changing,
                      FeedForward law)
      : Follower(ControlLoop(setup), std::move(input)),
        changing_(std::move(changing)),
        gains_(changing_.initial()),
        law_(std::move(law)),
        effort_(Eigen::VectorXd::Zero(gains_.Kp.size())),
        at_state_(gains_.Kp.size()) {}

  inverse_dynamics_control::ControlLaw& law() noexcept override { return law_; }

  Status update(const JointState& state, const std::vector<double>& references, double dt,
                Eigen::VectorXd& tau) noexcept override {
    if (const PdGains* const changed = changing_.changed()) gains_ = *changed;
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
    const Reference& reference = *input().motion();
    effort_ += P.cwiseProduct(law_.positionError(reference.q, state.q)) +
               D.cwiseProduct(reference.qd - state.qd);
    return law_.update(state, reference, effort_, dt, tau);
  }

 private:
  ChangingGains<PdGains> changing_;
  PdGains gains_;
  FeedForward law_;
  Eigen::VectorXd effort_;  // scratch
  Reference at_state_;      // scratch: the measured state, going on as it is
};

}  // namespace

FollowingController::MakeFollower FeedForwardController::declareParameters() {
  const auto parameters = std::make_shared<feed_forward_controller::ParamListener>(get_node());
  return [parameters](const Setup& setup, const reference_parameters::Params& references) {
    const auto params = parameters->get_params();
    const ReferenceLayout layout(params.reference_interfaces, setup.arm.joints);
    const LawOptions options = lawOptions(setup, frictionSource(params, layout));
    return std::make_unique<FeedForwardFollower>(
        setup, referenceInput(setup, layout, references), pdGains(setup),
        FeedForward(setup.arm.solver, modelState(params, layout), options));
  };
}

}  // namespace inverse_dynamics_controllers
