// SPDX-License-Identifier: Apache-2.0

#include "model_file_tree.hpp"

#include <algorithm>
#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "chain_dynamics/error.hpp"
#include "chain_dynamics/text.hpp"
#include "follower.hpp"

namespace chain_dynamics {
inline namespace v2 {
namespace {

using Eigen::Index;
using Joints = std::vector<std::size_t>;  // by their places in the file

/// The joints of a file, by name.
class Tree {
 public:
  explicit Tree(const std::vector<JointEntry>& entries)
      : entries_(entries), asked_(entries.size(), false), known_(entries.size()) {
    if (entries.size() > kMostMovingJoints) {
      throw ModelError(entries[kMostMovingJoints].where, "joints",
                       "at most " + std::to_string(kMostMovingJoints),
                       std::to_string(entries.size()), "");
    }
    for (std::size_t i = 0; i < entries.size(); ++i) {
      if (places_.emplace(entries[i].joint.name, i).second) continue;
      throw ModelError(entries[i].where, "name", "one that no other joint has", "it twice", "");
    }
    coordinate_.resize(entries.size(), -1);
    for (std::size_t i = 0; i < entries.size(); ++i) {
      if (entries[i].mimics.empty()) coordinate_[i] = coordinates_++;
    }
  }

  /// From the root to the joint that a tip names.
  Joints pathTo(const TipEntry& tip) const {
    Joints path{placeOf(tip.joint, tip.where, "joint")};
    refuseMotor(path.back(), tip.where, "joint");
    while (!entries_[path.back()].parent.empty()) {
      const JointEntry& entry = entries_[path.back()];
      path.push_back(placeOf(entry.parent, entry.where, "parent"));
      refuseMotor(path.back(), entry.where, "parent");
      if (path.size() <= entries_.size()) continue;
      throw ModelError(entry.where, "parent", "a joint that isn't below this one", entry.parent,
                       "begin at a joint on the root link, which has no parent");
    }
    std::reverse(path.begin(), path.end());
    return path;
  }

  /// What a joint follows: factors by coordinate, and where it stands if these are zero.
  struct Followed {
    std::map<Index, double> factors;
    double position = 0;
  };

  const Followed& followedBy(std::size_t i) {
    if (known_[i]) return *known_[i];
    const JointEntry& entry = entries_[i];
    if (asked_[i]) {
      throw ModelError(entry.where, "mimic", "a joint that doesn't follow this one",
                       entry.mimics.front().joint, "let one of them move by itself");
    }
    asked_[i] = true;
    Followed result;
    result.position = entry.offset;
    if (entry.mimics.empty()) result.factors[coordinate_[i]] = 1;
    for (const MimicEntry& mimic : entry.mimics) {
      const Followed& leader = followedBy(placeOf(mimic.joint, entry.where, "mimic.joint"));
      result.position += mimic.multiplier * leader.position;
      for (const auto& [coordinate, factor] : leader.factors) {
        result.factors[coordinate] += mimic.multiplier * factor;
      }
    }
    known_[i] = result;
    return *known_[i];
  }

 private:
  void refuseMotor(std::size_t i, const std::string& where, const char* key) const {
    if (!entries_[i].is_motor) return;
    throw ModelError(where, key, "a joint that moves a link", "the motor " + entries_[i].joint.name,
                     "");
  }

  std::size_t placeOf(const std::string& name, const std::string& where, const char* key) const {
    const auto found = places_.find(name);
    if (found != places_.end()) return found->second;
    std::vector<std::string> known;
    known.reserve(places_.size());
    for (const auto& [joint, place] : places_) known.push_back(joint);
    const std::string nearest = nearestName(name, known);
    throw ModelError(
        where, key, "a joint of the file", "'" + name + "'",
        nearest.empty() ? "known: " + joined(known) : "did you mean '" + nearest + "'?");
  }

  const std::vector<JointEntry>& entries_;
  std::map<std::string, std::size_t> places_;
  std::vector<Index> coordinate_;
  Index coordinates_ = 0;
  std::vector<bool> asked_;
  std::vector<std::optional<Followed>> known_;
};

}  // namespace

std::vector<TipEntry> readTips(const LocatedValue& value) {
  std::vector<TipEntry> tips;
  for (const LocatedValue& one : value.entries()) {
    LocatedMap map = one.map();
    const std::string name = map.required("name").text();
    const std::string joint = map.required("joint").text();
    tips.push_back({one.where(), name, joint, readPose(map)});
    map.rejectOthers();
  }
  if (tips.empty()) value.fail("at least one tip");
  return tips;
}

Mechanism treeOf(const std::string& name, const std::vector<JointEntry>& entries,
                 const std::vector<TipEntry>& tips, const Eigen::Vector3d& gravity,
                 const MakeChain& make_chain) {
  Tree tree(entries);
  std::vector<Joint> coordinates;
  std::vector<double> motor_inertia;
  for (const JointEntry& entry : coordinatesOf(entries)) {
    Joint& joint = coordinates.emplace_back(entry.joint);
    joint.placement = Transform<double>::identity();
    motor_inertia.push_back(entry.is_motor ? joint.rotor_inertia : 0);
    joint.rotor_inertia = motor_inertia.back();
  }
  std::vector<bool> seen;
  std::vector<Index> link_numbers;
  Index links = 0;
  for (const JointEntry& entry : entries) {
    seen.push_back(entry.is_motor);
    link_numbers.push_back(entry.is_motor ? -1 : links++);
  }
  std::vector<Branch> branches;
  std::vector<std::string> warnings;
  for (const TipEntry& tip : tips) {
    std::vector<JointEntry> path;
    std::vector<Follow> S;
    std::vector<double> s;
    std::vector<Index> link;
    for (const std::size_t i : tree.pathTo(tip)) {
      JointEntry& entry = path.emplace_back(entries[i]);
      if (seen[i]) {  // an earlier branch has its mass
        entry.own.clear();
        entry.joint.rotor_inertia = 0;
      }
      seen[i] = true;
      const Tree::Followed& followed = tree.followedBy(i);
      for (const auto& [coordinate, factor] : followed.factors) {
        if (factor == 0) continue;
        S.push_back({static_cast<Index>(link.size()), coordinate, factor});
        Joint& leader = coordinates[static_cast<std::size_t>(coordinate)];
        leader.rotor_inertia += factor * factor * entry.joint.rotor_inertia;
        addTurns(leader, entry.joint, factor);
      }
      s.push_back(followed.position);
      link.push_back(link_numbers[i]);
    }
    branches.push_back(
        {tip.name, make_chain(path, tip.X_U_tip), std::move(S), std::move(s), std::move(link)});
    for (const std::string& text : branches.back().chain.warnings()) warnings.push_back(text);
  }
  const auto lost = std::find(seen.begin(), seen.end(), false);
  if (lost != seen.end()) {
    throw ModelError(entries[static_cast<std::size_t>(lost - seen.begin())].where, "tips",
                     "one beyond this joint", "none", "add it to tips");
  }
  const std::vector<LinkParameters> none(coordinates.size(), LinkParameters::zero());
  return {Chain(name, std::move(coordinates), none, gravity).withWarnings(std::move(warnings)),
          std::move(branches),
          std::any_of(motor_inertia.begin(), motor_inertia.end(), [](double I) { return I != 0; })
              ? motor_inertia
              : std::vector<double>()};
}

}  // namespace v2
}  // namespace chain_dynamics
