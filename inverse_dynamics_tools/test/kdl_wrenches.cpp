// SPDX-License-Identifier: Apache-2.0
//
// KDL's ChainExternalWrenchEstimator on a recording, for comparison: reads a chain and samples as
// plain numbers from the standard input, writes the force of each sample [N], in the axes of the
// root.
//
//     joints  gain [1/s]  period [s]  samples
//     and of each joint and of the tip:  R (row after row)  p  axis  m  c  I (about c)
//     and of each sample:                q  qd  tau
#include <iostream>
#include <kdl/chain.hpp>
#include <kdl/chainexternalwrenchestimator.hpp>
#include <kdl/chainfksolverpos_recursive.hpp>

namespace {

double number() {
  double value = 0.0;
  std::cin >> value;
  return value;
}

KDL::Vector vector() {
  const double x = number(), y = number(), z = number();
  return {x, y, z};
}

KDL::Segment segment(bool fixed) {
  double R[9];
  for (double& entry : R) entry = number();
  const KDL::Frame frame(KDL::Rotation(R[0], R[1], R[2], R[3], R[4], R[5], R[6], R[7], R[8]),
                         vector());
  const KDL::Vector axis = frame.M * vector();
  const double mass = number();
  const KDL::Vector center = vector();
  double I[6];  // xx, xy, xz, yy, yz, zz
  for (double& entry : I) entry = number();
  const KDL::RigidBodyInertia inertia(mass, center,
                                      KDL::RotationalInertia(I[0], I[3], I[5], I[1], I[2], I[4]));
  const KDL::Joint joint =
      fixed ? KDL::Joint(KDL::Joint::None) : KDL::Joint(frame.p, axis, KDL::Joint::RotAxis);
  return KDL::Segment(joint, frame, inertia);
}

KDL::JntArray joints(unsigned count) {
  KDL::JntArray values(count);
  for (unsigned j = 0; j < count; ++j) values(j) = number();
  return values;
}

}  // namespace

int main() {
  const auto count = static_cast<unsigned>(number());
  const double gain = number(), period = number();
  const auto samples = static_cast<int>(number());
  KDL::Chain chain;
  for (unsigned j = 0; j <= count; ++j) chain.addSegment(segment(j == count));
  KDL::ChainExternalWrenchEstimator estimator(chain, {0, 0, -9.81}, 1.0 / period, gain, 0.0);
  KDL::ChainFkSolverPos_recursive kinematics(chain);
  std::cout.precision(17);
  for (int k = 0; k < samples; ++k) {
    const KDL::JntArray q = joints(count), qd = joints(count), tau = joints(count);
    if (k == 0) estimator.setInitialMomentum(q, qd);
    KDL::Wrench wrench;
    KDL::Frame tip;
    if (estimator.JntToExtWrench(q, qd, tau, wrench) < 0 || kinematics.JntToCart(q, tip) < 0) {
      std::cerr << "sample " << k << ": KDL failed\n";
      return 1;
    }
    const KDL::Vector force = tip.M * wrench.force;
    std::cout << force.x() << ' ' << force.y() << ' ' << force.z() << '\n';
  }
  return std::cin ? 0 : 1;
}
