// SPDX-License-Identifier: Apache-2.0
/// @file
/// Conformance, part one: parameters, robot description, failed and repeated initialization.
/// Include conformance_tests.hpp, not this.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

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
inline std::vector<std::pair<ParameterMap, std::string>> mistakes(const TestedSolver& tested) {
  const std::string description = tested.robotDescription();
  auto result = tested.badInitializations();
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

TEST_P(SolverConformance, FailedInitializeLeavesTheSolverAsItWas) {
  const std::vector<State> states = randomStates(kStates);
  const std::vector<Eigen::VectorXd> before = fingerprint(*solver_, states);
  const std::vector<std::string> names = solver_->jointNames();

  // Each mistake with other parameters that would change the numbers.
  for (const auto& [changed, text] : mistakes(GetParam())) {
    ParameterMap parameters = GetParam().parameters();
    parameters["gravity"] = std::vector<double>{1.0, -2.0, 3.0};
    for (const auto& [name, value] : changed) parameters[name] = value;
    EXPECT_THROW(solver_->initialize(parameters, "", text), Exception);

    EXPECT_TRUE(solver_->isInitialized());
    EXPECT_EQ(solver_->jointNames(), names);
    const std::vector<Eigen::VectorXd> after = fingerprint(*solver_, states);
    for (std::size_t i = 0; i < before.size(); ++i) EXPECT_TRUE(identical(before[i], after[i]));

    // And a solver that never was initialized isn't after that.
    const auto fresh = make();
    EXPECT_THROW(fresh->initialize(parameters, "", text), Exception);
    EXPECT_FALSE(fresh->isInitialized());
  }
}

TEST_P(SolverConformance, UnknownParameterIsAWarningOrARefusal) {
  const std::string description = GetParam().robotDescription();
  const std::vector<State> states = randomStates(kStates);
  const std::vector<Eigen::VectorXd> before = fingerprint(*solver_, states);
  ParameterMap parameters = GetParam().parameters();
  parameters["gravty"] = std::vector<double>{1.0, -2.0, 3.0};
  const auto warned = make(), fresh = make();
  warned->initialize(parameters, "", description);
  const std::vector<std::string>& warnings = warned->warnings();
  EXPECT_EQ(std::count_if(warnings.begin(), warnings.end(),
                          [](const std::string& w) {
                            return bool(contains(w, {"'gravty'", "'gravity'"}));
                          }),
            1);

  // Refused, with other parameters that would change the numbers: nothing has changed.
  parameters["gravity"] = std::vector<double>{1.0, -2.0, 3.0};
  for (InverseDynamicsSolver* solver : {solver_.get(), fresh.get()}) {
    const std::string error = errorOf<InvalidParameterValueException>(
        [&] { solver->initialize(Parameters(parameters).strict(), "", description); });
    EXPECT_TRUE(contains(error, {"'gravty'", "did you mean 'gravity'?"}));
  }
  EXPECT_FALSE(fresh->isInitialized());
  ASSERT_TRUE(solver_->isInitialized());
  const std::vector<Eigen::VectorXd> after = fingerprint(*solver_, states);
  for (std::size_t i = 0; i < before.size(); ++i) EXPECT_TRUE(identical(before[i], after[i]));

  // What the solver knows it takes.
  parameters.erase("gravty");
  EXPECT_NO_THROW(fresh->initialize(Parameters(parameters).strict(), "", description));
}

TEST_P(SolverConformance, InitializingAgainTakesEffect) {
  const std::vector<State> states = randomStates(kStates);
  const std::vector<Eigen::VectorXd> before = fingerprint(*solver_, states);
  initialize(*solver_, {{"gravity", std::vector<double>{3.0, -2.0, 1.0}}});
  const std::vector<Eigen::VectorXd> other = fingerprint(*solver_, states);
  const auto fresh = makeInitialized({{"gravity", std::vector<double>{3.0, -2.0, 1.0}}});
  const std::vector<Eigen::VectorXd> expected = fingerprint(*fresh, states);
  bool changed = false;
  for (std::size_t i = 0; i < before.size(); ++i) {
    EXPECT_TRUE(identical(other[i], expected[i]));
    changed = changed || !identical(other[i], before[i]);
  }
  EXPECT_TRUE(changed) << "the new gravity has no effect";

  // Back to the first parameters, back to the first numbers.
  initialize(*solver_);
  const std::vector<Eigen::VectorXd> after = fingerprint(*solver_, states);
  for (std::size_t i = 0; i < before.size(); ++i) EXPECT_TRUE(identical(before[i], after[i]));
}

TEST_P(SolverConformance, ParametersAreReadBelowTheNamespace) {
  const ParameterMap changed = {{"gravity", std::vector<double>{3.0, -2.0, 1.0}}};
  ParameterMap parameters, elsewhere;
  for (const auto& [name, value] : GetParam().parameters()) parameters["arm.ids." + name] = value;
  elsewhere = parameters;
  for (const auto& [name, value] : changed) parameters["arm.ids." + name] = value;
  for (const auto& [name, value] : changed) elsewhere[name] = value;  // not below: no effect

  const auto solver = make(), untouched = make();
  solver->initialize(parameters, "arm.ids", GetParam().robotDescription());
  untouched->initialize(elsewhere, "arm.ids", GetParam().robotDescription());
  const State x = randomState();
  EXPECT_TRUE(
      identical(solver->getGravityVector(x.q), makeInitialized(changed)->getGravityVector(x.q)));
  EXPECT_TRUE(identical(untouched->getGravityVector(x.q), solver_->getGravityVector(x.q)));
}

TEST_P(SolverConformance, RobotDescriptionComesFromArgumentOrParameter) {
  const std::string description = GetParam().robotDescription();
  if (description.empty()) GTEST_SKIP() << "this solver needs no robot description";

  // Absent: the error says where it may come from.
  const auto solver = make();
  const std::string error = errorOf<ParameterUninitializedException>(
      [&] { solver->initialize(GetParam().parameters(), "", ""); });
  EXPECT_TRUE(contains(error, {"robot description", "'robot_description'", "third argument"}));

  // From the parameter, which has no namespace; the argument takes precedence.
  ParameterMap parameters;
  for (const auto& [name, value] : GetParam().parameters()) parameters["ids." + name] = value;
  parameters["robot_description"] = description;
  solver->initialize(parameters, "ids");
  const State x = randomState();
  const Eigen::VectorXd expected = solver_->getTorques(x.q, x.qd, x.qdd);
  EXPECT_TRUE(identical(solver->getTorques(x.q, x.qd, x.qdd), expected));
  parameters["robot_description"] = std::string("<robot name='broken'");
  solver->initialize(parameters, "ids", description);
  EXPECT_TRUE(identical(solver->getTorques(x.q, x.qd, x.qdd), expected));

  // A description that is none.
  errorOf<InvalidRobotDescriptionException>([&] { solver->initialize(parameters, "ids"); });
}

}  // namespace inverse_dynamics_solver::conformance
