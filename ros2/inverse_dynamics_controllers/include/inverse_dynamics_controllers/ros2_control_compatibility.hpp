// SPDX-License-Identifier: Apache-2.0
/// @file
/// Differences between releases of ros2_control, from humble to rolling, detected by features.
///
///     const double q = valueOf(state_interfaces_[0]);     // NaN where it can't be read
///     setValue(command_interfaces_[0], tau);
#pragma once

#include <array>
#include <controller_interface/chainable_controller_interface.hpp>
#include <controller_interface/controller_interface.hpp>
#include <cstddef>
#include <hardware_interface/handle.hpp>
#include <limits>
#include <memory>
#include <optional>
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

/// Whether references are exported as shared interfaces, which have values of their own (jazzy), or
/// as interfaces on numbers of the controller (humble).
struct SharedReferences : controller_interface::ChainableControllerInterface {
  template <class T>
  static auto find(int) -> decltype(&T::on_export_reference_interfaces_list, std::true_type());
  template <class T>
  static std::false_type find(...);
};
constexpr bool kHasSharedReferences = decltype(SharedReferences::find<SharedReferences>(0))::value;

/// Whether controllers export state interfaces of their own (jazzy).
struct SharedStates : controller_interface::ChainableControllerInterface {
  template <class T>
  static auto find(int) -> decltype(&T::on_export_state_interfaces_list, std::true_type());
  template <class T>
  static std::false_type find(...);
};
constexpr bool kHasSharedStates = decltype(SharedStates::find<SharedStates>(0))::value;

/// Options with services that get and set the levels of loggers (jazzy).
template <class Options>
auto withLoggerService(Options options)
    -> std::decay_t<decltype(options.enable_logger_service(true))> {
  return options.enable_logger_service(true);
}
template <class Options, class... None>
Options withLoggerService(Options options, None...) {
  return options;
}

}  // namespace detail

/// Value of an interface, if it can be read: it has a value, which isn't being written. Real time:
/// no allocation, exception or system call.
template <class Interface>
std::optional<double> readable(const Interface& interface) noexcept {
  try {
    if constexpr (detail::HasOptional<Interface>::value) {
      return interface.get_optional();
    } else {
      return interface.get_value();
    }
  } catch (...) {  // an interface without a value
    return std::nullopt;
  }
}

/// The same; NaN where it can't be read.
template <class Interface>
double valueOf(const Interface& interface) noexcept {
  return readable(interface).value_or(std::numeric_limits<double>::quiet_NaN());
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

/// A controller whose node has declared parameters alone, in all releases: no misspelt one is taken.
template <class Base>
class Strict : public Base {
 public:
  using Base::init;

  // NOLINTBEGIN(readability-identifier-naming, modernize-use-override): one overrides, one doesn't
  /// From jazzy on.
  rclcpp::NodeOptions define_custom_node_options() const {
    return detail::withLoggerService(rclcpp::NodeOptions());
  }

  /// In humble, whose manager's options allow undeclared parameters; elsewhere never called.
  controller_interface::return_type init(const std::string& controller,
                                         const std::string& name_space,
                                         const rclcpp::NodeOptions& options) {
    return Base::init(controller, name_space,
                      rclcpp::NodeOptions(options)
                          .allow_undeclared_parameters(false)
                          .automatically_declare_parameters_from_overrides(false));
  }
  // NOLINTEND(readability-identifier-naming, modernize-use-override)
};

/// Base class of the chainable controllers, the same in all releases.
///
/// Of each pair of functions with different signatures, one overrides; neither is marked `override`,
/// as the other one doesn't.
class ChainableController : public Strict<controller_interface::ChainableControllerInterface> {
 protected:
  /// Names of the references below the controller's; called when it is configured.
  virtual std::vector<std::string> referenceNames() const = 0;

  /// Called in each cycle that isn't in chained mode, before update_and_write_commands().
  virtual void readReferenceTopic() noexcept = 0;

  /// Copies what the controller before has written, in the order of referenceNames(). Real time: no
  /// allocation, exception or system call.
  ///
  /// @param[in,out] values  one that is being written stays as it is.
  void readReferences(std::vector<double>& values) const noexcept {
    for (std::size_t k = 0; k < values.size() && k < size(); ++k) {
      if (shared_.empty()) {
        values[k] = reference_interfaces_[k];
      } else if (const std::optional<double> value = readable(*shared_[k])) {
        values[k] = *value;
      }
    }
  }

  /// Makes all references NaN: not written.
  void forgetReferences() noexcept {
    constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
    reference_interfaces_.assign(reference_interfaces_.size(), kNan);
    for (const auto& reference : shared_) setValue(*reference, kNan);
  }

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

  std::vector<hardware_interface::CommandInterface> on_export_reference_interfaces() {
    return ownReferences<hardware_interface::CommandInterface>();
  }
  std::vector<std::shared_ptr<hardware_interface::CommandInterface>>
  on_export_reference_interfaces_list() {
    shared_ = sharedReferences<hardware_interface::CommandInterface>();
    return shared_;
  }
  // NOLINTEND(readability-identifier-naming, modernize-use-override)

 private:
  std::size_t size() const noexcept {
    return shared_.empty() ? reference_interfaces_.size() : shared_.size();
  }

  // On numbers of the controller.
  template <class Interface>
  std::vector<Interface> ownReferences() {
    std::vector<Interface> references;
    if constexpr (!detail::kHasSharedReferences) {
      const std::vector<std::string> names = referenceNames();
      reference_interfaces_.assign(names.size(), std::numeric_limits<double>::quiet_NaN());
      for (std::size_t k = 0; k < names.size(); ++k) {
        references.emplace_back(get_node()->get_name(), names[k], &reference_interfaces_[k]);
      }
    }
    return references;
  }

  template <class Interface>
  std::vector<std::shared_ptr<Interface>> sharedReferences() {
    std::vector<std::shared_ptr<Interface>> references;
    if constexpr (detail::kHasSharedReferences) {
      for (const std::string& name : referenceNames()) {
        references.push_back(std::make_shared<Interface>(get_node()->get_name(), name));
      }
    }
    return references;
  }

  std::vector<std::shared_ptr<hardware_interface::CommandInterface>> shared_;
};

/// Whether a Broadcaster has state interfaces; decides about its base class in the plugin file too.
constexpr bool kExportsStates = detail::kHasSharedStates;

/// A controller that commands nothing, with the state interfaces of a force-torque sensor that has
/// the controller's name.
template <class StateInterface>
class ExportingBroadcaster : public ChainableController {
 protected:
  /// A cycle.
  virtual controller_interface::return_type measure(const rclcpp::Time& time,
                                                    const rclcpp::Duration& period) noexcept = 0;

  /// Sets the exported states: force, then torque. Real time: no allocation, exception or system call.
  void setStates(const std::array<double, 6>& values) noexcept {
    for (std::size_t k = 0; k < states_.size(); ++k) setValue(*states_[k], values[k]);
  }

  // NOLINTBEGIN(readability-identifier-naming)
  std::vector<std::shared_ptr<StateInterface>> on_export_state_interfaces_list() override {
    states_.clear();
    for (const char* name : {"force.x", "force.y", "force.z", "torque.x", "torque.y", "torque.z"}) {
      states_.push_back(std::make_shared<StateInterface>(this->get_node()->get_name(), name));
    }
    return states_;
  }
  controller_interface::return_type update_and_write_commands(
      const rclcpp::Time& time, const rclcpp::Duration& period) override {
    return measure(time, period);
  }
  // NOLINTEND(readability-identifier-naming)

 private:
  std::vector<std::string> referenceNames() const override { return {}; }
  void readReferenceTopic() noexcept override {}

  std::vector<std::shared_ptr<StateInterface>> states_;
};

/// The same without state interfaces.
class PlainBroadcaster : public Strict<controller_interface::ControllerInterface> {
 public:
  controller_interface::return_type update(const rclcpp::Time& time,
                                           const rclcpp::Duration& period) override {
    return measure(time, period);
  }

 protected:
  virtual controller_interface::return_type measure(const rclcpp::Time& time,
                                                    const rclcpp::Duration& period) noexcept = 0;
  void setStates(const std::array<double, 6>& /*values*/) noexcept {}
};

/// Base class of controllers that measure: with state interfaces where the release has them.
using Broadcaster =
    std::conditional_t<kExportsStates, ExportingBroadcaster<hardware_interface::StateInterface>,
                       PlainBroadcaster>;

}  // namespace inverse_dynamics_controllers
