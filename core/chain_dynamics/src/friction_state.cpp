// SPDX-License-Identifier: Apache-2.0

#include "chain_dynamics/friction_state.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <memory>
#include <utility>
#include <variant>

#include "chain_dynamics/model.hpp"

namespace chain_dynamics {
inline namespace v2 {

namespace {

constexpr double kRounding = 1e-17;  // of a part of friction; sums of denormal numbers take long

/// exp(-x), x >= 0; zero where rounding hides it.
double left(double x) { return x > 40 ? 0 : std::exp(-x); }

}  // namespace

FrictionState::FrictionState(const Model& model) {
  auto laws = std::make_shared<Laws>();
  bool remembers = false;
  for (const FrictionLaw& law : model.friction) {
    const auto* const smooth = std::get_if<SmoothCoulomb>(&law);
    const bool lags = smooth != nullptr && smooth->distance > 0 && smooth->fm + smooth->fs != 0;
    laws->each.push_back(lags ? *smooth : SmoothCoulomb());
    remembers = remembers || lags;
  }
  if (!remembers) return;
  laws->coupling = model.coupling;
  for (const Joint& joint : model.chain.joints()) laws->types.push_back(joint.type);
  memory_.resize(laws->each.size());
  last_.resize(laws->types.size());
  laws_ = std::move(laws);
  reset();
}

void FrictionState::reset() noexcept {
  for (Presliding<double>& of : memory_) of = {};
  std::fill(last_.begin(), last_.end(), std::numeric_limits<double>::quiet_NaN());
}

/// action(joint, c) for each joint with which the law's velocity changes, by the factor c.
template <class Action>
void FrictionState::forEachJoint(std::size_t law, const Action& action) const noexcept {
  const auto row = static_cast<Eigen::Index>(law);
  const OwnedMatrix& coupling = laws_->coupling;
  if (coupling.size() == 0) action(row, 1.0);
  for (Eigen::Index j = 0; j < coupling.cols(); ++j) {
    if (const double c = coupling(row, j); c != 0) action(j, c);
  }
}

template <class At>
void FrictionState::advance(const At& q) noexcept {
  for (std::size_t l = 0; l < memory_.size(); ++l) {
    const double distance = laws_->each[l].distance;
    if (distance == 0) continue;
    double by = 0;
    forEachJoint(l, [&](Eigen::Index j, double c) {
      const auto joint = static_cast<std::size_t>(j);
      const double from = last_[joint];
      by += c * (unwrapped(laws_->types[joint], q(j), from) - from);
    });
    if (std::isfinite(by)) memory_[l].move(by, distance);
  }
  for (std::size_t j = 0; j < last_.size(); ++j) {
    const double now = q(static_cast<Eigen::Index>(j));
    if (std::isfinite(now)) last_[j] = now;
  }
}

template <class At, class Add>
void FrictionState::add(const At& qd, const Add& add) const noexcept {
  for (std::size_t l = 0; l < memory_.size(); ++l) {
    const SmoothCoulomb& law = laws_->each[l];
    if (law.distance == 0) continue;
    double v = 0;
    forEachJoint(l, [&](Eigen::Index j, double c) { v += c * qd(j); });
    const double x = (v + law.shift) / law.width, e = left(2 * std::abs(x));
    const double step = std::copysign((1 - e) / (1 + e), x);  // tanh x
    const double known = memory_[l].z - step;
    const double unknown = memory_[l].unknown > kRounding ? memory_[l].unknown : 0;
    if (known == 0 && unknown == 0) continue;  // it is at its limit
    const double height = law.fm + (law.fs == 0 ? 0 : law.fs * left(v * v / (law.vs * law.vs)));
    forEachJoint(l, [&](Eigen::Index j, double c) {
      add(j, c * height * known, c * height * unknown, step);
    });
  }
}

void FrictionState::move(const Eigen::Ref<const Eigen::VectorXd>& q) noexcept {
  if (remembers()) advance([&](Eigen::Index j) { return q[j]; });
}

void FrictionState::addTo(const Eigen::Ref<const Eigen::VectorXd>& qd,
                          Eigen::Ref<Eigen::VectorXd> f) const noexcept {
  add([&](Eigen::Index j) { return qd[j]; }, [&](Eigen::Index j, double known, double unknown,
                                                 double step) { f[j] += known + unknown * step; });
}

void FrictionState::addRange(const Eigen::Ref<const Eigen::VectorXd>& qd,
                             Eigen::Ref<Eigen::VectorXd> least,
                             Eigen::Ref<Eigen::VectorXd> most) const noexcept {
  add([&](Eigen::Index j) { return qd[j]; },
      [&](Eigen::Index j, double known, double unknown, double) {
        least[j] += known - std::abs(unknown);
        most[j] += known + std::abs(unknown);
      });
}

void FrictionState::moveAlong(const ConstStates& q) noexcept {
  if (!remembers()) return;
  for (Eigen::Index k = 0; k < q.count; ++k) advance([&](Eigen::Index j) { return q(j, k); });
}

void FrictionState::addAlong(const ConstStates& q, const ConstStates& qd,
                             const States& f) noexcept {
  if (!remembers()) return;
  for (Eigen::Index k = 0; k < q.count; ++k) {
    advance([&](Eigen::Index j) { return q(j, k); });
    add([&](Eigen::Index j) { return qd(j, k); },
        [&](Eigen::Index j, double known, double unknown, double step) {
          f(j, k) += known + unknown * step;
        });
  }
}

void FrictionState::addUnknown(Eigen::Ref<Eigen::VectorXd> half_width) const noexcept {
  for (std::size_t l = 0; l < memory_.size(); ++l) {
    const SmoothCoulomb& law = laws_->each[l];
    if (law.distance == 0) continue;
    const double width = (law.fm + law.fs) * memory_[l].unknown;
    forEachJoint(l, [&](Eigen::Index j, double c) { half_width[j] += std::abs(c) * width; });
  }
}

}  // namespace v2
}  // namespace chain_dynamics
