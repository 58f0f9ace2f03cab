// SPDX-License-Identifier: Apache-2.0
/// @file
/// What the examples of inverse_dynamics_control and inverse_dynamics_solver take for granted. Compiled,
/// never linked.
#pragma once

#include <Eigen/Core>
#include <inverse_dynamics_control/inverse_dynamics_control.hpp>
#include <inverse_dynamics_solver/configuration.hpp>
#include <inverse_dynamics_solver/inverse_dynamics_solver.hpp>
#include <inverse_dynamics_solver/payload.hpp>
#include <inverse_dynamics_solver/solver_loader.hpp>
#include <iostream>
#include <memory>
#include <string>
#include <vector>

using namespace inverse_dynamics_control;
using namespace inverse_dynamics_solver;

namespace given {

// A robot, its state, and a cycle of its control loop.
extern std::shared_ptr<InverseDynamicsSolver> solver;
extern const Eigen::Index n;
extern Eigen::VectorXd q, qd, qdd, tau, effort, a, f;
extern const double period;
extern JointState state;
extern Reference reference;

// What makes a robot.
extern const std::string urdf;
extern const Parameters parameters;

// Numbers of joints that somebody has chosen or measured.
extern const Eigen::VectorXd effort_limits, measured_effort, pid_effort, torques;
extern const Eigen::VectorXd damping, stiffness, deceleration, viscous_scale, coulomb_scale;
extern Eigen::MatrixXd quiet;

// What other examples make.
extern ComputedTorque law;
extern Gains gains;
extern Compensated compensated;
extern MomentumObserver observer;
extern ContactThresholds thresholds;
extern SafeStop stop;
extern RigidBody part;
extern Eigen::Matrix3d R_root_world;

// What a program does with results and errors.
void ask_user(const char* text);
void give_up(const char* text);
template <class... Results>
void use(const Results&...);
template <class... Results>
void report(const Results&...);

// Of ROS.
struct StateInterface {
  double get_value() const;
};
extern StateInterface position_interface;

// What means something else in each header.
namespace acceleration_residual_examples {
extern EstimatorOptions options;
}
namespace computed_torque_examples {
extern LawOptions options;
}
namespace contact_sensing_examples {
extern ContactOptions options;
}
namespace estimator_choice_examples {
extern EstimatorOptions options;
}
namespace feed_forward_examples {
extern LawOptions options;
}
namespace gravity_compensation_examples {
extern LawOptions options;
}
namespace momentum_observer_examples {
extern EstimatorOptions options;
}
namespace output_stage_examples {
extern OutputLimits limits;
extern Eigen::VectorXd desired;
}  // namespace output_stage_examples
namespace pd_gravity_compensation_examples {
extern LawOptions options;
}
namespace published_examples {
struct Robot {
  explicit Robot(int model);
  void torques(const Eigen::VectorXd& q, const Eigen::VectorXd& qd, const Eigen::VectorXd& qdd,
               Eigen::VectorXd& tau) const;
};
extern const int model, with_tool;
}  // namespace published_examples
namespace reference_guard_examples {
extern ReferenceLimits limits;
extern Reference desired;
}  // namespace reference_guard_examples
namespace states_examples {
extern const Eigen::MatrixXd rows;
extern const double* data;
extern const Eigen::Index N;
extern Eigen::MatrixXd g;
}  // namespace states_examples
namespace tip_wrench_examples {
extern WrenchOptions options;
}
namespace workspace_pool_examples {
struct Workspace {
  explicit Workspace(int model);
  void torques(const Eigen::VectorXd& q, const Eigen::VectorXd& qd, const Eigen::VectorXd& qdd,
               Eigen::VectorXd& tau);
};
extern const Configuration configuration;
extern const int model;
}  // namespace workspace_pool_examples

}  // namespace given

#define RCLCPP_ERROR_THROTTLE(logger, clock, milliseconds, format, text) report(format, text)
