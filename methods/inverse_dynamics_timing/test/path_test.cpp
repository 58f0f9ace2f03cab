// SPDX-License-Identifier: Apache-2.0
#include "inverse_dynamics_timing/path.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <inverse_dynamics_solver/exceptions.hpp>
#include <limits>
#include <string>
#include <vector>

namespace {

using Eigen::MatrixXd;
using Eigen::Vector2d;
using Eigen::VectorXd;
using inverse_dynamics_solver::InvalidParameterValueException;
using inverse_dynamics_timing::Path;
using testing::HasSubstr;
using testing::Property;

constexpr double kRounding = 1e-12;

struct State {
  VectorXd q, dq, ddq;
};

State at(const Path& path, double s, bool before = false) {
  const Eigen::Index n = path.jointCount();
  State state{VectorXd(n), VectorXd(n), VectorXd(n)};
  path.evaluate(s, state.q, state.dq, state.ddq, before);
  return state;
}

MatrixXd corner() {
  MatrixXd waypoints(2, 3);
  waypoints << 0, 1, 1,  //
      0, 0, 1;
  return waypoints;
}

/// Knots between which q, q' and q'' don't jump, and derivatives are those of q.
void expectSmooth(const Path& path) {
  for (Eigen::Index k = 1; k + 1 < path.knots().size(); ++k) {
    const double s = path.knots()[k];
    const State left = at(path, s, true), right = at(path, s);
    EXPECT_LT((left.q - right.q).norm(), kRounding);
    EXPECT_LT((left.dq - right.dq).norm(), 1e-9);
    EXPECT_LT((left.ddq - right.ddq).norm(), 1e-8);
  }
  const double step = 1e-5 * (path.end() - path.start());
  for (int i = 1; i < 50; ++i) {
    const double s = path.start() + (path.end() - path.start()) * (i + 0.3) / 51;
    const State before = at(path, s - step), here = at(path, s), after = at(path, s + step);
    EXPECT_LT(((after.q - before.q) / (2 * step) - here.dq).norm(), 1e-5 * (1 + here.dq.norm()));
    EXPECT_LT(((after.dq - before.dq) / (2 * step) - here.ddq).norm(),
              1e-3 * (1 + here.ddq.norm()));
  }
}

TEST(Path, SplineGoesThroughItsWaypointsWithContinuousCurvature) {
  const MatrixXd waypoints = MatrixXd::Random(5, 7);
  const Path path = Path::spline(waypoints);
  for (Eigen::Index k = 0; k < waypoints.cols(); ++k) {
    EXPECT_LT((at(path, path.knots()[k]).q - waypoints.col(k)).norm(), kRounding);
  }
  expectSmooth(path);
  EXPECT_LT(at(path, path.start()).ddq.norm(), kRounding);
  EXPECT_LT(at(path, path.end()).ddq.norm(), 1e-9);
}

TEST(Path, LinesPassACornerByTheDeviationAndNoMore) {
  for (const double deviation : {0.01, 0.05, 0.1}) {
    const Path path = Path::lines(corner(), deviation);
    expectSmooth(path);
    double nearest = 1.0;
    for (int i = 0; i <= 1000; ++i) {
      nearest = std::min(nearest, (at(path, path.end() * i / 1000).q - Vector2d(1, 0)).norm());
    }
    EXPECT_NEAR(nearest, deviation, 1e-5);
  }
}

TEST(Path, CurvesOfNeighbouringCornersTakeAtMostHalfOfTheirLine) {
  MatrixXd waypoints(2, 4);
  waypoints << 0, 1, 1, 2,  //
      0, 0, 0.01, 0.01;
  const Path path = Path::lines(waypoints, 0.2);
  expectSmooth(path);
  EXPECT_EQ(path.stops().size(), 0);
  EXPECT_LT((at(path, path.end()).q - waypoints.col(3)).norm(), kRounding);
}

TEST(Path, StopsWhereItTurnsBackOrNoDeviationIsAllowed) {
  EXPECT_EQ(Path::lines(corner(), 0.0).stops().size(), 1);
  EXPECT_EQ(Path::lines(corner(), 0.1).stops().size(), 0);
  EXPECT_EQ(Path::lines(corner(), 0.1, {1}).stops().size(), 1);
  EXPECT_EQ(Path::spline(corner(), {1}).stops().size(), 1);
  MatrixXd back(2, 3);
  back << 0, 1, 0,  //
      0, 0.5, 0;
  EXPECT_EQ(Path::lines(back, 0.1).stops().size(), 1);
  const Path straight = Path::lines((MatrixXd(1, 3) << 0, 1, 2).finished(), 0.0);
  EXPECT_EQ(straight.stops().size(), 0);  // no corner
}

TEST(Path, LeavesRepeatedWaypointsOut) {
  MatrixXd waypoints(2, 5);
  waypoints << 0, 0, 1, 1, 2,  //
      0, 0, 1, 1, 0;
  const Path path = Path::spline(waypoints, {3});  // the second of two at one place
  EXPECT_EQ(path.knots().size(), 3);
  ASSERT_EQ(path.stops().size(), 1);
  EXPECT_LT((at(path, path.stops()[0]).q - Vector2d(1, 1)).norm(), kRounding);
}

TEST(Path, FunctionIsMetWithItsDerivativesAtKnots) {
  const auto circle = [](double s, Eigen::Ref<VectorXd> q, Eigen::Ref<VectorXd> dq,
                         Eigen::Ref<VectorXd> ddq) {
    q << std::cos(s), std::sin(s);
    dq << -std::sin(s), std::cos(s);
    ddq = -q;
  };
  const Path path = Path::function(circle, 2, VectorXd::LinSpaced(20, 0.0, 6.0));
  expectSmooth(path);
  for (int i = 0; i <= 100; ++i) {
    const double s = 6.0 * i / 100;
    EXPECT_LT((at(path, s).q - Vector2d(std::cos(s), std::sin(s))).norm(), 1e-6);
  }
}

TEST(Path, RefusesWhatIsNoPath) {
  const auto refused = [](const std::string& text) {
    return testing::Throws<InvalidParameterValueException>(
        Property(&InvalidParameterValueException::what, HasSubstr(text)));
  };
  EXPECT_THAT([] { Path::spline(MatrixXd::Zero(2, 1)); }, refused("two different waypoints"));
  EXPECT_THAT([] { Path::spline(MatrixXd::Ones(2, 3)); }, refused("two different waypoints"));
  EXPECT_THAT([] { Path::lines(MatrixXd(2, 0), 0.1); }, refused("two different waypoints"));
  EXPECT_THAT([] { Path::lines(corner(), -0.1); }, refused("deviation"));
  EXPECT_THAT([] { Path::spline(corner(), {3}); }, refused("0 to 2"));
  MatrixXd broken = corner();
  broken(1, 1) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT([&] { Path::spline(broken); }, refused("finite"));
}

// q = x (1 - x) (2 - x) of the first joint, q' = 3 x^2 - 6 x + 2.
TEST(Path, JointsTurnBackWhereTheirDerivativeChangesItsSign) {
  const Path path = Path::function(
      [](double s, auto q, auto dq, auto ddq) {
        q << s * (1 - s) * (2 - s), s;
        dq << 3 * s * s - 6 * s + 2, 1;
        ddq << 6 * s - 6, 0;
      },
      2, VectorXd::LinSpaced(4, 0.0, 2.0));
  const double extreme = 2 / (3 * std::sqrt(3.0));
  const std::vector<double> turns = path.turningPoints();
  ASSERT_EQ(turns.size(), 2);
  EXPECT_NEAR(turns[0], 1 - 1 / std::sqrt(3.0), 1e-7);
  EXPECT_NEAR(turns[1], 1 + 1 / std::sqrt(3.0), 1e-7);
  const MatrixXd ranges = path.positionRanges();
  EXPECT_LT((ranges - (MatrixXd(2, 2) << -extreme, extreme, 0, 2).finished()).norm(), kRounding);
}

TEST(Path, RangesOfLongPathsAreTheirExtremes) {
  const Path path = Path::spline(MatrixXd::Random(3, 200));
  const MatrixXd ranges = path.positionRanges();
  MatrixXd found(3, 2);
  found.colwise() = at(path, path.start()).q;
  for (int i = 0; i <= 200000; ++i) {
    const VectorXd q = at(path, path.end() * i / 200000).q;
    found.col(0) = found.col(0).cwiseMin(q), found.col(1) = found.col(1).cwiseMax(q);
  }
  EXPECT_LT((ranges - found).cwiseAbs().maxCoeff(), 1e-5);
  EXPECT_TRUE((ranges.col(1).array() >= found.col(1).array()).all());
}

}  // namespace
