// SPDX-License-Identifier: Apache-2.0
#include "pinocchio_model.hpp"

#include <chain_dynamics/chain.hpp>
#include <chain_dynamics/spatial.hpp>
#include <cstddef>

namespace pinocchio_inverse_dynamics_solver {
inline namespace v2 {
namespace {

/// Pinocchio wants the center of mass and the inertia about it; ours is about the origin of the
/// frame.
pinocchio::Inertia inertia(const chain_dynamics::LinkParameters& link) {
  const double m = link.mass;
  // (Masses are positive or zero, so without mass there is no first moment.)
  const Eigen::Vector3d c = m == 0.0 ? Eigen::Vector3d::Zero() : (link.first_moment / m).eval();

  // I_c = I + m [c]x [c]x (parallel axes)
  const Eigen::Matrix3d c_x = chain_dynamics::skew<double>(c);
  return {m, c, Eigen::Matrix3d(link.inertia + m * c_x * c_x)};
}

}  // namespace

Model toPinocchio(const chain_dynamics::Chain& chain) {
  Model model;
  model.name = chain.name();
  model.gravity = pinocchio::Motion(chain.gravity(), Eigen::Vector3d::Zero());
  pinocchio::JointIndex last = 0;  // the root link
  for (Eigen::Index i = 0; i < chain.jointCount(); ++i) {
    const chain_dynamics::Joint& joint = chain.joints()[static_cast<std::size_t>(i)];
    const pinocchio::SE3 X(joint.placement.R, joint.placement.p);
    last = isPrismatic(joint)
               ? model.addJoint(last, Model::JointCollection::Prismatic(), X, joint.name)
               : model.addJoint(last, Model::JointCollection::Revolute(), X, joint.name);
    model.appendBodyToJoint(last, inertia(chain.links()[static_cast<std::size_t>(i)]));
    model.armature[i] = joint.rotor_inertia;
  }
  const pinocchio::SE3 tip(chain.tip().R, chain.tip().p);
  model.addFrame(Model::Frame("tip", last, tip, pinocchio::OP_FRAME));
  return model;
}

}  // namespace v2
}  // namespace pinocchio_inverse_dynamics_solver
