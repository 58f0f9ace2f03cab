// SPDX-License-Identifier: Apache-2.0
/// @file
/// Solvers by name, through pluginlib.
///
///     SolverLoader loader;
///     for (const std::string& name : loader.availableSolvers()) std::cout << name << "\n";
///     auto solver = loader.load("kdl_inverse_dynamics_solver/InverseDynamicsSolverKDL");
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "inverse_dynamics_solver/inverse_dynamics_solver.hpp"

namespace inverse_dynamics_solver {
inline namespace v2 {

/// Finds the solver plugins of the sourced workspaces and makes solvers of them.
///
/// Installed plugins are looked up once, on construction. A plugin's library stays open until the
/// end of the program, so solvers and the exceptions that they throw may outlive the loader.
/// Threads: safe.
///
/// pluginlib's own loader works too, with package `inverse_dynamics_solver` and base class
/// `inverse_dynamics_solver::InverseDynamicsSolver`; then the solver must not outlive it.
class SolverLoader {
 public:
  SolverLoader();
  ~SolverLoader();
  SolverLoader(SolverLoader&&) noexcept;
  SolverLoader& operator=(SolverLoader&&) noexcept;

  /// Names of the installed plugins, sorted; empty if no workspace is sourced.
  std::vector<std::string> availableSolvers() const;

  /// Description of a plugin by its package. Throws as load().
  std::string description(const std::string& name) const;

  /// A new solver, not initialized.
  ///
  /// @param name  as in availableSolvers(): `package/Class`.
  /// Throws PluginNotFoundException: no such plugin (the text lists what there is); its library
  /// can't be opened, or was built against another version of the interface.
  std::shared_ptr<InverseDynamicsSolver> load(const std::string& name) const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace v2
}  // namespace inverse_dynamics_solver
