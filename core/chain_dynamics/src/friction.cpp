// SPDX-License-Identifier: Apache-2.0

#include "chain_dynamics/friction.hpp"

#include <cassert>
#include <cmath>
#include <cstddef>
#include <string>
#include <variant>
#include <vector>

#include "chain_dynamics/error.hpp"

namespace chain_dynamics {
inline namespace v2 {
namespace {

bool isIn(CoefficientRange range, double value) {
  return std::isfinite(value) && (range != CoefficientRange::kNotNegative || value >= 0) &&
         (range != CoefficientRange::kPositive || value > 0);
}

const char* textOf(CoefficientRange range) {
  if (range == CoefficientRange::kNotNegative) return "a finite number >= 0";
  return range == CoefficientRange::kPositive ? "a finite number > 0" : "a finite number";
}

/// Whether the coefficient has a meaning: not where the one it is required with is zero.
template <class Law>
bool isUsed(const Law& law, const Coefficient<Law>& coefficient) {
  for (const Coefficient<Law>& other : Law::coefficients()) {
    if (coefficient.required_with != nullptr &&
        std::string(other.name) == coefficient.required_with) {
      return law.*other.value != 0;
    }
  }
  return true;
}

template <class Law>
void checkCoefficients(const Law& law, const std::string& where) {
  for (const Coefficient<Law>& coefficient : Law::coefficients()) {
    const double value = law.*coefficient.value;
    if (!isUsed(law, coefficient) || isIn(coefficient.range, value)) continue;
    throw ModelError(where, std::string(Law::kName) + ": " + coefficient.name,
                     textOf(coefficient.range), numberText(value), "");
  }
}

/// Of laws that don't depend on load, a number.
double loadAt(const Eigen::Ref<const Eigen::VectorXd>& g, Eigen::Index j) {
  return g.size() == 0 ? 0.0 : g[j];
}

}  // namespace

FrictionLaw scaled(const FrictionLaw& law, double factor) {
  return std::visit(
      [factor](auto named) -> FrictionLaw {
        for (const auto& coefficient : decltype(named)::coefficients()) {
          if (coefficient.is_torque) named.*coefficient.value *= factor;
        }
        return named;
      },
      law);
}

void checkFriction(const FrictionLaw& law, const std::string& where) {
  std::visit([&](const auto& named) { checkCoefficients(named, where); }, law);
}

void frictionVector(const std::vector<FrictionLaw>& laws,
                    const Eigen::Ref<const Eigen::VectorXd>& qd,
                    const Eigen::Ref<const Eigen::VectorXd>& g, Eigen::Ref<Eigen::VectorXd> f) {
  assert(static_cast<Eigen::Index>(laws.size()) == qd.size() && f.size() == qd.size());
  for (Eigen::Index j = 0; j < f.size(); ++j) {
    f[j] = friction(laws[static_cast<std::size_t>(j)], qd[j], loadAt(g, j));
  }
}

}  // namespace v2
}  // namespace chain_dynamics
