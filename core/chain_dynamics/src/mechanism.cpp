// SPDX-License-Identifier: Apache-2.0

#include "chain_dynamics/mechanism.hpp"

#include <Eigen/QR>
#include <cmath>
#include <cstddef>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "chain_dynamics/error.hpp"

namespace chain_dynamics {
inline namespace v2 {
namespace {

using Eigen::Index;

std::string where(const Mechanism& mechanism) {
  return "mechanism " + mechanism.coordinates.name();
}

bool isBelow(Index i, std::size_t size) { return i >= 0 && static_cast<std::size_t>(i) < size; }

void checkBranch(const Mechanism& mechanism, const Branch& branch) {
  const std::size_t m = branch.chain.joints().size();
  const std::string place = where(mechanism) + ": branch to " + branch.tip;
  if (m > kMostBranchJoints) {
    throw ModelError(place, "joints", "at most " + std::to_string(kMostBranchJoints),
                     std::to_string(m), "hold joints at a position");
  }
  if (branch.s.size() != m || branch.link.size() != m) {
    throw ModelError(
        place, "positions s and links", "one per joint of the branch (" + std::to_string(m) + ")",
        std::to_string(branch.s.size()) + " and " + std::to_string(branch.link.size()), "");
  }
  std::set<std::pair<Index, Index>> entries;
  for (const Follow& entry : branch.S) {
    if (isBelow(entry.joint, m) &&
        isBelow(entry.coordinate, mechanism.coordinates.joints().size()) &&
        std::isfinite(entry.factor) && entries.insert({entry.joint, entry.coordinate}).second) {
      continue;
    }
    throw ModelError(place, "S", "finite entries, each of one joint and one coordinate",
                     "joint " + std::to_string(entry.joint) + ", coordinate " +
                         std::to_string(entry.coordinate) + ", factor " +
                         std::to_string(entry.factor),
                     "state each entry once");
  }
  for (const double position : branch.s) {
    if (std::isfinite(position)) continue;
    throw ModelError(place, "positions s", "finite numbers", std::to_string(position), "");
  }
}

/// S of all branches, one after the other.
Eigen::MatrixXd allOfS(const Mechanism& mechanism) {
  Index rows = 0;
  for (const Branch& branch : mechanism.branches) rows += branch.chain.jointCount();
  Eigen::MatrixXd S = Eigen::MatrixXd::Zero(rows, mechanism.coordinates.jointCount());
  Index first = 0;
  for (const Branch& branch : mechanism.branches) {
    for (const Follow& entry : branch.S) S(first + entry.joint, entry.coordinate) = entry.factor;
    first += branch.chain.jointCount();
  }
  return S;
}

void checkRank(const Mechanism& mechanism) {
  const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(allOfS(mechanism));
  const Index n = mechanism.coordinates.jointCount();
  if (qr.rank() == n) return;
  // pivoting leaves to the end a column that the others make up
  const Index least = qr.colsPermutation().indices()[n - 1];
  throw ModelError(
      where(mechanism),
      "coordinate " + mechanism.coordinates.jointNames()[static_cast<std::size_t>(least)],
      "one that moves joints as no others do (S of full column rank)",
      "one without a motion of its own", "leave it out");
}

void requireCount(const Mechanism& mechanism, const char* what, std::size_t expected,
                  std::size_t got) {
  if (expected == got) return;
  throw ModelError(where(mechanism), what, std::to_string(expected), std::to_string(got), "");
}

void checkMotorInertia(const Mechanism& mechanism) {
  const std::vector<double>& all = mechanism.motor_inertia;
  if (!all.empty())
    requireCount(mechanism, "motor_inertia", mechanism.coordinates.joints().size(), all.size());
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (std::isfinite(all[i]) && all[i] >= 0) continue;
    throw ModelError(where(mechanism),
                     "motor_inertia of coordinate " + mechanism.coordinates.joints()[i].name,
                     "a finite number >= 0", std::to_string(all[i]), "");
  }
}

/// Calls `use(branch, joint, link)` of each link in the first branch that moves it.
template <class Branches, class Use>
void forEachOwn(Branches& branches, const Use& use) {
  std::set<Index> seen;
  for (auto& branch : branches) {
    for (std::size_t i = 0; i < branch.link.size(); ++i) {
      if (seen.insert(branch.link[i]).second)
        use(branch, i, static_cast<std::size_t>(branch.link[i]));
    }
  }
}

/// Of a joint that follows one coordinate alone: that entry of S, otherwise null.
const Follow* onlyEntry(const Branch& branch, std::size_t joint) {
  const Follow* only = nullptr;
  for (const Follow& entry : branch.S) {
    if (entry.joint != static_cast<Index>(joint) || entry.factor == 0) continue;
    if (only != nullptr) return nullptr;
    only = &entry;
  }
  return only;
}

Chain withParts(const Chain& chain, const std::vector<LinkParameters>& links,
                const std::vector<double>& rotor_inertia) {
  std::vector<Joint> joints = chain.joints();
  for (std::size_t i = 0; i < joints.size(); ++i) joints[i].rotor_inertia = rotor_inertia[i];
  return {chain.name(), std::move(joints), links, chain.gravity(), chain.tip()};
}

}  // namespace

std::vector<LinkParameters> linksOf(const Mechanism& mechanism) {
  if (mechanism.branches.empty()) return mechanism.coordinates.links();
  std::vector<LinkParameters> links(static_cast<std::size_t>(linkCount(mechanism.branches)),
                                    LinkParameters::zero());
  for (const Branch& branch :
       mechanism.branches) {  // what is fixed to a link may be in a later one
    for (std::size_t i = 0; i < branch.link.size(); ++i) {
      links[static_cast<std::size_t>(branch.link[i])] += branch.chain.links()[i];
    }
  }
  return links;
}

Mechanism withLinks(const Mechanism& mechanism, const std::vector<LinkParameters>& links,
                    const Eigen::Ref<const Eigen::VectorXd>& rotor_inertia) {
  const std::vector<LinkParameters> before = linksOf(mechanism);
  const std::vector<double> rotors(rotor_inertia.data(),
                                   rotor_inertia.data() + rotor_inertia.size());
  const Chain& coordinates = mechanism.coordinates;
  requireCount(mechanism, "links", before.size(), links.size());
  requireCount(mechanism, "rotors", coordinates.joints().size(), rotors.size());
  if (mechanism.branches.empty())
    return {withParts(coordinates, links, rotors), {}, {}, mechanism.tip};

  Mechanism result{withParts(coordinates, coordinates.links(), rotors), mechanism.branches};
  std::vector<bool> placed(rotors.size(), false);
  std::map<const Branch*, std::pair<std::vector<LinkParameters>, std::vector<double>>> parts;
  for (const Branch& branch : result.branches) {
    const std::size_t m = branch.chain.joints().size();
    parts[&branch] = {std::vector<LinkParameters>(m, LinkParameters::zero()),
                      std::vector<double>(m, 0.0)};
  }
  forEachOwn(result.branches, [&](const Branch& branch, std::size_t joint, std::size_t link) {
    auto& [own_links, own_rotors] = parts[&branch];
    own_links[joint] = links[link];
    const Follow* const entry = onlyEntry(branch, joint);
    if (entry == nullptr) return;
    const auto c = static_cast<std::size_t>(entry->coordinate);
    if (placed[c]) return;
    placed[c] = true;
    own_rotors[joint] = rotors[c] / (entry->factor * entry->factor);
  });
  for (std::size_t c = 0; c < rotors.size(); ++c) {
    if (placed[c] || rotors[c] == 0) continue;
    result.motor_inertia.resize(rotors.size(), 0.0);
    result.motor_inertia[c] = rotors[c];
  }
  for (Branch& branch : result.branches) {
    branch.chain = withParts(branch.chain, parts[&branch].first, parts[&branch].second);
  }
  return result;
}

Index linkCount(const std::vector<Branch>& branches) {
  std::set<Index> links;
  for (const Branch& branch : branches) links.insert(branch.link.begin(), branch.link.end());
  return static_cast<Index>(links.size());
}

void checkMechanism(const Mechanism& mechanism) {
  if (mechanism.branches.empty()) return;
  if (mechanism.coordinates.joints().size() > kMostCoordinates) {
    throw ModelError(where(mechanism), "coordinates", "at most " + std::to_string(kMostCoordinates),
                     std::to_string(mechanism.coordinates.jointCount()), "");
  }
  for (const Branch& branch : mechanism.branches) checkBranch(mechanism, branch);
  const auto links = static_cast<std::size_t>(linkCount(mechanism.branches));
  for (const Branch& branch : mechanism.branches) {
    for (const Index link : branch.link) {
      if (isBelow(link, links) && links <= kMostMovingJoints) continue;
      throw ModelError(where(mechanism) + ": branch to " + branch.tip, "links",
                       "numbers without a gap, of at most " + std::to_string(kMostMovingJoints),
                       std::to_string(link), "");
    }
  }
  checkMotorInertia(mechanism);
  checkRank(mechanism);
}

}  // namespace v2
}  // namespace chain_dynamics
