// SPDX-License-Identifier: Apache-2.0

#include "chain_dynamics/friction_state.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <variant>

#include "chain_dynamics/model.hpp"

namespace chain_dynamics {
inline namespace v2 {

FrictionState::FrictionState(const Model& model) {
  bool remembers = false;
  for (const FrictionLaw& law : model.friction) {
    const auto* const smooth = std::get_if<SmoothCoulomb>(&law);
    const bool lags = smooth != nullptr && smooth->distance > 0 && smooth->fm + smooth->fs != 0;
    laws_.push_back({lags ? *smooth : SmoothCoulomb(), {}});
    remembers = remembers || lags;
  }
  if (!remembers) {
    laws_.clear();
    return;
  }
  coupling_ = model.coupling;
  for (const Joint& joint : model.chain.joints()) types_.push_back(joint.type);
  last_.resize(types_.size());
  reset();
}

void FrictionState::reset() noexcept {
  for (Remembered& of : laws_) of.memory = {};
  std::fill(last_.begin(), last_.end(), std::numeric_limits<double>::quiet_NaN());
}

double FrictionState::coefficient(std::size_t law, Eigen::Index joint) const noexcept {
  const auto row = static_cast<Eigen::Index>(law);
  return coupling_.size() > 0 ? coupling_(row, joint) : (row == joint ? 1.0 : 0.0);
}

template <class At>
void FrictionState::advance(const At& q) noexcept {
  const auto n = static_cast<Eigen::Index>(last_.size());
  for (std::size_t l = 0; l < laws_.size(); ++l) {
    if (laws_[l].law.distance == 0) continue;
    double by = 0;
    for (Eigen::Index j = 0; j < n; ++j) {
      const auto joint = static_cast<std::size_t>(j);
      const double c = coefficient(l, j), from = last_[joint];
      if (c != 0) by += c * (unwrapped(types_[joint], q(j), from) - from);
    }
    if (std::isfinite(by)) laws_[l].memory.move(by, laws_[l].law.distance);
  }
  for (Eigen::Index j = 0; j < n; ++j) {
    if (std::isfinite(q(j))) last_[static_cast<std::size_t>(j)] = q(j);
  }
}

template <class At, class Add>
void FrictionState::add(const At& qd, const Add& add) const noexcept {
  const auto n = static_cast<Eigen::Index>(last_.size());
  for (std::size_t l = 0; l < laws_.size(); ++l) {
    const auto& [law, memory] = laws_[l];
    if (law.distance == 0) continue;
    double v = 0;
    for (Eigen::Index j = 0; j < n; ++j) {
      const double c = coefficient(l, j);
      if (c != 0) v += c * qd(j);
    }
    const double step = std::tanh((v + law.shift) / law.width);
    const double height =
        law.fm + (law.fs == 0 ? 0 : law.fs * std::exp(-v * v / (law.vs * law.vs)));
    const double f = height * (memory.z + (memory.unknown - 1) * step);
    for (Eigen::Index j = 0; j < n; ++j) {
      const double c = coefficient(l, j);
      if (c != 0) add(j, c * f);
    }
  }
}

void FrictionState::move(const Eigen::Ref<const Eigen::VectorXd>& q) noexcept {
  if (remembers()) advance([&](Eigen::Index j) { return q[j]; });
}

void FrictionState::addTo(const Eigen::Ref<const Eigen::VectorXd>& qd,
                          Eigen::Ref<Eigen::VectorXd> f) const noexcept {
  add([&](Eigen::Index j) { return qd[j]; }, [&](Eigen::Index j, double by) { f[j] += by; });
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
        [&](Eigen::Index j, double by) { f(j, k) += by; });
  }
}

void FrictionState::addUnknown(Eigen::Ref<Eigen::VectorXd> half_width) const noexcept {
  for (std::size_t l = 0; l < laws_.size(); ++l) {
    const auto& [law, memory] = laws_[l];
    if (law.distance == 0) continue;
    const double width = (law.fm + law.fs) * memory.unknown;
    for (Eigen::Index j = 0; j < half_width.size(); ++j) {
      half_width[j] += std::abs(coefficient(l, j)) * width;
    }
  }
}

}  // namespace v2
}  // namespace chain_dynamics
