// SPDX-License-Identifier: Apache-2.0
/// @file
/// Capability: the matrix of Coriolis and centrifugal torques.
///
///     if (const auto* coriolis = dynamic_cast<const CoriolisMatrix*>(solver.get())) {
///       Eigen::MatrixXd C = coriolis->getCoriolisMatrix(q, qd);   // C qd = getCoriolisVector(q, qd)
///     }
#pragma once

#include <Eigen/Core>

#include "inverse_dynamics_solver/capability.hpp"

namespace inverse_dynamics_solver {
inline namespace v2 {

/// Of all matrices with the right `C qd`, that of Christoffel's symbols:
/// `C_ij = 1/2 d(C qd)_i / d qd_j`.
///
/// Where H is symmetric, `dH/dt = C + C^T`, so `dH/dt - 2 C` is skew: what momentum observers and
/// passivity proofs need. Row i of a model with row parameters is that of its own set of parameters.
class CoriolisMatrix : public Capability {
 public:
  ~CoriolisMatrix() override;

  /// `C(q, qd)`, n x n: linear in qd [kg m^2/s; prismatic kg/s, mixed kg m/s].
  Eigen::MatrixXd getCoriolisMatrix(const ConstVectorRef& q, const ConstVectorRef& qd) const {
    const Eigen::Index n = jointsFor("getCoriolisMatrix");
    Eigen::MatrixXd C(n, n);
    getCoriolisMatrix(q, qd, C);
    return C;
  }
  void getCoriolisMatrix(const ConstVectorRef& q, const ConstVectorRef& qd, MatrixRef C) const;

  /// Side by side, n x (n N).
  Eigen::MatrixXd getCoriolisMatrixBatch(const ConstStatesRef& q, const ConstStatesRef& qd) const {
    Eigen::MatrixXd C(q.joints, q.joints * q.count);
    getCoriolisMatrixBatch(q, qd, C);
    return C;
  }
  void getCoriolisMatrixBatch(const ConstStatesRef& q, const ConstStatesRef& qd,
                              const StridedMatrices& C) const;

 protected:
  /// @name What a solver implements
  /// As the compute... of InverseDynamicsSolver; a batch by default one state after the other.
  /// @{
  virtual void computeCoriolisMatrix(const ConstVectorRef& q, const ConstVectorRef& qd,
                                     MatrixRef C) const = 0;
  virtual void computeCoriolisMatrixBatch(const ConstStates& q, const ConstStates& qd,
                                          const StridedMatrices& C) const;
  /// @}
};

}  // namespace v2
}  // namespace inverse_dynamics_solver
