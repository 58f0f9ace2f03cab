// SPDX-License-Identifier: Apache-2.0

/// @file
/// Eigenvalues, as the tests need them: compiled in a tenth of a second, Eigen's solver in seven.

#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

namespace chain_dynamics::test {

/// Eigenvalues of a symmetric matrix, ascending: Jacobi's rotations, row by row [Golub and Van Loan 2013, 8.5].
inline Eigen::VectorXd eigenvaluesOf(Eigen::MatrixXd A) {
  const Eigen::Index n = A.cols();
  double outside =
      A.squaredNorm() + 1;  // the diagonal: squares that the last rotations have made zero
  for (int sweep = 0; sweep < 20 && outside > 1e-30 * A.squaredNorm(); ++sweep) {
    outside = 0;
    for (Eigen::Index i = 0; i < n; ++i) {
      for (Eigen::Index j = i + 1; j < n; ++j) {
        if (A(i, j) == 0) continue;
        outside += A(i, j) * A(i, j);
        // the smaller angle that makes A(i, j) zero: t = tan, t^2 + 2 cot t - 1 = 0
        const double cot = (A(j, j) - A(i, i)) / (2 * A(i, j));
        const double t = std::copysign(1 / (std::abs(cot) + std::hypot(cot, 1)), cot);
        const double c = 1 / std::hypot(t, 1), s = t * c;
        for (Eigen::Index k = 0; k < n; ++k) {
          const double a = A(k, i), b = A(k, j);
          A(k, i) = c * a - s * b;
          A(k, j) = s * a + c * b;
        }
        for (Eigen::Index k = 0; k < n; ++k) {
          const double a = A(i, k), b = A(j, k);
          A(i, k) = c * a - s * b;
          A(j, k) = s * a + c * b;
        }
      }
    }
  }
  Eigen::VectorXd values = A.diagonal();
  std::sort(values.data(), values.data() + n);
  return values;
}

}  // namespace chain_dynamics::test
