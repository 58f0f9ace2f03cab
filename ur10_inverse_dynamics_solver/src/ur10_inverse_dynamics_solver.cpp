// SPDX-License-Identifier: Apache-2.0
#include "ur10_inverse_dynamics_solver/ur10_inverse_dynamics_solver.hpp"

#include <string>
#include <utility>

#include "inverse_dynamics_solver/exceptions.hpp"
#include "rigid_body_inverse_dynamics_solver/model_files.hpp"

namespace ur10_inverse_dynamics_solver {
inline namespace v2 {
namespace {

const char* const kModel = "ur10_identified";

}  // namespace

auto InverseDynamicsSolverUR10::configure(
    const inverse_dynamics_solver::Configuration& configuration) -> JointInfo {
  chain_dynamics::Model model = rigid_body_inverse_dynamics_solver::readModel(kModel);

  // An overlaid workspace may bring another file of that name.
  if (model.chain.jointCount() != NUMBER_OF_JOINTS ||
      model.drive_gains.size() != NUMBER_OF_JOINTS) {
    throw inverse_dynamics_solver::Exception(inverse_dynamics_solver::errorText(
        std::string("model ") + kModel, "not a UR10's",
        std::to_string(NUMBER_OF_JOINTS) + " joints with a drive gain each",
        std::to_string(model.chain.jointCount()) + " joints, " +
            std::to_string(model.drive_gains.size()) + " drive gains",
        "for another robot use rigid_body_inverse_dynamics_solver with its model"));
  }
  return use(std::move(model), configuration);
}

// The current of each term is its torque divided by the gain of its joint, i = K^-1 tau. The
// methods of the base class check their arguments.

void InverseDynamicsSolverUR10::computeCurrents(const ConstVectorRef& q, const ConstVectorRef& qd,
                                                const ConstVectorRef& qdd,
                                                VectorRef currents) const {
  getTorques(q, qd, qdd, currents);
  currents.array() /= model().drive_gains.array();
}

void InverseDynamicsSolverUR10::computeInertiaCurrents(const ConstVectorRef& q,
                                                       MatrixRef currents) const {
  getInertiaMatrix(q, currents);
  currents.array().colwise() /= model().drive_gains.array();
}

void InverseDynamicsSolverUR10::computeCoriolisCurrents(const ConstVectorRef& q,
                                                        const ConstVectorRef& qd,
                                                        VectorRef currents) const {
  getCoriolisVector(q, qd, currents);
  currents.array() /= model().drive_gains.array();
}

void InverseDynamicsSolverUR10::computeGravityCurrents(const ConstVectorRef& q,
                                                       VectorRef currents) const {
  getGravityVector(q, currents);
  currents.array() /= model().drive_gains.array();
}

void InverseDynamicsSolverUR10::computeFrictionCurrents(const ConstVectorRef& qd,
                                                        VectorRef currents) const {
  getFrictionVector(qd, currents);
  currents.array() /= model().drive_gains.array();
}

}  // namespace v2
}  // namespace ur10_inverse_dynamics_solver
