// SPDX-License-Identifier: Apache-2.0

/// @file
/// Dual numbers: exact derivatives from the same code that computes the value.
///
///     using Scalar = Dual<double, 1>;
///     Scalar x = Scalar::variable(3.0, 0);     // x, and dx/dx = 1
///     Scalar y = x * x + sin(x);               // y.value = 9.14, y.derivative[0] = 6 + cos(3)
///
/// What a dual number is
/// ---------------------
/// Take a number e that isn't zero but whose square is: e^2 = 0. Then compute f(x) = x^2 at 3 + e:
///
///     f(3 + e) = (3 + e)^2 = 9 + 6 e + e^2 = 9 + 6 e
///
/// The part without e is the value f(3) = 9, the factor of e is the derivative f'(3) = 6. That is
/// no accident: the Taylor series f(x + e) = f(x) + f'(x) e + f''(x) e^2 / 2 + ... ends after its
/// second term, because e^2 = 0. Nothing is small and nothing is rounded off, as in a difference
/// quotient.
///
/// So a dual number is a pair, value and derivative, and each operation carries both along:
///
///     (a + a' e) + (b + b' e) = (a + b)     + (a' + b') e
///     (a + a' e) * (b + b' e) = (a b)       + (a' b + a b') e             product rule
///     (a + a' e) / (b + b' e) = (a / b)     + (a' - (a / b) b') / b e     quotient rule
///     sin(a + a' e)           = sin(a)      + cos(a) a' e                 chain rule
///
/// That is the whole algebra. Whatever is composed of these, a recursion over the links of a robot,
/// has its derivative computed in passing.
///
/// Several directions at once
/// --------------------------
/// For a gradient, give each variable an infinitesimal of its own, e_1 .. e_N, all products of two
/// being zero. Then f(x_1 + e_1, .., x_N + e_N) = f(x) + df/dx_1 e_1 + .. + df/dx_N e_N: the factor
/// has become a vector of N. Here the gravity torques, from potential energy alone:
///
///     Eigen::Matrix<Dual<double, 2>, 2, 1> q(Dual<double, 2>::variable(0.3, 0),
///                                            Dual<double, 2>::variable(0.5, 1));
///     Eigen::Vector2d g = potentialEnergy(chain, q).derivative;
///
/// One direction can also be time: set the derivative of q to qd, and that of qd to qdd, and
/// everything computed from them carries its rate of change.
///
/// Second derivatives
/// ------------------
/// The two numbers of the pair may be of any kind, also dual: Dual<Dual<double, N>, N> carries the
/// derivative of the derivative.
///
/// Comparisons look at the value alone, as the function would. Real time: no allocation, lock,
/// exception or system call. Threads: safe.

#pragma once

#include <Eigen/Core>
#include <cmath>
#include <ostream>
#include <type_traits>

#include "chain_dynamics/scratch.hpp"

namespace chain_dynamics {
inline namespace v2 {

/// `value + derivative . e`: a number with its derivatives in N directions.
///
/// @tparam T  type of value and derivatives: double, float, or again a dual number.
/// @tparam N  number of directions, known at compile time.
template <typename T, int N>
struct Dual {
  using Derivative = Eigen::Matrix<T, N, 1>;

  T value;
  Derivative derivative;

  /// Not initialised, like a plain number.
  Dual() = default;
  Dual(const T& value_in, const Derivative& derivative_in)
      : value(value_in), derivative(derivative_in) {}

  /// A constant: its derivatives are zero. Implicit, so that `2 * x` is what it says.
  template <typename Number,
            typename = std::enable_if_t<std::is_arithmetic_v<Number> || std::is_same_v<Number, T>>>
  Dual(const Number& constant)  // NOLINT(google-explicit-constructor)
      : value(constant), derivative(Derivative::Zero()) {}

  /// The variable of one direction: derivative one there, zero elsewhere.
  static Dual variable(const T& value, int direction) {
    return {value, Derivative::Unit(direction)};
  }

  Dual& operator+=(const Dual& b) { return *this = *this + b; }
  Dual& operator-=(const Dual& b) { return *this = *this - b; }
  Dual& operator*=(const Dual& b) { return *this = *this * b; }
  Dual& operator/=(const Dual& b) { return *this = *this / b; }

  friend Dual operator+(const Dual& a) { return a; }
  friend Dual operator-(const Dual& a) { return {-a.value, -a.derivative}; }
  friend Dual operator+(const Dual& a, const Dual& b) {
    return {a.value + b.value, a.derivative + b.derivative};
  }
  friend Dual operator-(const Dual& a, const Dual& b) {
    return {a.value - b.value, a.derivative - b.derivative};
  }
  friend Dual operator*(const Dual& a, const Dual& b) {
    return {a.value * b.value, a.derivative * b.value + b.derivative * a.value};
  }
  friend Dual operator/(const Dual& a, const Dual& b) {
    const T inverse = T(1) / b.value;
    const T quotient = a.value * inverse;
    return {quotient, (a.derivative - b.derivative * quotient) * inverse};
  }

  friend bool operator<(const Dual& a, const Dual& b) { return a.value < b.value; }
  friend bool operator>(const Dual& a, const Dual& b) { return a.value > b.value; }
  friend bool operator<=(const Dual& a, const Dual& b) { return a.value <= b.value; }
  friend bool operator>=(const Dual& a, const Dual& b) { return a.value >= b.value; }
  friend bool operator==(const Dual& a, const Dual& b) { return a.value == b.value; }
  friend bool operator!=(const Dual& a, const Dual& b) { return a.value != b.value; }

  friend Dual sin(const Dual& a) {
    using std::cos;
    using std::sin;
    return {sin(a.value), a.derivative * cos(a.value)};
  }
  friend Dual cos(const Dual& a) {
    using std::cos;
    using std::sin;
    return {cos(a.value), a.derivative * -sin(a.value)};
  }
  friend Dual exp(const Dual& a) {
    using std::exp;
    const T result = exp(a.value);
    return {result, a.derivative * result};
  }
  friend Dual tanh(const Dual& a) {
    using std::tanh;
    const T result = tanh(a.value);
    return {result, a.derivative * (T(1) - result * result)};
  }

  /// Its derivative at zero is infinite.
  friend Dual sqrt(const Dual& a) {
    using std::sqrt;
    const T result = sqrt(a.value);
    return {result, a.derivative * (T(0.5) / result)};
  }

  /// Its derivative at zero is taken as that from the right.
  friend Dual abs(const Dual& a) { return a.value < T(0) ? -a : a; }

  /// `9.1 + [5.0, 0.0] e`
  friend std::ostream& operator<<(std::ostream& stream, const Dual& a) {
    stream << a.value << " + [";
    for (int i = 0; i < N; ++i) stream << (i == 0 ? "" : ", ") << a.derivative[i];
    return stream << "] e";
  }
};

/// Derivatives of a function of vectors, exact, one direction after the other: `J_ij = dy_i / dx_j`.
///
/// @param compute  compute(x, y): y of x, vectors of dual numbers, as long as J has columns and rows.
/// @param[out] J   rows by size of x.
template <typename X, typename Compute, typename MatrixJ>
void differentiate(const Eigen::MatrixBase<X>& x, const Compute& compute,
                   const Eigen::MatrixBase<MatrixJ>& J) {
  using Number = Dual<typename X::Scalar, 1>;
  using Vector = Eigen::Map<Eigen::Matrix<Number, Eigen::Dynamic, 1>>;
  Scratch<Number> x_memory(J.cols()), y_memory(J.rows());
  Vector varied(&x_memory[0], J.cols()), y(&y_memory[0], J.rows());
  for (Eigen::Index j = 0; j < J.cols(); ++j) varied[j] = x[j];
  for (Eigen::Index j = 0; j < J.cols(); ++j) {
    varied[j] = Number::variable(x[j], 0);
    compute(varied, y);
    varied[j] = x[j];
    for (Eigen::Index i = 0; i < J.rows(); ++i) J.const_cast_derived()(i, j) = y[i].derivative[0];
  }
}

}  // namespace v2
}  // namespace chain_dynamics

namespace Eigen {

/// Lets matrices of dual numbers exist.
template <typename T, int N>
struct NumTraits<chain_dynamics::Dual<T, N>> : NumTraits<T> {
  using Real = chain_dynamics::Dual<T, N>;
  using NonInteger = Real;
  using Nested = Real;
  using Literal = Real;  // NOLINTBEGIN(readability-identifier-naming): Eigen's names
  enum {
    IsComplex = 0,
    IsInteger = 0,
    IsSigned = 1,
    RequireInitialization = 1,
    ReadCost = (N + 1) * static_cast<int>(NumTraits<T>::ReadCost),
    AddCost = (N + 1) * static_cast<int>(NumTraits<T>::AddCost),
    MulCost = (2 * N + 1) * static_cast<int>(NumTraits<T>::MulCost)
  };  // NOLINTEND(readability-identifier-naming)
};

}  // namespace Eigen
