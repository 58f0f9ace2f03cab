// SPDX-License-Identifier: Apache-2.0

#include "chain_dynamics/fast_model.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "allocation_guard.hpp"
#include "chain_dynamics/error.hpp"
#include "fast_model_check.hpp"
#include "quantities.hpp"
#include "robot.hpp"

namespace chain_dynamics {
namespace {

using namespace test;  // NOLINT(google-build-using-namespace)
using Eigen::MatrixXd;
using Eigen::VectorXd;

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

/// A tip that lies and points anywhere, and a root as well.
Model withEnds(const Model& model) {
  Random random(5);
  const Chain& chain = model.chain;
  std::vector<Joint> joints = chain.joints();
  joints[0].placement = Transform<double>{random.rotation(), random.vector3()};
  Model result = model;
  result.chain = Chain(chain.name(), joints, chain.links(), chain.gravity(),
                       {random.rotation(), 0.3 * random.vector3()});
  return result;
}

std::vector<State<double>> randomStates(Index n, Index count) {
  Random random(7);
  std::vector<State<double>> states;
  for (Index k = 0; k < count; ++k) {
    states.push_back({3 * random.vector(n), 2 * random.vector(n), 5 * random.vector(n)});
  }
  return states;
}

/// Numbers of one state, the same bits.
void expectBits(const Quantities& found, const Quantities& expected) {
  for (const auto& [name, values] : found) EXPECT_EQ(values, expected.at(name)) << name;
}

class FastModelOn : public ::testing::TestWithParam<std::string> {};

TEST_P(FastModelOn, EqualsThePlainFunctions) {
  for (const auto& [name, like] : models()) {
    for (std::uint32_t seed = 0; seed < 5; ++seed) {
      const Model model = seed < 3 ? like : withEnds(like);
      const FastModel fast(model, GetParam());
      const State<double> x = randomState(model.chain, seed);
      SCOPED_TRACE(name + "\n" + paste(model.chain, x));
      expectEqual(single(fast, x), plain(model, x), model, x, 4 * rounding(model.chain));
      if (HasFailure()) return;
    }
  }
}

// Batches of every size, so that the last pack is full, nearly empty and alone.
TEST_P(FastModelOn, BatchesEqualSingleCallsInAnyLayout) {
  for (const auto& [name, like] : models()) {
    const Model model = withEnds(like);
    const Index n = model.chain.jointCount();
    const FastModel fast(model, GetParam());
    for (const Index count : {0, 1, 3, 8, 21}) {
      if (n > 30 && count > 8) continue;
      const auto states = randomStates(n, count);
      for (const Layout& layout : layouts()) {
        SCOPED_TRACE(name + ", " + layout.name + ", " + std::to_string(count) + " states");
        const auto results = batch(fast, states, n, layout);
        for (std::size_t k = 0; k < states.size(); ++k) {
          expectEqual(results[k], single(fast, states[k]), model, states[k], 1e-12);
        }
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
    auto states = randomStates(n, 19);
    states[5].q[0] = 1e9;  // beyond the kernels' own sine and cosine, its neighbours within
    const Layout columns = layouts()[0];
    const auto all = batch(fast, states, n, columns);
    for (std::size_t k = 0; k < states.size(); ++k) {
      expectBits(batch(fast, {states[k]}, n, columns)[0], all[k]);
      if (HasFailure()) return;
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

TEST_P(FastModelOn, SlopesOfFrictionAreFiniteForAnyVelocity) {
  const Model model = identified(randomChain(3), false, false, 5);
  const FastModel fast(model, GetParam());
  State<double> x = randomState(model.chain, 1);
  for (const double qd : {1e3, -1e5, 0.0}) {
    x.qd.setConstant(qd);
    EXPECT_TRUE(single(fast, x).at("by qd").allFinite()) << qd;
  }
}

TEST_P(FastModelOn, AJointThatMovesNothingHasNoFiniteAcceleration) {
  const Chain chain("nothing", {randomChain(1).joints()[0]}, {LinkParameters::zero()}, {0, 0, -9});
  const FastModel fast(Model(chain), GetParam());
  EXPECT_FALSE(std::isfinite(single(fast, randomState(chain, 1)).at("qdd")(0)));
}

// What is known of the state has been read before anything is written.
TEST_P(FastModelOn, VectorsMayBeWrittenWhereAnInputStands) {
  for (const auto& [name, model] : models()) {
    const Index n = model.chain.jointCount();
    const FastModel fast(model, GetParam());
    const State<double> x = randomState(model.chain, 1);
    const Quantities alone = single(fast, x);
    SCOPED_TRACE(name);
    for (VectorXd State<double>::*argument :
         {&State<double>::q, &State<double>::qd, &State<double>::qdd}) {
      State<double> y = x;
      double* const out = (y.*argument).data();
      fast.torques(y.q.data(), y.qd.data(), y.qdd.data(), out);
      EXPECT_EQ(y.*argument, alone.at("tau"));
      y = x;
      fast.coriolisVector(y.q.data(), y.qd.data(), out);
      EXPECT_EQ(y.*argument, alone.at("c"));
      y = x;
      fast.gravityVector(y.q.data(), out);
      EXPECT_EQ(y.*argument, alone.at("g"));
    }
    for (const bool swapped : {false, true}) {
      State<double> y = x;
      MatrixXd H(n, n);
      fast.dynamicComponents(y.q.data(), y.qd.data(), H.data(), n,
                             swapped ? y.qd.data() : y.q.data(),
                             swapped ? y.q.data() : y.qd.data());
      EXPECT_EQ(swapped ? y.qd : y.q, alone.at("c of components"));
      EXPECT_EQ(swapped ? y.q : y.qd, alone.at("g of components"));
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
    MatrixXd out(n, 19), in_place = q;
    fast.torquesBatch(q, q, q, out);
    fast.torquesBatch(in_place, in_place, in_place, in_place);
    ASSERT_EQ(in_place, out) << name;
    in_place = q;
    fast.forwardDynamicsBatch(q, q, q, out);
    fast.forwardDynamicsBatch(in_place, in_place, in_place, in_place);
    ASSERT_EQ(in_place, out) << name;
  }
}

// Only its direction counts: where the root stands is nothing to anything but the tip's position.
TEST_P(FastModelOn, PlaceOfTheFirstJointMakesNoDifference) {
  for (const auto& [name, model] : models()) {
    if (model.chain.jointCount() > 9) continue;
    const State<double> x = randomState(model.chain, 1);
    const auto at = [&, like = model](const Eigen::Vector3d& p) {
      Model moved = like;
      std::vector<Joint> joints = like.chain.joints();
      joints[0].placement.p = p;
      moved.chain = Chain("moved", joints, like.chain.links(), like.chain.gravity());
      Quantities all = single(FastModel(moved, GetParam()), x);
      all.erase("p");
      return all;
    };
    SCOPED_TRACE(name);
    for (const double away : {1e3, 1e14, 1e50}) {
      expectBits(at({away, -away, away}), at(Eigen::Vector3d::Zero()));
    }
    if (HasFailure()) return;
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
    expectEqual(single(fast, x), plain(model, x), model, x, 4 * rounding(model.chain));
  }
}

// Up to sixteen joints in batches: longer ones allocate for derivatives and Coriolis matrices.
TEST_P(FastModelOn, NoCallAllocates) {
  if (!kAllocationGuardWorks) {
    GTEST_SKIP() << "allocations are counted with the GNU C library, without sanitizers";
  }
  for (const auto& [name, model] : models()) {
    const Index n = model.chain.jointCount();
    const FastModel fast(model, GetParam());
    OneState one(randomState(model.chain, 1));
    ManyStates many(randomStates(n, 11), n, layouts()[0]);
    for (const Calls& calls : {one.callsOf(fast), many.callsOf(fast)}) {
      for (const auto& [quantity, call] : calls) {
        const AllocationGuard guard;
        call();
        EXPECT_TRUE(guard.count() == 0 ||
                    (n > 16 && (quantity == "derivatives" || quantity == "C")))
            << name << ", " << quantity;
      }
    }
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
      const Quantities found = single(fast, x);
      expectBits(found, single(FastModel(changed, set), x));
      EXPECT_NE(found.at("g"), single(original, x).at("g"));
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
