// SPDX-License-Identifier: Apache-2.0

#include "reading.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include "chain_dynamics/fast_model.hpp"

namespace chain_dynamics::fuzz {
namespace {

constexpr double kModerate = 1e6;

bool moderate(const std::vector<LinkParameters>& links) {
  return std::all_of(links.begin(), links.end(), [](const LinkParameters& link) {
    return link.toVector().cwiseAbs().maxCoeff() < kModerate;
  });
}

}  // namespace

State someState(Eigen::Index n) {
  return {Eigen::VectorXd::LinSpaced(n, 0.3, 2.9), Eigen::VectorXd::LinSpaced(n, -1, 2),
          Eigen::VectorXd::LinSpaced(n, 5, -3)};
}

bool isModerate(const Model& model) {
  const auto small = [](const Joint& joint) {
    return joint.placement.p.cwiseAbs().maxCoeff() < kModerate && joint.rotor_inertia < kModerate;
  };
  const auto& joints = model.chain.joints();
  return model.chain.jointCount() <= FastModel::kMaxJoints &&
         std::all_of(joints.begin(), joints.end(), small) && moderate(model.chain.links()) &&
         moderate(model.gravity_parameters) &&
         std::all_of(model.row_parameters.begin(), model.row_parameters.end(),
                     [](const auto& links) { return moderate(links); });
}

void requireText(const ModelError& error, const std::string& where) {
  const std::string text = error.what();
  if (!text.empty() && text.find(where) != std::string::npos) return;
  std::fprintf(stderr, "error that doesn't name %s: %s\n", where.c_str(), text.c_str());
  std::abort();
}

}  // namespace chain_dynamics::fuzz
