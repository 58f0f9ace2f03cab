// SPDX-License-Identifier: Apache-2.0
/// @file
/// Conformance, part one: parameters, robot description, failed and repeated initialization.
/// Include conformance_tests.hpp, not this.
#pragma once

#include "inverse_dynamics_solver/conformance/solver_fixture.hpp"

namespace inverse_dynamics_solver::conformance {

/// All numbers of a solver at some states.
inline std::vector<Eigen::VectorXd> fingerprint(const InverseDynamicsSolver& solver,
                                                const std::vector<State>& states) {
  std::vector<Eigen::VectorXd> values;
  for (const State& x : states) {
    for (const Quantity& quantity : quantities()) values.push_back(quantity.value(solver, x));
  }
  return values;
}

TYPED_TEST_P(SolverConformance, FailedInitializeLeavesTheSolverAsItWas) {
  const std::vector<State> states = this->randomStates(kStates);
  const std::vector<Eigen::VectorXd> before = fingerprint(*this->solver_, states);
  const std::vector<std::string> names = this->solver_->jointNames();

  // The mistakes, each with other parameters that would change the numbers.
  const std::string description = TypeParam::robotDescription();
  auto mistakes = TypeParam::badInitializations();
  mistakes.push_back({{{"gravity", std::vector<double>{1.0, 2.0}}}, description});
  mistakes.push_back({{{"gravity", std::string("down")}}, description});
  mistakes.push_back({{{"friction", std::string("maybe")}}, description});
  if (!description.empty()) {
    mistakes.push_back({{}, "<robot name='broken'"});
    mistakes.push_back({{{"tip", std::string("no_such_link")}}, description});
    mistakes.push_back({{{"root", std::string("no_such_link")}}, description});
  }
  for (const auto& [changed, text] : mistakes) {
    ParameterMap parameters = TypeParam::parameters();
    parameters["gravity"] = std::vector<double>{1.0, -2.0, 3.0};
    for (const auto& [name, value] : changed) parameters[name] = value;
    EXPECT_THROW(this->solver_->initialize(parameters, "", text), Exception);

    EXPECT_TRUE(this->solver_->isInitialized());
    EXPECT_EQ(this->solver_->jointNames(), names);
    const std::vector<Eigen::VectorXd> after = fingerprint(*this->solver_, states);
    for (std::size_t i = 0; i < before.size(); ++i) EXPECT_TRUE(identical(before[i], after[i]));

    // And a solver that never was initialized isn't after that.
    const auto fresh = this->make();
    EXPECT_THROW(fresh->initialize(parameters, "", text), Exception);
    EXPECT_FALSE(fresh->isInitialized());
  }
}

TYPED_TEST_P(SolverConformance, InitializingAgainTakesEffect) {
  const std::vector<State> states = this->randomStates(kStates);
  const std::vector<Eigen::VectorXd> before = fingerprint(*this->solver_, states);
  this->initialize(*this->solver_, {{"gravity", std::vector<double>{3.0, -2.0, 1.0}}});
  const std::vector<Eigen::VectorXd> other = fingerprint(*this->solver_, states);
  const auto fresh = this->makeInitialized({{"gravity", std::vector<double>{3.0, -2.0, 1.0}}});
  const std::vector<Eigen::VectorXd> expected = fingerprint(*fresh, states);
  bool changed = false;
  for (std::size_t i = 0; i < before.size(); ++i) {
    EXPECT_TRUE(identical(other[i], expected[i]));
    changed = changed || !identical(other[i], before[i]);
  }
  EXPECT_TRUE(changed) << "the new gravity has no effect";

  // Back to the first parameters, back to the first numbers.
  this->initialize(*this->solver_);
  const std::vector<Eigen::VectorXd> after = fingerprint(*this->solver_, states);
  for (std::size_t i = 0; i < before.size(); ++i) EXPECT_TRUE(identical(before[i], after[i]));
}

TYPED_TEST_P(SolverConformance, ParametersAreReadBelowTheNamespace) {
  const ParameterMap changed = {{"gravity", std::vector<double>{3.0, -2.0, 1.0}}};
  ParameterMap parameters, elsewhere;
  for (const auto& [name, value] : TypeParam::parameters()) parameters["arm.ids." + name] = value;
  elsewhere = parameters;
  for (const auto& [name, value] : changed) parameters["arm.ids." + name] = value;
  for (const auto& [name, value] : changed) elsewhere[name] = value;  // not below: no effect

  const auto solver = this->make(), untouched = this->make();
  solver->initialize(parameters, "arm.ids", TypeParam::robotDescription());
  untouched->initialize(elsewhere, "arm.ids", TypeParam::robotDescription());
  const State x = this->randomState();
  EXPECT_TRUE(identical(solver->getGravityVector(x.q),
                        this->makeInitialized(changed)->getGravityVector(x.q)));
  EXPECT_TRUE(identical(untouched->getGravityVector(x.q), this->solver_->getGravityVector(x.q)));
}

TYPED_TEST_P(SolverConformance, RobotDescriptionComesFromArgumentOrParameter) {
  const std::string description = TypeParam::robotDescription();
  if (description.empty()) GTEST_SKIP() << "this solver needs no robot description";

  // Absent: the error says where it may come from.
  const auto solver = this->make();
  const std::string error = errorOf<ParameterUninitializedException>(
      [&] { solver->initialize(TypeParam::parameters(), "", ""); });
  EXPECT_TRUE(contains(error, {"robot description", "'robot_description'", "third argument"}));

  // From the parameter, which has no namespace; the argument goes before it.
  ParameterMap parameters;
  for (const auto& [name, value] : TypeParam::parameters()) parameters["ids." + name] = value;
  parameters["robot_description"] = description;
  solver->initialize(parameters, "ids");
  const State x = this->randomState();
  const Eigen::VectorXd expected = this->solver_->getTorques(x.q, x.qd, x.qdd);
  EXPECT_TRUE(identical(solver->getTorques(x.q, x.qd, x.qdd), expected));
  parameters["robot_description"] = std::string("<robot name='broken'");
  solver->initialize(parameters, "ids", description);
  EXPECT_TRUE(identical(solver->getTorques(x.q, x.qd, x.qdd), expected));

  // A description that is none.
  errorOf<InvalidRobotDescriptionException>([&] { solver->initialize(parameters, "ids"); });
}

}  // namespace inverse_dynamics_solver::conformance
