// SPDX-License-Identifier: Apache-2.0

#include "chain_dynamics/mechanism.hpp"

#include <Eigen/QR>
#include <cmath>
#include <cstddef>
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

}  // namespace

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
  checkRank(mechanism);
}

}  // namespace v2
}  // namespace chain_dynamics
