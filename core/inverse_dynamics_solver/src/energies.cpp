// SPDX-License-Identifier: Apache-2.0
#include "inverse_dynamics_solver/energies.hpp"

#include "method_call.hpp"
#include "one_state.hpp"

namespace inverse_dynamics_solver {
inline namespace v2 {

Energies::~Energies() = default;

namespace {

void require(bool has_energies, const char* method) {
  if (has_energies) return;
  throw Exception(method, "the robot has no energies",
                  "a symmetric inertia matrix, and gravity torques that are the gradient "
                  "of a potential",
                  "parameters that differ from row to row",
                  "use a solver of a robot description, or ask hasEnergies() first");
}

}  // namespace

bool Energies::hasEnergies() const {
  jointsFor("hasEnergies");
  return hasEnergiesImpl();
}

bool Energies::hasEnergiesImpl() const { return torqueSolver().inertiaIsPhysical(); }

double Energies::getKineticEnergy(const ConstVectorRef& q, const ConstVectorRef& qd) const {
  MethodCall("getKineticEnergy", torqueSolver()).vector("q", q).vector("qd", qd);
  require(hasEnergiesImpl(), "getKineticEnergy");
  return computeKineticEnergy(q, qd);
}

double Energies::getPotentialEnergy(const ConstVectorRef& q) const {
  MethodCall("getPotentialEnergy", torqueSolver()).vector("q", q);
  require(hasEnergiesImpl(), "getPotentialEnergy");
  return computePotentialEnergy(q);
}

void Energies::getKineticEnergyBatch(const ConstStatesRef& q, const ConstStatesRef& qd,
                                     const States& T) const {
  const BatchCall call("getKineticEnergyBatch", torqueSolver(), q.count);
  call.states("q", q).states("qd", qd).rows("T", T, 1);
  require(hasEnergiesImpl(), "getKineticEnergyBatch");
  const auto of_state = [this](const ConstVectorRef& q_k, const ConstVectorRef& qd_k,
                               VectorRef T_k) { T_k[0] = computeKineticEnergy(q_k, qd_k); };
  call.share([&](const auto&... part) { eachState(of_state, part...); }, q, qd, T);
}

void Energies::getPotentialEnergyBatch(const ConstStatesRef& q, const States& U) const {
  const BatchCall call("getPotentialEnergyBatch", torqueSolver(), q.count);
  call.states("q", q).rows("U", U, 1);
  require(hasEnergiesImpl(), "getPotentialEnergyBatch");
  const auto of_state = [this](const ConstVectorRef& q_k, VectorRef U_k) {
    U_k[0] = computePotentialEnergy(q_k);
  };
  call.share([&](const auto&... part) { eachState(of_state, part...); }, q, U);
}

}  // namespace v2
}  // namespace inverse_dynamics_solver
