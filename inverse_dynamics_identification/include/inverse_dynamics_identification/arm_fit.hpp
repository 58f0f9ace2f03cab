// SPDX-License-Identifier: Apache-2.0

/// @file
/// A physically consistent model of an arm with its friction, from samples of its motion.
///
///     const ArmFitter fitter(chain);                       // chain_dynamics::chainFromUrdf(...)
///     ArmFitOptions options;
///     options.terms = FrictionTerms::kLoad;
///     const ArmFit fit = fitter.fit({{q, qd, qdd, tau}}, options);
///     fitter.torques(fit, q, qd, qdd, computed);
///
/// The torque of joint j is `Y_j p + rotor_inertia_j qdd_j + f_j` [regressor_gram.hpp,
/// friction_step.hpp]. All that is linear in it is fitted by consistentFit(); width and shift of the
/// steps by Gauss-Newton steps, for which the samples are gone through again: 3 to 10 times. The
/// load of friction is that of the fit before. Memory doesn't grow with the samples.

#pragma once

#include <chain_dynamics/chain.hpp>
#include <chain_dynamics/fast_model.hpp>
#include <chain_dynamics/states.hpp>
#include <vector>

#include "inverse_dynamics_identification/consistent_fit.hpp"
#include "inverse_dynamics_identification/friction_step.hpp"

namespace inverse_dynamics_identification {
inline namespace v2 {

/// N samples of n joints: a block of a recording, a sample a column. Views.
struct ArmSamples {
  chain_dynamics::ConstStates q, qd, qdd;  ///< rad, rad/s, rad/s^2 (prismatic m, m/s, m/s^2)
  chain_dynamics::ConstStates tau;         ///< N m (prismatic N)
};

/// What is known of friction beforehand. Velocities are shares of a joint's greatest.
struct FrictionPrior {
  double width = 0.05;         ///< of the step
  double width_factor = 2.7;   ///< by which it may well differ
  double least_width = 0.002;  ///< narrower steps can't be told apart
  double most_width = 0.3;     ///< wider ones are viscous friction
  double shift = 0.02;         ///< standard deviation
  double most_shift = 0.1;
  double load = 0.1;               ///< standard deviation of fl
  double most_load = 0.5;          ///< fl is below
  double stribeck_velocity = 0.1;  ///< where the step has fallen
};

/// How to fit.
struct ArmFitOptions {
  FrictionTerms terms = FrictionTerms::kStep;
  double prior_strength = 100;  ///< gamma [consistent_fit.hpp]
  int most_passes = 10;         ///< over the samples
  FrictionPrior friction = {};
};

/// A model of an arm.
struct ArmFit {
  OwnedMatrix parameters;              ///< 10 x n, in link frames
  OwnedVector rotor_inertia;           ///< n; kg m^2 (prismatic kg)
  std::vector<StepFriction> friction;  ///< n
  OwnedVector noise;                   ///< n; root mean square of the errors; N m (prismatic N)
  double cost = 0;                     ///< what was minimised, up to a constant
  int passes = 0;
};

/// What samples and prior say of the unknowns at a fit: 10 n parameters, then ownColumns(terms) of each
/// joint; those of shift, log(width) and log(vs) are steps from the fit.
struct ArmInformation {
  OwnedMatrix data;    ///< unknowns x unknowns: half the second derivatives of the weighted squares
  OwnedMatrix prior;   ///< the same of prior and penalties
  OwnedMatrix scores;  ///< unknowns x blocks: half the negative gradients of each block's squares
};

/// Fits models of one arm. Threads: safe.
class ArmFitter {
 public:
  /// @param description  its links are the prior, once linkPrior() has seen to them.
  /// @throws chain_dynamics::ModelError  more than 64 joints.
  explicit ArmFitter(const chain_dynamics::Chain& description, const LinkFloor& floor = {});

  const chain_dynamics::Chain& description() const { return chain_; }
  /// What was made of the links, and why.
  const std::vector<LinkPrior>& prior() const { return prior_; }

  /// A fit to the samples of all blocks.
  ///
  /// @param start  another fit to begin with; its terms may be others.
  /// @throws chain_dynamics::ModelError  no samples, other numbers of joints, numbers that aren't
  ///     finite.
  ArmFit fit(const std::vector<ArmSamples>& blocks, const ArmFitOptions& options,
             const ArmFit* start = nullptr) const;

  /// What the samples of each block say at a fit, weighed by its noise.
  ArmInformation information(const ArmFit& fit, const std::vector<ArmSamples>& blocks,
                             const ArmFitOptions& options) const;

  /// `tau = H qdd + C qd + g + rotor_inertia qdd + f` of N states.
  void torques(const ArmFit& fit, chain_dynamics::ConstStates q, chain_dynamics::ConstStates qd,
               chain_dynamics::ConstStates qdd, chain_dynamics::States tau) const;

  /// Adds samples with the own columns of a fit [friction_step.hpp].
  ///
  /// @param gram  of ownColumns(terms) columns.
  void addToGram(const ArmFit& fit, const ArmSamples& samples,
                 chain_dynamics::RegressorGram& gram) const;

 private:
  chain_dynamics::Chain withLinks(const OwnedMatrix& parameters, const OwnedVector* rotors) const;

  chain_dynamics::Chain chain_;
  std::vector<LinkPrior> prior_;
  chain_dynamics::FastModel fast_;
};

}  // namespace v2
}  // namespace inverse_dynamics_identification
