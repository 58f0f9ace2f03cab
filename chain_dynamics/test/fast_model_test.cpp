// SPDX-License-Identifier: Apache-2.0

#include "chain_dynamics/fast_model.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "allocation_guard.hpp"
#include "chain_dynamics/error.hpp"
#include "example_models.hpp"
#include "fast_model_check.hpp"
#include "robot.hpp"

namespace chain_dynamics {
namespace {

using namespace test;  // NOLINT(google-build-using-namespace)
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Every quantity of one state, as one column of numbers: H, c, g, f, tau.
struct Terms {
  explicit Terms(Index n) : H(n, n), c(n), g(n), f(n), tau(n) {}
  MatrixXd H;
  VectorXd c, g, f, tau;
};

Terms termsOf(const Model& model, const State<double>& x) {
  Terms t(model.chain.jointCount());
  dynamicComponents(model, x.q, x.qd, t.H, t.c, t.g);
  frictionVector(model, x.q, x.qd, t.f);
  torques(model, x.q, x.qd, x.qdd, t.tau);
  t.tau += t.f;
  return t;
}

Terms termsOf(const FastModel& fast, const State<double>& x) {
  Terms t(x.q.size());
  fast.inertiaMatrix(x.q.data(), t.H.data(), t.H.outerStride());
  fast.coriolisVector(x.q.data(), x.qd.data(), t.c.data());
  fast.gravityVector(x.q.data(), t.g.data());
  fast.frictionVector(x.q.data(), x.qd.data(), t.f.data());
  fast.torques(x.q.data(), x.qd.data(), x.qdd.data(), t.tau.data());
  return t;
}

Terms componentsOf(const FastModel& fast, const State<double>& x) {
  Terms t = termsOf(fast, x);
  fast.dynamicComponents(x.q.data(), x.qd.data(), t.H.data(), t.H.outerStride(), t.c.data(),
                         t.g.data());
  return t;
}

void expectEqual(const Terms& a, const Terms& b, const State<double>& x, double tolerance) {
  const double inertial = largest(b.H.cwiseAbs() * x.qdd.cwiseAbs());
  const double size = inertial + largest(b.c) + largest(b.g) + largest(b.f);
  const double speed = std::max(1.0, x.qd.squaredNorm());
  EXPECT_TRUE(agree(a.H, b.H, largest(b.H), tolerance)) << "H";
  EXPECT_TRUE(agree(a.c, b.c, largest(b.c) + largest(b.H) * speed, tolerance)) << "c";
  EXPECT_TRUE(agree(a.g, b.g, std::max(1.0, largest(b.g)), tolerance)) << "g";
  EXPECT_TRUE(agree(a.f, b.f, std::max(1.0, largest(b.f)), tolerance)) << "f";
  EXPECT_TRUE(agree(a.tau, b.tau, size + largest(b.H) * speed, tolerance)) << "tau";
}

const fast::ManyKernels& manyKernelsNamed(const std::string& name) {
  constexpr int kAnyJoints = 0;
#ifdef CHAIN_DYNAMICS_KERNELS_V3
  if (name == "v3") return fast::manyKernelsV3(kAnyJoints);
#endif
#ifdef CHAIN_DYNAMICS_KERNELS_V4
  if (name == "v4") return fast::manyKernelsV4(kAnyJoints);
#endif
  EXPECT_EQ(name, "portable");
  return fast::manyKernelsPortable(kAnyJoints);
}

/// Memory of one number per joint and state, in some layout.
class Layout {
 public:
  Layout(Index n, Index count, Index joint_step, Index state_step)
      : n_(n), count_(count), joint_step_(joint_step), state_step_(state_step) {
    const Index size = n * std::abs(joint_step) + count * std::abs(state_step) + 1;
    numbers_ = VectorXd::Constant(2 * size, std::numeric_limits<double>::quiet_NaN());
    first_ = size;
  }
  double& operator()(Index j, Index k) {
    return numbers_[first_ + j * joint_step_ + k * state_step_];
  }
  ConstStates in() const {
    return {numbers_.data() + first_, n_, count_, joint_step_, state_step_};
  }
  States out() { return {numbers_.data() + first_, n_, count_, joint_step_, state_step_}; }

 private:
  Index n_, count_, joint_step_, state_step_;
  VectorXd numbers_;
  Index first_ = 0;
};

/// H of state k has its entry (i, j) at (i, j + k n) of a matrix with a row too many.
struct Batch {
  Batch(Index n, Index count, Index joint_step, Index state_step)
      : q(n, count, joint_step, state_step), qd(q), qdd(q), tau(q), c(q), g(q), f(q) {
    H = MatrixXd::Constant(n + 1, n * count, std::numeric_limits<double>::quiet_NaN());
  }
  StridedMatrices matrices() { return H.topRows(H.rows() - 1); }
  Layout q, qd, qdd, tau, c, g, f;
  MatrixXd H;
};

void compute(const FastModel& fast, Batch& b) {
  fast.inertiaMatrixBatch(b.q.in(), b.matrices());
  const MatrixXd H = b.H;
  b.H.setConstant(std::numeric_limits<double>::quiet_NaN());
  fast.dynamicComponentsBatch(b.q.in(), b.qd.in(), b.matrices(), b.tau.out(), b.f.out());
  EXPECT_TRUE((H.topRows(H.rows() - 1).array() == b.H.topRows(H.rows() - 1).array()).all());
  fast.coriolisVectorBatch(b.q.in(), b.qd.in(), b.c.out());
  fast.gravityVectorBatch(b.q.in(), b.g.out());
  fast.torquesBatch(b.q.in(), b.qd.in(), b.qdd.in(), b.tau.out());
  fast.frictionVectorBatch(b.q.in(), b.qd.in(), b.f.out());
}

void expectBatchEqual(const FastModel& fast, Index n, Index count, Index joint_step,
                      Index state_step) {
  Random random(7);
  Batch batch(n, count, joint_step, state_step);
  std::vector<State<double>> states;
  for (Index k = 0; k < count; ++k) {
    states.push_back({3 * random.vector(n), 2 * random.vector(n), 5 * random.vector(n)});
    for (Index j = 0; j < n; ++j) {
      batch.q(j, k) = states.back().q[j];
      batch.qd(j, k) = states.back().qd[j];
      batch.qdd(j, k) = states.back().qdd[j];
    }
  }
  compute(fast, batch);
  for (Index k = 0; k < count; ++k) {
    Terms terms(n);
    terms.H = batch.H.block(0, k * n, n, n);
    for (Index j = 0; j < n; ++j) {
      terms.c[j] = batch.c(j, k);
      terms.g[j] = batch.g(j, k);
      terms.f[j] = batch.f(j, k);
      terms.tau[j] = batch.tau(j, k);
    }
    expectEqual(terms, termsOf(fast, states[static_cast<std::size_t>(k)]),
                states[static_cast<std::size_t>(k)], 1e-12);
  }
}

class FastModelOn : public ::testing::TestWithParam<std::string> {};

TEST_P(FastModelOn, EqualsThePlainFunctions) {
  for (const auto& [name, model] : models()) {
    const FastModel fast(model, GetParam());
    for (std::uint32_t seed = 0; seed < 5; ++seed) {
      const State<double> x = randomState(model.chain, seed);
      SCOPED_TRACE(name + "\n" + paste(model.chain, x));
      const Terms plain = termsOf(model, x);
      const double tolerance = 4 * rounding(model.chain);
      expectEqual(termsOf(fast, x), plain, x, tolerance);
      expectEqual(componentsOf(fast, x), plain, x, tolerance);
      if (HasFailure()) return;
    }
  }
}

// Batches of every size, so that the last pack is full, nearly empty and alone; states as columns,
// as rows, and with gaps.
TEST_P(FastModelOn, BatchesEqualSingleCallsInAnyLayout) {
  for (const auto& [name, model] : models()) {
    const Index n = model.chain.jointCount();
    if (n > 30) continue;
    SCOPED_TRACE(name);
    const FastModel fast(model, GetParam());
    for (const Index count : {0, 1, 3, 8, 21}) {
      for (const auto& [joint_step, state_step] : {std::pair<Index, Index>{1, n},
                                                   {std::max<Index>(count, 1), 1},
                                                   {2, 2 * n + 3},
                                                   {-1, -n}}) {
        expectBatchEqual(fast, n, count, joint_step, state_step);
        if (HasFailure()) return;
      }
    }
  }
}

// Each lane is a computation of its own: what the others hold, and how many there are, is nothing
// to it.
TEST_P(FastModelOn, AStateHasTheSameBitsWhereverItStandsInABatch) {
  for (const auto& [name, model] : models()) {
    const Index n = model.chain.jointCount();
    if (n > 9) continue;
    SCOPED_TRACE(name);
    const FastModel fast(model, GetParam());
    Random random(3);
    const Index count = 19;
    MatrixXd q = 3 * random.vector(n * count).reshaped(n, count);
    const MatrixXd qd = 2 * q;
    const MatrixXd qdd = -q;
    MatrixXd all(n, count);
    MatrixXd alone(n, 1);
    q(0, 5) = 1e9;  // beyond the kernels' own sine and cosine, its neighbours within
    fast.torquesBatch(q, qd, qdd, all);
    for (Index k = 0; k < count; ++k) {
      fast.torquesBatch(q.col(k), qd.col(k), qdd.col(k), alone);
      ASSERT_EQ(alone, all.col(k)) << "state " << k;
    }
  }
}

// Row i of the torques depends on all joints, as no axis of this arm meets or parallels another.
TEST_P(FastModelOn, NanGoesToEveryEntry) {
  const Model model(revolute(randomChain(6)));
  const FastModel fast(model, GetParam());
  for (VectorXd State<double>::*argument :
       {&State<double>::q, &State<double>::qd, &State<double>::qdd}) {
    for (Index j = argument == &State<double>::q ? 1 : 0; j < 6; ++j) {
      State<double> x = randomState(model.chain, 1);
      (x.*argument)[j] = std::numeric_limits<double>::quiet_NaN();
      const VectorXd tau = termsOf(fast, x).tau;
      EXPECT_TRUE(tau.array().isNaN().all()) << "joint " << j << ": " << tau.transpose();
    }
  }
}

TEST_P(FastModelOn, FrictionOfNanIsNanAndThatOfAnyVelocityIsFinite) {
  const Model model = identified(randomChain(9), false, false, 5);
  const FastModel fast(model, GetParam());
  const VectorXd q = VectorXd::Constant(9, 0.3);
  VectorXd f(9);
  for (const double velocity : {0.0, 1e-300, 1e3, 1e200, std::numeric_limits<double>::max() / 4}) {
    for (const double sign : {-1.0, 1.0}) {
      const VectorXd qd = VectorXd::Constant(9, sign * velocity);
      fast.frictionVector(q.data(), qd.data(), f.data());
      EXPECT_TRUE(f.allFinite()) << sign * velocity << ": " << f.transpose();
    }
  }
  const VectorXd nan = VectorXd::Constant(9, std::numeric_limits<double>::quiet_NaN());
  fast.frictionVector(q.data(), nan.data(), f.data());
  EXPECT_TRUE(f.array().isNaN().all()) << f.transpose();
}

// What is known of the state has been read before anything is written.
TEST_P(FastModelOn, VectorsMayBeWrittenWhereAnInputStands) {
  for (const auto& [name, model] : models()) {
    const Index n = model.chain.jointCount();
    const FastModel fast(model, GetParam());
    const State<double> x = randomState(model.chain, 1);
    const Terms alone = termsOf(fast, x);
    SCOPED_TRACE(name);
    for (VectorXd State<double>::*argument :
         {&State<double>::q, &State<double>::qd, &State<double>::qdd}) {
      State<double> y = x;
      double* const out = (y.*argument).data();
      fast.torques(y.q.data(), y.qd.data(), y.qdd.data(), out);
      EXPECT_EQ(y.*argument, alone.tau);
      y = x;
      fast.coriolisVector(y.q.data(), y.qd.data(), out);
      EXPECT_EQ(y.*argument, alone.c);
      y = x;
      fast.gravityVector(y.q.data(), out);
      EXPECT_EQ(y.*argument, alone.g);
    }
    for (const bool swapped : {false, true}) {
      State<double> y = x;
      VectorXd& c = swapped ? y.qd : y.q;
      VectorXd& g = swapped ? y.q : y.qd;
      MatrixXd H(n, n);
      fast.dynamicComponents(y.q.data(), y.qd.data(), H.data(), n, c.data(), g.data());
      EXPECT_TRUE(agree(c, alone.c, 1 + largest(alone.c) + largest(alone.H), 1e-13 * n));
      EXPECT_TRUE(agree(g, alone.g, 1 + largest(alone.g), 1e-13 * n));
    }
    if (HasFailure()) return;
  }
}

TEST_P(FastModelOn, VectorsOfABatchMayBeWrittenWhereAnInputStands) {
  for (const auto& [name, model] : models()) {
    const Index n = model.chain.jointCount();
    const FastModel fast(model, GetParam());
    Random random(3);
    const MatrixXd q = random.vector(n * 19).reshaped(n, 19);
    MatrixXd tau(n, 19);
    fast.torquesBatch(q, q, q, tau);
    MatrixXd in_place = q;
    fast.torquesBatch(in_place, in_place, in_place, in_place);
    ASSERT_EQ(in_place, tau) << name;
  }
}

// Only its direction counts: where the root stands is nothing to the torques.
TEST_P(FastModelOn, PlaceOfTheFirstJointMakesNoDifference) {
  for (const Index n : {1, 6, 7, 9}) {
    const Chain chain = rightAngled(n, 2, true);
    const State<double> x = randomState(chain, 1);
    const Terms here = termsOf(FastModel(Model(chain), GetParam()), x);
    for (const double away : {1e3, 1e14, 1e50}) {
      std::vector<Joint> joints = chain.joints();
      joints[0].placement.p << away, -away, away;
      const Model moved(Chain("moved", joints, chain.links(), chain.gravity()));
      const Terms there = termsOf(FastModel(moved, GetParam()), x);
      EXPECT_EQ(there.tau, here.tau) << n << " joints, " << away << " m";
      EXPECT_EQ(there.H, here.H) << n << " joints, " << away << " m";
    }
  }
}

// |error| of sine and cosine: half a unit in the last place of numbers below one is 5.6e-17, once
// for the angle within a quarter turn and, with the term before the last, twice for the result.
constexpr double kTurnError = 1.7e-16;

TEST_P(FastModelOn, SineAndCosineAreThoseOfTheLibraryAtAnyAngle) {
  const fast::ManyKernels& kernels = manyKernelsNamed(GetParam());
  Random random(11);
  for (const double range : {1e-9, 0.8, 3.2, 100.0, 1e4, 1.6e6, 1.7e6, 1e15, 1e300}) {
    for (int k = 0; k < 2000; ++k) {
      const double angle = range * random();
      const double quarter_turns = k % 4;
      double s = 0;
      double c = 0;
      kernels.sine_cosine(1, &angle, &quarter_turns, &s, &c);
      long double expected_s = std::sin(static_cast<long double>(angle));
      long double expected_c = std::cos(static_cast<long double>(angle));
      for (int turn = 0; turn < k % 4; ++turn) {
        std::swap(expected_s, expected_c);
        expected_c = -expected_c;
      }
      ASSERT_LE(std::abs(static_cast<double>(s - expected_s)), kTurnError) << angle;
      ASSERT_LE(std::abs(static_cast<double>(c - expected_c)), kTurnError) << angle;
    }
  }
}

TEST_P(FastModelOn, LargeAnglesInOneJointLeaveTheOthersRight) {
  const Model model(revolute(randomChain(7)));
  const FastModel fast(model, GetParam());
  for (const double angle : {1e4, 1e7, -3e12}) {
    State<double> x = randomState(model.chain, 2);
    x.q[3] = angle;
    expectEqual(termsOf(fast, x), termsOf(model, x), x, rounding(model.chain));
  }
}

TEST_P(FastModelOn, NoCallAllocates) {
  if (!CHAIN_DYNAMICS_COUNTS_ALLOCATIONS) {
    GTEST_SKIP() << "allocations are counted with the GNU C library, without sanitizers";
  }
  for (const auto& [name, model] : models()) {
    const FastModel fast(model, GetParam());
    const State<double> x = randomState(model.chain, 1);
    Terms terms(x.q.size());
    const Index n = x.q.size();
    const AllocationGuard guard;
    fast.torques(x.q.data(), x.qd.data(), x.qdd.data(), terms.tau.data());
    fast.dynamicComponents(x.q.data(), x.qd.data(), terms.H.data(), n, terms.c.data(),
                           terms.g.data());
    fast.frictionVector(x.q.data(), x.qd.data(), terms.f.data());
    fast.torquesBatch(x.q, x.qd, x.qdd, terms.tau);
    EXPECT_EQ(guard.count(), 0) << name;
  }
}

INSTANTIATE_TEST_SUITE_P(Every, FastModelOn, ::testing::ValuesIn(FastModel::instructionSets()),
                         [](const auto& test) { return test.param; });

TEST(FastModel, UsesTheBestInstructionSetAsItEqualsThePlainFunctions) {
  for (const auto& [name, model] : models()) {
    EXPECT_EQ(FastModel(model).instructionSet(), FastModel::instructionSets().back()) << name;
  }
}

// --- which kernels are chosen ---

// The same chain with all lengths and masses multiplied.
Chain scaledChain(const Chain& chain, double length, double mass) {
  std::vector<Joint> joints = chain.joints();
  std::vector<LinkParameters> links = chain.links();
  for (Joint& joint : joints) {
    joint.placement.p *= length;
    joint.rotor_inertia *= mass * length * length;
  }
  for (LinkParameters& link : links) {
    link.mass *= mass;
    link.first_moment *= mass * length;
    link.inertia *= mass * length * length;
  }
  return Chain("scaled", joints, links, chain.gravity());
}

TEST(FastModelCheck, SeesAMillionthOfAMassInARobotOfAnySize) {
  for (const double length : {1e-3, 1.0, 1e3}) {
    for (const double mass : {1e-6, 1.0, 1e6}) {
      const Chain chain = scaledChain(randomChain(5), length, mass);
      std::vector<LinkParameters> links = chain.links();
      links[4].mass *= 1 + 1e-6;
      const Model other(Chain("other", chain.joints(), links, chain.gravity()));
      const FastModel fast{Model(chain)};
      EXPECT_TRUE(equalsPlain(fast, Model(chain))) << length << " m " << mass << " kg";
      EXPECT_FALSE(equalsPlain(fast, other)) << length << " m " << mass << " kg";
    }
  }
}

TEST(FastModelCheck, SeesNan) {
  Model model(randomChain(3));
  model.friction.resize(3, ViscousCoulombOffset{0, 0, 0});
  const FastModel fast(model);
  model.friction[1] = ViscousCoulombOffset{std::numeric_limits<double>::quiet_NaN(), 0, 0};
  EXPECT_FALSE(equalsPlain(fast, model));
}

TEST(FastModelCheck, BetterInstructionSetThatDiffersIsPassedOverWithAWarning) {
  const std::vector<std::string> sets = {"portable", "v3", "v4"};
  const Choice best = bestEqual("arm", sets, [](std::size_t) { return true; });
  EXPECT_EQ(best.index, 2U);
  EXPECT_TRUE(best.warnings.empty());
  const Choice second = bestEqual("arm", sets, [](std::size_t k) { return k < 2; });
  EXPECT_EQ(second.index, 1U);
  ASSERT_EQ(second.warnings.size(), 1U);
  EXPECT_THAT(second.warnings[0], ::testing::HasSubstr("fast model of arm: instruction set v4"));
  EXPECT_THAT(errorOf([&] { bestEqual("arm", sets, [](std::size_t) { return false; }); }),
              ::testing::AllOf(::testing::HasSubstr("fast model of arm: numbers"),
                               ::testing::HasSubstr("portable, v3, v4")));
}

TEST(FastModel, RefusesNumbersThatOverflow) {
  Model model(randomChain(3));
  model.friction.resize(3, ViscousCoulombOffset{1e308, 0, 0});
  EXPECT_THAT(errorOf([&] { const FastModel fast(model); }),
              ::testing::HasSubstr("fast model of random3: numbers: expected finite ones"));
}

TEST(FastModel, RefusesAModelWhosePartsDontFit) {
  Model model(randomChain(3));
  model.friction.resize(2, ViscousCoulombOffset{0, 0, 0});
  EXPECT_THAT(errorOf([&] { const FastModel fast(model); }), ::testing::HasSubstr("friction"));
  model.friction.clear();
  model.row_parameters.resize(3);
  EXPECT_THAT(errorOf([&] { const FastModel fast(model, "portable"); }),
              ::testing::HasSubstr("links: expected one per joint (3), got 0"));
}

TEST(FastModel, OfAChangedModelGivesTheBitsOfOneMadeForIt) {
  const auto body = LinkParameters::fromCenterOfMass(3.1, {0.02, -0.05, 0.11},
                                                     Eigen::Vector3d(0.1, 0.2, 0.25).asDiagonal());
  for (const std::string& set : FastModel::instructionSets()) {
    for (const auto& [name, model] : models()) {
      SCOPED_TRACE(name + ", " + set);
      const FastModel original(model, set);
      Model changed = withBodyAtTip(model, body);
      changed.chain = changed.chain.withGravity({1.0, -2.0, 3.0});
      const FastModel fast(changed, original);
      EXPECT_EQ(fast.instructionSet(), set);
      const auto x = randomState(model.chain, 1);
      const Terms found = componentsOf(fast, x);
      const Terms expected = componentsOf(FastModel(changed, set), x);
      EXPECT_EQ(found.H, expected.H);
      EXPECT_EQ(found.c, expected.c);
      EXPECT_EQ(found.g, expected.g);
      EXPECT_EQ(found.f, expected.f);
      EXPECT_EQ(found.tau, expected.tau);
      EXPECT_NE(found.g, componentsOf(original, x).g);
    }
  }
}

TEST(FastModel, RefusesAChangedModelWithOtherJoints) {
  const FastModel original(Model(randomChain(3)));
  EXPECT_THAT(errorOf([&] { const FastModel fast(Model(randomChain(4)), original); }),
              ::testing::AllOf(::testing::HasSubstr("joints: expected 3, as the original has"),
                               ::testing::HasSubstr("got 4")));
  Model broken(randomChain(3));
  broken.row_parameters.resize(3);
  EXPECT_THAT(errorOf([&] { const FastModel fast(broken, original); }),
              ::testing::HasSubstr("links: expected one per joint (3), got 0"));
}

TEST(FastModel, RefusesAChainThatIsTooLong) {
  const Model model(randomChain(65));
  EXPECT_THAT(errorOf([&] { const FastModel fast(model); }),
              ::testing::AllOf(::testing::HasSubstr("fast model of random65: joints"),
                               ::testing::HasSubstr("expected at most 64, got 65"),
                               ::testing::HasSubstr("use the functions of model.hpp")));
}

TEST(FastModel, RefusesAnInstructionSetThatIsNotThere) {
  EXPECT_THAT(
      errorOf([&] { const FastModel fast(Model(randomChain(2)), "altivec"); }),
      ::testing::AllOf(::testing::HasSubstr("instruction set"), ::testing::HasSubstr("portable"),
                       ::testing::HasSubstr("got altivec")));
}

}  // namespace
}  // namespace chain_dynamics
