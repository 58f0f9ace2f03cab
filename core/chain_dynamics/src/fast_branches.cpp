// SPDX-License-Identifier: Apache-2.0

// One state.

#include "fast_branches.hpp"

#include <algorithm>
#include <cstddef>
#include <memory>
#include <utility>
#include <vector>

#include "branch_sums.hpp"
#include "chain_dynamics/friction.hpp"
#include "chain_dynamics/scratch.hpp"
#include "springs.hpp"

namespace chain_dynamics {
inline namespace v2 {
namespace kernel_sums {
namespace {

using Map = Eigen::Map<Eigen::VectorXd>;
using ConstMap = Eigen::Map<const Eigen::VectorXd>;
using MatrixMap = Eigen::Map<Eigen::MatrixXd, 0, Eigen::OuterStride<>>;

/// `S x`: velocities or accelerations of a branch's joints.
const double* motionOf(const FastBranch& b, const double* x, Numbers& memory) {
  double* const to = memory.numbers;
  if (!b.coordinates.empty()) {
    for (std::size_t i = 0; i < b.coordinates.size(); ++i) to[i] = x[b.coordinates[i]];
    return to;
  }
  std::fill_n(to, jointsOf(b), 0.0);
  for (const Follow& entry : b.branch.S) to[entry.joint] += entry.factor * x[entry.coordinate];
  return to;
}

/// `S q + s`.
const double* positionsOf(const FastBranch& b, const double* q, Numbers& memory) {
  motionOf(b, q, memory);
  if (b.coordinates.empty()) {
    for (std::size_t i = 0; i < b.branch.s.size(); ++i) memory.numbers[i] += b.branch.s[i];
  }
  return memory.numbers;
}

/// `sum += S' of_branch`.
void add(const FastBranch& b, const double* of_branch, double* sum) {
  if (!b.coordinates.empty()) {
    for (std::size_t i = 0; i < b.coordinates.size(); ++i) sum[b.coordinates[i]] += of_branch[i];
    return;
  }
  for (const Follow& entry : b.branch.S) {
    sum[entry.coordinate] += entry.factor * of_branch[entry.joint];
  }
}

/// Adds the torques of springs.
void addSprings(const FastBranches& all, const double* q, double* sum) {
  for (Index j = 0; j < springCount(*all.model); ++j) sum[j] += springTorque(*all.model, j, q);
}

void friction(const Robot& robot, int /*structure*/, const double* q, const double* qd, double* f) {
  const FastBranches& all = branchesOf(robot);
  if (all.friction_alone) return all.friction_alone->frictionVector(q, qd, f);
  const Index n = robot.joints;
  Numbers result;  // f may be qd
  const ConstMap position(q, q != nullptr ? n : 0);
  chain_dynamics::frictionVector(*all.model, position, ConstMap(qd, n), Map(result.numbers, n));
  std::copy_n(result.numbers, n, f);
}

void torques(const Robot& robot, int structure, const double* q, const double* qd,
             const double* qdd, double* tau) {
  const FastBranches& all = branchesOf(robot);
  Numbers q_b, qd_b, qdd_b, tau_b, sum;
  if (all.model->friction.empty()) {
    std::fill_n(sum.numbers, robot.joints, 0.0);
  } else {
    friction(robot, structure, q, qd, sum.numbers);
  }
  addSprings(all, q, sum.numbers);
  for (Index j = 0; j < all.model->motor_inertia.size(); ++j) {
    if (all.model->motor_inertia[j] != 0) sum.numbers[j] += all.model->motor_inertia[j] * qdd[j];
  }
  for (const FastBranch& b : all.branches) {
    b.fast->torques(positionsOf(b, q, q_b), motionOf(b, qd, qd_b), motionOf(b, qdd, qdd_b),
                    tau_b.numbers);
    add(b, tau_b.numbers, sum.numbers);
  }
  std::copy_n(sum.numbers, robot.joints, tau);
}

void coriolis(const Robot& robot, int /*structure*/, const double* q, const double* qd, double* c) {
  Numbers q_b, qd_b, c_b, sum{};
  for (const FastBranch& b : branchesOf(robot).branches) {
    b.fast->coriolisVector(positionsOf(b, q, q_b), motionOf(b, qd, qd_b), c_b.numbers);
    add(b, c_b.numbers, sum.numbers);
  }
  std::copy_n(sum.numbers, robot.joints, c);
}

void gravity(const Robot& robot, int /*structure*/, const double* q, double* g) {
  Numbers q_b, g_b, sum{};
  addSprings(branchesOf(robot), q, sum.numbers);
  for (const FastBranch& b : branchesOf(robot).branches) {
    b.fast->gravityVector(positionsOf(b, q, q_b), g_b.numbers);
    add(b, g_b.numbers, sum.numbers);
  }
  std::copy_n(sum.numbers, robot.joints, g);
}

/// The sum of a matrix that `compute` gives of each branch.
template <class Compute>
void sumOfMatrices(const Robot& robot, const double* q, const Matrices& sum,
                   const Compute& compute) {
  Numbers q_b;
  double of_branch[kMost * kMost];
  setZero(sum, robot.joints, robot.joints);
  for (const FastBranch& b : branchesOf(robot).branches) {
    compute(b, positionsOf(b, q, q_b), of_branch);
    addMatrix(b, of_branch, sum);
  }
}

void inertia(const Robot& robot, int /*structure*/, const double* q, Matrices H) {
  sumOfMatrices(robot, q, H, [](const FastBranch& b, const double* q_b, double* H_b) {
    b.fast->inertiaMatrix(q_b, H_b, jointsOf(b));
  });
  addToDiagonal(branchesOf(robot).model->motor_inertia, H);
}

void components(const Robot& robot, int /*structure*/, const double* q, const double* qd,
                Matrices H, double* c, double* g) {
  const FastBranches& all = branchesOf(robot);
  Numbers q_b, qd_b, c_b, g_b, sum_c{}, sum_g{};  // c and g may stand where inputs do
  double H_b[kMost * kMost];
  setZero(H, robot.joints, robot.joints);
  addSprings(all, q, sum_g.numbers);
  for (const FastBranch& b : all.branches) {
    b.fast->dynamicComponents(positionsOf(b, q, q_b), motionOf(b, qd, qd_b), H_b, jointsOf(b),
                              c_b.numbers, g_b.numbers);
    addMatrix(b, H_b, H);
    add(b, c_b.numbers, sum_c.numbers);
    add(b, g_b.numbers, sum_g.numbers);
  }
  addToDiagonal(all.model->motor_inertia, H);
  std::copy_n(sum_c.numbers, robot.joints, c);
  std::copy_n(sum_g.numbers, robot.joints, g);
}

/// x = H^-1 x for symmetric H, whose lower triangle is overwritten: H = L' D L from the last row to the
/// first, as in fast/linear_solve.hpp.
void solveSymmetric(Index n, double* H, double* x) {
  for (Index k = n - 1; k >= 0; --k) {
    double* const row_k = H + k * n;
    const double inverse_D = 1 / row_k[k];
    for (Index i = 0; i < k; ++i) {
      const double factor = row_k[i] * inverse_D;
      for (Index j = 0; j <= i; ++j) H[i * n + j] -= factor * row_k[j];
      x[i] -= factor * x[k];
    }
    row_k[k] = inverse_D;
  }
  for (Index k = 0; k < n; ++k) {
    for (Index j = 0; j < k; ++j) x[k] -= H[k * n + j] * x[j];
    x[k] *= H[k * n + k];
  }
}

void forwardDynamics(const Robot& robot, int structure, const double* q, const double* qd,
                     const double* tau, double* qdd) {
  const Index n = robot.joints;
  const Numbers at_rest{};
  Numbers left;  // of the torques: what accelerates
  double H[kMost * kMost];
  torques(robot, structure, q, qd, at_rest.numbers, left.numbers);
  for (Index j = 0; j < n; ++j) left.numbers[j] = tau[j] - left.numbers[j];
  inertia(robot, structure, q, {H, 1, n, 0});
  solveSymmetric(n, H, left.numbers);
  std::copy_n(left.numbers, n, qdd);
}

void regressor(const Robot& robot, const double* q, const double* qd, const double* qdd, double* Y,
               std::ptrdiff_t outer_step) {
  constexpr Index kOnStack = Index{10} * 32 * 32;
  Numbers q_b, qd_b, qdd_b;
  const FastBranches& all = branchesOf(robot);
  setZero({Y, 1, outer_step, 0}, robot.joints, 10 * Index{all.links});
  for (const FastBranch& b : all.branches) {
    const Index m = jointsOf(b);
    Scratch<double, kOnStack> Y_b(10 * m * m);
    b.fast->regressor(positionsOf(b, q, q_b), motionOf(b, qd, qd_b), motionOf(b, qdd, qdd_b),
                      &Y_b[0], m);
    for (const int i : b.own) {
      const Index link = b.branch.link[static_cast<std::size_t>(i)];
      for (Index column = 0; column < 10; ++column) {
        add(b, &Y_b[(10 * i + column) * m], Y + (10 * link + column) * outer_step);
      }
    }
  }
}

/// Of all but friction. A function of its own, whose stack is free before that of friction is needed.
[[gnu::noinline]] void torqueDerivativesOfBodies(const FastBranches& all, const double* q,
                                                 const double* qd, const double* qdd,
                                                 const Matrices (&sums)[3]) {
  Numbers q_b, qd_b, qdd_b;
  double of_branch[3][kMost * kMost];
  for (const Matrices& sum : sums) setZero(sum, all.joints, all.joints);
  for (const FastBranch& b : all.branches) {
    b.fast->torqueDerivatives(positionsOf(b, q, q_b), motionOf(b, qd, qd_b),
                              motionOf(b, qdd, qdd_b), of_branch[0], of_branch[1], of_branch[2],
                              jointsOf(b));
    for (int k = 0; k < 3; ++k) addMatrix(b, of_branch[k], sums[k]);
  }
  for (Index j = 0; j < springCount(*all.model); ++j) {
    sums[0].data[j * (sums[0].row_step + sums[0].column_step)] += springSlope(*all.model, j, q);
  }
  addToDiagonal(all.model->motor_inertia, sums[2]);
}

void torqueDerivatives(const Robot& robot, int /*structure*/, const double* q, const double* qd,
                       const double* qdd, double* by_q, double* by_qd, double* by_qdd,
                       std::ptrdiff_t outer_step) {
  const Index n = robot.joints;
  const FastBranches& all = branchesOf(robot);
  torqueDerivativesOfBodies(
      all, q, qd, qdd,
      {{by_q, 1, outer_step, 0}, {by_qd, 1, outer_step, 0}, {by_qdd, 1, outer_step, 0}});
  chain_dynamics::addFrictionDerivatives(*all.model, ConstMap(q, n), ConstMap(qd, n),
                                         MatrixMap(by_q, n, n, Eigen::OuterStride<>(outer_step)),
                                         MatrixMap(by_qd, n, n, Eigen::OuterStride<>(outer_step)));
}

void coriolisMatrix(const Robot& robot, int /*structure*/, const double* q, const double* qd,
                    double* C, std::ptrdiff_t outer_step) {
  Numbers qd_b;
  const auto compute = [&](const FastBranch& b, const double* q_b, double* C_b) {
    b.fast->coriolisMatrix(q_b, motionOf(b, qd, qd_b), C_b, jointsOf(b));
  };
  sumOfMatrices(robot, q, {C, 1, outer_step, 0}, compute);
}

// The tip is that of the first branch.

void tipPose(const Robot& robot, int /*structure*/, const double* q, double* R, double* p) {
  Numbers q_b;
  const FastBranch& b = branchesOf(robot).branches.front();
  b.fast->tipPose(positionsOf(b, q, q_b), R, p);
}

/// `J_b S`.
void toCoordinates(const FastBranch& b, Index n, const double* J_b, double* J,
                   std::ptrdiff_t outer_step) {
  setZero({J, 1, outer_step, 0}, 6, n);
  for (const Follow& entry : b.branch.S) {
    for (Index i = 0; i < 6; ++i) {
      J[entry.coordinate * outer_step + i] += entry.factor * J_b[6 * entry.joint + i];
    }
  }
}

void tipJacobian(const Robot& robot, int /*structure*/, const double* q, double* J,
                 std::ptrdiff_t outer_step) {
  Numbers q_b;
  double J_b[6 * kMost];
  const FastBranch& b = branchesOf(robot).branches.front();
  b.fast->tipJacobian(positionsOf(b, q, q_b), J_b, 6);
  toCoordinates(b, robot.joints, J_b, J, outer_step);
}

void tipJacobianDerivative(const Robot& robot, int /*structure*/, const double* q, const double* qd,
                           double* dJ, std::ptrdiff_t outer_step) {
  Numbers q_b, qd_b;
  double dJ_b[6 * kMost];
  const FastBranch& b = branchesOf(robot).branches.front();
  b.fast->tipJacobianDerivative(positionsOf(b, q, q_b), motionOf(b, qd, qd_b), dJ_b, 6);
  toCoordinates(b, robot.joints, dJ_b, dJ, outer_step);
}

int structureOf(const Robot& /*robot*/) { return 0; }

/// Entry (row, column) of S is one, and it is the only one of its row; s is zero.
bool isSelection(const Branch& branch) {
  const auto m = static_cast<std::size_t>(branch.chain.jointCount());
  std::vector<int> entries(m, 0);
  for (const Follow& entry : branch.S) ++entries[static_cast<std::size_t>(entry.joint)];
  return std::all_of(entries.begin(), entries.end(), [](int count) { return count == 1; }) &&
         std::all_of(branch.S.begin(), branch.S.end(),
                     [](const Follow& entry) { return entry.factor == 1; }) &&
         std::all_of(branch.s.begin(), branch.s.end(), [](double s) { return s == 0; });
}

}  // namespace
}  // namespace kernel_sums

FastBranch::FastBranch(const Branch& of, std::unique_ptr<const FastModel> made)
    : branch(of), fast(std::move(made)) {
  if (!kernel_sums::isSelection(of)) return;
  coordinates.resize(of.S.size());
  for (const Follow& entry : of.S) {
    coordinates[static_cast<std::size_t>(entry.joint)] = static_cast<int>(entry.coordinate);
  }
}

fast::Kernels branchKernels(const char* instruction_set) {
  using namespace kernel_sums;  // NOLINT(google-build-using-namespace)
  return {instruction_set,
          structureOf,
          kernel_sums::torques,
          coriolis,
          gravity,
          inertia,
          components,
          kernel_sums::friction,
          kernel_sums::forwardDynamics,
          kernel_sums::regressor,
          kernel_sums::torqueDerivatives,
          kernel_sums::coriolisMatrix,
          kernel_sums::tipPose,
          kernel_sums::tipJacobian,
          kernel_sums::tipJacobianDerivative};
}

}  // namespace v2
}  // namespace chain_dynamics
