// SPDX-License-Identifier: Apache-2.0
#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "chain_dynamics/joint_frame.hpp"
#include "chain_dynamics/text.hpp"
#include "inverse_dynamics_solver/payload.hpp"

namespace inverse_dynamics_solver {
inline namespace v2 {
namespace {

using Numbers = std::vector<double>;

const std::string kPayload = "payload";

/// So many numbers, or none.
std::optional<Numbers> read(const Configuration& configuration, const std::string& name,
                            std::size_t count, const char* meaning) {
  auto numbers = configuration.get<Numbers>(name);
  if (numbers && numbers->size() != count) {
    configuration.refuse(name, std::to_string(count) + " numbers: " + meaning,
                         std::to_string(numbers->size()), "");
  }
  return numbers;
}

Eigen::Vector3d vectorOf(const std::optional<Numbers>& numbers) {
  return numbers ? Eigen::Vector3d(numbers->data()) : Eigen::Vector3d::Zero();
}

Eigen::Matrix3d inertiaOf(const std::optional<Numbers>& numbers) {
  if (!numbers) return Eigen::Matrix3d::Zero();
  const Numbers& I = *numbers;  // ixx ixy ixz iyy iyz izz
  Eigen::Matrix3d inertia;
  inertia << I[0], I[1], I[2], I[1], I[3], I[4], I[2], I[4], I[5];
  return inertia;
}

/// The body whose parameters begin with this prefix, if any of them is set.
std::optional<RigidBody> readBody(const Configuration& configuration, const std::string& prefix) {
  const auto mass = configuration.get<double>(prefix + "mass");
  const auto center = read(configuration, prefix + "center_of_mass", 3, "x y z [m]");
  const auto inertia = read(configuration, prefix + "inertia", 6,
                            "ixx ixy ixz iyy iyz izz about the center of mass [kg m^2]");
  const auto xyz = read(configuration, prefix + "frame.xyz", 3, "x y z in the tip frame [m]");
  const auto rpy = read(configuration, prefix + "frame.rpy", 3, "roll pitch yaw [rad]");
  const auto tip = configuration.get<std::string>(prefix + "tip");
  if (!mass && !center && !inertia && !xyz && !rpy && !tip) return {};

  RigidBody body;
  body.mass = configuration.require<double>(prefix + "mass");
  body.center_of_mass = vectorOf(center);
  body.inertia = inertiaOf(inertia);
  body.tip = tip.value_or("");
  const Eigen::Vector3d angles = vectorOf(rpy);
  body.frame = {chain_dynamics::rotationFromRollPitchYaw(angles), vectorOf(xyz)};
  if (const auto defect = defectOf(body)) {
    const bool turned = defect->field == "frame" && !angles.allFinite();
    configuration.refuse(prefix + (defect->field != "frame" ? defect->field
                                   : turned                 ? "frame.rpy"
                                                            : "frame.xyz"),
                         defect->expected, defect->got, defect->remedy);
  }
  return body;
}

/// NAME of each parameter `payload.NAME.<anything>`.
std::set<std::string> namesOf(const Configuration& configuration) {
  const std::string prefix = configuration.fullName(kPayload + ".");
  std::set<std::string> names;
  for (const std::string& parameter : configuration.parameters.names()) {
    if (parameter.rfind(prefix, 0) != 0) continue;
    const std::string rest = parameter.substr(prefix.size());
    const std::size_t dot = rest.find('.');
    if (dot == std::string::npos || rest == "frame.xyz" || rest == "frame.rpy") continue;
    names.insert(rest.substr(0, dot));
  }
  return names;
}

}  // namespace

Payloads readPayloads(const Configuration& configuration) {
  Payloads bodies;
  if (const auto body = readBody(configuration, kPayload + ".")) bodies[kPayload] = *body;
  for (const std::string& name : namesOf(configuration)) {
    const std::string prefix = kPayload + "." + name + ".";
    const auto body = readBody(configuration, prefix);
    if (!body) continue;
    if (name.empty() || !chain_dynamics::isPrintable(name) || bodies.count(name) > 0) {
      configuration.refuse(prefix + "mass", "a name of its own for each body", "'" + name + "'",
                           "the body without a name is called '" + kPayload + "'");
    }
    bodies[name] = *body;
  }
  return bodies;
}

}  // namespace v2
}  // namespace inverse_dynamics_solver
