// SPDX-License-Identifier: Apache-2.0

// Times every solver through the public interface, into the caller's memory, and its peers on the
// same states. Names: ROBOT/QUANTITY/LIBRARY.

#include <benchmark/benchmark.h>

#include <ament_index_cpp/get_package_share_directory.hpp>
#include <fstream>
#include <inverse_dynamics_solver/solver_loader.hpp>
#include <map>
#include <memory>
#include <sstream>
#include <string>

#include "pinocchio_peer.hpp"
#include "states.hpp"
#include "timing.hpp"

namespace inverse_dynamics_benchmarks {
namespace {

using inverse_dynamics_solver::InverseDynamicsSolver;
using inverse_dynamics_solver::ParameterValue;
using inverse_dynamics_solver::SolverLoader;

/// A solver with its states and the memory of its results.
struct Subject {
  Subject(std::shared_ptr<InverseDynamicsSolver> initialized)
      : solver(std::move(initialized)),
        n(solver->jointCount()),
        states(n),
        H(n, n),
        c(n),
        g(n),
        tau(n),
        tau_batch(n, kStates),
        H_batch(n, n * kStates) {}

  std::shared_ptr<InverseDynamicsSolver> solver;
  Eigen::Index n;
  States states;
  Eigen::MatrixXd H;
  Eigen::VectorXd c, g, tau;
  Eigen::MatrixXd tau_batch, H_batch;
};

void registerSingleCalls(const std::string& robot, const std::string& library,
                         const std::shared_ptr<Subject>& s) {
  const auto add = [&](const char* quantity, auto call) {
    registerOverStates(robot + "/" + quantity + "/" + library, [s, call](Eigen::Index k) {
      call(*s, k);
      benchmark::ClobberMemory();
    });
  };
  add("torques", [](Subject& x, Eigen::Index k) {
    x.solver->getTorques(x.states.q.col(k), x.states.qd.col(k), x.states.qdd.col(k), x.tau);
  });
  add("inertia",
      [](Subject& x, Eigen::Index k) { x.solver->getInertiaMatrix(x.states.q.col(k), x.H); });
  add("coriolis", [](Subject& x, Eigen::Index k) {
    x.solver->getCoriolisVector(x.states.q.col(k), x.states.qd.col(k), x.c);
  });
  add("gravity",
      [](Subject& x, Eigen::Index k) { x.solver->getGravityVector(x.states.q.col(k), x.g); });
  add("components", [](Subject& x, Eigen::Index k) {
    x.solver->getDynamicComponents(x.states.q.col(k), x.states.qd.col(k), x.H, x.c, x.g);
  });
  add("friction",
      [](Subject& x, Eigen::Index k) { x.solver->getFrictionVector(x.states.qd.col(k), x.tau); });
}

void registerBatches(const std::string& robot, const std::string& library,
                     const std::shared_ptr<Subject>& s) {
  const auto add = [&](const char* quantity, auto call) {
    registerBatch(robot + "/" + quantity + "/" + library, [s, call] {
      call(*s);
      benchmark::ClobberMemory();
    });
  };
  add("torques_batch", [](Subject& x) {
    x.solver->getTorquesBatch(x.states.q, x.states.qd, x.states.qdd, x.tau_batch);
  });
  add("inertia_batch", [](Subject& x) { x.solver->getInertiaMatrixBatch(x.states.q, x.H_batch); });
  add("gravity_batch",
      [](Subject& x) { x.solver->getGravityVectorBatch(x.states.q, x.tau_batch); });
}

std::string textOf(const std::string& file) {
  std::ifstream stream(ament_index_cpp::get_package_share_directory("inverse_dynamics_robots") +
                       "/urdf/" + file);
  std::ostringstream text;
  text << stream.rdbuf();
  return text.str();
}

struct Configuration {
  std::string robot, library, plugin, description;
  std::map<std::string, ParameterValue> parameters;
};

void registerSolver(const SolverLoader& loader, const Configuration& c) {
  auto solver = loader.load(c.plugin);
  solver->initialize(c.parameters, "", c.description);
  const auto subject = std::make_shared<Subject>(std::move(solver));
  registerSingleCalls(c.robot, c.library, subject);
  registerBatches(c.robot, c.library, subject);
}

void registerAll(const SolverLoader& loader) {
  const std::string rigid_body =
      "rigid_body_inverse_dynamics_solver/InverseDynamicsSolverRigidBody";
  const std::string kdl = "kdl_inverse_dynamics_solver/InverseDynamicsSolverKDL";
  for (const std::string robot : {"ur10", "panda"}) {
    const std::string urdf = textOf(robot + ".urdf");
    registerSolver(loader, {robot, "ours", rigid_body, urdf, {}});
    registerSolver(loader, {robot, "kdl", kdl, urdf, {}});
#ifdef BENCHMARK_PINOCCHIO
    registerPinocchio(robot, urdf);
#endif
  }
  registerSolver(loader, {"ur10_identified",
                          "ours",
                          "ur10_inverse_dynamics_solver/InverseDynamicsSolverUR10",
                          "",
                          {}});
  registerSolver(loader, {"panda_identified",
                          "ours",
                          "franka_inria_inverse_dynamics_solver/InverseDynamicsSolverFrankaInria",
                          "",
                          {}});
}

}  // namespace
}  // namespace inverse_dynamics_benchmarks

int main(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 1;
  const inverse_dynamics_solver::SolverLoader loader;
  inverse_dynamics_benchmarks::registerAll(loader);
  benchmark::RunSpecifiedBenchmarks();
  return 0;
}
