// SPDX-License-Identifier: Apache-2.0
/// @file
/// What differs between releases of ros2_control, from humble to rolling, found by what is there.
///
///     const double q = valueOf(state_interfaces_[0]);     // NaN where it can't be read
///     setValue(command_interfaces_[0], tau);
#pragma once

#include <controller_interface/chainable_controller_interface.hpp>
#include <hardware_interface/handle.hpp>
#include <limits>
#include <rclcpp/node_options.hpp>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

namespace inverse_dynamics_controllers {
namespace detail {

template <class T, class = void>
struct HasOptional : std::false_type {};
template <class T>
struct HasOptional<T, std::void_t<decltype(std::declval<const T&>().get_optional())>>
    : std::true_type {};

template <class T, class = void>
struct HasRobotDescription : std::false_type {};
template <class T>
struct HasRobotDescription<T,
                           std::void_t<decltype(std::declval<const T&>().get_robot_description())>>
    : std::true_type {};

}  // namespace detail

/// Value of a loaned interface; NaN where it can't be read: without a value, or while somebody else
/// writes it. Real time: no allocation, exception or system call.
template <class Interface>
double valueOf(const Interface& interface) noexcept {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  try {
    if constexpr (detail::HasOptional<Interface>::value) {
      return interface.get_optional().value_or(kNan);
    } else {
      return interface.get_value();
    }
  } catch (...) {  // an interface without a value
    return kNan;
  }
}

/// Writes a loaned command interface. Real time: no allocation, exception or system call.
///
/// @return false: it couldn't be written, and keeps its value.
template <class Interface>
bool setValue(Interface& interface, double value) noexcept {
  try {
    if constexpr (std::is_void_v<decltype(interface.set_value(value))>) {
      interface.set_value(value);
      return true;
    } else {
      return interface.set_value(value);
    }
  } catch (...) {  // an interface without a value
    return false;
  }
}

/// The robot description that the controller manager has given; empty where it gives none (humble).
template <class Controller>
std::string robotDescriptionOf(const Controller& controller) {
  if constexpr (detail::HasRobotDescription<Controller>::value) {
    return controller.get_robot_description();
  } else {
    return "";
  }
}

/// Declares what is in the parameter file, as humble does it: only the solver knows its parameters.
inline rclcpp::NodeOptions declaringNodeOptions() {
  return rclcpp::NodeOptions()
      .allow_undeclared_parameters(true)
      .automatically_declare_parameters_from_overrides(true);
}

/// An interface of a controller to the one before it, on a number that the controller keeps.
inline hardware_interface::CommandInterface referenceInterface(const std::string& controller,
                                                               const std::string& name,
                                                               double* value) {
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wdeprecated-declarations"  // from jazzy on, but still there
  return {controller, name, value};
#pragma GCC diagnostic pop
}

/// Base class of the chainable controllers, the same in all releases.
///
/// Of each pair of functions that take something else in another release one overrides; none says
/// so, for the other one doesn't.
class ChainableController : public controller_interface::ChainableControllerInterface {
 public:
  // NOLINTNEXTLINE(readability-identifier-naming): the base class's name, from jazzy on
  rclcpp::NodeOptions define_custom_node_options() const { return declaringNodeOptions(); }

 protected:
  /// Called in each cycle that isn't in chained mode, before update_and_write_commands().
  virtual void readReferenceTopic() noexcept = 0;

  // NOLINTBEGIN(readability-identifier-naming, modernize-use-override): one overrides, one doesn't
  controller_interface::return_type update_reference_from_subscribers() {
    readReferenceTopic();
    return controller_interface::return_type::OK;
  }
  controller_interface::return_type update_reference_from_subscribers(const rclcpp::Time&,
                                                                      const rclcpp::Duration&) {
    readReferenceTopic();
    return controller_interface::return_type::OK;
  }
  // NOLINTEND(readability-identifier-naming, modernize-use-override)
};

}  // namespace inverse_dynamics_controllers
