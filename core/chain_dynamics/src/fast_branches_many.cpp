// SPDX-License-Identifier: Apache-2.0

// Many states.

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <memory>
#include <vector>

#include "branch_sums.hpp"
#include "chain_dynamics/states.hpp"
#include "fast_branches.hpp"
#include "springs.hpp"

namespace chain_dynamics {
inline namespace v2 {
namespace kernel_sums {
namespace {

using fast::Samples;
using kernel_sums::setZero;  // and of states

const fast::Kernels kOne = branchKernels("");  // of one state

/// Numbers of as many states as are computed at a time: 8 KiB.
constexpr std::ptrdiff_t kBlockNumbers = 1024;
constexpr std::ptrdiff_t kBlockStates = 64;

/// Numbers of a block of states: joint j of state k at [j kBlockStates + k].
struct Block {
  double numbers[kBlockNumbers];
};

/// States that are computed at a time: fewer where a block of each joint would take more memory.
std::ptrdiff_t blockStates(const Robot& robot) {
  Index most = robot.joints;
  for (const FastBranch& b : branchesOf(robot).branches) most = std::max(most, jointsOf(b));
  return std::min<std::ptrdiff_t>(kBlockStates, kBlockNumbers / most / 8 * 8);
}

/// The same where a matrix of each state takes room, too.
std::ptrdiff_t matrixStates(const Robot& robot) {
  Index most = 1;
  for (const FastBranch& b : branchesOf(robot).branches) most = std::max(most, jointsOf(b));
  const std::ptrdiff_t fitting = kMost * kMost / (most * most);
  return std::min(blockStates(robot), fitting < 8 ? fitting : fitting / 8 * 8);
}

/// The states of a block of numbers, which don't stand in caller's memory.
States statesOf(Block& block, Index joints, Index count, std::ptrdiff_t step) {
  return {block.numbers, joints, count, step, 1};
}

/// `S x` of `count` states from the first on, and s where x are positions.
ConstStates motionOf(const FastBranch& b, const Samples& x, std::ptrdiff_t first, Index count,
                     std::ptrdiff_t step, bool are_positions, Block& memory) {
  const States to = statesOf(memory, jointsOf(b), count, step);
  for (Index i = 0; i < to.joints; ++i) {
    const double start = are_positions ? b.branch.s[static_cast<std::size_t>(i)] : 0;
    if (b.coordinates.empty()) std::fill_n(&to(i, 0), count, start);
  }
  for (const Follow& entry : b.branch.S) {
    const double* const from = x.data + entry.coordinate * x.joint_step + first * x.state_step;
    double* const joint = &to(entry.joint, 0);
    if (b.coordinates.empty()) {
      for (Index k = 0; k < count; ++k) joint[k] += entry.factor * from[k * x.state_step];
    } else {
      for (Index k = 0; k < count; ++k) joint[k] = from[k * x.state_step];
    }
  }
  return to;
}

/// `sum += S' of_branch`.
void add(const FastBranch& b, const States& of_branch, const States& sum) {
  for (const Follow& entry : b.branch.S) {
    const double* const from = &of_branch(entry.joint, 0);
    double* const to = &sum(entry.coordinate, 0);
    if (b.coordinates.empty()) {
      for (Index k = 0; k < sum.count; ++k) to[k] += entry.factor * from[k];
    } else {
      for (Index k = 0; k < sum.count; ++k) to[k] += from[k];
    }
  }
}

void write(const States& block, const Samples& to, std::ptrdiff_t first) {
  for (Index j = 0; j < block.joints; ++j) {
    double* const joint = to.data + j * to.joint_step + first * to.state_step;
    for (Index k = 0; k < block.count; ++k) joint[k * to.state_step] = block(j, k);
  }
}

/// A block of the samples, in place.
ConstStates part(const Samples& x, Index joints, std::ptrdiff_t first, Index count) {
  return {x.data + first * x.state_step, joints, count, x.joint_step, x.state_step};
}

/// Adds the sum over the branches of what compute(branch, positions and motions of its joints, result)
/// gives, of the states from `first` on.
///
/// @param x  positions, then velocities and accelerations where `compute` reads them.
template <std::size_t Count, class Compute>
void addBranches(const Robot& robot, const Samples (&x)[Count], std::ptrdiff_t first,
                 const States& sum, const Compute& compute) {
  Block memory[Count], result;
  const std::ptrdiff_t step = sum.joint_step;
  for (const FastBranch& b : branchesOf(robot).branches) {
    const ConstStates none(nullptr, 0, 0, 1, 0);
    ConstStates x_b[] = {none, none, none};
    for (std::size_t i = 0; i < Count; ++i) {
      x_b[i] = motionOf(b, x[i], first, sum.count, step, i == 0, memory[i]);
    }
    const States of_branch = statesOf(result, jointsOf(b), sum.count, step);
    compute(*b.fast, x_b, of_branch);
    add(b, of_branch, sum);
  }
}

/// The sum of all states, to which start(first, sum) gives its first values.
template <std::size_t Count, class Compute, class Start>
void sumOfBranches(const Robot& robot, std::ptrdiff_t states, const Samples (&x)[Count],
                   const Samples& to, const Compute& compute, const Start& start) {
  const std::ptrdiff_t size = blockStates(robot);
  Block memory;
  for (std::ptrdiff_t first = 0; first < states; first += size) {
    const States sum = statesOf(memory, robot.joints, std::min(size, states - first), size);
    start(first, sum);
    addBranches(robot, x, first, sum, compute);
    write(sum, to, first);
  }
}

void setZero(const States& sum) { std::fill_n(sum.data, sum.joints * sum.joint_step, 0.0); }

/// `sum += numbers_j (x_j - origin_j)` of the states from `first` on.
void addProducts(const OwnedVector& numbers, const Samples& x, const OwnedVector* origin,
                 std::ptrdiff_t first, const States& sum) {
  for (Index j = 0; j < numbers.size(); ++j) {
    if (numbers[j] == 0) continue;
    const double* const from = x.data + j * x.joint_step + first * x.state_step;
    const double start = origin != nullptr ? (*origin)[j] : 0;
    for (Index k = 0; k < sum.count; ++k)
      sum(j, k) += numbers[j] * (from[k * x.state_step] - start);
  }
}

/// Adds the torques of springs and levers in the states from `first` on.
void addSprings(const Model& model, const Samples& q, std::ptrdiff_t first, const States& sum) {
  addProducts(model.stiffness, q, &model.rest, first, sum);
  for (Index j = 0; j < model.levers.cols(); ++j) {
    if (!hasLever(model, j)) continue;
    const double* const from = q.data + j * q.joint_step + first * q.state_step;
    for (Index k = 0; k < sum.count; ++k) {
      const double angle = from[k * q.state_step];
      sum(j, k) += model.levers(0, j) * std::sin(angle) + model.levers(1, j) * std::cos(angle);
    }
  }
}

/// The states from `first` on.
Samples from(const Samples& x, std::ptrdiff_t first) {
  return {x.data + first * x.state_step, x.joint_step, x.state_step};
}

void frictionMany(const Robot& robot, int structure, std::ptrdiff_t states, Samples q, Samples qd,
                  Samples f) {
  const FastBranches& all = branchesOf(robot);
  const Index n = robot.joints;
  if (all.friction_alone) {
    all.friction_alone->frictionVectorBatch(part(q, n, 0, states), part(qd, n, 0, states),
                                            {f.data, n, states, f.joint_step, f.state_step});
    return;
  }
  Numbers q_k{}, qd_k, f_k;
  for (std::ptrdiff_t k = 0; k < states; ++k) {
    for (Index j = 0; j < n; ++j) {
      if (robot.load_friction) q_k.numbers[j] = q.data[j * q.joint_step + k * q.state_step];
      qd_k.numbers[j] = qd.data[j * qd.joint_step + k * qd.state_step];
    }
    kOne.friction(robot, structure, q_k.numbers, qd_k.numbers, f_k.numbers);
    for (Index j = 0; j < n; ++j) f.data[j * f.joint_step + k * f.state_step] = f_k.numbers[j];
  }
}

void torquesMany(const Robot& robot, int structure, std::ptrdiff_t states, Samples q, Samples qd,
                 Samples qdd, Samples tau) {
  const Model& model = *branchesOf(robot).model;
  const auto compute = [](const FastModel& fast, const ConstStates* x, const States& tau_b) {
    fast.torquesBatch(x[0], x[1], x[2], tau_b);
  };
  const auto start = [&](std::ptrdiff_t first, const States& sum) {
    if (model.friction.empty()) {
      setZero(sum);
    } else {
      frictionMany(robot, structure, sum.count, from(q, first), from(qd, first),
                   {sum.data, sum.joint_step, sum.state_step});
    }
    addSprings(model, q, first, sum);
    addProducts(model.motor_inertia, qdd, nullptr, first, sum);
  };
  sumOfBranches(robot, states, {q, qd, qdd}, tau, compute, start);
}

void coriolisMany(const Robot& robot, int /*structure*/, std::ptrdiff_t states, Samples q,
                  Samples qd, Samples c) {
  const auto compute = [](const FastModel& fast, const ConstStates* x, const States& c_b) {
    fast.coriolisVectorBatch(x[0], x[1], c_b);
  };
  const auto start = [](std::ptrdiff_t /*first*/, const States& sum) { setZero(sum); };
  sumOfBranches(robot, states, {q, qd}, c, compute, start);
}

void gravityMany(const Robot& robot, int /*structure*/, std::ptrdiff_t states, Samples q,
                 Samples g) {
  const Model& model = *branchesOf(robot).model;
  const auto compute = [](const FastModel& fast, const ConstStates* x, const States& g_b) {
    fast.gravityVectorBatch(x[0], g_b);
  };
  const auto start = [&](std::ptrdiff_t first, const States& sum) {
    setZero(sum);
    addSprings(model, q, first, sum);
  };
  sumOfBranches(robot, states, {q}, g, compute, start);
}

// ---------------------------------------------------------------------------------------------
// Many states, one after the other

/// The numbers of state k.
const double* stateOf(const Samples& x, Index joints, std::ptrdiff_t k, Numbers& memory) {
  for (Index j = 0; j < joints; ++j) {
    memory.numbers[j] = x.data[j * x.joint_step + k * x.state_step];
  }
  return memory.numbers;
}

Matrices ofState(const Matrices& all, std::ptrdiff_t k) {
  return {all.data + k * all.state_step, all.row_step, all.column_step, all.state_step};
}

/// Copies columns that stand one after the other.
void write(const double* columns, Index rows, Index count, const Matrices& to) {
  for (Index j = 0; j < count; ++j) {
    for (Index i = 0; i < rows; ++i) {
      to.data[i * to.row_step + j * to.column_step] = columns[j * rows + i];
    }
  }
}

/// H of all states and, where they aren't null, c and g. In one pass, by as many states as leave room for
/// their matrices.
void componentsMany(const Robot& robot, int /*structure*/, std::ptrdiff_t states, Samples q,
                    Samples qd, Matrices H, Samples c, Samples g) {
  const FastBranches& all = branchesOf(robot);
  const Index n = robot.joints;
  const bool all_terms = c.data != nullptr;
  const std::ptrdiff_t size = matrixStates(robot);
  Block q_b, qd_b, c_b, g_b, sum_c, sum_g;  // c and g may stand where inputs do
  double H_b[kMost * kMost];
  for (std::ptrdiff_t first = 0; first < states; first += size) {
    const std::ptrdiff_t count = std::min(size, states - first);
    const States c_all = statesOf(sum_c, n, count, size), g_all = statesOf(sum_g, n, count, size);
    for (Index k = 0; k < count; ++k) setZero(ofState(H, first + k), n, n);
    setZero(c_all);
    setZero(g_all);
    addSprings(*all.model, q, first, g_all);
    for (const FastBranch& b : all.branches) {
      const Index m = jointsOf(b);
      const ConstStates x = motionOf(b, q, first, count, size, true, q_b);
      const StridedMatrices of_branch(H_b, m, m, count, 1, m, m * m);
      if (all_terms) {
        const ConstStates v = motionOf(b, qd, first, count, size, false, qd_b);
        const States c_of = statesOf(c_b, m, count, size), g_of = statesOf(g_b, m, count, size);
        b.fast->dynamicComponentsBatch(x, v, of_branch, c_of, g_of);
        add(b, c_of, c_all);
        add(b, g_of, g_all);
      } else {
        b.fast->inertiaMatrixBatch(x, of_branch);
      }
      for (Index k = 0; k < count; ++k) addMatrix(b, H_b + k * m * m, ofState(H, first + k));
    }
    for (Index k = 0; k < count; ++k) {
      addToDiagonal(all.model->motor_inertia, ofState(H, first + k));
    }
    if (!all_terms) continue;
    write(c_all, c, first);
    write(g_all, g, first);
  }
}

void inertiaMany(const Robot& robot, int structure, std::ptrdiff_t states, Samples q, Matrices H) {
  componentsMany(robot, structure, states, q, {}, H, {}, {});
}

void forwardDynamicsMany(const Robot& robot, int structure, std::ptrdiff_t states, Samples q,
                         Samples qd, Samples tau, Samples qdd) {
  const Index n = robot.joints;
  Numbers q_k{}, qd_k{}, tau_k{}, qdd_k{};
  for (std::ptrdiff_t k = 0; k < states; ++k) {
    kOne.forward_dynamics(robot, structure, stateOf(q, n, k, q_k), stateOf(qd, n, k, qd_k),
                          stateOf(tau, n, k, tau_k), qdd_k.numbers);
    for (Index j = 0; j < n; ++j) {
      qdd.data[j * qdd.joint_step + k * qdd.state_step] = qdd_k.numbers[j];
    }
  }
}

void regressorMany(const Robot& robot, std::ptrdiff_t states, Samples q, Samples qd, Samples qdd,
                   Matrices Y) {
  const Index n = robot.joints;
  const Index columns = 10 * Index{branchesOf(robot).links};
  std::unique_ptr<double[]> memory(new double[static_cast<std::size_t>(n * columns)]);
  Numbers q_k{}, qd_k{}, qdd_k{};
  for (std::ptrdiff_t k = 0; k < states; ++k) {
    kOne.regressor(robot, stateOf(q, n, k, q_k), stateOf(qd, n, k, qd_k), stateOf(qdd, n, k, qdd_k),
                   memory.get(), n);
    write(memory.get(), n, columns, ofState(Y, k));
  }
}

void torqueDerivativesMany(const Robot& robot, int structure, std::ptrdiff_t states, Samples q,
                           Samples qd, Samples qdd, Matrices by_q, Matrices by_qd,
                           Matrices by_qdd) {
  const Index n = robot.joints;
  Numbers q_k{}, qd_k{}, qdd_k{};
  double matrices[3][fast::kPackedMatrixJoints * fast::kPackedMatrixJoints];
  for (std::ptrdiff_t k = 0; k < states; ++k) {
    kOne.torque_derivatives(robot, structure, stateOf(q, n, k, q_k), stateOf(qd, n, k, qd_k),
                            stateOf(qdd, n, k, qdd_k), matrices[0], matrices[1], matrices[2], n);
    write(matrices[0], n, n, ofState(by_q, k));
    write(matrices[1], n, n, ofState(by_qd, k));
    write(matrices[2], n, n, ofState(by_qdd, k));
  }
}

void coriolisMatrixMany(const Robot& robot, int structure, std::ptrdiff_t states, Samples q,
                        Samples qd, Matrices C) {
  const Index n = robot.joints;
  Numbers q_k{}, qd_k{};
  double matrix[fast::kPackedMatrixJoints * fast::kPackedMatrixJoints];
  for (std::ptrdiff_t k = 0; k < states; ++k) {
    kOne.coriolis_matrix(robot, structure, stateOf(q, n, k, q_k), stateOf(qd, n, k, qd_k), matrix,
                         n);
    write(matrix, n, n, ofState(C, k));
  }
}

void tipPoseMany(const Robot& robot, int structure, std::ptrdiff_t states, Samples q, Matrices R,
                 Samples p) {
  Numbers q_k{};
  double R_k[9], p_k[3];
  for (std::ptrdiff_t k = 0; k < states; ++k) {
    kOne.tip_pose(robot, structure, stateOf(q, robot.joints, k, q_k), R_k, p_k);
    write(R_k, 3, 3, ofState(R, k));
    for (Index i = 0; i < 3; ++i) p.data[i * p.joint_step + k * p.state_step] = p_k[i];
  }
}

void tipJacobianMany(const Robot& robot, int structure, std::ptrdiff_t states, Samples q,
                     Matrices J) {
  Numbers q_k{};
  double J_k[6 * kMost];
  for (std::ptrdiff_t k = 0; k < states; ++k) {
    kOne.tip_jacobian(robot, structure, stateOf(q, robot.joints, k, q_k), J_k, 6);
    write(J_k, 6, robot.joints, ofState(J, k));
  }
}

void tipJacobianDerivativeMany(const Robot& robot, int structure, std::ptrdiff_t states, Samples q,
                               Samples qd, Matrices dJ) {
  Numbers q_k{}, qd_k{};
  double dJ_k[6 * kMost];
  for (std::ptrdiff_t k = 0; k < states; ++k) {
    kOne.tip_jacobian_derivative(robot, structure, stateOf(q, robot.joints, k, q_k),
                                 stateOf(qd, robot.joints, k, qd_k), dJ_k, 6);
    write(dJ_k, 6, robot.joints, ofState(dJ, k));
  }
}

/// The square root of the weight of a joint's row.
double scaleOf(const fast::GramInputs& inputs, Index joint, std::ptrdiff_t state) {
  if (inputs.weights == nullptr) return 1;
  const Samples& weights = *inputs.weights;
  return std::sqrt(weights.data[joint * weights.joint_step + state * weights.state_step]);
}

/// Rows of one state of all joints times a scale, each to state `k` of its panel of kGramStates rows:
/// the links that it moves.
void writeLinks(const FastBranches& robot, const Eigen::MatrixXd& Y, const fast::GramInputs& inputs,
                std::ptrdiff_t state, Index k, double* panels) {
  for (Index j = 0; j < robot.joints; ++j) {
    const std::vector<int>& moved = robot.moved[static_cast<std::size_t>(j)];
    const std::ptrdiff_t size = fast::linksRow(static_cast<int>(moved.size()), 0);
    const double scale = scaleOf(inputs, j, state);
    double* to = panels + k * size;
    for (const int link : moved) {
      for (Index c = 0; c < 10; ++c) *to++ = scale * Y(j, 10 * link + c);
    }
    panels += fast::kGramStates * size;
  }
}

/// The same of own columns and torque.
void writeOwn(const FastBranches& robot, const fast::GramInputs& inputs, std::ptrdiff_t state,
              Index k, double* panels) {
  const std::ptrdiff_t size = fast::ownRow(inputs.column_count);
  for (Index j = 0; j < robot.joints; ++j, panels += fast::kGramStates * size) {
    const double scale = scaleOf(inputs, j, state);
    for (int c = 0; c <= inputs.column_count; ++c) {
      const Samples& from = c < inputs.column_count ? inputs.columns[c] : inputs.tau;
      panels[k * size + c] = scale * from.data[j * from.joint_step + state * from.state_step];
    }
  }
}

/// Adds the products of the numbers of `states` rows: the upper triangle of sums that stand row by row
/// is the lower one of their columns.
void addProducts(const FastBranches& robot, Index states, const fast::GramInputs& inputs,
                 const double* links, const double* own, double* sums) {
  const Index of_own = fast::ownRow(inputs.column_count);
  for (Index j = 0; j < robot.joints; ++j) {
    const Index of_links =
        fast::linksRow(static_cast<int>(robot.moved[static_cast<std::size_t>(j)].size()), 0);
    const Index size = of_own + of_links;
    const Eigen::Map<const Eigen::MatrixXd> A(own, of_own, states), B(links, of_links, states);
    Eigen::Map<Eigen::MatrixXd> sum(sums, size, size);
    sum.topLeftCorner(of_own, of_own).selfadjointView<Eigen::Lower>().rankUpdate(A);
    sum.bottomLeftCorner(of_links, of_own).noalias() += B * A.transpose();
    if (inputs.links) {
      sum.bottomRightCorner(of_links, of_links).selfadjointView<Eigen::Lower>().rankUpdate(B);
    }
    own += fast::kGramStates * of_own;
    links += fast::kGramStates * of_links;
    sums += size * size;
  }
}

void gramMany(const Robot& of, std::ptrdiff_t states, const fast::GramInputs& inputs,
              const fast::GramMemory& to) {
  const FastBranches& robot = branchesOf(of);
  const Index n = robot.joints;
  Eigen::MatrixXd Y(n, 10 * robot.links);
  Numbers q{}, qd{}, qdd{};
  std::ptrdiff_t part_size = 0;
  for (const std::vector<int>& moved : robot.moved) {
    part_size += fast::kGramStates * fast::linksRow(static_cast<int>(moved.size()), 0);
  }
  for (std::ptrdiff_t part = 0, first = 0; first < states; ++part, first += fast::kGramStates) {
    const auto count = std::min<std::ptrdiff_t>(fast::kGramStates, states - first);
    double* const made = to.links + (to.keep ? part * part_size : 0);
    for (std::ptrdiff_t k = 0; k < count; ++k) {
      const std::ptrdiff_t state = first + k;
      writeOwn(robot, inputs, state, k, to.own);
      if (inputs.rows != nullptr) continue;
      kOne.regressor(robot, stateOf(inputs.q, n, state, q), stateOf(inputs.qd, n, state, qd),
                     stateOf(inputs.qdd, n, state, qdd), Y.data(), n);
      writeLinks(robot, Y, inputs, state, k, made);
    }
    addProducts(robot, count, inputs,
                inputs.rows != nullptr ? inputs.rows + part * part_size : made, to.own, to.sums);
  }
}

}  // namespace
}  // namespace kernel_sums

fast::ManyKernels manyBranchKernels() {
  using namespace kernel_sums;  // NOLINT(google-build-using-namespace)
  return {torquesMany,
          coriolisMany,
          gravityMany,
          inertiaMany,
          componentsMany,
          frictionMany,
          forwardDynamicsMany,
          regressorMany,
          torqueDerivativesMany,
          coriolisMatrixMany,
          tipPoseMany,
          tipJacobianMany,
          tipJacobianDerivativeMany,
          gramMany,
          nullptr};
}

}  // namespace v2
}  // namespace chain_dynamics
