// SPDX-License-Identifier: Apache-2.0
/// @file
/// Arguments of the methods that compute many states: any layout, without a copy.
///
///     solver->getTorquesBatch(q, qd, qdd, tau);                              // one state per column
///     solver->getTorquesBatch(rows.transpose(), qd, qdd, tau);               // one state per row
///     solver->getGravityVectorBatch(ConstStates{data, n, N, 1, 3 * n}, g);   // any steps
///
/// The views themselves, and how an N x n x n array of inertia matrices is given:
/// chain_dynamics/states.hpp.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <type_traits>
#include <utility>
#include <vector>

#include "chain_dynamics/states.hpp"

namespace inverse_dynamics_solver {
inline namespace v2 {

using chain_dynamics::ConstStates;
using chain_dynamics::States;
using chain_dynamics::StridedMatrices;

/// An input: a view of what stands in memory, or the values of an expression that doesn't.
///
/// Made implicitly from any n x N expression of Eigen. Sums, products and the like are evaluated
/// into memory of this object; everything else is looked at where it is.
class ConstStatesRef : public ConstStates {
 public:
  ConstStatesRef(const ConstStates& states)  // NOLINT(google-explicit-constructor)
      : ConstStates(states) {}
  ConstStatesRef(const States& states)  // NOLINT(google-explicit-constructor)
      : ConstStates(states) {}

  template <typename Expression,
            typename = std::enable_if_t<chain_dynamics::detail::kIsEigen<Expression>>>
  ConstStatesRef(Expression&& states)  // NOLINT(google-explicit-constructor)
      : ConstStatesRef(Values(), states) {}

  ConstStatesRef(const ConstStatesRef&) = delete;
  ConstStatesRef& operator=(const ConstStatesRef&) = delete;

 private:
  using Values = std::vector<double>;

  template <typename Expression>
  ConstStatesRef(Values values, const Expression& states)
      : ConstStates(viewOf(states, values)), values_(std::move(values)) {}

  template <typename Expression>
  static ConstStates viewOf(const Expression& states, Values& values) {
    static_assert(std::is_same_v<typename Expression::Scalar, double>,
                  "states are of type double: convert them with cast<double>()");
    if constexpr (chain_dynamics::detail::kStandsInMemory<Expression>) {
      return states;
    } else {
      values.resize(static_cast<std::size_t>(states.size()));
      Eigen::Map<Eigen::MatrixXd> map(values.data(), states.rows(), states.cols());
      map = states;
      return map;
    }
  }

  Values values_;  // moving a vector leaves its numbers where they are
};

}  // namespace v2
}  // namespace inverse_dynamics_solver
