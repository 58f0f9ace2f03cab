// SPDX-License-Identifier: Apache-2.0
/// @file
/// The class Solver of Python, and the parts of its binding, one source each.
#pragma once

#include <pybind11/pybind11.h>

#include <inverse_dynamics_evaluation/run_configuration.hpp>
#include <inverse_dynamics_solver/exceptions.hpp>
#include <inverse_dynamics_solver/inverse_dynamics_solver.hpp>
#include <inverse_dynamics_solver/regressor.hpp>
#include <inverse_dynamics_solver/solver_loader.hpp>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "frames.hpp"
#include "parameters.hpp"
#include "solver_call.hpp"

namespace inverse_dynamics_tools {

/// The arguments that made a solver: enough to make it again elsewhere (pickle).
struct Origin {
  std::string plugin, urdf;
  ParameterValues parameters;
  inverse_dynamics_evaluation::RunConfiguration robot;  // that has these arguments
};

/// Names of the installed solvers for which `has` is true.
template <class Has>
std::string solversThat(const Has& has) {
  const inverse_dynamics_solver::SolverLoader loader;
  std::string names;
  for (const std::string& name : loader.availableSolvers()) {
    try {
      if (has(*loader.load(name))) names += (names.empty() ? "" : ", ") + name;
    } catch (const inverse_dynamics_solver::Exception&) {
      // don't recommend a solver that can't be loaded
    }
  }
  return names;
}

class Solver {
 public:
  static constexpr const char* kExample = "Solver(urdf=load_robot(\"ur10_simulated\").urdf)";

  explicit Solver(Origin origin);

  const Origin& origin() const { return origin_; }
  const inverse_dynamics_solver::InverseDynamicsSolver& get() const { return *solver_; }
  std::shared_ptr<const inverse_dynamics_solver::InverseDynamicsSolver> shared() const {
    return solver_;
  }
  const std::vector<std::string>& joints() const { return solver_->jointNames(); }
  Eigen::Index links() const {
    const auto* const regressor = find<inverse_dynamics_solver::Regressor>();
    return regressor == nullptr ? solver_->jointCount() : regressor->linkCount();
  }
  const Frames& frames() const { return *frames_; }

  /// A capability; null if this solver lacks it.
  template <class Capability>
  Capability* find() const {
    return dynamic_cast<Capability*>(solver_.get());
  }

  /// @throws Exception  this solver lacks it; names those that have it. `method` begins the text.
  template <class Capability>
  Capability& as(const std::string& method) const {
    if (auto* const found = find<Capability>()) return *found;
    const std::string others = solversThat(
        [](const auto& solver) { return dynamic_cast<const Capability*>(&solver) != nullptr; });
    throw inverse_dynamics_solver::Exception(inverse_dynamics_solver::errorText(
        method, "this solver doesn't compute it",
        others.empty() ? "a solver that does" : "one of " + others, origin_.plugin,
        "make another Solver for it"));
  }

  template <class Capability>
  Capability& as(const PartOfCall& part) const {
    return as<Capability>(part.call.method());
  }

  template <class OfPart>
  void compute(const SolverCall& call, const OfPart& of_part) const {
    call.run([&] { of_part(PartOfCall{call, 0, call.count()}); });
  }

 private:
  Origin origin_;
  std::shared_ptr<inverse_dynamics_solver::InverseDynamicsSolver> solver_;
  std::unique_ptr<const Frames> frames_;
};

void bindProperties(pybind11::class_<Solver>& solver);
void bindQuantities(pybind11::class_<Solver>& solver);
void bindChanges(pybind11::class_<Solver>& solver);
void bindFrictionState(pybind11::module_& module, pybind11::class_<Solver>& solver);

/// What was set since a solver was made: payloads and gravity; empty where it can't be.
pybind11::dict changesOf(const Solver& solver);

/// Sets it again.
void change(const Solver& solver, const pybind11::dict& changes);

}  // namespace inverse_dynamics_tools
