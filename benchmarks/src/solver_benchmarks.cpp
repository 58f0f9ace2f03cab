// SPDX-License-Identifier: Apache-2.0
#include "solver_benchmarks.hpp"

#include "states.hpp"
#include "timing.hpp"

namespace inverse_dynamics_benchmarks {
namespace {

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
    subject->solver->getFrictionVector(subject->states.qd.col(k), subject->tau);
    benchmark::ClobberMemory();
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

void registerLargeBatch(const std::string& robot, const Solver& solver) {
  constexpr Eigen::Index kLarge = 1 << 18;  // 50 MB for six joints
  struct Large {
    States states;
    Eigen::MatrixXd tau;
  };
  const Eigen::Index n = solver->jointCount();
  const auto large = std::make_shared<Large>(Large{States(n, kLarge), Eigen::MatrixXd(n, kLarge)});
  registerBatch(robot + "/torques_memory/ours", kLarge, [solver, large] {
    solver->getTorquesBatch(large->states.q, large->states.qd, large->states.qdd, large->tau);
    benchmark::ClobberMemory();
  });
  registerBatch(robot + "/torques_memory/sum", kLarge, [large] {
    large->tau = large->states.q + large->states.qd + large->states.qdd;
    benchmark::ClobberMemory();
  });
}

}  // namespace inverse_dynamics_benchmarks
