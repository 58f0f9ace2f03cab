// SPDX-License-Identifier: Apache-2.0
#include "inverse_dynamics_solver/inverse_dynamics_solver.hpp"

#include <string>

#include "chain_dynamics/text.hpp"
#include "one_state.hpp"

namespace inverse_dynamics_solver {
inline namespace v2 {
namespace {

using chain_dynamics::joined;
using Eigen::Index;

using StackVector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMaxStackJoints, 1>;
using StackMatrix =
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMaxStackJoints, kMaxStackJoints>;

std::string shape(Index rows, Index cols) {
  return std::to_string(rows) + " x " + std::to_string(cols);
}

// What throws is apart from the checks, which are then small enough to be inlined.
[[noreturn, gnu::noinline]] void throwUninitialized(const char* method) {
  throw UninitializedException(method);
}

[[noreturn, gnu::noinline]] void throwSizeMismatch(const char* method, const char* argument,
                                                   const std::string& expected,
                                                   const std::string& got,
                                                   const std::vector<std::string>& joint_names) {
  throw SizeMismatchException(errorText(std::string(method) + ": argument " + argument,
                                        "wrong size", expected, got,
                                        "the joints are " + joined(joint_names)));
}

[[noreturn, gnu::noinline]] void throwVectorMismatch(const char* method, const char* argument,
                                                     Index size,
                                                     const std::vector<std::string>& joint_names) {
  throwSizeMismatch(method, argument, std::to_string(joint_names.size()) + " numbers",
                    std::to_string(size), joint_names);
}

[[noreturn, gnu::noinline]] void throwMatrixMismatch(const char* method, const char* argument,
                                                     Index expected_cols, Index rows, Index cols,
                                                     const std::vector<std::string>& joint_names) {
  throwSizeMismatch(method, argument, shape(static_cast<Index>(joint_names.size()), expected_cols),
                    shape(rows, cols), joint_names);
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
  for (std::string& warning : configuration.unknownParameters()) {
    info.warnings.push_back(std::move(warning));
  }

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

const std::vector<std::string>& InverseDynamicsSolver::warnings() const {
  requireInitialized("warnings");
  return info_.warnings;
}

bool InverseDynamicsSolver::inertiaIsPhysical() const {
  requireInitialized("inertiaIsPhysical");
  return inertiaIsPhysicalImpl();
}

// ---------------------------------------------------------------- checks

void InverseDynamicsSolver::requireInitialized(const char* method) const {
  if (!initialized_) throwUninitialized(method);
}

void InverseDynamicsSolver::requireVector(const char* method, const char* argument,
                                          Index size) const {
  if (size != static_cast<Index>(info_.joint_names.size())) {
    throwVectorMismatch(method, argument, size, info_.joint_names);
  }
}

void InverseDynamicsSolver::requireMatrix(const char* method, const char* argument, Index rows,
                                          Index cols, Index expected_cols) const {
  const auto n = static_cast<Index>(info_.joint_names.size());
  if (rows != n || cols != expected_cols) {
    throwMatrixMismatch(method, argument, expected_cols, rows, cols, info_.joint_names);
  }
}

void InverseDynamicsSolver::requireStates(const char* method, const char* argument,
                                          const ConstStates& states, Index expected_count) const {
  requireMatrix(method, argument, states.joints, states.count, expected_count);
}

// ---------------------------------------------------------------- one state

void InverseDynamicsSolver::getInertiaMatrix(const ConstVectorRef& q, MatrixRef H) const {
  requireInitialized("getInertiaMatrix");
  requireVector("getInertiaMatrix", "q", q.size());
  requireMatrix("getInertiaMatrix", "H", H.rows(), H.cols(), q.size());
  computeInertiaMatrix(q, H);
}

void InverseDynamicsSolver::getCoriolisVector(const ConstVectorRef& q, const ConstVectorRef& qd,
                                              VectorRef c) const {
  requireInitialized("getCoriolisVector");
  requireVector("getCoriolisVector", "q", q.size());
  requireVector("getCoriolisVector", "qd", qd.size());
  requireVector("getCoriolisVector", "c", c.size());
  computeCoriolisVector(q, qd, c);
}

void InverseDynamicsSolver::getFrictionVector(const ConstVectorRef& qd, VectorRef f) const {
  requireInitialized("getFrictionVector");
  requireVector("getFrictionVector", "qd", qd.size());
  requireVector("getFrictionVector", "f", f.size());
  computeFriction(Eigen::VectorXd(), qd, f);  // positions are not known
}

void InverseDynamicsSolver::getGravityVector(const ConstVectorRef& q, VectorRef g) const {
  requireInitialized("getGravityVector");
  requireVector("getGravityVector", "q", q.size());
  requireVector("getGravityVector", "g", g.size());
  computeGravityVector(q, g);
}

void InverseDynamicsSolver::getDynamicComponents(const ConstVectorRef& q, const ConstVectorRef& qd,
                                                 MatrixRef H, VectorRef c, VectorRef g) const {
  requireInitialized("getDynamicComponents");
  requireVector("getDynamicComponents", "q", q.size());
  requireVector("getDynamicComponents", "qd", qd.size());
  requireMatrix("getDynamicComponents", "H", H.rows(), H.cols(), q.size());
  requireVector("getDynamicComponents", "c", c.size());
  requireVector("getDynamicComponents", "g", g.size());
  computeDynamicComponents(q, qd, H, c, g);
}

void InverseDynamicsSolver::getTorques(const ConstVectorRef& q, const ConstVectorRef& qd,
                                       const ConstVectorRef& qdd, VectorRef tau) const {
  requireInitialized("getTorques");
  requireVector("getTorques", "q", q.size());
  requireVector("getTorques", "qd", qd.size());
  requireVector("getTorques", "qdd", qdd.size());
  requireVector("getTorques", "tau", tau.size());
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

  // tau = H qdd + C qd + f + g, each term added as it comes
  const auto sum = [&](MatrixRef H, VectorRef term) {
    computeInertiaMatrix(q, H);
    tau.noalias() = H.lazyProduct(qdd);
    computeCoriolisVector(q, qd, term);
    tau += term;
    computeFriction(q, qd, term);
    tau += term;
    computeGravityVector(q, term);
    tau += term;
  };
  if (n <= kMaxStackJoints) {
    StackMatrix H(n, n);
    StackVector term(n);
    sum(H, term);
  } else {
    Eigen::MatrixXd H(n, n);
    Eigen::VectorXd term(n);
    sum(H, term);
  }
}

}  // namespace v2
}  // namespace inverse_dynamics_solver
