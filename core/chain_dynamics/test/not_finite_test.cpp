// SPDX-License-Identifier: Apache-2.0

// A NaN or an infinity in any input: every entry that depends on it is no finite number, in single
// calls and in batches, on every instruction set; and no other state of a batch sees it.

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <limits>
#include <map>
#include <string>
#include <vector>

#include "quantities.hpp"

namespace chain_dynamics::not_finite_test {

using namespace test;  // NOLINT(google-build-using-namespace)
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// States of a batch: healthy ones around the spoilt ones, in full packs and the last.
constexpr std::size_t kStates = 19;
constexpr std::size_t kSpoilt[] = {2, 17};

using Flags = Eigen::Array<bool, Eigen::Dynamic, Eigen::Dynamic>;

Flags notFinite(const MatrixXd& values) { return !values.array().isFinite(); }

/// One input of one joint.
struct Input {
  std::string name;
  VectorXd State<double>::*vector;
  Index joint;
};

State<double> with(State<double> x, const Input& input, double value) {
  (x.*input.vector)[input.joint] = value;
  return x;
}

/// What friction adds to a derivative: finite where that saturates and the rest is not.
const std::string kFriction = ", friction";

/// By the templates, what friction adds to the derivatives apart from the rest.
Quantities apart(const Model& model, const State<double>& x) {
  const Index n = x.q.size();
  Quantities all = plain(model, x);
  MatrixXd by_q(n, n), by_qd(n, n), by_qdd(n, n);
  torqueDerivatives(model, x.q, x.qd, x.qdd, by_q, by_qd, by_qdd);
  all["by q"] = by_q;
  all["by qd"] = by_qd;
  by_q.setZero();
  by_qd.setZero();
  addFrictionDerivatives(model, x.q, x.qd, by_q, by_qd);
  all["by q" + kFriction] = by_q;
  all["by qd" + kFriction] = by_qd;
  return all;
}

/// Entries that the templates compute differently where the input differs.
std::map<std::string, Flags> dependent(const Model& model, const State<double>& x,
                                       const Input& input) {
  const Quantities before = apart(model, x);
  std::map<std::string, Flags> flags;
  for (const auto& [name, values] : before) {
    flags[name] = Flags::Constant(values.rows(), values.cols(), false);
  }
  for (const double other : {-2.3, 0.4}) {
    for (const auto& [name, values] : apart(model, with(x, input, other))) {
      const MatrixXd& was = before.at(name);
      const double rounding = 1e-9 * (1 + largest(was) + largest(values));
      flags[name] = flags[name] || ((values - was).array().abs() > rounding);
    }
  }
  return flags;
}

void expectSpoilt(const Quantities& found, const Quantities& plain_spoilt,
                  const std::map<std::string, Flags>& depends, const std::string& how) {
  for (const auto& [name, values] : found) {
    // finite where an infinity is: friction that saturates
    const auto expected_of = [&](const std::string& part) {
      return Flags(depends.at(part) && notFinite(plain_spoilt.at(part)));
    };
    Flags expected = expected_of(name);
    if (depends.count(name + kFriction) > 0) {
      expected = expected || expected_of(name + kFriction);
    }
    EXPECT_FALSE((expected && !notFinite(values)).any()) << name << ", " << how << "\n" << values;
  }
}

void expectSame(const Quantities& batched, const Quantities& alone, const std::string& how) {
  for (const auto& [name, values] : batched) {
    if (name == "Y") continue;  // single calls may multiply zeros of the regressor by it
    EXPECT_TRUE((notFinite(values) == notFinite(alone.at(name))).all())
        << name << ", " << how << "\n"
        << values << "\nalone\n"
        << alone.at(name);
  }
}

void expectBits(const Quantities& a, const Quantities& b) {
  for (const auto& [name, values] : a) {
    EXPECT_TRUE((values.array() == b.at(name).array()).all()) << name << " of a healthy state";
  }
}

void checkInput(const Model& model, const FastModel& fast, const State<double>& x,
                const Input& input) {
  const auto depends = dependent(model, x, input);
  const Index n = x.q.size();
  const Layout columns = layouts()[0];
  std::vector<State<double>> states(kStates, x);
  const Quantities healthy = batch(fast, states, n, columns).front();
  for (const double value : {kNan, kInfinity, -kInfinity}) {
    SCOPED_TRACE(input.name + " of joint " + std::to_string(input.joint) + " is " +
                 std::to_string(value));
    const State<double> spoilt = with(x, input, value);
    const Quantities by_templates = apart(model, spoilt);
    const Quantities alone = single(fast, spoilt);
    expectSpoilt(alone, by_templates, depends, "single");
    for (const std::size_t k : kSpoilt) states[k] = spoilt;
    const std::vector<Quantities> batched = batch(fast, states, n, columns);
    for (std::size_t k = 0; k < kStates; ++k) {
      if (k != kSpoilt[0] && k != kSpoilt[1]) {
        expectBits(batched[k], healthy);
        continue;
      }
      expectSpoilt(batched[k], by_templates, depends, "batch");
      expectSame(batched[k], alone, "batch");
    }
  }
}

class NotFinite : public ::testing::TestWithParam<std::string> {};

TEST_P(NotFinite, InputsGoToEveryEntryThatDependsOnThem) {
  for (const auto& [name, model] : models()) {
    const Index n = model.chain.jointCount();
    if (n > 9) continue;
    const FastModel fast(model, GetParam());
    const State<double> x = randomState(model.chain, 4);
    SCOPED_TRACE(name + "\n" + paste(model.chain, x));
    for (Index j = 0; j < n; ++j) {
      checkInput(model, fast, x, {"q", &State<double>::q, j});
      checkInput(model, fast, x, {"qd", &State<double>::qd, j});
      checkInput(model, fast, x, {"qdd", &State<double>::qdd, j});
      if (HasFailure()) return;
    }
  }
}

// Gravity along the first axis: batches need no sine of that joint, but its NaN counts. Without
// friction: 0 * NaN.
TEST_P(NotFinite, FirstJointCountsWhereGravityIsAlongItsAxisAndFrictionIsUnknown) {
  for (const char* robot : {"ur10", "panda"}) {
    const Model arm(chainFromUrdf(textOf(robotFile("urdf/") + robot + ".urdf")));
    const FastModel fast(arm, GetParam());
    const State<double> x = randomState(arm.chain, 4);
    State<double> spoilt = x;
    spoilt.q[0] = kNan;
    spoilt.qd[1] = kNan;
    const Index n = x.q.size();
    VectorXd tau(n), f(n);
    fast.torquesBatch(spoilt.q, x.qd, x.qdd, tau);
    EXPECT_TRUE(tau.tail(n - 1).array().isNaN().all()) << robot << ": " << tau.transpose();
    fast.frictionVectorBatch(spoilt.q, spoilt.qd, f);
    EXPECT_TRUE(std::isnan(f[1])) << robot << ": " << f.transpose();
    fast.frictionVector(spoilt.q.data(), spoilt.qd.data(), f.data());
    EXPECT_TRUE(std::isnan(f[1])) << robot << ": " << f.transpose();
  }
}

INSTANTIATE_TEST_SUITE_P(Every, NotFinite, ::testing::ValuesIn(FastModel::instructionSets()),
                         [](const auto& test) { return test.param; });

}  // namespace chain_dynamics::not_finite_test
