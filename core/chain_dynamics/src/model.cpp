// SPDX-License-Identifier: Apache-2.0

#include "chain_dynamics/model.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <string>
#include <vector>

#include "chain_dynamics/coriolis_matrix.hpp"
#include "chain_dynamics/coriolis_vector.hpp"
#include "chain_dynamics/dual.hpp"
#include "chain_dynamics/dynamic_components.hpp"
#include "chain_dynamics/energy.hpp"
#include "chain_dynamics/error.hpp"
#include "chain_dynamics/gravity_vector.hpp"
#include "chain_dynamics/mechanism.hpp"
#include "chain_dynamics/parameter_sets.hpp"
#include "chain_dynamics/torque_derivatives.hpp"
#include "model_branches.hpp"
#include "springs.hpp"

namespace chain_dynamics {
inline namespace v2 {
namespace {

ParameterSets setsOf(const Model& model) {
  return {model.row_parameters, model.gravity_parameters};
}

/// Torques of springs, and of the inertia that motors have: computed before an output may take the place of
/// an input, to be added to the torques of bodies.
class OwnTorques {
 public:
  OwnTorques(const Model& model, const ConstVectorRef& q)
      : tau_(springCount(model) + model.motor_inertia.size()), springs_(springCount(model)) {
    for (Eigen::Index j = 0; j < springs_; ++j) tau_[j] = springTorque(model, j, q);
  }
  OwnTorques(const Model& model, const ConstVectorRef& q, const ConstVectorRef& qdd)
      : OwnTorques(model, q) {
    motors_ = model.motor_inertia.size();
    for (Eigen::Index j = 0; j < motors_; ++j) {
      const double I = model.motor_inertia[j];
      tau_[springs_ + j] = I == 0 ? 0 : I * qdd[j];
    }
  }

  void addTo(VectorRef tau) const {
    for (Eigen::Index j = 0; j < springs_; ++j) tau[j] += tau_[j];
    for (Eigen::Index j = 0; j < motors_; ++j) tau[j] += tau_[springs_ + j];
  }

 private:
  Scratch<double, 2 * kStackJoints> tau_;
  Eigen::Index springs_, motors_ = 0;
};

Eigen::Index lawCount(const Model& model) {
  return static_cast<Eigen::Index>(model.friction.size());
}

/// Adds the inertia that motors have to the diagonal of H.
void addMotors(const Model& model, MatrixRef H) {
  for (Eigen::Index j = 0; j < model.motor_inertia.size(); ++j) H(j, j) += model.motor_inertia[j];
}

/// What laws of friction call load: the gravity torques, or zeros where none asks for them.
class Load {
 public:
  Load(const Model& model, const ConstVectorRef& q)
      : memory_(lawCount(model)), g(&memory_[0], lawCount(model)) {
    g.setZero();
    if (frictionDependsOnLoad(model)) gravityVector(model, q, g.head(model.chain.jointCount()));
  }

 private:
  Scratch<double, kMostFrictionLaws> memory_;

 public:
  Eigen::Map<Eigen::VectorXd> g;
};

/// `C x`, of coefficients that aren't zero: a NaN goes no further.
template <class Matrix>
void multiply(const Matrix& C, const ConstVectorRef& x, VectorRef result) {
  result.setZero();
  for (Eigen::Index i = 0; i < C.rows(); ++i) {
    for (Eigen::Index j = 0; j < C.cols(); ++j) {
      if (C(i, j) != 0) result[i] += C(i, j) * x[j];
    }
  }
}

/// Velocities at which laws of friction act: those of joints, or `coupling qd`.
class LawVelocities {
 public:
  LawVelocities(const Model& model, const ConstVectorRef& qd)
      : memory_(lawCount(model)), v(&memory_[0], lawCount(model)) {
    if (model.coupling.size() > 0) {
      multiply(model.coupling, qd, v);
    } else {
      v = qd;
    }
  }

 private:
  Scratch<double, kMostFrictionLaws> memory_;

 public:
  Eigen::Map<Eigen::VectorXd> v;
};

std::string nameOf(const Model& model, std::size_t joint) {
  return model.chain.joints()[joint].name;
}

/// Of a law: that of its joint, or of its place.
std::string lawName(const Model& model, std::size_t law) {
  const std::size_t n = model.chain.joints().size();
  return law < n ? "joint " + nameOf(model, law) : model.friction_places[law - n];
}

/// A part of the model that is there for no joint or for all.
void checkCount(const Model& model, const std::string& what, std::size_t count) {
  const std::size_t n = model.chain.joints().size();
  if (count == 0 || count == n) return;
  throw ModelError("model " + model.name, what,
                   "none, or one per joint (" + std::to_string(n) + ")", std::to_string(count), "");
}

void checkFrictionLaws(const Model& model) {
  const std::string where = "model " + model.name;
  const std::size_t n = model.chain.joints().size(), places = model.friction_places.size();
  if (model.friction.empty()) return;
  if (places > 0 && (model.friction.size() != n + places || model.coupling.size() == 0 ||
                     lawCount(model) > kMostFrictionLaws)) {
    throw ModelError(where, "friction",
                     "a law and a row of coupling for each of " + std::to_string(n) +
                         " joints and " + std::to_string(places) + " places, of at most " +
                         std::to_string(kMostFrictionLaws) + " laws",
                     std::to_string(model.friction.size()) + " laws, " +
                         std::to_string(model.coupling.rows()) + " rows",
                     "");
  }
  if (places == 0 && model.friction.size() != n) {
    throw ModelError(where, "friction", "no law, or one per joint (" + std::to_string(n) + ")",
                     std::to_string(model.friction.size()), "name further laws in friction_places");
  }
  for (std::size_t k = 0; k < model.friction.size(); ++k) {
    checkFriction(model.friction[k], where + ": friction of " + lawName(model, k));
  }
}

void checkCoupling(const Model& model) {
  const Eigen::Index laws = lawCount(model), n = model.chain.jointCount();
  const OwnedMatrix& C = model.coupling;
  if (C.size() == 0 || laws == 0) return;
  const std::string where = "model " + model.name;
  if (C.rows() != laws || C.cols() != n || !C.allFinite()) {
    throw ModelError(where, "coupling",
                     std::to_string(laws) + " x " + std::to_string(n) + " finite numbers",
                     std::to_string(C.rows()) + " x " + std::to_string(C.cols()) +
                         (C.allFinite() ? "" : ", not all finite"),
                     "state a row per law of friction, of a number per joint, or no coupling");
  }
  for (Eigen::Index k = 0; k < laws; ++k) {
    const auto law = static_cast<std::size_t>(k);
    if (k >= n && C.row(k).isZero(0)) {
      throw ModelError(where, "coupling of " + lawName(model, law), "a number other than zero",
                       "none", "state which joints the friction acts on, or leave its law out");
    }
    if (!dependsOnLoad(model.friction[law]) ||
        (k < n && C.row(k) == Eigen::RowVectorXd::Unit(n, k))) {
      continue;
    }
    throw ModelError(where, "friction of " + lawName(model, law),
                     "no load term fl, as it acts on other joints too", "one",
                     "take Coulomb friction fc, or no coupling");
  }
}

void checkBranches(const Model& model) {
  if (model.branches.empty()) {
    if (model.motor_inertia.size() == 0) return;
    throw ModelError("model " + model.name, "motor_inertia", "none of a chain",
                     std::to_string(model.motor_inertia.size()) + " numbers",
                     "state the rotor inertia of its joints");
  }
  checkMechanism(
      {model.chain, model.branches, {model.motor_inertia.begin(), model.motor_inertia.end()}});
  if (model.row_parameters.empty() && model.gravity_parameters.empty()) return;
  throw ModelError("model " + model.name, "parameters of a mechanism", "one set, of its branches",
                   "others for rows or for gravity", "leave them out");
}

void checkSprings(const Model& model) {
  if (springCount(model) == 0) return;
  const std::string where = "model " + model.name;
  if (model.levers.size() > 0 && (model.levers.rows() != 2 || !model.levers.allFinite() ||
                                  model.levers.cols() != model.chain.jointCount())) {
    throw ModelError(where, "levers of springs",
                     "2 x " + std::to_string(model.chain.jointCount()) + " finite numbers",
                     std::to_string(model.levers.rows()) + " x " +
                         std::to_string(model.levers.cols()) +
                         (model.levers.allFinite() ? "" : ", not all finite"),
                     "");
  }
  checkCount(model, "stiffness of springs", static_cast<std::size_t>(model.stiffness.size()));
  if (model.rest.size() != model.stiffness.size()) {
    throw ModelError(where, "springs at rest", "a position for each stiffness",
                     std::to_string(model.rest.size()), "");
  }
  for (Eigen::Index j = 0; j < model.stiffness.size(); ++j) {
    const auto joint = static_cast<std::size_t>(j);
    const std::string spring = "spring of joint " + nameOf(model, joint);
    if (!std::isfinite(model.stiffness[j]) || !std::isfinite(model.rest[j])) {
      throw ModelError(where, spring, "finite numbers, of stiffness and rest",
                       std::to_string(model.stiffness[j]) + " and " + std::to_string(model.rest[j]),
                       "");
    }
    if (model.stiffness[j] == 0 || model.chain.joints()[joint].type != JointType::kContinuous) {
      continue;
    }
    throw ModelError(where, spring, "a joint with limits, as a spring tells whole turns apart",
                     "a continuous one", "make the joint revolute");
  }
  if (model.row_parameters.empty() && model.gravity_parameters.empty()) return;
  throw ModelError(where, "parameters of a robot with springs", "one set",
                   "others for rows or for gravity", "leave them out");
}

void checkDriveGains(const Model& model) {
  checkCount(model, "drive gains", static_cast<std::size_t>(model.drive_gains.size()));
  for (Eigen::Index j = 0; j < model.drive_gains.size(); ++j) {
    if (std::isfinite(model.drive_gains[j]) && model.drive_gains[j] > 0) continue;
    throw ModelError("model " + model.name,
                     "drive gain of joint " + nameOf(model, static_cast<std::size_t>(j)),
                     "a finite number > 0 [N m/A]", std::to_string(model.drive_gains[j]), "");
  }
}

bool isInterval(const Interval& interval) {
  return std::isfinite(interval.lower) && std::isfinite(interval.upper) &&
         interval.lower <= interval.upper;
}

void checkExperience(const Model& model) {
  const std::string where = "model " + model.name;
  checkCount(model, "torque deviations", static_cast<std::size_t>(model.torque_deviation.size()));
  for (Eigen::Index j = 0; j < model.torque_deviation.size(); ++j) {
    if (std::isfinite(model.torque_deviation[j]) && model.torque_deviation[j] >= 0) continue;
    throw ModelError(where,
                     "torque deviation of joint " + nameOf(model, static_cast<std::size_t>(j)),
                     "a finite number >= 0 [N m]", std::to_string(model.torque_deviation[j]), "");
  }
  checkCount(model, "seen ranges", model.seen.size());
  for (std::size_t j = 0; j < model.seen.size(); ++j) {
    const SeenRange& seen = model.seen[j];
    if (isInterval(seen.q) && isInterval(seen.qd) && isInterval(seen.qdd)) continue;
    throw ModelError(where, "seen range of joint " + nameOf(model, j),
                     "finite numbers, the least first", "others", "");
  }
}

}  // namespace

std::vector<std::string> tipNames(const Model& model) {
  if (model.branches.empty()) return {model.tip};
  std::vector<std::string> tips;
  for (const Branch& branch : model.branches) tips.push_back(branch.tip);
  return tips;
}

void checkModel(const Model& model) {
  checkParameterSets(model.chain, setsOf(model));
  checkBranches(model);
  checkSprings(model);
  checkFrictionLaws(model);
  checkCoupling(model);
  checkDriveGains(model);
  checkExperience(model);
}

void torques(const Model& model, const ConstVectorRef& q, const ConstVectorRef& qd,
             const ConstVectorRef& qdd, VectorRef tau) {
  const OwnTorques own(model, q, qdd);
  if (!model.branches.empty()) {
    sums::torques(model, q, qd, qdd, tau);
  } else {
    torques(model.chain, setsOf(model), q, qd, qdd, tau);
  }
  own.addTo(tau);
}

void inertiaMatrix(const Model& model, const ConstVectorRef& q, MatrixRef H) {
  if (model.branches.empty()) return inertiaMatrix(model.chain, setsOf(model), q, H);
  sums::inertiaMatrix(model, q, H);
  addMotors(model, H);
}

void coriolisVector(const Model& model, const ConstVectorRef& q, const ConstVectorRef& qd,
                    VectorRef c) {
  if (!model.branches.empty()) return sums::coriolisVector(model, q, qd, c);
  coriolisVector(model.chain, setsOf(model), q, qd, c);
}

void coriolisMatrix(const Model& model, const ConstVectorRef& q, const ConstVectorRef& qd,
                    MatrixRef C) {
  if (!model.branches.empty()) return sums::coriolisMatrix(model, q, qd, C);
  coriolisMatrix(model.chain, setsOf(model), q, qd, C);
}

void gravityVector(const Model& model, const ConstVectorRef& q, VectorRef g) {
  const OwnTorques own(model, q);
  if (!model.branches.empty()) {
    sums::gravityVector(model, q, g);
  } else {
    gravityVector(model.chain, setsOf(model), q, g);
  }
  own.addTo(g);
}

void dynamicComponents(const Model& model, const ConstVectorRef& q, const ConstVectorRef& qd,
                       MatrixRef H, VectorRef c, VectorRef g) {
  if (!model.branches.empty()) {
    inertiaMatrix(model, q, H);
    coriolisVector(model, q, qd, c);
    return gravityVector(model, q, g);
  }
  const OwnTorques own(model, q);
  dynamicComponents(model.chain, setsOf(model), q, qd, H, c, g);
  own.addTo(g);
}

double kineticEnergy(const Model& model, const ConstVectorRef& q, const ConstVectorRef& qd) {
  assert(model.row_parameters.empty());
  if (model.branches.empty()) return kineticEnergy(model.chain, q, qd);
  double energy = sums::kineticEnergy(model, q, qd);
  for (Eigen::Index j = 0; j < model.motor_inertia.size(); ++j) {
    energy += 0.5 * model.motor_inertia[j] * qd[j] * qd[j];
  }
  return energy;
}

double potentialEnergy(const Model& model, const ConstVectorRef& q) {
  const bool own = !model.gravity_parameters.empty();
  assert(own || model.row_parameters.empty());
  double energy = !model.branches.empty()
                      ? sums::potentialEnergy(model, q)
                      : internal::potentialEnergyOf(
                            model.chain, own ? model.gravity_parameters : model.chain.links(), q);
  for (Eigen::Index j = 0; j < model.stiffness.size(); ++j) {
    if (model.stiffness[j] == 0) continue;
    energy += 0.5 * model.stiffness[j] * (q[j] - model.rest[j]) * (q[j] - model.rest[j]);
  }
  for (Eigen::Index j = 0; j < model.levers.cols(); ++j) {
    if (!hasLever(model, j)) continue;
    energy += model.levers(1, j) * std::sin(q[j]) - model.levers(0, j) * std::cos(q[j]);
  }
  return energy;
}

bool frictionDependsOnLoad(const Model& model) {
  return std::any_of(model.friction.begin(), model.friction.end(), dependsOnLoad);
}

void frictionVector(const Model& model, const ConstVectorRef& q, const ConstVectorRef& qd,
                    VectorRef f) {
  if (model.friction.empty()) {
    f = 0.0 * qd;  // keeps a NaN
  } else {
    const LawVelocities laws(model, qd);
    const Load load(model, q);
    if (model.coupling.size() == 0) return frictionVector(model.friction, laws.v, load.g, f);
    Scratch<double, kMostFrictionLaws> memory(lawCount(model));
    Eigen::Map<Eigen::VectorXd> of_laws(&memory[0], lawCount(model));
    frictionVector(model.friction, laws.v, load.g, of_laws);
    multiply(model.coupling.transpose(), of_laws, f);
  }
}

void addFrictionDerivatives(const Model& model, const ConstVectorRef& q, const ConstVectorRef& qd,
                            MatrixRef dtau_dq, MatrixRef dtau_dqd) {
  if (model.friction.empty()) return;
  const Eigen::Index n = model.chain.jointCount();
  const Load load(model, q);
  const LawVelocities laws(model, qd);
  // What saturates has at infinity the slope that it has far out; NaN stays.
  const auto velocity = [&](Eigen::Index j) {
    return std::clamp<double>(laws.v[j], -1e100, 1e100);
  };
  for (Eigen::Index j = 0; j < lawCount(model); ++j) {
    const FrictionLaw& law = model.friction[static_cast<std::size_t>(j)];
    const double slope = frictionSlope(law, velocity(j), load.g[j]);
    if (model.coupling.size() == 0) {
      dtau_dqd(j, j) += slope;
      continue;
    }
    for (Eigen::Index i = 0; i < n * n; ++i) {
      const double both = model.coupling(j, i / n) * model.coupling(j, i % n);
      if (both != 0) dtau_dqd(i / n, i % n) += both * slope;
    }
  }
  if (!frictionDependsOnLoad(model)) return;

  const auto load_slope = [&](Eigen::Index j) {
    return frictionLoadSlope(model.friction[static_cast<std::size_t>(j)], velocity(j), load.g[j]);
  };
  for (Eigen::Index j = 0; j < springCount(model); ++j) {
    dtau_dq(j, j) += load_slope(j) * springSlope(model, j, q);
  }
  if (!model.branches.empty()) {
    Scratch<double> memory(n);
    Eigen::Map<Eigen::VectorXd> slopes(&memory[0], n);
    for (Eigen::Index j = 0; j < n; ++j) slopes[j] = load_slope(j);
    return sums::addGravityDerivatives(model, q, slopes, dtau_dq);
  }

  // df/dq = df/dg dg/dq, a column of dg/dq at a time
  using Number = Dual<double, 1>;
  Scratch<Number> q_memory(n);
  Scratch<Number> g_memory(n);
  Eigen::Map<Eigen::Matrix<Number, Eigen::Dynamic, 1>> moved(&q_memory[0], n), g(&g_memory[0], n);
  for (Eigen::Index i = 0; i < n; ++i) {
    for (Eigen::Index j = 0; j < n; ++j) moved[j] = q[j];
    moved[i] = Number::variable(q[i], 0);
    gravityVector(model.chain, setsOf(model), moved, g);
    for (Eigen::Index j = 0; j < n; ++j) dtau_dq(j, i) += load_slope(j) * g[j].derivative[0];
  }
}

void torqueDerivatives(const Model& model, const ConstVectorRef& q, const ConstVectorRef& qd,
                       const ConstVectorRef& qdd, MatrixRef dtau_dq, MatrixRef dtau_dqd,
                       MatrixRef dtau_dqdd) {
  if (!model.branches.empty()) {
    sums::torqueDerivatives(model, q, qd, qdd, dtau_dq, dtau_dqd, dtau_dqdd);
    addMotors(model, dtau_dqdd);
  } else {
    torqueDerivatives(model.chain, setsOf(model), q, qd, qdd, dtau_dq, dtau_dqd, dtau_dqdd);
  }
  for (Eigen::Index j = 0; j < springCount(model); ++j) dtau_dq(j, j) += springSlope(model, j, q);
}

}  // namespace v2
}  // namespace chain_dynamics
