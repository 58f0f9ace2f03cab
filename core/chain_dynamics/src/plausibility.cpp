// SPDX-License-Identifier: Apache-2.0

#include "plausibility.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>
#include <vector>

#include "chain_dynamics/gravity_vector.hpp"
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

constexpr int kPostures = 16;
constexpr double kWidestRange = 12.6;         // rad, the widest range of arms
constexpr double kFastestJoint = 30;          // rad/s, of arms
constexpr double kFourTurnsInDegrees = 1440;  // beyond it a number stands for no limit

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

/// Least gravity torques of the joints in postures that are spread over their ranges; N m.
Eigen::VectorXd leastGravity(const Chain& chain) {
  constexpr double kGolden = 0.6180339887498949;
  const auto n = static_cast<Eigen::Index>(chain.jointCount());
  Eigen::VectorXd q(n), g(n), least = Eigen::VectorXd::Constant(n, INFINITY);
  for (int posture = 1; posture <= kPostures; ++posture) {
    for (Eigen::Index i = 0; i < n; ++i) {
      const JointLimits& limits = chain.joints()[static_cast<std::size_t>(i)].limits;
      const double lower = std::max(limits.lower, -M_PI), upper = std::min(limits.upper, M_PI);
      const double share = kGolden * posture * static_cast<double>(i + 1);
      q[i] = lower < upper ? lower + (share - std::floor(share)) * (upper - lower) : 0.0;
    }
    gravityVector(chain, q, g);
    least = least.cwiseMin(g.cwiseAbs());
  }
  return least;
}

std::string effortDoubt(const Chain& chain) {
  const Eigen::VectorXd gravity = leastGravity(chain);
  const auto use = [&](std::size_t i) {
    const double effort = chain.joints()[i].limits.effort;
    return effort > 0 ? gravity[static_cast<Eigen::Index>(i)] / effort : 0.0;
  };
  std::size_t worst = 0;
  for (std::size_t i = 1; i < chain.joints().size(); ++i) worst = use(i) > use(worst) ? i : worst;
  if (!(use(worst) > 1)) return "";
  const Joint& joint = chain.joints()[worst];
  const char* const unit = isPrismatic(joint) ? " N" : " N m";
  return "joint " + joint.name + ": gravity takes " +
         shortText(gravity[static_cast<Eigen::Index>(worst)]) + unit + " or more in " +
         std::to_string(kPostures) + " postures, but its effort limit is " +
         shortText(joint.limits.effort) + unit +
         "; check the units of masses (kg), lengths (m) and efforts";
}

/// A sentence if a joint's limits are far beyond those of arms, but not in degrees.
std::string degreesDoubt(const Joint& joint) {
  const JointLimits& limits = joint.limits;
  const double range = limits.upper - limits.lower;
  const bool degrees = range > kWidestRange && range < kFourTurnsInDegrees &&
                       limits.velocity > kFastestJoint && limits.velocity < kFourTurnsInDegrees;
  if (isPrismatic(joint) || !degrees) return "";
  return "joint " + joint.name + ": limits of " + shortText(limits.lower) + " to " +
         shortText(limits.upper) + " rad and " + shortText(limits.velocity) +
         " rad/s are implausible; are they in degrees?";
}

}  // namespace

std::vector<std::string> limitDoubts(const Chain& chain) {
  std::vector<std::string> texts{effortDoubt(chain)};
  for (const Joint& joint : chain.joints()) texts.push_back(degreesDoubt(joint));
  texts.erase(std::remove(texts.begin(), texts.end(), ""), texts.end());
  std::transform(texts.begin(), texts.end(), texts.begin(),
                 [](const std::string& one) { return printable(one); });
  return texts;
}

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
