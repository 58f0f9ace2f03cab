// SPDX-License-Identifier: Apache-2.0
//
// The headers of the reference implementation's first release, 0.1.1, by the names that they had there.

#include <franka_inria_inverse_dynamics_solver/franka_inria_inverse_dynamics_solver.h>
#include <gtest/gtest.h>
#include <inverse_dynamics_solver/exceptions.h>
#include <inverse_dynamics_solver/inverse_dynamics_solver.h>
#include <kdl_inverse_dynamics_solver/kdl_inverse_dynamics_solver.h>
#include <ur10_inverse_dynamics_solver/ur10_inverse_dynamics_solver.h>

#include <type_traits>

namespace inverse_dynamics_documentation_tests::migration_headers_test {

using inverse_dynamics_solver::InverseDynamicsSolver;

template <class Solver>
constexpr bool isASolver() {
  return std::is_base_of_v<InverseDynamicsSolver, Solver> &&
         std::is_default_constructible_v<Solver>;
}

TEST(HeadersOfTheFirstRelease, DeclareTheClassesThatTheyDid) {
  EXPECT_TRUE(isASolver<franka_inria_inverse_dynamics_solver::InverseDynamicsSolverFrankaInria>());
  EXPECT_TRUE(isASolver<kdl_inverse_dynamics_solver::InverseDynamicsSolverKDL>());
  EXPECT_TRUE(isASolver<ur10_inverse_dynamics_solver::InverseDynamicsSolverUR10>());
}

TEST(HeadersOfTheFirstRelease, DeclareTheExceptionsThatTheyDid) {
  using namespace inverse_dynamics_solver;
  EXPECT_TRUE((std::is_base_of_v<std::runtime_error, InvalidParameterValueException>));
  EXPECT_TRUE((std::is_base_of_v<std::runtime_error, ParameterUninitializedException>));
  EXPECT_TRUE((std::is_base_of_v<std::runtime_error, UninitializedException>));
}

}  // namespace inverse_dynamics_documentation_tests::migration_headers_test
