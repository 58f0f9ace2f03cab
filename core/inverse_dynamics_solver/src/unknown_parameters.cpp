// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstddef>
#include <string>
#include <vector>

#include "chain_dynamics/text.hpp"
#include "inverse_dynamics_solver/configuration.hpp"
#include "inverse_dynamics_solver/strict_initialization.hpp"

namespace inverse_dynamics_solver {
inline namespace v2 {
namespace {

using chain_dynamics::joined;
using chain_dynamics::nearestName;
using Names = std::vector<std::string>;

/// Of a parameter `<prefix><joint>`, the prefix; of any other, nothing.
std::string prefixOf(const std::string& name) {
  for (const char* const prefix : {"locked_joints.", "rotor_inertia.", "springs."}) {
    if (name.rfind(prefix, 0) == 0) return prefix;
  }
  return "";
}

/// Names below the namespace, without it.
template <class Container>
Names below(const Configuration& configuration, const Container& full_names) {
  const std::string prefix = configuration.fullName("");
  Names result;
  for (const std::string& name : full_names) {
    if (name.rfind(prefix, 0) == 0) result.push_back(name.substr(prefix.size()));
  }
  return result;
}

/// The known name that is most like another; of joints, their names alone are compared.
std::string nearest(const std::string& name, const Names& known) {
  const std::string prefix = prefixOf(name);
  Names others;
  for (const std::string& other : known) {
    if (prefixOf(other) == prefix) others.push_back(other.substr(prefix.size()));
  }
  const std::string found = nearestName(name.substr(prefix.size()), others);
  return found.empty() ? "" : prefix + found;
}

/// @param meant  a known name, or "".
std::string remedy(const std::string& meant) {
  return meant.empty() ? "correct or remove it" : "did you mean '" + meant + "'?";
}

struct Unknown {
  Names known, unknown;  // full names
  Names remedies;        // one per unknown name
};

Unknown unknownNames(const Configuration& configuration) {
  const Names known = below(configuration, *configuration.asked);
  const bool own_only =
      configuration.param_namespace.empty() && configuration.parameters.isShared();
  Unknown result;
  for (const std::string& name : known) {
    // One entry for all joints, which are next to each other in a sorted list.
    const std::string prefix = prefixOf(name);
    const std::string full_name = configuration.fullName(prefix.empty() ? name : prefix + "JOINT");
    if (result.known.empty() || result.known.back() != full_name) result.known.push_back(full_name);
  }
  for (const std::string& name : below(configuration, configuration.parameters.names())) {
    const std::string full_name = configuration.fullName(name);
    const std::string meant = nearest(name, known);
    if (configuration.asked->count(full_name) > 0 || (own_only && meant.empty())) continue;
    result.unknown.push_back(full_name);
    result.remedies.push_back(remedy(meant.empty() ? "" : configuration.fullName(meant)));
  }
  return result;
}

}  // namespace

Names Configuration::unknownParameters() const {
  const Unknown names = unknownNames(*this);
  Names sentences;
  for (std::size_t i = 0; i < names.unknown.size(); ++i) {
    sentences.push_back("parameter '" + names.unknown[i] +
                        "' isn't used, the solver doesn't know it; " + names.remedies[i]);
  }
  return sentences;
}

void Configuration::rejectOthers() const {
  if (!parameters.isStrict()) return;
  const Unknown names = unknownNames(*this);
  if (names.unknown.empty()) return;
  throw InvalidParameterValueException("parameter '" + names.unknown.front() + "'",
                                       "the solver doesn't know it",
                                       "one of " + joined(names.known), "", names.remedies.front());
}

void rejectUndeclared(const Names& given, const Names& declared) {
  for (const std::string& name : given) {
    if (name.rfind("qos_overrides.", 0) == 0) continue;
    if (std::find(declared.begin(), declared.end(), name) != declared.end()) continue;
    throw InvalidParameterValueException("parameter '" + name + "'", "the node doesn't declare it",
                                         "", "", remedy(nearestName(name, declared)));
  }
}

}  // namespace v2
}  // namespace inverse_dynamics_solver
