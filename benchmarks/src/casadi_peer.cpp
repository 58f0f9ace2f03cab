// SPDX-License-Identifier: Apache-2.0

// C that CasADi generated and GCC compiled when the benchmarks were built: casadi_code.cpp.

#include <benchmark/benchmark.h>

#include <array>
#include <cstddef>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "peers.hpp"
#include "states.hpp"
#include "timing.hpp"

namespace inverse_dynamics_benchmarks {
namespace {

using Call = int (*)(const double** arg, double** res, long long* iw, double* w, int mem);
using Work = int (*)(long long* sz_arg, long long* sz_res, long long* sz_iw, long long* sz_w);

/// A generated function, and how much memory it needs.
struct Generated {
  Call call;
  Work work;
};

/// In this order.
constexpr std::array kQuantities = {"torques", "inertia", "coriolis", "gravity", "components"};

#define FUNCTION(name)                                                           \
  int name(const double** arg, double** res, long long* iw, double* w, int mem); \
  int name##_work(long long* sz_arg, long long* sz_res, long long* sz_iw, long long* sz_w);
#define FUNCTIONS(robot, expression)      \
  FUNCTION(robot##_torques_##expression)  \
  FUNCTION(robot##_inertia_##expression)  \
  FUNCTION(robot##_coriolis_##expression) \
  FUNCTION(robot##_gravity_##expression)  \
  FUNCTION(robot##_components_##expression)
#define GENERATED(name) \
  Generated { name, name##_work }
#define ALL_GENERATED(robot, expression)                                                   \
  {                                                                                        \
    GENERATED(robot##_torques_##expression), GENERATED(robot##_inertia_##expression),      \
        GENERATED(robot##_coriolis_##expression), GENERATED(robot##_gravity_##expression), \
        GENERATED(robot##_components_##expression)                                         \
  }

extern "C" {
FUNCTIONS(ur10, templates)
FUNCTIONS(ur10, textbook)
FUNCTIONS(panda, templates)
FUNCTIONS(panda, textbook)
}

struct Expression {
  const char* robot;
  const char* library;
  std::array<Generated, kQuantities.size()> functions;
};

const Expression kExpressions[] = {
    {"ur10", "casadi_templates", ALL_GENERATED(ur10, templates)},
    {"ur10", "casadi_textbook", ALL_GENERATED(ur10, textbook)},
    {"panda", "casadi_templates", ALL_GENERATED(panda, templates)},
    {"panda", "casadi_textbook", ALL_GENERATED(panda, textbook)},
};

/// One function with its states, results and memory.
struct CasadiPeer {
  CasadiPeer(const Generated& generated, bool matrix, Eigen::Index n)
      : call(generated.call), states(n), first(n, matrix ? n : 1), c(n), g(n) {
    long long arg = 0, res = 0, iw = 0, w = 0;
    generated.work(&arg, &res, &iw, &w);
    integers.resize(static_cast<std::size_t>(iw) + 1);
    numbers.resize(static_cast<std::size_t>(w) + 1);
    arguments.resize(static_cast<std::size_t>(arg) + 3);
    results.resize(static_cast<std::size_t>(res) + 3);
  }

  void operator()(Eigen::Index k) {
    arguments[0] = states.q.col(k).data();
    arguments[1] = states.qd.col(k).data();
    arguments[2] = states.qdd.col(k).data();
    results[0] = first.data();
    results[1] = c.data();
    results[2] = g.data();
    call(arguments.data(), results.data(), integers.data(), numbers.data(), 0);
  }

  Call call;
  States states;
  Eigen::MatrixXd first;  ///< torques, H, ...
  Eigen::VectorXd c, g;
  std::vector<const double*> arguments;
  std::vector<double*> results;
  std::vector<long long> integers;
  std::vector<double> numbers;
};

}  // namespace

void registerCasadi(const PeerRobot& robot) {
  for (const Expression& expression : kExpressions) {
    if (robot.name != expression.robot) continue;
    for (std::size_t i = 0; i < kQuantities.size(); ++i) {
      const std::string quantity = kQuantities[i];
      const bool matrix = quantity == "inertia" || quantity == "components";
      const auto peer =
          std::make_shared<CasadiPeer>(expression.functions[i], matrix, robot.chain.jointCount());
      (*peer)(0);
      if (i == 0) requireSameTorques(robot, expression.library, peer->first);
      registerOverStates(robot.name + "/" + quantity + "/" + expression.library,
                         [peer](Eigen::Index k) {
                           (*peer)(k);
                           benchmark::ClobberMemory();
                         });
    }
  }
}

std::string casadiVersion() { return BENCHMARK_CASADI_VERSION; }

}  // namespace inverse_dynamics_benchmarks
