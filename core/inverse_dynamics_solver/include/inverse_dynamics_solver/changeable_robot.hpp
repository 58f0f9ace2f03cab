// SPDX-License-Identifier: Apache-2.0
/// @file
/// Payload and VariableGravity for solvers that make their robot ready before they compute: only how
/// to make it is left to add.
///
///     struct Ready { ... };                                       // all that calls compute with
///     class MySolver : public InverseDynamicsSolver, public ChangeableRobot<Ready> {
///       std::unique_ptr<const Ready> robotUnder(const Conditions& conditions) const override;
///       void computeGravityVector(const ConstVectorRef& q, VectorRef g) const override {
///         const auto robot = currentRobot();                      // once per call
///         ...
///
/// A default that calls several such functions reads the robot several times: such a solver overrides
/// computeTorques() and computeDynamicComponents().
#pragma once

#include <functional>
#include <memory>
#include <mutex>
#include <shared_mutex>
#include <utility>

#include "chain_dynamics/model.hpp"
#include "chain_dynamics/spatial.hpp"
#include "inverse_dynamics_solver/payload.hpp"
#include "inverse_dynamics_solver/published.hpp"
#include "inverse_dynamics_solver/variable_gravity.hpp"

namespace inverse_dynamics_solver {
inline namespace v2 {

/// Keeps what may change about a robot, and lets one thread change it after the other.
///
/// A process may fork while threads compute: fork() waits for a change that is under way, and in the
/// child no lock belongs to a thread that isn't there.
class ChangingConditions : public Payload, public VariableGravity {
 public:
  ~ChangingConditions() override;

 protected:
  /// Bodies that a robot carries, and the motion of its base.
  struct Conditions {
    Payloads payloads;
    BaseMotion base;

    /// All bodies as one, in the tip frame of a chain.
    chain_dynamics::SpatialInertia<double> payload() const;

    /// The model of a bare robot with all bodies at its tips, under the apparent gravity.
    ///
    /// @throws chain_dynamics::ModelError  numbers that are too large together, no such tip.
    chain_dynamics::Model appliedTo(const chain_dynamics::Model& bare) const;
  };

  ChangingConditions();

  /// Conditions from parameters, for a robot with this gravity. Throws as readPayloads().
  static std::shared_ptr<const Conditions> readConditions(const Configuration& configuration,
                                                          const Eigen::Vector3d& gravity);

  /// Those of initialize(), which needs the solver for itself.
  void beginUnder(std::shared_ptr<const Conditions> conditions) noexcept;

  /// Whether the conditions are those of beginUnder().
  bool isAsInitialized(const Conditions& conditions) const;

  /// Calls `compute`, which may read the robot several times: it doesn't change meanwhile. A change
  /// waits for all these calls, and later calls wait for the change. For batches only: a control
  /// loop doesn't wait.
  virtual void whileUnchanged(const std::function<void()>& compute) const;

  /// Makes another robot the current one, where no call of whileUnchanged() runs.
  void publishAlone(const std::function<void()>& publish);

  /// Computes under these conditions from the next call on, or throws. One thread at a time.
  virtual void changeTo(const Conditions& conditions) = 0;

 private:
  friend class MethodCall;  // whileUnchanged()
  friend class Forks;       // the locks

  void changePayloads(const std::function<void(Payloads&)>& change) final;
  Payloads currentPayloads() const final;
  void changeBaseMotion(const std::function<void(BaseMotion&)>& change) final;
  BaseMotion currentBaseMotion() const final;
  void apply(const std::function<void(Conditions&)>& change);

  std::shared_ptr<const Conditions> initial_, current_;
  mutable std::mutex changes_;         // one change after the other
  mutable std::mutex entrance_;        // to the next: who comes first, changes or computes first
  mutable std::shared_mutex batches_;  // computed while nothing changes
};

/// The two capabilities of a solver that computes with a constant Robot.
///
/// @tparam Robot  all that calls compute with; many threads read it.
template <class Robot>
class ChangeableRobot : public ChangingConditions {
 protected:
  /// Made ready under other conditions than those of beginWith(); may allocate and throw.
  virtual std::unique_ptr<const Robot> robotUnder(const Conditions& conditions) const = 0;

  /// At the end of a solver's configure(), which needs the solver for itself.
  void beginWith(std::unique_ptr<const Robot> robot,
                 std::shared_ptr<const Conditions> conditions) noexcept {
    beginUnder(std::move(conditions));
    robot_.reset(std::move(robot));
  }

  /// The robot to compute with until the end of the scope. Once per call of the solver, so that no
  /// call mixes two.
  typename Published<Robot>::Reader currentRobot() const noexcept { return robot_.read(); }

  /// Calls `compute(robot)` with the current robot: as currentRobot(), but for single
  /// calls: while the robot is that of beginWith(), nothing is left to do after `compute`.
  template <class Compute>
  void withCurrentRobot(const Compute& compute) const {
    if (const Robot* const robot = robot_.initialIfCurrent()) return compute(*robot);
    compute(*robot_.read());
  }

  /// The robot of beginWith().
  const Robot& initialRobot() const noexcept { return robot_.initial(); }

 private:
  void changeTo(const Conditions& conditions) final {
    if (isAsInitialized(conditions)) {
      publishAlone([&] { robot_.publishInitial(); });
    } else {
      auto robot = robotUnder(conditions);
      publishAlone([&] { robot_.publish(std::move(robot)); });
    }
  }

  Published<Robot> robot_;
};

}  // namespace v2
}  // namespace inverse_dynamics_solver
