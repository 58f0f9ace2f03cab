// SPDX-License-Identifier: Apache-2.0
#include "inverse_dynamics_solver/inverse_dynamics_solver.hpp"

#include <algorithm>
#include <chain_dynamics/chain.hpp>
#include <string>
#include <utility>
#include <vector>

#include "inverse_dynamics_solver/plausibility.hpp"
#include "method_call.hpp"
#include "one_state.hpp"

namespace inverse_dynamics_solver {
inline namespace v2 {
namespace {

using Eigen::Index;

/// Warnings about implausible parameters.
std::vector<std::string> doubts(const InverseDynamicsSolver& solver,
                                const Configuration& configuration) {
  std::vector<std::string> texts = {doubtOf(configuration.gravity)};
  if (dynamic_cast<const Payload*>(&solver) != nullptr) {
    for (const auto& [name, body] : readPayloads(configuration)) texts.push_back(doubtOf(body));
  }
  texts.erase(std::remove(texts.begin(), texts.end(), ""), texts.end());
  return texts;
}

}  // namespace

// ---------------------------------------------------------------- initialization

void InverseDynamicsSolver::initialize(const Parameters& parameters,
                                       const std::string& param_namespace,
                                       const std::string& robot_description) {
  const Configuration configuration =
      readConfiguration(parameters, param_namespace, robot_description);
  JointInfo info = configure(configuration);

  // The solver has changed; one that hasn't refused unknown parameters itself can't go back.
  initialized_ = false;
  configuration.rejectOthers();
  for (const auto& more : {doubts(*this, configuration), configuration.unknownParameters()}) {
    info.warnings.insert(info.warnings.end(), more.begin(), more.end());
  }

  info.joint_types.resize(info.joint_names.size(), chain_dynamics::JointType::kRevolute);
  if (info.tip_names.empty()) info.tip_names.emplace_back();

  // Nothing below can fail.
  info_ = std::move(info);
  batch_threads_ = configuration.batch_threads;
  initialized_ = true;
}

Index InverseDynamicsSolver::jointCount() const {
  requireInitialized("jointCount");
  return static_cast<Index>(info_.joint_names.size());
}

const std::vector<std::string>& InverseDynamicsSolver::jointNames() const {
  requireInitialized("jointNames");
  return info_.joint_names;
}

const std::vector<std::string>& InverseDynamicsSolver::tipNames() const {
  requireInitialized("tipNames");
  return info_.tip_names;
}

const std::vector<chain_dynamics::JointType>& InverseDynamicsSolver::jointTypes() const {
  requireInitialized("jointTypes");
  return info_.joint_types;
}

const std::vector<std::string>& InverseDynamicsSolver::warnings() const {
  requireInitialized("warnings");
  return info_.warnings;
}

bool InverseDynamicsSolver::inertiaIsPhysical() const {
  requireInitialized("inertiaIsPhysical");
  return inertiaIsPhysicalImpl();
}

void InverseDynamicsSolver::requireInitialized(const char* method) const {
  MethodCall(method, *this);
}

// ---------------------------------------------------------------- one state

void InverseDynamicsSolver::getInertiaMatrix(const ConstVectorRef& q, MatrixRef H) const {
  MethodCall("getInertiaMatrix", *this).vector("q", q).matrix("H", H, q.size(), q.size());
  computeInertiaMatrix(q, H);
}

void InverseDynamicsSolver::getCoriolisVector(const ConstVectorRef& q, const ConstVectorRef& qd,
                                              VectorRef c) const {
  MethodCall("getCoriolisVector", *this).vector("q", q).vector("qd", qd).vector("c", c);
  computeCoriolisVector(q, qd, c);
}

void InverseDynamicsSolver::getFrictionVector(const ConstVectorRef& q, const ConstVectorRef& qd,
                                              VectorRef f) const {
  const MethodCall call("getFrictionVector", *this);
  call.vectorOrNothing("q", q).vector("qd", qd).vector("f", f);
  call.positionsOfFriction(q.size());
  computeFriction(q, qd, f);
}

void InverseDynamicsSolver::getGravityVector(const ConstVectorRef& q, VectorRef g) const {
  MethodCall("getGravityVector", *this).vector("q", q).vector("g", g);
  computeGravityVector(q, g);
}

void InverseDynamicsSolver::getDynamicComponents(const ConstVectorRef& q, const ConstVectorRef& qd,
                                                 MatrixRef H, VectorRef c, VectorRef g) const {
  MethodCall("getDynamicComponents", *this)
      .vector("q", q)
      .vector("qd", qd)
      .matrix("H", H, q.size(), q.size())
      .vector("c", c)
      .vector("g", g);
  computeDynamicComponents(q, qd, H, c, g);
}

void InverseDynamicsSolver::getTorques(const ConstVectorRef& q, const ConstVectorRef& qd,
                                       const ConstVectorRef& qdd, VectorRef tau) const {
  MethodCall("getTorques", *this)
      .vector("q", q)
      .vector("qd", qd)
      .vector("qdd", qdd)
      .vector("tau", tau);
  computeTorques(q, qd, qdd, tau);
}

// ---------------------------------------------------------------- defaults

void InverseDynamicsSolver::computeFriction(const ConstVectorRef&, const ConstVectorRef&,
                                            VectorRef f) const {
  f.setZero();
}

void InverseDynamicsSolver::computeDynamicComponents(const ConstVectorRef& q,
                                                     const ConstVectorRef& qd, MatrixRef H,
                                                     VectorRef c, VectorRef g) const {
  computeInertiaMatrix(q, H);
  computeCoriolisVector(q, qd, c);
  computeGravityVector(q, g);
}

void InverseDynamicsSolver::computeTorques(const ConstVectorRef& q, const ConstVectorRef& qd,
                                           const ConstVectorRef& qdd, VectorRef tau) const {
  const Index n = q.size();
  Scratch<kMaxStackJoints * kMaxStackJoints> matrix(n * n);
  Scratch<kMaxStackJoints> vector(n);
  Eigen::Map<Eigen::MatrixXd> H(&matrix[0], n, n);
  Eigen::Map<Eigen::VectorXd> term(&vector[0], n);

  // tau = H qdd + C qd + f + g, each term added as it comes
  computeInertiaMatrix(q, H);
  tau.noalias() = H.lazyProduct(qdd);
  computeCoriolisVector(q, qd, term);
  tau += term;
  computeFriction(q, qd, term);
  tau += term;
  computeGravityVector(q, term);
  tau += term;
}

}  // namespace v2
}  // namespace inverse_dynamics_solver
