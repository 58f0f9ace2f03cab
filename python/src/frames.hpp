// SPDX-License-Identifier: Apache-2.0
/// @file
/// Jacobians and poses of any link or joint of a robot description, not only of the chain's tip.
///
///     const Frames frames(urdf, {"base_link", {"shoulder", "elbow"}, {{"finger", 0.02}}});
///     frames.to("forearm", "jacobian").jacobians(q, J);
#pragma once

#include <Eigen/Core>
#include <chain_dynamics/chain.hpp>
#include <chain_dynamics/robot_description.hpp>
#include <chain_dynamics/spatial.hpp>
#include <chain_dynamics/states.hpp>
#include <cstddef>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

namespace inverse_dynamics_tools {

/// Whose frames: a chain of a description.
struct FramesOf {
  std::string root;                      ///< empty: that of the description
  std::vector<std::string> joints;       ///< the coordinates
  std::map<std::string, double> locked;  ///< positions of joints that are held; others: 0
};

/// Threads: safe.
class Frames {
 public:
  /// The chain from the root to a frame: joints of ours, and others, which are held.
  struct Path {
    std::unique_ptr<const chain_dynamics::Chain> chain;  // null: nothing moves
    chain_dynamics::Transform<double> fixed =
        chain_dynamics::Transform<double>::identity();  // then
    std::vector<Eigen::Index>
        numbers;              // of each joint, or the one that it follows, among ours; -1: held
    Eigen::VectorXd factors;  // of ours, in its position: 1 but where it follows one
    Eigen::VectorXd q;        // position beside that: of a joint that is held, or an offset

    /// `J(q)` of each state, 6 x n: the velocity of the frame's origin, linear first, in the axes
    /// of the root frame.
    void jacobians(const chain_dynamics::ConstStates& states,
                   const chain_dynamics::StridedMatrices& J) const;

    /// Pose of the frame in the root frame at each state: R 3 x 3, and p.
    void poses(const chain_dynamics::ConstStates& states, const chain_dynamics::StridedMatrices& R,
               const chain_dynamics::States& p) const;

    /// Sets the positions of joints of ours, of state k.
    void setPositions(const chain_dynamics::ConstStates& states, Eigen::Index k,
                      Eigen::VectorXd& of_path) const;
  };

  /// @param urdf  empty: there are no frames.
  Frames(std::string urdf, FramesOf of) : urdf_(std::move(urdf)), of_(std::move(of)) {}

  /// A joint's frame is that of its child link. method: of Python, for errors.
  ///
  /// @throws InvalidParameterValueException  no description, no such link or joint.
  const Path& to(const std::string& frame, const std::string& method) const;

 private:
  Path pathTo(const std::string& frame, const std::string& method) const;

  /// Adds a joint of the description to a path.
  void addTo(Path& path, const chain_dynamics::RobotDescription& robot, std::size_t joint) const;

  const std::string urdf_;
  const FramesOf of_;
  mutable std::mutex busy_;
  mutable std::map<std::string, Path> paths_;
};

}  // namespace inverse_dynamics_tools
