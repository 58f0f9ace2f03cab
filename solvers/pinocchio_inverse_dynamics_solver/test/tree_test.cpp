// SPDX-License-Identifier: Apache-2.0
/// @file
/// Pinocchio's trees as the judge of mechanisms: every quantity of random trees whose joints slide, turn
/// and mimic each other across branches.
///
/// Public descriptions, which the project doesn't contain, were compared in the same way (joints, tips):
/// OpenArm's two arms with grippers (18, 4), Robotiq 2F-85 and 2F-140 (6 each, of which 5 mimic), TIAGo (48,
/// 11), its two arms (17, 3) and one of them with a hand (50, 7), TIAGo Pro (33, 13), TALOS (44, 13) and its
/// upper body (32, 15), PR2 (30, 10) and its arms with torso (15, 2; with grippers 29, 9), Baxter (19, 5),
/// Allegro hand (16, 4). They differ by at most 7e-14 of one plus the greatest entry.
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>
#include <chain_dynamics/chain.hpp>
#include <chain_dynamics/fast_model.hpp>
#include <chain_dynamics/friction.hpp>
#include <chain_dynamics/friction_laws/smooth_coulomb.hpp>
#include <chain_dynamics/mechanism.hpp>
#include <chain_dynamics/model.hpp>
#include <chain_dynamics/robot_description.hpp>
#include <chain_dynamics/urdf.hpp>
#include <cmath>
#include <cstddef>
#include <inverse_dynamics_solver/conformance/allocation_guard.hpp>
#include <iomanip>
#include <map>
#include <memory>
#include <pinocchio/algorithm/crba.hpp>
#include <pinocchio/algorithm/energy.hpp>
#include <pinocchio/algorithm/frames.hpp>
#include <pinocchio/algorithm/jacobian.hpp>
#include <pinocchio/algorithm/kinematics.hpp>
#include <pinocchio/algorithm/regressor.hpp>
#include <pinocchio/algorithm/rnea-derivatives.hpp>
#include <pinocchio/algorithm/rnea.hpp>
#include <random>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "described_tree.hpp"
#include "pinocchio_model.hpp"
#include "pinocchio_workspace.hpp"

namespace {

using chain_dynamics::FastModel;
using chain_dynamics::LinkParameters;
using chain_dynamics::Mechanism;
using chain_dynamics::RobotDescription;
using Eigen::Index, Eigen::Matrix3d, Eigen::MatrixXd, Eigen::Vector3d, Eigen::VectorXd;
using TreeModel = pinocchio_inverse_dynamics_solver::Model;
using TreeData = pinocchio_inverse_dynamics_solver::Data;

/// Relative to the greatest entry.
constexpr double kRounding = 1e-10;

const Vector3d kGravity(1.0, -2.0, -9.0);

class Random {
 public:
  explicit Random(unsigned seed) : engine_(seed) {}
  double operator()() { return 2.0 * engine_() / 4294967295.0 - 1.0; }
  int below(int n) { return static_cast<int>(engine_() % static_cast<unsigned>(n)); }
  VectorXd vector(Index n, double size) {
    return VectorXd::NullaryExpr(n, [&](Index) { return size * (*this)(); });
  }

 private:
  std::mt19937 engine_;
};

std::string three(Random& random, double size) {
  std::ostringstream text;
  text << std::setprecision(17) << size * random() << " " << size * random() << " "
       << size * random();
  return text.str();
}

std::string link(const std::string& name, Random& random) {
  const VectorXd size = random.vector(3, 1).cwiseAbs() + VectorXd::Constant(3, 0.2);
  const Matrix3d turned =
      Eigen::AngleAxisd(random(), random.vector(3, 1).normalized()).toRotationMatrix();
  const Matrix3d moments =
      Vector3d(size[1] + size[2], size[0] + size[2], size[0] + size[1]).asDiagonal();
  const Matrix3d I = 0.05 * turned * moments * turned.transpose();
  std::ostringstream text;
  text << std::setprecision(17) << "<link name='" << name << "'><inertial><origin xyz='"
       << three(random, 0.2) << "' rpy='" << three(random, 1) << "'/><mass value='"
       << 1.5 + random() << "'/><inertia ixx='" << I(0, 0) << "' ixy='" << I(0, 1) << "' ixz='"
       << I(0, 2) << "' iyy='" << I(1, 1) << "' iyz='" << I(1, 2) << "' izz='" << I(2, 2)
       << "'/></inertial></link>\n";
  return text.str();
}

/// A tree of so many joints that move, and some that don't; a quarter of the joints mimic another one.
std::string randomTree(int movable, bool mimics, Random& random) {
  std::ostringstream text;
  text << std::setprecision(17) << "<robot name='tree'>" << link("link_0", random);
  std::vector<std::string> all;
  std::string leader;
  int links = 1, joints = 0;
  while (joints < movable) {
    const std::string name = std::to_string(links);
    const bool fixed = random.below(5) == 0;
    // mostly further along, else a new branch
    const int parent = random.below(3) == 0 ? random.below(links) : links - 1;
    const char* const types[] = {"revolute", "prismatic", "continuous"};
    text << link("link_" + name, random) << "<joint name='joint_" << name << "' type='"
         << (fixed ? "fixed" : types[random.below(3)]) << "'><parent link='link_" << parent
         << "'/><child link='link_" << name << "'/><origin xyz='" << three(random, 0.5) << "' rpy='"
         << three(random, 3) << "'/><axis xyz='" << three(random, 1)
         << "'/><limit lower='-3' upper='3' effort='100' velocity='3'/>";
    if (!fixed) {
      if (mimics && joints > 1 && random.below(4) == 0) {
        // often the same one, as a gripper's fingers
        if (leader.empty() || random.below(2) == 0) {
          leader = all[static_cast<std::size_t>(random.below(joints))];
        }
        text << "<mimic joint='" << leader << "' multiplier='" << 2 * random() << "' offset='"
             << random() << "'/>";
      }
      all.push_back("joint_" + name);
      ++joints;
    }
    text << "</joint>\n";
    ++links;
  }
  text << "</robot>";
  return text.str();
}

/// The tree by Pinocchio, and q_tree = S q + s of the joints that move.
struct Peer {
  Peer(const RobotDescription& robot, const std::vector<std::string>& coordinates,
       const std::map<std::string, double>& rotors)
      : model(pinocchio_inverse_dynamics_solver::toPinocchio(robot)) {
    model.gravity = pinocchio::Motion(kGravity, Vector3d::Zero());
    for (const auto& [joint, inertia] : rotors) {
      model.armature[static_cast<Index>(model.getJointId(joint)) - 1] = inertia;
    }
    S = MatrixXd::Zero(model.nv, static_cast<Index>(coordinates.size()));
    s = VectorXd::Zero(model.nv);
    for (const RobotDescription::Joint& joint : robot.joints) {
      if (!isMovable(joint)) continue;
      const Index row = static_cast<Index>(model.getJointId(joint.name)) - 1;
      double factor = 1;
      const RobotDescription::Joint* leader = &joint;
      for (; leader->mimic; leader = &robot.joints[leader->mimic->joint]) {
        s[row] += factor * leader->mimic->offset;
        factor *= leader->mimic->multiplier;
      }
      const auto found = std::find(coordinates.begin(), coordinates.end(), leader->name);
      if (found != coordinates.end()) S(row, found - coordinates.begin()) = factor;
    }
  }

  TreeModel model;
  MatrixXd S;
  VectorXd s;
};

void expectEqual(const MatrixXd& ours, const MatrixXd& theirs, const char* what) {
  ASSERT_EQ(ours.rows(), theirs.rows()) << what;
  ASSERT_EQ(ours.cols(), theirs.cols()) << what;
  const double scale = 1.0 + theirs.cwiseAbs().maxCoeff();
  EXPECT_LE((ours - theirs).cwiseAbs().maxCoeff(), kRounding * scale) << what;
}

/// A mechanism beside Pinocchio's tree.
class Pair {
 public:
  Pair(const RobotDescription& robot, const std::vector<std::string>& tips,
       const std::map<std::string, double>& rotors, Random& random, bool with_motors = false)
      : model(mechanismOf(robot, tips, rotors, with_motors)),
        peer(robot, model.chain.jointNames(), rotors) {
    if (with_motors) {
      drive(random);
    } else {
      stiffness = rest = rotor = VectorXd::Zero(n());
    }
    q = random.vector(n(), 3);
    qd = random.vector(n(), 2);
    qdd = random.vector(n(), 5);
  }

  /// Puts motors before the joints, each of which moves some of them, and springs beside most motors.
  void drive(Random& random) {
    const Index m = n() - random.below(static_cast<int>(n()));
    chain_dynamics::Motors motors;
    MatrixXd M = MatrixXd::Identity(n(), m);
    for (Index j = 0; j < n(); ++j) {
      if (random.below(2) == 0) M.row(j) += random.vector(m, 1).transpose();
    }
    motors.M = M;
    motors.offset = random.vector(n(), 1);
    rotor = random.vector(m, 1).cwiseAbs();
    motors.rotor_inertia.assign(rotor.begin(), rotor.end());
    const Mechanism joints{model.chain, model.branches};
    model = chain_dynamics::Model(withMotors(joints, motors));
    peer.s += peer.S * motors.offset;
    peer.S = (peer.S * M).eval();
    stiffness = random.vector(m, 9);
    rest = random.vector(m, 1);
    for (Index j = 0; j < m; ++j) {
      const auto type = model.chain.joints()[static_cast<std::size_t>(j)].type;
      if (random.below(4) == 0 || type == chain_dynamics::JointType::kContinuous) stiffness[j] = 0;
    }
    model.stiffness = stiffness;
    model.rest = rest;
    checkModel(model);
  }

  Index n() const { return model.chain.jointCount(); }

  static chain_dynamics::Model mechanismOf(const RobotDescription& robot,
                                           const std::vector<std::string>& tips,
                                           const std::map<std::string, double>& rotors,
                                           bool branches_of_chains) {
    chain_dynamics::UrdfOptions options;
    options.gravity = kGravity;
    options.rotor_inertia = [&](const RobotDescription::Joint& joint) {
      const auto found = rotors.find(joint.name);
      return found == rotors.end() ? 0.0 : found->second;
    };
    return chain_dynamics::Model(mechanismFromRobot(robot, options, tips, branches_of_chains));
  }

  /// Adds a body to the tip of a branch, of both.
  void carry(std::size_t branch) {
    const Vector3d center(0.1, -0.2, 0.3);
    const Matrix3d inertia = Vector3d(0.03, 0.02, 0.04).asDiagonal();
    model = withBodyAtTip(model, LinkParameters::fromCenterOfMass(2, center, inertia), branch);
    const auto& frame = peer.model.frames[peer.model.getFrameId(model.branches[branch].tip)];
#if PINOCCHIO_VERSION_AT_LEAST(3, 0, 0)
    const auto joint = frame.parentJoint;
#else
    const auto joint = frame.parent;
#endif
    peer.model.appendBodyToJoint(joint, pinocchio::Inertia(2, center, inertia), frame.placement);
  }

  void compare() {
    const MatrixXd& S = peer.S;
    const VectorXd q_t = S * q + peer.s, qd_t = S * qd, qdd_t = S * qdd;
    TreeData data(peer.model);

    const VectorXd springs = stiffness.cwiseProduct(q - rest);
    const VectorXd tau = S.transpose() * pinocchio::rnea(peer.model, data, q_t, qd_t, qdd_t) +
                         springs + rotor.cwiseProduct(qdd);
    const VectorXd g =
        S.transpose() * pinocchio::computeGeneralizedGravity(peer.model, data, q_t) + springs;
    const VectorXd c =
        S.transpose() * pinocchio::nonLinearEffects(peer.model, data, q_t, qd_t) - (g - springs);
#if PINOCCHIO_VERSION_AT_LEAST(3, 0, 0)
    pinocchio::crba(peer.model, data, q_t, pinocchio::Convention::LOCAL);
#else
    pinocchio::crba(peer.model, data, q_t);
#endif
    data.M.triangularView<Eigen::StrictlyLower>() =
        data.M.transpose().triangularView<Eigen::StrictlyLower>();
    const MatrixXd H = S.transpose() * data.M * S + MatrixXd(rotor.asDiagonal());
    pinocchio::computeRNEADerivatives(peer.model, data, q_t, qd_t, qdd_t);
    const MatrixXd by_q = S.transpose() * data.dtau_dq * S + MatrixXd(stiffness.asDiagonal());
    const MatrixXd by_qd = S.transpose() * data.dtau_dv * S;

    const FastModel fast(model, FastModel::instructionSets().back());
    VectorXd tau_(n()), c_(n()), g_(n()), forward(n()), alone(n());
    MatrixXd Y(n(), 10 * fast.linkCount());
    MatrixXd H_(n(), n()), H_alone(n(), n()), C(n(), n()), dq(n(), n()), dqd(n(), n()),
        dqdd(n(), n());
    {
      const inverse_dynamics_solver::conformance::AllocationGuard guard;
      fast.torques(q.data(), qd.data(), qdd.data(), tau_.data());
      fast.dynamicComponents(q.data(), qd.data(), H_.data(), n(), c_.data(), g_.data());
      fast.inertiaMatrix(q.data(), H_alone.data(), n());
      fast.coriolisMatrix(q.data(), qd.data(), C.data(), n());
      fast.forwardDynamics(q.data(), qd.data(), tau_.data(), forward.data());
      fast.torqueDerivatives(q.data(), qd.data(), qdd.data(), dq.data(), dqd.data(), dqdd.data(),
                             n());
      fast.regressor(q.data(), qd.data(), qdd.data(), Y.data(), n());
      EXPECT_EQ(guard.count(), 0);
    }
    expectEqual(tau_, tau, "torques");
    expectEqual(H_, H, "H");
    expectEqual(H_alone, H, "H alone");
    expectEqual(c_, c, "C qd");
    expectEqual(g_, g, "g");
    expectEqual(C * qd, c, "C matrix");
    expectEqual(dq, by_q, "dtau/dq");
    expectEqual(dqd, by_qd, "dtau/dqd");
    expectEqual(dqdd, H, "dtau/dqdd");
    expectEqual(H * forward, H * qdd, "forward dynamics");

    // the plain functions
    torques(model, q, qd, qdd, tau_);
    expectEqual(tau_, tau, "plain torques");
    dynamicComponents(model, q, qd, H_, c_, g_);
    expectEqual(H_, H, "plain H");
    expectEqual(c_, c, "plain C qd");
    expectEqual(g_, g, "plain g");
    MatrixXd C_plain(n(), n());
    coriolisMatrix(model, q, qd, C_plain);
    expectEqual(C, C_plain, "plain C");
    torqueDerivatives(model, q, qd, qdd, dq, dqd, dqdd);
    expectEqual(dq, by_q, "plain dtau/dq");
    expectEqual(dqd, by_qd, "plain dtau/dqd");

    const double kinetic = 0.5 * qd.dot(H * qd);  // versions differ about rotors
    EXPECT_NEAR(kineticEnergy(model, q, qd), kinetic, kRounding * (1 + kinetic));
    // apart from a constant: held links that no joint moves count in one of them only
    const VectorXd q_0 = VectorXd::Zero(n());
    const double potential =
        pinocchio::computePotentialEnergy(peer.model, data, q_t) -
        pinocchio::computePotentialEnergy(peer.model, data, VectorXd(peer.s)) +
        0.5 * stiffness.dot(VectorXd((q - rest).cwiseAbs2() - rest.cwiseAbs2()));
    EXPECT_NEAR(potentialEnergy(model, q) - potentialEnergy(model, q_0), potential,
                kRounding * (100 + std::abs(potential)));
    EXPECT_TRUE(model.inertiaIsPhysical());

    compareSolver(Y);
    compareRegressor(fast, Y, data, q_t, qd_t, qdd_t);
    compareBatches(fast);
  }

  /// Each tip, as that of the mechanism whose first branch leads to it.
  void compareTips() {
    const MatrixXd& S = peer.S;
    const VectorXd q_t = S * q + peer.s, qd_t = S * qd;
    TreeData data(peer.model);
    pinocchio::computeJointJacobiansTimeVariation(peer.model, data, q_t, qd_t);
    pinocchio::computeJointJacobians(peer.model, data, q_t);
    pinocchio::updateFramePlacements(peer.model, data);
    for (std::size_t b = 0; b < model.branches.size(); ++b) {
      chain_dynamics::Model turned = model;
      std::swap(turned.branches[0], turned.branches[b]);
      const FastModel fast(turned, FastModel::instructionSets().back());
      const auto frame = peer.model.getFrameId(turned.branches[0].tip);
      pinocchio_inverse_dynamics_solver::Data::Matrix6x J(6, peer.model.nv), dJ(6, peer.model.nv);
      J.setZero();
      dJ.setZero();
      pinocchio::getFrameJacobian(peer.model, data, frame, pinocchio::LOCAL_WORLD_ALIGNED, J);
      pinocchio::getFrameJacobianTimeVariation(peer.model, data, frame,
                                               pinocchio::LOCAL_WORLD_ALIGNED, dJ);
      MatrixXd R(3, 3), J_(6, n()), dJ_(6, n());
      Vector3d p;
      fast.tipPose(q.data(), R.data(), p.data());
      fast.tipJacobian(q.data(), J_.data(), 6);
      fast.tipJacobianDerivative(q.data(), qd.data(), dJ_.data(), 6);
      expectEqual(R, data.oMf[frame].rotation(), "R");
      expectEqual(p, data.oMf[frame].translation(), "p");
      expectEqual(J_, J * S, "J");
      expectEqual(dJ_, dJ * S, "dJ");
      VectorXd tau(n()), tau_of_first(n());
      fast.torques(q.data(), qd.data(), qdd.data(), tau.data());
      torques(model, q, qd, qdd, tau_of_first);
      expectEqual(tau, tau_of_first, "torques with another first branch");
    }
  }

  chain_dynamics::Model model;
  Peer peer;
  VectorXd stiffness, rest, rotor;  // of the coordinates
  VectorXd q, qd, qdd;

 private:
  /// Pinocchio's tree as its solver makes it, from the branches: without springs and inertia of motors.
  void compareSolver(const MatrixXd& Y) {
    using pinocchio_inverse_dynamics_solver::Models, pinocchio_inverse_dynamics_solver::toPinocchio;
    pinocchio_inverse_dynamics_solver::PinocchioWorkspace solver(
        std::make_shared<const Models>(toPinocchio(model.branches)));
    VectorXd ours(n()), theirs(n());
    MatrixXd H(n(), n()), H_(n(), n()), C(n(), n()), C_(n(), n()), dq(n(), n()), Y_(Y);
    torques(model, q, qd, qdd, ours);
    solver.torques(q, qd, qdd, theirs);
    theirs += stiffness.cwiseProduct(q - rest) + rotor.cwiseProduct(qdd);
    expectEqual(theirs, ours, "solver's torques");
    inertiaMatrix(model, q, H);
    solver.inertiaMatrix(q, H_);
    H_.diagonal() += rotor;
    expectEqual(H_, H, "solver's H");
    coriolisMatrix(model, q, qd, C);
    solver.coriolisMatrix(q, qd, C_);
    expectEqual(C_, C, "solver's C");
    torqueDerivatives(model, q, qd, qdd, H, C, dq);
    solver.torqueDerivatives(q, qd, qdd, dq, C_, H_);
    dq.diagonal() += stiffness;
    expectEqual(dq, H, "solver's dtau/dq");
    expectEqual(C_, C, "solver's dtau/dqd");
    solver.regressor(q, qd, qdd, Y_);
    expectEqual(Y_, Y, "solver's Y");
    for (std::size_t tip = 0; tip < model.branches.size(); ++tip) {
      MatrixXd J(6, n());
      solver.tipJacobian(tip, q, J);
      solver.externalTorques(tip, q, pinocchio_inverse_dynamics_solver::WrenchFrame::kRoot,
                             Eigen::VectorXd::Ones(6), theirs);
      expectEqual(theirs, J.colwise().sum().transpose(), "solver's wrench");
    }
  }

  void compareRegressor(const FastModel& fast, const MatrixXd& Y, TreeData& data,
                        const VectorXd& q_t, const VectorXd& qd_t, const VectorXd& qdd_t) {
    const MatrixXd theirs = peer.S.transpose() * pinocchio::computeJointTorqueRegressor(
                                                     peer.model, data, q_t, qd_t, qdd_t);
    MatrixXd p = MatrixXd::Zero(10, fast.linkCount());
    std::vector<std::string> joint_of_link(static_cast<std::size_t>(fast.linkCount()));
    for (const chain_dynamics::Branch& branch : model.branches) {
      for (std::size_t i = 0; i < branch.link.size(); ++i) {
        p.col(branch.link[i]) += branch.chain.links()[i].toVector();
        joint_of_link[static_cast<std::size_t>(branch.link[i])] = branch.chain.joints()[i].name;
      }
    }
    VectorXd tau(n());
    fast.torques(q.data(), qd.data(), qdd.data(), tau.data());
    const VectorXd rotors = peer.model.armature.cwiseProduct(qdd_t);
    expectEqual(Y * p.reshaped() + peer.S.transpose() * rotors + rotor.cwiseProduct(qdd) +
                    stiffness.cwiseProduct(q - rest),
                tau, "Y p");
    if (fast.linkCount() < peer.model.nv) return;  // links that are held are parts of others
    for (Index link = 0; link < fast.linkCount(); ++link) {
      const auto joint = peer.model.getJointId(joint_of_link[static_cast<std::size_t>(link)]);
      const VectorXd theirs_p = peer.model.inertias[joint].toDynamicParameters();
      expectEqual(Y.middleCols(10 * link, 10) * p.col(link),
                  theirs.middleCols(10 * (static_cast<Index>(joint) - 1), 10) * theirs_p,
                  "regressor");
    }
  }

  /// As one by one, in another layout.
  void compareBatches(const FastModel& fast) {
    const Index kStates = 70;  // more than a block
    const auto varied = [kStates](const VectorXd& x) {
      MatrixXd all(kStates, x.size());
      for (Index k = 0; k < kStates; ++k)
        all.row(k) = (1 + 0.01 * static_cast<double>(k)) * x.transpose();
      return all;
    };
    MatrixXd Q = varied(q);
    const MatrixXd QD = varied(qd), QDD = varied(qdd);
    MatrixXd T(kStates, n()), A(kStates, n()), c(n(), kStates), g(n(), kStates);
    MatrixXd H(n(), n() * kStates), dq(H), dqd(H), dqdd(H), C(H);
    MatrixXd Y(n(), 10 * fast.linkCount() * kStates);
    fast.torquesBatch(Q.transpose(), QD.transpose(), QDD.transpose(), T.transpose());
    fast.dynamicComponentsBatch(Q.transpose(), QD.transpose(), H, c, g);
    fast.forwardDynamicsBatch(Q.transpose(), QD.transpose(), T.transpose(), A.transpose());
    fast.torqueDerivativesBatch(Q.transpose(), QD.transpose(), QDD.transpose(), dq, dqd, dqdd);
    fast.coriolisMatrixBatch(Q.transpose(), QD.transpose(), C);
    fast.regressorBatch(Q.transpose(), QD.transpose(), QDD.transpose(), Y);
    for (const Index k : {Index{0}, Index{7}, Index{63}, Index{64}, kStates - 1}) {
      const VectorXd x = Q.row(k), v = QD.row(k), a = QDD.row(k);
      VectorXd tau(n()), c_(n()), g_(n());
      MatrixXd H_(n(), n()), dq_(H_), dqd_(H_), dqdd_(H_), C_(H_), Y_(n(), 10 * fast.linkCount());
      fast.torques(x.data(), v.data(), a.data(), tau.data());
      fast.dynamicComponents(x.data(), v.data(), H_.data(), n(), c_.data(), g_.data());
      fast.torqueDerivatives(x.data(), v.data(), a.data(), dq_.data(), dqd_.data(), dqdd_.data(),
                             n());
      fast.coriolisMatrix(x.data(), v.data(), C_.data(), n());
      fast.regressor(x.data(), v.data(), a.data(), Y_.data(), n());
      expectEqual(T.row(k).transpose(), tau, "batch of torques");
      expectEqual(c.col(k), c_, "batch of C qd");
      expectEqual(g.col(k), g_, "batch of g");
      expectEqual(H.middleCols(k * n(), n()), H_, "batch of H");
      expectEqual(dq.middleCols(k * n(), n()), dq_, "batch of dtau/dq");
      expectEqual(dqd.middleCols(k * n(), n()), dqd_, "batch of dtau/dqd");
      expectEqual(dqdd.middleCols(k * n(), n()), dqdd_, "batch of dtau/dqdd");
      expectEqual(C.middleCols(k * n(), n()), C_, "batch of C");
      expectEqual(Y.middleCols(k * Y_.cols(), Y_.cols()), Y_, "batch of Y");
      expectEqual(H_ * A.row(k).transpose(), H_ * a, "batch of accelerations");
    }
    MatrixXd in_place = Q;  // as of one state: tau may be where q is
    fast.torquesBatch(in_place.transpose(), QD.transpose(), QDD.transpose(), in_place.transpose());
    expectEqual(in_place, T, "torques in place of q");
  }
};

TEST(Tree, AgreesWithPinocchiosTree) {
  Random random(1);
  for (int k = 0; k < 200; ++k) {
    const int joints = 3 + k % 28;
    const bool mimics = k % 4 != 0;
    const std::string urdf = randomTree(joints, mimics, random);
    SCOPED_TRACE("tree " + std::to_string(k));
    const RobotDescription robot = chain_dynamics::robotFromUrdf(urdf);
    std::map<std::string, double> rotors;
    for (const auto& joint : robot.joints) {
      if (isMovable(joint) && random.below(2) == 0) rotors[joint.name] = 0.2 + 0.1 * random();
    }
    std::vector<std::string> tips{"*"};
    if (!mimics) {  // any link that moves; what leads to none of them is held
      tips.clear();
      for (const auto& link : robot.links) {
        const bool moves = link.parent_joint != RobotDescription::kNone &&
                           isMovable(robot.joints[link.parent_joint]);
        if (moves && random.below(3) == 0) tips.push_back(link.name);
      }
      if (tips.empty()) tips = {"*"};
    }
    Pair pair(robot, tips, rotors, random, k % 3 == 0);
    if (pair.model.branches.empty()) continue;  // a chain
    pair.compare();
    pair.compareTips();
    pair.carry(pair.model.branches.size() - 1);
    pair.compare();
    if (HasFailure()) {
      ADD_FAILURE() << urdf;
      return;
    }
  }
}

TEST(Tree, FrictionDependsOnTheLoadOfTheWholeTree) {
  Random random(2);
  const RobotDescription robot = chain_dynamics::robotFromUrdf(randomTree(9, true, random));
  Pair pair(robot, {"*"}, {}, random);
  const Index n = pair.n();
  chain_dynamics::Model model = pair.model;
  chain_dynamics::SmoothCoulomb law;
  law.fv = 0.5;
  law.fc = 2;
  law.width = 0.4;
  law.fl = 0.05;
  model.friction.assign(static_cast<std::size_t>(n), law);
  const VectorXd &q = pair.q, &qd = pair.qd, &qdd = pair.qdd;
  const FastModel bare(pair.model), fast(model);
  VectorXd g(n), f(n), f_(n), tau(n), tau_bare(n);
  bare.gravityVector(q.data(), g.data());
  bare.torques(q.data(), qd.data(), qdd.data(), tau_bare.data());
  frictionVector(model.friction, qd, g, f);
  EXPECT_GT((f - VectorXd(0.5 * qd)).cwiseAbs().minCoeff(), 0.1);
  fast.frictionVector(q.data(), qd.data(), f_.data());
  expectEqual(f_, f, "friction");
  fast.torques(q.data(), qd.data(), qdd.data(), tau.data());
  expectEqual(tau - tau_bare, f, "friction in torques");
  MatrixXd batch(n, 70);
  fast.torquesBatch(q.replicate(1, 70).eval(), qd.replicate(1, 70).eval(),
                    qdd.replicate(1, 70).eval(), batch);
  expectEqual(batch.rightCols(1), tau, "friction in a batch");
  VectorXd qdd_(n);
  fast.forwardDynamics(q.data(), qd.data(), tau.data(), qdd_.data());
  EXPECT_LE((qdd_ - qdd).norm(), 1e-8 * qdd.norm());

  MatrixXd by_q(n, n), by_qd(n, n), by_qdd(n, n);
  fast.torqueDerivatives(q.data(), qd.data(), qdd.data(), by_q.data(), by_qd.data(), by_qdd.data(),
                         n);
  constexpr double kStep = 1e-5;
  for (Index j = 0; j < n; ++j) {
    const VectorXd step = kStep * VectorXd::Unit(n, j);
    const auto slope = [&](const VectorXd& q_step, const VectorXd& qd_step) {
      VectorXd after(n), before(n);
      const VectorXd q_2 = q + q_step, q_1 = q - q_step, qd_2 = qd + qd_step, qd_1 = qd - qd_step;
      fast.torques(q_2.data(), qd_2.data(), qdd.data(), after.data());
      fast.torques(q_1.data(), qd_1.data(), qdd.data(), before.data());
      return VectorXd((after - before) / (2 * kStep));
    };
    const VectorXd zero = VectorXd::Zero(n);
    EXPECT_LE((by_q.col(j) - slope(step, zero)).norm(), 1e-6 * by_q.norm());
    EXPECT_LE((by_qd.col(j) - slope(zero, step)).norm(), 1e-6 * by_qd.norm());
  }
}

}  // namespace
