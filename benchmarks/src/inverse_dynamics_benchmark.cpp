// SPDX-License-Identifier: Apache-2.0

// Times every solver through the public interface, into the caller's memory, and other libraries on
// the same states. Names: ROBOT/QUANTITY/LIBRARY. `ids bench` runs it and makes tables of it; they
// know those in names.py.

#include <benchmark/benchmark.h>

#include <chain_dynamics/chain.hpp>
#include <chain_dynamics/mechanism.hpp>
#include <chain_dynamics/robot_description.hpp>
#include <chain_dynamics/urdf.hpp>
#include <cstdint>
#include <inverse_dynamics_solver/inverse_dynamics_solver.hpp>
#include <inverse_dynamics_solver/parameters.hpp>
#include <inverse_dynamics_solver/solver_loader.hpp>
#include <map>
#include <memory>
#include <string>

#include "context.hpp"
#include "engine_benchmarks.hpp"
#include "fixed_robot.hpp"
#include "observer_benchmarks.hpp"
#include "peers.hpp"
#include "program.hpp"
#include "robots.hpp"
#include "solver_benchmarks.hpp"
#include "states.hpp"

namespace inverse_dynamics_benchmarks {
namespace {

using inverse_dynamics_solver::InverseDynamicsSolver;
using inverse_dynamics_solver::ParameterValue;
using inverse_dynamics_solver::SolverLoader;

constexpr const char* kRigidBody =
    "rigid_body_inverse_dynamics_solver/InverseDynamicsSolverRigidBody";

void registerPeers(const PeerRobot& robot) {
  registerKdl(robot);
#ifdef BENCHMARK_PINOCCHIO
  registerPinocchio(robot);
#endif
#ifdef BENCHMARK_MUJOCO
  registerMujoco(robot);
#endif
#ifdef BENCHMARK_CASADI
  registerCasadi(robot);
#endif
}

void registerLargerBatches(const SolverLoader& loader, const Robot& robot,
                           const std::shared_ptr<const InverseDynamicsSolver>& solver) {
  registerRows(robot.name, solver);
  registerLargeBatch(robot.name, solver);
  registerManyStates(robot.name, "ours", solver);
  const auto threaded = loader.load(kRigidBody);
  threaded->initialize(std::map<std::string, ParameterValue>{{"batch_threads", std::int64_t{2}}},
                       "", robot.urdf);
  registerManyStates(robot.name, "two_threads", threaded);
}

void registerRobot(const SolverLoader& loader, const Robot& robot) {
  const auto solver = loader.load(kRigidBody);
  solver->initialize({}, "", robot.urdf);
  registerSingleCalls(robot.name, solver);
  const Eigen::Index n = solver->jointCount();
  if (isArm(n)) registerBatches(robot.name, solver);
  const chain_dynamics::Chain chain = chain_dynamics::chainFromUrdf(robot.urdf);
  if (robot.name == "ur10" || robot.name == "panda") {
    const auto fixed = std::make_shared<FixedRobot>(chain);
    fixed->initialize();
    registerTorques(robot.name + "/torques_fixed/ours", fixed);
    const auto loaded = loader.load(kRigidBody);
    loaded->initialize({}, "", robot.urdf);
    registerPayload(robot.name, loaded);
  }
  if (robot.name == "ur10") registerLargerBatches(loader, robot, solver);

  if (isArm(n)) registerEngine(robot.name, chain);
  const States states(n);
  registerPeers({robot.name, robot.urdf, chain,
                 solver->getTorques(states.q.col(0), states.qd.col(0), states.qdd.col(0))});
}

void registerTwoPandas(const SolverLoader& loader) {
  const Robot robot = twoPandas();
  const auto solver = loader.load(kRigidBody);
  solver->initialize(std::map<std::string, ParameterValue>{{"tip", std::string("*")}}, "",
                     robot.urdf);
  registerSingleCalls(robot.name, solver);
  registerBatches(robot.name, solver);
#ifdef BENCHMARK_PINOCCHIO
  const auto tree = chain_dynamics::robotFromUrdf(robot.urdf);
  const States states(solver->jointCount());
  const auto coordinates = chain_dynamics::mechanismFromRobot(tree, {}, {"*"}).coordinates;
  registerPinocchio({robot.name, robot.urdf, coordinates,
                     solver->getTorques(states.q.col(0), states.qd.col(0), states.qdd.col(0)),
                     tree});
#endif
}

void registerIdentified(const SolverLoader& loader, const std::string& robot,
                        const std::string& plugin) {
  const auto solver = loader.load(plugin);
  solver->initialize();
  registerSingleCalls(robot, solver);
  registerFriction(robot, solver);
  registerBatches(robot, solver);
  const auto loaded = loader.load(plugin);
  loaded->initialize();
  registerPayload(robot, loaded);
  registerObservers(robot, solver);
}

void registerFeasiblePanda(const SolverLoader& loader) {
  const auto solver = loader.load(kRigidBody);
  solver->initialize(std::map<std::string, ParameterValue>{{"model", feasiblePandaFile()}});
  registerObservers("panda_feasible", solver);
}

int run(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 1;
  for (const auto& [name, text] : measurementContext()) benchmark::AddCustomContext(name, text);

  const SolverLoader loader;
  for (const Robot& robot : robots()) registerRobot(loader, robot);
  registerTwoPandas(loader);
  registerIdentified(loader, "ur10_identified",
                     "ur10_inverse_dynamics_solver/InverseDynamicsSolverUR10");
  registerIdentified(loader, "panda_identified",
                     "franka_inria_inverse_dynamics_solver/InverseDynamicsSolverFrankaInria");
  registerFeasiblePanda(loader);
  benchmark::RunSpecifiedBenchmarks();
  benchmark::ClearRegisteredBenchmarks();  // before the loader, which holds the solvers' libraries
  benchmark::Shutdown();
  return 0;
}

}  // namespace
}  // namespace inverse_dynamics_benchmarks

int main(int argc, char** argv) {
  using inverse_dynamics_benchmarks::run;
  return inverse_dynamics_benchmarks::statusOf("inverse_dynamics_benchmark", run, argc, argv);
}
