// SPDX-License-Identifier: Apache-2.0
#include "inverse_dynamics_control/friction_compensation.hpp"

#include <algorithm>
#include <cmath>
#include <inverse_dynamics_solver/exceptions.hpp>
#include <string>

#include "option_checks.hpp"

namespace inverse_dynamics_control {
inline namespace v2 {
namespace {

void require(bool fulfilled, const std::string& where, const std::string& expected, double got,
             const std::string& remedy) {
  if (fulfilled) return;
  throw inverse_dynamics_solver::InvalidParameterValueException(where, "wrong value", expected,
                                                                numberText(got), remedy);
}

}  // namespace

FrictionCompensation::FrictionCompensation(const FrictionOptions& options, const std::string& law)
    : options_(options) {
  const std::string where = law + ": friction: ";
  require(std::isfinite(options.dead_band) && options.dead_band >= 0, where + "dead_band",
          "a speed that isn't negative [rad/s]", options.dead_band, "correct this number");
  require(options.source != FrictionSource::kMeasuredVelocity || options.dead_band > 0,
          where + "dead_band", "a speed above zero [rad/s] with the measured velocity",
          options.dead_band, "take what the noise of a resting joint's velocity stays below");
  require(std::isfinite(options.blend) && options.blend > 0, where + "blend",
          "a speed above zero [rad/s]", options.blend,
          "friction jumps at rest, so it must be blended in");
  require(options.scale >= 0 && options.scale <= 1, where + "scale", "a part from 0 to 1",
          options.scale, "more friction than there is would push the arm on");
}

double FrictionCompensation::weight(double v) const noexcept {
  const double x = std::clamp((std::abs(v) - options_.dead_band) / options_.blend, 0.0, 1.0);
  return options_.scale * x * x * (3.0 - 2.0 * x);
}

void FrictionCompensation::weigh(const Eigen::Ref<const Eigen::VectorXd>& v,
                                 Eigen::Ref<Eigen::VectorXd> f) const noexcept {
  for (Eigen::Index j = 0; j < f.size(); ++j) f[j] *= weight(v[j]);
}

void FrictionCompensation::weighRest(const Eigen::Ref<const Eigen::VectorXd>& v,
                                     Eigen::Ref<Eigen::VectorXd> f) const noexcept {
  const double most = options_.source == FrictionSource::kReferenceVelocity ? options_.scale : 0.0;
  for (Eigen::Index j = 0; j < f.size(); ++j) f[j] *= std::max(0.0, most - weight(v[j]));
}

}  // namespace v2
}  // namespace inverse_dynamics_control
