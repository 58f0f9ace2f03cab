// SPDX-License-Identifier: Apache-2.0

/// @file
/// Uncertainty of the torques of an identified model.
///
///     ArmDeviations deviations(solver, uncertainty);
///     deviations.compute(q, qd, qdd, D);                  // K x n
///     tau += D.transpose() * z;                           // of one arm that it may be, z ~ N(0, I)
///
/// The unknowns of a fit are those of ArmInformation [arm_fit.hpp]. Their covariance is `factor factor'`,
/// so torques near the model are those of the model plus `W factor z`, W their derivatives by the unknowns.

#pragma once

#include <Eigen/Core>
#include <inverse_dynamics_solver/inverse_dynamics_solver.hpp>
#include <inverse_dynamics_solver/regressor.hpp>
#include <memory>
#include <vector>

#include "chain_dynamics/owned.hpp"
#include "inverse_dynamics_identification/friction_step.hpp"

namespace inverse_dynamics_identification {
inline namespace v2 {

/// Of a model with n joints and m unknowns.
struct ArmUncertainty {
  /// The model's: n, or of each row of the coupling.
  std::vector<StepFriction> friction;
  /// m x K: columns are independent deviations from the model, of one standard deviation each. Rows:
  /// ten parameters of each link in the frames of the solver's regressor, then own unknowns as those of
  /// ArmInformation.
  chain_dynamics::OwnedMatrix factor;
  chain_dynamics::OwnedMatrix coupling = {};  ///< as ArmFitter takes it
  std::vector<SpringTerms> springs = {};      ///< likewise
};

class OwnRows;

/// Torques of these deviations. Not thread-safe.
class ArmDeviations {
 public:
  /// @throws inverse_dynamics_solver::InvalidParameterValueException  no solver, or one without the
  ///     capability Regressor; sizes that don't fit its joints, numbers that aren't finite.
  ArmDeviations(std::shared_ptr<const inverse_dynamics_solver::InverseDynamicsSolver> solver,
                const ArmUncertainty& uncertainty);

  /// K.
  Eigen::Index count() const noexcept { return factor_.rows(); }

  /// Torques per standard deviation. The load of friction is that of the solver, payloads included.
  ///
  /// @param q,qd,qdd  n each; rad, rad/s, rad/s^2 (prismatic m, m/s, m/s^2).
  /// @param[out] D    K x n; N m (prismatic N).
  /// Throws what the solver throws. Real time: as the solver: no allocation, lock or system call.
  void compute(const inverse_dynamics_solver::ConstVectorRef& q,
               const inverse_dynamics_solver::ConstVectorRef& qd,
               const inverse_dynamics_solver::ConstVectorRef& qdd,
               inverse_dynamics_solver::MatrixRef D);

 private:
  std::shared_ptr<const inverse_dynamics_solver::InverseDynamicsSolver> solver_;
  const inverse_dynamics_solver::Regressor* regressor_;  // of the solver
  ArmUncertainty of_;
  std::shared_ptr<const OwnRows> rows_;
  chain_dynamics::OwnedMatrix factor_;  // K x m
  chain_dynamics::OwnedMatrix Y_;       // n x 10 links
  std::vector<Eigen::Index> before_;    // columns of Y_ that are zero in each row
  chain_dynamics::OwnedVector gravity_, law_;
  chain_dynamics::OwnedMatrix own_;  // n x own columns
};

}  // namespace v2
}  // namespace inverse_dynamics_identification
