// SPDX-License-Identifier: Apache-2.0

#include "urdf_paths.hpp"

#include <algorithm>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "chain_dynamics/error.hpp"
#include "chain_dynamics/robot_description.hpp"
#include "chain_dynamics/text.hpp"

namespace chain_dynamics {
inline namespace v2 {
namespace paths {

std::string where(const RobotDescription& robot) { return "URDF: robot " + robot.name; }

std::string where(const RobotDescription::Joint& joint) { return "URDF: joint " + joint.name; }

std::size_t linkNamed(const RobotDescription& robot, const std::string& name,
                      const std::string& role) {
  const std::size_t link = robot.linkIndex(name);
  if (link != kNone) return link;
  constexpr std::size_t kShown = 8;
  std::vector<std::pair<std::size_t, std::string>> known;
  known.reserve(robot.links.size());
  for (const RobotDescription::Link& other : robot.links) {
    known.emplace_back(editDistance(name, other.name), other.name);
  }
  std::sort(known.begin(), known.end());

  std::vector<std::string> nearest;
  for (std::size_t i = 0; i < std::min(kShown, known.size()); ++i) {
    nearest.push_back(known[i].second);
  }
  throw ModelError(where(robot), role, "a link of the robot", "'" + name + "'",
                   (known.size() > kShown ? "nearest names: " : "links: ") + joined(nearest));
}

Joints jointsAbove(const RobotDescription& robot, std::size_t link) {
  Joints above;
  for (; robot.links[link].parent_joint != kNone; link = robot.joints[above.back()].parent) {
    above.push_back(robot.links[link].parent_joint);
  }
  return above;
}

Path pathBetween(const RobotDescription& robot, std::size_t root, std::size_t tip) {
  Joints up = jointsAbove(robot, root);
  Joints down = jointsAbove(robot, tip);
  while (!up.empty() && !down.empty() && up.back() == down.back()) {
    up.pop_back();
    down.pop_back();
  }
  Path path;
  for (const std::size_t j : up) path.push_back({j, true});
  for (auto j = down.rbegin(); j != down.rend(); ++j) path.push_back({*j, false});
  return path;
}

std::size_t rootOf(const RobotDescription& robot, const UrdfOptions& options) {
  return options.root.empty() ? robot.root : linkNamed(robot, options.root, "root");
}

RobotDescription::Mimic leaderOf(const RobotDescription& robot, std::size_t joint) {
  RobotDescription::Mimic leader{joint, 1, 0};
  for (std::size_t steps = 0; robot.joints[leader.joint].mimic; ++steps) {
    const RobotDescription::Mimic& next = *robot.joints[leader.joint].mimic;
    if (steps == robot.joints.size()) {
      throw ModelError(where(robot.joints[joint]), "<mimic>", "a joint that follows another one",
                       "one that follows itself through joint " + robot.joints[next.joint].name,
                       "take a <mimic> out of the loop");
    }
    leader.offset += leader.multiplier * next.offset;
    leader.multiplier *= next.multiplier;
    leader.joint = next.joint;
  }
  return leader;
}

namespace {

/// A link with what is between it and the root.
struct Reach {
  std::size_t link = kNone;
  std::size_t movable = 0;           // joints
  std::size_t joints = 0;            // fixed ones, too
  std::size_t last_movable = kNone;  // joint
};

/// The links below root that have no children.
std::vector<Reach> leavesBelow(const RobotDescription& robot, std::size_t root) {
  std::vector<Reach> reach(robot.links.size());
  std::vector<Reach> leaves;
  for (const std::size_t link : robot.linksBelow(root)) {
    reach[link].link = link;
    for (const std::size_t j : robot.links[link].child_joints) {
      const bool movable = isMovable(robot.joints[j]);
      reach[robot.joints[j].child] = {kNone, reach[link].movable + (movable ? 1 : 0),
                                      reach[link].joints + 1,
                                      movable ? j : reach[link].last_movable};
    }
    if (robot.links[link].child_joints.empty()) leaves.push_back(reach[link]);
  }
  return leaves;
}

/// Which tips to name where leaves, the farthest one first, are moved by different joints.
std::string tipsToName(const RobotDescription& robot, std::size_t root,
                       const std::vector<Reach>& leaves) {
  // the joints above all of them
  Joints shared = jointsAbove(robot, leaves.front().link);
  for (const Reach& leaf : leaves) {
    const Joints above = jointsAbove(robot, leaf.link);
    const auto parting =
        std::mismatch(shared.rbegin(), shared.rend(), above.rbegin(), above.rend()).first;
    shared.erase(shared.begin(), parting.base());
  }
  const auto movable = [&robot](const Joints& joints) {
    return static_cast<std::size_t>(std::count_if(
        joints.begin(), joints.end(), [&](std::size_t j) { return isMovable(robot.joints[j]); }));
  };
  // an arm with a gripper, not a body with arms
  const std::size_t arm = movable(shared) - movable(jointsAbove(robot, root));
  if (2 * arm < leaves.front().movable) return "name one of them as tip, or several for a tree";
  return "name '" + robot.links[robot.joints[shared.front()].child].name +
         "' as tip, where they part, or one of them";
}

/// What "*" stands for: see mechanismFromRobot().
std::vector<std::size_t> movedLeaves(const RobotDescription& robot, const UrdfOptions& options,
                                     std::size_t root) {
  struct Leaf {
    std::size_t link, last;  // last joint that moves it
    Joints above;            // that joint is among them
  };
  std::vector<Leaf> leaves;
  std::vector<bool> leads_on(robot.joints.size(), false);  // to a joint beyond it
  for (const Reach& reach : leavesBelow(robot, root)) {
    Joints above = jointsAbove(robot, reach.link);
    above.resize(reach.joints);  // below root
    const auto moves_itself = [&](std::size_t j) {
      return isMovable(robot.joints[j]) &&
             !(options.locked_position && options.locked_position(robot.joints[j].name));
    };
    const auto moves = [&](std::size_t j) {
      return moves_itself(j) && moves_itself(leaderOf(robot, j).joint);
    };
    const auto last = std::find_if(above.begin(), above.end(), moves);
    if (last == above.end()) continue;
    std::for_each(last + 1, above.end(), [&](std::size_t j) { leads_on[j] = true; });
    const std::size_t joint = *last;
    leaves.push_back({reach.link, joint, std::move(above)});
  }
  std::vector<std::size_t> chosen;
  for (const Leaf& leaf : leaves) {
    const bool farthest = std::none_of(leaves.begin(), leaves.end(), [&](const Leaf& other) {
      return other.last == leaf.last &&
             (other.above.size() > leaf.above.size() ||
              (other.above.size() == leaf.above.size() && other.link < leaf.link));
    });
    if (farthest && !leads_on[leaf.last]) chosen.push_back(leaf.link);
  }
  std::sort(chosen.begin(), chosen.end());
  if (chosen.empty()) {
    throw ModelError(where(robot), "tip", "a leaf that a joint moves",
                     "none below '" + robot.links[root].name + "'", "choose another root");
  }
  return chosen;
}

}  // namespace

std::size_t leafBelow(const RobotDescription& robot, std::size_t root) {
  const std::vector<Reach> leaves = leavesBelow(robot, root);
  const auto farther = [](const Reach& a, const Reach& b) {
    return std::make_pair(a.movable, a.joints) < std::make_pair(b.movable, b.joints);
  };
  const Reach& tip = *std::max_element(leaves.begin(), leaves.end(), farther);

  // leaves moved by joints that don't lead to this tip
  std::vector<bool> on_path(robot.joints.size(), false);
  for (const std::size_t j : jointsAbove(robot, tip.link)) on_path[j] = true;
  const auto described = [&robot](const Reach& leaf) {
    return robot.links[leaf.link].name + " (moved by " + robot.joints[leaf.last_movable].name + ")";
  };
  std::vector<Reach> rivals{tip};
  std::string others;
  for (const Reach& leaf : leaves) {
    if (leaf.last_movable == kNone || on_path[leaf.last_movable]) continue;
    rivals.push_back(leaf);
    others += ", " + described(leaf);
  }
  if (!others.empty()) {
    throw ModelError(where(robot), "tip", "one leaf below '" + robot.links[root].name + "'",
                     described(tip) + others, tipsToName(robot, root, rivals));
  }
  return tip.link;
}

std::vector<std::size_t> tipLinks(const RobotDescription& robot, const UrdfOptions& options,
                                  std::size_t root, const std::vector<std::string>& tips) {
  if (tips.empty()) return {leafBelow(robot, root)};
  if (tips.size() == 1 && tips[0] == "*") return movedLeaves(robot, options, root);
  std::vector<std::size_t> links;
  for (const std::string& tip : tips) {
    const std::size_t link = linkNamed(robot, tip, "tip");
    if (std::find(links.begin(), links.end(), link) != links.end()) {
      throw ModelError(where(robot), "tip", "each link once", "'" + tip + "' twice", "");
    }
    links.push_back(link);
  }
  return links;
}

}  // namespace paths
}  // namespace v2
}  // namespace chain_dynamics
