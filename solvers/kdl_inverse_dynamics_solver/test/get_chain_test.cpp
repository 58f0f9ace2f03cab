// SPDX-License-Identifier: Apache-2.0
/// @file
/// Chains between any two links are those of KDL's Tree::getChain: joints, signs, bodies and tip.

#include <gtest/gtest.h>

#include <cstddef>
#include <cstdlib>
#include <kdl/chain.hpp>
#include <kdl/frames.hpp>
#include <kdl/joint.hpp>
#include <kdl/rigidbodyinertia.hpp>
#include <kdl/rotationalinertia.hpp>
#include <kdl/tree.hpp>
#include <string>
#include <utility>
#include <vector>

#include "chain_dynamics/chain.hpp"
#include "chain_dynamics/robot_description.hpp"
#include "chain_dynamics/spatial.hpp"
#include "chain_dynamics/urdf.hpp"
#include "inverse_dynamics_solver/conformance/reference_values.hpp"
#include "kdl_chain.hpp"
#include "kdl_workspace.hpp"

namespace kdl_inverse_dynamics_solver::get_chain_test {

using chain_dynamics::RobotDescription;

/// [N m, N, m] Frames of KDL's chain are those of the description, ours are turned to z.
constexpr double kRounding = 1e-11;

const Eigen::Vector3d kGravity(1, -2, -9);

chain_dynamics::RobotDescription obliqueArm() {
  using namespace inverse_dynamics_solver::conformance;  // NOLINT(google-build-using-namespace)
  return chain_dynamics::robotFromUrdf(textOf(robotsFile("urdf/oblique_arm.urdf")));
}

KDL::RigidBodyInertia inertiaOf(const RobotDescription::Link& link) {
  if (!link.inertial) return KDL::RigidBodyInertia::Zero();
  const auto& [line, X, mass, I] = *link.inertial;
  const KDL::RotationalInertia moments(I(0, 0), I(1, 1), I(2, 2), I(0, 1), I(0, 2), I(1, 2));
  return toKdl(X) * KDL::RigidBodyInertia(mass, KDL::Vector::Zero(), moments);
}

/// The tree that kdl_parser makes: a segment for each link but the root, which KDL makes massless.
KDL::Tree treeOf(const RobotDescription& robot) {
  KDL::Tree tree(robot.links[robot.root].name);
  for (const std::size_t i : robot.linksBelow(robot.root)) {
    if (i == robot.root) continue;
    const RobotDescription::Link& link = robot.links[i];
    const RobotDescription::Joint& joint = robot.joints[link.parent_joint];
    const KDL::Frame X = toKdl(joint.placement);
    const auto type = joint.type == RobotDescription::JointType::kPrismatic ? KDL::Joint::TransAxis
                                                                            : KDL::Joint::RotAxis;
    const KDL::Joint moving(joint.name, X.p, X.M * toKdl(joint.axis), type);
    tree.addSegment(
        KDL::Segment(link.name,
                     isMovable(joint) ? moving : KDL::Joint(joint.name, KDL::Joint::Fixed), X,
                     inertiaOf(link)),
        robot.links[joint.parent].name);
  }
  return tree;
}

std::vector<std::string> jointsOf(const KDL::Chain& chain) {
  std::vector<std::string> names;
  for (const KDL::Segment& segment : chain.segments) {
    const KDL::Joint& joint = segment.getJoint();
    if (joint.getType() != KDL::Joint::Fixed) names.push_back(joint.getName());
  }
  return names;
}

TEST(KdlChain, IsThatOfGetChainBetweenAnyTwoLinks) {
  const RobotDescription robot = obliqueArm();
  const KDL::Tree tree = treeOf(robot);
  for (const auto& [root, tip] :
       std::vector<std::pair<std::string, std::string>>{{"floor", "tool"},
                                                        {"tool", "floor"},
                                                        {"wrist", "upper"},
                                                        {"cover", "tool"},
                                                        {"finger", "cover"},
                                                        {"finger", "tool"},
                                                        {"slide", "pedestal"}}) {
    SCOPED_TRACE(root + " to " + tip);
    KDL::Chain theirs;
    ASSERT_TRUE(tree.getChain(root, tip, theirs));
    chain_dynamics::UrdfOptions options;
    options.root = root;
    options.tip = tip;
    options.gravity = kGravity;
    options.lump_attached = false;  // getChain leaves out what is beside the chain
    const chain_dynamics::Chain chain = chainFromRobot(robot, options);
    ASSERT_EQ(chain.jointNames(), jointsOf(theirs));

    KdlWorkspace ours(toKdl(chain), toKdl(kGravity), toKdl(chain.tip()));
    KdlWorkspace expected(theirs, toKdl(kGravity));
    const Eigen::Index n = chain.jointCount();
    std::srand(3);  // Eigen's random numbers
    for (int k = 0; k < 5; ++k) {
      const Eigen::VectorXd q = Eigen::VectorXd::Random(n), qd = Eigen::VectorXd::Random(n),
                            qdd = Eigen::VectorXd::Random(n);
      Eigen::VectorXd tau(n), their_tau(n);
      ours.torques(q, qd, qdd, tau);
      expected.torques(q, qd, qdd, their_tau);
      EXPECT_LE((tau - their_tau).cwiseAbs().maxCoeff(), kRounding) << their_tau.transpose();

      Eigen::MatrixXd J(6, n), their_J(6, n);
      ours.tipJacobian(0, q, J);
      expected.tipJacobian(0, q, their_J);
      EXPECT_LE((J - their_J).cwiseAbs().maxCoeff(), kRounding);
      chain_dynamics::Transform<double> X, their_X;
      ours.tipPose(0, q, X);
      expected.tipPose(0, q, their_X);
      EXPECT_LE((X.p - their_X.p).cwiseAbs().maxCoeff(), kRounding);
      EXPECT_LE((X.R - their_X.R).cwiseAbs().maxCoeff(), kRounding);
    }
  }
}

}  // namespace kdl_inverse_dynamics_solver::get_chain_test
