// SPDX-License-Identifier: Apache-2.0
#include "inverse_dynamics_timing/retime.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <chain_dynamics/friction.hpp>
#include <chain_dynamics/friction_laws/smooth_coulomb.hpp>
#include <chain_dynamics/friction_laws/viscous_coulomb_offset.hpp>
#include <chain_dynamics/model.hpp>
#include <chain_dynamics/model_file.hpp>
#include <cmath>
#include <fstream>
#include <functional>
#include <inverse_dynamics_solver/exceptions.hpp>
#include <inverse_dynamics_solver/friction_memory.hpp>
#include <inverse_dynamics_solver/inverse_dynamics_solver.hpp>
#include <inverse_dynamics_solver/kinematics.hpp>
#include <iterator>
#include <limits>
#include <memory>
#include <random>
#include <rigid_body_inverse_dynamics_solver/rigid_body_inverse_dynamics_solver.hpp>
#include <string>
#include <thread>
#include <vector>

#include "dense_reference.hpp"
#include "half_planes.hpp"

namespace {

using namespace inverse_dynamics_timing;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using inverse_dynamics_solver::InvalidParameterValueException;
using inverse_dynamics_solver::InverseDynamicsSolver;
using RigidBody = rigid_body_inverse_dynamics_solver::InverseDynamicsSolverRigidBody;
using testing::HasSubstr;
using testing::Property;
using testing::Throws;

constexpr double kLimit = 0.005;  // above a limit between points of the grid, share of it

std::string fileText(const std::string& name) {
  std::ifstream file(INVERSE_DYNAMICS_ROBOTS_DIR "/" + name);
  return {std::istreambuf_iterator<char>(file), {}};
}

std::unique_ptr<InverseDynamicsSolver> described(const std::string& urdf) {
  auto solver = std::make_unique<RigidBody>();
  solver->initialize({}, "", fileText("urdf/" + urdf));
  return solver;
}

std::unique_ptr<InverseDynamicsSolver> identified(const std::string& model) {
  auto solver = std::make_unique<RigidBody>();
  solver->initialize({{"model", std::string(INVERSE_DYNAMICS_ROBOTS_DIR "/models/" + model)}});
  return solver;
}

/// An identified model with changes.
std::unique_ptr<InverseDynamicsSolver> identifiedWith(
    const std::string& model_file, const std::function<void(chain_dynamics::Model&)>& change) {
  chain_dynamics::Model model =
      chain_dynamics::modelFromFile(INVERSE_DYNAMICS_ROBOTS_DIR "/models/" + model_file);
  change(model);
  const std::string file = testing::TempDir() + "changed_model.yaml";
  std::ofstream(file) << chain_dynamics::modelFileText(model);
  auto solver = std::make_unique<RigidBody>();
  solver->initialize({{"model", file}});
  return solver;
}

/// A slider of `mass` kg, moved by the force `mass qdd`.
std::unique_ptr<InverseDynamicsSolver> slider() {
  auto solver = std::make_unique<RigidBody>();
  solver->initialize({}, "", R"(<robot name="slider"><link name="base"/>
    <link name="carriage"><inertial><mass value="2"/>
    <inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
    <joint name="x" type="prismatic"><parent link="base"/><child link="carriage"/><axis xyz="1 0 0"/>
    <limit effort="10" velocity="10" lower="-9" upper="9"/></joint></robot>)");
  return solver;
}

MatrixXd randomWaypoints(Index joints, unsigned seed, Index count = 4) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> angle(-1.3, 1.3);
  MatrixXd waypoints(joints, count);
  for (double& value : waypoints.reshaped()) value = angle(random);
  return waypoints;
}

VectorXd ur10Torques() { return (VectorXd(6) << 330, 330, 150, 56, 56, 56).finished(); }
VectorXd pandaTorques() { return (VectorXd(7) << 87, 87, 87, 87, 12, 12, 12).finished(); }

/// The greatest of `used / limit` of the torques, ten times finer than the grid.
double greatestUse(const InverseDynamicsSolver& solver, const Trajectory& motion,
                   const VectorXd& torque, chain_dynamics::FrictionState friction = {}) {
  const Index n = torque.size();
  VectorXd q(n), qd(n), qdd(n);
  double most = 0.0;
  for (Index k = 0; k + 1 < motion.time().size(); ++k) {
    for (int i = 0; i < 10; ++i) {
      const double interval = motion.time()[k + 1] - motion.time()[k];
      motion.evaluate(motion.time()[k] + interval * (i + 0.5) / 10, q, qd, qdd);
      VectorXd tau = solver.getTorques(q, qd, qdd);
      friction.move(q);
      friction.addTo(qd, tau);
      most = std::max(most, (tau.cwiseAbs().array() / torque.array()).maxCoeff());
    }
  }
  return most;
}

auto refused(const std::string& text) {
  return Throws<InvalidParameterValueException>(
      Property(&InvalidParameterValueException::what, HasSubstr(text)));
}

// A mass pushed halfway and braked halfway: T = 2 sqrt(way m / F).
TEST(HalfPlanes, StepsOfASteepLineEndWhereRoundingHidesThePlace) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> number(0.5, 1.0);
  for (int exponent = 0; exponent < 100; ++exponent) {
    for (int k = 0; k < 100; ++k) {
      // 0 <= y <= top, 2 x - p y <= t: with a small p all about x
      const double p = std::pow(10.0, -exponent), top = 50 * number(random),
                   t = 40 * number(random);
      HalfPlanes planes;
      planes.add(1.0, 0.0, top);
      planes.add(-1.0, 0.0, 0.0);
      planes.add(-p, 2.0, t);
      double x = 100.0;
      ASSERT_TRUE(planes.approach(x, 0.0)) << "p " << p << ", top " << top << ", t " << t;
      ASSERT_NEAR(x, (t + p * top) / 2, 1e-9);
    }
  }
}

TEST(Retime, SliderIsPushedHalfwayAndBrakedHalfway) {
  const auto solver = slider();
  const Path path = Path::lines((MatrixXd(1, 2) << -1.0, 2.0).finished(), 0.0);
  MotionLimits limits;
  limits.torque = VectorXd::Constant(1, 10.0);
  const Retimed fastest = retime(*solver, path, limits);
  ASSERT_TRUE(fastest);
  EXPECT_NEAR(fastest.trajectory.duration(), 2 * std::sqrt(3.0 * 2.0 / 10.0), 1e-4);
}

// F = 10 N gives 5 m/s^2: 0.2 s to 1 m/s, 0.1 m of way; the same to brake.
TEST(Retime, SliderKeepsItsGreatestVelocity) {
  const auto solver = slider();
  const Path path = Path::lines((MatrixXd(1, 2) << 0.0, 2.0).finished(), 0.0);
  MotionLimits limits;
  limits.torque = VectorXd::Constant(1, 10.0);
  limits.velocity = VectorXd::Constant(1, 1.0);
  EXPECT_NEAR(retime(*solver, path, limits).trajectory.duration(), 0.4 + 1.8, 1e-3);
  limits.velocity = {}, limits.tip_speed = 1.0;
  EXPECT_NEAR(retime(*solver, path, limits).trajectory.duration(), 0.4 + 1.8, 1e-3);
  limits.tip_speed = std::numeric_limits<double>::infinity();
  limits.acceleration = VectorXd::Constant(1, 2.0);
  EXPECT_NEAR(retime(*solver, path, limits).trajectory.duration(), 2.0, 1e-3);
}

// m dv/dt = F (1 - v / v0): the motor comes closer to v0, never beyond.
TEST(Retime, SliderWithAMotorWhoseForceFallsWithSpeed) {
  const auto solver = slider();
  const Path path = Path::lines((MatrixXd(1, 2) << 0.0, 2.0).finished(), 0.0);
  MotionLimits limits;
  limits.torque = VectorXd::Constant(1, 10.0);
  limits.knee_velocity = VectorXd::Constant(1, 1e-9);
  limits.no_load_velocity = VectorXd::Constant(1, 1.0);
  const Retimed fastest = retime(*solver, path, limits);
  ASSERT_TRUE(fastest);
  // Accelerating: x = t - tau (1 - exp(-t / tau)), v = 1 - exp(-t / tau), tau = m v0 / F = 0.2 s.
  const Trajectory& motion = fastest.trajectory;
  VectorXd q(1), qd(1), qdd(1);
  for (const double t : {0.05, 0.2, 0.5, 1.0}) {
    motion.evaluate(t, q, qd, qdd);
    EXPECT_NEAR(qd[0], 1 - std::exp(-t / 0.2), 2e-3);
  }
}

TEST(Retime, StartsAndEndsWithTheSpeedsAsked) {
  const auto solver = slider();
  const Path path = Path::lines((MatrixXd(1, 2) << 0.0, 2.0).finished(), 0.0);
  MotionLimits limits;
  limits.torque = VectorXd::Constant(1, 10.0);
  RetimeOptions options;
  options.start_speed = 1.0, options.end_speed = 2.0;
  const Retimed fastest = retime(*solver, path, limits, options);
  ASSERT_TRUE(fastest);
  EXPECT_DOUBLE_EQ(fastest.trajectory.speed()[0], 1.0);
  EXPECT_NEAR(fastest.trajectory.speed()[fastest.trajectory.speed().size() - 1], 2.0, 1e-9);
  options.start_speed = 5.0;  // 2 m aren't enough to brake to 2 m/s with 5 m/s^2: 4.9 m/s are
  const Retimed too_fast = retime(*solver, path, limits, options);
  EXPECT_EQ(too_fast.refusal.reason, Refusal::Reason::kStartTooFast);
  EXPECT_NEAR(too_fast.refusal.missing, std::sqrt(24.0), 1e-3);
  EXPECT_THAT(text(too_fast.refusal, solver->jointNames()), HasSubstr("4.89"));
}

TEST(Retime, SaysTheGreatestSpeedOfTheEnd) {
  const auto solver = slider();
  const Path path = Path::lines((MatrixXd(1, 2) << 0.0, 2.0).finished(), 0.0);
  MotionLimits limits;
  limits.torque = VectorXd::Constant(1, 10.0);
  RetimeOptions options;
  const auto greatest = [&] {
    const Retimed too_fast = retime(*solver, path, limits, options);
    EXPECT_EQ(too_fast.refusal.reason, Refusal::Reason::kEndTooFast);
    EXPECT_THAT(text(too_fast.refusal, solver->jointNames()), HasSubstr("end's speed"));
    return too_fast.refusal.missing;
  };
  options.end_speed = 5.0;  // 2 m with 5 m/s^2
  EXPECT_NEAR(greatest(), std::sqrt(20.0), 1e-3);
  options.start_speed = 1.0;
  EXPECT_NEAR(greatest(), std::sqrt(21.0), 1e-3);
  options.end_speed = 0.999 * greatest();
  EXPECT_TRUE(retime(*solver, path, limits, options));
  limits.velocity = VectorXd::Constant(1, 1.5);
  EXPECT_NEAR(greatest(), 1.5, 1e-9);
}

// Whatever the friction is, the duration is that of dynamic programming.
TEST(Retime, IsAsFastAsDynamicProgrammingWithFrictionAndWithout) {
  constexpr double kSame = 0.01;
  const struct {
    std::unique_ptr<InverseDynamicsSolver> solver;
    VectorXd torque;
  } robots[] = {{described("ur10.urdf"), 0.5 * ur10Torques()},
                {identified("ur10_identified.yaml"), 0.6 * ur10Torques()},
                {identified("franka_inria_identified.yaml"), 0.8 * pandaTorques()}};
  for (const auto& robot : robots) {
    const Path path = Path::spline(randomWaypoints(robot.solver->jointCount(), 2));
    MotionLimits limits;
    limits.torque = robot.torque;
    const Retimed fastest = retime(*robot.solver, path, limits);
    ASSERT_TRUE(fastest) << text(fastest.refusal, robot.solver->jointNames());
    DenseGrid grid;
    grid.fastest = 1.2 * fastest.trajectory.speed().maxCoeff();
    const double reference = denseDuration(*robot.solver, path, robot.torque, grid);
    EXPECT_NEAR(fastest.trajectory.duration() / reference, 1.0, kSame);
  }
}

TEST(Retime, TorquesStayWithinLimitsBetweenPoints) {
  for (unsigned seed = 0; seed < 10; ++seed) {
    for (const bool real : {false, true}) {
      const auto solver = real ? identified("ur10_identified.yaml") : described("ur10.urdf");
      const VectorXd torque = ur10Torques();
      MotionLimits limits;
      limits.torque = torque;
      for (const Path& path :
           {Path::spline(randomWaypoints(6, seed)), Path::lines(randomWaypoints(6, seed), 0.1)}) {
        const Retimed fastest = retime(*solver, path, limits);
        ASSERT_TRUE(fastest) << text(fastest.refusal, solver->jointNames());
        EXPECT_LT(greatestUse(*solver, fastest.trajectory, torque), 1 + kLimit) << seed << real;
        // and some joint is at its limit, nearly everywhere
        EXPECT_GT(greatestUse(*solver, fastest.trajectory, torque), 1 - kLimit);
      }
    }
  }
}

// Joints turn back several times between two waypoints, and friction steps there.
TEST(Retime, TorquesStayWithinLimitsOnPathsOfManyWaypoints) {
  constexpr double kWithFriction = 0.002;
  MotionLimits limits;
  limits.torque = ur10Torques();
  chain_dynamics::SmoothCoulomb falling;  // from 20 N m to 10 between 1 and 100 mrad/s
  falling.fv = 5, falling.fc = 10, falling.fs = 10, falling.vs = 0.1, falling.width = 0.001;
  const chain_dynamics::ViscousCoulombOffset step{5, 10, 2};
  for (const chain_dynamics::FrictionLaw& law :
       {chain_dynamics::FrictionLaw(step), chain_dynamics::FrictionLaw(falling)}) {
    const auto solver = identifiedWith("ur10_identified.yaml", [&](chain_dynamics::Model& model) {
      model.friction.assign(6, law);
    });
    for (unsigned seed = 0; seed < 3; ++seed) {
      const MatrixXd waypoints = randomWaypoints(6, seed, 50);
      for (const Path& path : {Path::spline(waypoints), Path::lines(waypoints, 0.05)}) {
        const Retimed fastest = retime(*solver, path, limits);
        ASSERT_TRUE(fastest) << text(fastest.refusal, solver->jointNames());
        EXPECT_LT(greatestUse(*solver, fastest.trajectory, limits.torque), 1 + kWithFriction)
            << "law " << law.index() << ", seed " << seed;
      }
    }
  }
}

// A joint that came from afar to where the motion starts has all of its friction on one side.
TEST(Retime, TorquesStayWithinLimitsWhateverFrictionRemembers) {
  constexpr double kFar = 20.0, kWithFriction = 0.002;  // rad; share of the limit
  const auto solver = identified("ur10_salerno_identified.yaml");
  MotionLimits limits;
  limits.torque = 0.6 * ur10Torques();
  for (unsigned seed = 0; seed < 4; ++seed) {
    const MatrixXd points = randomWaypoints(6, seed);
    for (const Path& path : {Path::spline(points), Path::lines(points, 0.0)}) {
      const Trajectory motion = retime(*solver, path, limits).trajectory;
      for (const double from : {-kFar, kFar}) {
        chain_dynamics::FrictionState friction = frictionState(*solver);
        friction.move((points.col(0).array() + from).matrix());
        EXPECT_LT(greatestUse(*solver, motion, limits.torque, friction), 1 + kWithFriction) << seed;
      }
    }
  }
}

TEST(Retime, WayBackTakesAsLongWithoutFrictionAndGravity) {
  auto solver = std::make_unique<RigidBody>();
  solver->initialize({{"gravity", std::vector<double>{0, 0, 0}}}, "", fileText("urdf/ur10.urdf"));
  const MatrixXd waypoints = randomWaypoints(6, 7);
  MotionLimits limits;
  limits.torque = ur10Torques();
  const double there = retime(*solver, Path::spline(waypoints), limits).trajectory.duration();
  const double back =
      retime(*solver, Path::spline(waypoints.rowwise().reverse()), limits).trajectory.duration();
  EXPECT_NEAR(there / back, 1.0, 1e-3);
}

TEST(Retime, StandsStillAtStops) {
  const auto solver = described("ur10.urdf");
  const MatrixXd waypoints = randomWaypoints(6, 5);
  MotionLimits limits;
  limits.torque = ur10Torques();
  const Path path = Path::lines(waypoints, 0.0);
  const Retimed fastest = retime(*solver, path, limits);
  ASSERT_TRUE(fastest);
  const Trajectory& motion = fastest.trajectory;
  ASSERT_EQ(path.stops().size(), 2);
  double total = 0.0;
  for (Index k = 0; k + 1 < waypoints.cols(); ++k) {
    total +=
        retime(*solver, Path::lines(waypoints.middleCols(k, 2), 0.0), limits).trajectory.duration();
  }
  EXPECT_NEAR(motion.duration(), total, 1e-2 * total);
  VectorXd q(6), qd(6), qdd(6), before(6);
  motion.evaluate(0.0, q, qd, qdd);
  EXPECT_EQ(qd.norm(), 0.0);
  for (double t = 1e-4; t < motion.duration(); t += 1e-4) {
    before = qd;
    motion.evaluate(t, q, qd, qdd);
    EXPECT_LT((qd - before).norm(), 0.1);  // velocities don't jump
  }
}

TEST(Retime, SaysWhichJointLacksHowMuchTorque) {
  const auto solver = described("ur10.urdf");
  MatrixXd waypoints = MatrixXd::Zero(6, 2);
  waypoints(5, 1) = 1.0;  // stretched out, level: the last joint turns
  MotionLimits limits;
  limits.torque = ur10Torques();
  limits.torque[1] = 60.0;
  const Retimed none = retime(*solver, Path::spline(waypoints), limits);
  ASSERT_FALSE(none);
  EXPECT_EQ(none.trajectory.duration(), 0.0);
  EXPECT_EQ(none.refusal.reason, Refusal::Reason::kTorqueAtRest);
  EXPECT_EQ(none.refusal.joint, 1);
  const double gravity = solver->getGravityVector(waypoints.col(0))[1];
  EXPECT_NEAR(none.refusal.missing, std::abs(gravity) - 60.0, 1e-6);
  EXPECT_THAT(text(none.refusal, solver->jointNames()), HasSubstr("shoulder_lift_joint"));
}

TEST(Retime, MarginLeavesTheBandOfTheModelFree) {
  const VectorXd band = 0.1 * pandaTorques();  // of 95 %
  const auto owned =
      identifiedWith("franka_gaz2019_feasible.yaml",
                     [&](chain_dynamics::Model& model) { model.torque_deviation = band; });
  const InverseDynamicsSolver& solver = *owned;
  const Path path = Path::spline(randomWaypoints(7, 1));
  MotionLimits limits;
  limits.torque = pandaTorques();
  const double without = retime(solver, path, limits).trajectory.duration();
  RetimeOptions options;
  options.margin = 0.95;
  const Retimed with = retime(solver, path, limits, options);
  ASSERT_TRUE(with) << text(with.refusal, solver.jointNames());
  EXPECT_NEAR(greatestUse(solver, with.trajectory, pandaTorques()), 0.9, kLimit);
  EXPECT_GT(with.trajectory.duration(), without);
  options.margin = 0.5;  // +- 0.6745 instead of 1.96 standard deviations
  const Retimed half = retime(solver, path, limits, options);
  EXPECT_NEAR(greatestUse(solver, half.trajectory, pandaTorques()), 1 - 0.1 * 0.6745 / 1.96,
              kLimit);
}

TEST(Retime, MarginNeedsAModelThatStatesItsDeviation) {
  MotionLimits limits;
  limits.torque = ur10Torques();
  RetimeOptions options;
  options.margin = 0.95;
  const Path path = Path::spline(randomWaypoints(6, 1));
  const auto solver = identified("ur10_identified.yaml");
  EXPECT_THAT([&] { retime(*solver, path, limits, options); }, refused("deviation"));
}

TEST(Retime, JerkStaysWithinItsLimit) {
  const auto solver = described("ur10.urdf");
  const Path path = Path::spline(randomWaypoints(6, 2));
  MotionLimits limits;
  limits.torque = ur10Torques();
  const double fastest = retime(*solver, path, limits).trajectory.duration();
  limits.jerk = VectorXd::Constant(6, 300.0);
  const Retimed smooth = retime(*solver, path, limits);
  ASSERT_TRUE(smooth) << text(smooth.refusal, solver->jointNames());
  const Trajectory& motion = smooth.trajectory;
  EXPECT_GT(motion.duration(), fastest);
  EXPECT_LT(greatestUse(*solver, motion, ur10Torques()), 1 + kLimit);
  VectorXd q(6), qd(6), qdd(6), later(6);
  for (double t = 0.0; t < motion.duration() - 1e-3; t += 1e-4) {
    motion.evaluate(t, q, qd, qdd);
    motion.evaluate(t + 1e-3, q, qd, later);
    EXPECT_LT((later - qdd).cwiseAbs().maxCoeff() / 1e-3, 300.0 * 1.003);
  }
}

TEST(Retime, TorquesStayWithinLimitsWithJerkLimitsThatHardlyMatter) {
  const auto solver = identified("ur10_identified.yaml");
  MotionLimits limits;
  limits.torque = ur10Torques();
  limits.jerk = VectorXd::Constant(6, 1e6);
  for (unsigned seed = 0; seed < 6; ++seed) {
    const Retimed motion = retime(*solver, Path::spline(randomWaypoints(6, seed, 5)), limits);
    ASSERT_TRUE(motion);
    EXPECT_LT(greatestUse(*solver, motion.trajectory, limits.torque), 1.003) << seed;
  }
}

TEST(Retime, TorqueRatesStayWithinTheirLimits) {
  const auto solver = identified("franka_inria_identified.yaml");
  const Path path = Path::spline(randomWaypoints(7, 2));
  MotionLimits limits;
  limits.torque = pandaTorques();
  const double fastest = retime(*solver, path, limits).trajectory.duration();
  limits.torque_rate = VectorXd::Constant(7, 1000.0);
  const Retimed smooth = retime(*solver, path, limits);
  ASSERT_TRUE(smooth) << text(smooth.refusal, solver->jointNames());
  const Trajectory& motion = smooth.trajectory;
  EXPECT_GT(motion.duration(), fastest);
  EXPECT_LT(motion.duration(), 2 * fastest);
  EXPECT_LT(greatestUse(*solver, motion, limits.torque), 1.003);
  VectorXd q(7), qd(7), qdd(7);
  for (double t = 0.0; t < motion.duration() - 1e-3; t += 1e-4) {
    motion.evaluate(t, q, qd, qdd);
    const VectorXd before = solver->getTorques(q, qd, qdd);
    motion.evaluate(t + 1e-3, q, qd, qdd);
    const VectorXd after = solver->getTorques(q, qd, qdd);
    ASSERT_LT((after - before).cwiseAbs().maxCoeff() / 1e-3, 1000.0 * 1.003) << t;
  }
}

TEST(Retime, TorqueRatesOfAMassAreItsJerks) {
  const auto solver = slider();  // 2 kg
  const Path path = Path::lines((MatrixXd(1, 2) << 0.0, 2.0).finished(), 0.0);
  MotionLimits jerks, rates;
  jerks.torque = rates.torque = VectorXd::Constant(1, 10.0);
  jerks.jerk = VectorXd::Constant(1, 20.0), rates.torque_rate = VectorXd::Constant(1, 40.0);
  EXPECT_NEAR(retime(*solver, path, rates).trajectory.duration(),
              retime(*solver, path, jerks).trajectory.duration(), 1e-9);
}

TEST(Retime, FrictionThatStepsFasterThanATorqueMayIsNamed) {
  const auto solver = identifiedWith("ur10_identified.yaml", [](chain_dynamics::Model& model) {
    model.friction.assign(6, chain_dynamics::ViscousCoulombOffset{5, 10, 2});
  });
  MotionLimits limits;
  limits.torque = ur10Torques(), limits.torque_rate = VectorXd::Constant(6, 1000.0);
  const Retimed none = retime(*solver, Path::spline(randomWaypoints(6, 1)), limits);
  EXPECT_EQ(none.refusal.reason, Refusal::Reason::kRateTooLow);
  EXPECT_GT(none.refusal.missing, 1e4);  // 10 N m within 1 ms
  EXPECT_THAT(text(none.refusal, solver->jointNames()), HasSubstr("friction steps there"));
}

TEST(Retime, MotionsWithJerkLimitsThatTakeTooLongAreRefused) {
  const auto solver = slider();
  const Path path = Path::lines((MatrixXd(1, 2) << 0.0, 2.0).finished(), 0.0);
  MotionLimits limits;
  limits.torque = VectorXd::Constant(1, 10.0);
  limits.jerk = VectorXd::Constant(1, 0.1);
  limits.velocity = VectorXd::Constant(1, 1e-3);
  const Retimed slow = retime(*solver, path, limits);
  EXPECT_EQ(slow.refusal.reason, Refusal::Reason::kTooSlow);
  EXPECT_THAT(text(slow.refusal, solver->jointNames()), HasSubstr("takes at least 2000 s"));
}

TEST(Retime, MotionsThatKeepJerkAndTorqueRateAnywayAreTheFastestOnes) {
  const auto solver = identified("ur10_identified.yaml");
  MotionLimits limits;
  limits.torque = ur10Torques();
  const Path path = Path::spline(randomWaypoints(6, 3));
  const double fastest = retime(*solver, path, limits).trajectory.duration();
  limits.jerk = VectorXd::Constant(6, 1e8), limits.torque_rate = VectorXd::Constant(6, 1e9);
  EXPECT_EQ(retime(*solver, path, limits).trajectory.duration(), fastest);
}

// The shortest time of a way d is (32 d / j)^(1/3).
TEST(Retime, JerkLimitsTakeTheCubeRootOfTheirInverse) {
  const auto solver = slider();
  const Path path = Path::lines((MatrixXd(1, 2) << 0.0, 2.0).finished(), 0.0);
  MotionLimits limits;
  limits.torque = VectorXd::Constant(1, 10.0);
  for (const double jerk : {0.1, 1.0, 10.0}) {
    limits.jerk = VectorXd::Constant(1, jerk);
    limits.acceleration = {};
    const double duration = retime(*solver, path, limits).trajectory.duration();
    EXPECT_NEAR(duration / std::cbrt(32 * 2.0 / jerk), 1.1, 0.11);
    for (const double acceleration : {0.1, 0.3, 1.0, 3.0}) {
      limits.acceleration = VectorXd::Constant(1, acceleration);
      EXPECT_GT(retime(*solver, path, limits).trajectory.duration(), 0.995 * duration);
    }
  }
}

// A joint_trajectory_controller refuses times that don't rise.
TEST(SampleTimes, RiseStrictlyWithALastStepOfHalfAPeriodAtLeast) {
  constexpr double kRate = 250.0, kRounded = 1e-12;
  for (int n = 1; n < 500; ++n) {
    for (const double duration : {n / kRate, n / kRate * (1 + 1e-15), n / kRate * (1 - 1e-15),
                                  (n + 0.3) / kRate, (n + 0.5) / kRate, (n + 0.7) / kRate}) {
      const VectorXd times = sampleTimes(duration, kRate);
      const VectorXd steps = times.tail(times.size() - 1) - times.head(times.size() - 1);
      EXPECT_EQ(times[0], 0.0);
      EXPECT_EQ(times[times.size() - 1], duration);
      EXPECT_GT(steps.minCoeff(), 0.5 / kRate - kRounded) << duration;
      EXPECT_LT(steps.maxCoeff(), 1.5 / kRate + kRounded) << duration;
    }
  }
  EXPECT_EQ(sampleTimes(1e-4, kRate), VectorXd(Eigen::Vector2d(0.0, 1e-4)));
  EXPECT_THAT([] { sampleTimes(1e5, kRate); },
              refused("rate: expected at most 10 Hz for a motion of 1e+05 s"));
}

TEST(Retime, SpeedLimitIsAboveTheSpeed) {
  const auto solver = identified("franka_inria_identified.yaml");
  MotionLimits limits;
  limits.torque = pandaTorques();
  const Retimed fastest = retime(*solver, Path::spline(randomWaypoints(7, 4)), limits);
  ASSERT_TRUE(fastest);
  const VectorXd limit = speedLimit(*solver, fastest.trajectory, limits);
  EXPECT_TRUE((fastest.trajectory.speed().array() <= 1.001 * limit.array()).all());
}

TEST(Retime, ThreadsShareASolver) {
  const auto solver = identified("franka_inria_identified.yaml");
  MotionLimits limits;
  limits.torque = pandaTorques();
  std::vector<double> alone, together(8);
  for (unsigned i = 0; i < 8; ++i) {
    alone.push_back(
        retime(*solver, Path::spline(randomWaypoints(7, i)), limits).trajectory.duration());
  }
  std::vector<std::thread> threads;
  for (unsigned i = 0; i < 8; ++i) {
    threads.emplace_back([&, i] {
      together[i] =
          retime(*solver, Path::spline(randomWaypoints(7, i)), limits).trajectory.duration();
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(together, alone);
}

TEST(Retime, RefusesWrongLimitsAndOptions) {
  const auto solver = slider();
  const Path path = Path::lines((MatrixXd(1, 2) << 0.0, 2.0).finished(), 0.0);
  const auto with = [&](auto change) {
    return [&, change] {
      MotionLimits limits;
      limits.torque = VectorXd::Constant(1, 10.0);
      RetimeOptions options;
      change(limits, options);
      retime(*solver, path, limits, options);
    };
  };
  using L = MotionLimits;
  using O = RetimeOptions;
  EXPECT_THAT(with([](L& limits, O&) { limits.torque = {}; }), refused("limits.torque"));
  EXPECT_THAT(with([](L& limits, O&) { limits.torque[0] = -1; }), refused("of x"));
  EXPECT_THAT(with([](L& limits, O&) { limits.velocity = VectorXd::Zero(1); }), refused("> 0"));
  EXPECT_THAT(with([](L& limits, O&) { limits.knee_velocity = VectorXd::Ones(1); }),
              refused("no_load_velocity"));
  EXPECT_THAT(with([](L& limits, O&) { limits.tip_speed = 0; }), refused("tip_speed"));
  EXPECT_THAT(with([](L& limits, O& options) {
                limits.jerk = VectorXd::Ones(1), options.start_speed = 0.1;
              }),
              refused("at rest"));
  EXPECT_THAT(with([](L& limits, O& options) {
                limits.torque_rate = VectorXd::Ones(1), options.end_speed = 0.1;
              }),
              refused("limits.torque_rate"));
  EXPECT_THAT(with([](L&, O& options) { options.points = 1; }), refused("points"));
  EXPECT_THAT(with([](L&, O& options) { options.points = 2000000; }), refused("1000000"));
  EXPECT_THAT(with([](L&, O& options) { options.margin = 1; }), refused("margin"));
  EXPECT_THAT(with([](L&, O& options) { options.end_speed = -1; }), refused("end_speed"));
  EXPECT_THROW(with([](L& limits, O&) { limits.jerk = VectorXd::Ones(2); })(),
               inverse_dynamics_solver::SizeMismatchException);
}

}  // namespace
