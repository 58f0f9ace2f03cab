// SPDX-License-Identifier: Apache-2.0
/// @file
/// What one thread computes with: Pinocchio's data of a model.
#pragma once

#include <Eigen/Core>
#include <memory>

#include "pinocchio_headers.hpp"

namespace pinocchio_inverse_dynamics_solver {

/// A model that all threads read.
struct Models {
  pinocchio::Model with_gravity;
  pinocchio::Model without_gravity;
};

/// Pinocchio's data and all that is written to. One thread at a time.
class Workspace {
 public:
  using Vector = Eigen::Ref<const Eigen::VectorXd>;

  explicit Workspace(std::shared_ptr<const Models> models);

  /// As the methods of the solver; n each, H n x n. No allocation.
  void inertiaMatrix(const Vector& q, Eigen::Ref<Eigen::MatrixXd> H);
  void coriolisVector(const Vector& q, const Vector& qd, Eigen::Ref<Eigen::VectorXd> c);
  void gravityVector(const Vector& q, Eigen::Ref<Eigen::VectorXd> g);
  void torques(const Vector& q, const Vector& qd, const Vector& qdd,
               Eigen::Ref<Eigen::VectorXd> tau);

 private:
  std::shared_ptr<const Models> models_;
  pinocchio::Data data_;
};

}  // namespace pinocchio_inverse_dynamics_solver
