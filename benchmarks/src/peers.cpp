// SPDX-License-Identifier: Apache-2.0
#include "peers.hpp"

#include <sstream>
#include <stdexcept>
#include <string>

namespace inverse_dynamics_benchmarks {

void requireSameTorques(const PeerRobot& robot, const std::string& library,
                        const Eigen::VectorXd& torques) {
  const double allowed = 1e-9 * robot.expected.cwiseAbs().maxCoeff();
  if (torques.size() == robot.expected.size() &&
      (torques - robot.expected).cwiseAbs().maxCoeff() <= allowed) {
    return;
  }
  std::ostringstream text;
  text << robot.name << ": " << library << " computes other torques: expected "
       << robot.expected.transpose() << ", got " << torques.transpose();
  throw std::runtime_error(text.str());
}

}  // namespace inverse_dynamics_benchmarks
