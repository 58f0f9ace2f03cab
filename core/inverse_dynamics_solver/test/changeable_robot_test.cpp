// SPDX-License-Identifier: Apache-2.0
#include "inverse_dynamics_solver/changeable_robot.hpp"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <future>
#include <thread>

namespace inverse_dynamics_solver::changeable_robot_test {

/// Nothing but the locks.
class Changing : public ChangingConditions {
 public:
  using ChangingConditions::publishAlone;
  using ChangingConditions::whileUnchanged;

 private:
  void changeTo(const Conditions& /*conditions*/) override {}
  const InverseDynamicsSolver& torqueSolver() const override { std::abort(); }
};

TEST(ChangingConditions, ChangesInAChildThatWasForkedDuringABatch) {
  constexpr unsigned kTooLong = 60;  // s, after which the child is ended
  Changing robot;
  std::promise<void> begun, ended;
  std::thread batch([&] {
    robot.whileUnchanged([&] {
      begun.set_value();
      ended.get_future().wait();
    });
  });
  begun.get_future().wait();
  const pid_t child = fork();
  if (child == 0) {
    alarm(kTooLong);
    bool has_changed = false;
    robot.publishAlone([&] { has_changed = true; });
    _exit(has_changed ? 0 : 1);
  }
  int status = -1;
  waitpid(child, &status, 0);
  EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0)
      << (WIFSIGNALED(status) ? "the child hung" : "the child's robot hasn't changed");
  ended.set_value();
  batch.join();
  bool has_changed = false;
  robot.publishAlone([&] { has_changed = true; });  // the parent's locks are free too
  EXPECT_TRUE(has_changed);
}

}  // namespace inverse_dynamics_solver::changeable_robot_test
