// SPDX-License-Identifier: Apache-2.0
/// @file
/// KDL's solvers of a chain with the memory they write to.
#pragma once

#include <Eigen/Core>
#include <kdl/chain.hpp>
#include <kdl/chaindynparam.hpp>
#include <kdl/chainidsolver_recursive_newton_euler.hpp>
#include <kdl/jntarray.hpp>
#include <kdl/jntspaceinertiamatrix.hpp>

namespace kdl_inverse_dynamics_solver {

/// KDL's solvers of one chain and all that they write to. One thread at a time.
class Workspace {
 public:
  using Vector = Eigen::Ref<const Eigen::VectorXd>;

  Workspace(const KDL::Chain& chain, const KDL::Vector& gravity);
  Workspace(const Workspace&) = delete;
  Workspace& operator=(const Workspace&) = delete;

  /// As the methods of the solver; n each, H n x n. No allocation.
  void inertiaMatrix(const Vector& q, Eigen::Ref<Eigen::MatrixXd> H);
  void coriolisVector(const Vector& q, const Vector& qd, Eigen::Ref<Eigen::VectorXd> c);
  void gravityVector(const Vector& q, Eigen::Ref<Eigen::VectorXd> g);
  void torques(const Vector& q, const Vector& qd, const Vector& qdd,
               Eigen::Ref<Eigen::VectorXd> tau);

 private:
  KDL::Chain chain_;  // KDL's solvers refer to it; its joints remember the last position
  KDL::ChainDynParam components_;
  KDL::ChainIdSolver_RNE newton_euler_;
  KDL::JntArray q_, qd_, qdd_, result_;
  KDL::JntSpaceInertiaMatrix H_;
  KDL::Wrenches no_forces_;
};

}  // namespace kdl_inverse_dynamics_solver
