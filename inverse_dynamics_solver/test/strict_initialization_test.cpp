// SPDX-License-Identifier: Apache-2.0
#include "inverse_dynamics_solver/strict_initialization.hpp"

#include <gtest/gtest.h>

#include "inverse_dynamics_solver/exceptions.hpp"
#include "inverse_dynamics_solver/solver_loader.hpp"
#include "node_parameters_stand_in.hpp"

namespace inverse_dynamics_solver {
namespace {

class StrictInitialization : public ::testing::Test {
 protected:
  void initialize() { initializeStrictly(*solver, node, "ids", ""); }

  const std::shared_ptr<stand_in::NodeParameters> node =
      std::make_shared<stand_in::NodeParameters>();
  const std::shared_ptr<InverseDynamicsSolver> solver =
      SolverLoader().load("pendulum_inverse_dynamics_solver/InverseDynamicsSolverPendulum");
};

TEST_F(StrictInitialization, TakesWhatTheSolverKnows) {
  node->values = {{"ids.mass", 2.0}, {"ids.length", 0.5}, {"mas", 3.0}, {"idsmas", 3.0}};
  initialize();
  const Eigen::VectorXd horizontal = Eigen::VectorXd::Constant(1, 1.5707963267948966);
  EXPECT_NEAR(solver->getGravityVector(horizontal)[0], 2.0 * 9.81 * 0.5, 1e-12);
}

TEST_F(StrictInitialization, RefusesWhatTheSolverDoesNotKnow) {
  node->values = {{"ids.mass", 2.0}, {"ids.length", 0.5}, {"ids.lenght", 0.7}};
  try {
    initialize();
    FAIL() << "no exception";
  } catch (const InvalidParameterValueException& error) {
    EXPECT_STREQ(error.what(),
                 "parameter 'ids.lenght': the solver doesn't know it: expected one of "
                 "ids.allow_massless, ids.attached, ids.batch_threads, ids.damping, ids.friction, "
                 "ids.gravity, ids.length, ids.mass, ids.root, ids.tip, got another name; correct "
                 "or remove it");
  }
}

TEST_F(StrictInitialization, LeavesToTheSolverWhatItRefusesItself) {
  node->values = {{"ids.mass", -2.0}, {"ids.length", 0.5}, {"ids.lenght", 0.7}};
  EXPECT_THROW(initialize(), InvalidParameterValueException);
  EXPECT_FALSE(solver->isInitialized());
}

}  // namespace
}  // namespace inverse_dynamics_solver
