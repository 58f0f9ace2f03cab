// SPDX-License-Identifier: Apache-2.0

/// @file
/// Inertial parameters that are a robot's, from Gram matrices: a convex fit.
///
///     RegressorGram gram = fast.emptyGram(2);          // own columns: qdd (rotor inertia), qd
///     fast.addToGram(samples, gram);                   // any number of times, blocks, recordings
///     const Prior prior{chain.links(), std::vector<OwnColumn>(2 * n, OwnColumn::positive())};
///     Fit fit = consistentFit(gram, prior, options);   // every link is a body
///
/// The least squares on the regressor [regressor_gram.hpp] leave most of the ten numbers of each link
/// open and give negative masses. What is minimised here instead is
///
///     sum_j |e_j|^2 / sigma_j^2  +  gamma sum_i [tr(P0_i^-1 P_i) - log det P_i]  +  penalties
///
/// with e_j the errors of joint j's torque, P_i the pseudo-inertia of link i [pseudo_inertia.hpp] and
/// P0_i that of the description: a divergence between two distributions of mass, which is convex,
/// keeps P_i positive definite, and doesn't depend on the choice of link frames [Lee, Wensing, Park
/// 2020, doi 10.1109/TRO.2019.2949062]. The penalties are those of OwnColumn.
///
/// Solved by Newton's method with step control, along a path from a large gamma, where the prior is
/// the solution, to the gamma that is asked for. The noise sigma_j is that of the errors: fits and
/// estimates take turns.

#pragma once

#include <Eigen/Core>
#include <chain_dynamics/chain.hpp>
#include <chain_dynamics/owned.hpp>
#include <chain_dynamics/regressor_gram.hpp>
#include <limits>
#include <vector>

#include "inverse_dynamics_identification/pseudo_inertia.hpp"

namespace inverse_dynamics_identification {
inline namespace v2 {

using chain_dynamics::OwnedMatrix;
using chain_dynamics::OwnedVector;

/// Prior of the coefficient x of a joint's own column.
///
/// The penalty is `-log(x) - log(most - x) + ((x - center) / deviation)^2`, of which those terms
/// are there that are asked for. A column without any must be determined by the data.
struct OwnColumn {
  bool is_positive = false;                                    ///< x > 0
  double most = std::numeric_limits<double>::infinity();       ///< x < most
  double center = 0;                                           ///< in the unit of x
  double deviation = std::numeric_limits<double>::infinity();  ///< in the unit of x

  static OwnColumn positive() { return {true}; }
};

/// Priors, from which the fit also starts.
struct Prior {
  std::vector<LinkParameters> links;  ///< of all links, positive definite each: linkPrior()
  /// Of joint 1, of joint 2, ...; as many for each. Of columns that share an unknown, the first counts.
  std::vector<OwnColumn> own;
  /// Which of the gram's own columns these are, ascending; the coefficients of the others are zero.
  /// Empty: all of them.
  std::vector<Eigen::Index> columns = {};
};

/// Options of a fit.
struct FitOptions {
  double prior_strength = 100;  ///< gamma > 0
  int noise_iterations = 4;     ///< fits, with an estimate of the noise after each
  double tolerance = 0;         ///< of the cost, beyond rounding
  OwnedVector noise = {};       ///< n; standard deviations to begin with; N m; empty: by itself
};

/// A robot, and how well it fits.
struct Fit {
  OwnedMatrix parameters;  ///< 10 x links, in the order of LinkParameters::toVector()
  OwnedMatrix own;         ///< own columns x n; of columns that share an unknown, the same
  OwnedVector noise;       ///< n; root mean square of the errors under this fit; N m (prismatic N)
  OwnedVector weighed_by;  ///< n; the noise that the fit was made with
  double cost = 0;         ///< what was minimised, with that noise
  int newton_steps = 0;
};

/// The fit to samples whose Gram matrices these are.
///
/// @param start  a fit of the same columns to begin with, e.g. one to nearly the same samples;
///     coefficients of its own columns that are beyond their limits begin within.
/// @throws chain_dynamics::ModelError  sizes that differ, a link of the prior that is no body, numbers
///     that aren't finite, or samples that leave a column open.
Fit consistentFit(const chain_dynamics::RegressorGram& gram, const Prior& prior,
                  const FitOptions& options = {}, const Fit* start = nullptr);

/// What the data and what the prior say of the unknowns at a fit: halves of the second derivatives of
/// the cost, in the order of RegressorGram::normalEquations().
struct Information {
  OwnedMatrix data;   ///< unknowns x unknowns; singular where the data say nothing
  OwnedMatrix prior;  ///< the same size: of the prior and the penalties
};

/// That of a fit.
///
/// @throws chain_dynamics::ModelError  sizes that differ.
Information information(const chain_dynamics::RegressorGram& gram, const Prior& prior,
                        const FitOptions& options, const Fit& fit);

}  // namespace v2
}  // namespace inverse_dynamics_identification
