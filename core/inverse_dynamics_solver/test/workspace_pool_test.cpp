// SPDX-License-Identifier: Apache-2.0
#include "inverse_dynamics_solver/workspace_pool.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <memory>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "inverse_dynamics_solver/conformance/allocation_guard.hpp"
#include "inverse_dynamics_solver/conformance/solver_fixture.hpp"
#include "inverse_dynamics_solver/exceptions.hpp"

namespace inverse_dynamics_solver::workspace_pool_test {

using conformance::AllocationGuard;
using conformance::kAllocationGuardWorks;

struct Workspace {
  bool busy = false;
};

using Pool = WorkspacePool<Workspace>;

std::unique_ptr<Workspace> make() { return std::make_unique<Workspace>(); }

TEST(WorkspacePool, LendsEachWorkspaceOnceAndTakesItBack) {
  Pool pool(2, make);
  std::set<Workspace*> pooled;
  {
    const Pool::Lease a = pool.acquire(), b = pool.acquire();
    pooled = {a.operator->(), b.operator->()};
    EXPECT_EQ(pooled.size(), 2U);
  }
  {
    const Pool::Lease a = pool.acquire(), b = pool.acquire();
    EXPECT_EQ(pooled, (std::set<Workspace*>{a.operator->(), b.operator->()}));

    // A third is made.
    AllocationGuard guard;
    const Pool::Lease third = pool.acquire();
    EXPECT_EQ(guard.count() > 0, kAllocationGuardWorks);
    EXPECT_EQ(pooled.count(third.operator->()), 0U);
  }
  AllocationGuard guard;
  EXPECT_EQ(pooled.count(pool.acquire().operator->()), 1U);
  EXPECT_EQ(guard.count(), 0);
}

TEST(WorkspacePool, NoTwoThreadsHaveTheSameWorkspace) {
  Pool pool(2, make);
  std::atomic<int> shared{0};
  std::vector<std::thread> threads;
  for (int i = 0; i < 4; ++i) {
    threads.emplace_back([&] {
      for (int k = 0; k < 2000; ++k) {
        const Pool::Lease workspace = pool.acquire();
        shared += workspace->busy ? 1 : 0;
        workspace->busy = true;
        std::this_thread::yield();
        workspace->busy = false;
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(shared, 0);
}

TEST(ReadMaxThreads, GivesWhatIsAskedForElseEnough) {
  EXPECT_EQ(readMaxThreads(readConfiguration(Parameters({{"max_threads", 3}}), "", "")), 3U);
  EXPECT_GE(readMaxThreads(readConfiguration({}, "", "")), 16U);
}

TEST(ReadMaxThreads, MistakesAreNamed) {
  const auto error = [](const ParameterValue& threads) {
    const Parameters parameters({{"ids.max_threads", threads}});
    return conformance::errorOf<InvalidParameterValueException>(
        [&] { readMaxThreads(readConfiguration(parameters, "ids", "")); });
  };
  EXPECT_EQ(error(0),
            "parameter 'ids.max_threads': wrong value: expected 1 to 4096, got 0; give the number "
            "of threads that compute at the same time");
  EXPECT_NE(error(5000).find("got 5000"), std::string::npos);
  EXPECT_EQ(error("many"),
            "parameter 'ids.max_threads': wrong type: expected integer, got string; correct it "
            "where it is set");
}

}  // namespace inverse_dynamics_solver::workspace_pool_test
