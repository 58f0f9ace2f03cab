// SPDX-License-Identifier: Apache-2.0
/// @file
/// A controller between hardware that is a few numbers and references that a test writes.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <fstream>
#include <initializer_list>
#include <inverse_dynamics_solver/installed_package.hpp>
#include <inverse_dynamics_solver/solver_loader.hpp>
#include <lifecycle_msgs/msg/state.hpp>
#include <limits>
#include <map>
#include <memory>
#include <rclcpp/rclcpp.hpp>
#include <sstream>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "inverse_dynamics_controllers/ros2_control_compatibility.hpp"
#include "inverse_dynamics_controllers/testing/captured_log.hpp"

#if __has_include(<controller_interface/controller_interface_params.hpp>)
#include <controller_interface/controller_interface_params.hpp>
#define INVERSE_DYNAMICS_CONTROLLERS_HAS_INTERFACE_PARAMS
#endif

namespace inverse_dynamics_controllers {

using controller_interface::return_type;
using hardware_interface::LoanedCommandInterface;
using hardware_interface::LoanedStateInterface;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr int kRate = 1000;              // Hz
constexpr double kPeriod = 1.0 / kRate;  // s
constexpr const char* kKdl = "kdl_inverse_dynamics_solver/InverseDynamicsSolverKDL";
constexpr const char* kUr10 = "ur10_inverse_dynamics_solver/InverseDynamicsSolverUR10";

inline Eigen::VectorXd vec(std::initializer_list<double> values) {
  Eigen::VectorXd v(static_cast<Eigen::Index>(values.size()));
  std::copy(values.begin(), values.end(), v.data());
  return v;
}

inline std::string ur10Description() {
  std::ifstream file(inverse_dynamics_solver::installedPackageShare("inverse_dynamics_robots") +
                     "/urdf/ur10.urdf");
  std::stringstream text;
  text << file.rdbuf();
  return text.str();
}

inline const std::vector<std::string>& ur10Joints() {
  static const std::vector<std::string> names = {"shoulder_pan_joint", "shoulder_lift_joint",
                                                 "elbow_joint",        "wrist_1_joint",
                                                 "wrist_2_joint",      "wrist_3_joint"};
  return names;
}

/// What a controller is given of interfaces.
template <class Loan, class Interfaces>
std::vector<Loan> loans(const Interfaces& interfaces) {
  using Pointer = typename Interfaces::value_type;
  std::vector<Loan> loaned;
  for (const Pointer& interface : interfaces) {
    if constexpr (std::is_constructible_v<Loan, const Pointer&>) {
      loaned.emplace_back(interface);
    } else {  // humble
      loaned.emplace_back(*interface);
    }
  }
  return loaned;
}

/// Joints with a position, a velocity, a measured and a commanded effort each.
class FakeHardware {
 public:
  explicit FakeHardware(const std::vector<std::string>& joints)
      : q(joints.size(), 0.0),
        qd(joints.size(), 0.0),
        measured_tau(joints.size(), 0.0),
        tau(joints.size(), 77.0) {
    for (std::size_t j = 0; j < joints.size(); ++j) {
      add(states_, joints[j], "position", &q[j]);
      add(states_, joints[j], "velocity", &qd[j]);
      add(states_, joints[j], "effort", &measured_tau[j]);
      add(commands_, joints[j], "effort", &tau[j]);
    }
  }

  void set(const Eigen::VectorXd& position, const Eigen::VectorXd& velocity) {
    for (std::size_t j = 0; j < q.size(); ++j) {
      q[j] = position[static_cast<Eigen::Index>(j)];
      qd[j] = velocity[static_cast<Eigen::Index>(j)];
    }
  }

  void setEffort(const Eigen::VectorXd& measured) {
    measured_tau.assign(measured.begin(), measured.end());
  }

  Eigen::VectorXd effort() const {
    return Eigen::Map<const Eigen::VectorXd>(tau.data(), static_cast<Eigen::Index>(tau.size()));
  }

  std::vector<LoanedStateInterface> states() { return loans<LoanedStateInterface>(states_); }
  std::vector<LoanedCommandInterface> commands() {
    return loans<LoanedCommandInterface>(commands_);
  }

  std::vector<double> q, qd, measured_tau, tau;

 private:
  template <class Interface>
  static void add(std::vector<std::shared_ptr<Interface>>& interfaces, const std::string& joint,
                  const std::string& name, double* value) {
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wdeprecated-declarations"  // from jazzy on, but still there
    interfaces.push_back(std::make_shared<Interface>(joint, name, value));
#pragma GCC diagnostic pop
  }

  std::vector<std::shared_ptr<hardware_interface::StateInterface>> states_;
  std::vector<std::shared_ptr<hardware_interface::CommandInterface>> commands_;
};

/// A controller on such hardware; parameters that a test doesn't give fit a UR10 and the KDL
/// solver.
template <class Controller>
class ControllerFixture : public ::testing::Test {
 protected:
  static void SetUpTestSuite() { rclcpp::init(0, nullptr); }
  static void TearDownTestSuite() { rclcpp::shutdown(); }

  using Parameters = std::map<std::string, rclcpp::ParameterValue>;

  static Parameters good() {
    return {{"plugin_name", rclcpp::ParameterValue(kKdl)},
            {"robot_description", rclcpp::ParameterValue(ur10Description())},
            {"ids.root", rclcpp::ParameterValue("base_link")},
            {"ids.tip", rclcpp::ParameterValue("tool0")},
            {"damping.values", rclcpp::ParameterValue(std::vector<double>{4.0})},
            {"update_rate", rclcpp::ParameterValue(kRate)}};
  }

  /// @param arguments  of the node: `--ros-args --params-file FILE`.
  bool init(const Parameters& parameters, const std::vector<std::string>& arguments = {}) {
    std::vector<rclcpp::Parameter> overrides;
    for (const auto& [name, value] : parameters) {
      if (value.get_type() != rclcpp::PARAMETER_NOT_SET) overrides.emplace_back(name, value);
    }
    const rclcpp::NodeOptions options =
        rclcpp::NodeOptions().parameter_overrides(overrides).arguments(arguments);
#ifdef INVERSE_DYNAMICS_CONTROLLERS_HAS_INTERFACE_PARAMS
    controller_interface::ControllerInterfaceParams params;
    params.controller_name = "under_test";
    setManagersRate(params, 0);
    params.node_options = options;
    return controller.init(params) == return_type::OK;
#else
    return controller.init("under_test", "", options) == return_type::OK;
#endif
  }

  bool configure(const Parameters& parameters, const std::vector<std::string>& arguments = {}) {
    if (!init(parameters, arguments)) return false;
    return controller.configure().id() == lifecycle_msgs::msg::State::PRIMARY_STATE_INACTIVE;
  }

  bool activate() {
    controller.assign_interfaces(hardware.commands(), hardware.states());
    return controller.get_node()->activate().id() ==
           lifecycle_msgs::msg::State::PRIMARY_STATE_ACTIVE;
  }

  return_type update(double period = kPeriod) {
    return controller.update(rclcpp::Time(0), rclcpp::Duration::from_seconds(period));
  }

  /// Spins the controller's node, and others that were added, until something is true.
  ///
  /// @param patience  after which it gives up.
  template <class Condition>
  bool spinUntil(const Condition& condition,
                 std::chrono::milliseconds patience = std::chrono::seconds(10)) {
    if (!spins_) executor.add_node(controller.get_node()->get_node_base_interface());
    spins_ = true;
    const auto end = std::chrono::steady_clock::now() + patience;
    while (!condition() && std::chrono::steady_clock::now() < end) {
      executor.spin_some(std::chrono::milliseconds(10));
    }
    return condition();
  }

  /// Sets a parameter as `ros2 param set` does; the reason why it was refused, or "".
  std::string set(const std::string& name, const rclcpp::ParameterValue& value) {
    const auto result = controller.get_node()->set_parameter(rclcpp::Parameter(name, value));
    return result.successful ? "" : result.reason;
  }

  /// Cycles until the effort isn't what it was.
  bool effortChanges() {
    const Eigen::VectorXd before = hardware.effort();
    return spinUntil([&] {
      update();
      return hardware.effort() != before;
    });
  }

  /// The solver of good(), to compute what is expected.
  static std::shared_ptr<inverse_dynamics_solver::InverseDynamicsSolver> solver(
      const char* plugin = kKdl) {
    auto made = inverse_dynamics_solver::SolverLoader().load(plugin);
    made->initialize({{"root", "base_link"}, {"tip", "tool0"}}, "", ur10Description());
    return made;
  }

  CapturedLog log;
  FakeHardware hardware{ur10Joints()};
  Controller controller;
  rclcpp::executors::SingleThreadedExecutor executor;

 private:
  /// Newer releases of jazzy and later.
  template <class Params>
  static auto setManagersRate(Params& params, int)
      -> decltype(void(params.controller_manager_update_rate)) {
    params.update_rate = params.controller_manager_update_rate = kRate;
  }
  template <class Params>
  static void setManagersRate(Params& params, long) {
    params.update_rate = kRate;
  }

  bool spins_ = false;
};

/// The same with references before it: joint by joint, interface by interface.
template <class Controller>
class ChainedFixture : public ControllerFixture<Controller> {
 protected:
  bool start(const typename ControllerFixture<Controller>::Parameters& parameters) {
    if (!this->configure(parameters)) return false;
    references_ = this->controller.export_reference_interfaces();
    return this->controller.set_chained_mode(true) && this->activate();
  }

  std::size_t referenceCount() const { return references_.size(); }

  /// @param interface  its place among a joint's.
  void setReference(std::size_t joint, std::size_t interface, double value) {
    const std::size_t stride = references_.size() / ur10Joints().size();
    auto& reference = references_[joint * stride + interface];
    if constexpr (std::is_same_v<std::decay_t<decltype(reference)>,
                                 hardware_interface::CommandInterface>) {
      setValue(reference, value);
    } else {
      setValue(*reference, value);
    }
  }

  void setReferences(std::size_t interface, const Eigen::VectorXd& values) {
    for (std::size_t j = 0; j < ur10Joints().size(); ++j) {
      setReference(j, interface, values[static_cast<Eigen::Index>(j)]);
    }
  }

  void setMotion(const Eigen::VectorXd& q, const Eigen::VectorXd& qd, const Eigen::VectorXd& qdd) {
    setReferences(0, q);
    setReferences(1, qd);
    setReferences(2, qdd);
  }

 private:
  decltype(std::declval<Controller&>().export_reference_interfaces()) references_;
};

}  // namespace inverse_dynamics_controllers
