// SPDX-License-Identifier: Apache-2.0
/// @file
/// Capability: the torques that a wrench at the tip needs.
///
///     if (const auto* contact = dynamic_cast<const ExternalWrench*>(solver.get())) {
///       const WrenchInRoot down{{0, 0, -20}, {0, 0, 0}};   // the tip presses on a table with 20 N
///       Eigen::VectorXd tau = contact->getTorques(q, qd, qdd, down);
///     }
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <string>
#include <type_traits>
#include <utility>

#include "inverse_dynamics_solver/capability.hpp"

namespace inverse_dynamics_solver {
inline namespace v2 {

/// The axes in which a wrench is expressed.
enum class WrenchFrame { kRoot, kTip };

/// A wrench that the tip exerts **on its surroundings**: the opposite of what a force-torque sensor at the tip
/// feels when something pushes [docs/notation.md, with a picture].
///
/// The frame is part of the type, so that one can't be taken for the other. It gives the axes; the
/// reference point is the origin of the tip in both.
template <WrenchFrame Frame>
struct Wrench {
  Eigen::Vector3d force = Eigen::Vector3d::Zero();   ///< N
  Eigen::Vector3d torque = Eigen::Vector3d::Zero();  ///< about the tip's origin; N m
};
using WrenchInRoot = Wrench<WrenchFrame::kRoot>;
using WrenchInTip = Wrench<WrenchFrame::kTip>;

/// The wrenches of many states, 6 x N: force, then torque, one state per column, of any layout. For the
/// same in each state: `WrenchesInTip(ConstStates(six_numbers, 6, N, 1, 0))`.
template <WrenchFrame Frame>
struct Wrenches : ConstStatesRef {
  template <class Expression, typename = std::enable_if_t<
                                  !std::is_base_of_v<ConstStatesRef, std::decay_t<Expression>>>>
  explicit Wrenches(Expression&& values) : ConstStatesRef(std::forward<Expression>(values)) {}
};
using WrenchesInRoot = Wrenches<WrenchFrame::kRoot>;
using WrenchesInTip = Wrenches<WrenchFrame::kTip>;

/// `J(q)^T w`, J the Jacobian of the tip [kinematics.hpp]: no inertia, gravity or friction in it.
///
/// A class that derives from it and from InverseDynamicsSolver names the methods of both:
/// `using InverseDynamicsSolver::getTorques; using ExternalWrench::getTorques;`, the same for
/// getTorquesBatch.
class ExternalWrench : public Capability {
 public:
  ~ExternalWrench() override;

  /// That of one of tipNames(); until the next initialize(). Torques of several wrenches are sums of those
  /// of each.
  ///
  /// @throws UninitializedException; InvalidParameterValueException  none of tipNames().
  const ExternalWrench& externalWrenchAt(const std::string& tip) const {
    return externalWrenchAtTip(tipIndex("externalWrenchAt", tip));
  }

  /// @name By value
  /// @{

  /// The torques that exert the wrench, in addition to those of the motion: `J(q)^T w`, n.
  template <WrenchFrame Frame>
  Eigen::VectorXd getExternalTorques(const ConstVectorRef& q, const Wrench<Frame>& wrench) const {
    Eigen::VectorXd tau(jointsFor("getExternalTorques"));
    getExternalTorques(q, wrench, tau);
    return tau;
  }
  /// Torques of a motion during which the tip exerts the wrench: `tau + J(q)^T w`, n.
  template <WrenchFrame Frame>
  Eigen::VectorXd getTorques(const ConstVectorRef& q, const ConstVectorRef& qd,
                             const ConstVectorRef& qdd, const Wrench<Frame>& wrench) const {
    Eigen::VectorXd tau(jointsFor("getTorques"));
    getTorques(q, qd, qdd, wrench, tau);
    return tau;
  }
  /// @}

  /// @name Into memory of the caller
  /// @{
  template <WrenchFrame Frame>
  void getExternalTorques(const ConstVectorRef& q, const Wrench<Frame>& wrench,
                          VectorRef tau) const {
    externalTorques(q, Frame, wrench.force, wrench.torque, tau);
  }
  template <WrenchFrame Frame>
  void getTorques(const ConstVectorRef& q, const ConstVectorRef& qd, const ConstVectorRef& qdd,
                  const Wrench<Frame>& wrench, VectorRef tau) const {
    torquesWithWrench(q, qd, qdd, Frame, wrench.force, wrench.torque, tau);
  }
  /// @}

  /// @name Many states at once
  /// @{
  template <WrenchFrame Frame>
  void getExternalTorquesBatch(const ConstStatesRef& q, const Wrenches<Frame>& wrenches,
                               const States& tau) const {
    externalTorquesBatch(q, Frame, wrenches, tau);
  }
  template <WrenchFrame Frame>
  void getTorquesBatch(const ConstStatesRef& q, const ConstStatesRef& qd, const ConstStatesRef& qdd,
                       const Wrenches<Frame>& wrenches, const States& tau) const {
    torquesWithWrenchBatch(q, qd, qdd, Frame, wrenches, tau);
  }
  template <WrenchFrame Frame>
  Eigen::MatrixXd getExternalTorquesBatch(const ConstStatesRef& q,
                                          const Wrenches<Frame>& wrenches) const {
    Eigen::MatrixXd tau(q.joints, q.count);
    getExternalTorquesBatch(q, wrenches, tau);
    return tau;
  }
  template <WrenchFrame Frame>
  Eigen::MatrixXd getTorquesBatch(const ConstStatesRef& q, const ConstStatesRef& qd,
                                  const ConstStatesRef& qdd,
                                  const Wrenches<Frame>& wrenches) const {
    Eigen::MatrixXd tau(q.joints, q.count);
    getTorquesBatch(q, qd, qdd, wrenches, tau);
    return tau;
  }
  /// @}

 protected:
  /// @name What a solver implements
  /// As the compute... of InverseDynamicsSolver.
  /// @{

  virtual const ExternalWrench& externalWrenchAtTip(std::size_t /*tip*/) const { return *this; }

  /// @param wrench  6: force, torque.
  virtual void computeExternalTorques(const ConstVectorRef& q, WrenchFrame frame,
                                      const ConstVectorRef& wrench, VectorRef tau) const = 0;

  /// @param wrenches  6 x N. By default one state after the other.
  virtual void computeExternalTorquesBatch(const ConstStates& q, WrenchFrame frame,
                                           const ConstStates& wrenches, const States& tau) const;
  /// @}

 private:
  void externalTorques(const ConstVectorRef& q, WrenchFrame frame, const Eigen::Vector3d& force,
                       const Eigen::Vector3d& torque, VectorRef tau) const;
  void torquesWithWrench(const ConstVectorRef& q, const ConstVectorRef& qd,
                         const ConstVectorRef& qdd, WrenchFrame frame, const Eigen::Vector3d& force,
                         const Eigen::Vector3d& torque, VectorRef tau) const;
  void externalTorquesBatch(const ConstStatesRef& q, WrenchFrame frame,
                            const ConstStatesRef& wrenches, const States& tau) const;
  void torquesWithWrenchBatch(const ConstStatesRef& q, const ConstStatesRef& qd,
                              const ConstStatesRef& qdd, WrenchFrame frame,
                              const ConstStatesRef& wrenches, const States& tau) const;
};

}  // namespace v2
}  // namespace inverse_dynamics_solver
