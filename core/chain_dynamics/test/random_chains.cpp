// SPDX-License-Identifier: Apache-2.0
#include "random_chains.hpp"

#include <Eigen/Geometry>
#include <cmath>
#include <cstdint>
#include <sstream>
#include <string>
#include <vector>

namespace chain_dynamics::test {

Eigen::VectorXd Random::vector(Eigen::Index n) {
  return Eigen::VectorXd::NullaryExpr(n, [this] { return (*this)(); });
}

Eigen::Matrix3d Random::rotation() {
  return Eigen::Quaterniond(Eigen::Vector4d(vector(4))).normalized().toRotationMatrix();
}

LinkParameters randomLink(Random& random) {
  LinkParameters link = LinkParameters::zero();
  const Eigen::Vector3d middle = 0.2 * random.vector3();
  for (int k = 0; k < 6; ++k) {
    const double mass = 0.35 + 0.2 * random();
    link += LinkParameters::fromCenterOfMass(mass, middle + 0.2 * random.vector3(),
                                             Eigen::Matrix3d::Zero());
  }
  return link;
}

LinkParameters randomIdentifiedLink(Random& random) {
  return LinkParameters::fromVector(random.vector(10));
}

std::vector<LinkParameters> randomIdentifiedLinks(Random& random, const Chain& chain) {
  std::vector<LinkParameters> links;
  for (Eigen::Index i = 0; i < chain.jointCount(); ++i) {
    links.push_back(randomIdentifiedLink(random));
    links.back().mass = std::abs(links.back().mass);
  }
  return links;
}

std::vector<std::vector<LinkParameters>> randomIdentifiedRows(const Chain& chain) {
  Random random(7);
  std::vector<std::vector<LinkParameters>> rows;
  for (Eigen::Index j = 0; j < chain.jointCount(); ++j) {
    rows.push_back(randomIdentifiedLinks(random, chain));
  }
  return rows;
}

Chain randomChain(Eigen::Index n) {
  Random random(1000 + static_cast<std::uint32_t>(n));
  std::vector<Joint> joints;
  std::vector<LinkParameters> links;
  for (Eigen::Index i = 0; i < n; ++i) {
    Joint joint;
    joint.name = "joint" + std::to_string(i + 1);
    const double which = random();
    joint.type = which > 0.4    ? JointType::kPrismatic
                 : which > -0.6 ? JointType::kRevolute
                                : JointType::kContinuous;
    joint.placement = {random.rotation(), 0.4 * random.vector3()};
    joint.rotor_inertia = i % 2 == 0 ? 0.0 : 0.3 + 0.2 * random();
    joints.push_back(joint);
    links.push_back(randomLink(random));
  }
  return Chain("random" + std::to_string(n), joints, links, {1.0, -2.0, -9.0});
}

State<double> randomState(const Chain& chain, std::uint32_t seed) {
  Random random(seed);
  const Eigen::Index n = chain.jointCount();
  return {3.0 * random.vector(n), 2.0 * random.vector(n), 5.0 * random.vector(n)};
}

std::string paste(const Chain& chain, const State<double>& state) {
  const Eigen::IOFormat list(Eigen::FullPrecision, 0, ", ", ", ", "", "", "", ";");
  std::ostringstream text;
  text << "const Chain chain = randomChain(" << chain.jointCount() << ");\n"
       << "q << " << state.q.transpose().format(list) << "\n"
       << "qd << " << state.qd.transpose().format(list) << "\n"
       << "qdd << " << state.qdd.transpose().format(list);
  return text.str();
}

}  // namespace chain_dynamics::test
