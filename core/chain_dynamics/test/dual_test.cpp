// SPDX-License-Identifier: Apache-2.0

#include "chain_dynamics/dual.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <cmath>
#include <functional>
#include <limits>

namespace chain_dynamics {
namespace {

using Dual1 = Dual<double, 1>;
using Dual2 = Dual<double, 2>;

// Some operations on numbers of size one.
constexpr double kDualRounding = 1e-14;

// A central difference is off by step^2 (its series) and rounding / step: both 1e-10 here.
constexpr double kStep = 1e-5;
constexpr double kDifference = 1e-9;

Dual1 x(double value) { return Dual1::variable(value, 0); }

// Value and derivative of a function against those of the same function of plain numbers.
template <typename Function>
void expectDerivative(const Function& f, double at) {
  const Dual1 y = f(x(at));
  EXPECT_EQ(y.value, f(at));
  EXPECT_NEAR(y.derivative[0], (f(at + kStep) - f(at - kStep)) / (2 * kStep), kDifference)
      << "at " << at;
}

TEST(Dual, OfTheLesson) {
  // f(x) = x^2 at 3 + e is 9 + 6 e
  const Dual1 square = x(3) * x(3);
  EXPECT_EQ(square.value, 9);
  EXPECT_EQ(square.derivative[0], 6);

  const Dual1 y = x(3) * x(3) + sin(x(3));
  EXPECT_EQ(y.value, 9 + std::sin(3.0));
  EXPECT_EQ(y.derivative[0], 6 + std::cos(3.0));
}

TEST(Dual, AlgebraIsThatOfDerivatives) {
  const auto polynomial = [](const auto& a) { return 2 * a * a * a - a / 4 + 1.5; };
  const auto quotient = [](const auto& a) { return (1 - a) / (a * a + 2); };
  for (const double at : {-2.0, 0.3, 1.7}) {
    expectDerivative(polynomial, at);
    expectDerivative(quotient, at);
  }
}

TEST(Dual, FunctionsHaveTheirDerivatives) {
  using std::abs;
  using std::cos;
  using std::exp;
  using std::sin;
  using std::sqrt;
  using std::tanh;
  for (const double at : {0.4, 0.9, 2.2}) {
    expectDerivative([](const auto& a) { return sin(a); }, at);
    expectDerivative([](const auto& a) { return cos(a); }, at);
    expectDerivative([](const auto& a) { return exp(a); }, at);
    expectDerivative([](const auto& a) { return tanh(a); }, at);
    expectDerivative([](const auto& a) { return sqrt(a); }, at);
    expectDerivative([](const auto& a) { return abs(-a); }, at);
  }
}

TEST(Dual, ComposedAssignmentsAreTheOperators) {
  Dual1 y = x(2);
  y += 3;
  y *= x(2);
  y -= 1;
  y /= 3;  // ((x + 3) x - 1) / 3, derivative (2 x + 3) / 3
  EXPECT_NEAR(y.value, 3, kDualRounding);
  EXPECT_NEAR(y.derivative[0], 7.0 / 3, kDualRounding);
}

TEST(Dual, ConstantsHaveNoDerivative) {
  EXPECT_EQ(Dual1(5).derivative[0], 0);
  EXPECT_EQ((Dual1(5) * Dual1(2) - 3).derivative[0], 0);
  EXPECT_EQ((-x(5)).derivative[0], -1);
  EXPECT_EQ((+x(5)).derivative[0], 1);
}

// d(a^2 b)/da = 2 a b, d(a^2 b)/db = a^2
TEST(Dual, TwoDirectionsAreAGradient) {
  const Dual2 a = Dual2::variable(3, 0);
  const Dual2 b = Dual2::variable(5, 1);
  EXPECT_EQ((a * a * b).derivative, Eigen::Vector2d(30, 9));
}

// x^3: 8, 12, 12 at x = 2
TEST(Dual, OfDualIsASecondDerivative) {
  using Twice = Dual<Dual1, 1>;
  const Twice y = Twice::variable(x(2), 0);
  const Twice cube = y * y * y;
  EXPECT_EQ(cube.value.value, 8);
  EXPECT_EQ(cube.derivative[0].value, 12);
  EXPECT_EQ(cube.value.derivative[0], 12);
  EXPECT_EQ(cube.derivative[0].derivative[0], 12);
}

TEST(Dual, ComparesByValue) {
  EXPECT_TRUE(x(1) < x(2) && x(2) > 1 && x(1) <= x(1) && x(1) >= 1);
  EXPECT_TRUE(x(1) == Dual1(1) && x(1) != x(2));
  EXPECT_FALSE(x(2) < x(1) || x(1) > 2 || x(2) <= x(1) || x(1) >= 2);
}

TEST(Dual, NanStaysNan) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(std::isnan(sin(x(nan)).derivative[0]));
  EXPECT_TRUE(std::isnan((x(1) * nan).derivative[0]));
}

// d(A^-1 b)/dx = -A^-1 (dA/dx) A^-1 b: a whole factorisation, differentiated in passing.
TEST(Dual, IsAScalarOfEigensDecompositions) {
  Eigen::Matrix3d A;
  A << 4, 1, 0.5, 1, 3, 0.2, 0.5, 0.2, 2;
  Eigen::Matrix3d rate;
  rate << 1, 0.3, 0, 0.3, -1, 0.4, 0, 0.4, 2;
  const Eigen::Vector3d b(1, -2, 3);

  Eigen::Matrix<Dual1, 3, 3> moving = A.cast<Dual1>();
  for (Eigen::Index i = 0; i < 9; ++i) {
    moving(i).derivative[0] = rate(i);
  }
  const Eigen::Matrix<Dual1, 3, 1> solution = moving.llt().solve(b.cast<Dual1>());
  const Eigen::Vector3d value = A.llt().solve(b);
  const Eigen::Vector3d derivative = -A.llt().solve(rate * value);
  for (Eigen::Index i = 0; i < 3; ++i) {
    EXPECT_NEAR(solution[i].value, value[i], kDualRounding);
    EXPECT_NEAR(solution[i].derivative[0], derivative[i], kDualRounding);
  }
}

}  // namespace
}  // namespace chain_dynamics
