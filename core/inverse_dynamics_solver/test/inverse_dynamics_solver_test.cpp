// SPDX-License-Identifier: Apache-2.0
#include "inverse_dynamics_solver/inverse_dynamics_solver.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <limits>
#include <memory>
#include <string>
#include <tuple>
#include <type_traits>
#include <utility>
#include <vector>

#include "inverse_dynamics_solver/conformance/allocation_guard.hpp"
#include "inverse_dynamics_solver/conformance/solver_fixture.hpp"
#include "inverse_dynamics_solver/external_wrench.hpp"
#include "node_parameters_stand_in.hpp"

namespace inverse_dynamics_solver::inverse_dynamics_solver_test {

// A wrench without a frame doesn't compile, nor does one of another frame.
template <class W, class = void>
constexpr bool kIsTaken = false;
template <class W>
constexpr bool
    kIsTaken<W, std::void_t<decltype(std::declval<const ExternalWrench&>().getExternalTorques(
                    Eigen::VectorXd(), std::declval<W>()))>> = true;
using SixNumbers = Eigen::Matrix<double, 6, 1>;
static_assert(kIsTaken<WrenchInRoot> && kIsTaken<WrenchInTip>);
static_assert(!kIsTaken<SixNumbers> && !kIsTaken<Eigen::VectorXd>);
static_assert(!std::is_constructible_v<WrenchInRoot, WrenchInTip>);
static_assert(!std::is_convertible_v<Eigen::MatrixXd&, WrenchesInRoot>);
static_assert(!std::is_constructible_v<WrenchesInTip, WrenchesInRoot>);
static_assert(!std::is_constructible_v<WrenchesInTip, const WrenchesInRoot&>);
static_assert(std::is_constructible_v<WrenchesInTip, Eigen::MatrixXd&>);

/// Made-up dynamics of any number of joints, with terms that can be told apart: H = diag(2) + 0.1,
/// c = q qd, g = 100 q.
class MadeUp : public InverseDynamicsSolver {
 public:
  Configuration seen;
  mutable int calls = 0;

 protected:
  JointInfo configure(const Configuration& configuration) override {
    JointInfo info;
    const auto n = configuration.get<std::int64_t>("joints").value_or(6);
    if (n < 1) throw InvalidParameterValueException("no joints");
    for (std::int64_t i = 0; i < n; ++i) info.joint_names.push_back("joint" + std::to_string(i));
    info.warnings = {"made up"};
    seen = configuration;
    return info;
  }
  void computeInertiaMatrix(const ConstVectorRef&, MatrixRef H) const override {
    ++calls;
    H.setConstant(0.1);
    H.diagonal().array() += 2.0;
  }
  void computeCoriolisVector(const ConstVectorRef& q, const ConstVectorRef& qd,
                             VectorRef c) const override {
    ++calls;
    c = q.cwiseProduct(qd);
  }
  void computeGravityVector(const ConstVectorRef& q, VectorRef g) const override {
    ++calls;
    g = 100.0 * q;
  }
  bool inertiaIsPhysicalImpl() const override { return false; }
};

/// The same with friction.
class MadeUpWithFriction : public MadeUp {
 protected:
  void computeFriction(const ConstVectorRef&, const ConstVectorRef& qd,
                       VectorRef f) const override {
    f = 1e4 * qd;
  }
};

template <class Solver = MadeUp>
std::unique_ptr<Solver> initialized(int joints = 6) {
  auto solver = std::make_unique<Solver>();
  solver->initialize({{"joints", joints}});
  return solver;
}

using Vector6d = Eigen::Matrix<double, 6, 1>;
using Matrix6d = Eigen::Matrix<double, 6, 6>;

TEST(InverseDynamicsSolver, DefaultTorquesAreTheSumOfTheTerms) {
  const auto solver = initialized<MadeUpWithFriction>(2);
  const Eigen::Vector2d q(1, 2), qd(3, 4), qdd(5, 6);

  // H qdd = (2 * 5 + 1.1, 2 * 6 + 1.1), c = (3, 8), f = (3e4, 4e4), g = (100, 200)
  EXPECT_TRUE(solver->getTorques(q, qd, qdd)
                  .isApprox(Eigen::Vector2d(11.1 + 3 + 3e4 + 100, 13.1 + 8 + 4e4 + 200), 1e-15));
  const auto [H, c, g] = solver->getDynamicComponents(q, qd);
  EXPECT_EQ(H, (Eigen::Matrix2d() << 2.1, 0.1, 0.1, 2.1).finished());
  EXPECT_EQ(c, Eigen::Vector2d(3, 8));
  EXPECT_EQ(g, Eigen::Vector2d(100, 200));
}

TEST(InverseDynamicsSolver, FrictionOfMutableVelocitiesIsReturned) {
  const auto solver = initialized(2);
  Eigen::VectorXd q = Eigen::Vector2d(1, 2), qd = Eigen::Vector2d(3, 4);
  EXPECT_EQ(solver->getFrictionVector(q, qd), Eigen::VectorXd::Zero(2));
  EXPECT_EQ(qd, Eigen::Vector2d(3, 4));
  Eigen::MatrixXd many = Eigen::MatrixXd::Ones(2, 3);
  EXPECT_EQ(solver->getFrictionVectorBatch(many, many), Eigen::MatrixXd::Zero(2, 3));
  EXPECT_EQ(many, Eigen::MatrixXd::Ones(2, 3));
  const ConstStates unknown(many.data(), 0, 3, 1, 0);  // positions
  EXPECT_EQ(solver->getFrictionVectorBatch(unknown, many), Eigen::MatrixXd::Zero(2, 3));
}

TEST(InverseDynamicsSolver, DefaultsDoNotAllocateUpToSixtyFourJoints) {
  if (!conformance::kAllocationGuardWorks) GTEST_SKIP() << "allocations can't be counted";
  for (const int n : {1, 64, 65}) {
    const auto solver = initialized(n);
    const Eigen::VectorXd q = Eigen::VectorXd::Ones(n);
    Eigen::VectorXd tau(n);
    conformance::AllocationGuard guard;
    solver->getTorques(q, q, q, tau);
    const long count = guard.count();
    EXPECT_EQ(count > 0, n > 64) << n << " joints: " << count;

    // H of ones times ones: 2 + 0.1 n, and 1 + 100.
    EXPECT_NEAR(tau[n - 1], 2 + 0.1 * n + 101, 1e-12);
  }
}

TEST(InverseDynamicsSolver, TakesEveryKindOfVector) {
  const auto solver = initialized();
  const double values[] = {1, 2, 3, 4, 5, 6};
  const Vector6d fixed(values);
  const Eigen::VectorXd expected = solver->getTorques(fixed, fixed, fixed);

  // Dynamic, mapped, block, row of a matrix (copied by Eigen), row vector, expression,
  // std::vector's memory.
  const Eigen::VectorXd dynamic = fixed;
  const Eigen::Map<const Eigen::VectorXd> mapped(values, 6);
  const Eigen::Map<const Vector6d> mapped_fixed(values);
  Eigen::MatrixXd rows(2, 8);
  rows << fixed.transpose(), 0, 0, fixed.transpose(), 0, 0;
  Eigen::VectorXd longer(8);
  longer << fixed, 0, 0;
  const Eigen::RowVectorXd row = fixed.transpose();
  const std::vector<double> standard(values, values + 6);
  EXPECT_EQ(solver->getTorques(dynamic, mapped, mapped_fixed), expected);
  EXPECT_EQ(solver->getTorques(longer.head(6), longer.head<6>(), fixed + 0 * fixed), expected);
  EXPECT_EQ(solver->getTorques(rows.row(1).head(6), rows.row(0).head<6>().transpose(), row),
            expected);
  EXPECT_EQ(solver->getTorques(Eigen::VectorXd::LinSpaced(6, 1, 6), 1 * fixed,
                               Eigen::Map<const Vector6d>(standard.data())),
            expected);
  EXPECT_EQ(solver->getGravityVector(rows.row(1).head(6)), 100 * dynamic);

  // Results into fixed sizes, blocks, maps and columns.
  const Vector6d tau = solver->getTorques(fixed, fixed, fixed);
  const Matrix6d H = solver->getInertiaMatrix(fixed);
  const std::tuple<Matrix6d, Vector6d, Vector6d> parameters =
      solver->getDynamicParameters(fixed, fixed);
  EXPECT_EQ(tau, expected);
  EXPECT_EQ(std::get<0>(parameters), H);
  Vector6d fixed_out;
  Matrix6d fixed_H;
  Eigen::MatrixXd block(8, 8);
  double memory[6];
  solver->getTorques(fixed, fixed, fixed, fixed_out);
  EXPECT_EQ(fixed_out, expected);
  solver->getTorques(fixed, fixed, fixed, Eigen::Map<Vector6d>(memory));
  EXPECT_EQ(Vector6d(memory), expected);
  solver->getTorques(fixed, fixed, fixed, block.col(3).segment<6>(1));
  EXPECT_EQ(block.col(3).segment(1, 6), expected);
  solver->getInertiaMatrix(fixed, fixed_H);
  EXPECT_EQ(fixed_H, H);
  solver->getDynamicComponents(fixed, fixed, block.topLeftCorner(6, 6), fixed_out,
                               Eigen::Map<Vector6d>(memory));
  EXPECT_EQ(block.topLeftCorner(6, 6), H);
}

TEST(InverseDynamicsSolver, ContiguousInputsAreNotCopied) {
  if (!conformance::kAllocationGuardWorks) GTEST_SKIP() << "allocations can't be counted";
  const auto solver = initialized();
  const Vector6d fixed = Vector6d::Ones();
  const Eigen::MatrixXd columns = Eigen::MatrixXd::Ones(8, 3);
  Eigen::VectorXd tau(6);
  conformance::AllocationGuard guard;
  solver->getTorques(fixed, columns.col(1).head(6), Eigen::Map<const Vector6d>(fixed.data()), tau);
  EXPECT_EQ(guard.count(), 0);
}

TEST(InverseDynamicsSolver, ChecksBeforeItComputes) {
  const auto solver = initialized();
  const Vector6d q = Vector6d::Zero();
  Eigen::VectorXd tau(5);
  EXPECT_THROW(solver->getTorques(q, q, q, tau), SizeMismatchException);
  EXPECT_THROW(MadeUp().getTorques(q, q, q), UninitializedException);
  EXPECT_EQ(solver->calls, 0);
}

TEST(InverseDynamicsSolver, WrongSizesAreExplained) {
  const auto solver = initialized(2);
  const auto error = [](const auto& call) {
    return conformance::errorOf<SizeMismatchException>(call);
  };
  const Eigen::Vector2d q(1, 2);
  EXPECT_EQ(error([&] { solver->getCoriolisVector(q, Eigen::Vector3d::Zero()); }),
            "getCoriolisVector: argument qd: wrong size: expected 2 numbers, got 3; the joints are "
            "joint0, joint1");
  Eigen::MatrixXd H(2, 3);
  EXPECT_EQ(error([&] { solver->getInertiaMatrix(q, H); }),
            "getInertiaMatrix: argument H: wrong size: expected 2 x 2, got 2 x 3; the joints are "
            "joint0, joint1");
  const Eigen::MatrixXd states = Eigen::MatrixXd::Zero(2, 5);
  EXPECT_EQ(error([&] { solver->getTorquesBatch(states, states, states.transpose()); }),
            "getTorquesBatch: argument qdd: wrong size: expected 2 x 5, got 5 x 2; the joints are "
            "joint0, joint1");
  EXPECT_EQ(error([&] { solver->getInertiaMatrixBatch(states, H); }),
            "getInertiaMatrixBatch: argument H: wrong size: expected 2 x 10, got 2 x 3; the joints "
            "are joint0, joint1");

#ifdef NDEBUG  // else Eigen's own assertion comes first
  // A matrix where one state is expected isn't taken for its first column.
  EXPECT_NE(error([&] { solver->getGravityVector(Eigen::MatrixXd::Zero(1, 4)); }), "");
#endif
}

TEST(InverseDynamicsSolver, TellsItsJoints) {
  const auto solver = initialized(2);
  EXPECT_EQ(solver->jointCount(), 2);
  EXPECT_EQ(solver->jointNames(), (std::vector<std::string>{"joint0", "joint1"}));
  EXPECT_EQ(solver->warnings(), std::vector<std::string>{"made up"});
  EXPECT_FALSE(solver->inertiaIsPhysical());
}

TEST(InverseDynamicsSolver, InitializeReadsTheParametersOfANode) {
  const auto node = std::make_shared<stand_in::NodeParameters>();
  node->values = {{"robot_description", std::string("<robot/>")},
                  {"ids.tip", std::string("tool0")},
                  {"ids.gravity", std::vector<double>{0, 0, -1}},
                  {"ids.joints", std::int64_t{3}}};
  MadeUp solver;
  const stand_in::NodeParametersInterface::SharedPtr interface = node;
  solver.initialize(interface, "ids");
  EXPECT_EQ(solver.jointCount(), 3);
  EXPECT_EQ(solver.seen.tip, "tool0");
  EXPECT_EQ(solver.seen.gravity, Eigen::Vector3d(0, 0, -1));
  EXPECT_EQ(solver.seen.robot_description, "<robot/>");
  solver.initialize(interface, "ids", "<other/>");
  EXPECT_EQ(solver.seen.robot_description, "<other/>");
}

TEST(InverseDynamicsSolver, InitializeNeedsNoArguments) {
  MadeUp solver;
  solver.initialize();
  EXPECT_EQ(solver.jointCount(), 6);
  solver.initialize(nullptr);
  solver.initialize({});
  solver.initialize({{"joints", 2}});
  EXPECT_EQ(solver.jointCount(), 2);
  solver.initialize(Parameters::fromYaml("ids: {joints: 4}"), "ids");
  EXPECT_EQ(solver.jointCount(), 4);
}

}  // namespace inverse_dynamics_solver::inverse_dynamics_solver_test
