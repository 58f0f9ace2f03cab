// SPDX-License-Identifier: Apache-2.0
#include "inverse_dynamics_solver/plausibility.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "chain_dynamics/text.hpp"

namespace inverse_dynamics_solver {
inline namespace v2 {
namespace {

std::string rounded(double number) { return chain_dynamics::numberText(number, 4); }

}  // namespace

std::string doubtOf(const RigidBody& body) {
  constexpr double kLong = 5.0;  // m: no arm's tool is as long; 5 mm taken for metres are
  if (!(body.mass > 0)) return "";
  const double center = (body.frame.p + body.frame.R * body.center_of_mass).norm();
  // No principal moment exceeds the sum of the other two.
  const double radius = std::sqrt(std::max(body.inertia.trace(), 0.0) / 2 / body.mass);
  if (center < kLong && radius < kLong) return "";
  return "a payload of " + rounded(body.mass) + " kg is implausible: its " +
         (center < kLong ? "radius of gyration is " + rounded(radius) + " m"
                         : "center of mass is " + rounded(center) + " m from the tip") +
         "; check the units (kg, m, kg m^2)";
}

std::string doubtOf(const Eigen::Vector3d& gravity) {
  constexpr double kMoon = 1.6, kJupiter = 25.0;  // m/s^2, rounded outwards
  const double norm = gravity.norm();
  if (norm == 0 || (norm >= kMoon && norm <= kJupiter)) return "";
  return "gravity of " + rounded(norm) +
         " m/s^2 is implausible; check its unit (m/s^2, 9.81 on Earth)";
}

}  // namespace v2
}  // namespace inverse_dynamics_solver
