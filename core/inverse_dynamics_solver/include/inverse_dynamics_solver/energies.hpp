// SPDX-License-Identifier: Apache-2.0
/// @file
/// Capability: the energy of the robot's bodies.
///
///     if (const auto* energies = dynamic_cast<const Energies*>(solver.get())) {
///       const double E = energies->getKineticEnergy(q, qd) + energies->getPotentialEnergy(q);
///     }
#pragma once

#include <Eigen/Core>

#include "inverse_dynamics_solver/capability.hpp"

namespace inverse_dynamics_solver {
inline namespace v2 {

/// Kinetic and potential energy. Their sum grows with the power of all torques but friction:
/// `d(T + U)/dt = qd^T (tau - f)`.
///
/// A robot whose H isn't symmetric, or whose g isn't the gradient of a potential, has no energy: all
/// methods but hasEnergies() throw Exception.
class Energies : public Capability {
 public:
  ~Energies() override;

  /// Whether the robot has energies: always where inertiaIsPhysical(), and for identified models
  /// that have one set of parameters for all rows of H.
  bool hasEnergies() const;

  /// `T(q, qd) = 1/2 qd^T H(q) qd` [J]; where not inertiaIsPhysical() it may be negative.
  double getKineticEnergy(const ConstVectorRef& q, const ConstVectorRef& qd) const;

  /// `U(q)` [J], of which g is the gradient; zero where all masses are at the root's origin and all springs
  /// at rest.
  double getPotentialEnergy(const ConstVectorRef& q) const;

  /// @name Many states at once
  /// One number per state, 1 x N.
  /// @{
  void getKineticEnergyBatch(const ConstStatesRef& q, const ConstStatesRef& qd,
                             const States& T) const;
  void getPotentialEnergyBatch(const ConstStatesRef& q, const States& U) const;

  Eigen::RowVectorXd getKineticEnergyBatch(const ConstStatesRef& q,
                                           const ConstStatesRef& qd) const {
    Eigen::RowVectorXd T(q.count);
    getKineticEnergyBatch(q, qd, T);
    return T;
  }
  Eigen::RowVectorXd getPotentialEnergyBatch(const ConstStatesRef& q) const {
    Eigen::RowVectorXd U(q.count);
    getPotentialEnergyBatch(q, U);
    return U;
  }
  /// @}

 protected:
  /// @name What a solver implements
  /// As the compute... of InverseDynamicsSolver; called where hasEnergiesImpl() is true.
  /// @{

  /// Answer of hasEnergies(); by default that of inertiaIsPhysical().
  virtual bool hasEnergiesImpl() const;

  virtual double computeKineticEnergy(const ConstVectorRef& q, const ConstVectorRef& qd) const = 0;
  virtual double computePotentialEnergy(const ConstVectorRef& q) const = 0;
  /// @}
};

}  // namespace v2
}  // namespace inverse_dynamics_solver
