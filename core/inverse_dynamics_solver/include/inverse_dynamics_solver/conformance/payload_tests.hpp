// SPDX-License-Identifier: Apache-2.0
/// @file
/// Conformance, part seven: bodies at the tip and gravity that change while others compute. Include
/// conformance_tests.hpp, not this.
#pragma once

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <atomic>
#include <cmath>
#include <cstddef>
#include <exception>
#include <functional>
#include <iomanip>
#include <limits>
#include <sstream>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "chain_dynamics/robot_description.hpp"
#include "inverse_dynamics_solver/conformance/allocation_guard.hpp"
#include "inverse_dynamics_solver/conformance/capabilities.hpp"
#include "inverse_dynamics_solver/conformance/initialization_tests.hpp"
#include "inverse_dynamics_solver/conformance/real_time_tests.hpp"
#include "inverse_dynamics_solver/payload.hpp"
#include "inverse_dynamics_solver/variable_gravity.hpp"

namespace inverse_dynamics_solver::conformance {

/// [N m, kg m^2; N, kg for slides] Absolute, on torques of some hundred N m: two lumped bodies on the
/// way are a few dozen products of numbers around one.
constexpr double kFixedLink = 1e-10;

/// A body without any symmetry, in a frame that is turned and moved.
inline RigidBody tool() {
  RigidBody body{3.1};
  body.center_of_mass = {0.02, -0.05, 0.11};
  const Eigen::Matrix3d R = Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, 3).normalized()).matrix();
  body.inertia = R * Eigen::Vector3d(0.011, 0.02, 0.025).asDiagonal() * R.transpose();
  body.frame.R = (Eigen::AngleAxisd(0.9, Eigen::Vector3d::UnitZ()) *
                  Eigen::AngleAxisd(-0.3, Eigen::Vector3d::UnitY()) *
                  Eigen::AngleAxisd(0.4, Eigen::Vector3d::UnitX()))
                     .matrix();
  body.frame.p = {0.03, 0.02, 0.1};
  return body;
}

/// The same as parameters below a prefix.
inline ParameterMap toolParameters(const std::string& prefix) {
  const Eigen::Matrix3d I = tool().inertia;
  return {{prefix + "mass", 3.1},
          {prefix + "center_of_mass", std::vector<double>{0.02, -0.05, 0.11}},
          {prefix + "inertia",
           std::vector<double>{I(0, 0), I(0, 1), I(0, 2), I(1, 1), I(1, 2), I(2, 2)}},
          {prefix + "frame.xyz", std::vector<double>{0.03, 0.02, 0.1}},
          {prefix + "frame.rpy", std::vector<double>{0.4, -0.3, 0.9}}};
}

/// And as a fixed link of a robot description.
inline std::string withToolAsLink(const std::string& urdf, const std::string& parent) {
  const Eigen::Matrix3d I = tool().inertia;
  std::ostringstream link;
  link.precision(17);
  link << "<link name='a_tool'><inertial><origin xyz='0.02 -0.05 0.11'/><mass value='3.1'/><inertia"
       << " ixx='" << I(0, 0) << "' ixy='" << I(0, 1) << "' ixz='" << I(0, 2) << "' iyy='"
       << I(1, 1) << "' iyz='" << I(1, 2) << "' izz='" << I(2, 2) << "'/></inertial></link>"
       << "<joint name='a_tool_joint' type='fixed'><parent link='" << parent << "'/><child "
       << "link='a_tool'/><origin xyz='0.03 0.02 0.1' rpy='0.4 -0.3 0.9'/></joint>";
  const std::size_t end = urdf.rfind("</robot>");
  return end == std::string::npos ? urdf : urdf.substr(0, end) + link.str() + urdf.substr(end);
}

/// A point mass, the simplest body.
inline RigidBody pointMass() {
  RigidBody body{1.7};
  body.center_of_mass = {-0.08, 0.03, 0.2};
  return body;
}

// The capability of the fixture's solver, which a test is about; without it the test is skipped.
#define INVERSE_DYNAMICS_SOLVER_REQUIRE(Capability, name)            \
  Capability* const name = dynamic_cast<Capability*>(solver_.get()); \
  if (name == nullptr) GTEST_SKIP() << "this solver has no " #Capability

inline ::testing::AssertionResult identicalAll(const std::vector<Eigen::VectorXd>& a,
                                               const std::vector<Eigen::VectorXd>& b) {
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (!identical(a[i], b[i])) {
      return ::testing::AssertionFailure()
             << quantities()[i % quantities().size()].name << ": " << std::setprecision(17)
             << a[i].transpose() << " and " << b[i].transpose();
    }
  }
  return ::testing::AssertionSuccess();
}

TEST_P(SolverConformance, BodiesAddWhatEachAddsAlone) {
  initialize(*solver_, {{"friction", false}});
  INVERSE_DYNAMICS_SOLVER_REQUIRE(Payload, payload);
  const std::vector<State> states = randomStates(kStates);
  const auto now = [&] { return fingerprint(*solver_, states); };
  const auto none = now();
  payload->setPayload("tool", tool());
  const auto one = now();
  payload->setPayload("part", pointMass());
  const auto both = now();
  payload->removePayload("tool");
  const auto other = now();
  bool changed = false;
  for (std::size_t i = 0; i < none.size(); ++i) {
    const Eigen::VectorXd sum = (one[i] - none[i]) + (other[i] - none[i]);
    const double size = sizeOf(none[i]) + sizeOf(one[i]) + sizeOf(other[i]);
    EXPECT_TRUE(near(both[i] - none[i], sum, kRounding, size))
        << quantities()[i % quantities().size()].name;
    changed = changed || sum.norm() > 1e-3;
  }
  EXPECT_TRUE(changed) << "the bodies have no effect";
}

TEST_P(SolverConformance, NumbersDependOnTheBodiesThatAreThereAlone) {
  INVERSE_DYNAMICS_SOLVER_REQUIRE(Payload, payload);
  const std::vector<State> states = randomStates(kStates);
  const auto now = [&] { return fingerprint(*solver_, states); };
  const auto none = now();
  EXPECT_FALSE(payload->removePayload("tool"));

  payload->setPayload("tool", tool());
  const auto with_tool = now();
  payload->setPayload("part", pointMass());
  const auto both = now();
  EXPECT_EQ(payload->payloads(), (Payloads{{"part", pointMass()}, {"tool", tool()}}));
  EXPECT_TRUE(payload->removePayload("part"));
  EXPECT_TRUE(identicalAll(now(), with_tool));
  EXPECT_TRUE(payload->removePayload("tool"));
  EXPECT_FALSE(payload->removePayload("tool"));
  EXPECT_TRUE(identicalAll(now(), none)) << "a body that was taken away is still there";

  // In another order, over others of the same name, at once.
  payload->setPayload("part", tool());
  payload->setPayload("tool", pointMass());
  payload->setPayload("tool", tool());
  payload->setPayload("part", pointMass());
  EXPECT_TRUE(identicalAll(now(), both));
  payload->clearPayloads();
  EXPECT_TRUE(payload->payloads().empty());
  EXPECT_TRUE(identicalAll(now(), none));

  // Those of initialize() are the parameters'.
  payload->setPayload("tool", tool());
  initialize(*solver_);
  EXPECT_TRUE(payload->payloads().empty());
  EXPECT_TRUE(identicalAll(now(), none));
}

/// The first tip, or the link that the last joint moves, in the description; empty without one.
inline std::string lastLink(const TestedSolver& tested, const InverseDynamicsSolver& solver) {
  if (tested.robotDescription().empty()) return "";
  if (!solver.tipNames().front().empty()) return solver.tipNames().front();
  try {
    const auto robot = chain_dynamics::robotFromUrdf(tested.robotDescription());
    return robot.links[robot.joints[robot.jointIndex(solver.jointNames().back())].child].name;
  } catch (const std::exception&) {
    return "";
  }
}

TEST_P(SolverConformance, BodyEqualsAFixedLinkOfTheDescription) {
  INVERSE_DYNAMICS_SOLVER_REQUIRE(Payload, payload);
  const std::string link = lastLink(GetParam(), *solver_);
  if (link.empty()) GTEST_SKIP() << "this solver needs no robot description";
  const std::vector<State> states = randomStates(kStates);
  ParameterMap parameters = GetParam().parameters();
  std::vector<std::string> tip = solver_->tipNames();
  tip.front() = link;
  parameters["tip"] = tip;
  const auto described = make();
  described->initialize(parameters, "", withToolAsLink(GetParam().robotDescription(), link));
  const auto expected = fingerprint(*described, states);

  initialize(*solver_, {{"tip", tip}});
  payload->setPayload("tool", tool());
  const auto found = fingerprint(*solver_, states);
  for (std::size_t i = 0; i < found.size(); ++i) {
    EXPECT_TRUE(near(found[i], expected[i], kFixedLink, 1.0))
        << quantities()[i % quantities().size()].name;
  }

  // The capabilities too, of which derivatives and accelerations are far greater.
  const std::vector<Method> own = methodsOf(*solver_);
  const std::vector<Method> of_link = methodsOf(*described);
  ASSERT_EQ(own.size(), of_link.size());
  for (const State& x : states) {
    for (std::size_t i = 0; i < own.size(); ++i) {
      const Eigen::VectorXd values = flat(of_link[i].by_value(x));
      EXPECT_TRUE(near(flat(own[i].by_value(x)), values, kFixedLink, sizeOf(values)))
          << own[i].name;
    }
  }
}

TEST_P(SolverConformance, BodyOfParametersEqualsOneThatIsSet) {
  INVERSE_DYNAMICS_SOLVER_REQUIRE(Payload, payload);
  const std::vector<State> states = randomStates(kStates);
  const auto none = fingerprint(*solver_, states);
  payload->setPayload("payload", tool());
  const RigidBody body = payload->payloads().at("payload");
  const auto expected = fingerprint(*solver_, states);

  const std::string description = GetParam().robotDescription();
  for (const std::string name : {"", "gripper."}) {
    ParameterMap parameters = GetParam().parameters();
    for (const auto& [key, value] : toolParameters("payload." + name)) parameters[key] = value;
    const auto solver = make();
    solver->initialize(Parameters(parameters).strict(), "", description);
    auto& stated = dynamic_cast<Payload&>(*solver);
    ASSERT_EQ(stated.payloads().size(), 1U);
    EXPECT_EQ(stated.payloads().begin()->first, name.empty() ? "payload" : "gripper");
    const auto found = fingerprint(*solver, states);
    for (std::size_t i = 0; i < found.size(); ++i) {
      EXPECT_TRUE(near(found[i], expected[i], kRounding, sizeOf(expected[i])));
    }
    EXPECT_TRUE(stated.payloads().begin()->second.frame.R.isApprox(body.frame.R, 1e-14));
    stated.clearPayloads();
    EXPECT_TRUE(identicalAll(fingerprint(*solver, states), none));

    // A name that is misspelt, with the one that is meant.
    parameters["payload." + name + "centre_of_mass"] = std::vector<double>{0, 0, 0};
    const std::string error = errorOf<InvalidParameterValueException>(
        [&] { solver_->initialize(Parameters(parameters).strict(), "", description); });
    EXPECT_TRUE(contains(error, {"'payload." + name + "centre_of_mass'",
                                 "did you mean 'payload." + name + "center_of_mass'?"}));
  }
  EXPECT_TRUE(identicalAll(fingerprint(*solver_, states), expected)) << "changed by an error";
}

/// A body that can't be, and the part of the message that names what is wrong.
struct ImpossibleBody {
  const char* what;
  std::function<void(RigidBody&)> spoil;
};

inline std::vector<ImpossibleBody> impossibleBodies() {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinite = std::numeric_limits<double>::infinity();
  return {{"mass", [](RigidBody& b) { b.mass = -0.1; }},
          {"mass", [=](RigidBody& b) { b.mass = nan; }},
          {"mass", [=](RigidBody& b) { b.mass = infinite; }},
          {"center_of_mass", [=](RigidBody& b) { b.center_of_mass.y() = nan; }},
          {"inertia", [=](RigidBody& b) { b.inertia(0, 1) = nan; }},
          {"inertia", [](RigidBody& b) { b.inertia(0, 1) += 1e-3; }},
          {"positive", [](RigidBody& b) { b.inertia = -b.inertia; }},
          {"triangle", [](RigidBody& b) { b.inertia = Eigen::Vector3d(1, 1, 2.1).asDiagonal(); }},
          {"without mass", [](RigidBody& b) { b.mass = 0.0; }},
          {"frame", [=](RigidBody& b) { b.frame.p.z() = nan; }},
          {"frame", [=](RigidBody& b) { b.frame.R(2, 2) = nan; }},
          {"rotation", [](RigidBody& b) { b.frame.R *= 1.001; }},
          {"rotation", [](RigidBody& b) { b.frame.R = -b.frame.R; }}};
}

TEST_P(SolverConformance, ImpossibleBodyIsRefusedAndNothingChanges) {
  INVERSE_DYNAMICS_SOLVER_REQUIRE(Payload, payload);
  payload->setPayload("tool", pointMass());
  const std::vector<State> states = randomStates(2);
  const auto before = fingerprint(*solver_, states);
  for (const ImpossibleBody& impossible : impossibleBodies()) {
    RigidBody body = tool();
    impossible.spoil(body);
    const std::string error =
        errorOf<InvalidParameterValueException>([&] { payload->setPayload("tool", body); });
    EXPECT_TRUE(contains(error, {"setPayload", "'tool'", "expected", "got", impossible.what}));
  }
  for (const std::string name : {"", "line\nbreak"}) {
    errorOf<InvalidParameterValueException>([&] { payload->setPayload(name, tool()); });
  }
  EXPECT_EQ(payload->payloads(), (Payloads{{"tool", pointMass()}}));
  EXPECT_TRUE(identicalAll(fingerprint(*solver_, states), before));

  // By parameters: initialize() changes nothing.
  const std::vector<std::pair<std::string, ParameterValue>> mistakes = {
      {"payload.mass", -1.0},
      {"payload.mass", std::string("heavy")},
      {"payload.center_of_mass", std::vector<double>{0.0, 0.1}},
      {"payload.inertia", std::vector<double>{1, 0, 0, 1, 0, 2.1}},
      {"payload.frame.rpy", std::vector<double>{0, 0, std::numeric_limits<double>::infinity()}},
      {"payload.frame.xyz", std::vector<double>{0}}};
  for (const auto& [name, value] : mistakes) {
    ParameterMap parameters = {{"payload.mass", 1.0}, {"gravity", std::vector<double>{1, 2, 3}}};
    parameters[name] = value;
    const std::string error = errorOf<InvalidParameterValueException>(
        [&, &changed = parameters] { initialize(*solver_, changed); });
    EXPECT_TRUE(contains(error, {"parameter '" + name + "'", "expected", "got"}));
  }
  const std::string error = errorOf<ParameterUninitializedException>([&] {
    initialize(*solver_, {{"payload.part.center_of_mass", std::vector<double>{0, 0, 1}}});
  });
  EXPECT_TRUE(contains(error, {"'payload.part.mass'"}));
  EXPECT_TRUE(identicalAll(fingerprint(*solver_, states), before));

  // No body has to have mass.
  EXPECT_NO_THROW(payload->setPayload("tool", RigidBody{}));
  EXPECT_NO_THROW(payload->setPayload("tool", RigidBody{2.0}));
}

TEST_P(SolverConformance, InertiaWithABodyIsAsPhysicalAsWithout) {
  INVERSE_DYNAMICS_SOLVER_REQUIRE(Payload, payload);
  const bool physical = solver_->inertiaIsPhysical();
  payload->setPayload("tool", tool());
  EXPECT_EQ(solver_->inertiaIsPhysical(), physical);
  if (!physical) return;
  for (const State& x : randomStates(kStates)) {
    const Eigen::MatrixXd H = solver_->getInertiaMatrix(x.q);
    EXPECT_TRUE(near(H, H.transpose(), kRounding, sizeOf(H))) << toString(x);
    EXPECT_EQ(H.llt().info(), Eigen::Success) << toString(x);
  }
}

TEST_P(SolverConformance, GravityThatIsSetEqualsThatOfInitialize) {
  INVERSE_DYNAMICS_SOLVER_REQUIRE(VariableGravity, mount);
  const std::vector<State> states = randomStates(kStates);
  const auto now = [&] { return fingerprint(*solver_, states); };
  const auto before = now();
  const Eigen::Vector3d first = mount->gravity(), other(3.0, -2.0, 1.0), a(0.3, 0.7, -1.1);
  EXPECT_EQ(mount->baseAcceleration(), Eigen::Vector3d::Zero());

  mount->setGravity(other);
  const auto fresh = makeInitialized({{"gravity", std::vector<double>{3.0, -2.0, 1.0}}});
  EXPECT_TRUE(identicalAll(now(), fingerprint(*fresh, states)));
  EXPECT_FALSE(identicalAll(now(), before)) << "gravity has no effect";

  // The acceleration of the base is a change of gravity.
  mount->setBaseAcceleration(a);
  const auto accelerated = now();
  EXPECT_EQ(mount->gravity(), other);
  EXPECT_EQ(mount->baseAcceleration(), a);
  mount->setBaseAcceleration(Eigen::Vector3d::Zero());
  mount->setGravity(other - a);
  EXPECT_TRUE(identicalAll(accelerated, now()));

  // Refused, nothing changes.
  const auto last = now();
  Eigen::Vector3d nan = other;
  nan.y() = std::numeric_limits<double>::quiet_NaN();
  const auto refused = [&](const char* method, const std::function<void()>& call) {
    const std::string error = errorOf<InvalidParameterValueException>(call);
    EXPECT_TRUE(contains(error, {method, "3 finite numbers", "nan"}));
  };
  refused("setGravity", [&] { mount->setGravity(nan); });
  refused("setBaseAcceleration", [&] { mount->setBaseAcceleration(nan); });
  EXPECT_TRUE(identicalAll(now(), last));

  mount->setGravity(first);
  EXPECT_TRUE(identicalAll(now(), before));
}

TEST_P(SolverConformance, UninitializedSolverRefusesBodiesAndGravity) {
  INVERSE_DYNAMICS_SOLVER_REQUIRE(Payload, ignored);
  (void)ignored;
  const auto solver = make();
  auto& payload = dynamic_cast<Payload&>(*solver);
  const auto refused = [](const char* method, const std::function<void()>& call) {
    EXPECT_TRUE(contains(errorOf<UninitializedException>(call), {method, "initialize()"}));
  };
  refused("setPayload", [&] { payload.setPayload("tool", tool()); });
  refused("removePayload", [&] { payload.removePayload("tool"); });
  refused("clearPayloads", [&] { payload.clearPayloads(); });
  refused("payloads", [&] { payload.payloads(); });
  auto* const mount = dynamic_cast<VariableGravity*>(solver.get());
  if (mount == nullptr) return;
  refused("setGravity", [&] { mount->setGravity(Eigen::Vector3d::Zero()); });
  refused("setBaseAcceleration", [&] { mount->setBaseAcceleration(Eigen::Vector3d::Zero()); });
  refused("gravity", [&] { mount->gravity(); });
  refused("baseAcceleration", [&] { mount->baseAcceleration(); });
}

TEST_P(SolverConformance, CallsWithABodyNeitherAllocateNorMakeASystemCall) {
  INVERSE_DYNAMICS_SOLVER_REQUIRE(Payload, payload);
  payload->setPayload("tool", tool());
  const std::vector<State> states = randomStates(kStates);
  CallsOfALoop calls(*solver_);
  const SystemCalls found = runWithoutSystemCalls([&] {
    for (const State& x : states) calls(x);
  });
  EXPECT_NE(found, SystemCalls::kMade) << "a system call is made: strace names it";
  EXPECT_NE(found, SystemCalls::kFailed) << "a call threw or crashed";
  if (!kAllocationGuardWorks) GTEST_SKIP() << "allocations can't be counted in this build";
  AllocationGuard guard;
  for (const State& x : states) calls(x);
  EXPECT_EQ(guard.count(), 0);
}

/// In the computing thread alone: whoever changes the robot does allocate.
TEST_P(SolverConformance, CallsDoNotAllocateWhileAnotherThreadChangesTheRobot) {
  if (!kAllocationGuardWorks) GTEST_SKIP() << "allocations can't be counted in this build";
  constexpr int kChanges = 50;
  INVERSE_DYNAMICS_SOLVER_REQUIRE(Payload, payload);
  auto* const mount = dynamic_cast<VariableGravity*>(solver_.get());
  const std::vector<State> states = randomStates(kStates);
  CallsOfALoop calls(*solver_);

  std::atomic<bool> done{false};
  std::atomic<int> changes{0};
  long allocations_of_changes = 0;
  std::thread other([&] {
    const AllocationGuard guard;
    for (; !done; ++changes) {
      payload->setPayload("part", changes % 2 == 0 ? tool() : pointMass());
      if (mount != nullptr) mount->setGravity({0.0, 0.1 * (changes % 7), -9.81});
      if (changes % 5 == 0) payload->removePayload("part");
      std::this_thread::yield();
    }
    allocations_of_changes = guard.count();
  });
  long allocations = 0;
  for (bool last = false; !last;) {
    last = changes >= kChanges;
    const AllocationGuard guard;
    for (const State& x : states) calls(x);
    allocations += guard.count();
  }
  done = true;
  other.join();
  EXPECT_EQ(allocations, 0);
  EXPECT_GT(allocations_of_changes, 0) << "allocations aren't counted";
}

/// Quantities of single states, and those of a batch as one result.
inline std::vector<Eigen::VectorXd> resultsOf(const InverseDynamicsSolver& solver,
                                              const std::vector<State>& states) {
  std::vector<Eigen::VectorXd> results;
  for (const Method& method : methodsOf(solver)) {
    for (const State& x : states) {
      for (const Eigen::MatrixXd& matrix : method.by_value(x)) results.push_back(flat(matrix));
    }
  }
  const auto count = static_cast<Eigen::Index>(states.size());
  Eigen::MatrixXd q(solver.jointCount(), count), qd(q), qdd(q);
  for (Eigen::Index k = 0; k < count; ++k) {
    q.col(k) = states[static_cast<std::size_t>(k)].q;
    qd.col(k) = states[static_cast<std::size_t>(k)].qd;
    qdd.col(k) = states[static_cast<std::size_t>(k)].qdd;
  }
  results.push_back(flat(solver.getTorquesBatch(q, qd, qdd)));
  results.push_back(flat(solver.getInertiaMatrixBatch(q)));
  return results;
}

/// Each result is that of one robot, whole: which, changes in between.
TEST_P(SolverConformance, ThreadsThatComputeWhileTheRobotChangesGetOldOrNewNumbers) {
  constexpr int kThreads = 8, kRounds = 40;
  INVERSE_DYNAMICS_SOLVER_REQUIRE(Payload, payload);
  auto* const mount = dynamic_cast<VariableGravity*>(solver_.get());
  const std::vector<State> states = randomStates(12);
  const Eigen::Vector3d other_gravity(3.0, -2.0, 1.0);

  // One change after the other; the last one leads back to the first robot.
  std::vector<std::function<void()>> changes = {[&] { payload->setPayload("part", tool()); },
                                                [&] { payload->setPayload("part", pointMass()); },
                                                [&] { payload->removePayload("part"); }};
  if (mount != nullptr) {
    changes.emplace_back([&, first = mount->gravity()] {
      mount->setGravity(mount->gravity() == first ? other_gravity : first);
    });
  }
  std::vector<std::vector<Eigen::VectorXd>> robots;
  for (int twice = 0; twice < 2; ++twice) {
    for (const auto& change : changes) {
      change();
      robots.push_back(resultsOf(*solver_, states));
    }
  }

  std::atomic<bool> done{false};
  std::atomic<long> mixed{0}, results{0};
  const auto work = [&] {
    while (!done) {
      const std::vector<Eigen::VectorXd> found = resultsOf(*solver_, states);
      for (std::size_t i = 0; i < found.size(); ++i) {
        bool whole = false;
        for (const auto& robot : robots) whole = whole || identical(found[i], robot[i]);
        if (!whole) ++mixed;
      }
      ++results;
    }
  };
  std::vector<std::thread> threads;
  for (int i = 0; i < kThreads; ++i) threads.emplace_back(work);
  for (int k = 0; k < kRounds || results < kThreads; ++k) {
    for (const auto& change : changes) {
      change();
      std::this_thread::yield();
    }
  }
  done = true;
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(mixed, 0) << "of " << results << ": a call computes with a mixture of two robots";
}

TEST_P(SolverConformance, ThreadsThatShareABatchComputeWithOneRobot) {
  constexpr int kRounds = 20;
  initialize(*solver_, {{"batch_threads", 4}});
  INVERSE_DYNAMICS_SOLVER_REQUIRE(Payload, payload);
  const Eigen::Index count = 4 * 2048;  // parts for four threads
  const Eigen::MatrixXd q = randomColumns(16).replicate(1, count / 16);
  const auto torques = [&] { return flat(solver_->getTorquesBatch(q, q, q)); };
  payload->setPayload("part", tool());
  const Eigen::VectorXd one = torques();
  payload->setPayload("part", pointMass());
  const Eigen::VectorXd other = torques();
  ASSERT_FALSE(identical(one, other));

  std::atomic<bool> done{false};
  std::thread changes([&] {
    for (bool first = true; !done; first = !first) {
      payload->setPayload("part", first ? tool() : pointMass());
      std::this_thread::yield();
    }
  });
  int mixed = 0;
  for (int k = 0; k < kRounds; ++k) {
    const Eigen::VectorXd found = torques();
    if (!identical(found, one) && !identical(found, other)) ++mixed;
  }
  done = true;
  changes.join();
  EXPECT_EQ(mixed, 0) << "of " << kRounds << ": parts of a batch are of different robots";
}

}  // namespace inverse_dynamics_solver::conformance
