// SPDX-License-Identifier: Apache-2.0

/// @file
/// The dynamics of a Model, about ten times as fast as the functions of model.hpp, for double.
///
///     const FastModel fast(model);                                     // once: allocates
///     fast.torques(q.data(), qd.data(), qdd.data(), tau.data());       // friction included
///     fast.torquesBatch(Q, QD, QDD, TAU);                              // n x N each [states.hpp]
///
/// The same recursions as in torques.hpp, inertia_matrix.hpp and gravity_vector.hpp, with what can
/// be done once done once [docs/speed.md]: frames whose placements have few numbers, inertial
/// parameters without those that torques don't depend on, and kernels compiled for the processor
/// and, for the usual arms, for their right angles. Results differ from the functions of model.hpp
/// by rounding only.

#pragma once

#ifdef CHAIN_DYNAMICS_WITHOUT_MODELS
#error "chain_dynamics was built without models: build it with -DCHAIN_DYNAMICS_MODELS=ON"
#endif

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "chain_dynamics/model.hpp"
#include "chain_dynamics/regressor_gram.hpp"
#include "chain_dynamics/states.hpp"

namespace chain_dynamics {
inline namespace v2 {

namespace fast {
struct Kernels;
struct ManyKernels;
struct Robot;
}  // namespace fast

/// A model made ready for the fast kernels. Of a mechanism [mechanism.hpp] the tip is that of the first
/// branch.
///
/// Up to kMaxJoints joints. Real time: no method but the constructor, emptyGram(), addToGram(),
/// torqueDerivativesBatch() and coriolisMatrixBatch() allocates, locks or throws; of a mechanism also
/// regressorBatch(), and regressor() where a branch has more than 32 joints. One state needs up to 48 KiB
/// of stack, many states up to 112 KiB; of a mechanism or springs 160 KiB [docs/real_time.md]. Threads:
/// safe. NaN gives NaN in every entry that depends on it. A vector may be written where one of the inputs
/// stands (tau where q does, of many states in the same layout); otherwise outputs overlap no input.
class FastModel {
 public:
  /// Longest chain.
  static constexpr Eigen::Index kMaxJoints = 64;

  /// Instruction sets that this processor and this build both have, the best last: "portable", and
  /// on x86-64 "v3" (AVX2, FMA) and "v4" (AVX-512).
  static std::vector<std::string> instructionSets();

  /// @param model            at most kMaxJoints joints; checkModel() is called.
  /// @param instruction_set  one of instructionSets(); empty: the best of those that give what
  ///     the functions of model.hpp give, to eight digits, at a few states.
  /// @throws ModelError  longer chain, unknown instruction set, parts that don't fit together, or
  ///     no instruction set that gives these numbers (because they overflow).
  explicit FastModel(const Model& model, const std::string& instruction_set = "");

  /// A model with other parameters, gravity or friction than `original` was made from, with its
  /// instruction set: in microseconds, as nothing is compared with the functions of model.hpp.
  ///
  /// @throws ModelError  another number of joints, parts that don't fit together.
  FastModel(const Model& changed, const FastModel& original);
  ~FastModel();
  FastModel(const FastModel&) = delete;
  FastModel& operator=(const FastModel&) = delete;

  /// Whether friction depends on the gravity torques, and so on q.
  bool frictionDependsOnLoad() const;

  /// Number of links, which regressor() has ten columns each of: of a chain n, of a mechanism linkCount()
  /// of its branches.
  Eigen::Index linkCount() const;

  /// The instruction set in use.
  std::string instructionSet() const;

  /// A sentence for each better instruction set that isn't used, as its numbers differ.
  const std::vector<std::string>& warnings() const { return warnings_; }

  /// @name One state
  /// n numbers each; H: entry (i, j) at H[i + j * outer_step].
  /// @{

  /// `tau = H(q) qdd + C(q, qd) qd + g(q) + f(q, qd)`.
  void torques(const double* q, const double* qd, const double* qdd, double* tau) const;
  /// `H(q)`.
  void inertiaMatrix(const double* q, double* H, std::ptrdiff_t outer_step) const;
  /// `C(q, qd) qd`.
  void coriolisVector(const double* q, const double* qd, double* c) const;
  /// `g(q)`.
  void gravityVector(const double* q, double* g) const;
  /// `f(q, qd)`. q may be null where frictionDependsOnLoad() is false.
  void frictionVector(const double* q, const double* qd, double* f) const;
  /// `H(q)`, `C(q, qd) qd`, `g(q)`.
  void dynamicComponents(const double* q, const double* qd, double* H, std::ptrdiff_t outer_step,
                         double* c, double* g) const;
  /// `qdd` of given torques, friction taken off: the inverse of torques().
  ///
  /// Solves the equation of motion by `H = L' D L` [Featherstone 2008, sec. 6.5], with row parameters
  /// by elimination. Where no rigid bodies have the parameters [Chain::warnings()], the result still
  /// solves the equation, but describes no motion of a robot. A joint that moves neither mass nor rotor
  /// inertia (H singular) gives infinity or NaN, no error.
  void forwardDynamics(const double* q, const double* qd, const double* tau, double* qdd) const;
  /// `Y(q, qd, qdd)` of regressor.hpp, n x 10 linkCount(): of rigid bodies, whatever parameters and friction
  /// the model has. Entry (i, j) at Y[i + j * outer_step].
  void regressor(const double* q, const double* qd, const double* qdd, double* Y,
                 std::ptrdiff_t outer_step) const;
  /// `dtau/dq`, `dtau/dqd` and `dtau/dqdd = H(q)` of torques(), those of friction included
  /// [addFrictionDerivatives() in model.hpp]: n x n each, entry (i, j), of tau_i by joint j, at
  /// [i + j * outer_step].
  void torqueDerivatives(const double* q, const double* qd, const double* qdd, double* dtau_dq,
                         double* dtau_dqd, double* dtau_dqdd, std::ptrdiff_t outer_step) const;
  /// `C(q, qd)` of coriolis_matrix.hpp: entry (i, j) at C[i + j * outer_step].
  void coriolisMatrix(const double* q, const double* qd, double* C,
                      std::ptrdiff_t outer_step) const;
  /// Pose of the tip in the root frame: the 9 entries of R column by column, the 3 of p.
  void tipPose(const double* q, double* R, double* p) const;
  /// `J(q)` of tip_kinematics.hpp, 6 x n: entry (i, j) at J[i + j * outer_step].
  void tipJacobian(const double* q, double* J, std::ptrdiff_t outer_step) const;
  /// `dJ/dt`, likewise.
  void tipJacobianDerivative(const double* q, const double* qd, double* dJ,
                             std::ptrdiff_t outer_step) const;
  /// @}

  /// @name Many states
  /// As many as the first argument has; n joints each. The numbers of a state don't depend on its
  /// place among the others.
  /// @{
  void torquesBatch(ConstStates q, ConstStates qd, ConstStates qdd, States tau) const;
  void inertiaMatrixBatch(ConstStates q, StridedMatrices H) const;
  void coriolisVectorBatch(ConstStates q, ConstStates qd, States c) const;
  void gravityVectorBatch(ConstStates q, States g) const;
  /// q may be 0 x N where frictionDependsOnLoad() is false.
  void frictionVectorBatch(ConstStates q, ConstStates qd, States f) const;
  void dynamicComponentsBatch(ConstStates q, ConstStates qd, StridedMatrices H, States c,
                              States g) const;
  /// As forwardDynamics().
  void forwardDynamicsBatch(ConstStates q, ConstStates qd, ConstStates tau, States qdd) const;
  /// As torqueDerivatives(). Allocates for more than 16 joints.
  void torqueDerivativesBatch(ConstStates q, ConstStates qd, ConstStates qdd,
                              StridedMatrices dtau_dq, StridedMatrices dtau_dqd,
                              StridedMatrices dtau_dqdd) const;
  /// As coriolisMatrix(). Allocates for more than 16 joints.
  void coriolisMatrixBatch(ConstStates q, ConstStates qd, StridedMatrices C) const;
  /// R: 3 x 3 each; p: 3 numbers each.
  void tipPoseBatch(ConstStates q, StridedMatrices R, States p) const;
  /// 6 x n each.
  void tipJacobianBatch(ConstStates q, StridedMatrices J) const;
  void tipJacobianDerivativeBatch(ConstStates q, ConstStates qd, StridedMatrices dJ) const;
  /// As regressor(); n x 10 linkCount() each. Allocates where the robot is a mechanism.
  void regressorBatch(ConstStates q, ConstStates qd, ConstStates qdd, StridedMatrices Y) const;
  /// Gram matrices of this robot, without samples. Allocates.
  ///
  /// @throws ModelError  a negative number of columns.
  RegressorGram emptyGram(Eigen::Index own_columns = 0) const;
  /// Adds samples to the Gram matrices of the regressor's rows [regressor_gram.hpp].
  ///
  /// @throws ModelError  another number of joints, samples or columns; sums of another robot.
  void addToGram(const GramSamples& samples, RegressorGram& gram) const;
  /// @}

 private:
  struct Data;
  const fast::Robot& robot() const;
  void use(const fast::Kernels& kernels, const fast::ManyKernels& many);
  void useBest(const Model& model);

  std::unique_ptr<const Data> data_;
  const fast::Kernels* kernels_ = nullptr;
  const fast::ManyKernels* many_ = nullptr;
  int structure_ = 0;  // of the kernels for joints of this kind
  std::vector<std::string> warnings_;
};

}  // namespace v2
}  // namespace chain_dynamics
