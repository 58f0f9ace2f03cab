// SPDX-License-Identifier: Apache-2.0
/// @file
/// KDL's solvers of a chain with the memory they write to.
#pragma once

#include <kdl/chain.hpp>
#include <kdl/chaindynparam.hpp>
#include <kdl/chainidsolver_recursive_newton_euler.hpp>
#include <kdl/jntarray.hpp>
#include <kdl/jntspaceinertiamatrix.hpp>

#include "inverse_dynamics_solver/pooled_solver.hpp"

namespace kdl_inverse_dynamics_solver {
inline namespace v2 {

using inverse_dynamics_solver::ConstVectorRef;
using inverse_dynamics_solver::MatrixRef;
using inverse_dynamics_solver::VectorRef;

/// KDL's solvers of one chain and all that they write to. One thread at a time.
class KdlWorkspace : public inverse_dynamics_solver::Workspace {
 public:
  KdlWorkspace(const KDL::Chain& chain, const KDL::Vector& gravity);

  void inertiaMatrix(const ConstVectorRef& q, MatrixRef H) override;
  void coriolisVector(const ConstVectorRef& q, const ConstVectorRef& qd, VectorRef c) override;
  void gravityVector(const ConstVectorRef& q, VectorRef g) override;
  void torques(const ConstVectorRef& q, const ConstVectorRef& qd, const ConstVectorRef& qdd,
               VectorRef tau) override;

 private:
  KDL::Chain chain_;  // KDL's solvers refer to it; its joints remember the last position
  KDL::ChainDynParam components_;
  KDL::ChainIdSolver_RNE newton_euler_;
  KDL::JntArray q_, qd_, qdd_, result_;
  KDL::JntSpaceInertiaMatrix H_;
  KDL::Wrenches no_forces_;
};

}  // namespace v2
}  // namespace kdl_inverse_dynamics_solver
