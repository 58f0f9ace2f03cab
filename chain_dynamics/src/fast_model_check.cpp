// SPDX-License-Identifier: Apache-2.0

#include "fast_model_check.hpp"

#include <algorithm>
#include <cmath>

#include "chain_dynamics/error.hpp"
#include "chain_dynamics/regressor.hpp"
#include "chain_dynamics/tip_kinematics.hpp"

namespace chain_dynamics {
inline namespace v2 {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// What the terms of an entry may amount to, in units that a robot of any size has: its length and
/// its greatest moment of inertia, as if everything were at that length from everything.
class Scale {
 public:
  explicit Scale(const Model& model) : Scale(model, setsOf(model)) {}

  /// Of H; per unit of acceleration.
  MatrixXd inertia() const { return moment_ * per_radian_ * per_radian_.transpose(); }
  /// Of all that moves the links but friction and rotors, at q = qd = qdd.
  VectorXd torques(const VectorXd& q) const { return moment_ * rate(q) * per_radian_; }
  /// Of the same by q; by qd.
  MatrixXd byPosition(const VectorXd& q) const { return rate(q) * inertia(); }
  MatrixXd byVelocity(const VectorXd& q) const { return speed(q) * inertia(); }
  /// Of the regressor: ten columns per link.
  MatrixXd regressor(const VectorXd& q) const {
    Vector10<double> column;
    column << length_ * length_, Eigen::Vector3d::Constant(length_), Vector6::Ones();
    return rate(q) * per_radian_ * column.replicate(q.size(), 1).transpose();
  }
  /// Of J: a length, and one.
  MatrixXd jacobian(const Chain& chain, const VectorXd& q) const {
    MatrixXd J = MatrixXd::Ones(6, q.size());
    J.topRows(3).setConstant(length_ + chain.tip().p.norm() + q.cwiseAbs().sum());
    return J;
  }

 private:
  using Vector6 = Eigen::Matrix<double, 6, 1>;
  using Set = const std::vector<LinkParameters>*;

  static std::vector<Set> setsOf(const Model& model) {
    std::vector<Set> sets = {&model.chain.links()};
    for (const auto& row : model.row_parameters) sets.push_back(&row);
    if (!model.gravity_parameters.empty()) sets.push_back(&model.gravity_parameters);
    return sets;
  }

  Scale(const Model& model, const std::vector<Set>& sets)
      : gravity_(model.chain.gravity().norm()), per_radian_(model.chain.jointCount()) {
    double mass = 0;
    double first_moment = 0;
    double inertia = 0;
    for (Set set : sets) {
      for (const LinkParameters& link : *set) {
        mass += std::abs(link.mass);
        first_moment += link.first_moment.norm();
        inertia += link.inertia.norm();
      }
    }
    const std::vector<Joint>& joints = model.chain.joints();
    for (std::size_t i = 1; i < joints.size(); ++i) length_ += joints[i].placement.p.norm();
    if (mass > 0) length_ += first_moment / mass + std::sqrt(inertia / mass);
    if (!(length_ > 0)) length_ = 1;
    moment_ = inertia + length_ * (first_moment + length_ * mass);
    for (std::size_t i = 0; i < joints.size(); ++i) {
      per_radian_[static_cast<Index>(i)] = isPrismatic(joints[i]) ? 1 / length_ : 1;
    }
  }

  double speed(const VectorXd& qd) const { return per_radian_.dot(qd.cwiseAbs()); }
  double rate(const VectorXd& q) const {
    return gravity_ / length_ + speed(q) + speed(q) * speed(q);
  }

  double length_ = 0;
  double moment_ = 0;
  double gravity_;
  VectorXd per_radian_;  ///< 1, prismatic 1 / length: a slide by so much counts as a turn
};

// Entry by entry; a NaN isn't near.
bool near(const MatrixXd& a, const MatrixXd& b, const MatrixXd& scale) {
  return ((a - b).array().abs() <= 1e-9 * (scale + b.cwiseAbs()).array()).all();
}

/// What the functions of model.hpp give at one state q = qd = qdd.
struct Plain {
  Plain(const Model& model, const VectorXd& q)
      : H(q.size(), q.size()), c(q.size()), g(q.size()), f(q.size()), backwards(q.size()) {
    dynamicComponents(model, q, q, H, c, g);
    frictionVector(model, q, q, f);
    frictionVector(model, q, -q, backwards);
  }
  /// What friction is made of: the parts of a law may cancel at one velocity.
  VectorXd frictionScale() const { return f.cwiseAbs() + backwards.cwiseAbs(); }
  /// And torques, with rotors.
  VectorXd torqueScale(const Scale& scale, const VectorXd& q) const {
    return scale.torques(q) + frictionScale() + H.cwiseAbs() * q.cwiseAbs();
  }
  MatrixXd H;
  VectorXd c, g, f, backwards;
};

// One state.
bool torquesEqual(const FastModel& fast, const Model& model, const Scale& scale,
                  const VectorXd& q) {
  const Index n = q.size();
  const Plain plain(model, q);
  MatrixXd H(n, n);
  VectorXd tau(n);
  fast.inertiaMatrix(q.data(), H.data(), n);
  fast.torques(q.data(), q.data(), q.data(), tau.data());
  return near(H, plain.H, scale.inertia()) &&
         near(tau, plain.H * q + plain.c + plain.g + plain.f, plain.torqueScale(scale, q));
}

// More states than the widest pack has lanes, each another one: none may get a neighbour's numbers.
bool batchesEqual(const FastModel& fast, const Model& model, const Scale& scale,
                  const VectorXd& q) {
  constexpr Index kStates = 11;
  const Index n = q.size();
  MatrixXd states = q.replicate(1, kStates);
  states.rowwise() += Eigen::RowVectorXd::LinSpaced(kStates, 0.0, 1.0);
  MatrixXd H(n, n * kStates);
  MatrixXd tau(n, kStates), c(n, kStates), g(n, kStates);
  fast.torquesBatch(states, states, states, tau);
  fast.dynamicComponentsBatch(states, states, H, c, g);

  for (Index k = 0; k < kStates; ++k) {
    const VectorXd state = states.col(k);
    const Plain plain(model, state);
    const VectorXd torques = plain.H * state + plain.c + plain.g + plain.f;
    const VectorXd size = scale.torques(state);
    if (!near(tau.col(k), torques, plain.torqueScale(scale, state)) ||
        !near(c.col(k), plain.c, size) || !near(g.col(k), plain.g, size) ||
        !near(H.middleCols(k * n, n), plain.H, scale.inertia())) {
      return false;
    }
  }
  return true;
}

bool derivativesEqual(const FastModel& fast, const Model& model, const Scale& scale,
                      const VectorXd& q) {
  const Index n = q.size();
  MatrixXd by_q(n, n), by_qd(n, n), by_qdd(n, n);
  VectorXd slope(n);
  torqueDerivatives(model, q, q, q, by_q, by_qd, by_qdd);
  addFrictionDerivatives(model, q, q, by_q, by_qd);
  frictionSlopes(model, q, q, slope);

  MatrixXd fast_by_q(n, n), fast_by_qd(n, n), fast_by_qdd(n, n);
  fast.torqueDerivatives(q.data(), q.data(), q.data(), fast_by_q.data(), fast_by_qd.data(),
                         fast_by_qdd.data(), n);
  MatrixXd velocity_scale = scale.byVelocity(q);
  velocity_scale.diagonal() += slope.cwiseAbs() + Plain(model, q).frictionScale();
  return near(fast_by_q, by_q, scale.byPosition(q)) && near(fast_by_qd, by_qd, velocity_scale) &&
         near(fast_by_qdd, by_qdd, scale.inertia());
}

bool regressorsEqual(const FastModel& fast, const Chain& chain, const Scale& scale,
                     const VectorXd& q) {
  const Index n = q.size();
  MatrixXd Y(n, 10 * n), fast_Y(n, 10 * n);
  regressor(chain, q, q, q, Y);
  fast.regressor(q.data(), q.data(), q.data(), fast_Y.data(), n);
  return near(fast_Y, Y, scale.regressor(q));
}

// Where the tip is and how it moves; the Coriolis matrix.
struct Kinematics {
  explicit Kinematics(Index n) : C(n, n), J(6, n), dJ(6, n) {}
  Transform<double> tip;
  MatrixXd C, J, dJ;
};

Kinematics kinematicsOf(const Model& model, const VectorXd& q) {
  Kinematics all(q.size());
  all.tip = tipPose(model.chain, q);
  coriolisMatrix(model, q, q, all.C);
  tipJacobian(model.chain, q, all.J);
  tipJacobianDerivative(model.chain, q, q, all.dJ);
  return all;
}

Kinematics kinematicsOf(const FastModel& fast, const VectorXd& q) {
  Kinematics all(q.size());
  fast.tipPose(q.data(), all.tip.R.data(), all.tip.p.data());
  fast.coriolisMatrix(q.data(), q.data(), all.C.data(), q.size());
  fast.tipJacobian(q.data(), all.J.data(), 6);
  fast.tipJacobianDerivative(q.data(), q.data(), all.dJ.data(), 6);
  return all;
}

bool near(const Kinematics& a, const Kinematics& b, const Chain& chain, const Scale& scale,
          const VectorXd& q) {
  const MatrixXd J = scale.jacobian(chain, q);
  const double root = chain.joints().front().placement.p.norm();
  return near(a.tip.R, b.tip.R, Eigen::Matrix3d::Ones()) &&
         near(a.tip.p, b.tip.p, Eigen::Vector3d::Constant(root + J(0, 0))) && near(a.J, b.J, J) &&
         near(a.dJ, b.dJ, J * q.cwiseAbs().sum()) && near(a.C, b.C, scale.byVelocity(q));
}

bool kinematicsEqual(const FastModel& fast, const Model& model, const Scale& scale,
                     const VectorXd& q) {
  return near(kinematicsOf(fast, q), kinematicsOf(model, q), model.chain, scale, q);
}

// Likewise, against single calls, which are compared with the plain functions. (Accelerations aren't:
// an identified H may be singular.)
bool batchesOfDynamicsEqual(const FastModel& fast, const Scale& scale, const VectorXd& q) {
  constexpr Index kStates = 11;
  const Index n = q.size();
  MatrixXd states = q.replicate(1, kStates);
  states.rowwise() += Eigen::RowVectorXd::LinSpaced(kStates, 0.0, 1.0);
  MatrixXd by_q(n, n * kStates), by_qd(n, n * kStates), by_qdd(n, n * kStates);
  MatrixXd Y(n, 10 * n * kStates);
  fast.torqueDerivativesBatch(states, states, states, by_q, by_qd, by_qdd);
  fast.regressorBatch(states, states, states, Y);

  MatrixXd one_q(n, n), one_qd(n, n), one_qdd(n, n), one_Y(n, 10 * n);
  for (Index k = 0; k < kStates; ++k) {
    const VectorXd state = states.col(k);
    const double* const x = state.data();
    fast.torqueDerivatives(x, x, x, one_q.data(), one_qd.data(), one_qdd.data(), n);
    fast.regressor(x, x, x, one_Y.data(), n);
    if (!near(by_q.middleCols(k * n, n), one_q, scale.byPosition(state)) ||
        !near(by_qd.middleCols(k * n, n), one_qd, scale.byVelocity(state)) ||
        !near(by_qdd.middleCols(k * n, n), one_qdd, scale.inertia()) ||
        !near(Y.middleCols(10 * k * n, 10 * n), one_Y, scale.regressor(state))) {
      return false;
    }
  }
  return true;
}

bool batchesOfKinematicsEqual(const FastModel& fast, const Chain& chain, const Scale& scale,
                              const VectorXd& q) {
  constexpr Index kStates = 11;
  const Index n = q.size();
  MatrixXd states = q.replicate(1, kStates);
  states.rowwise() += Eigen::RowVectorXd::LinSpaced(kStates, 0.0, 1.0);
  MatrixXd C(n, n * kStates), R(3, 3 * kStates), p(3, kStates), J(6, n * kStates), dJ(J);
  fast.coriolisMatrixBatch(states, states, C);
  fast.tipPoseBatch(states, R, p);
  fast.tipJacobianBatch(states, J);
  fast.tipJacobianDerivativeBatch(states, states, dJ);

  for (Index k = 0; k < kStates; ++k) {
    Kinematics one(n);
    one.tip = {R.middleCols(3 * k, 3), p.col(k)};
    one.C = C.middleCols(k * n, n);
    one.J = J.middleCols(k * n, n);
    one.dJ = dJ.middleCols(k * n, n);
    const VectorXd state = states.col(k);
    if (!near(one, kinematicsOf(fast, state), chain, scale, state)) return false;
  }
  return true;
}

}  // namespace

bool equalsPlain(const FastModel& fast, const Model& model) {
  const VectorXd q = VectorXd::LinSpaced(model.chain.jointCount(), 0.3, 2.9);
  const Scale scale(model);
  return torquesEqual(fast, model, scale, q) && batchesEqual(fast, model, scale, q) &&
         derivativesEqual(fast, model, scale, q) && regressorsEqual(fast, model.chain, scale, q) &&
         batchesOfDynamicsEqual(fast, scale, q) && kinematicsEqual(fast, model, scale, q) &&
         batchesOfKinematicsEqual(fast, model.chain, scale, q);
}

Choice bestEqual(const std::string& model, const std::vector<std::string>& sets,
                 const std::function<bool(std::size_t)>& equals) {
  Choice choice{sets.size(), {}};
  while (choice.index-- > 0) {
    if (equals(choice.index)) return choice;
    choice.warnings.push_back("fast model of " + model + ": instruction set " + sets[choice.index] +
                              " isn't used: its numbers differ from those of the plain functions");
  }
  throw ModelError("fast model of " + model, "numbers",
                   "finite ones, equal to those of the plain functions",
                   "others, or none, on each of " + joined(sets),
                   "look for lengths, masses and gains that are too large");
}

}  // namespace v2
}  // namespace chain_dynamics
