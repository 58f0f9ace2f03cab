// SPDX-License-Identifier: Apache-2.0

#include "chain_dynamics/chain.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "chain_dynamics/gravity.hpp"
#include "number.hpp"

namespace chain_dynamics {
inline namespace v2 {
namespace {

constexpr double kRotationTolerance = 1e-9;  // entries of R'R - 1: what ten printed digits leave
constexpr double kInertiaTolerance = 1e-9;  // of the greatest moment: published numbers are rounded
constexpr double kSymmetryTolerance = 1e-12;  // of the greatest entry: a frame changed by R I R'

/// With enough digits to find the number in a file.
std::string text(double value) { return numberText(value, 10); }

std::string text(const Eigen::Vector3d& value) {
  return "[" + text(value.x()) + ", " + text(value.y()) + ", " + text(value.z()) + "]";
}

void checkGravity(const std::string& chain, const Eigen::Vector3d& gravity) {
  // The comparison is false for a NaN.
  if (!(gravity.array().abs() <= kGreatestGravity).all()) {
    throw ModelError(chain, "gravity", "three finite numbers up to 1e6 [m/s^2]", text(gravity),
                     "for example [0, 0, -9.81]");
  }
}

void checkPose(const std::string& where, const std::string& what, const Transform<double>& X) {
  if (!X.R.allFinite() || !X.p.allFinite()) {
    throw ModelError(where, what, "finite numbers", "a NaN or an infinity", "");
  }
  if (X.p.cwiseAbs().maxCoeff() > kLargestNumber) {
    throw ModelError(where, what, "lengths up to 1e50 m", text(Eigen::Vector3d(X.p)), "");
  }
  const double error = (X.R.transpose() * X.R - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff();
  if (error > kRotationTolerance || X.R.determinant() < 0) {
    throw ModelError(
        where, what, "a rotation matrix",
        "columns off orthonormal by " + text(error) + ", determinant " + text(X.R.determinant()),
        "make it from angles or a unit quaternion");
  }
}

void checkLimits(const std::string& where, const JointLimits& limits) {
  if (!(limits.lower <= limits.upper)) {
    throw ModelError(where, "position limits", "lower <= upper",
                     text(limits.lower) + " and " + text(limits.upper),
                     "leave out what is unknown");
  }
  for (const auto& [what, limit] :
       {std::pair("velocity", limits.velocity), std::pair("effort", limits.effort),
        std::pair("acceleration", limits.acceleration),
        std::pair("deceleration", limits.deceleration), std::pair("jerk", limits.jerk)}) {
    if (!(limit >= 0)) {
      throw ModelError(where, std::string(what) + " limit", "a number >= 0", text(limit),
                       "leave out what is unknown");
    }
  }
}

void checkJoint(const std::string& where, const Joint& joint) {
  checkPose(where, "placement", joint.placement);
  checkLimits(where, joint.limits);
  if (!std::isfinite(joint.rotor_inertia) || joint.rotor_inertia < 0) {
    throw ModelError(where, "rotor inertia", "a finite number >= 0", text(joint.rotor_inertia), "");
  }
  if (!std::isfinite(joint.damping) || !std::isfinite(joint.friction)) {
    throw ModelError(where, "damping and friction", "finite numbers",
                     text(joint.damping) + " and " + text(joint.friction), "");
  }
}

void checkLink(const std::string& where, const LinkParameters& link) {
  if (!link.toVector().allFinite()) {
    throw ModelError(where, "inertial parameters", "ten finite numbers", "a NaN or an infinity",
                     "");
  }
  const double greatest = link.toVector().cwiseAbs().maxCoeff();
  if (greatest > kLargestNumber) {
    throw ModelError(where, "inertial parameters", "numbers up to 1e50", text(greatest), "");
  }
  if (link.mass < 0) throw ModelError(where, "mass", "a number >= 0 [kg]", text(link.mass), "");
  const double asymmetry = (link.inertia - link.inertia.transpose()).cwiseAbs().maxCoeff();
  if (asymmetry > kSymmetryTolerance * link.inertia.cwiseAbs().maxCoeff()) {
    throw ModelError(where, "moment of inertia", "a symmetric matrix",
                     "entries that differ by " + text(asymmetry), "");
  }
}

void checkSizes(const std::string& chain, std::size_t joints, std::size_t links) {
  if (joints == 0) {
    throw ModelError(chain, "joints", "at least one movable joint", "none",
                     "a chain without joints has no torques");
  }
  if (links != joints) {
    throw ModelError(chain, "links", "one per joint (" + std::to_string(joints) + ")",
                     std::to_string(links), "");
  }
}

// Names are how callers tell joints apart.
void checkNames(const std::string& chain, const std::vector<Joint>& joints) {
  std::set<std::string> names;
  for (std::size_t i = 0; i < joints.size(); ++i) {
    if (joints[i].name.empty()) {
      throw ModelError(chain, "name of joint " + std::to_string(i + 1), "a name", "none", "");
    }
    if (!isPrintable(joints[i].name)) {
      throw ModelError(chain, "name of joint " + std::to_string(i + 1),
                       "UTF-8 text without control characters", "'" + joints[i].name + "'", "");
    }
    if (!names.insert(joints[i].name).second) {
      throw ModelError(chain, "joint names", "each once", "'" + joints[i].name + "' twice", "");
    }
  }
}

}  // namespace

Chain::Chain(std::string name, std::vector<Joint> joints, std::vector<LinkParameters> links,
             const Eigen::Vector3d& gravity, const Transform<double>& tip)
    : name_(std::move(name)),
      joints_(std::move(joints)),
      links_(std::move(links)),
      gravity_(gravity),
      tip_(tip) {
  const std::string where = "chain " + name_;
  if (!isPrintable(name_)) {
    throw ModelError(where, "name", "UTF-8 text without control characters", "'" + name_ + "'", "");
  }
  checkSizes(where, joints_.size(), links_.size());
  checkNames(where, joints_);
  checkGravity(where, gravity_);
  checkPose(where, "tip", tip_);

  for (std::size_t i = 0; i < joints_.size(); ++i) {
    const std::string joint = where + ": joint " + joints_[i].name;
    const std::string link = where + ": link moved by joint " + joints_[i].name;
    checkJoint(joint, joints_[i]);
    checkLink(link, links_[i]);
    links_[i].inertia = (0.5 * (links_[i].inertia + links_[i].inertia.transpose())).eval();

    const std::string defect = inertiaDefect(links_[i]);
    if (!defect.empty()) warnings_.push_back(printable(link + ": " + defect));
  }
}

Chain Chain::withGravity(const Eigen::Vector3d& gravity) const {
  checkGravity("chain " + name_, gravity);
  Chain result = *this;
  result.gravity_ = gravity;
  return result;
}

Chain Chain::withWarnings(std::vector<std::string> warnings) const {
  Chain result = *this;
  result.warnings_ = std::move(warnings);
  return result;
}

std::vector<std::string> Chain::jointNames() const {
  std::vector<std::string> names;
  names.reserve(joints_.size());
  for (const Joint& joint : joints_) names.push_back(joint.name);
  return names;
}

std::vector<JointType> Chain::jointTypes() const {
  std::vector<JointType> types;
  types.reserve(joints_.size());
  for (const Joint& joint : joints_) types.push_back(joint.type);
  return types;
}

Matrix3<double> inertiaAboutCenter(const LinkParameters& link) {
  if (link.mass == 0) return link.inertia;
  const Matrix3<double> mc_x = skew<double>(link.first_moment);
  return link.inertia + mc_x * mc_x / link.mass;
}

std::string inertiaDefect(const LinkParameters& link) {
  if (link.mass < 0) return "negative mass " + text(link.mass);
  if (link.mass == 0) {
    const bool empty = link.first_moment.isZero(0) && link.inertia.isZero(0);
    return empty ? "" : "inertia without mass";
  }

  // principal moments in rising order
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(inertiaAboutCenter(link),
                                                              Eigen::EigenvaluesOnly);
  const Eigen::Vector3d moments = solver.eigenvalues();

  // what rounding of the given entries, about the frame's origin, may cause is no defect
  const double tolerance = kInertiaTolerance * link.inertia.cwiseAbs().maxCoeff();
  if (moments[0] < -tolerance) {
    return "principal moments of inertia " + text(moments) +
           " about the center of mass aren't positive";
  }
  if (moments[0] + moments[1] < moments[2] - tolerance) {
    return "principal moments of inertia " + text(moments) +
           " about the center of mass break the triangle inequality";
  }
  return "";
}

}  // namespace v2
}  // namespace chain_dynamics
