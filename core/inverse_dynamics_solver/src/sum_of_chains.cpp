// SPDX-License-Identifier: Apache-2.0
#include "sum_of_chains.hpp"

#include <cstddef>
#include <memory>
#include <utility>
#include <vector>

#include "chain_dynamics/mechanism.hpp"
#include "chain_dynamics/spatial.hpp"

namespace inverse_dynamics_solver {
inline namespace v2 {

using Eigen::MatrixXd, Eigen::VectorXd;

SumOfChains::SumOfChains(Eigen::Index n,
                         std::shared_ptr<const std::vector<chain_dynamics::Branch>> branches,
                         std::vector<std::unique_ptr<Workspace>> chains)
    : branches_(std::move(branches)), sum_(n) {
  for (std::size_t b = 0; b < chains.size(); ++b) {
    const chain_dynamics::Branch& branch = (*branches_)[b];
    const Eigen::Index m = branch.chain.jointCount();
    const VectorXd x = VectorXd::Zero(m);
    parts_.push_back(
        {branch, std::move(chains[b]), x, x, x, x, MatrixXd::Zero(m, m), MatrixXd::Zero(6, m)});
  }
}

void SumOfChains::Part::setPositions(const ConstVectorRef& of_coordinates) {
  q = Eigen::Map<const VectorXd>(branch.s.data(), q.size());
  addMotion(branch.S, of_coordinates, q);
}

void SumOfChains::Part::setMotion(const ConstVectorRef& of_coordinates, VectorXd& of_joints) const {
  of_joints.setZero();
  addMotion(branch.S, of_coordinates, of_joints);
}

void SumOfChains::inertiaMatrix(const ConstVectorRef& q, MatrixRef H) {
  H.setZero();
  for (Part& part : parts_) {
    part.setPositions(q);
    part.chain->inertiaMatrix(part.q, part.H);
    addMatrix(part.branch.S, part.H, H);
  }
}

void SumOfChains::coriolisVector(const ConstVectorRef& q, const ConstVectorRef& qd, VectorRef c) {
  sum_.setZero();
  for (Part& part : parts_) {
    part.setPositions(q);
    part.setMotion(qd, part.qd);
    part.chain->coriolisVector(part.q, part.qd, part.tau);
    addTorques(part.branch.S, part.tau, sum_);
  }
  c = sum_;  // which may stand where an input does
}

void SumOfChains::gravityVector(const ConstVectorRef& q, VectorRef g) {
  sum_.setZero();
  for (Part& part : parts_) {
    part.setPositions(q);
    part.chain->gravityVector(part.q, part.tau);
    addTorques(part.branch.S, part.tau, sum_);
  }
  g = sum_;
}

void SumOfChains::torques(const ConstVectorRef& q, const ConstVectorRef& qd,
                          const ConstVectorRef& qdd, VectorRef tau) {
  sum_.setZero();
  for (Part& part : parts_) {
    part.setPositions(q);
    part.setMotion(qd, part.qd);
    part.setMotion(qdd, part.qdd);
    part.chain->torques(part.q, part.qd, part.qdd, part.tau);
    addTorques(part.branch.S, part.tau, sum_);
  }
  tau = sum_;
}

void SumOfChains::tipPose(std::size_t tip, const ConstVectorRef& q,
                          chain_dynamics::Transform<double>& pose) {
  Part& part = parts_[tip];
  part.setPositions(q);
  part.withTip().tipPose(0, part.q, pose);
}

void SumOfChains::tipJacobian(std::size_t tip, const ConstVectorRef& q, MatrixRef J) {
  Part& part = parts_[tip];
  part.setPositions(q);
  part.withTip().tipJacobian(0, part.q, part.J);
  J.setZero();
  addJacobian(part.branch.S, part.J, J);
}

void SumOfChains::tipJacobianDerivative(std::size_t tip, const ConstVectorRef& q,
                                        const ConstVectorRef& qd, MatrixRef dJ) {
  Part& part = parts_[tip];
  part.setPositions(q);
  part.setMotion(qd, part.qd);
  part.withTip().tipJacobianDerivative(0, part.q, part.qd, part.J);
  dJ.setZero();
  addJacobian(part.branch.S, part.J, dJ);
}

void SumOfChains::externalTorques(std::size_t tip, const ConstVectorRef& q, WrenchFrame frame,
                                  const ConstVectorRef& wrench, VectorRef tau) {
  Part& part = parts_[tip];
  part.setPositions(q);
  part.withTip().externalTorques(0, part.q, frame, wrench, part.tau);
  tau.setZero();
  addTorques(part.branch.S, part.tau, tau);
}

}  // namespace v2
}  // namespace inverse_dynamics_solver
