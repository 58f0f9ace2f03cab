// SPDX-License-Identifier: Apache-2.0

/// @file
/// Reference values of other people's code, for tests: inverse_dynamics_robots/reference/*.json.
///
///     for (const ReferenceState& state : referenceStates("ur10_urdf.json")) { ... }

#pragma once

#include <yaml-cpp/yaml.h>

#include <Eigen/Core>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

namespace chain_dynamics {

/// One state with what another program computed there; what it didn't compute is empty.
struct ReferenceState {
  std::string label;  // file and number, to find it again
  Eigen::VectorXd q, qd, qdd;
  Eigen::MatrixXd H;
  Eigen::VectorXd coriolis, gravity, friction, torques;
  Eigen::VectorXd forward_torques, forward_qdd;
};

inline Eigen::VectorXd vectorOf(const YAML::Node& node) {
  Eigen::VectorXd v(static_cast<Eigen::Index>(node.size()));
  for (Eigen::Index i = 0; i < v.size(); ++i) {
    v[i] = node[static_cast<std::size_t>(i)].as<double>();
  }
  return v;
}

/// JSON is YAML.
inline std::vector<ReferenceState> referenceStates(const std::string& file) {
  const YAML::Node data = YAML::LoadFile(CHAIN_DYNAMICS_ROBOTS_DIR "/reference/" + file);
  std::vector<ReferenceState> states;
  for (const YAML::Node& node : data["states"]) {
    ReferenceState state;
    state.label = file + " state " + std::to_string(states.size());
    state.q = vectorOf(node["q"]);
    state.qd = vectorOf(node["qd"]);
    state.qdd = vectorOf(node["qdd"]);
    state.H.resize(state.q.size(), state.q.size());
    for (Eigen::Index row = 0; row < state.q.size(); ++row) {
      state.H.row(row) = vectorOf(node["inertia"][static_cast<std::size_t>(row)]);
    }
    state.coriolis = vectorOf(node["coriolis"]);
    state.gravity = vectorOf(node["gravity"]);
    state.torques = vectorOf(node["torques"]);
    if (node["friction"]) {
      state.friction = vectorOf(node["friction"]);
    }
    if (node["forward_dynamics"]) {
      state.forward_torques = vectorOf(node["forward_dynamics"]["torques"]);
      state.forward_qdd = vectorOf(node["forward_dynamics"]["qdd"]);
    }
    states.push_back(state);
  }
  return states;
}

/// The folder of data that isn't part of the project; empty if the environment names none.
inline std::string dataFolder() {
  const char* folder = std::getenv("IDS_DATA_DIR");
  return folder == nullptr ? "" : folder;
}

inline std::string textOf(const std::string& path) {
  std::ifstream file(path);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

/// The text of the ModelError that a call throws; "no error" if it doesn't.
template <typename Call>
std::string errorOf(Call call) {
  try {
    call();
  } catch (const ModelError& error) {
    return error.what();
  }
  return "no error";
}

}  // namespace chain_dynamics
