// SPDX-License-Identifier: Apache-2.0

/// @file
/// Any robot in any state: the fast kernels against the readable algorithms.

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "bytes.hpp"
#include "equal_kernels.hpp"

namespace chain_dynamics::fuzz {
namespace {

constexpr double kPi = 3.14159265358979323846;

/// Right angles, as robots have them, or any rotation.
Matrix3<double> rotation(Bytes& bytes) {
  const int kind = bytes.below(4);
  Eigen::Vector3d angles;
  for (double& angle : angles) {
    angle = kind == 0 ? 0.0 : kind == 1 ? kPi / 2 * bytes.below(4) : bytes.number(kPi);
  }
  Matrix3<double> R = (Eigen::AngleAxisd(angles.z(), Eigen::Vector3d::UnitZ()) *
                       Eigen::AngleAxisd(angles.y(), Eigen::Vector3d::UnitY()) *
                       Eigen::AngleAxisd(angles.x(), Eigen::Vector3d::UnitX()))
                          .toRotationMatrix();
  if (kind == 1) R = R.array().round().matrix().eval();  // a right angle is one to the last bit
  return R;
}

Eigen::Vector3d vector3(Bytes& bytes, double range) {
  return {bytes.number(range), bytes.number(range), bytes.number(range)};
}

/// Parameters of any sign, as identified ones may be, but for the mass.
LinkParameters linkParameters(Bytes& bytes) {
  Vector10<double> numbers;
  for (double& number : numbers) number = bytes.number(3.0);
  numbers[0] = std::abs(numbers[0]);
  return LinkParameters::fromVector(numbers);
}

Chain chainOf(Bytes& bytes) {
  const int n = bytes.below(16) == 15 ? 64 : 1 + bytes.below(9);
  std::vector<Joint> joints;
  std::vector<LinkParameters> links;
  for (int i = 0; i < n; ++i) {
    Joint joint;
    joint.name = "joint" + std::to_string(i + 1);
    joint.type = bytes.below(4) == 0 ? JointType::kPrismatic : JointType::kRevolute;
    joint.placement = {rotation(bytes), vector3(bytes, 2.0)};
    joint.rotor_inertia = std::abs(bytes.number(1.0));
    joints.push_back(joint);
    links.push_back(linkParameters(bytes));
  }
  return Chain("fuzzed", joints, links, vector3(bytes, 9.81));
}

FrictionLaw friction(Bytes& bytes) {
  const double a = bytes.number(500), b = bytes.number(20), c = bytes.number(20);
  switch (bytes.below(4)) {
    case 0:
      return ViscousCoulombOffset{a, b, c};
    case 1:
      return ViscousOffsetSigmoid{a, b, c, bytes.number(500), bytes.number(0.5)};
    case 2:
      return CenteredSigmoid{b, a, bytes.number(0.5)};
    default:
      return SmoothCoulomb{std::abs(b),
                           std::abs(c),
                           0.002 + std::abs(bytes.number(0.5)),
                           bytes.number(0.5),
                           bytes.number(5),
                           std::abs(bytes.number(1)),
                           std::abs(bytes.number(5)),
                           0.01 + std::abs(bytes.number(0.5))};
  }
}

Model modelOf(Bytes& bytes) {
  Model model(chainOf(bytes));
  const auto n = static_cast<std::size_t>(model.chain.jointCount());
  const auto links = [&] {
    std::vector<LinkParameters> set;
    for (std::size_t i = 0; i < n; ++i) set.push_back(linkParameters(bytes));
    return set;
  };
  const int parts = bytes.byte();
  if ((parts & 1) != 0 && n < 10) {
    for (std::size_t j = 0; j < n; ++j) model.row_parameters.push_back(links());
  }
  if ((parts & 2) != 0) model.gravity_parameters = links();
  if ((parts & 4) != 0) {
    for (std::size_t j = 0; j < n; ++j) model.friction.push_back(friction(bytes));
  }
  return model;
}

State stateOf(Bytes& bytes, Eigen::Index n) {
  State state{Eigen::VectorXd(n), Eigen::VectorXd(n), Eigen::VectorXd(n)};
  // Sines of angles far away aren't those of the angle in the file, but all must take the same.
  const double turn = bytes.below(8) == 0 ? 1e7 : 4.0;
  for (Eigen::Index j = 0; j < n; ++j) {
    state.q[j] = bytes.number(turn);
    state.qd[j] = bytes.number(10.0);
    state.qdd[j] = bytes.number(100.0);
  }
  return state;
}

}  // namespace
}  // namespace chain_dynamics::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace chain_dynamics::fuzz;
  Bytes bytes(data, size);
  const chain_dynamics::Model model = modelOf(bytes);
  requireEqualKernels(model, stateOf(bytes, model.chain.jointCount()));
  return 0;
}
