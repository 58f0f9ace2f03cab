// SPDX-License-Identifier: Apache-2.0
#include "inverse_dynamics_solver/strict_initialization.hpp"

#include <gtest/gtest.h>

#include "inverse_dynamics_solver/exceptions.hpp"
#include "inverse_dynamics_solver/solver_loader.hpp"
#include "node_parameters_stand_in.hpp"

namespace inverse_dynamics_solver::strict_initialization_test {

class StrictInitialization : public ::testing::Test {
 protected:
  /// The text of the refusal.
  std::string refusal(const std::string& param_namespace) {
    try {
      initializeStrictly(*solver, node, param_namespace, "");
    } catch (const InvalidParameterValueException& error) {
      return error.what();
    }
    ADD_FAILURE() << "no exception";
    return "";
  }
  double massTimesLength() const {
    const Eigen::VectorXd horizontal = Eigen::VectorXd::Constant(1, 1.5707963267948966);
    return solver->getGravityVector(horizontal)[0] / 9.81;
  }

  const std::shared_ptr<stand_in::NodeParameters> node =
      std::make_shared<stand_in::NodeParameters>();
  const std::shared_ptr<InverseDynamicsSolver> solver =
      SolverLoader().load("pendulum_inverse_dynamics_solver/InverseDynamicsSolverPendulum");
};

TEST_F(StrictInitialization, TakesWhatTheSolverKnows) {
  node->values = {{"ids.mass", 2.0}, {"ids.length", 0.5}, {"mas", 3.0}, {"idsmas", 3.0}};
  initializeStrictly(*solver, node, "ids", "");
  EXPECT_NEAR(massTimesLength(), 1.0, 1e-12);
}

TEST_F(StrictInitialization, RefusesWhatTheSolverDoesNotKnow) {
  node->values = {{"ids.mass", 2.0}, {"ids.length", 0.5}, {"ids.lenght", 0.7}};
  EXPECT_EQ(refusal("ids"),
            "parameter 'ids.lenght': the solver doesn't know it: expected one of "
            "ids.allow_massless, ids.attached, ids.batch_threads, ids.damping, ids.friction, "
            "ids.gravity, ids.length, ids.mass, ids.root, ids.tip, ids.urdf_friction; did you mean "
            "'ids.length'?");
  EXPECT_FALSE(solver->isInitialized());
}

TEST_F(StrictInitialization, RefusesWhatIsSetFromOutsideAndNotDeclared) {
  node->values = {{"ids.mass", 2.0}, {"ids.length", 0.5}};
  node->overrides = {{"ids.dampng", {0.7}}};
  EXPECT_NE(refusal("ids").find("did you mean 'ids.damping'?"), std::string::npos);
}

TEST_F(StrictInitialization, LeavesTheSolverAsItWas) {
  solver->initialize({{"mass", 2.0}, {"length", 0.5}});
  node->values = {{"ids.mass", 6.0}, {"ids.length", 0.5}, {"ids.lenght", 0.7}};
  refusal("ids");
  ASSERT_TRUE(solver->isInitialized());
  EXPECT_NEAR(massTimesLength(), 1.0, 1e-12);
}

/// A node has parameters of its own there.
TEST_F(StrictInitialization, RefusesWithoutANamespaceWhatIsNearToWhatTheSolverKnows) {
  node->values = {{"mass", 2.0}, {"length", 0.5}, {"use_sim_time", true}, {"rate", 100.0}};
  initializeStrictly(*solver, node, "", "");
  node->values["dampng"] = 0.7;
  EXPECT_NE(refusal("").find("parameter 'dampng': the solver doesn't know it"), std::string::npos);
}

TEST_F(StrictInitialization, LeavesToTheSolverWhatItRefusesItself) {
  node->values = {{"ids.mass", -2.0}, {"ids.length", 0.5}, {"ids.lenght", 0.7}};
  EXPECT_NE(refusal("ids").find("ids.mass, ids.length: wrong value"), std::string::npos);
  EXPECT_FALSE(solver->isInitialized());
}

TEST_F(StrictInitialization, OtherwiseAnUnknownParameterIsAWarning) {
  solver->initialize({{"mass", 2.0}, {"length", 0.5}, {"dampng", 0.7}, {"x", 1}});
  EXPECT_EQ(solver->warnings(),
            (std::vector<std::string>{
                "parameter 'dampng' isn't used, the solver doesn't know it; did you mean "
                "'damping'?",
                "parameter 'x' isn't used, the solver doesn't know it; correct or remove it"}));
}

}  // namespace inverse_dynamics_solver::strict_initialization_test
