// SPDX-License-Identifier: Apache-2.0

/// @file
/// A physically consistent model of an arm with its friction, from samples of its motion.
///
///     const ArmFitter fitter(chain);                       // chain_dynamics::chainFromUrdf(...)
///     ArmFitOptions options;
///     options.terms = FrictionTerms::kLoad;
///     const ArmData data = fitter.data({{q, qd, qdd, tau}});
///     const ArmFit fit = fitter.fit(data, options);
///     fitter.torques(fit, q, qd, qdd, computed);
///
/// The torque of joint j is `Y_j p + rotor_inertia_j qdd_j + f_j` [regressor_gram.hpp,
/// friction_step.hpp]; with a coupling C, `f = C' f_laws(C qd)` of any number of laws, and with springs also
/// `k q` or `a sin q + b cos q`. All that is linear in it is fitted by consistentFit(); width and shift of the
/// steps by Gauss-Newton steps, for which the samples are gone through again: 3 to 10 times. The
/// load of friction is that of the fit before. What is the same for all fits, the products Y_j' Y_j, is
/// summed once; up to 20 000 samples, their rows are kept, too. Memory doesn't grow with more.
///
/// A mechanism [chain_dynamics/mechanism.hpp] is fitted likewise: links are all its links, joints its
/// coordinates, and the tip is that of its first branch.
///
/// Where `tau` are motor currents i, the drive gains k are fitted too,
///
///     k_j i_j = Y_j p + rotor_inertia_j qdd_j + f_j + t_j,
///
/// t_j the torque of a body that the tip carries and that is known: it alone has a scale [Gautier,
/// Briot 2011, New Method for Global Identification of the Joint Drive Gains of Robots Using a Known
/// Payload Mass, IROS]. Errors are those of the currents, weighed with k_j: `2 N log k_j` is taken off
/// the cost, as small gains would make errors in N m small. log k_j takes Gauss-Newton steps as widths
/// do.

#pragma once

#include <chain_dynamics/chain.hpp>
#include <chain_dynamics/fast_model.hpp>
#include <chain_dynamics/mechanism.hpp>
#include <chain_dynamics/model.hpp>
#include <chain_dynamics/regressor_gram.hpp>
#include <chain_dynamics/states.hpp>
#include <string>
#include <utility>
#include <vector>

#include "inverse_dynamics_identification/consistent_fit.hpp"
#include "inverse_dynamics_identification/friction_step.hpp"
#include "inverse_dynamics_identification/residual_noise.hpp"

namespace inverse_dynamics_identification {
inline namespace v2 {

/// N samples of n joints in the order of time: a block of a recording, one sample per column. Views.
struct ArmSamples {
  chain_dynamics::ConstStates q, qd, qdd;  ///< rad, rad/s, rad/s^2 (prismatic m, m/s, m/s^2)
  chain_dynamics::ConstStates tau;         ///< N m (prismatic N); A where drive gains are fitted
  /// A known body at the tip, in the tip frame and about its origin.
  LinkParameters carried = LinkParameters::zero();
  OwnedVector time = {};  ///< N, ascending; s; for whitenedInformation() alone
  /// Positions before the first sample, which friction remembers: where joints turned round suffices.
  chain_dynamics::ConstStates before = {nullptr, 0, 0, 1, 0};
};

/// Blocks of samples for any number of fits. What their views look at must live as long.
class ArmData {
 private:
  friend class ArmFitter;
  struct Block {
    ArmSamples samples;
    chain_dynamics::RegressorGram links;              // products Y_j' Y_j
    std::vector<chain_dynamics::RegressorRows> rows;  // of each batch, unless there are too many
  };
  explicit ArmData(std::vector<Block> blocks) : blocks_(std::move(blocks)) {}

  std::vector<Block> blocks_;
};

/// Prior of friction. Velocities are shares of a joint's greatest; distances are in rad (prismatic m): a
/// gear's is the same however far its joint moves.
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
  double distance = 0.005;         ///< of presliding
  double least_distance = 1e-4;    ///< the play; shorter ones can't be told apart
  double most_distance = 0.5;      ///< longer ones are springs
};

/// Prior of a drive gain: a factor by which it may differ from its starting value.
constexpr double kDriveGainFactor = 3;

/// Options of a fit.
struct ArmFitOptions {
  FrictionTerms terms = FrictionTerms::kStep;
  double prior_strength = 100;  ///< gamma [consistent_fit.hpp]
  int most_passes = 10;         ///< over the samples
  /// Whether the step may be off zero velocity. Friction at rest is a constant then, although it may be
  /// anything up to its step: it helps within a recording, not on another day.
  bool shift = false;
  FrictionPrior friction = {};
  /// n, > 0; N m/A (prismatic N/A), about: what is measured are currents, and the gains are fitted.
  /// Empty: what is measured are torques.
  OwnedVector drive_gains = {};
};

/// A model of an arm.
struct ArmFit {
  OwnedMatrix parameters;              ///< 10 x links, in link frames
  OwnedVector rotor_inertia;           ///< n; kg m^2 (prismatic kg)
  std::vector<StepFriction> friction;  ///< n, or of each row of the coupling
  OwnedVector noise;                   ///< n; root mean square of the errors; N m (prismatic N)
  OwnedVector drive_gains;             ///< n; N m/A (prismatic N/A); empty: of measured torques
  double cost = 0;                     ///< what was minimised, up to a constant
  int passes = 0;
  /// 2 x n: of linear springs k [N m/rad; prismatic N/m] and zero, of levers a and b [N m]; empty: no springs.
  OwnedMatrix springs = {};
};

/// What samples and prior say of the unknowns at a fit: ten parameters of each link, then
/// ownColumns(terms) of each joint, and one more of log(drive gain) where these were fitted; then, of each
/// law beyond those of joints, ownColumns(terms) without acceleration and offset; then k or a, b of springs.
/// Those of shift, log(width), log(vs), log(distance) and log(drive gain) are steps from the fit.
struct ArmInformation {
  OwnedMatrix data;    ///< unknowns x unknowns: half the second derivatives of the weighted squares
  OwnedMatrix prior;   ///< the same of prior and penalties
  OwnedMatrix scores;  ///< unknowns x blocks: half the negative gradients of each block's squares
};

class OwnRows;

/// Fits models of one arm. Threads: safe.
class ArmFitter {
 public:
  /// @param description  its links are the prior, once linkPrior() has seen to them.
  /// @param coupling     r x n, r >= n, as chain_dynamics::Model::coupling: laws of friction act at the
  ///     velocities `coupling qd`. Laws of rows that aren't their joint's alone have no load friction.
  ///     Empty: each joint has its own law.
  /// @param springs      n, of each joint what is fitted; empty: no springs.
  /// @param places       names of the r - n other places with friction; empty: place 1, place 2, ...
  /// @throws chain_dynamics::ModelError  more than 64 joints or 128 laws, a mechanism that checkMechanism()
  ///     refuses, coupling or springs of another size, a row of zeros.
  explicit ArmFitter(const chain_dynamics::Mechanism& description, const LinkFloor& floor = {},
                     const OwnedMatrix& coupling = {}, std::vector<SpringTerms> springs = {},
                     std::vector<std::string> places = {});
  explicit ArmFitter(const chain_dynamics::Chain& description, const LinkFloor& floor = {},
                     const OwnedMatrix& coupling = {}, std::vector<SpringTerms> springs = {},
                     std::vector<std::string> places = {})
      : ArmFitter(chain_dynamics::Mechanism{description, {}}, floor, coupling, std::move(springs),
                  std::move(places)) {}

  const chain_dynamics::Mechanism& robot() const { return robot_; }
  /// The chain, or the coordinates of the mechanism.
  const chain_dynamics::Chain& description() const { return robot_.coordinates; }
  const OwnedMatrix& coupling() const { return coupling_; }
  const std::vector<SpringTerms>& springs() const { return springs_; }
  const std::vector<std::string>& frictionPlaces() const { return places_; }
  /// What was made of the links, and why.
  const std::vector<LinkPrior>& prior() const { return prior_; }

  /// @throws chain_dynamics::ModelError  no samples, other numbers of joints.
  ArmData data(std::vector<ArmSamples> blocks) const;

  /// A fit to the samples of all blocks.
  ///
  /// @param start  another fit to begin with; its terms may be others.
  /// @throws chain_dynamics::ModelError  no samples, numbers that aren't finite, a fit of another
  ///     arm, drive gains that aren't above zero.
  ArmFit fit(const ArmData& data, const ArmFitOptions& options,
             const ArmFit* start = nullptr) const;
  /// The same of samples that no other fit needs.
  ArmFit fit(const std::vector<ArmSamples>& blocks, const ArmFitOptions& options,
             const ArmFit* start = nullptr) const {
    return fit(data(blocks), options, start);
  }

  /// Of each block, a fit to the others: one Gauss-Newton step of all unknowns from a fit to all blocks.
  ///
  /// @param options  those of the fit; the strength of the prior may be another.
  /// @throws chain_dynamics::ModelError  as fit().
  std::vector<ArmFit> leftOut(const ArmFit& fit, const ArmData& data,
                              const ArmFitOptions& options) const;

  /// What the samples of each block say at a fit, weighed by its noise.
  ArmInformation information(const ArmFit& fit, const ArmData& data,
                             const ArmFitOptions& options) const;

  /// What samples say of the unknowns at a fit whose errors are correlated in time: as
  /// ArmInformation::data, of rows that the filter of this noise has made white.
  ///
  /// @throws chain_dynamics::ModelError  samples without times, a fit or noise of others.
  OwnedMatrix whitenedInformation(const ArmFit& fit, FrictionTerms terms, const ArmData& data,
                                  const ResidualNoise& noise) const;

  /// The robot that a fit is.
  ///
  /// @throws chain_dynamics::ModelError  a fit of another arm.
  chain_dynamics::Model model(const ArmFit& fit) const;

  /// `tau = H qdd + C qd + g + rotor_inertia qdd + f` of N states in the order of time.
  ///
  /// @param before  as ArmSamples::before.
  void torques(const ArmFit& fit, chain_dynamics::ConstStates q, chain_dynamics::ConstStates qd,
               chain_dynamics::ConstStates qdd, chain_dynamics::States tau,
               chain_dynamics::ConstStates before = {nullptr, 0, 0, 1, 0}) const;

 private:
  using Gram = chain_dynamics::RegressorGram;

  void check(const ArmFit& fit) const;
  Eigen::Index joints() const { return robot_.coordinates.jointCount(); }
  Eigen::Index links() const { return static_cast<Eigen::Index>(prior_.size()); }
  chain_dynamics::Model robotOf(const OwnedMatrix& parameters, const OwnedVector* rotors,
                                const LinkParameters& carried = LinkParameters::zero()) const;
  /// Sums of blocks with the own columns of a fit [friction_step.hpp], less the torque of what is
  /// carried. Where the fit has drive gains, there is one more column: minus the computed torque, which is
  /// the derivative by log k of the errors. links: the products Y_j' Y_j of the same blocks.
  Gram gramOf(const ArmFit& fit, FrictionTerms terms,
              const std::vector<const ArmData::Block*>& blocks, const Gram& links) const;

  OwnRows rowsOf(FrictionTerms terms, bool has_gains) const;
  Eigen::Index laws() const { return coupling_.size() == 0 ? joints() : coupling_.rows(); }

  chain_dynamics::Mechanism robot_;
  OwnedMatrix coupling_;
  std::vector<SpringTerms> springs_;
  std::vector<std::string> places_;
  std::vector<LinkPrior> prior_;
  chain_dynamics::FastModel fast_;
};

}  // namespace v2
}  // namespace inverse_dynamics_identification
