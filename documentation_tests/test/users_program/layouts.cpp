// SPDX-License-Identifier: Apache-2.0
#include "layouts.hpp"

#include <inverse_dynamics_control/inverse_dynamics_control.hpp>
#include <inverse_dynamics_evaluation/accelerations.hpp>
#include <inverse_dynamics_evaluation/online_derivative.hpp>
#include <inverse_dynamics_evaluation/sample_table.hpp>
#include <inverse_dynamics_solver/motor_currents.hpp>
#include <inverse_dynamics_solver/pooled_solver.hpp>
#include <inverse_dynamics_solver/torque_deviation.hpp>
#include <rigid_body_inverse_dynamics_solver/rigid_body_inverse_dynamics_solver.hpp>

#include "chain_dynamics/fast_model.hpp"
#include "chain_dynamics/urdf.hpp"

namespace {

template <class T>
Layout layout(const char* type) {
  return {type, sizeof(T), alignof(T)};
}

}  // namespace

// Alone in a file, whose functions are the same with any flags: nothing here computes.
#define LAYOUT(type) layout<type>(#type)

std::vector<Layout> LAYOUTS() {
  return {LAYOUT(chain_dynamics::Chain),
          LAYOUT(chain_dynamics::FastModel),
          LAYOUT(chain_dynamics::FrictionLaw),
          LAYOUT(chain_dynamics::FrictionState),
          LAYOUT(chain_dynamics::SeenRange),
          LAYOUT(chain_dynamics::Joint),
          LAYOUT(chain_dynamics::LinkParameters),
          LAYOUT(chain_dynamics::Model),
          LAYOUT(chain_dynamics::StridedMatrices),
          LAYOUT(chain_dynamics::Transform<double>),
          LAYOUT(chain_dynamics::UrdfOptions),
          LAYOUT(inverse_dynamics_control::ComputedTorque),
          LAYOUT(inverse_dynamics_control::FaultLatch),
          LAYOUT(inverse_dynamics_control::FeedForward),
          LAYOUT(inverse_dynamics_control::Gains),
          LAYOUT(inverse_dynamics_control::GravityCompensation),
          LAYOUT(inverse_dynamics_control::LawOptions),
          LAYOUT(inverse_dynamics_control::Reference),
          LAYOUT(inverse_dynamics_control::ReferenceGuard),
          LAYOUT(inverse_dynamics_control::SafeStop),
          LAYOUT(inverse_dynamics_evaluation::AccelerationReport),
          LAYOUT(inverse_dynamics_evaluation::JointMetrics),
          LAYOUT(inverse_dynamics_evaluation::JointSample),
          LAYOUT(inverse_dynamics_evaluation::OnlineDerivative),
          LAYOUT(inverse_dynamics_evaluation::SampleReport),
          LAYOUT(inverse_dynamics_evaluation::SampleTable),
          LAYOUT(inverse_dynamics_evaluation::TableBuilder),
          LAYOUT(inverse_dynamics_solver::Configuration),
          LAYOUT(inverse_dynamics_solver::ConstStatesRef),
          LAYOUT(inverse_dynamics_solver::ConstVectorRef),
          LAYOUT(inverse_dynamics_solver::InverseDynamicsSolver),
          LAYOUT(inverse_dynamics_solver::MatrixRef),
          LAYOUT(inverse_dynamics_solver::MotorCurrents),
          LAYOUT(inverse_dynamics_solver::TorqueDeviation),
          LAYOUT(inverse_dynamics_solver::Parameters),
          LAYOUT(inverse_dynamics_solver::PooledSolver),
          LAYOUT(inverse_dynamics_solver::WorkspacePool<inverse_dynamics_solver::Workspace>),
          LAYOUT(rigid_body_inverse_dynamics_solver::InverseDynamicsSolverRigidBody)};
}
