// SPDX-License-Identifier: Apache-2.0
/// @file
/// Small arms to test the laws on, known in closed form or as a chain, and what goes wrong with
/// them.
#pragma once

#include <algorithm>
#include <chain_dynamics/chain.hpp>
#include <chain_dynamics/coriolis_vector.hpp>
#include <chain_dynamics/dynamic_components.hpp>
#include <chain_dynamics/gravity_vector.hpp>
#include <chain_dynamics/inertia_matrix.hpp>
#include <chain_dynamics/model.hpp>
#include <cmath>
#include <initializer_list>
#include <inverse_dynamics_solver/configuration.hpp>
#include <inverse_dynamics_solver/exceptions.hpp>
#include <inverse_dynamics_solver/friction_memory.hpp>
#include <inverse_dynamics_solver/inverse_dynamics_solver.hpp>
#include <limits>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "inverse_dynamics_control/inverse_dynamics_control.hpp"

namespace inverse_dynamics_control {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Rounding of some dozens of operations on numbers around one hundred.
constexpr double kRounding = 1e-12;

inline Eigen::VectorXd vec(std::initializer_list<double> values) {
  Eigen::VectorXd v(static_cast<Eigen::Index>(values.size()));
  std::copy(values.begin(), values.end(), v.data());
  return v;
}

/// A mass of 2 kg, 0.5 m from a horizontal axis, along x at q = 0. H = 0.5, g = 9.81 cos q.
/// Friction as the UR10's wrists have it: it jumps at rest, and isn't zero there.
///     f(qd) = 3 sign(qd) + 2 qd - 0.8
class Pendulum : public InverseDynamicsSolver {
 public:
  enum class Fault { kNone, kThrows, kGivesNan };

  static std::shared_ptr<Pendulum> make() {
    auto solver = std::make_shared<Pendulum>();
    solver->initialize();
    return solver;
  }

  static double friction(double qd) { return 3.0 * ((qd > 0) - (qd < 0)) + 2.0 * qd - 0.8; }

  Fault fault = Fault::kNone;
  bool physical = true;

 protected:
  using Configuration = inverse_dynamics_solver::Configuration;
  using MatrixRef = inverse_dynamics_solver::MatrixRef;

  JointInfo configure(const Configuration&) override { return {{"pivot"}, {}}; }
  void computeInertiaMatrix(const ConstVectorRef&, MatrixRef H) const override { H(0, 0) = 0.5; }
  void computeCoriolisVector(const ConstVectorRef&, const ConstVectorRef&,
                             VectorRef c) const override {
    c[0] = 0.0;
  }
  void computeGravityVector(const ConstVectorRef& q, VectorRef g) const override {
    if (fault == Fault::kThrows) throw std::runtime_error("a plugin's fault");
    g[0] = fault == Fault::kGivesNan ? kNan : 2.0 * 9.81 * 0.5 * std::cos(q[0]);
  }
  void computeFriction(const ConstVectorRef&, const ConstVectorRef& qd,
                       VectorRef f) const override {
    f[0] = friction(qd[0]);
  }
  bool inertiaIsPhysicalImpl() const override { return physical; }
};

/// Two bars in a vertical plane, the second one beyond the first, with rotor inertia: every term
/// couples the joints.
inline chain_dynamics::Chain twoBars(
    chain_dynamics::JointType type = chain_dynamics::JointType::kRevolute) {
  using chain_dynamics::Joint;
  using chain_dynamics::LinkParameters;
  Joint shoulder{"shoulder", type}, elbow{"elbow", type};
  elbow.placement.p = {0.7, 0.0, 0.0};
  elbow.rotor_inertia = 0.05;
  const auto bar = [](double mass, double center, double inertia) {
    return LinkParameters::fromCenterOfMass(
        mass, {center, 0.0, 0.0}, Eigen::Vector3d(inertia, inertia, inertia).asDiagonal());
  };
  return {
      "two bars", {shoulder, elbow}, {bar(3.0, 0.35, 0.1), bar(2.0, 0.25, 0.05)}, {0, -9.81, 0}};
}

/// A chain as a solver.
class ChainSolver : public InverseDynamicsSolver {
 public:
  static std::shared_ptr<ChainSolver> make(chain_dynamics::Chain chain) {
    auto solver = std::make_shared<ChainSolver>(std::move(chain));
    solver->initialize();
    return solver;
  }
  explicit ChainSolver(chain_dynamics::Chain chain) : chain_(std::move(chain)) {}

 protected:
  JointInfo configure(const inverse_dynamics_solver::Configuration&) override {
    return {chain_.jointNames(), {}, chain_.jointTypes()};
  }
  void computeInertiaMatrix(const ConstVectorRef& q,
                            inverse_dynamics_solver::MatrixRef H) const override {
    chain_dynamics::inertiaMatrix(chain_, q, H);
  }
  void computeCoriolisVector(const ConstVectorRef& q, const ConstVectorRef& qd,
                             VectorRef c) const override {
    chain_dynamics::coriolisVector(chain_, q, qd, c);
  }
  void computeGravityVector(const ConstVectorRef& q, VectorRef g) const override {
    chain_dynamics::gravityVector(chain_, q, g);
  }
  void computeFriction(const ConstVectorRef&, const ConstVectorRef& qd,
                       VectorRef f) const override {
    f = 0.4 * qd;
  }
  bool inertiaIsPhysicalImpl() const override { return true; }

 private:
  chain_dynamics::Chain chain_;
};

/// Two bars whose friction preslides, or its limit without memory.
class PreslidingArm : public ChainSolver, public inverse_dynamics_solver::FrictionMemory {
 public:
  static constexpr double kPresliding = 8.0;  // N m

  /// @param stribeck  what friction is greater by at rest [N m].
  static std::shared_ptr<PreslidingArm> make(bool remembers, double stribeck = 0) {
    auto solver = std::make_shared<PreslidingArm>(remembers, stribeck);
    solver->initialize();
    return solver;
  }
  PreslidingArm(bool remembers, double stribeck)
      : ChainSolver(twoBars()), model_(twoBars()), remembers_(remembers) {
    chain_dynamics::SmoothCoulomb law;
    law.fv = 2.0;
    law.fm = kPresliding;
    law.width = 0.02;
    law.distance = 0.01;
    law.fs = stribeck;
    law.vs = 0.06;
    model_.friction = {law, law};
  }

 protected:
  void computeFriction(const ConstVectorRef& q, const ConstVectorRef& qd,
                       VectorRef f) const override {
    chain_dynamics::frictionVector(model_, q, qd, f);
  }
  chain_dynamics::FrictionState frictionStateImpl() const override {
    return remembers_ ? chain_dynamics::FrictionState(model_) : chain_dynamics::FrictionState();
  }
  const InverseDynamicsSolver& torqueSolver() const override { return *this; }

 private:
  chain_dynamics::Model model_;
  bool remembers_;
};

/// Options without any limit: damping 4 N m s/rad in each joint, no friction compensation.
inline LawOptions unlimited(Eigen::Index joints) {
  LawOptions options;
  options.limits.effort.setConstant(joints, kInfinity);
  options.damping.setConstant(joints, 4.0);
  options.friction.source = FrictionSource::kNone;
  return options;
}

inline JointState stateOf(const Eigen::VectorXd& q, const Eigen::VectorXd& qd) {
  JointState state(q.size());
  state.q = q;
  state.qd = qd;
  return state;
}

inline Reference referenceOf(const Eigen::VectorXd& q, const Eigen::VectorXd& qd,
                             const Eigen::VectorXd& qdd) {
  Reference reference(q.size());
  reference.q = q;
  reference.qd = qd;
  reference.qdd = qdd;
  return reference;
}

/// Text of what a statement throws, empty if nothing.
template <class Statement>
std::string thrownBy(const Statement& statement) {
  try {
    statement();
  } catch (const inverse_dynamics_solver::Exception& error) {
    return error.what();
  }
  return "";
}

}  // namespace inverse_dynamics_control
