// SPDX-License-Identifier: Apache-2.0

/// @file
/// The functions of model.hpp, for a model with branches: sums over these [mechanism.hpp].

#pragma once

#include "chain_dynamics/model.hpp"

namespace chain_dynamics {
inline namespace v2 {
namespace sums {

void torques(const Model& model, const ConstVectorRef& q, const ConstVectorRef& qd,
             const ConstVectorRef& qdd, VectorRef tau);
void inertiaMatrix(const Model& model, const ConstVectorRef& q, MatrixRef H);
void coriolisVector(const Model& model, const ConstVectorRef& q, const ConstVectorRef& qd,
                    VectorRef c);
void coriolisMatrix(const Model& model, const ConstVectorRef& q, const ConstVectorRef& qd,
                    MatrixRef C);
void gravityVector(const Model& model, const ConstVectorRef& q, VectorRef g);
void torqueDerivatives(const Model& model, const ConstVectorRef& q, const ConstVectorRef& qd,
                       const ConstVectorRef& qdd, MatrixRef dtau_dq, MatrixRef dtau_dqd,
                       MatrixRef dtau_dqdd);
double kineticEnergy(const Model& model, const ConstVectorRef& q, const ConstVectorRef& qd);
double potentialEnergy(const Model& model, const ConstVectorRef& q);

/// Adds `factors_j dg_j/dq` to the rows j.
void addGravityDerivatives(const Model& model, const ConstVectorRef& q,
                           const ConstVectorRef& factors, MatrixRef dtau_dq);

}  // namespace sums
}  // namespace v2
}  // namespace chain_dynamics
