// SPDX-License-Identifier: Apache-2.0

/// @file
/// Files, differences and errors, for tests.

#pragma once

#include <yaml-cpp/yaml.h>

#include <Eigen/Core>
#include <cstddef>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <string>

#include "chain_dynamics/error.hpp"

namespace chain_dynamics {

inline Eigen::VectorXd vectorOf(const YAML::Node& node) {
  Eigen::VectorXd v(static_cast<Eigen::Index>(node.size()));
  for (Eigen::Index i = 0; i < v.size(); ++i) {
    v[i] = node[static_cast<std::size_t>(i)].as<double>();
  }
  return v;
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

// Two ways of rounding through the same few hundred operations on figures below 100.
constexpr double kRounding = 1e-12;

/// The greatest difference of two entries.
inline double difference(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
  return (a - b).cwiseAbs().maxCoeff();
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
