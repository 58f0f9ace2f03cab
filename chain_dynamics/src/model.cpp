// SPDX-License-Identifier: Apache-2.0

#include "chain_dynamics/model.hpp"

#include <cassert>
#include <cmath>
#include <string>

#include "chain_dynamics/coriolis_matrix.hpp"
#include "chain_dynamics/coriolis_vector.hpp"
#include "chain_dynamics/dynamic_components.hpp"
#include "chain_dynamics/energy.hpp"
#include "chain_dynamics/error.hpp"
#include "chain_dynamics/parameter_sets.hpp"
#include "chain_dynamics/torque_derivatives.hpp"
#include "definite_inertia.hpp"

namespace chain_dynamics {
inline namespace v2 {
namespace {

ParameterSets setsOf(const Model& model) {
  return {model.row_parameters, model.gravity_parameters};
}

}  // namespace

bool Model::inertiaIsPhysical() const { return row_parameters.empty() && inertiaIsDefinite(chain); }

void checkModel(const Model& model) {
  const std::string where = "model " + model.name;
  const Eigen::Index n = model.chain.jointCount();
  checkParameterSets(model.chain, setsOf(model));
  if (!model.friction.empty() && model.friction.size() != model.chain.joints().size()) {
    throw ModelError(where, "friction", "no law, or one per joint (" + std::to_string(n) + ")",
                     std::to_string(model.friction.size()), "");
  }
  for (std::size_t j = 0; j < model.friction.size(); ++j) {
    if (!std::isfinite(friction(model.friction[j], 0.0))) {
      throw ModelError(where, "friction of joint " + model.chain.joints()[j].name,
                       "finite coefficients", "a NaN or an infinity", "");
    }
  }
  if (model.drive_gains.size() != 0 && model.drive_gains.size() != n) {
    throw ModelError(where, "drive gains", "none, or one per joint (" + std::to_string(n) + ")",
                     std::to_string(model.drive_gains.size()), "");
  }
  for (Eigen::Index j = 0; j < model.drive_gains.size(); ++j) {
    if (!std::isfinite(model.drive_gains[j]) || model.drive_gains[j] <= 0) {
      throw ModelError(
          where, "drive gain of joint " + model.chain.joints()[static_cast<std::size_t>(j)].name,
          "a finite number > 0 [N m/A]", std::to_string(model.drive_gains[j]), "");
    }
  }
}

Model withBodyAtTip(const Model& model, const LinkParameters& body) {
  LinkParameters added = model.chain.tip() * body;
  added.inertia = (0.5 * (added.inertia + added.inertia.transpose())).eval();

  Model result = model;
  std::vector<LinkParameters> links = model.chain.links();
  links.back() += added;
  result.chain = Chain(model.chain.name(), model.chain.joints(), std::move(links),
                       model.chain.gravity(), model.chain.tip())
                     .withWarnings(model.chain.warnings());
  for (std::vector<LinkParameters>& row : result.row_parameters) row.back() += added;
  if (!result.gravity_parameters.empty()) result.gravity_parameters.back() += added;
  return result;
}

void torques(const Model& model, const ConstVectorRef& q, const ConstVectorRef& qd,
             const ConstVectorRef& qdd, VectorRef tau) {
  torques(model.chain, setsOf(model), q, qd, qdd, tau);
}

void inertiaMatrix(const Model& model, const ConstVectorRef& q, MatrixRef H) {
  inertiaMatrix(model.chain, setsOf(model), q, H);
}

void coriolisVector(const Model& model, const ConstVectorRef& q, const ConstVectorRef& qd,
                    VectorRef c) {
  coriolisVector(model.chain, setsOf(model), q, qd, c);
}

void coriolisMatrix(const Model& model, const ConstVectorRef& q, const ConstVectorRef& qd,
                    MatrixRef C) {
  coriolisMatrix(model.chain, setsOf(model), q, qd, C);
}

void gravityVector(const Model& model, const ConstVectorRef& q, VectorRef g) {
  gravityVector(model.chain, setsOf(model), q, g);
}

void dynamicComponents(const Model& model, const ConstVectorRef& q, const ConstVectorRef& qd,
                       MatrixRef H, VectorRef c, VectorRef g) {
  dynamicComponents(model.chain, setsOf(model), q, qd, H, c, g);
}

double kineticEnergy(const Model& model, const ConstVectorRef& q, const ConstVectorRef& qd) {
  assert(model.row_parameters.empty());
  return kineticEnergy(model.chain, q, qd);
}

double potentialEnergy(const Model& model, const ConstVectorRef& q) {
  const bool own = !model.gravity_parameters.empty();
  assert(own || model.row_parameters.empty());
  return internal::potentialEnergyOf(model.chain,
                                     own ? model.gravity_parameters : model.chain.links(), q);
}

void frictionVector(const Model& model, const ConstVectorRef& qd, VectorRef f) {
  if (model.friction.empty()) {
    f = 0.0 * qd;  // keeps a NaN
  } else {
    frictionVector(model.friction, qd, f);
  }
}

void frictionSlopes(const Model& model, const ConstVectorRef& qd, VectorRef slope) {
  if (model.friction.empty()) {
    slope = 0.0 * qd;  // keeps a NaN
  } else {
    frictionSlopes(model.friction, qd, slope);
  }
}

void torqueDerivatives(const Model& model, const ConstVectorRef& q, const ConstVectorRef& qd,
                       const ConstVectorRef& qdd, MatrixRef dtau_dq, MatrixRef dtau_dqd,
                       MatrixRef dtau_dqdd) {
  torqueDerivatives(model.chain, setsOf(model), q, qd, qdd, dtau_dq, dtau_dqd, dtau_dqdd);
}

}  // namespace v2
}  // namespace chain_dynamics
