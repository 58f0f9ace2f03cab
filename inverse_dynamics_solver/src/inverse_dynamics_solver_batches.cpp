// SPDX-License-Identifier: Apache-2.0

// Batches of InverseDynamicsSolver: checks, threads, and what they compute where a solver has
// nothing better.

#include <chain_dynamics/share_states.hpp>

#include "inverse_dynamics_solver/inverse_dynamics_solver.hpp"
#include "one_state.hpp"

namespace inverse_dynamics_solver {
inline namespace v2 {

using chain_dynamics::shareStates;
using Eigen::Index;

void InverseDynamicsSolver::getInertiaMatrixBatch(const ConstStatesRef& q,
                                                  const StridedMatrices& H) const {
  const char* const method = "getInertiaMatrixBatch";
  requireInitialized(method);
  requireStates(method, "q", q, q.count);
  requireMatrix(method, "H", H.rows, H.cols, q.joints * q.count);
  shareStates(q.count, batch_threads_, [&](Index first, Index size) {
    computeInertiaMatrixBatch(q.middle(first, size), H.middle(first, size));
  });
}

void InverseDynamicsSolver::getCoriolisVectorBatch(const ConstStatesRef& q,
                                                   const ConstStatesRef& qd,
                                                   const States& c) const {
  const char* const method = "getCoriolisVectorBatch";
  requireInitialized(method);
  requireStates(method, "q", q, q.count);
  requireStates(method, "qd", qd, q.count);
  requireStates(method, "c", c, q.count);
  shareStates(q.count, batch_threads_, [&](Index first, Index size) {
    computeCoriolisVectorBatch(q.middle(first, size), qd.middle(first, size),
                               c.middle(first, size));
  });
}

void InverseDynamicsSolver::getFrictionVectorBatch(const ConstStatesRef& qd,
                                                   const States& f) const {
  const char* const method = "getFrictionVectorBatch";
  requireInitialized(method);
  requireStates(method, "qd", qd, qd.count);
  requireStates(method, "f", f, qd.count);
  shareStates(qd.count, batch_threads_, [&](Index first, Index size) {
    computeFrictionBatch(qd.middle(first, size), f.middle(first, size));
  });
}

void InverseDynamicsSolver::getGravityVectorBatch(const ConstStatesRef& q, const States& g) const {
  const char* const method = "getGravityVectorBatch";
  requireInitialized(method);
  requireStates(method, "q", q, q.count);
  requireStates(method, "g", g, q.count);
  shareStates(q.count, batch_threads_, [&](Index first, Index size) {
    computeGravityVectorBatch(q.middle(first, size), g.middle(first, size));
  });
}

void InverseDynamicsSolver::getDynamicComponentsBatch(const ConstStatesRef& q,
                                                      const ConstStatesRef& qd,
                                                      const StridedMatrices& H, const States& c,
                                                      const States& g) const {
  const char* const method = "getDynamicComponentsBatch";
  requireInitialized(method);
  requireStates(method, "q", q, q.count);
  requireStates(method, "qd", qd, q.count);
  requireMatrix(method, "H", H.rows, H.cols, q.joints * q.count);
  requireStates(method, "c", c, q.count);
  requireStates(method, "g", g, q.count);
  shareStates(q.count, batch_threads_, [&](Index first, Index size) {
    computeDynamicComponentsBatch(q.middle(first, size), qd.middle(first, size),
                                  H.middle(first, size), c.middle(first, size),
                                  g.middle(first, size));
  });
}

void InverseDynamicsSolver::getTorquesBatch(const ConstStatesRef& q, const ConstStatesRef& qd,
                                            const ConstStatesRef& qdd, const States& tau) const {
  const char* const method = "getTorquesBatch";
  requireInitialized(method);
  requireStates(method, "q", q, q.count);
  requireStates(method, "qd", qd, q.count);
  requireStates(method, "qdd", qdd, q.count);
  requireStates(method, "tau", tau, q.count);
  shareStates(q.count, batch_threads_, [&](Index first, Index size) {
    computeTorquesBatch(q.middle(first, size), qd.middle(first, size), qdd.middle(first, size),
                        tau.middle(first, size));
  });
}

// ---------------------------------------------------------------- defaults

void InverseDynamicsSolver::computeInertiaMatrixBatch(const ConstStates& q,
                                                      const StridedMatrices& H) const {
  StateReader q_of(q);
  MatrixWriter H_of(H);
  for (Index k = 0; k < q.count; ++k) {
    computeInertiaMatrix(q_of(k), H_of(k));
    H_of.done(k);
  }
}

void InverseDynamicsSolver::computeCoriolisVectorBatch(const ConstStates& q, const ConstStates& qd,
                                                       const States& c) const {
  StateReader q_of(q), qd_of(qd);
  StateWriter c_of(c);
  for (Index k = 0; k < q.count; ++k) {
    computeCoriolisVector(q_of(k), qd_of(k), c_of(k));
    c_of.done(k);
  }
}

void InverseDynamicsSolver::computeFrictionBatch(const ConstStates& qd, const States& f) const {
  StateReader qd_of(qd);
  StateWriter f_of(f);
  for (Index k = 0; k < qd.count; ++k) {
    computeFriction(Eigen::VectorXd(), qd_of(k), f_of(k));
    f_of.done(k);
  }
}

void InverseDynamicsSolver::computeGravityVectorBatch(const ConstStates& q, const States& g) const {
  StateReader q_of(q);
  StateWriter g_of(g);
  for (Index k = 0; k < q.count; ++k) {
    computeGravityVector(q_of(k), g_of(k));
    g_of.done(k);
  }
}

void InverseDynamicsSolver::computeDynamicComponentsBatch(const ConstStates& q,
                                                          const ConstStates& qd,
                                                          const StridedMatrices& H, const States& c,
                                                          const States& g) const {
  StateReader q_of(q), qd_of(qd);
  MatrixWriter H_of(H);
  StateWriter c_of(c), g_of(g);
  for (Index k = 0; k < q.count; ++k) {
    computeDynamicComponents(q_of(k), qd_of(k), H_of(k), c_of(k), g_of(k));
    H_of.done(k);
    c_of.done(k);
    g_of.done(k);
  }
}

void InverseDynamicsSolver::computeTorquesBatch(const ConstStates& q, const ConstStates& qd,
                                                const ConstStates& qdd, const States& tau) const {
  StateReader q_of(q), qd_of(qd), qdd_of(qdd);
  StateWriter tau_of(tau);
  for (Index k = 0; k < q.count; ++k) {
    computeTorques(q_of(k), qd_of(k), qdd_of(k), tau_of(k));
    tau_of.done(k);
  }
}

}  // namespace v2
}  // namespace inverse_dynamics_solver
