// SPDX-License-Identifier: Apache-2.0
#include "inverse_dynamics_solver/external_wrench.hpp"

#include <algorithm>

#include "method_call.hpp"
#include "one_state.hpp"

namespace inverse_dynamics_solver {
inline namespace v2 {

ExternalWrench::~ExternalWrench() = default;

namespace {

/// States whose external torques are added to the torques of their motions at a time.
constexpr Eigen::Index kBlock = 32;

Eigen::Matrix<double, 6, 1> together(const Eigen::Vector3d& force, const Eigen::Vector3d& torque) {
  Eigen::Matrix<double, 6, 1> wrench;
  wrench << force, torque;
  return wrench;
}

}  // namespace

void ExternalWrench::externalTorques(const ConstVectorRef& q, WrenchFrame frame,
                                     const Eigen::Vector3d& force, const Eigen::Vector3d& torque,
                                     VectorRef tau) const {
  MethodCall("getExternalTorques", torqueSolver()).vector("q", q).vector("tau", tau);
  computeExternalTorques(q, frame, together(force, torque), tau);
}

void ExternalWrench::torquesWithWrench(const ConstVectorRef& q, const ConstVectorRef& qd,
                                       const ConstVectorRef& qdd, WrenchFrame frame,
                                       const Eigen::Vector3d& force, const Eigen::Vector3d& torque,
                                       VectorRef tau) const {
  torqueSolver().getTorques(q, qd, qdd, tau);  // checks all sizes
  Scratch<kMaxStackJoints> external(tau.size());
  Eigen::Map<Eigen::VectorXd> of_wrench(&external[0], tau.size());
  computeExternalTorques(q, frame, together(force, torque), of_wrench);
  tau += of_wrench;
}

void ExternalWrench::externalTorquesBatch(const ConstStatesRef& q, WrenchFrame frame,
                                          const ConstStatesRef& wrenches, const States& tau) const {
  const BatchCall call("getExternalTorquesBatch", torqueSolver(), q.count);
  call.states("q", q).rows("wrenches", wrenches, 6).states("tau", tau);
  const auto compute = [&](const ConstStates& q_part, const ConstStates& wrenches_part,
                           const States& tau_part) {
    computeExternalTorquesBatch(q_part, frame, wrenches_part, tau_part);
  };
  call.share(compute, q, wrenches, tau);
}

void ExternalWrench::torquesWithWrenchBatch(const ConstStatesRef& q, const ConstStatesRef& qd,
                                            const ConstStatesRef& qdd, WrenchFrame frame,
                                            const ConstStatesRef& wrenches,
                                            const States& tau) const {
  const BatchCall call("getTorquesBatch", torqueSolver(), q.count);
  call.states("q", q).rows("wrenches", wrenches, 6);
  torqueSolver().getTorquesBatch(q, qd, qdd, tau);  // checks the others
  const auto add = [&](const ConstStates& q_part, const ConstStates& wrenches_part,
                       const States& tau_part) {
    const Eigen::Index n = q_part.joints;
    Scratch<kMaxStackJoints * kBlock> external(n * kBlock);
    for (Eigen::Index first = 0; first < q_part.count; first += kBlock) {
      const Eigen::Index size = std::min(kBlock, q_part.count - first);
      const States of_wrenches(&external[0], n, size, 1, n);
      computeExternalTorquesBatch(q_part.middle(first, size), frame,
                                  wrenches_part.middle(first, size), of_wrenches);
      for (Eigen::Index k = 0; k < size; ++k) {
        for (Eigen::Index j = 0; j < n; ++j) tau_part(j, first + k) += of_wrenches(j, k);
      }
    }
  };
  call.share(add, q, wrenches, tau);
}

void ExternalWrench::computeExternalTorquesBatch(const ConstStates& q, WrenchFrame frame,
                                                 const ConstStates& wrenches,
                                                 const States& tau) const {
  const auto of_state = [&](const ConstVectorRef& q_k, const ConstVectorRef& w_k, VectorRef tau_k) {
    computeExternalTorques(q_k, frame, w_k, tau_k);
  };
  eachState(of_state, q, wrenches, tau);
}

}  // namespace v2
}  // namespace inverse_dynamics_solver
