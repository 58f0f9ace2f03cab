// SPDX-License-Identifier: Apache-2.0
#include "pinocchio_model.hpp"

#include <algorithm>
#include <chain_dynamics/chain.hpp>
#include <chain_dynamics/mechanism.hpp>
#include <chain_dynamics/spatial.hpp>
#include <cstddef>
#include <vector>

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

pinocchio::SE3 placed(const chain_dynamics::Transform<double>& X) { return {X.R, X.p}; }

pinocchio::JointIndex addJoint(Model& model, pinocchio::JointIndex parent,
                               const chain_dynamics::Joint& joint) {
  const pinocchio::SE3 X = placed(joint.placement);
  return isPrismatic(joint)
             ? model.addJoint(parent, Model::JointCollection::Prismatic(), X, joint.name)
             : model.addJoint(parent, Model::JointCollection::Revolute(), X, joint.name);
}

void addLink(Model& model, pinocchio::JointIndex joint, const chain_dynamics::Chain& chain,
             std::size_t i) {
  model.appendBodyToJoint(joint, inertia(chain.links()[i]));
  model.armature[static_cast<Eigen::Index>(joint) - 1] += chain.joints()[i].rotor_inertia;
}

}  // namespace

Model toPinocchio(const chain_dynamics::Chain& chain) {
  Model model;
  model.name = chain.name();
  model.gravity = pinocchio::Motion(chain.gravity(), Eigen::Vector3d::Zero());
  pinocchio::JointIndex last = 0;  // the root link
  for (std::size_t i = 0; i < chain.joints().size(); ++i) {
    last = addJoint(model, last, chain.joints()[i]);
    addLink(model, last, chain, i);
  }
  model.addFrame(Model::Frame("tip", last, placed(chain.tip()), pinocchio::OP_FRAME));
  return model;
}

Models toPinocchio(const std::vector<chain_dynamics::Branch>& branches) {
  using chain_dynamics::Branch;
  Models result;
  Model& model = result.with_gravity;
  model.gravity = pinocchio::Motion(branches[0].chain.gravity(), Eigen::Vector3d::Zero());
  // Pinocchio wants all joints below a joint in a row, so branches that begin alike stand together.
  std::vector<const Branch*> order;
  order.reserve(branches.size());
  for (const Branch& branch : branches) order.push_back(&branch);
  std::sort(order.begin(), order.end(),
            [](const Branch* a, const Branch* b) { return a->link < b->link; });
  const auto links = static_cast<std::size_t>(linkCount(branches));
  std::vector<pinocchio::JointIndex> moving(links, 0);  // joints, of links
  for (const Branch* branch : order) {
    pinocchio::JointIndex last = 0;
    for (std::size_t i = 0; i < branch->link.size(); ++i) {
      pinocchio::JointIndex& joint = moving[static_cast<std::size_t>(branch->link[i])];
      if (joint == 0) {
        joint = addJoint(model, last, branch->chain.joints()[i]);
        for (const chain_dynamics::Follow& entry : branch->S) {
          if (entry.joint != static_cast<Eigen::Index>(i)) continue;
          result.S.push_back(
              {static_cast<Eigen::Index>(joint) - 1, entry.coordinate, entry.factor});
        }
        result.s.push_back(branch->s[i]);
        result.link.push_back(branch->link[i]);
      }
      last = joint;
      addLink(model, last, branch->chain, i);
    }
  }
  for (const Branch& branch : branches) {
    model.addFrame(Model::Frame(branch.tip, moving[static_cast<std::size_t>(branch.link.back())],
                                placed(branch.chain.tip()), pinocchio::OP_FRAME));
  }
  result.without_gravity = model;
  result.without_gravity.gravity.setZero();
  return result;
}

}  // namespace v2
}  // namespace pinocchio_inverse_dynamics_solver
