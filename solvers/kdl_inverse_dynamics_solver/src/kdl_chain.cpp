// SPDX-License-Identifier: Apache-2.0
#include "kdl_chain.hpp"

#include <chain_dynamics/chain.hpp>
#include <chain_dynamics/spatial.hpp>
#include <cstddef>
#include <kdl/frames.hpp>
#include <kdl/joint.hpp>
#include <kdl/rigidbodyinertia.hpp>
#include <kdl/segment.hpp>

namespace kdl_inverse_dynamics_solver {
inline namespace v2 {
namespace {

KDL::Rotation rotation(const Eigen::Matrix3d& R) {
  return {R(0, 0), R(0, 1), R(0, 2), R(1, 0), R(1, 1), R(1, 2), R(2, 0), R(2, 1), R(2, 2)};
}

/// KDL wants the center of mass and the inertia about it; ours is about the origin of the frame.
KDL::RigidBodyInertia inertia(const chain_dynamics::LinkParameters& link) {
  const double m = link.mass;
  // (Masses are positive or zero, so without mass there is no first moment.)
  const Eigen::Vector3d c = m == 0.0 ? Eigen::Vector3d::Zero() : (link.first_moment / m).eval();

  // I_c = I + m [c]x [c]x (parallel axes)
  const Eigen::Matrix3d c_x = chain_dynamics::skew<double>(c);
  const Eigen::Matrix3d I_c = link.inertia + m * c_x * c_x;
  return KDL::RigidBodyInertia(
      m, toKdl(c),
      KDL::RotationalInertia(I_c(0, 0), I_c(1, 1), I_c(2, 2), I_c(0, 1), I_c(0, 2), I_c(1, 2)));
}

}  // namespace

KDL::Vector toKdl(const Eigen::Vector3d& vector) { return {vector.x(), vector.y(), vector.z()}; }

KDL::Frame toKdl(const chain_dynamics::Transform<double>& pose) {
  return {rotation(pose.R), toKdl(pose.p)};
}

KDL::Chain toKdl(const chain_dynamics::Chain& chain) {
  KDL::Chain result;
  for (Eigen::Index i = 0; i < chain.jointCount(); ++i) {
    const chain_dynamics::Joint& joint = chain.joints()[static_cast<std::size_t>(i)];
    const KDL::Frame X = toKdl(joint.placement);

    // The axis is z of the link's frame; KDL wants it in the frame of the parent link.
    const auto type = isPrismatic(joint) ? KDL::Joint::TransAxis : KDL::Joint::RotAxis;
    const KDL::Joint kdl_joint(joint.name, X.p, X.M.UnitZ(), type, 1.0, 0.0, joint.rotor_inertia);
    result.addSegment(KDL::Segment(joint.name, kdl_joint, X,
                                   inertia(chain.links()[static_cast<std::size_t>(i)])));
  }
  return result;
}

}  // namespace v2
}  // namespace kdl_inverse_dynamics_solver
