// SPDX-License-Identifier: Apache-2.0

#include "chain_dynamics/friction.hpp"

#include <cassert>

namespace chain_dynamics {
inline namespace v2 {

void frictionVector(const std::vector<FrictionLaw>& laws,
                    const Eigen::Ref<const Eigen::VectorXd>& qd, Eigen::Ref<Eigen::VectorXd> f) {
  assert(static_cast<Eigen::Index>(laws.size()) == qd.size() && f.size() == qd.size());
  for (Eigen::Index j = 0; j < f.size(); ++j) {
    f[j] = friction(laws[static_cast<std::size_t>(j)], qd[j]);
  }
}

void frictionSlopes(const std::vector<FrictionLaw>& laws,
                    const Eigen::Ref<const Eigen::VectorXd>& qd,
                    Eigen::Ref<Eigen::VectorXd> slope) {
  assert(static_cast<Eigen::Index>(laws.size()) == qd.size() && slope.size() == qd.size());
  for (Eigen::Index j = 0; j < slope.size(); ++j) {
    slope[j] = frictionSlope(laws[static_cast<std::size_t>(j)], qd[j]);
  }
}

}  // namespace v2
}  // namespace chain_dynamics
