// SPDX-License-Identifier: Apache-2.0

// How long each of many calls takes, through the public interface, into the caller's memory, as
// JSON. The first argument is how many calls (default: ten million). `ids bench --latency` runs it
// and makes a table of it.

#include <algorithm>
#include <cstdlib>
#include <inverse_dynamics_solver/inverse_dynamics_solver.hpp>
#include <inverse_dynamics_solver/solver_loader.hpp>
#include <iostream>
#include <ostream>
#include <string>
#include <vector>

#include "latency.hpp"
#include "program.hpp"
#include "robots.hpp"

namespace inverse_dynamics_benchmarks {
namespace {

using inverse_dynamics_solver::InverseDynamicsSolver;
using inverse_dynamics_solver::SolverLoader;

/// Writes one object per measurement, as soon as it is there.
class Report {
 public:
  Report(long calls, double tick) : calls_(calls), tick_(tick) { std::cout << "[\n"; }
  ~Report() { std::cout << "\n]\n"; }
  Report(const Report&) = delete;
  Report& operator=(const Report&) = delete;

  template <typename Call>
  void measure(const std::string& name, Call call) {
    const Latency x = measureLatency(name, calls_, tick_, call);
    std::cout << separator_ << R"({"name": ")" << x.name << '"';
    field("calls", x.calls);
    field("p50", x.p50);
    field("p99", x.p99);
    field("p99.99", x.p9999);
    field("max", x.max);
    field("slowest_state", x.slowest_state);
    field("interruptions_per_second", x.interruptions_per_second);
    field("context_switches", x.context_switches);
    field("page_faults", x.page_faults);
    std::cout << '}' << std::flush;
    separator_ = ",\n";
  }

 private:
  template <typename Number>
  static void field(const char* name, Number value) {
    std::cout << ", \"" << name << "\": " << value;
  }

  long calls_;
  double tick_;
  const char* separator_ = "";
};

void measureSystem(Report& report) {
  report.measure("system/nothing/none", [](Eigen::Index) {});
  // No memory, no library: what it takes beyond its least is the system's.
  report.measure("system/multiplications/none", [](Eigen::Index) {
    volatile double result = 1.0;
    double product = result;
    for (int i = 0; i < 60; ++i) product *= 1.0 + 1e-9 * product;
    result = product;
  });
}

void measureSolver(Report& report, const std::string& robot, const std::string& library,
                   const InverseDynamicsSolver& solver) {
  const Eigen::Index n = solver.jointCount();
  const States states(n);
  Eigen::MatrixXd H(n, n);
  Eigen::VectorXd c(n), g(n), tau(n);
  report.measure(robot + "/torques/" + library, [&](Eigen::Index k) {
    solver.getTorques(states.q.col(k), states.qd.col(k), states.qdd.col(k), tau);
  });
  report.measure(robot + "/components/" + library, [&](Eigen::Index k) {
    solver.getDynamicComponents(states.q.col(k), states.qd.col(k), H, c, g);
  });
}

void measureAll(Report& report) {
  measureSystem(report);
  const SolverLoader loader;
  const std::vector<std::string> installed = loader.availableSolvers();
  const auto measure = [&](const std::string& robot, const std::string& library,
                           const std::string& plugin, const std::string& urdf) {
    if (std::find(installed.begin(), installed.end(), plugin) == installed.end()) return;
    const auto solver = loader.load(plugin);
    solver->initialize({}, "", urdf);
    measureSolver(report, robot, library, *solver);
  };
  for (const Robot& robot : realRobots()) {
    measure(robot.name, "ours", "rigid_body_inverse_dynamics_solver/InverseDynamicsSolverRigidBody",
            robot.urdf);
    measure(robot.name, "pinocchio",
            "pinocchio_inverse_dynamics_solver/InverseDynamicsSolverPinocchio", robot.urdf);
    measure(robot.name, "kdl", "kdl_inverse_dynamics_solver/InverseDynamicsSolverKDL", robot.urdf);
  }
  measure("ur10_identified", "ours", "ur10_inverse_dynamics_solver/InverseDynamicsSolverUR10", "");
  measure("panda_identified", "ours",
          "franka_inria_inverse_dynamics_solver/InverseDynamicsSolverFrankaInria", "");
}

int run(int argc, char** argv) {
  constexpr long kDefaultCalls = 10'000'000;
  const long calls = argc > 1 ? std::strtol(argv[1], nullptr, 10) : kDefaultCalls;
  if (calls < 1 || argc > 2) {
    std::cerr << "usage: inverse_dynamics_latency [CALLS]; CALLS: above zero\n";
    return 1;
  }
  Report report(calls, nanosecondsPerTick());
  measureAll(report);
  return 0;
}

}  // namespace
}  // namespace inverse_dynamics_benchmarks

int main(int argc, char** argv) {
  using inverse_dynamics_benchmarks::run;
  return inverse_dynamics_benchmarks::statusOf("inverse_dynamics_latency", run, argc, argv);
}
