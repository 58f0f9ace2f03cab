// SPDX-License-Identifier: Apache-2.0

#include "plausibility.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "chain_dynamics/text.hpp"

namespace chain_dynamics {
inline namespace v2 {
namespace {

/// Of the inertia of all moving mass halfway along the chain: less changes no torque visibly, and
/// makers give sensors and fingers round placeholders.
constexpr double kVisible = 0.01;

/// m: torsos, heads and turntables are as wide, however short the chain that moves them.
constexpr double kBody = 0.3;

constexpr double kSamePlace = 1e-3;  // m between axes of one joint

/// Of a joint's range: a measured position may lie beyond a limit by as much.
constexpr double kBeyondLimit = 0.1;

std::string shortText(double number) { return numberText(number, 3); }

std::string linkText(int line, const std::string& link, const std::string& joint) {
  return "URDF:" + std::to_string(line) + ": link " + link + ", moved by joint " + joint + ": ";
}

/// Length of the stretched chain to the tip, or to the farthest center of mass; m.
double lengthOf(const Chain& chain) {
  double length = 0, beyond = chain.tip().p.norm();
  for (std::size_t i = 0; i < chain.joints().size(); ++i) {
    const Joint& joint = chain.joints()[i];
    const LinkParameters& link = chain.links()[i];
    const double stroke = joint.limits.upper - joint.limits.lower;
    length += joint.placement.p.norm();
    if (isPrismatic(joint) && std::isfinite(stroke)) length += stroke;
    if (link.mass > 0) beyond = std::max(beyond, link.first_moment.norm() / link.mass);
  }
  return length + beyond;
}

bool hasMass(const LinkParameters& link) { return link.mass > 0; }

/// Whether link i has no inertia, holds the next joint at a distance, and moves mass beyond it. (The
/// links between the axes of one joint of several axes may be massless.)
bool isForgotten(const Chain& chain, std::size_t i) {
  const auto next = chain.links().begin() + static_cast<std::ptrdiff_t>(i) + 1;
  return chain.links()[i].toVector().isZero(0) && std::any_of(next, chain.links().end(), hasMass) &&
         chain.joints()[i + 1].placement.p.norm() > kSamePlace;
}

double massOf(const Chain& chain) {
  double mass = 0;
  for (const LinkParameters& link : chain.links()) mass += link.mass;
  return mass;
}

/// Largest principal moment about the center of mass; kg m^2.
double largestMoment(const RobotDescription::Inertial& inertial) {
  const Eigen::Matrix3d symmetric = 0.5 * (inertial.inertia + inertial.inertia.transpose());
  return Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(symmetric, Eigen::EigenvaluesOnly)
      .eigenvalues()[2];
}

/// A sentence if the radius of gyration of a link is implausible; mass: of all links.
std::string radiusDoubt(const RobotDescription::Link& link, const std::string& joint, double length,
                        double mass) {
  if (!link.inertial || !(link.inertial->mass > 0)) return "";
  const double moment = largestMoment(*link.inertial);
  const double radius = std::sqrt(std::max(moment, 0.0) / link.inertial->mass);
  const double half = 0.5 * length;
  if (radius <= std::max(half, kBody) || moment <= kVisible * mass * half * half) return "";
  return linkText(link.inertial->line, link.name, joint) + "a moment of inertia of " +
         shortText(moment) + " kg m^2 for " + shortText(link.inertial->mass) +
         " kg is implausible: a radius of gyration of " + shortText(radius) + " m in a chain of " +
         shortText(length) + " m; check the units of <inertia> (kg m^2) and <mass> (kg)";
}

}  // namespace

std::vector<std::string> inertiaDoubts(const RobotDescription& robot, const Chain& chain,
                                       const std::vector<std::vector<std::size_t>>& parts) {
  const double length = lengthOf(chain), mass = massOf(chain);
  const bool has_length = chain.jointCount() > 1;  // a wheel alone may have any radius
  std::vector<std::string> texts;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const std::string& joint = chain.joints()[i].name;
    for (const std::size_t part : has_length ? parts[i] : std::vector<std::size_t>()) {
      texts.push_back(radiusDoubt(robot.links[part], joint, length, mass));
    }
    if (isForgotten(chain, i) && !robot.links[parts[i].front()].inertial) {
      const RobotDescription::Link& link = robot.links[parts[i].front()];
      texts.push_back(linkText(link.line, link.name, joint) +
                      "has no <inertial>, but links beyond it have mass: it counts as massless");
    }
  }
  texts.erase(std::remove(texts.begin(), texts.end(), ""), texts.end());
  std::transform(texts.begin(), texts.end(), texts.begin(),
                 [](const std::string& one) { return printable(one); });
  return texts;
}

std::string positionDoubt(const RobotDescription::Joint& joint, double position) {
  const double lower = joint.limits.lower, upper = joint.limits.upper;
  const double margin = kBeyondLimit * (upper - lower);  // infinite without limits
  if (position >= lower - margin && position <= upper + margin) return "";
  const bool slides = joint.type == RobotDescription::JointType::kPrismatic;
  return printable("URDF:" + std::to_string(joint.line) + ": joint " + joint.name + ": held at " +
                   shortText(position) + (slides ? " m" : " rad") + ", beyond its limits of " +
                   shortText(lower) + " to " + shortText(upper) + "; check the unit");
}

}  // namespace v2
}  // namespace chain_dynamics
