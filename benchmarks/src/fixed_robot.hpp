// SPDX-License-Identifier: Apache-2.0

/// @file
/// A solver whose robot can't carry anything: what the possibility of a payload costs.
#pragma once

#include <chain_dynamics/chain.hpp>
#include <chain_dynamics/fast_model.hpp>
#include <chain_dynamics/model.hpp>
#include <inverse_dynamics_solver/configuration.hpp>
#include <inverse_dynamics_solver/inverse_dynamics_solver.hpp>
#include <memory>
#include <string>
#include <vector>

namespace inverse_dynamics_benchmarks {

/// The engine behind the interface as in the rigid body solver, but for its robot that may change.
class FixedRobot : public inverse_dynamics_solver::InverseDynamicsSolver {
 public:
  explicit FixedRobot(const chain_dynamics::Chain& chain)
      : names_(chain.jointNames()),
        model_(chain),
        fast_(std::make_unique<chain_dynamics::FastModel>(model_)) {}

 protected:
  using MatrixRef = inverse_dynamics_solver::MatrixRef;
  using VectorRef = inverse_dynamics_solver::VectorRef;
  using ConstVectorRef = inverse_dynamics_solver::ConstVectorRef;

  JointInfo configure(const inverse_dynamics_solver::Configuration&) override {
    return {names_, {}};
  }
  void computeInertiaMatrix(const ConstVectorRef& q, MatrixRef H) const override {
    fast_->inertiaMatrix(q.data(), H.data(), H.outerStride());
  }
  void computeCoriolisVector(const ConstVectorRef& q, const ConstVectorRef& qd,
                             VectorRef c) const override {
    fast_->coriolisVector(q.data(), qd.data(), c.data());
  }
  void computeGravityVector(const ConstVectorRef& q, VectorRef g) const override {
    fast_->gravityVector(q.data(), g.data());
  }
  void computeTorques(const ConstVectorRef& q, const ConstVectorRef& qd, const ConstVectorRef& qdd,
                      VectorRef tau) const override {
    // A branch as in the rigid body solver: it isn't what a payload costs.
    if (fast_ == nullptr) return chain_dynamics::torques(model_, q, qd, qdd, tau);
    fast_->torques(q.data(), qd.data(), qdd.data(), tau.data());
  }
  bool inertiaIsPhysicalImpl() const override { return true; }

 private:
  std::vector<std::string> names_;
  chain_dynamics::Model model_;
  std::unique_ptr<const chain_dynamics::FastModel> fast_;
};

}  // namespace inverse_dynamics_benchmarks
