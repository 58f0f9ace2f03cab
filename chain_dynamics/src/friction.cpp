// SPDX-License-Identifier: Apache-2.0

#include "chain_dynamics/friction.hpp"

#include <cassert>
#include <sstream>

#include "chain_dynamics/error.hpp"

namespace chain_dynamics {
inline namespace v2 {
namespace {

bool isIn(FigureRange range, double value) {
  return std::isfinite(value) && (range != FigureRange::kNotNegative || value >= 0) &&
         (range != FigureRange::kPositive || value > 0);
}

const char* textOf(FigureRange range) {
  if (range == FigureRange::kNotNegative) return "a finite number >= 0";
  return range == FigureRange::kPositive ? "a finite number > 0" : "a finite number";
}

/// Whether the figure has a meaning: not where the one it is required with is zero.
template <class Law>
bool isUsed(const Law& law, const Figure<Law>& figure) {
  for (const Figure<Law>& other : Law::figures()) {
    if (figure.required_with != nullptr && std::string(other.name) == figure.required_with) {
      return law.*other.value != 0;
    }
  }
  return true;
}

template <class Law>
void checkFigures(const Law& law, const std::string& where) {
  for (const Figure<Law>& figure : Law::figures()) {
    const double value = law.*figure.value;
    if (!isUsed(law, figure) || isIn(figure.range, value)) continue;
    std::ostringstream got;
    got << value;
    throw ModelError(where, std::string(Law::kName) + ": " + figure.name, textOf(figure.range),
                     got.str(), "");
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
        for (const auto& figure : decltype(named)::figures()) {
          if (figure.is_torque) named.*figure.value *= factor;
        }
        return named;
      },
      law);
}

void checkFriction(const FrictionLaw& law, const std::string& where) {
  std::visit([&](const auto& named) { checkFigures(named, where); }, law);
}

void frictionVector(const std::vector<FrictionLaw>& laws,
                    const Eigen::Ref<const Eigen::VectorXd>& qd,
                    const Eigen::Ref<const Eigen::VectorXd>& g, Eigen::Ref<Eigen::VectorXd> f) {
  assert(static_cast<Eigen::Index>(laws.size()) == qd.size() && f.size() == qd.size());
  for (Eigen::Index j = 0; j < f.size(); ++j) {
    f[j] = friction(laws[static_cast<std::size_t>(j)], qd[j], loadAt(g, j));
  }
}

void frictionSlopes(const std::vector<FrictionLaw>& laws,
                    const Eigen::Ref<const Eigen::VectorXd>& qd,
                    const Eigen::Ref<const Eigen::VectorXd>& g, Eigen::Ref<Eigen::VectorXd> slope) {
  assert(static_cast<Eigen::Index>(laws.size()) == qd.size() && slope.size() == qd.size());
  for (Eigen::Index j = 0; j < slope.size(); ++j) {
    slope[j] = frictionSlope(laws[static_cast<std::size_t>(j)], qd[j], loadAt(g, j));
  }
}

}  // namespace v2
}  // namespace chain_dynamics
