// SPDX-License-Identifier: Apache-2.0
/// @file
/// KDL's solvers of a chain with the memory they write to.
#pragma once

#include <cstddef>
#include <kdl/chain.hpp>
#include <kdl/chaindynparam.hpp>
#include <kdl/chainfdsolver_recursive_newton_euler.hpp>
#include <kdl/chainfksolverpos_recursive.hpp>
#include <kdl/chainidsolver.hpp>
#include <kdl/chainidsolver_recursive_newton_euler.hpp>
#include <kdl/chainjnttojacdotsolver.hpp>
#include <kdl/chainjnttojacsolver.hpp>
#include <kdl/frames.hpp>
#include <kdl/jacobian.hpp>
#include <kdl/jntarray.hpp>
#include <kdl/jntarrayvel.hpp>
#include <kdl/jntspaceinertiamatrix.hpp>

#include "chain_dynamics/spatial.hpp"
#include "inverse_dynamics_solver/external_wrench.hpp"
#include "inverse_dynamics_solver/inverse_dynamics_solver.hpp"
#include "inverse_dynamics_solver/pooled_solver.hpp"

namespace kdl_inverse_dynamics_solver {
inline namespace v2 {

using inverse_dynamics_solver::ConstVectorRef;
using inverse_dynamics_solver::MatrixRef;
using inverse_dynamics_solver::VectorRef;
using inverse_dynamics_solver::WrenchFrame;

/// KDL's solvers of one chain and all that they write to. One thread at a time.
class KdlWorkspace : public inverse_dynamics_solver::TipWorkspace {
 public:
  /// @param tip  pose of the tip in the frame of the last segment.
  KdlWorkspace(const KDL::Chain& chain, const KDL::Vector& gravity,
               const KDL::Frame& tip = KDL::Frame::Identity());

  void inertiaMatrix(const ConstVectorRef& q, MatrixRef H) override;
  void coriolisVector(const ConstVectorRef& q, const ConstVectorRef& qd, VectorRef c) override;
  void gravityVector(const ConstVectorRef& q, VectorRef g) override;
  void torques(const ConstVectorRef& q, const ConstVectorRef& qd, const ConstVectorRef& qdd,
               VectorRef tau) override;
  void tipPose(std::size_t tip, const ConstVectorRef& q,
               chain_dynamics::Transform<double>& pose) override;
  void tipJacobian(std::size_t tip, const ConstVectorRef& q, MatrixRef J) override;
  void tipJacobianDerivative(std::size_t tip, const ConstVectorRef& q, const ConstVectorRef& qd,
                             MatrixRef dJ) override;
  void externalTorques(std::size_t tip, const ConstVectorRef& q, WrenchFrame frame,
                       const ConstVectorRef& wrench, VectorRef tau) override;

  /// As ForwardDynamics, without friction.
  void accelerations(const ConstVectorRef& q, const ConstVectorRef& qd, const ConstVectorRef& tau,
                     VectorRef qdd);

 private:
  const KDL::Jacobian& jacobian(const ConstVectorRef& q);
  const KDL::Frame& pose(const ConstVectorRef& q);

  KDL::Chain chain_;  // KDL's solvers refer to it; its joints remember the last position
  KDL::ChainDynParam components_;
  KDL::ChainIdSolver_RNE newton_euler_;
  KDL::ChainFdSolver_RNE forward_;
  KDL::JntArray q_, qd_, qdd_, tau_, result_;
  KDL::JntSpaceInertiaMatrix H_;
  KDL::Wrenches no_forces_;

  KDL::Chain to_tip_;  // with a fixed segment to the tip
  KDL::ChainFkSolverPos_recursive positions_;
  KDL::ChainJntToJacSolver jacobians_;
  KDL::ChainJntToJacDotSolver derivatives_;
  KDL::Frame pose_;
  KDL::Jacobian jacobian_;
  KDL::JntArrayVel motion_;
};

}  // namespace v2
}  // namespace kdl_inverse_dynamics_solver
