// SPDX-License-Identifier: Apache-2.0
#include "inverse_dynamics_solver/solver_loader.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cstdlib>
#include <memory>
#include <pluginlib/class_loader.hpp>
#include <string>
#include <thread>
#include <utility>
#include <vector>

namespace inverse_dynamics_solver::solver_loader_test {

const char* const kPendulum = "pendulum_inverse_dynamics_solver/InverseDynamicsSolverPendulum";
const Parameters kPendulumParameters = {{"mass", 2.0}, {"length", 0.5}};

/// Gravity torque of the pendulum held horizontally: m g l.
const Eigen::VectorXd kHorizontal = Eigen::VectorXd::Constant(1, 1.5707963267948966);
constexpr double kTorque = 2.0 * 9.81 * 0.5;

std::string errorOf(const SolverLoader& loader, const std::string& name) {
  try {
    loader.load(name);
  } catch (const PluginNotFoundException& e) {
    return e.what();
  }
  ADD_FAILURE() << "no exception";
  return "";
}

bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

/// An environment variable, put back at the end of the scope.
class Environment {
 public:
  Environment(const char* name, const char* value) : name_(name) {
    const char* const before = std::getenv(name);
    was_set_ = before != nullptr;
    if (was_set_) before_ = before;
    value == nullptr ? unsetenv(name) : setenv(name, value, 1);
  }
  ~Environment() { was_set_ ? setenv(name_, before_.c_str(), 1) : unsetenv(name_); }

 private:
  const char* name_;
  bool was_set_;
  std::string before_;
};

TEST(SolverLoader, ListsWhatIsInstalled) {
  const std::vector<std::string> names = SolverLoader().availableSolvers();
  EXPECT_EQ(std::count(names.begin(), names.end(), kPendulum), 1);
  EXPECT_EQ(std::count(names.begin(), names.end(), "two_link_solver/TwoLinkSolver"), 1);
  EXPECT_TRUE(std::is_sorted(names.begin(), names.end()));
}

TEST(SolverLoader, TellsWhatASolverIs) {
  EXPECT_EQ(SolverLoader().description(kPendulum),
            "A point mass on a rod: the example of how to add a solver.");
  EXPECT_THROW(SolverLoader().description("none"), PluginNotFoundException);
}

TEST(SolverLoader, SolverOutlivesItsLoader) {
  auto loader = std::make_unique<SolverLoader>();
  auto first = loader->load(kPendulum), second = loader->load(kPendulum);
  std::weak_ptr<InverseDynamicsSolver> observer = first;
  loader.reset();
  first->initialize(kPendulumParameters);
  first.reset();
  EXPECT_TRUE(observer.expired());
  second->initialize(kPendulumParameters);
  EXPECT_DOUBLE_EQ(second->getGravityVector(kHorizontal)[0], kTorque);
  second.reset();

  // And another loader makes another solver.
  const auto third = SolverLoader().load(kPendulum);
  third->initialize(kPendulumParameters);
  EXPECT_DOUBLE_EQ(third->getGravityVector(kHorizontal)[0], kTorque);
}

/// In a process of its own, so that nothing of another test is there before: the exit status is the
/// test.
TEST(SolverLoaderDeathTest, LoaderAndSolverMayLiveUntilTheEndOfTheProgram) {
  ::testing::FLAGS_gtest_death_test_style = "threadsafe";
  EXPECT_EXIT(
      {
        static std::shared_ptr<InverseDynamicsSolver> before;
        static const SolverLoader loader;
        before = loader.load(kPendulum);
        static const std::shared_ptr<InverseDynamicsSolver> after = loader.load(kPendulum);
        std::exit(before != nullptr && after != nullptr ? 0 : 1);
      },
      ::testing::ExitedWithCode(0), "");
}

TEST(SolverLoader, MayBeMovedAndUsedFromManyThreads) {
  SolverLoader first;
  const SolverLoader loader = std::move(first);
  std::vector<std::thread> threads;
  std::atomic<int> loaded{0};
  for (int i = 0; i < 4; ++i) {
    threads.emplace_back([&] {
      for (int k = 0; k < 20; ++k) loaded += loader.load(kPendulum) != nullptr ? 1 : 0;
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(loaded, 80);
}

TEST(SolverLoader, UnknownNameListsWhatThereIsAndSuggestsTheNearest) {
  const SolverLoader loader;
  const std::string error =
      errorOf(loader, "pendulum_inverse_dynamics_solver/InverseDynamicSolverPendulum");
  EXPECT_EQ(
      error.rfind("solver plugin 'pendulum_inverse_dynamics_solver/InverseDynamicSolverPendulum': "
                  "not found: expected one of ",
                  0),
      0U)
      << error;
  EXPECT_TRUE(contains(error, "two_link_solver/TwoLinkSolver")) << error;
  EXPECT_TRUE(contains(error, std::string("did you mean ") + kPendulum + "?")) << error;

  // The class alone, and something that is near to nothing.
  EXPECT_TRUE(
      contains(errorOf(loader, "TwoLinkSolver"), "did you mean two_link_solver/TwoLinkSolver?"));
  EXPECT_FALSE(contains(errorOf(loader, "xyz"), "did you mean"));
  EXPECT_TRUE(contains(errorOf(loader, ""),
                       "; install its package, or source the workspace that has it: source "
                       "install/local_setup.bash"));
}

TEST(SolverLoader, PluginOfAnotherInterfaceIsNotFoundInsteadOfCrashing) {
  const std::string error = errorOf(SolverLoader(), "foreign_solver/OtherInterface");
  EXPECT_EQ(error,
            "solver plugin 'foreign_solver/OtherInterface': its library has no such solver: "
            "expected class foreign_solver::OtherInterface made with this version of the "
            "interface, got none, or one made with another version; rebuild package "
            "foreign_solver against this workspace");
  EXPECT_TRUE(contains(errorOf(SolverLoader(), "foreign_solver/NotThere"),
                       "its library has no such solver"));
}

TEST(SolverLoader, MissingLibraryIsReported) {
  const std::string error = errorOf(SolverLoader(), "foreign_solver/NoLibrary");
  EXPECT_TRUE(contains(error, "its library can't be opened")) << error;
  EXPECT_TRUE(contains(error, "no_such_library")) << error;
}

TEST(SolverLoader, WithoutASourcedWorkspaceTheErrorSaysSo) {
  for (const char* const prefixes : {static_cast<const char*>(nullptr), "", "/nonexistent"}) {
    const Environment environment("AMENT_PREFIX_PATH", prefixes);
    const SolverLoader loader;
    EXPECT_TRUE(loader.availableSolvers().empty());
    const std::string error = errorOf(loader, kPendulum);
    EXPECT_TRUE(contains(error, "no installed plugin at all")) << error;
    EXPECT_TRUE(contains(error, "source install/local_setup.bash")) << error;
  }
}

TEST(Pluginlib, LoadsSolversByTheNamesThatUsersKnow) {
  pluginlib::ClassLoader<inverse_dynamics_solver::InverseDynamicsSolver> loader(
      "inverse_dynamics_solver", "inverse_dynamics_solver::InverseDynamicsSolver");
  {
    pluginlib::UniquePtr<inverse_dynamics_solver::InverseDynamicsSolver> solver =
        loader.createUniqueInstance(kPendulum);
    solver->initialize(kPendulumParameters);
    EXPECT_DOUBLE_EQ(solver->getGravityVector(kHorizontal)[0], kTorque);
  }
  EXPECT_THROW(loader.createUniqueInstance("foreign_solver/OtherInterface"),
               pluginlib::CreateClassException);
}

const char* const kTwoLink = "two_link_solver/TwoLinkSolver";
const Parameters kErrorOfItsOwnClass = {{"fault", "error of its own class"}};

/// In a process of its own, where nothing else keeps the plugin open. Solver and loader are gone
/// before the error, whose class is in the plugin, is handled.
TEST(SolverLoaderDeathTest, ErrorOfASolverOutlivesItsLoader) {
  ::testing::FLAGS_gtest_death_test_style = "threadsafe";
  const auto text_of_error = []() -> std::string {
    try {
      SolverLoader().load(kTwoLink)->initialize(kErrorOfItsOwnClass);
    } catch (const InvalidParameterValueException& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EXIT(std::exit(text_of_error() == "error of its own class" ? 0 : 1),
              ::testing::ExitedWithCode(0), "");
}

TEST(PluginlibDeathTest, ErrorOfASolverOutlivesItsLoaderWhichMayBeMadeAgain) {
  ::testing::FLAGS_gtest_death_test_style = "threadsafe";
  const auto text_of_error = []() -> std::string {
    try {
      pluginlib::ClassLoader<InverseDynamicsSolver> loader(
          "inverse_dynamics_solver", "inverse_dynamics_solver::InverseDynamicsSolver");
      loader.createUniqueInstance(kTwoLink)->initialize(kErrorOfItsOwnClass);
    } catch (const InvalidParameterValueException& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EXIT(
      {
        const std::string first = text_of_error();
        const std::string second = text_of_error();
        std::exit(first == "error of its own class" && first == second ? 0 : 1);
      },
      ::testing::ExitedWithCode(0), "");
}

TEST(SolverLoader, PluginsOfEachIndexAreTheirOwn) {
  const SolverLoader here;
  const char* const prefixes = std::getenv("AMENT_PREFIX_PATH");
  ASSERT_NE(prefixes, nullptr);
  const std::string all = prefixes, first = all.substr(0, all.find(':'));  // the pendulum's
  {
    const Environment environment("AMENT_PREFIX_PATH",
                                  (first + all.substr(all.rfind(':'))).c_str());
    const SolverLoader there;
    EXPECT_EQ(there.availableSolvers(), std::vector<std::string>{kPendulum});
    EXPECT_NE(there.load(kPendulum), nullptr);
    EXPECT_THROW(there.load("two_link_solver/TwoLinkSolver"), PluginNotFoundException);
  }
  EXPECT_NE(here.load("two_link_solver/TwoLinkSolver"), nullptr);
}

}  // namespace inverse_dynamics_solver::solver_loader_test
