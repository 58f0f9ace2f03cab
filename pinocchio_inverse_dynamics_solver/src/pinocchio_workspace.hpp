// SPDX-License-Identifier: Apache-2.0
/// @file
/// What one thread computes with: Pinocchio's data of a model.
#pragma once

#include <memory>

#include "inverse_dynamics_solver/pooled_solver.hpp"
#include "pinocchio_headers.hpp"

namespace pinocchio_inverse_dynamics_solver {
inline namespace v2 {

using inverse_dynamics_solver::ConstVectorRef;
using inverse_dynamics_solver::MatrixRef;
using inverse_dynamics_solver::VectorRef;

/// A model that all threads read.
struct Models {
  Model with_gravity;
  Model without_gravity;
};

/// Pinocchio's data and all that is written to. One thread at a time.
class PinocchioWorkspace : public inverse_dynamics_solver::Workspace {
 public:
  explicit PinocchioWorkspace(std::shared_ptr<const Models> models);

  void inertiaMatrix(const ConstVectorRef& q, MatrixRef H) override;
  void coriolisVector(const ConstVectorRef& q, const ConstVectorRef& qd, VectorRef c) override;
  void gravityVector(const ConstVectorRef& q, VectorRef g) override;
  void torques(const ConstVectorRef& q, const ConstVectorRef& qd, const ConstVectorRef& qdd,
               VectorRef tau) override;

 private:
  std::shared_ptr<const Models> models_;
  Data data_;
};

}  // namespace v2
}  // namespace pinocchio_inverse_dynamics_solver
