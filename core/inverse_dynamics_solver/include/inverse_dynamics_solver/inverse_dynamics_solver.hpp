// SPDX-License-Identifier: Apache-2.0
/// @file
/// The interface of all solvers: the joint torques of a robot arm's motion.
///
///     auto solver = SolverLoader().load("kdl_inverse_dynamics_solver/InverseDynamicsSolverKDL");
///     solver->initialize({{"tip", "tool0"}}, "", urdf);
///     Eigen::VectorXd tau = solver->getTorques(q, qd, qdd);   // H qdd + C qd + f + g
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "chain_dynamics/chain.hpp"
#include "inverse_dynamics_solver/configuration.hpp"
#include "inverse_dynamics_solver/exceptions.hpp"
#include "inverse_dynamics_solver/parameters.hpp"
#include "inverse_dynamics_solver/states.hpp"  // IWYU pragma: export

namespace inverse_dynamics_solver {

/// Number of the binary interface: layouts, order of virtual functions, types that functions take.
///
/// The same in all packages, and part of every name that crosses a library, so a plugin built
/// against another one is refused instead of crashing [docs/design.md]. Source code and plugin
/// descriptions leave it out.
inline namespace v2 {

using ConstVectorRef = Eigen::Ref<const Eigen::VectorXd>;
using VectorRef = Eigen::Ref<Eigen::VectorXd>;
using MatrixRef = Eigen::Ref<Eigen::MatrixXd>;

/// Base class of every solver.
///
/// Sizes and units: with n = jointCount(), q [rad], qd [rad/s], qdd [rad/s^2] have n numbers each
/// in the order of jointNames(); torques [N m], H [kg m^2]; for prismatic joints m instead of rad,
/// N instead of N m.
///
/// Every quantity comes in three forms: by value; into memory of the caller (outputs last, sized by
/// the caller, overlapping no input); for many states at once (`...Batch`: one state per column).
///
/// Inputs may be any Eigen expression. Of one state, one that isn't contiguous (a row of a matrix,
/// a sum) is copied by Eigen into a temporary, and outputs must be contiguous columns. Of many
/// states, what stands in memory is taken as it is.
///
/// All methods but initialize() throw UninitializedException before a successful initialize(), and
/// SizeMismatchException for a wrong size. A NaN in gives NaN in every entry that depends on it.
///
/// Real time (up to 64 joints): calls of one state into the caller's memory with contiguous inputs:
/// no allocation, lock or system call, and for valid calls no exception. Batches may allocate, and
/// wait for a thread that changes the robot [docs/real_time.md]. Threads: const methods are safe;
/// initialize() needs the solver for itself.
class InverseDynamicsSolver {
 public:
  virtual ~InverseDynamicsSolver() = default;
  InverseDynamicsSolver(const InverseDynamicsSolver&) = delete;
  InverseDynamicsSolver& operator=(const InverseDynamicsSolver&) = delete;

  /// Makes the solver ready, or leaves it as it was. A parameter of the namespace that the solver
  /// doesn't know gives one of warnings(), or is an error [Parameters::strict()].
  ///
  /// @param parameters         a node's parameters interface, a map, or YAML: see parameters.hpp.
  /// @param param_namespace    where the parameters of Configuration stand, for example "ids".
  /// @param robot_description  URDF text; if empty, the parameter `robot_description` without
  ///                           namespace.
  /// @throws ParameterUninitializedException, InvalidParameterValueException,
  ///   InvalidRobotDescriptionException
  void initialize(const Parameters& parameters = {}, const std::string& param_namespace = "",
                  const std::string& robot_description = "");

  /// Whether initialize() has succeeded.
  bool isInitialized() const noexcept { return initialized_; }

  /// Number n of movable joints of the chain; of a tree, of those that mimic no other.
  Eigen::Index jointCount() const;

  /// Their names, in order along the chain from root to tip, of a tree in the order of the robot
  /// description: the order of all vectors.
  const std::vector<std::string>& jointNames() const;

  /// Links that are tips, in the order of the parameter `tip`: methods that name no tip are about the
  /// first. A chain has one; its name is empty where a model file is the robot and `tip` isn't stated.
  const std::vector<std::string>& tipNames() const;

  /// How each of them moves. A driver may report a continuous joint within one turn: differences of
  /// positions go through `chain_dynamics::unwrap(solver.jointTypes(), reference, q)`.
  const std::vector<chain_dynamics::JointType>& jointTypes() const;

  /// Non-fatal warnings about the robot, one sentence each.
  const std::vector<std::string>& warnings() const;

  /// Whether H(q) is symmetric and positive definite by construction, without payloads, which may be
  /// taken away. Only then may a controller invert H or feed back through it.
  bool inertiaIsPhysical() const;

  /// @name By value
  /// @{

  /// Inertia matrix `H(q)`, n x n.
  Eigen::MatrixXd getInertiaMatrix(const ConstVectorRef& q) const {
    Eigen::MatrixXd H = squareMatrix("getInertiaMatrix", 1);
    getInertiaMatrix(q, H);
    return H;
  }
  /// Coriolis and centrifugal torques `C(q, qd) qd`.
  Eigen::VectorXd getCoriolisVector(const ConstVectorRef& q, const ConstVectorRef& qd) const {
    Eigen::VectorXd c = vector("getCoriolisVector");
    getCoriolisVector(q, qd, c);
    return c;
  }
  /// Friction torques `f(qd)`; zero where the solver has no friction model or the parameter
  /// `friction` is false. Throws SizeMismatchException where it depends on q [load_friction.hpp].
  Eigen::VectorXd getFrictionVector(const ConstVectorRef& qd) const {
    return getFrictionVector(Eigen::VectorXd(), qd);
  }
  /// Friction torques `f(q, qd)`, of any solver.
  [[nodiscard]] Eigen::VectorXd getFrictionVector(const ConstVectorRef& q,
                                                  const ConstVectorRef& qd) const {
    Eigen::VectorXd f = vector("getFrictionVector");
    getFrictionVector(q, qd, f);
    return f;
  }
  /// Gravity torques `g(q)`, those of springs included: what holds the robot still.
  Eigen::VectorXd getGravityVector(const ConstVectorRef& q) const {
    Eigen::VectorXd g = vector("getGravityVector");
    getGravityVector(q, g);
    return g;
  }
  /// Inertia matrix, Coriolis and gravity torques: `H(q)`, `C(q, qd) qd`, `g(q)`.
  std::tuple<Eigen::MatrixXd, Eigen::VectorXd, Eigen::VectorXd> getDynamicComponents(
      const ConstVectorRef& q, const ConstVectorRef& qd) const {
    Eigen::MatrixXd H = squareMatrix("getDynamicComponents", 1);
    Eigen::VectorXd c(H.rows()), g(H.rows());
    getDynamicComponents(q, qd, H, c, g);
    return {std::move(H), std::move(c), std::move(g)};
  }
  /// Another name of getDynamicComponents().
  std::tuple<Eigen::MatrixXd, Eigen::VectorXd, Eigen::VectorXd> getDynamicParameters(
      const ConstVectorRef& q, const ConstVectorRef& qd) const {
    return getDynamicComponents(q, qd);
  }
  /// Joint torques `tau = H(q) qdd + C(q, qd) qd + f(q, qd) + g(q)`.
  Eigen::VectorXd getTorques(const ConstVectorRef& q, const ConstVectorRef& qd,
                             const ConstVectorRef& qdd) const {
    Eigen::VectorXd tau = vector("getTorques");
    getTorques(q, qd, qdd, tau);
    return tau;
  }
  /// @}

  /// @name Into memory of the caller
  /// @{
  void getInertiaMatrix(const ConstVectorRef& q, MatrixRef H) const;
  void getCoriolisVector(const ConstVectorRef& q, const ConstVectorRef& qd, VectorRef c) const;
  /// q may be empty where friction doesn't depend on it; as in batches.
  void getFrictionVector(const ConstVectorRef& q, const ConstVectorRef& qd, VectorRef f) const;
  void getGravityVector(const ConstVectorRef& q, VectorRef g) const;
  void getDynamicComponents(const ConstVectorRef& q, const ConstVectorRef& qd, MatrixRef H,
                            VectorRef c, VectorRef g) const;
  void getDynamicParameters(const ConstVectorRef& q, const ConstVectorRef& qd, MatrixRef H,
                            VectorRef c, VectorRef g) const {
    getDynamicComponents(q, qd, H, c, g);
  }
  void getTorques(const ConstVectorRef& q, const ConstVectorRef& qd, const ConstVectorRef& qdd,
                  VectorRef tau) const;
  /// @}

  /// @name Many states at once
  /// State k is column k of each n x N matrix; its H is columns k n to k n + n - 1 of the n x (n N)
  /// matrix H. Inputs and outputs may have any layout: states.hpp. With the parameter
  /// `batch_threads` large batches are shared among threads: the same bits, whatever their number.
  /// @{
  void getInertiaMatrixBatch(const ConstStatesRef& q, const StridedMatrices& H) const;
  void getCoriolisVectorBatch(const ConstStatesRef& q, const ConstStatesRef& qd,
                              const States& c) const;
  void getFrictionVectorBatch(const ConstStatesRef& q, const ConstStatesRef& qd,
                              const States& f) const;
  void getGravityVectorBatch(const ConstStatesRef& q, const States& g) const;
  void getDynamicComponentsBatch(const ConstStatesRef& q, const ConstStatesRef& qd,
                                 const StridedMatrices& H, const States& c, const States& g) const;
  void getTorquesBatch(const ConstStatesRef& q, const ConstStatesRef& qd, const ConstStatesRef& qdd,
                       const States& tau) const;

  Eigen::MatrixXd getInertiaMatrixBatch(const ConstStatesRef& q) const {
    Eigen::MatrixXd H = squareMatrix("getInertiaMatrixBatch", q.count);
    getInertiaMatrixBatch(q, H);
    return H;
  }
  Eigen::MatrixXd getCoriolisVectorBatch(const ConstStatesRef& q, const ConstStatesRef& qd) const {
    Eigen::MatrixXd c(q.joints, q.count);
    getCoriolisVectorBatch(q, qd, c);
    return c;
  }
  Eigen::MatrixXd getFrictionVectorBatch(const ConstStatesRef& qd) const {
    return getFrictionVectorBatch(ConstStates(qd.data, 0, qd.count, 1, 0), qd);
  }
  [[nodiscard]] Eigen::MatrixXd getFrictionVectorBatch(const ConstStatesRef& q,
                                                       const ConstStatesRef& qd) const {
    Eigen::MatrixXd f(qd.joints, qd.count);
    getFrictionVectorBatch(q, qd, f);
    return f;
  }
  Eigen::MatrixXd getGravityVectorBatch(const ConstStatesRef& q) const {
    Eigen::MatrixXd g(q.joints, q.count);
    getGravityVectorBatch(q, g);
    return g;
  }
  std::tuple<Eigen::MatrixXd, Eigen::MatrixXd, Eigen::MatrixXd> getDynamicComponentsBatch(
      const ConstStatesRef& q, const ConstStatesRef& qd) const {
    Eigen::MatrixXd H = squareMatrix("getDynamicComponentsBatch", q.count);
    Eigen::MatrixXd c(q.joints, q.count), g(q.joints, q.count);
    getDynamicComponentsBatch(q, qd, H, c, g);
    return {std::move(H), std::move(c), std::move(g)};
  }
  Eigen::MatrixXd getTorquesBatch(const ConstStatesRef& q, const ConstStatesRef& qd,
                                  const ConstStatesRef& qdd) const {
    Eigen::MatrixXd tau(q.joints, q.count);
    getTorquesBatch(q, qd, qdd, tau);
    return tau;
  }
  /// @}

 protected:
  InverseDynamicsSolver() = default;

  /// Result of configure() for the base class.
  struct JointInfo {
    std::vector<std::string> joint_names;  ///< in order along the chain
    std::vector<std::string> warnings;     ///< one sentence each
    /// n; empty: no joint is continuous, all count as revolute
    std::vector<chain_dynamics::JointType> joint_types = {};
    std::vector<std::string> tip_names = {};  ///< empty: one tip, without a name
  };

  /// Makes the solver ready for the robot that the configuration names.
  ///
  /// All or nothing: if it throws, the solver must compute as before. Build everything in local
  /// variables, the result too, call configuration.rejectOthers(), and move them into members as
  /// the last statements.
  virtual JointInfo configure(const Configuration& configuration) = 0;

  /// @name What a solver computes
  /// Called after a successful configure(), with sizes checked; outputs overlap no input, are not
  /// initialized, and every entry must be written. Without allocation or lock; from many threads at
  /// once.
  /// @{
  virtual void computeInertiaMatrix(const ConstVectorRef& q, MatrixRef H) const = 0;
  virtual void computeCoriolisVector(const ConstVectorRef& q, const ConstVectorRef& qd,
                                     VectorRef c) const = 0;
  virtual void computeGravityVector(const ConstVectorRef& q, VectorRef g) const = 0;

  /// Zero by default. With Configuration::friction false it gives zero, and computeTorques() leaves
  /// it out. q may be empty, unless the solver has LoadFriction that depends on it.
  virtual void computeFriction(const ConstVectorRef& q, const ConstVectorRef& qd,
                               VectorRef f) const;

  /// By default the three functions above.
  virtual void computeDynamicComponents(const ConstVectorRef& q, const ConstVectorRef& qd,
                                        MatrixRef H, VectorRef c, VectorRef g) const;

  /// By default the sum of the terms; up to 64 joints without allocation. Includes friction.
  virtual void computeTorques(const ConstVectorRef& q, const ConstVectorRef& qd,
                              const ConstVectorRef& qdd, VectorRef tau) const;

  /// By default one state after the other. Called with parts of a batch where threads share it, so
  /// a state's numbers must not depend on the others, nor on its place among them.
  virtual void computeInertiaMatrixBatch(const ConstStates& q, const StridedMatrices& H) const;
  virtual void computeCoriolisVectorBatch(const ConstStates& q, const ConstStates& qd,
                                          const States& c) const;
  /// Of friction q may have no joints, as above.
  virtual void computeFrictionBatch(const ConstStates& q, const ConstStates& qd,
                                    const States& f) const;
  virtual void computeGravityVectorBatch(const ConstStates& q, const States& g) const;
  virtual void computeDynamicComponentsBatch(const ConstStates& q, const ConstStates& qd,
                                             const StridedMatrices& H, const States& c,
                                             const States& g) const;
  virtual void computeTorquesBatch(const ConstStates& q, const ConstStates& qd,
                                   const ConstStates& qdd, const States& tau) const;

  /// Answer of inertiaIsPhysical(). No default: a false positive makes robots oscillate.
  virtual bool inertiaIsPhysicalImpl() const = 0;
  /// @}

 private:
  friend class MethodCall;  // the checks of a call, for capabilities too

  void requireInitialized(const char* method) const;

  // Results of the methods by value: allocated and freed by the caller's code, whatever its
  // alignment.
  Eigen::VectorXd vector(const char* method) const {
    requireInitialized(method);
    return Eigen::VectorXd(static_cast<Eigen::Index>(info_.joint_names.size()));
  }
  Eigen::MatrixXd squareMatrix(const char* method, Eigen::Index states) const {
    requireInitialized(method);
    const auto n = static_cast<Eigen::Index>(info_.joint_names.size());
    return Eigen::MatrixXd(n, n * states);
  }

  JointInfo info_;
  std::int64_t batch_threads_ = 1;
  bool initialized_ = false;
};

}  // namespace v2
}  // namespace inverse_dynamics_solver
