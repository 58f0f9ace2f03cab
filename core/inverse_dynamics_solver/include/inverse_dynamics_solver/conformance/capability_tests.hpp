// SPDX-License-Identifier: Apache-2.0
/// @file
/// Conformance, part six: errors and laws of the capabilities that a solver has. Include
/// conformance_tests.hpp, not this.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "chain_dynamics/chain.hpp"
#include "chain_dynamics/mechanism.hpp"
#include "chain_dynamics/model.hpp"
#include "chain_dynamics/regressor.hpp"
#include "chain_dynamics/spatial.hpp"
#include "inverse_dynamics_solver/conformance/allocation_guard.hpp"
#include "inverse_dynamics_solver/conformance/batch_tests.hpp"
#include "inverse_dynamics_solver/conformance/capabilities.hpp"
#include "inverse_dynamics_solver/conformance/law_tests.hpp"
#include "inverse_dynamics_solver/friction_memory.hpp"
#include "inverse_dynamics_solver/torque_deviation.hpp"

namespace inverse_dynamics_solver::conformance {

/// The capability, or a test that is skipped.
#define INVERSE_DYNAMICS_SOLVER_REQUIRE(Capability, name)                 \
  const auto* const name = dynamic_cast<const Capability*>(&s);           \
  if (name == nullptr) GTEST_SKIP() << "this solver has no " #Capability; \
  static_assert(true)

/// q moved for a time with qd.
inline Eigen::VectorXd moved(const State& x, double time) { return x.q + time * x.qd; }

/// A step in time in which all joints together move by kDifferenceStep.
inline double timeStep(const State& x) { return kDifferenceStep / x.qd.cwiseAbs().sum(); }

TEST_P(SolverConformance, CapabilitiesRefuseWrongSizes) {
  const InverseDynamicsSolver& s = *solver_;
  const Eigen::Index n = s.jointCount();
  const auto refuses = [&](const Method& method, const std::function<void()>& call) {
    const std::string error = errorOf<SizeMismatchException>(call);
    EXPECT_TRUE(contains(error, {method.name, "argument ", "expected "}));
  };
  for (const Method& method : methodsOf(s)) {
    SCOPED_TRACE(method.name);
    const Eigen::VectorXd ok = Eigen::VectorXd::Zero(n);
    const Eigen::VectorXd no = Eigen::VectorXd::Zero(n + 1);
    refuses(method, [&] { method.by_value({no, ok, ok}); });
    Matrices out = method.shapes.memory();
    refuses(method, [&] { method.into_memory({no, no, no}, out); });

    // Each output, of one state and of two.
    const Eigen::MatrixXd two = Eigen::MatrixXd::Zero(n, 2);
    const std::size_t matrices = method.shapes.matrices.size();
    for (std::size_t i = 0; i < out.size(); ++i) {
      Method wrong = method;
      if (i < matrices) {
        ++wrong.shapes.matrices[i].second;
      } else {
        ++wrong.shapes.vectors[i - matrices];
      }
      const BatchLayout columns = batchLayouts().front();
      refuses(method, [&] { batchResult(wrong, columns, two, two, two); });
      Matrices of_one = wrong.shapes.memory();
      // (pose and energies have a type of their own)
      if (method.name == "getTipPose" || out[i].size() == 1) continue;
      refuses(method, [&] { method.into_memory({ok, ok, ok}, of_one); });
    }
    const Eigen::MatrixXd three = Eigen::MatrixXd::Zero(n, 3);
    Matrices memory = method.shapes.memory();
    BatchOutputs outputs;
    for (std::size_t i = 0; i < memory.size(); ++i) {
      if (i < matrices) {
        outputs.matrices.emplace_back(memory[i]);
      } else {
        outputs.vectors.emplace_back(memory[i]);
      }
    }
    refuses(method, [&] { method.batch(three, three, three, outputs); });
  }
}

TEST_P(SolverConformance, TipJacobianIsTheDerivativeOfTheTipPose) {
  const InverseDynamicsSolver& s = *solver_;
  INVERSE_DYNAMICS_SOLVER_REQUIRE(Kinematics, kinematics);
  for (const State& x : randomStates(kStates)) {
    SCOPED_TRACE(toString(x));
    const Eigen::MatrixXd J = kinematics->getTipJacobian(x.q);
    const auto pose = kinematics->getTipPose(x.q);
    const Eigen::Matrix3d RtR = pose.R.transpose() * pose.R;
    EXPECT_TRUE(near(RtR, Eigen::Matrix3d::Identity(), kRounding, 1.0));
    EXPECT_GT(pose.R.determinant(), 0.0);
    for (Eigen::Index j = 0; j < s.jointCount(); ++j) {
      const auto at = [&](double step) {
        return kinematics->getTipPose(x.q + step * Eigen::VectorXd::Unit(s.jointCount(), j));
      };
      const auto position = [&](double step) -> Eigen::MatrixXd { return at(step).p; };
      const auto rotation = [&](double step) -> Eigen::MatrixXd { return at(step).R; };
      EXPECT_TRUE(near(J.col(j).head<3>(), derivative(position, kDifferenceStep), kDifference,
                       sizeOf(pose.p)));

      // dR/dq R^T = [w]x
      const Eigen::Matrix3d w_x = derivative(rotation, kDifferenceStep) * pose.R.transpose();
      EXPECT_TRUE(near(w_x, chain_dynamics::skew<double>(J.col(j).tail<3>()), kDifference, 1.0));
    }
  }
}

TEST_P(SolverConformance, TipJacobianDerivativeIsItsRate) {
  const InverseDynamicsSolver& s = *solver_;
  INVERSE_DYNAMICS_SOLVER_REQUIRE(Kinematics, kinematics);
  for (const State& x : randomStates(kStates)) {
    SCOPED_TRACE(toString(x));
    const auto J = [&](double time) { return kinematics->getTipJacobian(moved(x, time)); };
    const double size = sizeOf(J(0.0)) * x.qd.cwiseAbs().sum();
    EXPECT_TRUE(near(kinematics->getTipJacobianDerivative(x.q, x.qd), derivative(J, timeStep(x)),
                     kDifference, size));
  }
}

TEST_P(SolverConformance, WrenchAddsItsPowerPerVelocity) {
  const InverseDynamicsSolver& s = *solver_;
  INVERSE_DYNAMICS_SOLVER_REQUIRE(ExternalWrench, contact);
  Eigen::Matrix<double, 6, 1> w;
  w << kWrenchInRoot.force, kWrenchInRoot.torque;
  for (const State& x : randomStates(kStates)) {
    SCOPED_TRACE(toString(x));
    const Eigen::VectorXd external = contact->getExternalTorques(x.q, kWrenchInRoot);
    const Eigen::VectorXd tau = s.getTorques(x.q, x.qd, x.qdd);
    EXPECT_TRUE(near(contact->getTorques(x.q, x.qd, x.qdd, kWrenchInRoot), tau + external,
                     kRounding, sizeOf(tau) + sizeOf(external)));
    EXPECT_TRUE(near(contact->getExternalTorques(x.q, WrenchInTip()), 0 * tau, 0.0, 1.0));

    const auto* kinematics = dynamic_cast<const Kinematics*>(&s);
    if (kinematics == nullptr) continue;
    const Eigen::MatrixXd J = kinematics->getTipJacobian(x.q);
    EXPECT_TRUE(near(external, J.transpose() * w, kRounding, sizeOf(J) * w.cwiseAbs().sum()));

    // The same wrench in the axes of the tip.
    const Eigen::Matrix3d R = kinematics->getTipPose(x.q).R;
    const WrenchInTip turned{R.transpose() * kWrenchInRoot.force,
                             R.transpose() * kWrenchInRoot.torque};
    EXPECT_TRUE(near(contact->getExternalTorques(x.q, turned), external, kRounding,
                     sizeOf(J) * w.cwiseAbs().sum()));
  }
}

TEST_P(SolverConformance, EachTipIsTheOneOfASolverWhoseFirstTipItIs) {
  const InverseDynamicsSolver& s = *solver_;
  INVERSE_DYNAMICS_SOLVER_REQUIRE(Kinematics, kinematics);
  INVERSE_DYNAMICS_SOLVER_REQUIRE(ExternalWrench, contact);
  std::vector<std::string> tips = s.tipNames();
  if (tips.front().empty()) GTEST_SKIP() << "the tip has no name";
  const Eigen::Index n = s.jointCount();
  for (const std::string& tip : s.tipNames()) {
    SCOPED_TRACE(tip);
    std::iter_swap(tips.begin(), std::find(tips.begin(), tips.end(), tip));
    const auto turned = makeInitialized({{"tip", tips}});
    const auto& first = dynamic_cast<const Kinematics&>(*turned);
    const auto& first_contact = dynamic_cast<const ExternalWrench&>(*turned);
    const Kinematics& own = kinematics->kinematicsOf(tip);
    const ExternalWrench& own_contact = contact->externalWrenchAt(tip);
    for (const std::string& other : tips) {
      EXPECT_EQ(&own.kinematicsOf(other), &kinematics->kinematicsOf(other));
      EXPECT_EQ(&own_contact.externalWrenchAt(other), &contact->externalWrenchAt(other));
    }
    for (const State& x : randomStates(kStates)) {
      Eigen::MatrixXd J(6, n), dJ(6, n);
      Eigen::VectorXd tau(n), tau_of_motion(n);
      {
        const AllocationGuard guard;
        own.getTipJacobian(x.q, J);
        own.getTipJacobianDerivative(x.q, x.qd, dJ);
        own_contact.getExternalTorques(x.q, kWrenchInTip, tau);
        own_contact.getTorques(x.q, x.qd, x.qdd, kWrenchInTip, tau_of_motion);
        EXPECT_EQ(guard.count(), 0);
      }
      const auto pose = own.getTipPose(x.q), expected = first.getTipPose(x.q);
      EXPECT_TRUE(near(pose.R, expected.R, kRounding, 1.0));
      EXPECT_TRUE(near(pose.p, expected.p, kRounding, sizeOf(expected.p)));
      EXPECT_TRUE(near(J, first.getTipJacobian(x.q), kRounding, sizeOf(J)));
      EXPECT_TRUE(near(dJ, first.getTipJacobianDerivative(x.q, x.qd), kRounding, sizeOf(dJ)));
      EXPECT_TRUE(
          near(tau, first_contact.getExternalTorques(x.q, kWrenchInTip), kRounding, sizeOf(tau)));
      EXPECT_TRUE(near(tau_of_motion, s.getTorques(x.q, x.qd, x.qdd) + tau, kRounding,
                       sizeOf(tau_of_motion)));
    }
  }
}

TEST_P(SolverConformance, NanInAWrenchGivesNan) {
  const InverseDynamicsSolver& s = *solver_;
  INVERSE_DYNAMICS_SOLVER_REQUIRE(ExternalWrench, contact);
  const State x = randomState();
  for (Eigen::Index i = 0; i < 3; ++i) {
    for (Eigen::Vector3d WrenchInRoot::*half : {&WrenchInRoot::force, &WrenchInRoot::torque}) {
      WrenchInRoot unit, nan;
      (unit.*half)[i] = 1.0;
      (nan.*half)[i] = std::numeric_limits<double>::quiet_NaN();
      const Eigen::VectorXd needed = contact->getExternalTorques(x.q, unit);
      const Eigen::VectorXd lost = contact->getExternalTorques(x.q, nan);
      for (Eigen::Index j = 0; j < s.jointCount(); ++j) {
        EXPECT_TRUE(needed[j] == 0.0 || std::isnan(lost[j])) << "joint " << j;
      }
    }
  }
}

TEST_P(SolverConformance, CoriolisMatrixIsThatOfChristoffelsSymbols) {
  const InverseDynamicsSolver& s = *solver_;
  INVERSE_DYNAMICS_SOLVER_REQUIRE(CoriolisMatrix, coriolis);
  const Eigen::Index n = s.jointCount();
  for (const State& x : randomStates(kStates)) {
    SCOPED_TRACE(toString(x));
    const Eigen::MatrixXd C = coriolis->getCoriolisMatrix(x.q, x.qd);
    const double size = sizeOf(C) * sizeOf(x.qd);
    EXPECT_TRUE(near(C * x.qd, s.getCoriolisVector(x.q, x.qd), kRounding, size));

    // 2 C_ij = d(C qd)_i / d qd_j, exactly by a difference as C qd is quadratic
    Eigen::MatrixXd twice(n, n);
    for (Eigen::Index j = 0; j < n; ++j) {
      const Eigen::VectorXd unit = Eigen::VectorXd::Unit(n, j);
      twice.col(j) =
          (s.getCoriolisVector(x.q, x.qd + unit) - s.getCoriolisVector(x.q, x.qd - unit)) / 2.0;
    }
    EXPECT_TRUE(near(2.0 * C, twice, kRounding, 4.0 * size));
  }
}

TEST_P(SolverConformance, RateOfInertiaIsTheCoriolisMatrixPlusItsTranspose) {
  const InverseDynamicsSolver& s = *solver_;
  INVERSE_DYNAMICS_SOLVER_REQUIRE(CoriolisMatrix, coriolis);
  const Eigen::MatrixXd H = s.getInertiaMatrix(randomState().q);
  if (!near(H, H.transpose(), kRounding, sizeOf(H))) {
    GTEST_SKIP() << "the inertia matrix of this solver isn't symmetric";
  }
  for (const State& x : randomStates(kStates)) {
    SCOPED_TRACE(toString(x));
    const auto inertia = [&](double time) { return s.getInertiaMatrix(moved(x, time)); };
    const Eigen::MatrixXd C = coriolis->getCoriolisMatrix(x.q, x.qd);
    const double size = sizeOf(inertia(0.0)) * x.qd.cwiseAbs().sum();
    EXPECT_TRUE(near(C + C.transpose(), derivative(inertia, timeStep(x)), kDifference, size));
  }
}

TEST_P(SolverConformance, EnergyGrowsWithThePowerOfTheTorques) {
  const InverseDynamicsSolver& s = *solver_;
  INVERSE_DYNAMICS_SOLVER_REQUIRE(Energies, energies);
  const auto fresh = make();
  errorOf<UninitializedException>([&] { dynamic_cast<const Energies&>(*fresh).hasEnergies(); });
  if (!energies->hasEnergies()) {
    const State x = randomState();
    const Eigen::MatrixXd H = s.getInertiaMatrix(x.q);
    EXPECT_FALSE(near(H, H.transpose(), kRounding, sizeOf(H))) << "H is symmetric";
    for (const auto& call :
         std::vector<std::function<void()>>{[&] { energies->getKineticEnergy(x.q, x.qd); },
                                            [&] { energies->getPotentialEnergy(x.q); },
                                            [&] { energies->getKineticEnergyBatch(x.q, x.qd); },
                                            [&] { energies->getPotentialEnergyBatch(x.q); }}) {
      EXPECT_TRUE(contains(errorOf<Exception>(call), {"Energy", "symmetric", "hasEnergies()"}));
    }
    return;
  }
  for (const State& x : randomStates(kStates)) {
    SCOPED_TRACE(toString(x));
    const double T = energies->getKineticEnergy(x.q, x.qd);
    const Eigen::MatrixXd H = s.getInertiaMatrix(x.q);
    EXPECT_NEAR(T, 0.5 * x.qd.dot(H * x.qd), kRounding * sizeOf(H) * x.qd.squaredNorm());

    const auto energy = [&](double time) {
      const Eigen::VectorXd q = moved(x, time) + 0.5 * time * time * x.qdd;
      const Eigen::VectorXd qd = x.qd + time * x.qdd;
      return Eigen::MatrixXd::Constant(
          1, 1, energies->getKineticEnergy(q, qd) + energies->getPotentialEnergy(q));
    };
    const Eigen::VectorXd f = s.getFrictionVector(x.q, x.qd);
    const Eigen::VectorXd tau = s.getTorques(x.q, x.qd, x.qdd) - f;
    const double speed = x.qd.cwiseAbs().sum() + x.qdd.cwiseAbs().sum();
    const double size =
        speed * (std::abs(T) + sizeOf(tau) + std::abs(energies->getPotentialEnergy(x.q)));
    EXPECT_NEAR(derivative(energy, kDifferenceStep / speed)(0), x.qd.dot(tau), kDifference * size);
  }
}

TEST_P(SolverConformance, TorqueDerivativesAreThoseOfTheTorques) {
  const InverseDynamicsSolver& own = *solver_;
  if (dynamic_cast<const TorqueDerivatives*>(&own) == nullptr) {
    GTEST_SKIP() << "this solver has no TorqueDerivatives";
  }
  // Without friction, whose laws may be steeper than a difference can tell.
  const auto smooth = makeInitialized({{"friction", false}});
  const InverseDynamicsSolver& s = *smooth;
  INVERSE_DYNAMICS_SOLVER_REQUIRE(TorqueDerivatives, derivatives);
  const Eigen::Index n = s.jointCount();
  for (const State& x : randomStates(kStates)) {
    SCOPED_TRACE(toString(x));
    const auto [by_q, by_qd, by_qdd] = derivatives->getTorqueDerivatives(x.q, x.qd, x.qdd);
    const double size = sizeOf(s.getTorques(x.q, x.qd, x.qdd)) + sizeOf(by_q) + sizeOf(by_qd) +
                        sizeOf(by_qdd) * sizeOf(x.qdd);
    for (Eigen::Index j = 0; j < n; ++j) {
      const Eigen::VectorXd unit = Eigen::VectorXd::Unit(n, j);
      const auto with_q = [&](double h) -> Eigen::MatrixXd {
        return s.getTorques(x.q + h * unit, x.qd, x.qdd);
      };
      const auto with_qd = [&](double h) -> Eigen::MatrixXd {
        return s.getTorques(x.q, x.qd + h * unit, x.qdd);
      };
      EXPECT_TRUE(near(by_q.col(j), derivative(with_q, kDifferenceStep), kDifference, size));
      EXPECT_TRUE(near(by_qd.col(j), derivative(with_qd, kDifferenceStep), kDifference, size));
    }
    EXPECT_TRUE(near(by_qdd, s.getInertiaMatrix(x.q), kRounding, sizeOf(by_qdd)));
  }
}

TEST_P(SolverConformance, TorqueDerivativesIncludeFriction) {
  const InverseDynamicsSolver& s = *solver_;
  INVERSE_DYNAMICS_SOLVER_REQUIRE(TorqueDerivatives, derivatives);
  const auto smooth = makeInitialized({{"friction", false}});
  const auto& without = dynamic_cast<const TorqueDerivatives&>(*smooth);
  const Eigen::Index n = s.jointCount();
  for (const State& x : randomStates(kStates)) {
    SCOPED_TRACE(toString(x));
    const auto [q_with, qd_with, qdd_with] = derivatives->getTorqueDerivatives(x.q, x.qd, x.qdd);
    const auto [q_without, qd_without, qdd_without] =
        without.getTorqueDerivatives(x.q, x.qd, x.qdd);
    EXPECT_TRUE(near(qdd_with, qdd_without, kRounding, sizeOf(qdd_with)));

    // A difference of steep laws: small steps, so fewer digits.
    const Eigen::MatrixXd slopes = qd_with - qd_without, by_load = q_with - q_without;
    for (Eigen::Index j = 0; j < n; ++j) {
      const auto friction = [&](double h) -> Eigen::MatrixXd {
        return s.getFrictionVector(x.q, x.qd + h * Eigen::VectorXd::Unit(n, j));
      };
      const double size = sizeOf(friction(0.0)) + sizeOf(qd_with);
      EXPECT_TRUE(near(slopes.col(j), derivative(friction, kSteepStep), kSteepDifference, size));
      const auto elsewhere = [&](double h) -> Eigen::MatrixXd {
        return s.getFrictionVector(x.q + h * Eigen::VectorXd::Unit(n, j), x.qd);
      };
      const double q_size = sizeOf(friction(0.0)) + sizeOf(q_with);
      EXPECT_TRUE(
          near(by_load.col(j), derivative(elsewhere, kSteepStep), kSteepDifference, q_size));
      if (!frictionDependsOnPosition(s)) {
        EXPECT_TRUE(near(by_load.col(j), 0 * q_with.col(j), kRounding, sizeOf(q_with)));
      }
    }
  }
}

TEST_P(SolverConformance, FrictionRemembersWithinItsBand) {
  const InverseDynamicsSolver& s = *solver_;
  INVERSE_DYNAMICS_SOLVER_REQUIRE(FrictionMemory, memory);
  chain_dynamics::FrictionState state = memory->frictionState();
  const Eigen::Index n = s.jointCount();
  Eigen::VectorXd most = Eigen::VectorXd::Zero(n), f(n);
  state.addUnknown(most);
  EXPECT_EQ(state.remembers(), !most.isZero(0));
  for (const State& x : randomStates(kStates)) {
    f.setZero();
    state.move(x.q);
    state.addTo(x.qd, f);
    EXPECT_TRUE((f.array().abs() <= 2 * most.array()).all()) << f.transpose();
  }
  EXPECT_FALSE(frictionState(*makeInitialized({{"friction", false}})).remembers());
  const auto fresh = make();
  const auto& uninitialized = dynamic_cast<const FrictionMemory&>(*fresh);
  errorOf<UninitializedException>([&] { uninitialized.frictionState(); });
}

TEST_P(SolverConformance, TorqueDeviationIsOneOfEachJointOrUnknown) {
  const InverseDynamicsSolver& s = *solver_;
  INVERSE_DYNAMICS_SOLVER_REQUIRE(TorqueDeviation, band);
  const Eigen::Index n = s.jointCount();
  Eigen::VectorXd deviation(n), wrong(n + 1);
  EXPECT_TRUE(band->seenRanges().empty() ||
              static_cast<Eigen::Index>(band->seenRanges().size()) == n);
  if (band->hasTorqueDeviation()) {
    band->getTorqueDeviation(deviation);
    EXPECT_TRUE(identical(band->getTorqueDeviation(), deviation));
    EXPECT_TRUE((deviation.array() >= 0.0 && deviation.array().isFinite()).all());
    errorOf<SizeMismatchException>([&] { band->getTorqueDeviation(wrong); });
  } else {
    const std::string error = errorOf<Exception>([&] { band->getTorqueDeviation(); });
    EXPECT_TRUE(contains(error, {"getTorqueDeviation", "torque_deviation"}));
  }
  const auto fresh = make();
  const auto& uninitialized = dynamic_cast<const TorqueDeviation&>(*fresh);
  errorOf<UninitializedException>([&] { uninitialized.hasTorqueDeviation(); });
  errorOf<UninitializedException>([&] { uninitialized.getTorqueDeviation(); });
  errorOf<UninitializedException>([&] { uninitialized.seenRanges(); });
}

/// `[m, mcx, ..., Izz]` of links, one after the other.
inline Eigen::VectorXd parametersOf(const std::vector<chain_dynamics::LinkParameters>& links) {
  Eigen::VectorXd p(10 * static_cast<Eigen::Index>(links.size()));
  Eigen::Index first = 0;
  for (const chain_dynamics::LinkParameters& link : links) {
    p.segment<10>(first) = link.toVector();
    first += 10;
  }
  return p;
}

/// Those of the chain, or of all branches.
inline Eigen::VectorXd parametersOf(const chain_dynamics::Model& model) {
  if (model.branches.empty()) return parametersOf(model.chain.links());
  Eigen::VectorXd p = Eigen::VectorXd::Zero(10 * linkCount(model.branches));
  for (const chain_dynamics::Branch& branch : model.branches) {
    for (std::size_t i = 0; i < branch.link.size(); ++i) {
      p.segment<10>(10 * branch.link[i]) += branch.chain.links()[i].toVector();
    }
  }
  return p;
}

/// The torques of a model from a regressor: `(Y - Y_g) p + Y_g p_g + rotor_inertia qdd`, and those of springs,
/// where p is that of the row, and p_g that of gravity, for models in which these differ.
inline Eigen::VectorXd torquesOf(const chain_dynamics::Model& model, const Regressor& bodies,
                                 const State& x) {
  const Eigen::VectorXd zero = Eigen::VectorXd::Zero(x.q.size());
  const Eigen::MatrixXd Y = bodies.getRegressor(x.q, x.qd, x.qdd);
  const Eigen::MatrixXd Y_g = bodies.getRegressor(x.q, zero, zero);
  Eigen::VectorXd tau(x.q.size());
  for (Eigen::Index i = 0; i < tau.size(); ++i) {
    const auto row = static_cast<std::size_t>(i);
    const Eigen::VectorXd p = model.row_parameters.empty()
                                  ? parametersOf(model)
                                  : parametersOf(model.row_parameters[row]);
    tau[i] = Y.row(i).dot(p) + model.chain.joints()[row].rotor_inertia * x.qdd[i];
    if (model.stiffness.size() > 0) tau[i] += model.stiffness[i] * (x.q[i] - model.rest[i]);
    if (model.levers.size() > 0) {
      tau[i] += model.levers(0, i) * std::sin(x.q[i]) + model.levers(1, i) * std::cos(x.q[i]);
    }
    if (model.gravity_parameters.empty()) continue;
    tau[i] += Y_g.row(i).dot(parametersOf(model.gravity_parameters) - p);
  }
  return tau;
}

TEST_P(SolverConformance, RegressorTimesParametersAreTheTorques) {
  const auto own = makeInitialized({{"friction", false}});
  const InverseDynamicsSolver& s = *own;
  INVERSE_DYNAMICS_SOLVER_REQUIRE(Regressor, bodies);
  std::optional<chain_dynamics::Model> model = GetParam().model();
  if (!model) {
    ASSERT_FALSE(GetParam().robotDescription().empty()) << "the traits must state the model()";
    const Configuration configuration =
        readConfiguration(GetParam().parameters(), "", GetParam().robotDescription());
    model.emplace(mechanismFromDescription(configuration));
    setSprings(configuration, *model);
  }
  for (const State& x : randomStates(kStates)) {
    SCOPED_TRACE(toString(x));
    const Eigen::VectorXd tau = s.getTorques(x.q, x.qd, x.qdd);
    EXPECT_TRUE(near(torquesOf(*model, *bodies, x), tau, kRounding, sizeOf(tau)));
  }
}

TEST_P(SolverConformance, AccelerationsInvertTorques) {
  const InverseDynamicsSolver& s = *solver_;
  INVERSE_DYNAMICS_SOLVER_REQUIRE(ForwardDynamics, forward);
  if (!s.inertiaIsPhysical()) {
    const State x = randomState();
    for (const auto& call : std::vector<std::function<void()>>{
             [&] { forward->getAccelerations(x.q, x.qd, x.qdd); },
             [&] { forward->getAccelerationsBatch(x.q, x.qd, x.qdd); }}) {
      EXPECT_TRUE(contains(errorOf<Exception>(call), {"Accelerations", "inertiaIsPhysical()"}));
    }
    return;
  }
  for (const State& x : randomStates(kStates)) {
    SCOPED_TRACE(toString(x));
    const Eigen::VectorXd tau = s.getTorques(x.q, x.qd, x.qdd);
    const Eigen::VectorXd qdd = forward->getAccelerations(x.q, x.qd, tau);
    const Eigen::VectorXd residual = s.getInertiaMatrix(x.q) * (qdd - x.qdd);
    EXPECT_TRUE(near(residual, 0 * tau, kSolved, sizeOf(tau)));
  }
}

#undef INVERSE_DYNAMICS_SOLVER_REQUIRE

}  // namespace inverse_dynamics_solver::conformance
