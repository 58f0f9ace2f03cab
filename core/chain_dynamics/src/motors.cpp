// SPDX-License-Identifier: Apache-2.0

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "chain_dynamics/error.hpp"
#include "chain_dynamics/mechanism.hpp"
#include "chain_dynamics/text.hpp"
#include "follower.hpp"

namespace chain_dynamics {
inline namespace v2 {
namespace {

using Eigen::Index;

const Joint& jointOf(const Mechanism& mechanism, Index i) {
  return mechanism.coordinates.joints()[static_cast<std::size_t>(i)];
}

std::string motorsOf(const Mechanism& mechanism) {
  return "motors of mechanism " + mechanism.coordinates.name();
}

void checkMotors(const Mechanism& mechanism, const Motors& motors) {
  if (mechanism.branches.empty()) {
    throw ModelError(motorsOf(mechanism), "branches", "at least one", "none",
                     "make the mechanism with branches_of_chains");
  }
  const Index n = mechanism.coordinates.jointCount(), m = motors.M.cols();
  const auto count = static_cast<std::size_t>(m);
  const bool named = motors.names.empty() || motors.names.size() == count;
  const bool moved = motors.offset.size() == 0 || motors.offset.size() == n;
  const bool heavy = motors.rotor_inertia.empty() || motors.rotor_inertia.size() == count;
  if (motors.M.rows() != n || m < 1 || m > n || !named || !moved || !heavy) {
    throw ModelError(
        motorsOf(mechanism), "matrix, offsets, names and rotor inertia",
        "a row for each of the joints " + joined(mechanism.coordinates.jointNames()) +
            ", up to as many columns, an offset per row, a name and an inertia per column",
        std::to_string(motors.M.rows()) + " x " + std::to_string(m) + " numbers, " +
            std::to_string(motors.offset.size()) + " offsets, " +
            std::to_string(motors.names.size()) + " names, " +
            std::to_string(motors.rotor_inertia.size()) + " inertias",
        "");
  }
  for (Index i = 0; i < n; ++i) {
    if (motors.M.row(i).allFinite() &&
        (motors.offset.size() == 0 || std::isfinite(motors.offset[i])))
      continue;
    throw ModelError(motorsOf(mechanism), "row of joint " + jointOf(mechanism, i).name,
                     "finite numbers", "others", "");
  }
}

/// The only column whose entry of the row isn't zero, or -1.
Index onlyMotor(const OwnedMatrix& M, Index row) {
  Index column = -1;
  for (Index i = 0; i < M.cols(); ++i) {
    if (M(row, i) == 0) continue;
    if (column >= 0) return -1;
    column = i;
  }
  return column;
}

double offsetOf(const Motors& motors, Index joint) {
  return motors.offset.size() == 0 ? 0 : motors.offset[joint];
}

/// The joint that a motor is itself, or -1.
Index ownJoint(const Motors& motors, Index motor) {
  for (Index j = 0; j < motors.M.rows(); ++j) {
    const bool is_itself = onlyMotor(motors.M, j) == motor && motors.M(j, motor) == 1;
    if (is_itself && offsetOf(motors, j) == 0) return j;
  }
  return -1;
}

/// A motor that isn't a joint itself.
Joint motorOf(const Mechanism& mechanism, const Motors& motors, Index motor) {
  Joint result;
  result.name = "motor_" + std::to_string(motor + 1);
  result.type = JointType::kPrismatic;
  for (Index j = 0; j < motors.M.rows(); ++j) {
    const Joint& joint = jointOf(mechanism, j);
    if (motors.M(j, motor) != 0 && !isPrismatic(joint)) result.type = JointType::kRevolute;
    const bool alone = (motors.M.col(motor).array() != 0).count() == 1;
    if (onlyMotor(motors.M, j) != motor || !alone) continue;
    const double factor = std::abs(motors.M(j, motor));
    result.limits.effort = factor * joint.limits.effort;
    if (joint.type == JointType::kContinuous && factor == 1) result.type = joint.type;
  }
  return result;
}

Chain coordinatesOf(const Mechanism& mechanism, const Motors& motors) {
  std::vector<std::string> warnings = mechanism.coordinates.warnings();
  std::vector<Joint> joints;
  for (Index i = 0; i < motors.M.cols(); ++i) {
    const Index own = ownJoint(motors, i);
    Joint motor = own < 0 ? motorOf(mechanism, motors, i) : jointOf(mechanism, own);
    if (!motors.names.empty()) motor.name = motors.names[static_cast<std::size_t>(i)];
    for (Index j = 0; j < motors.M.rows(); ++j) {
      const double factor = motors.M(j, i);
      if (j == own || factor == 0) continue;
      const Joint& joint = jointOf(mechanism, j);
      if (onlyMotor(motors.M, j) != i) {
        motor.rotor_inertia += factor * factor * joint.rotor_inertia;
        addTurns(motor, joint, factor);
        continue;
      }
      const std::string doubt = addFollower(motor, joint, factor, offsetOf(motors, j));
      if (!doubt.empty()) warnings.push_back(doubt);
    }
    if (!motors.rotor_inertia.empty()) {
      motor.rotor_inertia += motors.rotor_inertia[static_cast<std::size_t>(i)];
    }
    joints.push_back(motor);
  }
  for (Index j = 0; j < motors.M.rows(); ++j) {
    const Joint& joint = jointOf(mechanism, j);
    if (onlyMotor(motors.M, j) >= 0 || (joint.damping == 0 && joint.friction == 0)) continue;
    warnings.push_back(printable("joint " + joint.name +
                                 ": its damping and friction aren't used, " +
                                 "as several motors move it"));
  }
  const std::vector<LinkParameters> links(joints.size(), LinkParameters::zero());
  return Chain(mechanism.coordinates.name(), joints, links, mechanism.coordinates.gravity())
      .withWarnings(std::move(warnings));
}

/// `S M` and `S offset + s`.
Branch behind(const Branch& branch, const Motors& motors) {
  Branch result = branch;
  result.S.clear();
  const Index m = branch.chain.jointCount();
  Eigen::MatrixXd S = Eigen::MatrixXd::Zero(m, motors.M.rows());
  for (const Follow& entry : branch.S) S(entry.joint, entry.coordinate) = entry.factor;
  const Eigen::MatrixXd SM = S * motors.M;
  for (Index j = 0; j < m; ++j) {
    for (Index i = 0; i < SM.cols(); ++i) {
      if (SM(j, i) != 0) result.S.push_back({j, i, SM(j, i)});
    }
  }
  for (const Follow& entry : branch.S) {
    result.s[static_cast<std::size_t>(entry.joint)] +=
        entry.factor * offsetOf(motors, entry.coordinate);
  }
  return result;
}

/// The transmission that moves a joint, if any.
const RobotDescription::Transmission* transmissionOf(const RobotDescription& robot,
                                                     const std::vector<std::string>& joints,
                                                     const std::string& joint) {
  const RobotDescription::Transmission* found = nullptr;
  for (const RobotDescription::Transmission& next : robot.transmissions) {
    if (std::count(next.joints.begin(), next.joints.end(), joint) == 0) continue;
    const std::string place = "URDF:" + std::to_string(next.line) + ": transmission " + next.name;
    if (!next.fault.empty()) throw ModelError(next.fault);
    if (found != nullptr) {
      throw ModelError(place, "joint " + joint, "one of no other transmission",
                       "one of transmission " + found->name, "");
    }
    for (const std::string& other : next.joints) {
      if (std::count(joints.begin(), joints.end(), other) > 0) continue;
      throw ModelError(place, "joint " + other, "one between root and tips that moves by itself",
                       "one that is held or follows others", "hold joint " + joint + ", too");
    }
    found = &next;
  }
  return found;
}

}  // namespace

Mechanism withMotors(const Mechanism& mechanism, const Motors& motors) {
  checkMotors(mechanism, motors);
  Mechanism result{coordinatesOf(mechanism, motors), {}, motors.rotor_inertia};
  for (const Branch& branch : mechanism.branches) {
    result.branches.push_back(behind(branch, motors));
  }
  checkMechanism(result);
  return result;
}

Motors motorsFromRobot(const RobotDescription& robot, const std::vector<std::string>& joints) {
  const auto n = static_cast<Index>(joints.size());
  const auto row_of = [&joints](const std::string& joint) {
    return static_cast<Index>(std::find(joints.begin(), joints.end(), joint) - joints.begin());
  };
  Motors motors;
  motors.M = Eigen::MatrixXd::Zero(n, n);
  motors.offset = Eigen::VectorXd::Zero(n);
  std::set<const RobotDescription::Transmission*> taken;
  Index column = 0;
  for (const std::string& joint : joints) {
    const RobotDescription::Transmission* const found = transmissionOf(robot, joints, joint);
    if (found == nullptr) {
      motors.names.push_back(joint);
      motors.M(row_of(joint), column++) = 1;
    } else if (taken.insert(found).second) {
      motors.names.insert(motors.names.end(), found->motors.begin(), found->motors.end());
      const auto count = static_cast<Index>(found->joints.size());
      for (Index i = 0; i < count; ++i) {
        const auto at = static_cast<std::size_t>(i);
        const Index row = row_of(found->joints[at]);
        motors.offset[row] = found->offset[at];
        motors.M.row(row).segment(column, count) =
            Eigen::Map<const Eigen::RowVectorXd>(&found->M[at * found->joints.size()], count);
      }
      column += count;
    }
  }
  return motors;
}

}  // namespace v2
}  // namespace chain_dynamics
