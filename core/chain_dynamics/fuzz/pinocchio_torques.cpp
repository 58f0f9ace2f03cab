// SPDX-License-Identifier: Apache-2.0

/// @file
/// Torques by Pinocchio's own reading of robot descriptions, for other programs.
///
/// A process of its own, since Pinocchio's wheel brings other versions of libraries that ours are
/// linked with, and since it may crash where ours must not. From standard input, over and over:
/// a description, and joints by name with q, qd, qdd. To standard output: the number of torques
/// and the torques in the same order; none where Pinocchio or urdfdom refuses or complains. Texts
/// and lists begin with their length as a 32-bit number.

#include <console_bridge/console.h>

#include <cmath>
#include <cstdint>
#include <cstdio>
#include <exception>
#include <pinocchio/algorithm/rnea.hpp>
#include <pinocchio/parsers/urdf.hpp>
#include <string>
#include <vector>

namespace {

class Complaints : public console_bridge::OutputHandler {
 public:
  void log(const std::string& /*text*/, console_bridge::LogLevel level, const char* /*file*/,
           int /*line*/) override {
    if (level >= console_bridge::CONSOLE_BRIDGE_LOG_WARN) ++count;
  }
  int count = 0;
};

struct JointState {
  std::string name;
  double q, qd, qdd;
};

template <typename Number>
bool read(Number& number) {
  return std::fread(&number, sizeof number, 1, stdin) == 1;
}

bool read(std::string& text) {
  std::uint32_t size = 0;
  if (!read(size)) return false;
  text.resize(size);
  return std::fread(text.data(), 1, size, stdin) == size;
}

bool read(std::vector<JointState>& joints) {
  std::uint32_t size = 0;
  if (!read(size)) return false;
  joints.resize(size);
  for (JointState& joint : joints) {
    if (!read(joint.name) || !read(joint.q) || !read(joint.qd) || !read(joint.qdd)) return false;
  }
  return true;
}

/// Joints that aren't named stand at zero.
std::vector<double> torques(const std::string& urdf, const std::vector<JointState>& joints) {
  pinocchio::Model model;
  pinocchio::urdf::buildModelFromXML(urdf, model);
  Eigen::VectorXd q = pinocchio::neutral(model);
  Eigen::VectorXd qd = Eigen::VectorXd::Zero(model.nv), qdd = qd;
  for (const JointState& joint : joints) {
    if (!model.existJointName(joint.name)) return {};
    const auto id = model.getJointId(joint.name);
    const bool turns_without_limit = model.nqs[id] == 2;
    q[model.idx_qs[id]] = turns_without_limit ? std::cos(joint.q) : joint.q;
    if (turns_without_limit) q[model.idx_qs[id] + 1] = std::sin(joint.q);
    qd[model.idx_vs[id]] = joint.qd;
    qdd[model.idx_vs[id]] = joint.qdd;
  }
  pinocchio::Data data(model);
  const Eigen::VectorXd tau = pinocchio::rnea(model, data, q, qd, qdd);
  std::vector<double> of_joints;
  of_joints.reserve(joints.size());
  for (const JointState& joint : joints) {
    of_joints.push_back(tau[model.idx_vs[model.getJointId(joint.name)]]);
  }
  return of_joints;
}

}  // namespace

int main() {
  Complaints complaints;
  console_bridge::useOutputHandler(&complaints);
  std::string urdf;
  std::vector<JointState> joints;
  while (read(urdf) && read(joints)) {
    std::vector<double> tau;
    complaints.count = 0;
    try {
      tau = torques(urdf, joints);
    } catch (const std::exception&) {
      tau.clear();
    }
    if (complaints.count > 0) tau.clear();
    const auto size = static_cast<std::uint32_t>(tau.size());
    std::fwrite(&size, sizeof size, 1, stdout);
    std::fwrite(tau.data(), sizeof(double), size, stdout);
    std::fflush(stdout);
  }
}
