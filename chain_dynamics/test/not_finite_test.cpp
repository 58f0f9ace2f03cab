// SPDX-License-Identifier: Apache-2.0

// A NaN or an infinity in any input: every entry that depends on it is no finite number, in single
// calls and in batches, on every instruction set; and no other state of a batch sees it.

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <map>
#include <string>

#include "chain_dynamics/fast_model.hpp"
#include "chain_dynamics/forward_dynamics.hpp"
#include "chain_dynamics/regressor.hpp"
#include "chain_dynamics/tip_kinematics.hpp"
#include "example_models.hpp"

namespace chain_dynamics::not_finite_test {

using namespace test;  // NOLINT(google-build-using-namespace)
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// What friction adds to a quantity, where the templates compute that apart.
const std::string kFriction = ", friction";

/// Each quantity of one state by its name.
using Quantities = std::map<std::string, MatrixXd>;

void addParts(Quantities& all, const std::string& suffix, const MatrixXd& H, const MatrixXd& c,
              const MatrixXd& g) {
  all["H" + suffix] = H;
  all["c" + suffix] = c;
  all["g" + suffix] = g;
}

void addKinematics(Quantities& all, const MatrixXd& C, const MatrixXd& R, const MatrixXd& p,
                   const MatrixXd& J, const MatrixXd& dJ) {
  all["C"] = C;
  all["R"] = R;
  all["p"] = p;
  all["J"] = J;
  all["dJ"] = dJ;
}

/// By the templates. Accelerations solve H qdd = tau - c - g - f, for any parameters.
Quantities plain(const Model& model, const State<double>& x) {
  const Index n = x.q.size();
  MatrixXd H(n, n), by_q(n, n), by_qd(n, n), by_qdd(n, n), Y(n, 10 * n);
  VectorXd c(n), g(n), f(n), tau(n);
  Quantities all;
  dynamicComponents(model, x.q, x.qd, H, c, g);
  addParts(all, "", H, c, g);
  addParts(all, " together", H, c, g);
  frictionVector(model, x.q, x.qd, f);
  torques(model, x.q, x.qd, x.qdd, tau);
  torqueDerivatives(model, x.q, x.qd, x.qdd, by_q, by_qd, by_qdd);
  MatrixXd friction_by_q = MatrixXd::Zero(n, n), friction_by_qd = friction_by_q;
  addFrictionDerivatives(model, x.q, x.qd, friction_by_q, friction_by_qd);
  regressor(model.chain, x.q, x.qd, x.qdd, Y);
  MatrixXd C(n, n), J(6, n), dJ(6, n);
  coriolisMatrix(model, x.q, x.qd, C);
  tipJacobian(model.chain, x.q, J);
  tipJacobianDerivative(model.chain, x.q, x.qd, dJ);
  const Transform<double> tip = tipPose(model.chain, x.q);
  addKinematics(all, C, tip.R, tip.p, J, dJ);
  all["f"] = f;
  all["tau"] = tau + f;
  all["by q"] = by_q;
  all["by qd"] = by_qd;
  all["by q" + kFriction] = friction_by_q;
  all["by qd" + kFriction] = friction_by_qd;
  all["by qdd"] = by_qdd;
  all["Y"] = Y;
  all["qdd"] = H.partialPivLu().solve(x.qdd - c - g - f);  // of torques as large as qdd
  return all;
}

Quantities single(const FastModel& fast, const State<double>& x) {
  const Index n = x.q.size();
  const double* const q = x.q.data();
  const double* const qd = x.qd.data();
  MatrixXd H(n, n), by_q(n, n), by_qd(n, n), by_qdd(n, n), Y(n, 10 * n);
  VectorXd c(n), g(n), f(n), tau(n), qdd(n);
  Quantities all;
  fast.inertiaMatrix(q, H.data(), n);
  fast.coriolisVector(q, qd, c.data());
  fast.gravityVector(q, g.data());
  addParts(all, "", H, c, g);
  fast.dynamicComponents(q, qd, H.data(), n, c.data(), g.data());
  addParts(all, " together", H, c, g);
  fast.frictionVector(q, qd, f.data());
  fast.torques(q, qd, x.qdd.data(), tau.data());
  fast.torqueDerivatives(q, qd, x.qdd.data(), by_q.data(), by_qd.data(), by_qdd.data(), n);
  fast.regressor(q, qd, x.qdd.data(), Y.data(), n);
  fast.forwardDynamics(q, qd, x.qdd.data(), qdd.data());
  MatrixXd C(n, n), R(3, 3), p(3, 1), J(6, n), dJ(6, n);
  fast.coriolisMatrix(q, qd, C.data(), n);
  fast.tipPose(q, R.data(), p.data());
  fast.tipJacobian(q, J.data(), 6);
  fast.tipJacobianDerivative(q, qd, dJ.data(), 6);
  addKinematics(all, C, R, p, J, dJ);
  all["f"] = f;
  all["tau"] = tau;
  all["by q"] = by_q;
  all["by qd"] = by_qd;
  all["by qdd"] = by_qdd;
  all["Y"] = Y;
  all["qdd"] = qdd;
  return all;
}

/// States of a batch: healthy ones around the spoilt one, in full packs and the last.
constexpr Index kStates = 19;
constexpr Index kSpoilt[] = {2, 17};

/// The quantities of every state of a batch.
std::vector<Quantities> batch(const FastModel& fast, const State<double>& healthy,
                              const State<double>& spoilt) {
  const Index n = healthy.q.size();
  MatrixXd q = healthy.q.replicate(1, kStates);
  MatrixXd qd = healthy.qd.replicate(1, kStates);
  MatrixXd qdd = healthy.qdd.replicate(1, kStates);
  for (const Index k : kSpoilt) {
    q.col(k) = spoilt.q;
    qd.col(k) = spoilt.qd;
    qdd.col(k) = spoilt.qdd;
  }
  MatrixXd H(n, n * kStates), H2 = H, c = q, g = q, c2 = q, g2 = q, f = q, tau = q;
  fast.inertiaMatrixBatch(q, H);
  fast.coriolisVectorBatch(q, qd, c);
  fast.gravityVectorBatch(q, g);
  fast.dynamicComponentsBatch(q, qd, H2, c2, g2);
  fast.frictionVectorBatch(q, qd, f);
  fast.torquesBatch(q, qd, qdd, tau);
  MatrixXd C = H, R(3, 3 * kStates), p(3, kStates), J(6, n * kStates), dJ = J;
  fast.coriolisMatrixBatch(q, qd, C);
  fast.tipPoseBatch(q, R, p);
  fast.tipJacobianBatch(q, J);
  fast.tipJacobianDerivativeBatch(q, qd, dJ);
  std::vector<Quantities> all(kStates);
  for (Index k = 0; k < kStates; ++k) {
    Quantities& of_state = all[static_cast<std::size_t>(k)];
    addParts(of_state, "", H.middleCols(k * n, n), c.col(k), g.col(k));
    addParts(of_state, " together", H2.middleCols(k * n, n), c2.col(k), g2.col(k));
    addKinematics(of_state, C.middleCols(k * n, n), R.middleCols(3 * k, 3), p.col(k),
                  J.middleCols(k * n, n), dJ.middleCols(k * n, n));
    of_state["f"] = f.col(k);
    of_state["tau"] = tau.col(k);
  }
  return all;
}

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

/// Entries that the templates compute differently where the input differs.
std::map<std::string, Flags> dependent(const Model& model, const State<double>& x,
                                       const Input& input) {
  const Quantities before = plain(model, x);
  std::map<std::string, Flags> flags;
  for (const auto& [name, values] : before) {
    flags[name] = Flags::Constant(values.rows(), values.cols(), false);
  }
  for (const double other : {-2.3, 0.4}) {
    for (const auto& [name, values] : plain(model, with(x, input, other))) {
      const MatrixXd& was = before.at(name);
      const double rounding = 1e-9 * (1 + largest(was) + largest(values));
      flags[name] = flags[name] || ((values - was).array().abs() > rounding);
    }
  }
  return flags;
}

void expectSpoilt(const Quantities& fast, const Quantities& plain_spoilt,
                  const std::map<std::string, Flags>& depends, const std::string& how) {
  for (const auto& [name, values] : fast) {
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
  const Quantities healthy = batch(fast, x, x).front();
  for (const double value : {kNan, kInfinity, -kInfinity}) {
    SCOPED_TRACE(input.name + " of joint " + std::to_string(input.joint) + " is " +
                 std::to_string(value));
    const State<double> spoilt = with(x, input, value);
    const Quantities by_templates = plain(model, spoilt);
    const Quantities alone = single(fast, spoilt);
    expectSpoilt(alone, by_templates, depends, "single");
    const std::vector<Quantities> batched = batch(fast, x, spoilt);
    for (Index k = 0; k < kStates; ++k) {
      const Quantities& of_state = batched[static_cast<std::size_t>(k)];
      if (k != kSpoilt[0] && k != kSpoilt[1]) {
        expectBits(of_state, healthy);
        continue;
      }
      expectSpoilt(of_state, by_templates, depends, "batch");
      expectSame(of_state, alone, "batch");
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
