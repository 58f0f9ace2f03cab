// SPDX-License-Identifier: Apache-2.0
/// @file
/// Many states where they stand in memory, whatever their layout: pointers and steps, no copy.
///
///     const ConstStates q = columns;                     // n x N, one state per column
///     const ConstStates first_ten = columns.leftCols(10);
///     const ConstStates from_rows = rows.transpose();    // N x n, one state per row
///     const ConstStates numpy{data, n, N, 1, n};         // any steps, negative ones too
///
/// In Eigen's terms states are always n x N, one state per column; how the numbers stand in memory
/// (column after column, row after row, with gaps) is the expression's affair. A view doesn't own:
/// it is for arguments of functions, and what it looks at must live as long.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <type_traits>
#include <utility>

namespace chain_dynamics {
inline namespace v2 {

namespace detail {

template <typename Derived>
std::true_type isEigen(const Eigen::DenseBase<Derived>*);
std::false_type isEigen(const void*);
template <typename Derived>
std::true_type ownsMemory(const Eigen::PlainObjectBase<Derived>*);
std::false_type ownsMemory(const void*);

/// Whether T, perhaps a reference, is an Eigen matrix, array or expression.
template <typename T>
constexpr bool kIsEigen = decltype(isEigen(static_cast<std::decay_t<T>*>(nullptr)))::value;

/// Whether it tells where its numbers stand; a choice of columns by Eigen::seq() doesn't.
template <typename T, typename = void>
constexpr bool kHasData = false;
template <typename T>
constexpr bool kHasData<T, std::void_t<decltype(std::declval<T&>().data())>> = true;

/// Whether its numbers are doubles that stand in memory; those of a sum or a product don't.
template <typename T, bool = kIsEigen<T>>
constexpr bool kStandsInMemory = false;
template <typename T>
constexpr bool kStandsInMemory<T, true> =
    std::is_same_v<typename std::decay_t<T>::Scalar, double> &&
    (std::decay_t<T>::Flags & Eigen::DirectAccessBit) != 0 && kHasData<T>;

/// Whether they may be written: a block or map may, a matrix if it isn't const or a temporary.
template <typename T, bool = kStandsInMemory<T>>
constexpr bool kMayBeWritten = false;
template <typename T>
constexpr bool kMayBeWritten<T, true> =
    (std::decay_t<T>::Flags & Eigen::LvalueBit) != 0 &&
    (!decltype(ownsMemory(static_cast<std::decay_t<T>*>(nullptr)))::value ||
     (std::is_lvalue_reference_v<T> && !std::is_const_v<std::remove_reference_t<T>>));

template <typename T, typename Number>
using RequireMemory =
    std::enable_if_t<std::is_const_v<Number> ? kStandsInMemory<T> : kMayBeWritten<T>>;

}  // namespace detail

/// One number per joint of many states: that of joint j and state k stands at
/// `data[j * joint_step + k * state_step]`.
template <typename Number>
struct StridedStates {
  Number* data = nullptr;
  Eigen::Index joints = 0;        ///< n
  Eigen::Index count = 0;         ///< N
  std::ptrdiff_t joint_step = 1;  ///< from a joint to the next; in numbers, not bytes
  std::ptrdiff_t state_step = 0;  ///< from a state to the next

  StridedStates(Number* first, Eigen::Index joint_count, Eigen::Index state_count,
                std::ptrdiff_t from_joint_to_joint, std::ptrdiff_t from_state_to_state)
      : data(first),
        joints(joint_count),
        count(state_count),
        joint_step(from_joint_to_joint),
        state_step(from_state_to_state) {}

  /// An n x N expression whose doubles stand in memory.
  template <typename Expression, typename = detail::RequireMemory<Expression, Number>>
  StridedStates(Expression&& states)  // NOLINT(google-explicit-constructor)
      : StridedStates(const_cast<Number*>(states.data()), states.rows(), states.cols(),
                      states.rowStride(), states.colStride()) {}

  /// What may be written may be read.
  operator StridedStates<const Number>() const {  // NOLINT(google-explicit-constructor)
    return {data, joints, count, joint_step, state_step};
  }

  Number& operator()(Eigen::Index joint, Eigen::Index state) const {
    return data[joint * joint_step + state * state_step];
  }

  /// The states first to first + size - 1.
  StridedStates middle(Eigen::Index first, Eigen::Index size) const {
    return {data + first * state_step, joints, size, joint_step, state_step};
  }
};

/// Inputs and outputs of functions of many states.
using ConstStates = StridedStates<const double>;
using States = StridedStates<double>;

/// A matrix of each of many states: entry (i, j) of state k stands at
/// `data[i * row_step + j * column_step + k * state_step]`.
///
/// In Eigen's terms the matrices stand side by side: n x n inertia matrices as n x (n N), 6 x n
/// Jacobians as 6 x (n N), n x 10 n regressors as n x (10 n N). An array N x n x n, each matrix row
/// after row (C order), is `{data, n, N, n, 1, n * n}`; an array N x 6 x n is
/// `{data, 6, n, N, n, 1, 6 * n}`.
struct StridedMatrices {
  double* data = nullptr;
  Eigen::Index rows = 0;     ///< of each matrix
  Eigen::Index columns = 0;  ///< of each matrix
  Eigen::Index cols = 0;     ///< of all matrices together: columns N
  std::ptrdiff_t row_step = 1;
  std::ptrdiff_t column_step = 0;
  std::ptrdiff_t state_step = 0;
  bool side_by_side = false;  ///< an expression, which doesn't say where a matrix ends

  /// Matrices `size` x `size`.
  StridedMatrices(double* first, Eigen::Index size, Eigen::Index state_count,
                  std::ptrdiff_t from_row_to_row, std::ptrdiff_t from_column_to_column,
                  std::ptrdiff_t from_state_to_state)
      : StridedMatrices(first, size, size, state_count, from_row_to_row, from_column_to_column,
                        from_state_to_state) {}

  /// Matrices `row_count` x `column_count`.
  StridedMatrices(double* first, Eigen::Index row_count, Eigen::Index column_count,
                  Eigen::Index state_count, std::ptrdiff_t from_row_to_row,
                  std::ptrdiff_t from_column_to_column, std::ptrdiff_t from_state_to_state)
      : data(first),
        rows(row_count),
        columns(column_count),
        cols(column_count * state_count),
        row_step(from_row_to_row),
        column_step(from_column_to_column),
        state_step(from_state_to_state) {}

  /// An expression whose doubles stand in memory and may be written. Its matrices are square, until
  /// a function that writes others calls withColumns().
  template <typename Expression, typename = detail::RequireMemory<Expression, double>>
  StridedMatrices(Expression&& matrices)  // NOLINT(google-explicit-constructor)
      : data(const_cast<double*>(matrices.data())),
        rows(matrices.rows()),
        columns(matrices.rows()),
        cols(matrices.cols()),
        row_step(matrices.rowStride()),
        column_step(matrices.colStride()),
        state_step(matrices.rows() * matrices.colStride()),
        side_by_side(true) {}

  double& operator()(Eigen::Index row, Eigen::Index column, Eigen::Index state) const {
    return data[row * row_step + column * column_step + state * state_step];
  }

  /// The same numbers as matrices of so many columns each. Where the caller has given the number of
  /// columns and the steps, these stay.
  StridedMatrices withColumns(Eigen::Index column_count) const {
    StridedMatrices result = *this;
    if (side_by_side) {
      result.columns = column_count;
      result.state_step = column_count * column_step;
    }
    return result;
  }

  /// Those of the states first to first + size - 1.
  StridedMatrices middle(Eigen::Index first, Eigen::Index size) const {
    StridedMatrices result = *this;
    result.data += first * state_step;
    result.cols = columns * size;
    return result;
  }
};

}  // namespace v2
}  // namespace chain_dynamics
