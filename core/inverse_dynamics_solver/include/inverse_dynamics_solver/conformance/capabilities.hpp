// SPDX-License-Identifier: Apache-2.0
/// @file
/// Every quantity of the solver and its capabilities in its three forms, for the tests that hold them
/// to the promises of all methods. Include conformance_tests.hpp, not this.
#pragma once

#include <chain_dynamics/spatial.hpp>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "inverse_dynamics_solver/conformance/solver_fixture.hpp"
#include "inverse_dynamics_solver/coriolis_matrix.hpp"
#include "inverse_dynamics_solver/energies.hpp"
#include "inverse_dynamics_solver/external_wrench.hpp"
#include "inverse_dynamics_solver/forward_dynamics.hpp"
#include "inverse_dynamics_solver/kinematics.hpp"
#include "inverse_dynamics_solver/regressor.hpp"
#include "inverse_dynamics_solver/torque_derivatives.hpp"

namespace inverse_dynamics_solver::conformance {

using Matrices = std::vector<Eigen::MatrixXd>;

/// The matrices, then the vectors that a call writes for many states.
struct BatchOutputs {
  std::vector<StridedMatrices> matrices;
  std::vector<States> vectors;
};

/// Rows and columns of each matrix, rows of each vector.
struct OutputShapes {
  std::vector<std::pair<Eigen::Index, Eigen::Index>> matrices;
  std::vector<Eigen::Index> vectors;

  /// A matrix for each, one after the other.
  Matrices memory(double value = 0.0) const {
    Matrices all;
    for (const auto& [rows, columns] : matrices) {
      all.push_back(Eigen::MatrixXd::Constant(rows, columns, value));
    }
    for (const Eigen::Index rows : vectors) {
      all.push_back(Eigen::MatrixXd::Constant(rows, 1, value));
    }
    return all;
  }
};

/// A method of the solver, or of a capability.
struct Method {
  std::string name;
  OutputShapes shapes;
  std::function<Matrices(const State&)> by_value;
  std::function<void(const State&, Matrices&)> into_memory;
  std::function<void(const ConstStates& q, const ConstStates& qd, const ConstStates& qdd,
                     const BatchOutputs&)>
      batch;
};

inline const WrenchInRoot kWrenchInRoot{{3.0, -4.0, 5.0}, {-0.6, 0.7, 0.8}};
inline const WrenchInTip kWrenchInTip{{3.0, -4.0, 5.0}, {-0.6, 0.7, 0.8}};
inline const double kSixNumbers[] = {3.0, -4.0, 5.0, -0.6, 0.7, 0.8};

/// The wrench above in each state.
template <class OfFrame>
OfFrame sameWrenches(Eigen::Index count) {
  return OfFrame(ConstStates(kSixNumbers, 6, count, 1, 0));
}

/// Of one vector, which is what most give.
template <class ByValue, class IntoMemory, class Batch>
Method vectorMethod(const char* name, Eigen::Index n, const ByValue& by_value,
                    const IntoMemory& into_memory, const Batch& batch) {
  return {name,
          {{}, {n}},
          [by_value](const State& x) { return Matrices{by_value(x)}; },
          [into_memory](const State& x, Matrices& out) { into_memory(x, out[0].col(0)); },
          [batch](const ConstStates& q, const ConstStates& qd, const ConstStates& qdd,
                  const BatchOutputs& out) { batch(q, qd, qdd, out.vectors[0]); }};
}

inline void addMethods(const InverseDynamicsSolver& s, Eigen::Index n, std::vector<Method>& all) {
  using Q = const ConstStates&;
  all.push_back(
      {"getInertiaMatrix",
       {{{n, n}}, {}},
       [&s](const State& x) { return Matrices{s.getInertiaMatrix(x.q)}; },
       [&s](const State& x, Matrices& out) { s.getInertiaMatrix(x.q, out[0]); },
       [&s](Q q, Q, Q, const BatchOutputs& out) { s.getInertiaMatrixBatch(q, out.matrices[0]); }});
  all.push_back(vectorMethod(
      "getCoriolisVector", n, [&s](const State& x) { return s.getCoriolisVector(x.q, x.qd); },
      [&s](const State& x, VectorRef c) { s.getCoriolisVector(x.q, x.qd, c); },
      [&s](Q q, Q qd, Q, const States& c) { s.getCoriolisVectorBatch(q, qd, c); }));
  all.push_back(vectorMethod(
      "getFrictionVector", n, [&s](const State& x) { return s.getFrictionVector(x.q, x.qd); },
      [&s](const State& x, VectorRef f) { s.getFrictionVector(x.q, x.qd, f); },
      [&s](Q q, Q qd, Q, const States& f) { s.getFrictionVectorBatch(q, qd, f); }));
  all.push_back(vectorMethod(
      "getGravityVector", n, [&s](const State& x) { return s.getGravityVector(x.q); },
      [&s](const State& x, VectorRef g) { s.getGravityVector(x.q, g); },
      [&s](Q q, Q, Q, const States& g) { s.getGravityVectorBatch(q, g); }));
  all.push_back(vectorMethod(
      "getTorques", n, [&s](const State& x) { return s.getTorques(x.q, x.qd, x.qdd); },
      [&s](const State& x, VectorRef tau) { s.getTorques(x.q, x.qd, x.qdd, tau); },
      [&s](Q q, Q qd, Q qdd, const States& tau) { s.getTorquesBatch(q, qd, qdd, tau); }));
  all.push_back({"getDynamicComponents",
                 {{{n, n}}, {n, n}},
                 [&s](const State& x) {
                   const auto [H, c, g] = s.getDynamicParameters(x.q, x.qd);
                   return Matrices{H, c, g};
                 },
                 [&s](const State& x, Matrices& out) {
                   s.getDynamicComponents(x.q, x.qd, out[0], out[1].col(0), out[2].col(0));
                 },
                 [&s](Q q, Q qd, Q, const BatchOutputs& out) {
                   s.getDynamicComponentsBatch(q, qd, out.matrices[0], out.vectors[0],
                                               out.vectors[1]);
                 }});
}

inline void addMethods(const Kinematics& k, Eigen::Index n, std::vector<Method>& all) {
  using Q = const ConstStates&;
  all.push_back({"getTipPose",
                 {{{3, 3}}, {3}},
                 [&k](const State& x) {
                   const auto pose = k.getTipPose(x.q);
                   return Matrices{pose.R, pose.p};
                 },
                 [&k](const State& x, Matrices& out) {
                   chain_dynamics::Transform<double> pose;
                   k.getTipPose(x.q, pose);
                   out[0] = pose.R;
                   out[1] = pose.p;
                 },
                 [&k](Q q, Q, Q, const BatchOutputs& out) {
                   k.getTipPoseBatch(q, out.matrices[0], out.vectors[0]);
                 }});
  all.push_back(
      {"getTipJacobian",
       {{{6, n}}, {}},
       [&k](const State& x) { return Matrices{k.getTipJacobian(x.q)}; },
       [&k](const State& x, Matrices& out) { k.getTipJacobian(x.q, out[0]); },
       [&k](Q q, Q, Q, const BatchOutputs& out) { k.getTipJacobianBatch(q, out.matrices[0]); }});
  all.push_back(
      {"getTipJacobianDerivative",
       {{{6, n}}, {}},
       [&k](const State& x) { return Matrices{k.getTipJacobianDerivative(x.q, x.qd)}; },
       [&k](const State& x, Matrices& out) { k.getTipJacobianDerivative(x.q, x.qd, out[0]); },
       [&k](Q q, Q qd, Q, const BatchOutputs& out) {
         k.getTipJacobianDerivativeBatch(q, qd, out.matrices[0]);
       }});
}

template <WrenchFrame Frame>
void addMethods(const ExternalWrench& e, const Wrench<Frame>& w, Eigen::Index n,
                std::vector<Method>& all) {
  using Q = const ConstStates&;
  using Same = Wrenches<Frame>;
  all.push_back(vectorMethod(
      "getExternalTorques", n, [&e, w](const State& x) { return e.getExternalTorques(x.q, w); },
      [&e, w](const State& x, VectorRef tau) { e.getExternalTorques(x.q, w, tau); },
      [&e](Q q, Q, Q, const States& tau) {
        e.getExternalTorquesBatch(q, sameWrenches<Same>(q.count), tau);
      }));
  all.push_back(vectorMethod(
      "getTorques", n, [&e, w](const State& x) { return e.getTorques(x.q, x.qd, x.qdd, w); },
      [&e, w](const State& x, VectorRef tau) { e.getTorques(x.q, x.qd, x.qdd, w, tau); },
      [&e](Q q, Q qd, Q qdd, const States& tau) {
        e.getTorquesBatch(q, qd, qdd, sameWrenches<Same>(q.count), tau);
      }));
}

inline void addMethods(const CoriolisMatrix& c, Eigen::Index n, std::vector<Method>& all) {
  using Q = const ConstStates&;
  all.push_back({"getCoriolisMatrix",
                 {{{n, n}}, {}},
                 [&c](const State& x) { return Matrices{c.getCoriolisMatrix(x.q, x.qd)}; },
                 [&c](const State& x, Matrices& out) { c.getCoriolisMatrix(x.q, x.qd, out[0]); },
                 [&c](Q q, Q qd, Q, const BatchOutputs& out) {
                   c.getCoriolisMatrixBatch(q, qd, out.matrices[0]);
                 }});
}

inline void addMethods(const Energies& e, std::vector<Method>& all) {
  using Q = const ConstStates&;
  const auto one = [](double value) { return Eigen::MatrixXd::Constant(1, 1, value).eval(); };
  all.push_back({"getKineticEnergy",
                 {{}, {1}},
                 [&e, one](const State& x) { return Matrices{one(e.getKineticEnergy(x.q, x.qd))}; },
                 [&e](const State& x, Matrices& out) { out[0](0) = e.getKineticEnergy(x.q, x.qd); },
                 [&e](Q q, Q qd, Q, const BatchOutputs& out) {
                   e.getKineticEnergyBatch(q, qd, out.vectors[0]);
                 }});
  all.push_back(
      {"getPotentialEnergy",
       {{}, {1}},
       [&e, one](const State& x) { return Matrices{one(e.getPotentialEnergy(x.q))}; },
       [&e](const State& x, Matrices& out) { out[0](0) = e.getPotentialEnergy(x.q); },
       [&e](Q q, Q, Q, const BatchOutputs& out) { e.getPotentialEnergyBatch(q, out.vectors[0]); }});
}

inline void addMethods(const TorqueDerivatives& d, Eigen::Index n, std::vector<Method>& all) {
  using Q = const ConstStates&;
  all.push_back({"getTorqueDerivatives",
                 {{{n, n}, {n, n}, {n, n}}, {}},
                 [&d](const State& x) {
                   const auto [by_q, by_qd, by_qdd] = d.getTorqueDerivatives(x.q, x.qd, x.qdd);
                   return Matrices{by_q, by_qd, by_qdd};
                 },
                 [&d](const State& x, Matrices& out) {
                   d.getTorqueDerivatives(x.q, x.qd, x.qdd, out[0], out[1], out[2]);
                 },
                 [&d](Q q, Q qd, Q qdd, const BatchOutputs& out) {
                   d.getTorqueDerivativesBatch(q, qd, qdd, out.matrices[0], out.matrices[1],
                                               out.matrices[2]);
                 }});
}

inline void addMethods(const Regressor& r, Eigen::Index n, Eigen::Index links,
                       std::vector<Method>& all) {
  using Q = const ConstStates&;
  all.push_back({"getRegressor",
                 {{{n, 10 * links}}, {}},
                 [&r](const State& x) { return Matrices{r.getRegressor(x.q, x.qd, x.qdd)}; },
                 [&r](const State& x, Matrices& out) { r.getRegressor(x.q, x.qd, x.qdd, out[0]); },
                 [&r](Q q, Q qd, Q qdd, const BatchOutputs& out) {
                   r.getRegressorBatch(q, qd, qdd, out.matrices[0]);
                 }});
}

inline void addMethods(const ForwardDynamics& f, Eigen::Index n, std::vector<Method>& all) {
  using Q = const ConstStates&;
  // (the third numbers of a state as torques)
  all.push_back(vectorMethod(
      "getAccelerations", n, [&f](const State& x) { return f.getAccelerations(x.q, x.qd, x.qdd); },
      [&f](const State& x, VectorRef qdd) { f.getAccelerations(x.q, x.qd, x.qdd, qdd); },
      [&f](Q q, Q qd, Q tau, const States& qdd) { f.getAccelerationsBatch(q, qd, tau, qdd); }));
}

/// The methods of a solver of n joints and of all capabilities that it has; those that need an inertia
/// of rigid bodies, or energies, where it has these, or isn't initialized.
inline std::vector<Method> methodsOf(const InverseDynamicsSolver& solver, Eigen::Index n) {
  std::vector<Method> all;
  const bool fresh = !solver.isInitialized();
  addMethods(solver, n, all);
  if (const auto* k = dynamic_cast<const Kinematics*>(&solver)) addMethods(*k, n, all);
  if (const auto* e = dynamic_cast<const ExternalWrench*>(&solver)) {
    addMethods(*e, kWrenchInRoot, n, all);
    addMethods(*e, kWrenchInTip, n, all);
  }
  if (const auto* c = dynamic_cast<const CoriolisMatrix*>(&solver)) addMethods(*c, n, all);
  if (const auto* d = dynamic_cast<const TorqueDerivatives*>(&solver)) addMethods(*d, n, all);
  if (const auto* r = dynamic_cast<const Regressor*>(&solver))
    addMethods(*r, n, fresh ? n : r->linkCount(), all);
  if (const auto* e = dynamic_cast<const Energies*>(&solver)) {
    if (fresh || e->hasEnergies()) addMethods(*e, all);
  }
  if (const auto* f = dynamic_cast<const ForwardDynamics*>(&solver)) {
    if (fresh || solver.inertiaIsPhysical()) addMethods(*f, n, all);
  }
  return all;
}

inline std::vector<Method> methodsOf(const InverseDynamicsSolver& solver) {
  return methodsOf(solver, solver.jointCount());
}

/// The entries of several matrices in one column.
inline Eigen::VectorXd flat(const Matrices& matrices) {
  Eigen::Index size = 0;
  for (const Eigen::MatrixXd& matrix : matrices) size += matrix.size();
  Eigen::VectorXd all(size);
  Eigen::Index first = 0;
  for (const Eigen::MatrixXd& matrix : matrices) {
    all.segment(first, matrix.size()) = flat(matrix);
    first += matrix.size();
  }
  return all;
}

}  // namespace inverse_dynamics_solver::conformance
