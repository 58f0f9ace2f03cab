// SPDX-License-Identifier: Apache-2.0
/// @file
/// Conformance, part one: parameters, robot description, failed and repeated initialization.
/// Include conformance_tests.hpp, not this.
#pragma once

#include <algorithm>

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

/// Arguments with which initialize() must throw: what differs from the traits' parameters, and the
/// robot description.
template <class Traits>
std::vector<std::pair<ParameterMap, std::string>> mistakes() {
  const std::string description = Traits::robotDescription();
  auto result = Traits::badInitializations();
  result.push_back({{{"gravity", std::vector<double>{1.0, 2.0}}}, description});
  result.push_back({{{"gravity", std::string("down")}}, description});
  result.push_back({{{"friction", std::string("maybe")}}, description});
  if (!description.empty()) {
    result.push_back({{}, ""});
    result.push_back({{}, "<robot name='broken'"});
    result.push_back({{{"tip", std::string("no_such_link")}}, description});
    result.push_back({{{"root", std::string("no_such_link")}}, description});
  }
  return result;
}

TYPED_TEST_P(SolverConformance, FailedInitializeLeavesTheSolverAsItWas) {
  const std::vector<State> states = this->randomStates(kStates);
  const std::vector<Eigen::VectorXd> before = fingerprint(*this->solver_, states);
  const std::vector<std::string> names = this->solver_->jointNames();

  // Each mistake with other parameters that would change the numbers.
  for (const auto& [changed, text] : mistakes<TypeParam>()) {
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

TYPED_TEST_P(SolverConformance, UnknownParameterIsAWarningOrARefusal) {
  const std::string description = TypeParam::robotDescription();
  const std::vector<State> states = this->randomStates(kStates);
  const std::vector<Eigen::VectorXd> before = fingerprint(*this->solver_, states);
  ParameterMap parameters = TypeParam::parameters();
  parameters["gravty"] = std::vector<double>{1.0, -2.0, 3.0};
  const auto warned = this->make(), fresh = this->make();
  warned->initialize(parameters, "", description);
  const std::vector<std::string>& warnings = warned->warnings();
  EXPECT_EQ(std::count_if(warnings.begin(), warnings.end(),
                          [](const std::string& w) {
                            return bool(contains(w, {"'gravty'", "'gravity'"}));
                          }),
            1);

  // Refused, with other parameters that would change the numbers: nothing has changed.
  parameters["gravity"] = std::vector<double>{1.0, -2.0, 3.0};
  for (InverseDynamicsSolver* solver : {this->solver_.get(), fresh.get()}) {
    const std::string error = errorOf<InvalidParameterValueException>(
        [&] { solver->initialize(Parameters(parameters).strict(), "", description); });
    EXPECT_TRUE(contains(error, {"'gravty'", "did you mean 'gravity'?"}));
  }
  EXPECT_FALSE(fresh->isInitialized());
  ASSERT_TRUE(this->solver_->isInitialized());
  const std::vector<Eigen::VectorXd> after = fingerprint(*this->solver_, states);
  for (std::size_t i = 0; i < before.size(); ++i) EXPECT_TRUE(identical(before[i], after[i]));

  // What the solver knows it takes.
  parameters.erase("gravty");
  EXPECT_NO_THROW(fresh->initialize(Parameters(parameters).strict(), "", description));
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
