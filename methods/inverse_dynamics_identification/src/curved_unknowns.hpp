// SPDX-License-Identifier: Apache-2.0
/// @file
/// Unknowns of an arm that torques aren't linear in.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

#include "inverse_dynamics_identification/arm_fit.hpp"
#include "own_rows.hpp"

namespace inverse_dynamics_identification {
inline namespace v2 {

constexpr double kSettledStep = 0.02;  // Gauss-Newton step, relative to the width, that ends it
constexpr double kSettledGain = 1e-3;  // the same, of the logarithm of a drive gain
constexpr double kHeld = 1e-6;  // deviation of what is held; of a shift by the greatest velocity
constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// An unknown of a joint that torques aren't linear in: a fit takes Gauss-Newton steps of it, or of its
/// logarithm.
struct Curved {
  Eigen::Index column;          // of the derivative
  double StepFriction::*value;  // null: the drive gain
  bool is_logarithm;
  double center, deviation;  // what it is drawn to
  double least, most;
  double settled = kSettledStep;

  double of(const ArmFit& fit, Eigen::Index j) const {
    return value != nullptr ? fit.friction[static_cast<std::size_t>(j)].*value : fit.drive_gains[j];
  }
  double distance(const ArmFit& fit, Eigen::Index j) const {
    return is_logarithm ? std::log(of(fit, j) / center) : of(fit, j) - center;
  }
  /// From one fit to another.
  double step(const ArmFit& from, const ArmFit& to, Eigen::Index j) const {
    return is_logarithm ? std::log(of(to, j) / of(from, j)) : of(to, j) - of(from, j);
  }
  /// Of steps: the width of friction, or a factor e.
  double unit(const ArmFit& fit, Eigen::Index j) const {
    return is_logarithm ? 1.0 : fit.friction[static_cast<std::size_t>(j)].width;
  }
  double moved(const ArmFit& fit, Eigen::Index j, double by, double most_units) const {
    const double longest = most_units * unit(fit, j), step = std::clamp(by, -longest, longest);
    return std::clamp(is_logarithm ? of(fit, j) * std::exp(step) : of(fit, j) + step, least, most);
  }
};

/// How fast what has friction moves: by the coupling, or joints.
class Reach {
 public:
  explicit Reach(Eigen::Index laws) : greatest_(Eigen::VectorXd::Zero(laws)) {}

  void add(const ArmSamples& samples, const OwnedMatrix& coupling) {
    for (Eigen::Index k = 0; k < samples.qd.count; ++k) {
      for (Eigen::Index j = 0; j < laws(); ++j) {
        const double v = atLaw(coupling, j, [&](Eigen::Index i) { return samples.qd(i, k); });
        greatest_[j] = std::max(greatest_[j], std::abs(v));
      }
    }
  }

  Eigen::Index laws() const { return greatest_.size(); }
  /// The greatest velocity.
  double velocity(Eigen::Index j) const { return std::max(greatest_[j], kLeast); }

 private:
  static constexpr double kLeast = 1e-6;  // of a joint that stands still
  Eigen::VectorXd greatest_;
};

/// The curved unknowns of a law and, if it is a joint's, of its drive gain.
inline std::vector<Curved> curvedUnknowns(const ArmFitOptions& options, Eigen::Index law,
                                          const Reach& reach) {
  using namespace own_column;
  const FrictionPrior& prior = options.friction;
  const double greatest = reach.velocity(law);
  const double factor = std::log(prior.width_factor);
  const double shift = (options.shift ? prior.shift : kHeld) * greatest;
  const double most_shift = options.shift ? prior.most_shift * greatest : 0.0;
  std::vector<Curved> curved = {
      {kShift, &StepFriction::shift, false, 0, shift, -most_shift, most_shift},
      {kWidth, &StepFriction::width, true, prior.width * greatest, factor,
       prior.least_width * greatest, prior.most_width * greatest}};
  if (options.terms >= FrictionTerms::kStribeck) {
    curved.push_back({kStribeckVelocity, &StepFriction::vs, true,
                      prior.stribeck_velocity * greatest, factor, 0, greatest});
  }
  if (options.terms >= FrictionTerms::kMemory) {
    curved.push_back({kDistance, &StepFriction::distance, true, prior.distance, factor,
                      prior.least_distance, prior.most_distance});
  }
  if (options.drive_gains.size() > law) {
    curved.push_back({ownColumns(options.terms), nullptr, true, options.drive_gains[law],
                      std::log(kDriveGainFactor), 0, kInfinity, kSettledGain});
  }
  return curved;
}

}  // namespace v2
}  // namespace inverse_dynamics_identification
