// SPDX-License-Identifier: Apache-2.0
//
// What a user's program makes, takes, changes and frees of these packages, with flags of its own.
// Memory that one side frees in another way than the other allocated it ends the program.

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <inverse_dynamics_control/inverse_dynamics_control.hpp>
#include <inverse_dynamics_evaluation/online_derivative.hpp>
#include <inverse_dynamics_evaluation/sample_table.hpp>
#include <inverse_dynamics_solver/conformance/reference_values.hpp>
#include <inverse_dynamics_solver/external_wrench.hpp>
#include <inverse_dynamics_solver/kinematics.hpp>
#include <inverse_dynamics_solver/motor_currents.hpp>
#include <inverse_dynamics_solver/solver_loader.hpp>
#include <inverse_dynamics_solver/torque_derivatives.hpp>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "chain_dynamics/fast_model.hpp"
#include "chain_dynamics/model_file.hpp"
#include "chain_dynamics/regressor.hpp"
#include "chain_dynamics/torques.hpp"
#include "chain_dynamics/urdf.hpp"
#include "inverse_dynamics_evaluation/accelerations.hpp"
#include "layouts.hpp"

namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using inverse_dynamics_solver::conformance::expectReferenceValues;
using inverse_dynamics_solver::conformance::robotsFile;
using inverse_dynamics_solver::conformance::textOf;

// Torques of up to 500 N m, after a few hundred operations in another order.
constexpr double kRounding = 1e-10;

const VectorXd kQ = VectorXd::LinSpaced(6, -1.0, 1.0);
const VectorXd kQd = VectorXd::LinSpaced(6, 0.5, -0.5);
const VectorXd kQdd = VectorXd::LinSpaced(6, 2.0, 1.0);

/// A mass on a rod, as a user writes it.
class Pendulum : public inverse_dynamics_solver::InverseDynamicsSolver {
 public:
  VectorXd home = VectorXd::Constant(1, 0.3);

 protected:
  JointInfo configure(const inverse_dynamics_solver::Configuration& configuration) override {
    const inverse_dynamics_solver::Configuration kept = configuration;
    mass_ = kept.require<double>("mass");
    held_ = kept.locked_position("finger").value();
    return {{"pivot"}, {}};
  }
  void computeInertiaMatrix(const inverse_dynamics_solver::ConstVectorRef&,
                            inverse_dynamics_solver::MatrixRef H) const override {
    H(0, 0) = mass_;
  }
  void computeCoriolisVector(const inverse_dynamics_solver::ConstVectorRef&,
                             const inverse_dynamics_solver::ConstVectorRef&,
                             inverse_dynamics_solver::VectorRef c) const override {
    c.setZero();
  }
  void computeGravityVector(const inverse_dynamics_solver::ConstVectorRef& q,
                            inverse_dynamics_solver::VectorRef g) const override {
    g = 9.81 * mass_ * q.array().cos() + held_;
  }
  bool inertiaIsPhysicalImpl() const override { return true; }

 private:
  double mass_ = 0, held_ = 0;
};

std::shared_ptr<inverse_dynamics_solver::InverseDynamicsSolver> ur10Solver() {
  auto solver = inverse_dynamics_solver::SolverLoader().load(
      "rigid_body_inverse_dynamics_solver/InverseDynamicsSolverRigidBody");
  solver->initialize({{"root", std::string("base_link")}, {"tip", std::string("tool0")}}, "",
                     textOf(robotsFile("urdf/ur10.urdf")));
  return solver;
}

inverse_dynamics_control::LawOptions lawOptions(
    const inverse_dynamics_solver::InverseDynamicsSolver& solver) {
  inverse_dynamics_control::LawOptions options;
  options.limits.effort = VectorXd::Constant(6, 500.0);
  options.limits.rate = VectorXd::Constant(6, 1e6);
  options.damping = VectorXd::Zero(3);
  options.damping = VectorXd(0.5 * solver.getInertiaMatrix(kQ).diagonal());
  return options;
}

TEST(UsersProgram, SeesTheLayoutsOfThePackages) {
  const std::vector<Layout> packages = packagesLayouts(), mine = usersLayouts();
  ASSERT_EQ(packages.size(), mine.size());
  for (std::size_t i = 0; i < mine.size(); ++i) {
    EXPECT_EQ(packages[i].size, mine[i].size) << mine[i].type;
    EXPECT_EQ(packages[i].alignment, mine[i].alignment) << mine[i].type;
  }
}

TEST(UsersProgram, ReadsCopiesChangesAndFreesModels) {
  chain_dynamics::Model model =
      chain_dynamics::modelFromFile(robotsFile("models/ur10_identified.yaml"));
  chain_dynamics::Model copy = model, moved = std::move(model);
  model = moved;
  copy = std::move(moved);
  copy.drive_gains = 2.0 * copy.drive_gains;
  copy.drive_gains = VectorXd::Constant(6, 3.0);
  chain_dynamics::checkModel(copy);
  EXPECT_EQ(copy.drive_gains, VectorXd::Constant(6, 3.0));

  VectorXd tau(6), f(6), fast(6);
  chain_dynamics::torques(model, kQ, kQd, kQdd, tau);
  chain_dynamics::frictionVector(model, kQ, kQd, f);
  chain_dynamics::FastModel(model).torques(kQ.data(), kQd.data(), kQdd.data(), fast.data());
  EXPECT_LT((tau + f - fast).cwiseAbs().maxCoeff(), kRounding);
}

TEST(UsersProgram, ComputesWithTheTemplatesWhatTheLibraryComputes) {
  chain_dynamics::UrdfOptions options;
  const VectorXd held = VectorXd::Constant(5, 0.25);
  options.locked_position = [held](const std::string& joint) {
    return joint == "finger" ? std::optional<double>(held[0]) : std::nullopt;
  };
  options.root = "base_link";
  options.tip = "tool0";
  const chain_dynamics::Chain chain =
      chain_dynamics::chainFromUrdf(textOf(robotsFile("urdf/ur10.urdf")), options);
  const chain_dynamics::Model model(chain);
  VectorXd mine(6), library(6);
  MatrixXd Y(6, 60);
  chain_dynamics::torques(chain, kQ, kQd, kQdd, mine);
  chain_dynamics::torques(model, kQ, kQd, kQdd, library);
  EXPECT_LT((mine - library).cwiseAbs().maxCoeff(), kRounding);
  chain_dynamics::regressor(chain, kQ, kQd, kQdd, Y);
  EXPECT_LT((Y * chain_dynamics::parameters(chain) - library).cwiseAbs().maxCoeff(), kRounding);
}

TEST(UsersProgram, GetsTheReferenceValuesOfSolvers) {
  expectReferenceValues(*ur10Solver(), "ur10_urdf.json", kRounding);
  const auto ur10 = inverse_dynamics_solver::SolverLoader().load(
      "ur10_inverse_dynamics_solver/InverseDynamicsSolverUR10");
  ur10->initialize();
  expectReferenceValues(*ur10, "ur10.json", kRounding);
}

TEST(UsersProgram, TakesMotorCurrentsByValue) {
  const auto solver = inverse_dynamics_solver::SolverLoader().load(
      "ur10_inverse_dynamics_solver/InverseDynamicsSolverUR10");
  solver->initialize();
  const auto* motors = dynamic_cast<const inverse_dynamics_solver::MotorCurrents*>(solver.get());
  ASSERT_NE(motors, nullptr);
  const MatrixXd K = motors->getDriveGainsMatrix();
  const VectorXd i = motors->getCurrents(kQ, kQd, kQdd);
  EXPECT_LT((K * i - solver->getTorques(kQ, kQd, kQdd)).cwiseAbs().maxCoeff(), kRounding);
  VectorXd mine(6);
  motors->getCurrents(kQ, kQd, kQdd, mine);
  EXPECT_EQ(mine, i);
}

TEST(UsersProgram, TakesWhatCapabilitiesGiveByValue) {
  using namespace inverse_dynamics_solver;
  const auto solver = ur10Solver();
  const auto& kinematics = dynamic_cast<const Kinematics&>(*solver);
  const auto& contact = dynamic_cast<const ExternalWrench&>(*solver);
  const auto& derivatives = dynamic_cast<const TorqueDerivatives&>(*solver);
  const MatrixXd J = kinematics.getTipJacobian(kQ);
  const WrenchInRoot down{{0.0, 0.0, -20.0}, {0.0, 0.0, 0.0}};
  const VectorXd external = contact.getExternalTorques(kQ, down);
  EXPECT_LT((external + 20.0 * J.row(2).transpose()).cwiseAbs().maxCoeff(), kRounding);
  const VectorXd tau = contact.getTorques(kQ, kQd, kQdd, down);
  EXPECT_LT((tau - external - solver->getTorques(kQ, kQd, kQdd)).cwiseAbs().maxCoeff(), kRounding);

  // The same wrench in the axes of the tip.
  const Eigen::Matrix3d R = kinematics.getTipPose(kQ).R;
  const WrenchInTip turned{R.transpose() * down.force, R.transpose() * down.torque};
  EXPECT_LT((contact.getExternalTorques(kQ, turned) - external).cwiseAbs().maxCoeff(), kRounding);
  const auto [by_q, by_qd, H] = derivatives.getTorqueDerivatives(kQ, kQd, kQdd);
  EXPECT_LT((H - solver->getInertiaMatrix(kQ)).cwiseAbs().maxCoeff(), kRounding);
  EXPECT_EQ(kinematics.getTipJacobianBatch(kQ.replicate(1, 3)).cols(), 18);
}

TEST(UsersProgram, DerivesASolver) {
  Pendulum pendulum;
  pendulum.initialize({{"ids.mass", 2.0}, {"ids.locked_joints.finger", 0.5}}, "ids");
  pendulum.home = VectorXd::Zero(1);
  const auto [H, c, g] = pendulum.getDynamicComponents(pendulum.home, pendulum.home);
  EXPECT_DOUBLE_EQ(g[0], 2.0 * 9.81 + 0.5);
  EXPECT_EQ(pendulum.getTorquesBatch(MatrixXd::Zero(1, 40) * 2.0, MatrixXd::Zero(1, 40),
                                     MatrixXd::Ones(1, 40)),
            MatrixXd::Constant(1, 40, g[0] + 2.0));
  EXPECT_THROW(pendulum.getGravityVector(kQ), inverse_dynamics_solver::SizeMismatchException);
}

TEST(UsersProgram, KeepsEveryControlLawOnItsStack) {
  using namespace inverse_dynamics_control;
  const auto solver = ur10Solver();
  LawOptions options = lawOptions(*solver), copy = options;
  options = copy;
  copy = std::move(options);
  Gains gains = Gains::of(VectorXd::Constant(6, 20.0), VectorXd::Ones(6));
  gains.Kd = 2.0 * gains.Kd;
  Gains others = Gains::uniform(6, 20.0, 2.0);
  EXPECT_EQ(gains.Kd, others.Kd);

  ComputedTorque computed_torque(solver, std::move(gains), copy);
  FeedForward feed_forward(solver, ModelState::kReference, copy);
  GravityCompensation gravity(solver, copy);
  JointState state(6);
  Reference reference(6);
  state.q = reference.q = kQ;
  state.qd = reference.qd = kQd;
  reference.qdd = kQdd;
  const VectorXd expected = solver->getTorques(kQ, kQd, kQdd);
  VectorXd tau(6);
  EXPECT_EQ(computed_torque.update(state, reference, 1e-3, tau), Status::kOk);
  EXPECT_LT((tau - expected).cwiseAbs().maxCoeff(), kRounding);
  EXPECT_EQ(feed_forward.update(state, reference, VectorXd::Zero(6), 1e-3, tau), Status::kOk);
  EXPECT_LT((tau - expected).cwiseAbs().maxCoeff(), kRounding);
  ComputedTorque another = computed_torque;
  another = std::move(computed_torque);
  another.start(tau);
  EXPECT_EQ(another.hold(state, 1e-3, tau), Status::kOk);
  const VectorXd safe = tau;
  EXPECT_EQ(gravity.update(state, 1e-3, tau), Status::kOk);
  EXPECT_LT((tau - safe).cwiseAbs().maxCoeff(), kRounding);
  EXPECT_FALSE(another.saturated().any());
}

TEST(UsersProgram, KeepsStopsAndGuardsOnItsStack) {
  using namespace inverse_dynamics_control;
  const std::vector<std::string> names = {"a", "b", "c", "d", "e", "f"};
  SafeStop stop(VectorXd::Constant(6, 2.0), names);
  SafeStop again = stop;
  Reference reference(6);
  EXPECT_EQ(again.begin(kQ, kQd), Status::kOk);
  EXPECT_EQ(again.advance(10.0, reference), Status::kOk);
  EXPECT_TRUE(again.finished());

  ReferenceLimits limits = ReferenceLimits::none(6);
  limits.velocity = VectorXd::Constant(6, 1.0);
  ReferenceGuard guard(limits, VectorXd::Constant(6, 2.0), names);
  guard.start(reference.q);
  Reference copy = guard.next(reference, 1e-3);
  EXPECT_EQ(copy.q, reference.q);
  copy.qd = VectorXd::Constant(6, 9.0);
  guard.next(copy, 1e-3);
  EXPECT_EQ(guard.reason(), StopReason::kVelocity);

  OutputStage output({VectorXd::Constant(6, 1.0), {}}, names, "mine");
  VectorXd tau(6);
  EXPECT_EQ(output.apply(kQ * 5.0, 1e-3, tau), Status::kSaturated);
}

TEST(UsersProgram, EvaluatesALogOfItsOwn) {
  using namespace inverse_dynamics_evaluation;
  constexpr Eigen::Index kSamples = 400;
  const VectorXd time = VectorXd::LinSpaced(kSamples, 0.0, 3.99);
  SampleTable table;
  TableBuilder builder("mine", {{"a"}}, table);
  for (Eigen::Index i = 0; i < kSamples; ++i) {
    const std::vector<std::string> names = {"a"};
    const double q = std::sin(time[i]), qd = std::cos(time[i]), effort = -q;
    JointSample sample;
    sample.names = &names;
    sample.position = {&q, 1};
    sample.velocity = {&qd, 1};
    sample.effort = {&effort, 1};
    sample.header_stamp = 10'000'000 * (i + 1);
    builder.add(sample);
  }
  builder.finish(Clock::kAuto);
  EXPECT_LT((table.time - time).cwiseAbs().maxCoeff(), 1e-9);

  // qdd = -sin t, which the efforts are; the ends of a filter aside
  LowPassOptions options;
  options.cutoff = 20.0;
  AccelerationReport found = findAccelerations(table, AccelerationMethod::kLowPass, options);
  found.summary += " of a user";
  table.kept.head(40) = false;
  table.kept.tail(40) = false;
  EXPECT_LT(metrics(table.qdd, table.effort, Mask(table.kept))[0].rmse, 1e-3);
  MatrixXd raw = backwardDifference(table.time, table.qd);
  raw = 1.0 * raw;
  EXPECT_EQ(raw.cols(), kSamples);
  MatrixXd smooth = lowPass(table.qd, 100.0, 10.0);
  smooth = 1.0 * smooth;

  OnlineDerivative online(1, 5.0);
  OnlineDerivative copy = online;
  copy.update(1, VectorXd::Ones(1));
  copy.update(1000001, VectorXd::Ones(1));
  EXPECT_EQ(copy.derivative().size(), 1);
}

}  // namespace
