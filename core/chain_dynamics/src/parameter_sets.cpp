// SPDX-License-Identifier: Apache-2.0

#include "chain_dynamics/parameter_sets.hpp"

#include <cstddef>
#include <string>
#include <vector>

#include "chain_dynamics/error.hpp"

namespace chain_dynamics {
inline namespace v2 {
namespace {

void checkSet(const Chain& chain, const std::string& where,
              const std::vector<LinkParameters>& links) {
  if (links.size() != chain.joints().size()) {
    throw ModelError(where, "links", "one per joint (" + std::to_string(chain.jointCount()) + ")",
                     std::to_string(links.size()), "");
  }
  for (std::size_t i = 0; i < links.size(); ++i) {
    if (!links[i].toVector().allFinite()) {
      throw ModelError(where, "link moved by joint " + chain.joints()[i].name, "ten finite numbers",
                       "a NaN or an infinity", "");
    }
  }
}

}  // namespace

void checkParameterSets(const Chain& chain, const ParameterSets& sets) {
  const std::string where = "chain " + chain.name();
  if (!sets.rows.empty() && sets.rows.size() != chain.joints().size()) {
    throw ModelError(where, "parameter sets",
                     "none, or one per joint (" + std::to_string(chain.jointCount()) + ")",
                     std::to_string(sets.rows.size()), "");
  }
  for (std::size_t j = 0; j < sets.rows.size(); ++j) {
    checkSet(chain, where + ": parameter set of joint " + chain.joints()[j].name, sets.rows[j]);
  }
  if (!sets.gravity.empty()) checkSet(chain, where + ": parameter set of gravity", sets.gravity);
}

}  // namespace v2
}  // namespace chain_dynamics
