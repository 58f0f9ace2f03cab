// SPDX-License-Identifier: Apache-2.0
#include "two_link_solver.hpp"

#include <chain_dynamics/chain.hpp>
#include <cmath>
#include <limits>
#include <memory>
#include <pluginlib/class_list_macros.hpp>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "two_link_arm.hpp"

namespace two_link_solver {
namespace {

/// An error whose class is this library's alone.
class OwnError : public InvalidParameterValueException {
 public:
  using InvalidParameterValueException::InvalidParameterValueException;
};

bool known(const std::string& link) { return link.empty() || link == "base" || link == "tip"; }

}  // namespace

auto TwoLinkSolver::configure(const Configuration& configuration) -> JointInfo {
  const std::string fault = configuration.get<std::string>("fault").value_or("");
  if (fault == "members set before checks") gravity_ = configuration.gravity;

  if (fault == "error of its own class") throw OwnError(fault);

  // Enough of a reader of robot descriptions to refuse what isn't one.
  const std::string& text = configuration.robot_description;
  if (fault != "any description will do") {
    if (text.empty()) chainFromDescription(configuration);  // throws
    if (text != "<robot/>") throw InvalidRobotDescriptionException("not a robot: " + text);
  }
  if (!known(configuration.root) || !known(configuration.tip)) {
    throw InvalidRobotDescriptionException("no link " + configuration.root + configuration.tip);
  }
  JointInfo info;
  info.joint_names = {"shoulder", fault == "two joints of one name" ? "shoulder" : "elbow"};
  info.joint_types.assign(2, chain_dynamics::JointType::kContinuous);

  if (fault != "unknown parameters are refused too late") configuration.rejectOthers();
  friction_ = configuration.friction || fault == "friction can't be switched off";
  if (fault != "first gravity is kept" || !isInitialized()) gravity_ = configuration.gravity;
  if (fault == "another default gravity" && !configuration.gravity_given) gravity_ *= -1.0;
  if (fault == "namespace is ignored") {
    const auto g = configuration.parameters.get<std::vector<double>>("gravity");
    if (g) gravity_ = Eigen::Vector3d((*g)[0], (*g)[1], (*g)[2]);
  }
  fault_ = fault;
  const bool falls = !has("regressor lacks gravity");
  chain_ = std::make_unique<const chain_dynamics::Chain>(
      chain(falls ? gravity_ : Eigen::Vector3d(0.0, 0.0, 0.0)));
  return info;
}

void TwoLinkSolver::computeInertiaMatrix(const ConstVectorRef& q, MatrixRef H) const {
  const double coupling = m2 * l1 * l2 * std::cos(q[1]);
  H(0, 0) = (m1 + m2) * l1 * l1 + m2 * l2 * l2 + 2.0 * coupling;
  H(0, 1) = m2 * l2 * l2 + coupling;
  if (!has("an entry is not written")) H(1, 0) = H(0, 1);
  H(1, 1) = m2 * l2 * l2;
  if (has("inertia is not symmetric")) H(1, 0) *= 1.1;
  if (has("inertia is not positive")) H *= -1.0;
}

void TwoLinkSolver::computeCoriolisVector(const ConstVectorRef& q, const ConstVectorRef& qd,
                                          VectorRef c) const {
  const double k = m2 * l1 * l2 * std::sin(q[1]);
  c[0] = -k * (2.0 * qd[0] * qd[1] + qd[1] * qd[1]);
  c[1] = k * qd[0] * qd[0];
  if (has("Coriolis torques are linear")) c += qd;
  if (has("Coriolis torques with the wrong sign")) c *= -1.0;
  if (has("allocates")) c = Eigen::VectorXd(c + c) / 2.0;
  if (has("NaN is swallowed") && std::isnan(c[1])) c[1] = 0.0;
}

void TwoLinkSolver::computeGravityVector(const ConstVectorRef& q, VectorRef g) const {
  if (has("state is shared")) {
    shared_ = q[0];
    std::this_thread::yield();
    g.setConstant(shared_);
    return;
  }
  // A link that hangs at angle a pulls with s(a) per mass and length.
  const auto s = [this](double a) {
    return gravity_.x() * std::cos(a) - gravity_.z() * std::sin(a);
  };
  g[1] = m2 * l2 * s(q[0] + q[1]);
  g[0] = (m1 + m2) * l1 * s(q[0]) + g[1];
  if (has("gravity torques have an offset")) g[1] += 1.0;
  if (has("torques change with a turn")) g[0] += 1e-6 * q[0];
  if (has("gravity torques have no potential")) g[1] *= 1.1;
  if (has("a result is not finite")) g[0] = std::numeric_limits<double>::infinity();
}

void TwoLinkSolver::computeFriction(const ConstVectorRef&, const ConstVectorRef& qd,
                                    VectorRef f) const {
  if (!friction_) {
    f.setZero();
  } else if (has("friction overflows")) {
    f = qd.array().exp() / (1.0 + qd.array().exp());
  } else {
    f = 0.3 * qd.array() + qd.array().tanh();
  }
}

void TwoLinkSolver::computeDynamicComponents(const ConstVectorRef& q, const ConstVectorRef& qd,
                                             MatrixRef H, VectorRef c, VectorRef g) const {
  InverseDynamicsSolver::computeDynamicComponents(q, qd, H, c, g);
  if (has("components differ")) g[0] += 1e-6;
}

void TwoLinkSolver::computeTorques(const ConstVectorRef& q, const ConstVectorRef& qd,
                                   const ConstVectorRef& qdd, VectorRef tau) const {
  InverseDynamicsSolver::computeTorques(q, qd, qdd, tau);
  if (has("torques lack a term")) tau[0] -= 1e-6 * qd[0];
  if (has("torques are not linear")) tau += 1e-6 * qdd.cwiseAbs2();
}

void TwoLinkSolver::computeTorquesBatch(const ConstStates& q, const ConstStates& qd,
                                        const ConstStates& qdd, const States& tau) const {
  InverseDynamicsSolver::computeTorquesBatch(q, qd, qdd, tau);
  if (has("last state of a batch is missed") && tau.count > 1) tau(0, tau.count - 1) += 1.0;
  if (has("layouts are ignored") && tau.joint_step != 1) tau(0, 0) += 1e-6;
  if (has("parts of a batch differ") && tau.count < 4096) tau(0, 0) += 1e-13;
}

TwoLinkSolver::Gains TwoLinkSolver::driveGains() const {
  static constexpr double kGains[] = {2.0, 4.0}, kZero[] = {2.0, 0.0};  // N m/A
  if (has("currents allocate")) fault_.reserve(2 * fault_.capacity());
  return Gains(has("a drive gain is zero") ? kZero : kGains, 2);
}

}  // namespace two_link_solver

PLUGINLIB_EXPORT_CLASS(two_link_solver::TwoLinkSolver,
                       inverse_dynamics_solver::InverseDynamicsSolver)
