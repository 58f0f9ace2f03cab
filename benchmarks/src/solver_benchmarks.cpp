// SPDX-License-Identifier: Apache-2.0
#include "solver_benchmarks.hpp"

#include <benchmark/benchmark.h>

#include <inverse_dynamics_solver/inverse_dynamics_solver.hpp>
#include <inverse_dynamics_solver/payload.hpp>
#include <inverse_dynamics_solver/variable_gravity.hpp>
#include <memory>
#include <string>

#include "states.hpp"
#include "timing.hpp"

namespace inverse_dynamics_benchmarks {
namespace {

using inverse_dynamics_solver::RigidBody;
using Solver = std::shared_ptr<const inverse_dynamics_solver::InverseDynamicsSolver>;

/// A solver with its states and the memory of its results.
struct Subject {
  Subject(const Solver& initialized, Eigen::Index count)
      : solver(initialized),
        n(solver->jointCount()),
        states(n, count),
        H(n, n),
        c(n),
        g(n),
        tau(n) {}

  Solver solver;
  Eigen::Index n;
  States states;
  Eigen::MatrixXd H;
  Eigen::VectorXd c, g, tau;
};

struct BatchSubject : Subject {
  BatchSubject(const Solver& initialized, Eigen::Index count)
      : Subject(initialized, count), H_all(n, n * count), c_all(n, count), g_all(n, count) {}

  Eigen::MatrixXd H_all, c_all, g_all;
};

/// States, and room for their torques.
struct Torques {
  Torques(Eigen::Index joints, Eigen::Index count) : states(joints, count), tau(joints, count) {}

  States states;
  Eigen::MatrixXd tau;
};

}  // namespace

void registerSingleCalls(const std::string& robot, const Solver& solver) {
  const auto subject = std::make_shared<Subject>(solver, kStates);
  const auto add = [&](const char* quantity, auto call) {
    registerOverStates(robot + "/" + quantity + "/ours", [subject, call](Eigen::Index k) {
      call(*subject, subject->states, k);
      benchmark::ClobberMemory();
    });
  };
  add("torques", [](Subject& x, const States& s, Eigen::Index k) {
    x.solver->getTorques(s.q.col(k), s.qd.col(k), s.qdd.col(k), x.tau);
  });
  add("inertia", [](Subject& x, const States& s, Eigen::Index k) {
    x.solver->getInertiaMatrix(s.q.col(k), x.H);
  });
  add("coriolis", [](Subject& x, const States& s, Eigen::Index k) {
    x.solver->getCoriolisVector(s.q.col(k), s.qd.col(k), x.c);
  });
  add("gravity", [](Subject& x, const States& s, Eigen::Index k) {
    x.solver->getGravityVector(s.q.col(k), x.g);
  });
  add("components", [](Subject& x, const States& s, Eigen::Index k) {
    x.solver->getDynamicComponents(s.q.col(k), s.qd.col(k), x.H, x.c, x.g);
  });
}

void registerFriction(const std::string& robot, const Solver& solver) {
  const auto subject = std::make_shared<Subject>(solver, kStates);
  registerOverStates(robot + "/friction/ours", [subject](Eigen::Index k) {
    subject->solver->getFrictionVector(subject->states.q.col(k), subject->states.qd.col(k),
                                       subject->tau);
    benchmark::ClobberMemory();
  });
}

void registerTorques(const std::string& name, const Solver& solver) {
  const auto subject = std::make_shared<Subject>(solver, kStates);
  registerOverStates(name, [subject](Eigen::Index k) {
    const States& s = subject->states;
    subject->solver->getTorques(s.q.col(k), s.qd.col(k), s.qdd.col(k), subject->tau);
    benchmark::ClobberMemory();
  });
}

void registerPayload(
    const std::string& robot,
    const std::shared_ptr<inverse_dynamics_solver::InverseDynamicsSolver>& solver) {
  auto* const payload = dynamic_cast<inverse_dynamics_solver::Payload*>(solver.get());
  auto* const mount = dynamic_cast<inverse_dynamics_solver::VariableGravity*>(solver.get());
  inverse_dynamics_solver::RigidBody body{2.0};
  body.center_of_mass = {0.0, 0.0, 0.1};
  payload->setPayload("part", body);
  registerTorques(robot + "/torques_payload/ours", solver);
  registerOverStates(robot + "/set_payload/ours", [solver, payload, body](Eigen::Index k) {
    RigidBody changed = body;
    changed.mass += 1e-3 * static_cast<double>(k);
    payload->setPayload("part", changed);
  });
  registerOverStates(robot + "/set_gravity/ours", [solver, mount](Eigen::Index k) {
    mount->setGravity({1e-3 * static_cast<double>(k + 1), 0.0, -9.81});
  });
}

void registerBatches(const std::string& robot, const Solver& solver) {
  const auto subject = std::make_shared<BatchSubject>(solver, kStates);
  const auto add = [&](const char* quantity, auto call) {
    registerBatch(robot + "/" + quantity + "/ours", kStates, [subject, call] {
      call(*subject, subject->states);
      benchmark::ClobberMemory();
    });
  };
  add("torques_batch", [](BatchSubject& x, const States& s) {
    x.solver->getTorquesBatch(s.q, s.qd, s.qdd, x.c_all);
  });
  add("inertia_batch",
      [](BatchSubject& x, const States& s) { x.solver->getInertiaMatrixBatch(s.q, x.H_all); });
  add("coriolis_batch", [](BatchSubject& x, const States& s) {
    x.solver->getCoriolisVectorBatch(s.q, s.qd, x.c_all);
  });
  add("gravity_batch",
      [](BatchSubject& x, const States& s) { x.solver->getGravityVectorBatch(s.q, x.g_all); });
  add("components_batch", [](BatchSubject& x, const States& s) {
    x.solver->getDynamicComponentsBatch(s.q, s.qd, x.H_all, x.c_all, x.g_all);
  });
}

void registerRows(const std::string& robot, const Solver& solver) {
  using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  struct Rows {
    RowMajor q, qd, qdd, tau;  // n x N like columns, but the numbers of a joint are neighbours
  };
  const States states(solver->jointCount());
  const auto rows =
      std::make_shared<Rows>(Rows{states.q, states.qd, states.qdd, RowMajor(states.q)});
  registerBatch(robot + "/torques_rows/ours", kStates, [solver, rows] {
    solver->getTorquesBatch(rows->q, rows->qd, rows->qdd, rows->tau);
    benchmark::ClobberMemory();
  });
}

void registerManyStates(const std::string& robot, const std::string& library,
                        const Solver& solver) {
  const auto many = std::make_shared<Torques>(solver->jointCount(), 1 << 17);
  registerBatch(robot + "/torques_many/" + library, many->tau.cols(), [solver, many] {
    solver->getTorquesBatch(many->states.q, many->states.qd, many->states.qdd, many->tau);
    benchmark::ClobberMemory();
  })->UseRealTime();
}

void registerLargeBatch(const std::string& robot, const Solver& solver) {
  const auto large = std::make_shared<Torques>(solver->jointCount(), 1 << 18);  // 50 MB
  registerBatch(robot + "/torques_memory/ours", large->tau.cols(), [solver, large] {
    solver->getTorquesBatch(large->states.q, large->states.qd, large->states.qdd, large->tau);
    benchmark::ClobberMemory();
  });
  registerBatch(robot + "/torques_memory/sum", large->tau.cols(), [large] {
    large->tau = large->states.q + large->states.qd + large->states.qdd;
    benchmark::ClobberMemory();
  });
}

}  // namespace inverse_dynamics_benchmarks
