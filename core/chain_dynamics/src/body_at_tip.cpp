// SPDX-License-Identifier: Apache-2.0

#include <utility>
#include <vector>

#include "chain_dynamics/model.hpp"

namespace chain_dynamics {
inline namespace v2 {

Model withBodyAtTip(const Model& model, const LinkParameters& body) {
  LinkParameters added = model.chain.tip() * body;
  added.inertia = (0.5 * (added.inertia + added.inertia.transpose())).eval();

  Model result = model;
  std::vector<LinkParameters> links = model.chain.links();
  links.back() += added;
  result.chain = Chain(model.chain.name(), model.chain.joints(), std::move(links),
                       model.chain.gravity(), model.chain.tip())
                     .withWarnings(model.chain.warnings());
  for (std::vector<LinkParameters>& row : result.row_parameters) row.back() += added;
  if (!result.gravity_parameters.empty()) result.gravity_parameters.back() += added;
  return result;
}

}  // namespace v2
}  // namespace chain_dynamics
