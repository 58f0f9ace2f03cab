// SPDX-License-Identifier: Apache-2.0
/// @file
/// A plugin built against an interface of the same name that isn't ours: a header with another
/// class, as the reference implementation has it.
#include <pluginlib/class_list_macros.hpp>

namespace inverse_dynamics_solver {

class InverseDynamicsSolver {
 public:
  virtual ~InverseDynamicsSolver() = default;
  virtual int somethingElse() = 0;
};

}  // namespace inverse_dynamics_solver

namespace foreign_solver {

class OtherInterface : public inverse_dynamics_solver::InverseDynamicsSolver {
 public:
  int somethingElse() override { return 1; }
};

}  // namespace foreign_solver

PLUGINLIB_EXPORT_CLASS(foreign_solver::OtherInterface,
                       inverse_dynamics_solver::InverseDynamicsSolver)
