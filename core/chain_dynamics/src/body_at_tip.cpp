// SPDX-License-Identifier: Apache-2.0

#include <Eigen/Core>
#include <cstddef>
#include <utility>
#include <vector>

#include "chain_dynamics/model.hpp"

namespace chain_dynamics {
inline namespace v2 {

Model withBodyAtTip(const Model& model, const LinkParameters& body, std::size_t branch) {
  Model result = model;
  Chain& chain = model.branches.empty() ? result.chain : result.branches.at(branch).chain;
  LinkParameters added = chain.tip() * body;
  added.inertia = (0.5 * (added.inertia + added.inertia.transpose())).eval();

  std::vector<LinkParameters> links = chain.links();
  links.back() += added;
  chain = Chain(chain.name(), chain.joints(), std::move(links), chain.gravity(), chain.tip())
              .withWarnings(chain.warnings());
  for (std::vector<LinkParameters>& row : result.row_parameters) row.back() += added;
  if (!result.gravity_parameters.empty()) result.gravity_parameters.back() += added;
  return result;
}

Model withGravity(const Model& model, const Eigen::Vector3d& gravity) {
  Model result = model;
  result.chain = result.chain.withGravity(gravity);
  for (Branch& branch : result.branches) branch.chain = branch.chain.withGravity(gravity);
  return result;
}

}  // namespace v2
}  // namespace chain_dynamics
