// SPDX-License-Identifier: Apache-2.0

/// @file
/// Linear equations of the size of a robot, in place.
///
/// Included by the kernels' two sources only [pack.hpp].

#pragma once

#include <cstddef>

#include "pack.hpp"

namespace chain_dynamics {
inline namespace v2 {
namespace fast {
namespace {

/// x = H^-1 x for symmetric H, H(i, j) at H[i n + j]; reads and overwrites its lower triangle.
///
/// H = L' D L from the last row to the first [Featherstone 2008, sec. 6.5], whose D are the
/// articulated inertias of forward dynamics in recursive form.
template <typename V>
void solveSymmetric(int n, V* H, V* x) {
  for (int k = n - 1; k >= 0; --k) {
    V* const row_k = H + std::ptrdiff_t{k} * n;
    const V inverse_D = 1.0 / row_k[k];
    for (int i = 0; i < k; ++i) {
      const V factor = row_k[i] * inverse_D;
      V* const row_i = H + std::ptrdiff_t{i} * n;
      for (int j = 0; j <= i; ++j) row_i[j] -= factor * row_k[j];
      x[i] -= factor * x[k];
    }
    row_k[k] = inverse_D;
  }
  // row k now says: H_kk x_k + sum of H_kj x_j, j < k, is what is left in x_k
  for (int k = 0; k < n; ++k) {
    const V* const row_k = H + std::ptrdiff_t{k} * n;
    for (int j = 0; j < k; ++j) x[k] -= row_k[j] * x[j];
    x[k] *= row_k[k];
  }
}

/// x = H^-1 x for any H, H(i, j) at H[i n + j], overwritten: Gauss with the largest pivot of each
/// column.
inline void solveGeneral(int n, double* H, double* x) {
  for (int k = 0; k < n; ++k) {
    int pivot = k;
    for (int i = k + 1; i < n; ++i) {
      if (__builtin_fabs(H[i * n + k]) > __builtin_fabs(H[pivot * n + k])) pivot = i;
    }
    for (int j = k; j < n && pivot != k; ++j) {
      const double above = H[k * n + j];
      H[k * n + j] = H[pivot * n + j];
      H[pivot * n + j] = above;
    }
    const double x_above = x[k];
    x[k] = x[pivot];
    x[pivot] = x_above;
    for (int i = k + 1; i < n; ++i) {
      const double factor = H[i * n + k] / H[k * n + k];
      for (int j = k + 1; j < n; ++j) H[i * n + j] -= factor * H[k * n + j];
      x[i] -= factor * x[k];
    }
  }
  for (int k = n - 1; k >= 0; --k) {
    for (int j = k + 1; j < n; ++j) x[k] -= H[k * n + j] * x[j];
    x[k] /= H[k * n + k];
  }
}

}  // namespace
}  // namespace fast
}  // namespace v2
}  // namespace chain_dynamics
