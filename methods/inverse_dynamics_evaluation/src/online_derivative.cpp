// SPDX-License-Identifier: Apache-2.0

#include "inverse_dynamics_evaluation/online_derivative.hpp"

#include <cmath>
#include <cstdint>
#include <string>

#include "inverse_dynamics_evaluation/error.hpp"

namespace inverse_dynamics_evaluation {
inline namespace v2 {
namespace {

constexpr double kSettled = 6.6384;  // (1 + x) exp(-x) = 0.01: what is left of a start, x = w t

double requirePositive(const char* what, double value) {
  if (!(value > 0) || !std::isfinite(value)) {
    throw EvaluationError("online derivative", what, "a number above 0", std::to_string(value),
                          "the defaults suit an arm at 100 Hz or more");
  }
  return value;
}

}  // namespace

OnlineDerivative::OnlineDerivative(Eigen::Index size, double cutoff, double longest_gap)
    : w_(2.0 * M_PI * requirePositive("cut-off [Hz]", cutoff)),
      longest_gap_(requirePositive("longest gap [s]", longest_gap)),
      input_(Eigen::VectorXd::Zero(size)),
      value_(Eigen::VectorXd::Zero(size)),
      derivative_(Eigen::VectorXd::Zero(size)) {}

OnlineDerivative::Step OnlineDerivative::update(std::int64_t stamp,
                                                const Eigen::Ref<const Eigen::VectorXd>& u) {
  if (!started_) {
    start(stamp, u);
    return Step::kStarted;
  }
  const double dt = static_cast<double>(stamp - last_) * 1e-9;
  if (dt == 0.0) return Step::kRepeated;
  if (dt < 0.0 || dt > longest_gap_) {
    start(stamp, u);
    return dt < 0.0 ? Step::kWentBack : Step::kGap;
  }
  const double decay = std::exp(-w_ * dt);
  for (Eigen::Index j = 0; j < u.size(); ++j) {
    // y = straight line that lags by 2 / w, plus exp(-w t) (a + b t)
    const double slope = (u[j] - input_[j]) / dt;
    const double a = value_[j] - (input_[j] - 2.0 * slope / w_);
    const double b = derivative_[j] - slope + w_ * a;
    value_[j] = u[j] - 2.0 * slope / w_ + decay * (a + b * dt);
    derivative_[j] = slope + decay * (b - w_ * (a + b * dt));
    input_[j] = u[j];
  }
  last_ = stamp;
  return Step::kContinued;
}

bool OnlineDerivative::settled() const {
  return started_ && w_ * static_cast<double>(last_ - begin_) * 1e-9 >= kSettled;
}

void OnlineDerivative::start(std::int64_t stamp, const Eigen::Ref<const Eigen::VectorXd>& u) {
  started_ = true;
  begin_ = last_ = stamp;
  input_ = u;
  value_ = u;
  derivative_.setZero();
}

}  // namespace v2
}  // namespace inverse_dynamics_evaluation
